"""Runs: outcomes, the order of a step, rates, and the same bytes for the same trial and seed."""

from __future__ import annotations

import dataclasses
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import InputError, Scene, TrialError, Twist
from crowdbot.metrics import NAVIGATION_METRICS
from crowdbot.models import ORCA
from crowdbot.navigation import Navigator, Observation, Straight
from crowdbot.recording import read_episode, run
from crowdbot.sensors import Gaussian, Lidar2D, Scan
from crowdbot.simulation import Episode, EpisodeLog, RunFailureWarning, Simulation, StopRequest, run_to_end
from crowdbot.simulation.world_builder import start_scenes
from crowdbot.trials import (
    Mount,
    PeopleBatch,
    RobotGoal,
    RobotSpec,
    Spawner,
    Stage,
    Trial,
    Wall,
    load_trial,
    parse_trial,
    place,
)
from crowdbot.world import DifferentialDrive
from samples import sample
from trial_texts import GOOD

TINY = parse_trial(GOOD)


@dataclasses.dataclass(frozen=True)
class Spy(Navigator):
    """Goes to its goal and writes down what it was told."""

    told: list[Observation] = dataclasses.field(default_factory=list)

    def act(self, observation: Observation) -> Twist:
        self.told.append(observation)
        return observation.towards_goal(1.0)


def robot(**changes: object) -> RobotSpec:
    given = {
        "x": -2.0,
        "y": 0.0,
        "goal": RobotGoal(2.0, 0.0),
        "drive": DifferentialDrive(),
        "navigator": Straight(),
    }
    return RobotSpec(**(given | changes))  # type: ignore[arg-type]


def person(x: float, y: float, goal: tuple[float, float], **changes: object) -> Spawner:
    """Make one person who stands at a place, to a hair."""
    (a, b), e = goal, 1e-6
    return Spawner(
        count=1,
        zone=[(x, y), (x + e, y), (x + e, y + e)],
        goal=[(a, b), (a + e, b), (a + e, b + e)],
        **changes,  # type: ignore[arg-type]
    )


def trial(**changes: object) -> Trial:
    given = {"name": "t", "duration": 8.0, "crowd": ORCA(), "robots": [robot()]}
    return Trial(**(given | changes))  # type: ignore[arg-type]


def test_a_robot_alone_reaches_its_goal() -> None:
    episode = run(trial())
    away = np.hypot(*(episode.position[:, 0] - [2.0, 0.0]).T)
    assert episode.outcome == "success"
    assert away[-1] < 0.3
    assert np.all(away[:-1] >= 0.3)
    assert episode.times[0] == 0.0
    assert np.allclose(np.diff(episode.times), 0.1, atol=1e-12)
    assert episode.steps == round(episode.times[-1] / 0.05)
    assert (episode.robots, episode.ids.tolist()) == ((0,), [0])
    assert set(episode.metrics) == set(NAVIGATION_METRICS)
    assert (episode.metrics["success"], episode.metrics["timeout"]) == (1.0, 0.0)
    assert episode.metrics["time_to_goal"] == pytest.approx(episode.times[-1])


def test_time_runs_out() -> None:
    episode = run(trial(duration=2.0))
    assert (episode.outcome, episode.times[-1], episode.steps) == ("timeout", 2.0, 40)
    assert np.isnan(episode.metrics["time_to_goal"])


def test_a_wall_is_touched_even_by_a_fast_robot() -> None:
    drive = DifferentialDrive(max_speed=60.0, max_acceleration=1e4)
    thin = Stage(walls=[Wall([(0.0, -1.0), (0.0, 1.0)])])
    fast = robot(drive=drive, navigator=Fast(), goal=RobotGoal(40.0, 0.0), radius=0.05)
    episode = run(trial(stage=thin, robots=[fast]))
    assert episode.outcome == "collision"
    assert episode.metrics["min_wall_clearance"] < 0.0


@dataclasses.dataclass(frozen=True)
class Mute(Navigator):
    def act(self, observation: Observation) -> Twist:
        return None  # type: ignore[return-value]


def test_a_navigator_that_says_nothing_is_named() -> None:
    sentence = "navigator Mute of robot 'robot' returned a NoneType, it must return a Twist"
    with pytest.warns(RunFailureWarning, match=sentence):
        episode = run(trial(robots=[robot(navigator=Mute())]))
    assert (episode.outcome, len(episode.times)) == ("error", 1)
    assert episode.failure is not None
    assert episode.failure.message == f"InputError: {sentence}"


@dataclasses.dataclass(frozen=True)
class Fast(Navigator):
    def act(self, observation: Observation) -> Twist:
        return Twist(60.0)


def test_a_person_is_touched_and_the_run_ends_or_goes_on() -> None:
    standing = person(0.0, 0.0, (0.0, 0.0), arrival="stay")
    blind = robot(visible=False)
    first = run(trial(spawners=[standing], robots=[blind]))
    assert first.outcome == "collision"
    assert first.metrics["collision"] == 1.0
    assert first.metrics["min_clearance"] < 0.0
    assert first.times[-1] < 3.5
    on = dataclasses.replace(TINY.end, collision=False)
    second = run(trial(spawners=[standing], robots=[blind], end=on))
    assert (second.outcome, second.metrics["success"]) == ("collision", 0.0)
    assert second.times[-1] == 8.0
    assert np.array_equal(second.position[: len(first.times)], first.position)


def test_people_walk_leave_or_stay() -> None:
    leaving = person(0.0, 2.0, (3.0, 2.0), speed=1.5)
    staying = person(0.0, -2.0, (3.0, -2.0), speed=1.5, arrival="stay")
    episode = run(trial(spawners=[leaving, staying], robots=[], duration=5.0))
    assert (episode.outcome, episode.robots, episode.metrics) == ("finished", (), {})
    assert episode.active[0].all()
    assert episode.active[-1].tolist() == [False, True]
    gone = int(np.argmin(episode.active[:, 0]))
    assert 1.7 <= episode.times[gone] <= 2.1
    assert not episode.position[gone:, 0].any()
    assert np.allclose(episode.position[-1, 1], [3.0, -2.0], atol=0.05)
    assert np.allclose(episode.velocity[0], [[1.5, 0.0], [1.5, 0.0]], atol=1e-5)
    tracks = episode.tracks()
    assert (tracks.dt, tracks.ids.tolist(), tracks.robots) == (0.4, [0, 1], frozenset())
    assert len(tracks) == int(episode.active[::4].sum())


def test_an_invisible_robot_changes_nobody_and_a_visible_one_does() -> None:
    walker = person(3.0, 0.1, (-3.0, 0.1), speed=1.2)
    crowd = [run(trial(spawners=[walker], robots=bots)) for bots in ([], [robot(visible=False)], [robot()])]
    count = min(len(episode.times) for episode in crowd)
    alone, unseen, seen = (episode.position[:count, 0] for episode in crowd)
    assert np.array_equal(alone, unseen)
    assert not np.array_equal(alone, seen)


def test_adding_sensors_and_robots_with_sensors_does_not_change_the_crowd() -> None:
    more = dataclasses.replace(
        TINY.robots[0],
        sensors=[
            *TINY.robots[0].sensors,
            Mount(name="back", heading=3.0, sensor=Lidar2D(rays=20, noise=Gaussian(0.1))),
        ],
    )
    episodes = [run(dataclasses.replace(TINY, robots=[bot]), seed=5) for bot in (TINY.robots[0], more)]
    assert np.array_equal(episodes[0].position, episodes[1].position)
    one, two = (episode.readings["robot/scan"] for episode in episodes)
    assert all(np.array_equal(a.ranges, b.ranges) for a, b in zip(one, two, strict=True))  # type: ignore[attr-defined]
    assert list(episodes[1].readings) == ["robot/scan", "robot/back"]
    assert episodes[0].digest != episodes[1].digest


def test_sensors_navigators_and_recorders_keep_their_rates() -> None:
    told: list[Observation] = []
    bot = robot(
        navigator=Spy(told),
        control_period=0.2,
        goal=RobotGoal(9.0, 0.0),
        sensors=[Mount(sensor=Lidar2D(rate=4.0)), Mount(name="slow", sensor=Lidar2D(rate=1.0))],
    )
    episode = run(trial(robots=[bot], duration=3.0, recording=dataclasses.replace(TINY.recording, period=0.15)))
    assert np.allclose([seen.time for seen in told], np.arange(16) * 0.2)
    assert np.allclose(episode.times, np.arange(21) * 0.15)
    assert [reading.time for reading in episode.readings["robot/slow"]] == [0.0, 1.0, 2.0, 3.0]
    assert np.allclose([scan.time for scan in episode.scans], np.arange(13) * 0.25)
    assert {seen.dt for seen in told} == {0.2}
    held = [told[int(t / 0.2 + 1e-9)].towards_goal(1.0) for t in episode.times]
    assert np.array_equal(episode.commands[:, 0], np.array(held))


def test_a_navigator_knows_the_people_its_scan_hit_and_no_others() -> None:
    told: list[Observation] = []
    wall = Stage(walls=[Wall([(1.0, 0.5), (1.0, 3.0)])])
    hidden, open_, far = person(3.0, 1.5, (3.0, 9.0)), person(3.0, -2.0, (3.0, -9.0)), person(30.0, 0.0, (40.0, 0.0))
    bot = robot(navigator=Spy(told), sensors=[Mount(sensor=Lidar2D(rays=720, range_max=10.0), x=0.2)])
    episode = run(trial(stage=wall, spawners=[hidden, open_, far], robots=[bot], duration=0.1))
    assert set(episode.scans[0].hit.tolist()) == {-2, -1, 1}
    assert np.array_equal(told[0].people.position, episode.position[0, [1]])
    assert np.array_equal(told[0].people.velocity, episode.velocity[0, [1]])
    assert told[0].scan is episode.readings["robot/scan"][0]
    assert episode.scans[0].pose == (-1.8, 0.0, 0.0)
    blind: list[Observation] = []
    run(trial(spawners=[open_], robots=[robot(navigator=Spy(blind))], duration=0.1))
    assert (len(blind[0].people), blind[0].scan) == (0, None)


def test_a_navigator_gets_the_scan_of_the_first_laser_scanner() -> None:
    told: list[Observation] = []
    lasers = [Mount(name="front", sensor=Lidar2D(rays=30)), Mount(name="back", heading=3.0, sensor=Lidar2D(rays=20))]
    run(trial(robots=[robot(navigator=Spy(told), sensors=lasers)], duration=0.1))
    scan = told[0].scan
    assert isinstance(scan, Scan)
    assert scan.ranges.shape == (1, 30)


def test_two_robots_see_each_other_and_share_the_outcome() -> None:
    lidar = [Mount(sensor=Lidar2D(rays=180))]
    bots = [
        robot(name="a", sensors=lidar),
        robot(name="b", x=2.0, y=1.5, heading=np.pi, goal=RobotGoal(-2.0, 1.5), sensors=lidar),
    ]
    episode = run(trial(robots=bots))
    assert (episode.outcome, episode.robots) == ("success", (0, 1))
    assert 1 in episode.readings["a/scan"][0].hit  # type: ignore[attr-defined]
    assert episode.metrics["b.path_length"] > 3.0
    assert {"path_length", "b.success"} <= set(episode.metrics)


def same(episode: Episode, two: Episode) -> bool:
    arrays = ("times", "position", "velocity", "heading", "active", "twists", "commands")
    return episode.digest == two.digest and all(np.array_equal(getattr(episode, n), getattr(two, n)) for n in arrays)


def test_the_digest_is_that_of_the_bytes() -> None:
    first, again, other = run(TINY), run(TINY, seed=3), run(TINY, seed=4)
    assert same(first, again)
    assert first.digest != other.digest
    assert len(first.digest) == 32
    assert not np.array_equal(first.position, other.position)
    moved = dataclasses.replace(TINY, robots=[dataclasses.replace(TINY.robots[0], x=-2.0 + 1e-15 * 4)])
    assert run(moved).digest != first.digest


@pytest.mark.program
@pytest.mark.parametrize("threads", sample(["1", "2"], 1))
def test_another_process_gives_the_same_digest(threads: str) -> None:
    code = (
        "import sys; from crowdbot.recording import run; from crowdbot.trials import parse_trial;"
        " print(run(parse_trial(sys.stdin.read())).digest)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        input=GOOD,
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "NUMBA_NUM_THREADS": threads, "PYTHONHASHSEED": threads},
    )
    assert done.stdout.strip() == run(TINY).digest


def test_a_trial_stepped_from_outside_gives_the_same_digest() -> None:
    log = EpisodeLog(TINY, 3)
    simulation = Simulation(TINY, 3)
    assert run_to_end(simulation, [log], StopRequest()) == log.episode("timeout", 80).outcome
    assert log.episode("timeout", simulation.tick).digest == run(TINY).digest


def test_progress_is_told_from_nothing_to_all() -> None:
    shares: list[float] = []
    run(TINY, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert len(shares) > 10


def test_ctrl_c_keeps_what_is_done() -> None:
    def press(share: float) -> None:
        if 0.49 < share < 0.505:
            signal.raise_signal(signal.SIGINT)

    before = signal.getsignal(signal.SIGINT)
    episode = run(TINY, progress=press)
    assert (episode.outcome, episode.times[-1], episode.steps) == ("interrupted", 2.1, 42)
    assert (episode.metrics["success"], episode.metrics["collision"], episode.metrics["timeout"]) == (0.0, 0.0, 0.0)
    whole = run(TINY)
    assert np.array_equal(whole.position[:22], episode.position)
    assert signal.getsignal(signal.SIGINT) is before


def test_a_second_ctrl_c_stops_at_once(tmp_path: Path) -> None:
    def press(share: float) -> None:
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        run(TINY, out=tmp_path / "deep" / "out", progress=press)
    assert [path.name for path in (tmp_path / "deep" / "out").iterdir()] == ["episode.mcap"]
    assert not read_episode(tmp_path / "deep" / "out" / "episode.mcap").complete


def test_a_run_outside_the_main_thread_leaves_signals_alone() -> None:
    episodes: list[Episode] = []
    thread = threading.Thread(target=lambda: episodes.append(run(TINY)))
    thread.start()
    thread.join()
    assert episodes[0].digest == run(TINY).digest


def test_an_impossible_seed_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    tight = [(0, 0), (1.2, 0), (1.2, 1.2), (0, 1.2)]
    crowded = trial(spawners=[Spawner(name="s", count=5, zone=tight, goal=tight, radius=0.25)], robots=[])
    bad = next(seed for seed in range(500) if place(crowded.stage, crowded.spawners, [], seed)[1])
    with pytest.raises(TrialError, match=r"trial 't': spawner 's' only \d of 5 people fit"):
        run(crowded, seed=bad, out=tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_tracks_need_a_multiple_of_the_recording_period() -> None:
    episode = run(trial(duration=1.0))
    assert episode.tracks(0.2).dt == pytest.approx(0.2)
    with pytest.raises(InputError, match=r"recorded every 0.1 s, dt must be a multiple"):
        episode.tracks(0.25)
    for times in (episode.times, np.append(episode.times[:-1], 1e9)):  # a damaged file may have any time
        with pytest.raises(InputError, match=r"recorded every 0.1 s, dt must be a multiple"):
            dataclasses.replace(episode, times=times).tracks(0.01 if times is episode.times else 0.1)


def test_the_scene_begins_with_people_who_walk_to_their_goals() -> None:
    people, _ = place(TINY.stage, TINY.spawners, TINY.robots, 3)
    scene = start_scenes(TINY, PeopleBatch.of([people]), np.array([0]), TINY.stage.as_walls())
    assert isinstance(scene, Scene)
    assert scene.external[0].tolist() == [False] * 4 + [True]
    assert np.allclose(np.hypot(*scene.velocity[0, :4].T), people.speed)
    ahead = np.sum(scene.velocity[0, :4] * (people.goal - people.position), axis=1)
    assert np.all(ahead > 0.0)
    assert scene.goal[0, 4].tolist() == [3.0, -2.4]


@pytest.mark.parametrize("name", sample(["crossing-flows", "frontal", "empty-corridor"], 2))
def test_the_robot_succeeds_in_the_built_in_trials(name: str) -> None:
    episode = run(load_trial(name))
    assert episode.outcome == "success"
    assert episode.metrics["min_clearance"] > 0.02


def test_crossing_flows_is_a_two_way_flow_around_the_robot() -> None:
    episode = run(load_trial("crossing-flows"))
    assert episode.position.shape[1] == 41
    assert 15.0 < episode.times[-1] < 35.0
    robot = episode.robots[0]
    assert episode.position[0, robot, 1] < -3.0
    assert episode.position[-1, robot, 1] > 3.0
    for k in range(0, 3 * len(episode.times) // 4, 20):  # at the end, people have passed
        near = episode.active[k] & (np.abs(episode.position[k, :, 0] - episode.position[k, robot, 0]) < 12.0)
        near[robot] = False
        along = episode.velocity[k, near, 0]
        assert np.sum(along > 0.3) >= 2, episode.times[k]
        assert np.sum(along < -0.3) >= 2, episode.times[k]
