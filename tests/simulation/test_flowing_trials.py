"""Trials in which people find their way, go on journeys, come in and go out, and walk by several models."""

from __future__ import annotations

import dataclasses
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from crowdbot import data, world
from crowdbot.core import Scene, Twist
from crowdbot.metrics import NAVIGATION_METRICS
from crowdbot.models import ORCA, Mixture, SocialForce
from crowdbot.navigation import Navigator, Observation, Straight
from crowdbot.recording import read_episode, replay, run
from crowdbot.sensors import Lidar2D
from crowdbot.simulation import Episode, Simulation
from crowdbot.trials import (
    Crowds,
    Direction,
    End,
    Exit,
    Journey,
    Mount,
    Point,
    RobotGoal,
    RobotSpec,
    Routing,
    SourceSpec,
    Spawner,
    Stage,
    Trial,
    Wall,
    Zone,
    load_trial,
    parse_trial,
)
from crowdbot.world import DifferentialDrive, PlanarWorld
from trial_texts import FLOW

WHOLE = parse_trial(FLOW)
DOOR = Stage(walls=[Wall([(0, -50), (0, 3)]), Wall([(0, 4.5), (0, 5)])])


def box(x: float, y: float, width: float = 1.0, height: float = 1.0) -> list[tuple[float, float]]:
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def trial(**changes: object) -> Trial:
    return Trial(**({"name": "t", "duration": 20.0, "crowd": ORCA()} | changes))  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Episode]:
    """Return a file and the episode it was written from, in which places are used again."""
    folder = tmp_path_factory.mktemp("flow")
    return folder / "episode.mcap", run(WHOLE, out=folder)


def whole_tracks(episode: Episode) -> bool:
    """Whether everybody comes once, goes once, and walks without a jump in between."""
    for agent in range(len(episode.ids)):
        there = np.flatnonzero(episode.active[:, agent])
        steps = np.hypot(*np.diff(episode.position[there, agent], axis=0).T)
        if np.any(np.diff(there) > 1) or np.any(steps > 0.35):
            return False
    return True


def test_everybody_has_a_column_although_places_are_used_again(recorded: tuple[Path, Episode]) -> None:
    _, episode = recorded
    simulation = Simulation(WHOLE, WHOLE.seed)
    people = len(episode.ids) - 1
    assert people > 20
    assert simulation.world.scene.shape[1] == 11, "10 people and a robot at a time"
    assert episode.ids.tolist() == list(range(people + 1))
    assert (episode.robots, WHOLE.people) == ((4,), 4)
    assert episode.active[:, 4].all()
    assert whole_tracks(episode)
    assert np.all((episode.radius > 0.0) == episode.active.any(axis=0))
    assert episode.active.sum(axis=1).max() <= 11
    assert set(episode.metrics) == set(NAVIGATION_METRICS)
    begin = [int(np.argmax(episode.active[:, who])) for who in range(5, people + 1) if episode.radius[who] > 0.0]
    assert begin == sorted(begin)


def test_a_recording_of_a_flow_is_the_episode(recorded: tuple[Path, Episode]) -> None:
    path, episode = recorded
    read = read_episode(path)
    for name in ("times", "active", "ids", "radius", "commands", "position"):
        assert np.array_equal(getattr(read, name), getattr(episode, name)), name
    assert np.allclose(read.velocity, episode.velocity, rtol=0, atol=1e-12)
    assert read.robots == episode.robots
    assert parse_trial(read.xml) == WHOLE
    for item, two in ((read.tracks(), episode.tracks()), (read.tracks(0.1), data.load(path))):
        assert np.array_equal(item.x, two.x)
        assert np.array_equal(item.id, two.id)
        assert np.array_equal(item.frame, two.frame)
        assert item.robots == two.robots == frozenset([4])
    for scan, two in zip(read.scans, episode.scans, strict=True):
        assert np.array_equal(scan.hit, two.hit)


def test_a_flow_replays_to_the_same_bytes(recorded: tuple[Path, Episode]) -> None:
    path, episode = recorded
    done = replay(path)
    assert done.equal
    assert done.replayed == episode.digest


@pytest.mark.program
def test_a_flow_is_the_same_in_another_process_with_one_thread(recorded: tuple[Path, Episode]) -> None:
    code = (
        "import sys; from crowdbot.recording import run; from crowdbot.trials import parse_trial;"
        " print(run(parse_trial(sys.stdin.read())).digest)"
    )
    env = {**os.environ, "NUMBA_NUM_THREADS": "1", "PYTHONHASHSEED": "1"}
    done = subprocess.run([sys.executable, "-c", code], input=FLOW, capture_output=True, text=True, check=True, env=env)
    assert done.stdout.strip() == recorded[1].digest


def test_scans_name_whom_they_hit(recorded: tuple[Path, Episode]) -> None:
    _, episode = recorded
    known: set[int] = set()
    for scan in episode.scans:
        k = round(scan.time * 10)
        hit = np.unique(scan.hit[scan.hit >= 0])
        known |= set(hit.tolist())
        assert episode.active[k, hit].all()
        for who in hit.tolist():
            rays = np.flatnonzero(scan.hit == who)
            x, y, heading = scan.pose
            angle = scan.angles[rays] + heading
            there = np.stack([x + scan.ranges[rays] * np.cos(angle), y + scan.ranges[rays] * np.sin(angle)], axis=-1)
            away = np.hypot(*(there - episode.position[k, who]).T)
            assert np.allclose(away, episode.radius[who], atol=1e-6)
    assert max(known) > 10


def test_the_report_shows_everybody(recorded: tuple[Path, Episode], tmp_path: Path) -> None:
    from crowdbot.evaluation import PredictionResult, score_predictor, write_demo_report
    from crowdbot.prediction import ConstantVelocity

    _, episode = recorded
    past, future = episode.tracks().windows(8, 12, near=8.0)
    row = PredictionResult(ConstantVelocity().predict(past, 12), score_predictor(ConstantVelocity(), past, future))
    page = write_demo_report(tmp_path / "report.html", episode, past, future, [row], {}, "").read_text(encoding="utf-8")
    assert f"<b>{len(episode.ids) - 1}</b><span>people" in page


def test_people_find_the_door_with_routing_only() -> None:
    walker = Spawner(count=3, zone=box(-4, -2), goal=box(3, -2), speed=1.3)
    without = run(trial(stage=DOOR, spawners=[walker]))
    led = run(trial(stage=DOOR, spawners=[walker], routing=Routing()))
    assert without.active[-1].all()
    assert np.all(without.position[-1, :, 0] < 0.0)
    assert not led.active[-1].any()
    crossing = np.argmax(led.position[:, :, 0] > 0.0, axis=0)
    assert np.all(led.position[crossing, np.arange(3), 1] > 3.0)
    assert np.all(led.velocity[0, :, 1] > 0.5), "they set off towards the door"


def test_journeys_lead_from_stop_to_stop() -> None:
    around = Journey(name="around", then="stay", stops=[Point(0, 3), Zone(box(5, 2.5)), Point(5, -1, tolerance=0.2)])
    away = Journey(name="away", stops=[Direction(np.pi)])
    spawners = [Spawner(count=1, zone=box(0, 0, 0.1, 0.1), journey="around", speed=1.5),
                Spawner(count=1, zone=box(-2, 0, 0.1, 0.1), journey="away", speed=1.0)]  # fmt: skip
    episode = run(trial(journeys=[around, away], spawners=spawners))
    path = episode.position[:, 0]
    reached = [int(np.argmax(np.hypot(*(path - place).T) < 0.5)) for place in ([0, 3], [5, 3], [5, -1])]
    assert 0 < reached[0] < reached[1] < reached[2]
    assert np.allclose(path[-1], [5, -1], atol=0.05)
    assert episode.active.all()
    assert episode.position[-1, 1, 0] == pytest.approx(-22.0, abs=0.2)
    assert episode.velocity[0].round(6).tolist()[1] == [-1.0, 0.0]
    leaving = dataclasses.replace(around, then="leave")
    assert run(trial(journeys=[leaving, away], spawners=spawners)).active[-1].tolist() == [False, True]


def test_people_leave_by_exits_and_robots_stay() -> None:
    walker = Spawner(count=2, zone=box(0, 0), goal=box(9, 0), speed=1.0)
    bot = RobotSpec(x=3, y=-3, goal=RobotGoal(4, 3), drive=DifferentialDrive(), navigator=Straight(), visible=False)
    way = Exit(zone=box(3, -4, 2, 9))
    episode = run(trial(spawners=[walker], robots=[bot], exits=[way], end=End(False, False)))
    last = [int(np.flatnonzero(episode.active[:, who])[-1]) for who in (0, 1)]
    assert all(2.8 < episode.position[k, who, 0] < 3.0 for who, k in enumerate(last))
    assert episode.active[:, 2].all()


def test_people_come_in_by_sources() -> None:
    evenly = SourceSpec(
        zone=box(0, 0, 1, 4), goal=box(9, 0, 1, 4), rate=0.5, timing="regular", begin=1.0, end=9.5, speed=1.0
    )
    episode = run(trial(sources=[evenly]))
    come = [float(episode.times[np.argmax(column)]) for column in episode.active.T]
    assert come == pytest.approx([1.0, 3.0, 5.0, 7.0, 9.0])
    assert (episode.outcome, episode.robots, episode.ids.tolist()) == ("finished", (), [0, 1, 2, 3, 4])
    assert not episode.active[-1].all()
    stay = run(trial(sources=[dataclasses.replace(evenly, arrival="stay", max_count=2)], duration=15.0))
    assert stay.active[-1].tolist() == [True, True]
    nobody = run(trial(sources=[dataclasses.replace(evenly, max_count=0)]))
    assert nobody.position.shape == (201, 0, 2)


def test_people_of_a_spawner_and_a_source_do_not_leave_for_one_another() -> None:
    """Who takes the place of somebody with a goal zone is not sent out in that zone."""
    first = Spawner(count=1, zone=box(0, 0, 0.1, 0.1), goal=box(2, 0), speed=1.5)
    through = Journey(name="through", then="stay", stops=[Point(6, 0.5)])
    second = SourceSpec(
        zone=box(-1, 0), journey="through", rate=1.0, timing="regular", begin=4.0, max_count=1, speed=1.5
    )
    episode = run(trial(spawners=[first], sources=[second], journeys=[through], capacity=1, duration=12.0))
    assert episode.active[-1].tolist() == [False, True]
    assert episode.position[-1, 1] == pytest.approx([6.0, 0.5], abs=0.1)
    assert int(np.argmax(episode.active[:, 1])) == 40


def test_the_capacity_keeps_people_outside() -> None:
    fast = SourceSpec(zone=box(0, 0, 3, 4), goal=box(9, 0, 1, 4), rate=3.0)
    full = run(trial(sources=[fast], capacity=4))
    free = run(trial(sources=[fast]))
    assert full.active.sum(axis=1).max() == 4
    assert free.active.sum(axis=1).max() > 8
    assert full.position.shape[1] > 8
    assert whole_tracks(full)


def test_people_walk_by_the_model_of_their_crowd() -> None:
    crowds = Crowds((ORCA(), SocialForce()), names=("calm", "hurried"))
    zones = {"calm": box(-3, 0, 1, 3), "hurried": box(3, 0, 1, 3)}
    spawners = [Spawner(count=3, zone=zones[name], goal=zones[other], crowd=name)
                for name, other in (("hurried", "calm"), ("calm", "hurried"))]  # fmt: skip
    both = trial(crowd=crowds, spawners=spawners, duration=2.0)
    start = Simulation(both, 0).world.scene
    by_hand = PlanarWorld(start, Mixture((ORCA(), SocialForce()), [1, 1, 1, 0, 0, 0]), {}, 0.05)
    for _ in range(40):
        by_hand.step({})
    episode = run(both)
    assert np.array_equal(episode.position[-1], by_hand.scene.position[0])
    named = dataclasses.replace(both, spawners=[dataclasses.replace(s, crowd="calm") for s in spawners])
    default = dataclasses.replace(both, spawners=[dataclasses.replace(s, crowd="") for s in spawners])
    alone = dataclasses.replace(default, crowd=ORCA())
    assert run(named).digest == run(default).digest == run(alone).digest != episode.digest


def test_people_of_a_source_walk_by_the_model_of_their_crowd() -> None:
    crowds = Crowds((ORCA(), SocialForce()), names=("calm", "hurried"))
    one = SourceSpec(zone=box(0, 0), goal=box(9, 0), rate=1.0, timing="regular", crowd="hurried", max_count=3)
    simulation = Simulation(trial(crowd=crowds, sources=[one]), 0)
    for _ in range(60):
        simulation.advance()
    scene = simulation.world.scene
    assert scene.memory["model"][0, scene.active[0]].tolist() == [1.0, 1.0, 1.0]


def test_the_world_is_as_the_trial_says() -> None:
    made = Simulation(WHOLE, 1).world
    assert made.contact == world.ContactModel("force", 50.0, 4)
    assert made.limits == world.CrowdLimits(2.5, 5.0)
    assert made.router is not None
    assert (made.router.radius, made.router.unreachable) == (0.25, "nearest")
    assert (made.robot_margin, made.heading_jitter, made.substeps) == (0.2, 0.001, 2)
    assert made.exits == WHOLE.exits
    plain = Simulation(trial(), 1).world
    assert (plain.contact, plain.limits, plain.router, plain.journeys) == (None, None, None, None)
    assert (plain.robot_margin, plain.heading_jitter, plain.substeps, plain.exits) == (0.1, 0.0, 1, ())


@dataclasses.dataclass(frozen=True)
class Spy(Navigator):
    """Stands and writes down what it was told."""

    told: list[Observation] = dataclasses.field(default_factory=list)

    def act(self, observation: Observation) -> Twist:
        self.told.append(observation)
        return Twist()


def test_an_old_scan_does_not_show_who_took_the_place_of_somebody() -> None:
    told: list[Observation] = []
    lidar = Mount(sensor=Lidar2D(rays=180, range_max=5.0, rate=0.25))
    bot = RobotSpec(x=0, y=0, goal=RobotGoal(0, 50), drive=DifferentialDrive(), navigator=Spy(told), sensors=[lidar])
    near = Spawner(count=1, zone=box(2, 0, 0.1, 0.1), goal=box(2, 3), speed=1.5)
    far = SourceSpec(zone=box(40, 0), goal=box(60, 0), rate=1.0, timing="regular", max_count=1, speed=1.0)
    episode = run(trial(spawners=[near], sources=[far], robots=[bot], capacity=1, duration=3.9))
    seen = {len(item.people) for item in told}
    assert seen == {0, 1}
    assert all(np.all(item.people.position[:, 0] < 10.0) for item in told)
    assert episode.active[-1].tolist() == [False, True, True]


@pytest.mark.parametrize("name", ["bottleneck", "two-crowds"])
def test_built_in_flows_flow(name: str) -> None:
    given = load_trial(name, {"end/goal": False, "duration": 30})
    episode = run(given)
    assert (episode.outcome, episode.metrics["success"]) == ("success", 1.0)
    assert len(episode.ids) > given.people + 3
    assert whole_tracks(episode)
    gone = episode.active.any(axis=0) & ~episode.active[-1]
    assert gone.sum() >= 3
    assert isinstance(Simulation(given, 2).world.scene, Scene)
