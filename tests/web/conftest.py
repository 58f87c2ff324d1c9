"""A real browser for the tests of the page."""

import asyncio
import contextlib
import gc
import os
import shutil
import subprocess
import threading
from pathlib import Path

import pytest

from crowdbot.web import DESKS, AppServer

LONG = int(os.environ.get("PAGE_TIMEOUT", "180000"))
"""Longest time [ms] that a test waits for something in a page; kernels may be compiled."""
FLAGS = ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


@pytest.fixture(scope="module")
def browser():
    """Headless Chromium; Playwright keeps an event loop running until the end of the module."""
    from playwright.sync_api import expect, sync_playwright

    expect.set_options(timeout=LONG)
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    assert path, "chromium is missing: tests/system-packages installs it"
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield chromium
        chromium.close()


@contextlib.contextmanager
def serve(folder, desks=DESKS, kind=AppServer, port=0, **options):
    """Run the app in a thread and give its server."""
    ready, box = threading.Event(), {}

    async def main():
        box["loop"], box["stop"] = asyncio.get_running_loop(), asyncio.Event()
        async with kind(desks, folder, port=port, **options).running() as server:
            box["server"] = server
            ready.set()
            await box["stop"].wait()

    thread = threading.Thread(target=asyncio.run, args=(main(),))
    thread.start()
    assert ready.wait(180)

    def stop():
        if thread.is_alive():
            box["loop"].call_soon_threadsafe(box["stop"].set)
        thread.join(180)

    box["server"].stop = stop
    try:
        yield box["server"]
    finally:
        stop()
        assert not thread.is_alive()
        gc.collect()  # what the server left open fails this test, and not whichever comes next


@pytest.fixture(name="serve")
def serve_fixture():
    """Function that runs the app with given desks in a thread."""
    return serve


@pytest.fixture
def app(tmp_path):
    """The app on a free port, with an empty folder."""
    with serve(tmp_path / "files") as server:
        yield server


@pytest.fixture
def page(request, browser, app):
    """A window with the app; fails on console errors, errors of the page, and requests beyond the server.

    It opens the tab that the module names in ``TAB``, by default the first one.
    """
    context = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    page = context.new_page()
    page.set_default_timeout(LONG)
    faults = []
    page.on("console", lambda one: faults.append(one.text) if one.type == "error" else None)
    page.on("pageerror", lambda one: faults.append(str(one)))
    page.on("request", lambda one: None if one.url.startswith((app.url, "data:", "blob:")) else faults.append(one.url))
    page.goto(app.url + getattr(request.module, "TAB", ""))
    page.wait_for_selector(".connection:not(.lost):has-text('connected')")
    yield page
    context.close()
    assert faults == []


@pytest.fixture(scope="session")
def modules(tmp_path_factory):
    """A copy of the sources of the page with the libraries of its lock file."""
    root = Path(__file__).parents[2]
    folder = tmp_path_factory.mktemp("checkout")
    shutil.copytree(root / "frontend", folder / "frontend", ignore=shutil.ignore_patterns("node_modules"))
    shutil.copytree(root / "src/crowdbot/assets/web", folder / "src/crowdbot/assets/web")
    shutil.copytree(root / "tests/web", folder / "tests/web", ignore=shutil.ignore_patterns("*.py"))
    command = ["npm", "ci", "--no-audit", "--no-fund", "--fetch-timeout=60000", "--fetch-retries=3"]
    done = subprocess.run(command, cwd=folder / "frontend", capture_output=True, text=True, timeout=400)
    assert done.returncode == 0, done.stderr
    return folder / "frontend"


@pytest.fixture(scope="session")
def axe(modules):
    """A function that returns the accessibility faults that axe-core finds in a page."""
    script = (modules / "node_modules/axe-core/axe.min.js").read_text(encoding="utf-8")

    def check(page):
        page.evaluate(script)
        found = page.evaluate("axe.run()")["violations"]
        return [(one["id"], one["help"], [node["html"][:200] for node in one["nodes"][:3]]) for one in found]

    return check
