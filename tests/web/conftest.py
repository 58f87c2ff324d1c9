"""A real browser for the tests of the page."""

import asyncio
import contextlib
import shutil
import threading

import pytest

from crowdbot.web import DESKS, AppServer

FLAGS = ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


@pytest.fixture(scope="session")
def browser():
    """Headless Chromium."""
    from playwright.sync_api import sync_playwright

    path = shutil.which("chromium") or shutil.which("chromium-browser")
    assert path, "chromium is missing: tests/system-packages installs it"
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield chromium
        chromium.close()


@contextlib.contextmanager
def serve(folder, desks=DESKS, **options):
    """Run the app in a thread and give its server."""
    ready, box = threading.Event(), {}

    async def main():
        box["loop"], box["stop"] = asyncio.get_running_loop(), asyncio.Event()
        async with AppServer(desks, folder, port=0, **options).running() as server:
            box["server"] = server
            ready.set()
            await box["stop"].wait()

    thread = threading.Thread(target=asyncio.run, args=(main(),))
    thread.start()
    assert ready.wait(20)
    try:
        yield box["server"]
    finally:
        box["loop"].call_soon_threadsafe(box["stop"].set)
        thread.join(20)
        assert not thread.is_alive()


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
def page(browser, app):
    """A window with the app; fails on console errors, errors of the page, and requests beyond the server."""
    context = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    page = context.new_page()
    page.set_default_timeout(30_000)
    faults = []
    page.on("console", lambda one: faults.append(one.text) if one.type == "error" else None)
    page.on("pageerror", lambda one: faults.append(str(one)))
    page.on("request", lambda one: None if one.url.startswith((app.url, "data:", "blob:")) else faults.append(one.url))
    page.goto(app.url)
    page.wait_for_selector(".connection:not(.lost):has-text('connected')")
    yield page
    context.close()
    assert faults == []
