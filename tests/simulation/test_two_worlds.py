"""The same trial in both worlds: every built-in one, digests, what sensors see, who is who."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import ExternalClock, InputError, MissingExtra, TrialError
from crowdbot.recording import branch, open_run, read_episode, record, replay, run
from crowdbot.sensors import Lidar2D, RgbImage, TrackedPeople
from crowdbot.simulation import Order, Simulation, SimulationRun, run_to_end
from crowdbot.simulation.simulation import COLLISION
from crowdbot.trials import (
    Trial,
    builtin_trials,
    expand_spawners,
    expand_sweeps,
    load_trial,
    parse_trial,
    people_appearance,
    trial_xml,
)
from samples import sample
from space_trials import LEAN, ROOM, WORLDS, room
from trial_schema import valid

STEPS = {"planar": 40, "physics": 20}


def short(name: str, world: str) -> Trial:
    """A built-in trial in a world, over after a few steps."""
    trial = load_trial(name, world=world)
    first = expand_sweeps(trial)[0] if trial.sweeps else trial
    period = first.recording.period
    return dataclasses.replace(first, duration=max(period, math.ceil(STEPS[world] * first.step / period) * period))


SOME = ("crossing-flows", "empty-corridor", "frontal", "bottleneck", "object-handover", "challenge-cross-50")


@pytest.mark.parametrize("name", sample(builtin_trials(), SOME))
def test_every_builtin_trial_runs_in_both_worlds_and_is_recorded(name: str, tmp_path: Path) -> None:
    for world in WORLDS:
        trial = short(name, world)
        done = record(trial, out=f"{tmp_path}/{world}")
        assert done.steps == trial.ticks or done.outcome in ("collision", "success")
        read = read_episode(f"{tmp_path}/{world}/episode.mcap")
        assert ('world="physics"' in read.metadata["trial"]) == (world == "physics")
        assert read.digest == done.digest


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("world", sample(WORLDS, ["physics"]))
def test_the_same_seed_gives_the_same_bytes_however_time_passes(world: str, tmp_path: Path) -> None:
    trial = parse_trial(room(world))
    once = run(trial, out=f"{tmp_path}/free")
    with open_run(trial, out=f"{tmp_path}/outside", clock=ExternalClock(trial.step)) as running:
        now = 0
        while running.outcome is None:
            now += 37_000_001
            running.until(now)
    files = [(tmp_path / name / "episode.mcap").read_bytes() for name in ("free", "outside")]
    assert files[0] == files[1]
    assert replay(f"{tmp_path}/free/episode.mcap", trust=True).equal
    later = branch(f"{tmp_path}/free/episode.mcap", at=0.52)
    assert later.digest == once.digest


def test_a_room_with_everything_is_the_identity_and_valid() -> None:
    trial = parse_trial(ROOM)
    assert parse_trial(trial_xml(trial)) == trial
    assert trial_xml(parse_trial(trial_xml(trial))) == trial_xml(trial)
    assert valid(trial_xml(trial))
    whole = expand_spawners(trial)
    assert parse_trial(trial_xml(whole)) == whole
    assert valid(trial_xml(whole))


@pytest.mark.parametrize("world", WORLDS)
def test_explicit_people_have_the_same_bodies(world: str) -> None:
    trial = parse_trial(room(world, LEAN))
    simulations = [Simulation(item, 4, posed=True) for item in (trial, expand_spawners(trial, 4))]
    casts = [
        people_appearance(simulation.trial, simulation.people, simulation.world.scene.shape[1], 4)
        for simulation in simulations
    ]
    assert [person.name for person in casts[0].people.persons] == [person.name for person in casts[1].people.persons]
    assert casts[0].people.variation.tolist() == casts[1].people.variation.tolist()
    assert casts[0].activity == casts[1].activity
    assert casts[0].people.persons[0].name == "woman-36"
    assert casts[0].people.variation[0] == 3
    assert casts[0].activity[:2] == ("walk", "phone")
    assert run(trial, 4).digest == run(expand_spawners(trial, 4)).digest


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("world", WORLDS)
def test_readings_of_the_room(world: str) -> None:
    episode = run(parse_trial(room(world)))
    found = episode.readings
    pictures = found["pepper/eyes"]
    assert isinstance(pictures[0], RgbImage)
    assert pictures[0].rgb.shape == (1, 24, 32, 3)
    assert pictures[0].hit is not None
    assert {item for picture in pictures for item in np.unique(picture.hit)} >= {-2, -3, 0}
    assert len(found["pepper/laser_rear"][0].angles) == 31  # type: ignore[attr-defined]
    assert len(found["pepper/laser_front"][0].angles) == 481  # type: ignore[attr-defined]
    near = found["pepper/depth"][0]
    assert near.pose.position[0, 2] == pytest.approx(1.0, abs=0.01)
    told = found["pepper/people"][-1]
    assert isinstance(told, TrackedPeople)
    assert told.ids() == [0, 1, 2, 3, 4, 6]
    turning = found["pepper/imu"][-1].acceleration  # type: ignore[attr-defined]
    assert np.isfinite(turning).all()
    with_people = {item for cloud in found["pepper/rings"] for item in np.unique(cloud.hit)}  # type: ignore[attr-defined]
    assert {-4, -3, -2} <= with_people
    assert with_people & {0, 1, 2, 3, 4}


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("world", WORLDS)
def test_readings_arrive_late_and_keep_their_instant(world: str) -> None:
    simulation = Simulation(parse_trial(room(world)), 4)
    arrived = []

    class Listener:
        def orders(self, simulation: Simulation) -> list[Order]:
            for _, mount, reading in simulation.new_readings():
                if mount.name == "wheels":
                    arrived.append((simulation.tick, round(reading.time / 0.04)))
            return []

    running = SimulationRun(simulation, sources=[Listener()])
    while simulation.tick < 6:
        running.step()
    assert arrived == [(k + 2, k) for k in range(5)]


def test_a_late_drive_follows_late_in_the_plane() -> None:
    trial = parse_trial(LEAN)
    simulation = Simulation(trial, 4)
    running = SimulationRun(simulation)
    moving = []
    for _ in range(5):
        running.step()
        moving.append(float(simulation.world.twists[simulation.robots[0].agent].forward[0]) > 0.0)
    assert moving == [False, False, False, True, True]


def test_flat_lasers_see_discs_unless_asked_for_limbs() -> None:
    lasers = {}
    for bodies in ("discs", "limbs", "skins"):
        scans = run(parse_trial(room(text=LEAN, bodies=bodies))).readings["puck/scan"]
        lasers[bodies] = scans[5].ranges[0]  # type: ignore[attr-defined]
    assert not np.array_equal(lasers["discs"], lasers["limbs"])
    assert not np.array_equal(lasers["skins"], lasers["limbs"])
    default = run(parse_trial(LEAN)).readings["puck/scan"][5].ranges[0]  # type: ignore[attr-defined]
    assert np.array_equal(default, lasers["discs"])
    physical = run(parse_trial(room("physics", LEAN))).readings["puck/scan"][5]
    assert physical.pose.position.shape == (1, 3)


def test_props_are_solid_in_the_plane_and_have_bodies_in_physics() -> None:
    lines = LEAN.splitlines()
    text = "\n".join(line for line in lines if not line.startswith(("  <agent", "  <spawner", "  <tree", "  <table")))
    for world in WORLDS:
        trial = parse_trial(text.replace('seed="4"', f'seed="4" world="{world}" bodies="discs"').replace(
            'duration="1"', 'duration="4"').replace('<end collision="false"', '<end collision="true"'))  # fmt: skip
        episode = run(trial)
        assert episode.outcome == "collision"
        touching = episode.position[-1, episode.robots[0]]
        assert touching[0] == pytest.approx(4.0 - 0.3 - 0.3, abs=0.05)
        scans = episode.readings["puck/scan"]
        assert scans[0].ranges[0, 30] == pytest.approx(1.7, abs=0.01)  # type: ignore[attr-defined]


@pytest.mark.parametrize("world", WORLDS)
def test_a_ray_above_a_cube_passes_over_it(world: str) -> None:
    simulation = Simulation(parse_trial(room(world, LEAN, bodies="limbs")), 4)
    robot = simulation.robots[0].agent
    low, high = (
        Lidar2D(rays=1).read(simulation.around.space(0).without(robot), simulation.world.pose(robot).to_spatial(height))
        for height in (0.3, 1.2)
    )
    assert low.ranges[0, 0] == pytest.approx(1.7)  # from x = 2 m to the cube of 0.6 m around x = 4 m
    assert high.ranges[0, 0] > 4.0


def test_a_cube_is_pushed_in_physics() -> None:
    lines = [
        line for line in LEAN.splitlines() if not line.startswith(("  <agent", "  <spawner", "  <tree", "  <table"))
    ]
    text = "\n".join(lines).replace('x="4" y="2" size="0.6" fixed="true"', 'x="4" y="2.2" size="0.6"')
    trial = parse_trial(text.replace('seed="4"', 'seed="4" world="physics"').replace('duration="1"', 'duration="4"'))
    simulation = Simulation(trial, 4)
    running = SimulationRun(simulation)
    while running.outcome is None:
        running.step()
    world: object = simulation.world
    assert world.prop(0)[0, 3] > 4.3  # type: ignore[attr-defined]
    scan = next(sensor for sensor in simulation.robots[0].sensors if sensor.name == "scan").reading(0)
    assert scan.ranges[0, 30] < 0.7  # type: ignore[attr-defined]
    wall = [contact for contact in simulation.contacts() if contact.other == -2]
    assert not wall


def test_collisions_and_forces_are_told_once() -> None:
    text = LEAN.replace(
        '<agent x="6" y="4" goal="1,4" body="woman-36" outfit="3"/>', '<agent x="3" y="2.2" heading="0"/>'
    )
    trial = parse_trial(text.replace('seed="4"', 'seed="4" world="physics"').replace('duration="1"', 'duration="3"'))
    simulation = Simulation(trial, 4)
    frames = []

    class Keeper:
        def take(self, frame: object) -> None:
            frames.append(frame)

    from crowdbot.simulation import StopRequest

    run_to_end(simulation, [Keeper()], StopRequest())
    told = [collision for frame in frames for collision in frame.collisions]
    world: object = simulation.world
    assert sorted(map(repr, told)) == sorted(map(repr, world.contact_events))  # type: ignore[attr-defined]
    assert told
    forced = {frame.nanoseconds / 1e9 for frame in frames if frame.forces}
    assert forced
    for item in told:  # forces are stamped with the ends of their steps, of which some are in the collision
        assert 0.0 <= item.begin < item.end <= 3.0 + 1e-9
        assert min(abs(stamp - item.begin) for stamp in forced) <= trial.step + 1e-9
        assert any(item.begin < stamp <= item.end + trial.step for stamp in forced)
    assert max(item.end for item in told) > max(forced) - trial.step - 1e-9
    assert simulation.event.tolist() == [COLLISION]


WRONG = {
    "no such robot": (
        'type="pepper"',
        'type="peper"',
        r"type=\"peper\" is not a robot, did you mean 'pepper'\?.*built-in robots are",
    ),
    "outside": ('type="pepper"', 'type="../pepper"', r"is not a robot|lies outside"),
    "mass beside a type": (
        'type="pepper"',
        'type="pepper" mass="3"',
        r"has height or mass in addition to type=\"pepper\"",
    ),
    "no such link": (
        'link="CameraTop_frame"',
        'link="CameraTop"',
        r"is on link=\"CameraTop\", which does not exist, did you",
    ),
    "no drive": ('<drive type="differential-drive"/>', "", r"needs the element <drive>, or a type such as"),
    "no body": ('body="woman-36"', 'body="woman-37"', r"body=\"woman-37\" has 'woman-37', did you mean 'woman-"),
    "no activity": ('activity="phone"', 'activity="fone"', r"activity=\"fone\" has 'fone', did you mean 'phone'\?"),
    "no world": ('seed="4"', 'seed="4" world="phisics"', r"must be planar or physics, did you mean 'physics'\?"),
    "steps that do not fit": (
        'seed="4"',
        'seed="4" world="physics" physics-step="0.015"',
        r"whole number of steps of the ph",
    ),
    "a camera on nobody": (
        'robot="pepper" link',
        'robot="peper" link',
        r"robot=\"peper\" is not a robot, did you mean 'pepper'\?",
    ),
    "a camera on no link": (
        'link="Head"',
        'link="head"',
        r"link=\"head\" is not a link of robot 'pepper', did you mean 'Head'",
    ),
    "a link of nobody": ('robot="pepper" link="Head"', 'link="Head"', r"link=\"Head\" needs robot"),
    "a camera twice": ('camera name="head"', 'camera name="door"', r"name 'door' is already used by another camera"),
    "a prop": ('size="0.3"', 'size="0"', r"<cube> size=\"0\" must be at least 0.001 m"),
    "in a prop": ('x="7" y="2.2"', 'x="9" y="6.5"', r"<agent> stands at 9,6.5, 0.00 m from a wall"),
}


@pytest.mark.parametrize("mistake", WRONG)
def test_a_mistake_is_named(mistake: str) -> None:
    old, new, sentence = WRONG[mistake]
    assert old in ROOM
    with pytest.raises(TrialError, match=sentence):
        parse_trial(ROOM.replace(old, new), place="room.xml")


def test_without_mujoco_the_physics_world_is_refused_in_one_sentence(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingExtra, match=r"the physics world needs the extra \[sim\]: pip install 'crowdbot\[sim\]'"):
        run(load_trial("frontal", world="physics"), out=f"{tmp_path}/out")
    assert not (tmp_path / "out").exists()
    assert run(load_trial("frontal", duration=0.2)).outcome


def test_a_robot_of_a_folder_beside_the_trial(tmp_path: Path) -> None:
    from shutil import copytree

    from crowdbot.trials.robot import _assets

    home = tmp_path
    copytree(_assets("turtlebot2"), home / "mine")
    (home / "deep").mkdir()
    text = ROOM.replace('<robot name="puck"', '<robot name="puck" type="mine"').replace(' height="0.4" mass="15"', "")
    text = text.replace('<drive type="differential-drive"/>', "").replace('latency="0.12" ', 'default-sensors="false" ')
    (home / "trial.xml").write_text(text)
    (home / "deep" / "trial.xml").write_text(text.replace('type="mine"', 'type="../mine"'))
    trial = load_trial(home / "trial.xml")
    puck = trial.robots[1]
    assert (puck.drive.max_speed, [mount.name for mount in puck.sensors]) == (0.65, ["scan"])  # type: ignore[attr-defined]
    assert 'type="mine"' in trial_xml(trial)
    assert {path.name for path in puck.files()} >= {"robot.xml", "turtlebot2.urdf"}
    with pytest.raises(TrialError, match=r"lies outside .*--trust"):
        load_trial(home / "deep" / "trial.xml")
    assert load_trial(home / "deep" / "trial.xml", trust=True).robots[1].radius == puck.radius
    (home / "mine" / "robot.xml").write_text("<robot/>")
    with pytest.raises(TrialError, match=r"<robot> type=\"mine\": .*robot.xml:1: <robot> needs"):
        load_trial(home / "trial.xml")


def test_a_branch_of_the_physics_world_keeps_its_stage(tmp_path: Path) -> None:
    trial = parse_trial(room("physics", LEAN))
    episode = run(trial)
    slow = branch(episode, 0.52, changes={"robot[puck].drive.max-speed": 0.1})
    assert slow.digest != episode.digest
    assert slow.position[-1, 5, 0] < episode.position[-1, 5, 0]
    with pytest.raises(InputError, match="only walls, obstacles and props can change while it runs"):
        branch(episode, 0.52, changes={"stage.wall-height": 3})
    with pytest.raises(InputError, match="world cannot change in a branch"):
        branch(episode, 0.52, changes={"world": "planar"})
