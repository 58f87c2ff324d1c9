"""The table of people: definitions, and the same numbers live and from a recording."""

from __future__ import annotations

import csv
import dataclasses
import math

import numpy as np
import pytest

from crowdbot.metrics import PEOPLE_COLUMNS, AgentLog, PersonImpact, TableRobot, people_table
from crowdbot.recording import export, read_episode, run
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial, parse_trial
from space_trials import LEAN, room
from trial_texts import FLOW


def walk(absent: tuple[int, ...] = ()) -> AgentLog:
    """Return a log of a robot at rest and a person who walks past it along x at 1 m/s."""
    times = np.arange(0.0, 4.05, 0.1)
    place, velocity = np.zeros((len(times), 2, 2)), np.zeros((len(times), 2, 2))
    place[:, 1, 0], place[:, 1, 1], velocity[:, 1, 0] = times - 2.0, 0.4, 1.0
    active = np.ones((len(times), 2), dtype=bool)
    active[list(absent), 1] = False
    return AgentLog(times, place, velocity, np.zeros((len(times), 2)), np.full((len(times), 2), 0.3), active)


def test_a_walk_past_a_robot() -> None:
    table = people_table(walk(), [TableRobot(0, "robot")], [PersonImpact(1, 50.0, 0.3), PersonImpact(1, 20.0, 0.4)])
    assert list(table) == list(PEOPLE_COLUMNS)
    row = {name: float(column[0]) for name, column in table.items()}
    assert (row["id"], row["left"], row["contacts"]) == (1.0, 0.0, 1.0)
    assert math.isnan(row["time_to_leave"])
    assert row["distance_walked"] == pytest.approx(4.0)
    assert row["mean_speed"] == row["max_speed"] == 1.0
    assert row["mean_jerk"] == pytest.approx(0.0, abs=1e-9)
    assert row["min_clearance"] == pytest.approx(-0.2)
    assert row["intrusion_time"] == pytest.approx(3.5, abs=0.11)
    assert row["contact_time"] == pytest.approx(2.0 * math.sqrt(0.36 - 0.16), abs=0.11)
    assert (row["peak_force"], row["max_severity"]) == (50.0, 0.4)


def test_who_leaves_and_who_is_away_for_a_while() -> None:
    gone = people_table(walk(tuple(range(31, 41))), [])  # agent 0 is a person, too
    assert gone["left"].tolist() == [0.0, 1.0]
    assert gone["time_to_leave"].tolist() == pytest.approx([math.nan, 3.0], nan_ok=True)
    assert np.isnan(gone["min_clearance"]).all()
    assert np.isnan(gone["peak_force"]).all()
    away = people_table(walk((10, 11, 12)), [])
    assert away["time_present"].tolist() == pytest.approx([4.0, 3.6])
    assert away["distance_walked"].tolist() == pytest.approx([0.0, 3.6])
    assert np.isnan(away["mean_jerk"]).tolist() == [False, True]


def test_a_ghost_has_clearances_but_no_contacts() -> None:
    table = people_table(walk(), [TableRobot(0, "robot", ghost=True)])
    assert table["min_clearance"][0] < 0.0
    assert (table["contacts"][0], table["contact_time"][0]) == (0.0, 0.0)


def test_nobody_gives_an_empty_table() -> None:
    table = people_table(walk(tuple(range(41))), [TableRobot(0, "robot")])
    assert all(len(column) == 0 for column in table.values())


@pytest.mark.parametrize("world", ["planar", pytest.param("physics", marks=pytest.mark.needs("mujoco"))])
def test_a_recording_has_the_numbers_of_its_run(world: str, tmp_path) -> None:
    text = FLOW if world == "planar" else room("physics", LEAN)
    trial = dataclasses.replace(parse_trial(text), duration=4.0)
    episode = run(trial, 1, out=tmp_path)
    recorded = read_episode(tmp_path / "episode.mcap")
    assert list(episode.people) == list(recorded.people)
    for name, column in episode.people.items():
        assert column == pytest.approx(recorded.people[name], abs=1e-9, nan_ok=True), name
    assert np.isnan(episode.people["peak_force"]).all() == (world == "planar")
    assert export(tmp_path / "episode.mcap", tmp_path / "persons.csv", "persons") == len(episode.people["id"])
    with (tmp_path / "persons.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["min_clearance"]) for row in rows] == pytest.approx(recorded.people["min_clearance"].tolist())


def test_the_smallest_clearance_is_that_of_the_metrics() -> None:
    episode = simulate(load_trial("circle-crossing", duration=8.0), 0)
    assert min(episode.people["min_clearance"]) == pytest.approx(episode.metrics["min_clearance"])
    assert sum(episode.people["contacts"]) == episode.metrics["contacts"]


def test_several_robots_have_a_column_each() -> None:
    trial = load_trial("frontal", duration=1.0)
    other = dataclasses.replace(trial.robots[0], name="other", y=trial.robots[0].y + 3.0)
    people = simulate(dataclasses.replace(trial, robots=(*trial.robots, other)), 0).people
    both = np.minimum(people[f"{trial.robots[0].name}.min_clearance"], people["other.min_clearance"])
    assert people["min_clearance"].tolist() == both.tolist()
