"""Drawings from above show uneven ground, and doors at their current angle."""

from __future__ import annotations

import re

import numpy as np
import pytest

from crowdbot.evaluation.worst_run import _plan
from crowdbot.simulation import DoorOrder, Simulation, simulate
from crowdbot.trials import Door, Platform, Ramp, Stage, Stairs, Threshold, floor_plan, parse_trial

TEXT = """<trial name="d" duration="0.2" world="physics">
  <stage walkable="-1,-2 9,-2 9,2 -1,2">
    <ramp x="1" y="0" length="2" width="1" height="0.16"/>
    <wall points="3,-2 3,-0.5"/><wall points="3,0.5 3,2"/>
    <door name="hall" points="3,-0.5 3,0.5"/>
  </stage>
  <crowd type="orca"/>
  <agent name="p" x="5" y="0.3" goal="8,0"/>
</trial>
"""


def test_every_part_of_the_ground_is_drawn() -> None:
    stage = Stage(
        ground=(
            Ramp(x=2, y=0, length=4, width=2, height=0.3),
            Stairs(x=8, y=0, steps=3),
            Platform(x=0, y=5, length=2, width=1),
            Threshold(x=0, y=0, bevel=0.02),
        )
    )
    lines = floor_plan(stage)
    # an outline for each part, and an arrow for the ramp, both bevels and the stairs
    assert len(lines) == (1 + 3 + 1 + 3) + 4
    assert lines[-1].points[[0, 1, 4]].tolist() == pytest.approx(np.array([[7.652, 0], [8.348, 0], [8.348, 0]]))
    arrow = lines[1].points
    assert arrow[1].tolist() == pytest.approx([3.6, 0.0])
    assert np.isnan(arrow[2]).all()


@pytest.mark.parametrize(
    ("share", "end"), [(0.0, [0, 1]), (1.0, [-1, 0]), (-1.0, [1, 0]), (0.5, [-(0.5**0.5), 0.5**0.5])]
)
def test_a_hinged_door_is_drawn_at_its_angle(share: float, end: list[float]) -> None:
    stage = Stage(doors=(Door(name="hall", points=[(0, 0), (0, 1)]),))
    arc, leaf = floor_plan(stage, {"hall": share})
    assert leaf.points[1] == pytest.approx(end, abs=1e-9)
    assert arc.points[-1] == pytest.approx([1, 0] if share < 0 else [-1, 0], abs=1e-9)


def test_a_sliding_door_that_is_open_at_the_start_is_short() -> None:
    _, leaf = floor_plan(Stage(doors=(Door(name="hall", points=[(0, 0), (0, 1)], kind="sliding", open=True),)))
    assert leaf.points.tolist() == [[0.0, 0.0], [0.0, 0.0]]


def _paths(drawing: str) -> list[str]:
    return re.findall(r'<path d="([^"]*)"', drawing)


def test_trials_episodes_and_simulations_show_ground_and_doors() -> None:
    trial = parse_trial(TEXT.encode())
    assert "#b08d57" in trial._repr_svg_()
    episode = simulate(trial, 0)
    assert "#2a7f9e" in episode._repr_svg_()
    simulation = Simulation(trial, [0, 1])
    before = _paths(simulation._repr_svg_())
    DoorOrder(door="hall").apply(simulation)
    for _ in range(6):
        simulation.advance()
    after = _paths(simulation._repr_svg_())
    assert before[:3] == after[:3]
    assert before[3] != after[3], "the leaf has turned"


def test_the_worst_runs_of_an_evaluation_show_ground_and_doors() -> None:
    plan = _plan(simulate(parse_trial(TEXT.encode()), 0))
    # ramp, shaft and head of its arrow; arc and leaf of the door
    assert [line["color"] for line in plan] == ["#b08d57"] * 3 + ["#2a7f9e"] * 2
    assert plan[-1]["points"] == [[3.0, -0.5], [3.0, 0.5]]
    assert len(plan[2]["points"]) == 3
