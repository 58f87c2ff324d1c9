"""Make the pictures of the app from the real program: python tools/app_pictures.py docs/how-to [NAME ...].

With ``--review DIR`` every tab is taken at two sizes and in both themes, to be looked at.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import shutil
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from playwright.sync_api import FilePayload, Page, expect, sync_playwright

from crowdbot.web import DESKS, AppServer

FLAGS = ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
SIZE = (1280, 800)
REVIEWED = ((1280, 800), (1920, 1080))
LONG = 400_000
"""Longest wait for a run [ms]."""
CAMERAS = """<trial name="wheelchair-hall" duration="20" world="physics">
  <stage walkable="-6,-4 8,-4 8,4 -6,4"><table x="-1" y="3" length="1.4" width="0.7"/><tree x="6" y="3"/></stage>
  <crowd type="orca"/>
  <spawner count="10" zone="1,-3 6,-3 6,3 1,3" goal="-6,-3 -5,-3 -5,3 -6,3"/>
  <robot name="wheelchair" type="wheelchair" x="-4" y="0"><goal x="7" y="0"/><navigator type="orca"/>
    <sensor name="eye" type="rgb-camera" x="0.4" z="1.1" pitch="0.15" field-of-view="1.2" rate="10"/>
    <sensor name="range" type="depth-camera" x="0.4" z="1.1" rate="10"/>
  </robot>
</trial>"""
"""The trial of the picture of camera images."""


def editor(page: Page) -> None:
    """Show crossing-flows with a way that some of its people follow."""
    page.get_by_role("button", name="Open").click()
    page.get_by_role("button", name="crossing-flows", exact=True).click()
    page.get_by_role("option", name="spawner eastbound").click()
    page.get_by_role("button", name="Whole view").click()
    page.get_by_role("button", name="Way", exact=True).click()
    box = page.locator(".editor canvas").bounding_box()
    assert box is not None
    for x, y in ((0.3, 0.62), (0.5, 0.45), (0.72, 0.55)):
        page.mouse.click(box["x"] + x * box["width"], box["y"] + y * box["height"])
    page.keyboard.press("Enter")
    page.wait_for_function("() => document.querySelector('.editor textarea').value.includes('journey=')")
    page.keyboard.press("Escape")
    page.get_by_role("option", name="spawner eastbound").click()
    page.get_by_role("button", name="Places").click()
    page.wait_for_function("() => crowdbot.tab('editor').tab.model.people !== null")


def experiments(page: Page) -> None:
    """Show the first screen of an experiment with its operator."""
    page.get_by_role("combobox", name="Experiment").select_option("robot-speed")
    page.get_by_role("button", name="Start", exact=True).click()
    page.get_by_label("How old are you?").fill("31")


def evaluation(page: Page) -> None:
    """Compare two navigators and list the runs of the first."""
    page.get_by_label("Trials").select_option("circle-crossing")
    page.get_by_label("Trials").evaluate("(one) => one.selectedOptions[0].scrollIntoView({ block: 'start' })")
    page.get_by_label("Seeds").fill("0:30")
    page.get_by_role("button", name="Run", exact=True).click()
    page.get_by_role("heading", name="first").wait_for(timeout=LONG)


def jobs(page: Page) -> None:
    """Show a search that has ended, one that fails, a training that runs and data that wait."""
    call = "([kind, values]) => crowdbot.connection.call('jobs.begin', {kind, values})"
    search = {"trial": "frontal", "navigator": "straight", "search": "plain", "runs": 20, "name": "straight-fails"}
    page.evaluate(call, ["falsify", search])
    page.locator(".job.done").wait_for(timeout=LONG)
    page.evaluate(call, ["falsify", {"trial": "frontal", "navigator": "orka", "name": "wrong-name"}])
    page.locator(".job.failed").wait_for(timeout=LONG)
    training = {"predictor": "anchor-net", "data": ["example:crossing-flows"], "epochs": 3000, "name": "corridor"}
    page.evaluate(call, ["train", training])
    page.locator(".job.running").get_by_text("update").wait_for(timeout=LONG)
    data = {"sources": ["crossing-flows"], "sensors": "sick-tim571", "seeds": "0:1000", "name": "lidar"}
    page.evaluate(call, ["generate", data])
    page.evaluate(call, ["generate", {**data, "sources": ["bottleneck"], "name": "lidar-door"}])
    page.locator(".job.waiting").wait_for()


def prediction(page: Page) -> None:
    """Open an example, run three predictors and go to a frame in its middle."""
    page.get_by_role("button", name="Open…").click()
    page.get_by_role("dialog").get_by_role("button", name="bottleneck").click()
    for name in ("constant-velocity", "anchor-net"):
        page.get_by_role("button", name="Add base predictor…").click()
        page.get_by_role("dialog").get_by_label("Predictor").select_option(name)
        page.get_by_role("dialog").get_by_role("button", name="OK").click()
        expect(page.get_by_role("list", name="List of predictors")).to_contain_text(name)
    page.get_by_role("button", name="Add sim predictor…").click()
    page.get_by_role("dialog").get_by_label("Simulation model").select_option("social-force")
    page.get_by_role("dialog").get_by_role("button", name="OK").click()
    expect(page.get_by_role("list", name="List of predictors")).to_contain_text("social-force")
    page.get_by_role("button", name="Run", exact=True).click()
    expect(page.locator(".metrics tbody tr")).to_have_count(3, timeout=LONG)
    expect(page.get_by_role("button", name="Cancel")).to_be_disabled(timeout=LONG)
    page.get_by_label("Jump to frame").fill("17")
    page.get_by_label("Jump to frame").press("Enter")
    expect(page.locator("canvas.scene")).to_have_attribute("data-frame", "10")
    expect(page.get_by_role("img", name="Execution time, Frame")).to_be_visible()
    page.locator(".side").first.evaluate("(one) => one.scrollTo(0, 0)")
    page.wait_for_timeout(1000)


def simulator(page: Page) -> None:
    """Show the first trial after some seconds, with the robot chosen."""
    status = "() => crowdbot.tab('simulator').status"
    page.wait_for_function(f"{status}.time > 6", timeout=LONG)
    page.get_by_role("button", name="Pause").click()
    page.get_by_label("Choose a person or robot").focus()
    page.wait_for_function("() => document.querySelectorAll('option[value^=robot]').length > 0")
    robot = page.evaluate("document.querySelector('option[value^=robot]').value")
    page.get_by_label("Choose a person or robot").select_option(robot)
    page.get_by_role("rowheader", name="navigator").wait_for()
    page.get_by_label("Choose a person or robot").evaluate("(one) => one.blur()")
    page.wait_for_timeout(4000)


def cameras(page: Page) -> None:
    """Show what the cameras of a wheelchair see, beside it."""
    page.get_by_label("View", exact=True).select_option("2d")  # in space only for the picture
    trial = FilePayload(name="wheelchair-hall.xml", mimeType="text/xml", buffer=CAMERAS.encode())
    page.locator(".library input[type=file]").set_input_files(trial)
    for name in ("eye: colour", "range: depth"):
        page.get_by_role("checkbox", name=f"wheelchair / {name}").check(timeout=LONG)
    page.wait_for_function("() => crowdbot.tab('simulator').status.time > 2.4", timeout=LONG)
    page.get_by_role("button", name="Pause").click()
    page.get_by_label("View", exact=True).select_option("3d")
    page.wait_for_timeout(6000)


PICTURES: dict[str, Callable[[Page], None]] = {
    "simulator": simulator,
    "cameras": cameras,
    "prediction": prediction,
    "editor": editor,
    "evaluation": evaluation,
    "experiments": experiments,
    "jobs": jobs,
}
"""Pictures by the names of the tabs, and what is done in each."""


@contextlib.contextmanager
def serve(folder: Path) -> Iterator[str]:
    """Run the app and give its address."""
    ready = threading.Event()
    box: dict[str, Any] = {}

    async def main() -> None:
        box["loop"], box["stop"] = asyncio.get_running_loop(), asyncio.Event()
        async with AppServer(DESKS, folder, port=0).running() as server:
            box["url"] = server.url
            ready.set()
            await box["stop"].wait()

    thread = threading.Thread(target=asyncio.run, args=(main(),))
    thread.start()
    ready.wait()
    try:
        yield box["url"]
    finally:
        box["loop"].call_soon_threadsafe(box["stop"].set)
        thread.join()


def review(page: Page, folder: Path, name: str) -> None:
    """Take a tab at two sizes in both themes."""
    for width, height in REVIEWED:
        page.set_viewport_size({"width": width, "height": height})
        for theme in ("light", "dark"):
            if page.evaluate("document.documentElement.dataset.theme") != theme:
                page.get_by_role("button", name="Theme").click()
            page.wait_for_timeout(1500)
            page.screenshot(path=folder / f"{name}-{width}-{theme}.png")


def take(name: str, browser: Any, options: argparse.Namespace) -> None:
    """Take the picture of a tab."""
    with tempfile.TemporaryDirectory() as folder, serve(Path(folder)) as url:
        page = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]}, reduced_motion="reduce")
        page.set_default_timeout(LONG)
        page.goto(f"{url}#tab={name}&theme=light")
        page.wait_for_selector(".connection:has-text('connected')")
        PICTURES[name](page)
        page.evaluate("document.activeElement.blur()")  # a mark of the focus is no part of a picture
        if options.review is not None:
            review(page, options.review, name)
        else:
            page.screenshot(path=options.out / f"app-{name}.png")
        page.close()


def main() -> int:
    """Take the pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("names", nargs="*", choices=[*PICTURES, []], default=[])
    parser.add_argument("--review", type=Path, metavar="DIR", help="folder for all sizes and themes, instead")
    options = parser.parse_args()
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=FLAGS)
        for name in options.names or PICTURES:
            take(name, browser, options)
            print(f"took {name}", flush=True)
        browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
