"""`crowdbot app --open RECORDING` shows the recording in the prediction tab."""

import json
import re
import subprocess
import sys

import pytest
from playwright.sync_api import expect
from prediction_session import DeskCaller

from crowdbot.core import DataError, InputError
from crowdbot.web import DESKS, opened_first

ROWS = "".join(f"{10 * k} 1 {0.5 * k} 0.0\n{10 * k} 2 {10 - 0.5 * k} 1.0\n" for k in range(24))


@pytest.fixture
def recording(tmp_path):
    (tmp_path / "data").mkdir()
    file = tmp_path / "data" / "two.txt"
    file.write_text(ROWS)
    return file


def caller(folder, file):
    found = opened_first(DESKS, str(file))
    own = next(desk for desk in found.desks if desk.name == "prediction")
    return DeskCaller(folder, own, found.readable)


def test_a_new_session_has_the_recording_and_keeps_its_predictors(tmp_path, recording):
    desk = caller(tmp_path / "files", recording)
    assert desk.desk.greet()["stored"]
    assert desk("restore")["recording"]["path"] == str(recording)
    desk("add", settings={"predictor": "constant-velocity"})
    again = caller(tmp_path / "files", recording)
    assert [item["name"] for item in again("restore")["predictors"]] == ["constant-velocity"]
    other = recording.with_name("other.txt")
    other.write_text(ROWS)
    assert caller(tmp_path / "files", other)("restore")["predictors"] == []


def test_a_recording_that_cannot_be_used_is_told(tmp_path, recording):
    desk = caller(tmp_path / "files", recording)
    recording.write_text("0 1 0.0 0.0\n10 1 0.5 0.0\n")
    with pytest.raises((DataError, InputError), match="window"):
        desk("restore")


def test_the_program_prints_the_tab_and_the_page_shows_the_recording(browser, tmp_path, recording):
    words = ["app", "--port", "0", "--no-browser", "--folder", str(tmp_path / "files"), "--open", str(recording)]
    with subprocess.Popen([sys.executable, "-m", "crowdbot", *words], stdout=subprocess.PIPE, text=True) as process:
        try:
            address = re.search(r"http://\S+", process.stdout.readline())[0]
            assert address.endswith("#tab=prediction")
            page = browser.new_page()
            page.set_default_timeout(180_000)
            page.goto(address)
            expect(page.get_by_role("region", name="Recording")).to_contain_text("two.txt", timeout=180_000)
            assert json.loads(page.evaluate("JSON.stringify(crowdbot.tab('prediction').store.recording.walls)")) == []
            page.close()
        finally:
            process.terminate()
