"""The frame of the page: tabs, theme, keys, connection; the shipped files are as built."""

import subprocess
from pathlib import Path

import pytest
from playwright.sync_api import expect

FRONTEND = Path(__file__).parents[2] / "frontend"


def test_the_shipped_files_are_as_built(modules):
    done = subprocess.run(["node", "build.mjs", "--check"], cwd=modules, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "the files of the page are as built\n"


def test_the_modules_of_the_page_pass_their_tests(modules):
    done = subprocess.run(["node", "--test"], cwd=modules, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    assert "# fail 0" in done.stdout


def test_the_bundle_is_below_1_mb():
    assert (FRONTEND.parent / "src/crowdbot/assets/web/app.js").stat().st_size < 1_000_000


@pytest.mark.live
def test_theme_and_keys(page):
    before = page.evaluate("document.documentElement.dataset.theme")
    page.get_by_role("button", name="Theme").click()
    assert page.evaluate("document.documentElement.dataset.theme") != before
    page.keyboard.press("Escape")
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("?")
    expect(page.get_by_role("dialog", name="Keys")).to_be_visible()
