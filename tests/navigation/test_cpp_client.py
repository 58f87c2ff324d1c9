"""The C++ client of the examples: compiled, and driving a robot in lock step with the simulation."""

from __future__ import annotations

import dataclasses
import math
import shutil
import subprocess
from pathlib import Path

import pytest

from crowdbot.navigation import ProcessNavigator
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial

FOLDER = Path(__file__).parents[2] / "examples" / "cpp"


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    """Return the compiled program."""
    place = tmp_path_factory.mktemp("cpp") / "drive"
    compiler = shutil.which("g++")
    assert compiler, "tests/system-packages installs g++"
    warnings = ["-Wall", "-Wextra", "-Werror"]
    subprocess.run([compiler, "-std=c++17", "-O1", *warnings, "-o", place, FOLDER / "drive.cpp"], check=True)
    return place


@pytest.mark.program
def test_it_drives_towards_the_goal_and_turns_away_from_people(program):
    trial = load_trial("frontal", {"duration": 6.0, "crowd/robot-gap": 0.0})
    navigator = ProcessNavigator(command=str(program), sandbox=False)
    trial = dataclasses.replace(trial, robots=(dataclasses.replace(trial.robots[0], navigator=navigator),))
    episode = simulate(trial, 0)
    assert episode.failure is None
    path = episode.position[:, episode.robots[0]]
    assert math.dist(path[-1], path[0]) > 2.5
    assert abs(path[:, 1] - path[0, 1]).max() > 0.05  # it has turned away from a person
    assert simulate(trial, 0).digest == episode.digest


@pytest.mark.program
def test_a_question_without_its_parts_is_answered_with_an_error(program):
    lines = '{"call":"begin"}\n{"call":"act","observation":{"goal":[1.0,0.0]}}\n{}\n'
    done = subprocess.run([program], input=lines, capture_output=True, text=True, timeout=20, check=True)
    assert done.stdout.splitlines() == [
        '{"ready":true}',
        '{"memory":""}',
        '{"error":"the question has no pose"}',
        '{"error":"the question has no call"}',
    ]
