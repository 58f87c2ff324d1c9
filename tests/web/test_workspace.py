"""Names of trials and values come from a browser: they reach built-in trials and files of the folder, and no others."""

import pytest
from simulator_session import Windows, ready

from crowdbot.core import CrowdbotError
from crowdbot.trials import load_builtin_trial, load_trial, trial_xml
from crowdbot.web import Workspace, call_command
from crowdbot.web.simulator import SimulatorDesk
from trial_texts import SHY

TRAP = 'from pathlib import Path\nPath(__file__).with_name("ran").write_text("yes")\n'


@pytest.fixture
def outside(tmp_path, monkeypatch):
    """The working folder, with a trial, code and a map that are not of the app; its folder is ``files`` inside."""
    monkeypatch.chdir(tmp_path)
    text = trial_xml(load_builtin_trial("frontal", gap=7))
    for name in ("frontal", "secret", "secret.xml", "secret.XML"):
        (tmp_path / name).write_text(text)
    (tmp_path / "shy.py").write_text(TRAP + SHY)
    (tmp_path / "plan.yaml").write_text("image: plan.png\nresolution: 0.05\norigin: [0, 0, 0]\n")
    (tmp_path / "files" / "sub").mkdir(parents=True)
    for name in ("own.xml", "sub/own.XML"):
        (tmp_path / "files" / name).write_text(text)
    (tmp_path / "files" / "link.xml").symlink_to(tmp_path / "secret.xml")
    return tmp_path


def test_built_in_trials_and_files_of_the_folder_are_loaded(outside):
    space = Workspace(outside / "files")
    assert space.trial("own.xml", {"duration": 3.0}).duration == 3.0
    assert space.trial("sub/own.XML").name == "frontal"
    assert space.trial("own.xml").robots == load_trial("secret").robots
    assert space.trial("frontal").robots == load_builtin_trial("frontal").robots != load_trial("frontal").robots
    assert space.trial("frontal", {"gap": 7}).robots == load_trial("secret").robots


@pytest.mark.parametrize(
    "name",
    ["secret", "secret.xml", "secret.XML", "../secret", "../secret.xml", "{}/secret", "{}/secret.xml", "link.xml", ""],
)
def test_no_other_file_is_a_trial(outside, name):
    with pytest.raises(CrowdbotError, match=r"is outside the folder of the app|does not exist in|there is no trial"):
        Workspace(outside / "files").trial(name.format(outside))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("stage/map", "plan.yaml"),
        ("stage/map", "{}/plan.yaml"),
        ("robot/navigator/type", "shy.py:Shy"),
        ("robot/navigator/type", "{}/shy.py:Shy"),
        ("model", "shy.py:Shy"),
        ("model", "{}/shy.py:Shy"),
        ("navigator", "{}/shy.py:Shy"),
    ],
)
@pytest.mark.parametrize("name", ["intersection", "frontal", "own.xml"])
def test_a_value_names_no_file_outside_the_folder(outside, name, path, value):
    desk = SimulatorDesk(Windows(outside / "files"))
    with pytest.raises(CrowdbotError):
        call_command(desk, "open", {"name": name, "settings": {path: value.format(outside)}})
    assert not (outside / "ran").exists()
    desk.close()


@pytest.mark.parametrize("word", ["trust", "folder", "source", "name", "given", "values", "self", "place"])
@pytest.mark.parametrize("name", ["intersection", "frontal", "own.xml"])
def test_no_setting_is_an_argument(outside, name, word):
    settings = {word: str(outside), "robot/navigator/type": f"{outside}/shy.py:Shy"}
    desk = SimulatorDesk(Windows(outside / "files"))
    with pytest.raises(CrowdbotError):
        call_command(desk, "open", {"name": name, "settings": settings})
    call_command(desk, "open", {"name": name, "paused": True})
    with pytest.raises(CrowdbotError):
        call_command(desk, "restart", {"settings": settings})
    if word != "name":  # a value of each trial
        with pytest.raises(CrowdbotError, match=word):
            call_command(desk, "open", {"name": name, "settings": {word: "1"}})
    assert not (outside / "ran").exists()
    desk.close()


def test_a_value_of_a_running_trial_names_no_code_outside_the_folder(outside):
    desk = SimulatorDesk(Windows(outside / "files"))
    call_command(desk, "open", {"name": "own.xml", "paused": True})
    ready(desk)
    with pytest.raises(CrowdbotError, match="outside"):
        call_command(desk, "set_value", {"path": "robot/navigator/type", "text": f"{outside}/shy.py:Shy"})
    assert not (outside / "ran").exists()
    desk.close()


def test_code_of_the_folder_runs(outside):
    (outside / "files" / "shy.py").write_text(SHY)
    trial = Workspace(outside / "files").trial("intersection", {"navigator": "shy.py:Shy"})
    assert type(trial.robots[0].navigator).__name__ == "Shy"
