"""The server is killed and started again, the net is cut, two windows edit the same trial: nothing is lost silently."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from playwright.sync_api import expect

from crowdbot.trials import parse_trial

pytestmark = pytest.mark.live

START = 240


def start(folder, port=0):
    """Start `crowdbot app` and return its process and address."""
    words = [sys.executable, "-m", "crowdbot", "app", "--no-browser", "--port", str(port), "--folder", str(folder)]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    line = process.stdout.readline()
    assert line.startswith("crowdbot app: http"), line
    return process, line.split()[2]


def stop(process):
    process.send_signal(signal.SIGKILL)
    process.wait(180)
    process.stdout.close()


def alive(pid):
    """Whether a process runs, and is not waiting to be reaped."""
    try:
        return Path(f"/proc/{pid}/stat").read_text(encoding="ascii").split(")")[-1].split()[0] != "Z"
    except OSError:
        return False


def children(pid):
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True)
    return [int(one) for one in found.stdout.split()]


def text_of(page):
    return page.get_by_label("XML of the trial").input_value()


@pytest.fixture
def window(browser):
    """A window that may see its server die."""
    context = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    page = context.new_page()
    page.set_default_timeout(180_000)
    yield page
    context.close()


def test_a_killed_server_comes_back_with_the_jobs_and_the_text_stays(window, tmp_path):
    page = window
    process, url = start(tmp_path)
    try:
        page.goto(url + "#tab=jobs")
        page.get_by_role("button", name="Generate data").click()
        page.get_by_label("Trials or a recipe").select_option("frontal")
        page.get_by_label("Sensors").fill("sick-tim571")
        page.get_by_label("Seeds").fill("0:100000")
        page.get_by_role("form").get_by_role("button", name="Start").click()
        page.locator(".job.running").wait_for()
        workers = [child for child in children(process.pid) if alive(child)]
        assert workers
        page.get_by_role("tab", name="Editor").click()
        page.wait_for_function("() => document.querySelector('.editor textarea').value.includes('new-trial')")
        stop(process)
        page.locator(".connection.lost").wait_for()
        page.get_by_label("XML of the trial").fill(text_of(page).replace("<stage/>", '<stage map="mine"/>'))
        end = time.monotonic() + START
        while any(alive(worker) for worker in workers):  # no orphan goes on
            if time.monotonic() > end:
                raise TimeoutError
            time.sleep(0.1)
        process, again = start(tmp_path, int(url.rsplit(":", 1)[1].strip("/")))
        assert again == url
        page.locator(".connection:not(.lost):has-text('connected')").wait_for()
        page.get_by_role("tab", name="Jobs").click()
        page.locator(".job.interrupted").wait_for()
        expect(page.locator(".job.interrupted")).to_contain_text("the server ended while the job was running")
        expect(page.get_by_role("button", name="Continue first")).to_be_visible()
        page.get_by_role("tab", name="Editor").click()
        assert 'map="mine"' in text_of(page)  # what was typed meanwhile
    finally:
        stop(process)


def test_a_cut_net_is_shown_and_the_edit_that_did_not_arrive_is_told(page, app):
    page.get_by_role("tab", name="Editor").click()
    page.wait_for_function("() => document.querySelector('.editor textarea').value.includes('new-trial')")
    page.evaluate("crowdbot.connection._socket.close()")
    page.wait_for_function("() => !crowdbot.connection.open")
    sentence = page.evaluate("crowdbot.connection.call('editor.undo').catch((error) => error.message)")
    assert sentence == "the server is not connected"
    page.wait_for_function("() => crowdbot.connection.open")  # the word before the cut is still there for a moment
    page.locator(".connection:not(.lost):has-text('connected')").wait_for()
    assert (
        page.evaluate("crowdbot.connection.call('editor.start', {trial: 'frontal'}).then((one) => one.revision)") == 1
    )


def test_two_windows_that_edit_the_same_trial_lose_nothing_silently(page, app, browser):
    other = browser.new_page()
    other.goto(app.url + "#tab=editor")
    page.get_by_role("tab", name="Editor").click()
    for item in (page, other):
        item.wait_for_function("() => document.querySelector('.editor textarea').value.includes('new-trial')")
    insert = """(xml) =>
      crowdbot.connection.call('editor.insert', {path: [0], xml, revision: 0}).then(() => '', (error) => error.message)
    """
    answers = [item.evaluate(insert, f'<wall points="0,{i} 4,{i}"/>') for i, item in enumerate((page, other))]
    assert answers == ["", "the trial was changed in another window or by a later edit; it is shown as it is now"]
    for item in (page, other):
        item.wait_for_function("() => document.querySelector('.editor textarea').value.includes('<wall')")
    assert text_of(page) == text_of(other)
    assert len(parse_trial(text_of(page)).stage.walls) == 1
    other.close()
