"""Recorded people as a crowd: where they were, when they were; reacting to a robot; one replaced by the robot."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import InputError, TrialError
from crowdbot.recording import run
from crowdbot.simulation import Simulation
from crowdbot.trials import (
    RecordedPeople,
    RobotGoal,
    RobotSpec,
    Trial,
    expand_spawners,
    load_trial,
    parse_trial,
    recorded_trial,
    trial_xml,
)
from samples import sample
from trial_texts import written

RECORDINGS = {
    "eth": ("eth_biwi/seq_eth/obsmat.txt", None, 60.0),
    "zara": ("eth_ucy_splits/all_data/crowds_zara01.txt", None, 60.0),
    "juelich": ("juelich/bottleneck/040_c_56_h-.txt", None, 30.0),
}
TRACK = "".join(f"{10 * k}\t{p}\t{0.5 * k + p}\t{p}\n" for k in range(30) for p in (0, 3))


@pytest.fixture
def track(tmp_path: Path) -> Path:
    """Two people who walk east side by side, 1.25 m/s, for 11.6 s."""
    return written(tmp_path, TRACK, "track.txt")


def farthest(trial: Trial) -> tuple[float, int]:
    """Return how far people ever are from their recording, and how many rows of it were looked at."""
    simulation = Simulation(trial, 0)
    walks = simulation.people.walks
    rows: dict[int, list[tuple[int, float, float]]] = {}
    for agent, walk in enumerate(walks):
        for t, (x, y) in zip(walk.time, walk.position, strict=True):
            tick = round(t / trial.step)
            if 0.0 <= t <= trial.duration:
                assert abs(tick * trial.step - t) < 1e-4, "a step ends at every frame"
                rows.setdefault(tick, []).append((agent, x, y))
    begins, ends = (np.array([walk.time[k] for walk in walks]) for k in (0, -1))
    worst, seen = 0.0, 0
    while True:
        scene = simulation.world.scene
        for agent, x, y in rows.get(simulation.tick, ()):
            assert scene.active[0, agent], (agent, simulation.tick)
            worst = max(worst, float(np.hypot(*(scene.position[0, agent] - [x, y]))))
            seen += 1
        now = simulation.world.clock.time
        inside = (begins - 1e-4 <= now) & (now <= ends + 1e-4)
        assert np.array_equal(scene.active[0, : len(walks)], inside)
        if simulation.tick >= trial.ticks:
            return worst, seen
        simulation.advance()


WHOLE = [("zara", 1, 5153), ("eth", 2, 8908), ("juelich", 1, 63110)]


@pytest.mark.parametrize(("name", "longer", "rows"), sample(WHOLE, 1, rows=True))
def test_everybody_is_where_the_whole_recording_has_them_at_every_frame(
    name: str, longer: int, rows: int, recordings: Path
) -> None:
    file, fps, _ = RECORDINGS[name]
    whole = recorded_trial(recordings / file, fps=fps)
    last = max(walk.time[-1] for walk in whole.recorded[0].walks(86_400.0))
    assert whole.duration == pytest.approx(last)
    worst, seen = farthest(dataclasses.replace(whole, step=longer * whole.step))
    assert worst < 1e-3
    assert seen == rows == len(whole.recorded[0].tracks())


def test_velocity_and_heading_are_those_of_the_recording(track: Path) -> None:
    simulation = Simulation(recorded_trial(track, fps=25.0), 0)
    for _ in range(30):
        simulation.advance()
    scene = simulation.world.scene
    assert np.allclose(scene.velocity[0], [[1.25, 0.0], [1.25, 0.0]])
    assert np.allclose(scene.heading, 0.0)
    assert not scene.external.any()


def robot(x: float, y: float, **more: object) -> RobotSpec:
    from crowdbot.navigation import Straight
    from crowdbot.world import DifferentialDrive

    whole = {"goal": RobotGoal(x + 9.0, y), "drive": DifferentialDrive(max_speed=0.02), "navigator": Straight()} | more
    return RobotSpec(x=x, y=y, **whole)


def with_robot(track: Path, mode: str, **more: object) -> Trial:
    """Return the two people with a robot that hardly moves, in the way of the first."""
    trial = recorded_trial(track, fps=25.0, mode=mode, near=4.0)
    return dataclasses.replace(
        trial, robots=[robot(8.0, 0.05, **more)], duration=25.0, end=dataclasses.replace(trial.end, collision=False)
    )


def test_scripted_people_go_through_a_robot_and_it_is_judged(track: Path) -> None:
    episode = run(with_robot(track, "scripted"))
    assert episode.metrics["collision"] == 1.0
    assert np.allclose(episode.position[:100:4, 0, 1], 0.0)


def test_reactive_people_go_round_the_robot_and_keep_their_destination(track: Path) -> None:
    trial = with_robot(track, "reactive")
    episode = run(trial)
    assert episode.metrics["collision"] == 0.0
    first = episode.position[episode.active[:, 0], 0]
    assert np.abs(first[:, 1]).max() > 0.3
    assert np.hypot(*(first[-1] - [14.5, 0.0])) < 0.35
    # the one who stays clear of it goes on as recorded until the robot is near
    before = episode.times < 2.0
    assert np.allclose(episode.position[before, 1, 1], 3.0)


def test_nobody_reacts_to_a_robot_that_people_do_not_see(track: Path) -> None:
    episode = run(with_robot(track, "reactive", visible=False))
    assert np.allclose(episode.position[episode.active[:, 0], 0, 1], 0.0)


@pytest.mark.parametrize("name", sample(RECORDINGS, ["zara"]))
def test_reactive_people_of_real_recordings_end_where_they_ended(name: str, recordings: Path) -> None:
    file, fps, seconds = RECORDINGS[name]
    trial = recorded_trial(recordings / file, fps=fps, mode="reactive", near=3.0)
    places = np.concatenate([walk.position for walk in trial.recorded[0].walks(seconds / 2)])
    x, y = np.median(places, axis=0)
    one = robot(float(x), float(y), control_period=4 * trial.step)
    trial = dataclasses.replace(trial, duration=seconds, robots=[one], seed=1)
    trial = dataclasses.replace(trial, end=dataclasses.replace(trial.end, goal=False, collision=False))
    simulation = Simulation(trial, 1)
    walks = simulation.people.walks
    last = np.full((len(walks), 2), np.nan)
    for _ in range(trial.ticks):
        before = simulation.world.scene
        simulation.advance()
        gone = before.active[0] & ~simulation.world.scene.active[0]
        for agent in np.flatnonzero(gone[: len(walks)]):
            last[agent] = before.position[0, agent]
    state = simulation.world.scene.memory["script"][0, : len(walks)]
    away = np.hypot(*(last - np.array([walk.position[-1] for walk in walks])).T)
    assert np.count_nonzero(state == 3.0) >= 3, "somebody met the robot and arrived"
    assert np.all(away[state == 3.0] < 0.5)


def test_a_robot_takes_the_place_of_somebody(track: Path, recordings: Path) -> None:
    trial = recorded_trial(track, fps=25.0, replace=3)
    (one,) = trial.robots
    assert (one.x, one.y, one.goal.position) == (3.0, 3.0, (17.5, 3.0))
    assert one.heading == pytest.approx(0.0)
    assert [walk.person for walk in trial.recorded[0].walks(20.0)] == [0]
    assert run(trial).outcome == "success"
    zara = recorded_trial(recordings / RECORDINGS["zara"][0], replace=10)
    begin = zara.recorded[0].begin
    assert begin > 0.0
    assert run(zara, seed=1).outcome in ("success", "collision", "timeout")
    with pytest.raises(InputError, match=r"nobody in track.txt has the id 4; ids go from 0 to 3"):
        recorded_trial(track, fps=25.0, replace=4)


def test_a_trial_lasts_as_long_as_the_recording(track: Path) -> None:
    assert recorded_trial(track, fps=25.0).duration == pytest.approx(11.6)
    replaced = recorded_trial(track, fps=25.0, replace=3)
    assert replaced.duration == pytest.approx(23.2)  # twice as long as the person walked
    rows = TRACK + "".join(f"{10 * k}\t9\t0\t{0.5 * k}\n" for k in range(200))
    long = recorded_trial(written(track.parent, rows, "long.txt"), fps=25.0, replace=3)
    assert long.duration == pytest.approx(79.6)  # to the end of the recording
    late = TRACK + "".join(f"{10 * k}\t9\t0\t{0.5 * k}\n" for k in range(100, 200))
    one = recorded_trial(written(track.parent, late, "late.txt"), fps=25.0, replace=9)
    assert (one.recorded[0].begin, one.duration) == (pytest.approx(40.0), pytest.approx(79.2))


def test_a_trial_of_recorded_people_is_a_file(track: Path) -> None:
    trial = recorded_trial(track, fps=25.0, replace=3)
    file = written(track.parent, trial_xml(trial))
    again = load_trial(file)
    assert again == trial
    assert run(again).digest == run(trial).digest
    assert expand_spawners(trial) == trial


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("track.txt", "none.txt", "t.xml:3: <recorded> data=\"none.txt\" there is no file 'none.txt'"),
        ("track.txt", "../../etc/passwd", "lies outside"),
        ("track.txt", "bad.txt", "bad.txt"),
        ('fps="25"', 'fps="25" exclude="8"', "exclude names person 8, who is not in track.txt"),
        ('fps="25"', 'fps="25" exclude="x"', 'exclude="x" must be whole numbers'),
        ('fps="25"', 'fps="25" begin="99"', "contains nobody after 99 s; use an earlier begin"),
        ('fps="25"', 'fps="25" mode="reactiv"', "must be scripted or reactive, did you mean 'reactive'?"),
        ('fps="25"', 'fps="25" crowd="calm"', 'crowd="calm" is not the name of a crowd'),
    ],
)
def test_wrong_recordings_are_told_with_their_line(track: Path, old: str, new: str, sentence: str) -> None:
    written(track.parent, b"\x00\xff" * 100, "bad.txt")
    text = '<trial name="t" duration="5">\n<crowd type="orca"/>\n<recorded data="track.txt" fps="25"/>\n</trial>'
    assert parse_trial(text, folder=track.parent).recorded == (RecordedPeople(data="track.txt", fps=25.0),)
    with pytest.raises(TrialError) as found:
        parse_trial(text.replace(old, new), place="t.xml", folder=track.parent)
    assert sentence in str(found.value)


def test_a_gap_in_a_track_is_an_absence(tmp_path: Path) -> None:
    rows = [k for k in range(40) if not 10 <= k < 20]
    file = written(tmp_path, "".join(f"{10 * k}\t1\t{0.5 * k}\t0\n" for k in rows), "gap.txt")
    trial = recorded_trial(file, fps=25.0)
    first, second = trial.recorded[0].walks(20.0)
    assert (first.time[-1], second.time[0]) == (pytest.approx(3.6), pytest.approx(8.0))
    assert farthest(trial)[0] < 1e-9
