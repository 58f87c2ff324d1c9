"""Takes the pictures of the app for the documentation from the real program, in headless Chromium.

    python tools/app_pictures.py docs/how-to [NAME ...]

Each name of ``PICTURES`` is one picture ``app-NAME.png``. Needs Playwright and Chromium.
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

from playwright.sync_api import Page, sync_playwright

from crowdbot.web import DESKS, AppServer

FLAGS = ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
WIDTH, HEIGHT = 1280, 800


def editor(page: Page) -> None:
    """Show crossing-flows with a chosen spawner and the ways of its people."""
    page.get_by_role("button", name="Open").click()
    page.get_by_role("button", name="crossing-flows", exact=True).click()
    page.get_by_role("option", name="spawner eastbound").click()
    page.get_by_role("button", name="Places").click()
    page.get_by_role("button", name="Whole view").click()
    page.wait_for_function("() => crowdbot._views.get('editor').tab.model.people !== null")


def experiments(page: Page) -> None:
    """Show the first screen of an experiment with its operator."""
    page.get_by_role("button", name="Start", exact=True).click()
    page.get_by_label("How old are you?").fill("31")


def evaluation(page: Page) -> None:
    """Compare two navigators and list the runs of the first."""
    page.get_by_label("Trials").select_option("circle-crossing")
    page.get_by_label("Seeds").fill("0:30")
    page.get_by_role("button", name="Run", exact=True).click()
    page.get_by_role("heading", name="first").wait_for(timeout=300_000)


def simulator(page: Page) -> None:
    """Show the first trial after some seconds, with the robot chosen."""
    status = "() => crowdbot._views.get('simulator').status"
    page.wait_for_function(f"{status}.time > 6", timeout=300_000)
    page.get_by_role("button", name="Pause").click()
    page.get_by_label("Choose a person or robot").focus()
    page.wait_for_function("() => document.querySelectorAll('option[value^=robot]').length > 0")
    robot = page.evaluate("document.querySelector('option[value^=robot]').value")
    page.get_by_label("Choose a person or robot").select_option(robot)
    page.get_by_role("rowheader", name="navigator").wait_for()
    page.get_by_label("Choose a person or robot").evaluate("(one) => one.blur()")
    page.wait_for_timeout(4000)


PICTURES: dict[str, tuple[str, Callable[[Page], None]]] = {
    "editor": ("editor", editor),
    "evaluation": ("evaluation", evaluation),
    "experiments": ("experiments", experiments),
    "simulator": ("simulator", simulator),
}
"""Pictures: the tab, and what is done in it."""


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


def main() -> int:
    """Take the pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("names", nargs="*", choices=[*PICTURES, []], default=[])
    options = parser.parse_args()
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=FLAGS)
        for name in options.names or PICTURES:
            tab, act = PICTURES[name]
            with tempfile.TemporaryDirectory() as folder, serve(Path(folder)) as url:
                page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT}, reduced_motion="reduce")
                page.goto(f"{url}#tab={tab}&theme=light")
                page.wait_for_selector(".connection:has-text('connected')")
                act(page)
                page.screenshot(path=options.out / f"app-{name}.png")
                page.close()
            print(f"wrote {options.out / f'app-{name}.png'}")
        browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
