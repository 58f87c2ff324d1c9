"""Found trials run by themselves, wherever their robots, maps and code came from."""

import json
import shutil

import pytest

from crowdbot.cli import main
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial
from trial_texts import SHY

URDF = """<robot name="mine"><link name="base_link"><inertial><mass value="5"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.4 0.4 0.4"/></geometry></collision></link></robot>"""
ROBOT = """<robot name="mine" urdf="mine.urdf"><footprint radius="0.3"/>
<drive type="differential-drive" max-speed="0.8"/></robot>"""
TRIAL = """<trial name="met" duration="4"><stage/><crowd type="orca"/><agent x="2" y="0" goal="-6,0"/>
<robot name="a" type="{type}" x="-2" y="0"><goal x="6" y="0"/><navigator type="{navigator}"/></robot></trial>"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder of trials beside one of robots; the working folder has both, and a robot of its own."""
    monkeypatch.chdir(tmp_path)
    for place in ("robots/mine", "trials/mine", "mine"):
        (tmp_path / place).mkdir(parents=True)
        (tmp_path / place / "robot.xml").write_text(ROBOT)
        (tmp_path / place / "mine.urdf").write_text(URDF)
    (tmp_path / "robots" / "shy.py").write_text(SHY)
    (tmp_path / "trials" / "shy.py").write_text(SHY)
    return tmp_path


def falsified(folder, words):
    """Return the trials that a search finds, after everything that it was made from is gone."""
    options = ["--runs", "3", "--search", "plain", "--failure", "min-clearance>9", "--workers", "1", "--keep", "2"]
    assert main(["falsify", *words, *options, "--out", "out"]) == 0
    result = json.loads((folder / "out" / "result.json").read_text())
    assert result["found"]
    assert all(one["same"] for one in result["found"])
    for place in ("robots", "trials", "mine"):
        shutil.rmtree(folder / place)
    return sorted((folder / "out" / "found").glob("*.xml"))


@pytest.mark.parametrize(
    ("kind", "navigator"),
    [("mine", "shy.py:Shy"), ("../robots/mine", "straight"), ("{}/robots/mine", "../robots/shy.py:Shy")],
)
def test_a_found_trial_takes_its_robot_and_its_code_along(folder, kind, navigator):
    text = TRIAL.format(type=kind.format(folder), navigator=navigator)
    (folder / "trials" / "met.xml").write_text(text)
    for path in falsified(folder, ["trials/met.xml", "--trust"]):
        trial = load_trial(path)  # without trust: everything is inside
        assert trial.robots[0].drive.max_speed == 0.8
        assert simulate(trial, trial.seed).steps > 0


def test_a_built_in_trial_takes_the_robot_of_the_working_folder_along(folder):
    for path in falsified(folder, ["frontal", "--set", "robot/type=mine"]):
        trial = load_trial(path)
        assert trial.robots[0].mass == 5.0
        assert simulate(trial, trial.seed).steps > 0
