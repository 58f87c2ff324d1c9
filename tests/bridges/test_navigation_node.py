"""The reference navigation node of the examples: its planner, and the node as a process over rosbridge."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bridge_runs import serve

from crowdbot.trials import load_trial

FOLDER = Path(__file__).parents[2] / "examples" / "robot_bridge"
sys.path.insert(0, str(FOLDER))
from local_planner import CELL, HALF, LocalPlanner  # noqa: E402

ANGLES = np.linspace(-math.pi, math.pi, 361)


def scan_of(points):
    """Return ranges of a full scan that sees points (x, y) of a robot at the origin."""
    ranges = np.full(len(ANGLES), np.inf)
    for x, y in points:
        beam = int(np.argmin(np.abs(ANGLES - math.atan2(y, x))))
        ranges[beam] = min(ranges[beam], math.hypot(x, y))
    return ranges


@pytest.mark.parametrize(("goal", "sign"), [((5.0, 0.0), 0), ((2.0, 2.0), 1), ((2.0, -2.0), -1)])
def test_without_obstacles_it_drives_to_the_goal(goal, sign):
    speed, turn = LocalPlanner().command(np.full(361, np.inf), -math.pi, math.radians(1), goal)
    assert speed > 0.2
    assert np.sign(round(turn, 1)) == sign


def test_the_path_goes_around_a_wall():
    wall = [(1.5, y) for y in np.arange(-1.0, 2.5, 0.02)]
    planner = LocalPlanner()
    clearance = planner.clearance(scan_of(wall), -math.pi, math.radians(1))
    path = planner.path(clearance, (2.8, 0.0))
    assert path[-1] == (28, 0)
    assert min(y for _, y in path) * CELL < -1.0
    assert all(clearance[x + HALF, y + HALF] >= planner.radius - CELL for x, y in path[3:])


def test_a_closed_ring_has_no_path():
    ring = [(0.6 * math.cos(a), 0.6 * math.sin(a)) for a in ANGLES]
    speed, turn = LocalPlanner().command(scan_of(ring), -math.pi, math.radians(1), (5.0, 0.0))
    assert speed < 0.1
    assert turn != 0.0


def test_the_node_drives_a_robot_through_people_over_rosbridge(tmp_path):
    trial = load_trial("frontal", duration=40.0)
    running, server = serve(trial, rate=2.0, out=tmp_path)
    goal = trial.robots[0].goal
    command = [sys.executable, FOLDER / "navigate_rosbridge.py", "--port", str(server.port or 0)]
    with running:
        command[-1] = str(server.port)
        done = subprocess.run(
            [*command, "--goal", f"{goal.x},{goal.y}"], capture_output=True, text=True, timeout=100, check=True
        )
        summary = running.end()
    assert summary.outcome == "success", (done.stdout, summary.metrics)
    assert "commands" in done.stdout
