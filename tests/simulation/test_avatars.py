"""Avatars: people whose pose comes from a file, a function or orders, in both worlds."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import InputError, TrialError, without_running_code
from crowdbot.recording import branch, open_run, read_episode, replay
from crowdbot.simulation import (
    AvatarOrder,
    MoveOrder,
    Order,
    RemoveOrder,
    Simulation,
    SimulationRun,
    read_order,
    write_order,
)
from crowdbot.trials import Trial, check_trial, expand_spawners, load_trial, parse_trial, trial_xml

ROBOT = '<robot name="robot" type="pepper" {0} x="0" y="0"><goal x="6" y="0"/><navigator type="straight"/>{1}</robot>'
LIDAR = '<sensor name="lidar" type="lidar2d" rate="10"/>'
CIRCLE = """
import math
from dataclasses import dataclass
from crowdbot.humans import BodyPose, PoseSource

@dataclass(frozen=True)
class Circle(PoseSource):
    def at(self, time):
        x, y = 3.0 + math.cos(time), 2.0 + math.sin(time)
        return BodyPose(x, y, time + 0.5 * math.pi, right_hand=(x, y, 1.9, 1, 0, 0, 0))
"""


def text(avatar: str, world: str = "planar", robot: str = 'default-sensors="false"', sensor: str = "") -> str:
    return f"""<trial name="guided" duration="2" world="{world}"><stage/><crowd type="orca"/>
<agent x="5" y="0.6" goal="-5,0.6"/><agent x="-3" y="2" goal="5,2"/>{avatar}
{ROBOT.format(robot, sensor)}<end collision="false"/></trial>"""


EXTERNAL = '<avatar name="guide" source="external" x="2" y="1" heading="3" body="man-20" {0}/>'
TRIALS = {world: parse_trial(text(EXTERNAL.format(""), world)) for world in ("planar", "physics")}
WITH_CAMERAS = {world: parse_trial(text(EXTERNAL.format(""), world, robot="")) for world in ("planar", "physics")}
"""Trials in which cameras see the body of the avatar."""


def slot(trial: Trial) -> int:
    return len(trial.agents)


def sample(time: float, environment: int = 0, **how: float) -> AvatarOrder:
    """Return a sample of a person who walks back and forth in front of the robot, one hand up."""
    x, y = 2.0 + 0.5 * math.sin(2.0 * time + environment), 1.0 - 0.8 * time
    hand = (x - 0.2, y + 0.2, 1.8, 1.0, 0.0, 0.0, 0.0)
    return AvatarOrder(avatar="guide", time=time, x=x, y=y, heading=3.0, right_hand=hand, environment=environment)


class Walk:
    """A source that gives the pose of the next step, with jitter in rate and order that depends on the tick only."""

    def orders(self, simulation: Simulation) -> list[Order]:
        step = simulation.trial.step
        found: list[Order] = []
        for e, tick in enumerate(simulation.ticks.tolist()):
            if tick % 7 != 3:
                found += [sample((tick + k) * step, e) for k in (1.0, 0.4)]
        return found


def test_the_scene_has_the_pose_of_the_sample_for_its_time() -> None:
    trial = TRIALS["planar"]
    run = SimulationRun(Simulation(trial))
    for tick in range(1, 30):
        order = sample(tick * trial.step)
        run.step([order])
        scene = run.simulation.record().scene
        assert scene.position[0, slot(trial)].tolist() == [order.x, order.y]
        assert not scene.external[0, slot(trial)]
    now = sample(29 * trial.step)
    run.step([dataclasses.replace(now, x=5.0, y=3.0, right_hand=None, time=None)])
    last = run.simulation.world.scene
    assert last.position[0, slot(trial)] == pytest.approx([5.0, 3.0], abs=1e-9)


def test_the_record_of_an_instant_has_the_sample_of_that_instant() -> None:
    seen: list[list[float]] = []

    class Sink:
        def take(self, frame: object) -> None:
            seen.append(frame.scene.position[0, 2].tolist())  # type: ignore[attr-defined]

    run = SimulationRun(Simulation(TRIALS["planar"]), [Sink()])
    run.step([AvatarOrder(avatar="guide", x=4.0, y=4.0)])
    assert seen[0] == [4.0, 4.0]


def test_the_velocity_is_that_of_the_samples_and_ends_after_the_timeout() -> None:
    trial = TRIALS["planar"]
    run = SimulationRun(Simulation(trial))
    run.step([AvatarOrder(avatar="guide", time=0.05 * k, x=2.0, y=1.0 + 0.05 * k) for k in (0, 1, 2)])
    speeds, places = [], []
    for _ in range(12):
        speeds.append(float(run.simulation.world.scene.velocity[0, 2, 1]))
        places.append(float(run.simulation.world.scene.position[0, 2, 1]))
        run.step()
    assert speeds[:6] == pytest.approx([1.0] * 6)
    assert speeds[6:] == [0.0] * 6
    assert places[-1] == pytest.approx(1.0 + 0.1 + 0.25)
    assert run.simulation.world.scene.active[0, 2]


def test_a_delay_shows_the_samples_later() -> None:
    trial = parse_trial(text(EXTERNAL.format('delay="0.2"')))
    run = SimulationRun(Simulation(trial))
    for tick in range(20):
        run.step([sample(tick * trial.step)])
    late = sample(16 * trial.step)
    assert run.simulation.world.scene.position[0, 2] == pytest.approx([late.x, late.y], abs=1e-9)


def test_people_avoid_an_avatar_and_lidar_sees_it() -> None:
    """An avatar that stands in the way of a person is passed; the scanner of the robot hits its id."""
    trial = parse_trial(text('<avatar name="post" source="external" x="2" y="0.6" timeout="0"/>', sensor=LIDAR))
    run = SimulationRun(Simulation(dataclasses.replace(trial, duration=6.0)))
    least, hit = math.inf, False
    while run.outcome is None:
        run.step()
        scene = run.simulation.world.scene
        least = min(least, float(np.hypot(*(scene.position[0, 0] - scene.position[0, 2]))))
        hit |= any(2 in getattr(reading, "hit", np.zeros(0)) for _, _, reading in run.simulation.new_readings())
    assert least > 0.45
    assert hit


@pytest.mark.parametrize("world", ["planar", "physics"])
def test_a_steered_run_replays_and_branches_to_the_byte(world: str, tmp_path: Path) -> None:
    trial = dataclasses.replace(WITH_CAMERAS[world], duration=1.0)
    with open_run(trial, out=tmp_path / "one", sources=[Walk()]) as running:
        while running.outcome is None:
            running.step()
    path = tmp_path / "one" / "episode.mcap"
    assert replay(path).equal
    branch(path, at=0.5, out=tmp_path / "two")
    assert replay(tmp_path / "two" / "episode.mcap").equal
    assert read_episode(tmp_path / "two" / "episode.mcap").digest == read_episode(path).digest
    with open_run(trial, out=tmp_path / "three", sources=[Walk()]) as running:
        running.hold()
        running.go()
        running.advance()
    assert (tmp_path / "three" / "episode.mcap").read_bytes() == path.read_bytes()


def state(simulation: Simulation, e: int) -> list[list[float]]:
    scene = simulation.world.environment_scene(e)
    return [part[0].tolist() for part in (scene.position, scene.velocity, scene.heading)]


@pytest.mark.parametrize("world", ["planar", "physics"])
def test_environments_are_those_of_single_runs_and_copies_continue(world: str) -> None:
    trial, steps = TRIALS[world], 20 if world == "planar" else 8
    many = SimulationRun(Simulation(trial, range(4)), sources=[Walk()])
    for _ in range(steps):
        many.step()
    for e in (0, 2):
        alone = SimulationRun(Simulation(trial, e))
        for tick in range(steps):
            orders = [sample((tick + k) * trial.step, e) for k in (1.0, 0.4)] if tick % 7 != 3 else []
            alone.step([dataclasses.replace(order, environment=0) for order in orders])
        assert state(many.simulation, e) == state(alone.simulation, 0)
    some = many.simulation.select([3, 1, 1])
    before = state(many.simulation, 1)
    for run in (SimulationRun(some), many):
        run.step()
    assert state(many.simulation, 1) != before
    fork = some.select([0, 2])
    some.put([1], fork.select([0]))
    assert state(some, 1) == state(some, 0)


def test_snapshots_are_independent_of_later_samples() -> None:
    run = SimulationRun(Simulation(TRIALS["planar"]))
    for tick in range(5):
        run.step([sample((tick + 1) * 0.05)])
    snapshot = run.snapshot()
    first = []
    for _ in range(2):
        for tick in range(5, 12):
            run.step([sample((tick + 1) * 0.05)])
        first.append(state(run.simulation, 0))
        run.restore(snapshot)
        run.step([AvatarOrder(avatar="guide", x=9.0, y=9.0)])
        run.restore(snapshot)
    assert first[0] == first[1]


def test_a_file_moves_an_avatar_and_belongs_to_the_episode(tmp_path: Path) -> None:
    rows = "".join(f"{0.1 * k},{2 + 0.1 * k},1,0\n" for k in range(30))
    (tmp_path / "walk.csv").write_text("time,x,y,heading\n" + rows)
    (tmp_path / "t.xml").write_text(text('<avatar name="guide" source="file" file="walk.csv" begin="0.5"/>'))
    trial = load_trial(tmp_path / "t.xml")
    assert parse_trial(trial_xml(trial), folder=tmp_path) == trial
    run = SimulationRun(Simulation(trial, range(3)))
    for _ in range(11):
        run.step()
    assert run.simulation.world.scene.position[:, 2] == pytest.approx(np.array([[2.0 + 0.5 + 0.55, 1.0]] * 3))
    assert run.simulation.world.scene.velocity[:, 2] == pytest.approx(np.array([[1.0, 0.0]] * 3))
    with open_run(trial, out=tmp_path / "elsewhere" / "one") as running:
        running.advance()
    (tmp_path / "walk.csv").unlink()
    assert replay(tmp_path / "elsewhere" / "one" / "episode.mcap").equal


def test_a_function_moves_an_avatar_and_its_code_is_needed_for_a_replay(tmp_path: Path) -> None:
    (tmp_path / "circle.py").write_text(CIRCLE)
    (tmp_path / "t.xml").write_text(text('<avatar name="guide" source="function" function="circle.py:Circle"/>'))
    trial = load_trial(tmp_path / "t.xml")
    with open_run(trial, out=tmp_path / "one") as running:
        running.advance()
        scene = running.simulation.world.scene
    now = trial.ticks * trial.step
    assert scene.position[0, 2] == pytest.approx([3.0 + math.cos(now), 2.0 + math.sin(now)])
    assert scene.velocity[0, 2] == pytest.approx([-math.sin(now), math.cos(now)], abs=0.02)
    path = tmp_path / "one" / "episode.mcap"
    with pytest.raises(InputError, match="needs the code"):
        replay(path)
    assert replay(path, trust=True).equal
    assert replay(path, folder=tmp_path).equal


def test_a_function_that_fails_ends_its_run(tmp_path: Path) -> None:
    code = CIRCLE.replace("        x, y", "        if time > 0.5: raise ValueError('lost')\n        x, y", 1)
    (tmp_path / "circle.py").write_text(code)
    (tmp_path / "t.xml").write_text(text('<avatar name="guide" source="function" function="circle.py:Circle"/>'))
    run = SimulationRun(Simulation(load_trial(tmp_path / "t.xml")))
    assert run.advance() == "error"
    assert "lost" in str(run.failure)


def test_nobody_is_touched_on_the_way_of_a_teleport() -> None:
    for world in ("planar", "physics"):
        trial = TRIALS[world]
        run = SimulationRun(Simulation(trial))
        run.step([AvatarOrder(avatar="guide", time=0.0, x=0.2, y=2.0)])
        run.step([AvatarOrder(avatar="guide", time=0.1, x=0.2, y=-2.0)])
        for _ in range(3):
            run.step()
            assert run.simulation.contacts() == ()
        assert run.simulation.world.scene.position[0, 2].tolist() == [0.2, -2.0]


def test_a_contact_pushes_the_robot_and_not_the_avatar() -> None:
    """An avatar walks against a robot that stands: the robot is moved, the avatar keeps to its samples."""
    still = (
        '<robot name="robot" type="turtlebot2" x="0" y="0"><goal x="6" y="0"/>'
        '<navigator type="straight" speed="0.01"/></robot>'
    )
    trial = parse_trial(
        f"""<trial name="push" duration="3" world="physics"><stage/><crowd type="orca"/>
        <avatar name="guide" source="external" x="1" y="0" heading="3.14159"/>{still}<end collision="false"/></trial>"""
    )
    run = SimulationRun(Simulation(trial))
    force = 0.0
    for tick in range(1, 50):
        time = tick * trial.step
        run.step([AvatarOrder(avatar="guide", time=time, x=1.0 - 0.5 * time, y=0.0, heading=math.pi)])
        world = run.simulation.world
        assert world.scene.position[0, 0].tolist() == [1.0 - 0.5 * time, 0.0]
        force = max([force, *(float(np.linalg.norm(force.force)) for force in world.forces)])
    assert 5.0 < force < 5000.0
    assert float(run.simulation.world.scene.position[0, 1, 0]) < -0.05


def test_orders_round_trip_and_are_checked() -> None:
    order = sample(0.1)
    assert read_order(write_order(order)) == order
    simulation = Simulation(TRIALS["planar"])
    wrong: Sequence[tuple[Order, str]] = [
        (AvatarOrder(avatar="gide", x=0, y=0), "there is no avatar 'gide', did you mean 'guide'"),
        (AvatarOrder(avatar="guide", x=0, y=0, time=11.0), "more than 10 s after the current 0 s"),
        (AvatarOrder(avatar="guide", x=0, y=0, environment=1), "environment = 1 must be from 0 to 0"),
        (RemoveOrder(person=2), "2 is the id of avatar 'guide'"),
        (MoveOrder(person=2, x=0.0, y=0.0), "2 is the id of avatar 'guide'"),
    ]
    for item, message in wrong:
        with pytest.raises(InputError, match=message):
            item.check(simulation)
    for values, message in (
        ('"x": 0, "y": 0, "head": [1]', "head must be 7 numbers"),
        ('"x": NaN, "y": 0', "x = nan must be a finite number"),
        ('"x": 0, "y": 0, "head": "up"', "head = 'up' must be of type"),
        ('"x": 0, "y": 0, "time": Infinity', "time = inf must be a finite number"),
    ):
        with pytest.raises(InputError, match=message):
            read_order(f'{{"order": "avatar", "avatar": "guide", {values}}}')


@pytest.mark.parametrize(
    ("avatar", "message"),
    [
        ('name="a" source="external" x="1"', "needs x and y"),
        ('name="a" source="file"', 'source="file" needs the attribute file'),
        ('name="a" source="external" x="1" y="1" file="bad.csv"', 'needs source="file"'),
        ('name="a" source="file" file="a.csv"', "there is no file 'a.csv'"),
        ('name="a" source="file" file="../a.csv"', "lies outside"),
        ('name="a" source="function" function="circle.py:Square"', "is not a concrete PoseSource"),
        ('name="a" source="function" function="circle.py:Circle" x="1"', "the function gives the place"),
        ('name="a" source="headset"', "must be file or function or external"),
        ('name="a" source="external" x="1" y="1"/><avatar name="a" source="external" x="3" y="1"', "already used"),
        ('name="a" source="file" file="bad.csv"', "bad.csv:2: x = 'far' must be a finite number"),
    ],
)
def test_wrong_avatars_are_refused(avatar: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "circle.py").write_text(CIRCLE)
    (tmp_path / "bad.csv").write_text("time,x,y\n0,far,0\n")
    (tmp_path / "t.xml").write_text(text(f"<avatar {avatar}/>"))
    with pytest.raises(TrialError) as told:
        load_trial(tmp_path / "t.xml")
    assert message in str(told.value)


def test_avatars_are_kept_when_spawners_become_agents_and_never_leave() -> None:
    zone = '<spawner count="3" zone="-4,-4 -2,-4 -2,-2" goal="2,1 4,1 4,3"/><exit zone="1,0 3,0 3,2 1,2"/>'
    trial = parse_trial(text(EXTERNAL.format("") + zone))
    whole = expand_spawners(trial)
    assert len(whole.avatars) == 1
    assert len(whole.agents) == 5
    check_trial(whole)
    run = SimulationRun(Simulation(trial))
    for _ in range(10):
        run.step()
    assert run.simulation.world.scene.active[0, 5]
    assert run.simulation.world.scene.position[0, 5].tolist() == [2.0, 1.0]
    assert not run.simulation.world.scene.external[0, 5]


@pytest.mark.parametrize("world", ["planar", "physics"])
def test_the_bodies_of_a_replay_have_the_hand_where_it_was(world: str) -> None:
    trial = TRIALS[world]
    simulation = Simulation(trial, posed=True)
    run = SimulationRun(simulation)
    for tick in range(1, 8):
        order = AvatarOrder(
            avatar="guide", time=tick * 0.05, x=2, y=1, heading=math.pi, right_hand=(1.7, 1.3, 1.7, 0, 0, 0, 1)
        )
        run.step([order])
    people = simulation.world.people
    assert people is not None
    wrist = people.posture().position[slot(trial), 16]
    assert np.linalg.norm(wrist - (1.7, 1.3, 1.7)) < 0.01
    hand = people.ends[slot(trial), 13]  # the capsule of the right hand
    assert min(np.linalg.norm(hand[:3] - wrist), np.linalg.norm(hand[3:] - wrist)) < 0.15
    assert np.ptp(people.skin(2)[slot(trial), :, 2]) > 1.7


def test_environments_restart_with_their_avatars_at_the_start() -> None:
    run = SimulationRun(Simulation(TRIALS["planar"], range(3)), sources=[Walk()])
    for _ in range(10):
        run.step()
    run.simulation.restart([1], seeds=[1])
    place = run.simulation.world.scene.position[:, 2]
    assert place[1].tolist() == [2.0, 1.0]
    assert place[0].tolist() != [2.0, 1.0]
    fresh = Simulation(TRIALS["planar"], 1)
    fresh.begin()
    fresh.advance()
    run.simulation.advance()
    assert state(run.simulation, 1) == state(fresh, 0)


def test_a_trial_with_a_function_is_checked_without_running_code(tmp_path: Path) -> None:
    (tmp_path / "circle.py").write_text(CIRCLE + "\nraise SystemExit('code was run')\n")
    with without_running_code():
        avatar = '<avatar name="guide" source="function" function="circle.py:Circle"/>'
        trial = parse_trial(text(avatar), folder=tmp_path)
        with pytest.raises(TrialError, match=r"Square is not a concrete PoseSource"):
            parse_trial(text(avatar.replace(":Circle", ":Square")), folder=tmp_path)
    assert trial.avatars[0].function == "circle.py:Circle"


def test_a_trial_ends_when_only_avatars_are_left() -> None:
    trial = parse_trial(
        """<trial name="alone" duration="20"><stage/><crowd type="orca"/><agent x="0" y="0" goal="2,0"/>
        <avatar name="guide" source="external" x="0" y="3"/><end empty="true"/></trial>"""
    )
    run = SimulationRun(Simulation(trial))
    assert run.advance() == "finished"
    assert run.simulation.tick < 100


def test_a_file_that_stands_for_a_time_and_hands_that_come_and_go(tmp_path: Path) -> None:
    rows = [
        {"time": 0.0, "x": 2.0, "y": 1.0},
        {"time": 0.5, "x": 2.0, "y": 1.0, "left_hand": [2.2, 1.3, 1.5, 1, 0, 0, 0]},
        {"time": 1.0, "x": 2.0, "y": 1.0},
    ]
    (tmp_path / "walk.jsonl").write_text("\n".join(map(json.dumps, rows)))
    trial = parse_trial(text('<avatar name="guide" source="file" file="walk.jsonl" height="1.9"/>'), folder=tmp_path)
    simulation = Simulation(trial, posed=True)
    assert simulation.world.people is not None
    assert simulation.world.people.people.height[2] == 1.9
    reached = []
    for _ in range(24):
        wrist = simulation.world.people.posture().position[2, 9]
        reached.append(bool(np.linalg.norm(wrist - (2.2, 1.3, 1.5)) < 0.01))
        simulation.advance()
    assert reached == [False] * 10 + [True] * 10 + [False] * 4
