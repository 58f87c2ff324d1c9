"""The rows of ``crowdbot bench`` about people who keep a gap to a robot."""

import json

import pytest

from crowdbot.benchmark import measure
from crowdbot.cli import main


@pytest.mark.parametrize(
    ("name", "against"),
    [
        ("people-robot-gap", "the same 100 people and robot with robot-gap=0"),
        ("people-robot", "the same 100 people without a robot"),
    ],
)
def test_a_step_around_a_robot_is_compared_with_one_of_the_same_run(name, against):
    (row,) = measure([name], 1)
    assert (row.name, row.unit, row.against) == (name, "agent-steps/s", against)
    assert row.median > 0.0
    assert 0.0 < row.ratio < float("inf")


def test_the_command_prints_both_rows(capsys):
    assert main(["bench", "people-robot-gap", "people-robot", "--repeats", "1", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert [row["name"] for row in rows] == ["people-robot-gap", "people-robot"]
