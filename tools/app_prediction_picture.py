"""Make the picture of the prediction tab: python tools/app_prediction_picture.py docs/how-to/app-prediction.png."""

from __future__ import annotations

import argparse
import asyncio
import shutil
import tempfile
import threading
from pathlib import Path

from playwright.sync_api import Page, expect, sync_playwright

from crowdbot.web import DESKS, AppServer

LONG = 300_000
FLAGS = ["--no-sandbox", "--disable-gpu"]


def main() -> None:
    """Open the example, run three predictors, click a person and save the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--size", type=int, nargs=2, default=(1440, 900), metavar="PX")
    parser.add_argument("--dark", action="store_true", help="dark theme")
    options = parser.parse_args()
    ready, stop = threading.Event(), asyncio.Event()
    box: dict[str, object] = {}

    async def serve() -> None:
        with tempfile.TemporaryDirectory() as folder:
            async with AppServer(DESKS, Path(folder), port=0).running() as server:
                box["loop"], box["url"] = asyncio.get_running_loop(), server.url
                ready.set()
                await stop.wait()

    thread = threading.Thread(target=asyncio.run, args=(serve(),))
    thread.start()
    ready.wait()
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
            width, height = options.size
            page = browser.new_page(viewport={"width": width, "height": height}, reduced_motion="reduce")
            page.goto(f"{box['url']}#tab=prediction&theme={'dark' if options.dark else 'light'}")
            _fill(page)
            page.screenshot(path=options.file)
            browser.close()
    finally:
        box["loop"].call_soon_threadsafe(stop.set)  # type: ignore[attr-defined]
        thread.join()


def _fill(page: Page) -> None:
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


if __name__ == "__main__":
    main()
