"""PlanarWorld: people and robots together, determinism, leaving, contacts between samples."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from crowdbot.core import InputError, Paper, Scene, Twist, stream
from crowdbot.metrics import swept_distance
from crowdbot.models import ORCA, CrowdModel
from crowdbot.world import Contact, DifferentialDrive, Omnidirectional, PlanarWorld, Twists

FAST = DifferentialDrive(max_speed=10.0, max_turn_rate=10.0, max_acceleration=1e6, max_turn_acceleration=1e6)


@dataclass(frozen=True)
class Wanderers(CrowdModel):
    """Everyone walks as desired plus a random part, to see who draws from which stream."""

    paper: ClassVar[Paper] = Paper("Nobody", 2000, "Random walks", "Nowhere")
    shake: float = 0.0

    def velocity(self, scene, dt, rng=None):
        return scene.desired_velocity(dt) + self.shake * rng.normal(size=(*scene.shape, 2))


def crossing(seed, people=10, environments=1):
    rng = stream(seed, "people")
    place = rng.uniform(-6.0, 6.0, (environments, people, 2))
    goal = place * -1.0
    place[:, 0], goal[:, 0] = (0.0, -8.0), (0.0, 8.0)
    external = np.arange(people) == 0
    heading = np.where(external, math.pi / 2, 0.0)
    return Scene.of(place, goal=goal, external=external, heading=heading, radius=0.25)


def run(world, steps, command):
    return [world.step(dict.fromkeys(world.drives, command)) for _ in range(steps)]


def test_the_robot_follows_its_drive_and_the_people_their_model():
    scene = crossing(0)
    world = PlanarWorld(scene, ORCA(), {0: DifferentialDrive()}, dt=0.1)
    after = world.step({0: Twist(1.0, 0.0)})
    crowd = ORCA().step(scene, 0.1, stream(0, "crowd"))
    np.testing.assert_array_equal(after.position[:, 1:], crowd.position[:, 1:])
    np.testing.assert_allclose(after.position[0, 0], [0.0, -8.0 + 0.01], atol=1e-12)
    np.testing.assert_allclose(after.velocity[0, 0], [0.0, 0.1], atol=1e-12)
    assert world.twists[0].at(0) == Twist(0.1, 0.0, 0.0)
    np.testing.assert_array_equal(world.pose(0).position, after.position[:, 0])


def test_the_velocity_of_a_turning_robot_is_along_its_heading():
    world = PlanarWorld(crossing(1), ORCA(), {0: FAST}, dt=0.1)
    scene = run(world, 5, Twist(1.0, 0.9))[-1]
    assert scene.heading[0, 0] == pytest.approx(math.pi / 2 + 0.45)
    direction = [math.cos(scene.heading[0, 0]), math.sin(scene.heading[0, 0])]
    np.testing.assert_allclose(scene.velocity[0, 0], direction, atol=1e-12)


def test_people_make_way_for_a_robot_they_see():
    places, goals = [[0.0, 0.0], [4.0, 0.05]], [[0.0, 0.0], [-4.0, 0.05]]
    ways = []
    for visible in (True, False):
        start = Scene.of(places, goal=goals, external=[True, False], visible=[visible, True])
        scenes = run(PlanarWorld(start, ORCA(), {0: FAST}, dt=0.1), 40, Twist())
        ways.append(max(abs(scene.position[0, 1, 1] - 0.05) for scene in scenes))
    assert ways[0] > 0.3
    assert ways[1] < 1e-9


def standing_in_a_flow(robot_margin):
    """Return the smallest clearance of a robot that stands still while people walk past it both ways."""
    places = [[0.0, 0.0], *([x, 0.1 * k - 0.5] for k, x in enumerate(np.linspace(-8.0, 8.0, 10)))]
    goals = [[0.0, 0.0], *([-30.0 * np.sign(x), y] for x, y in places[1:])]
    start = Scene.of(places, goal=goals, external=np.arange(11) == 0, radius=0.25)
    world = PlanarWorld(start, ORCA(), {0: FAST}, dt=0.1, robot_margin=robot_margin)
    paths = np.stack([start.position[0], *(scene.position[0] for scene in run(world, 80, Twist()))])
    away = paths[:, 1:] - paths[:, :1]
    assert np.array_equal(world.scene.radius, start.radius)
    return float(np.min(swept_distance(away[:-1], away[1:]))) - 0.5


def test_people_keep_a_berth_of_robots():
    touching, apart = standing_in_a_flow(0.0), standing_in_a_flow(0.2)
    assert abs(touching) < 0.02
    assert apart == pytest.approx(0.2, abs=0.02)


def test_same_seed_same_bytes():
    digests = []
    for seed in (4, 4, 5):
        world = PlanarWorld(crossing(2), Wanderers(shake=0.3), {0: DifferentialDrive()}, dt=0.1, seed=seed)
        digests.append([scene.digest() for scene in run(world, 20, Twist(0.8, 0.2))])
    assert digests[0] == digests[1]
    assert digests[0] != digests[2]


def test_a_robot_more_does_not_change_the_draws_of_the_crowd():
    start = crossing(2)
    without = PlanarWorld(start, Wanderers(shake=0.3), {}, dt=0.1, seed=4)
    driven = PlanarWorld(start, Wanderers(shake=0.3), {0: FAST}, dt=0.1, seed=4)
    for _ in range(5):
        one, two = without.step({}), driven.step({0: Twist(0.5, 0.5)})
        np.testing.assert_array_equal(one.position[:, 1:], two.position[:, 1:])


def test_a_batch_gives_the_bytes_of_each_alone():
    parts = [crossing(seed) for seed in range(4)]
    fields = ("position", "goal", "heading", "external", "radius")
    together = Scene.of(**{name: np.concatenate([getattr(p, name) for p in parts]) for name in fields})
    commands = Twists(np.linspace(0.2, 1.0, 4), np.linspace(-0.5, 0.5, 4), np.zeros(4))
    world = PlanarWorld(together, ORCA(), {0: DifferentialDrive()}, dt=0.1)
    for _ in range(15):
        world.step({0: commands})
    for e, part in enumerate(parts):
        alone = PlanarWorld(part, ORCA(), {0: DifferentialDrive()}, dt=0.1)
        run(alone, 15, commands.at(e))
        assert alone.scene.position.tobytes() == world.scene.position[e].tobytes()
        assert alone.scene.velocity.tobytes() == world.scene.velocity[e].tobytes()
        assert alone.scene.heading.tobytes() == world.scene.heading[e].tobytes()


def test_people_leave_at_their_goal_and_robots_do_not():
    start = Scene.of(
        [[0.0, 0.0], [0.0, 3.0], [0.0, 6.0]], goal=[[0.0, 0.0], [1.0, 3.0], [9.0, 6.0]], external=[1, 0, 0]
    )
    world = PlanarWorld(start, ORCA(), {0: FAST}, dt=0.1, leave_radius=0.3)
    scenes = run(world, 20, Twist())
    assert scenes[-1].active[0].tolist() == [True, False, True]
    last = [scene for scene in scenes if scene.active[0, 1]][-1]
    assert math.dist(last.position[0, 1], (1.0, 3.0)) >= 0.3
    stays = PlanarWorld(start, ORCA(), {0: FAST}, dt=0.1)
    assert np.all(run(stays, 20, Twist())[-1].active)


def test_time_is_a_whole_number_of_steps():
    world = PlanarWorld(crossing(0).replace(time=2.0), ORCA(), {0: FAST}, dt=0.1)
    assert [scene.time for scene in run(world, 3, Twist())] == [2.1, 2.2, 2.3]


def test_a_head_on_contact_between_samples_is_found():
    # 1 m apart in closing at 10 m/s: at both samples they are 0.5 m clear, in between they pass through each other
    start = Scene.of(
        [[0.0, 0.0], [1.0, 0.0]], goal=[[0.0, 0.0], [-9.0, 0.0]], external=[1, 0], radius=0.2, preferred_speed=10.0
    )
    world = PlanarWorld(start, Wanderers(), {0: FAST}, dt=0.2)
    scene = world.step({0: Twist()})
    assert math.dist(scene.position[0, 0], scene.position[0, 1]) == pytest.approx(1.0)
    assert world.contacts == (Contact(0, 0, 1, pytest.approx(-0.4)),)
    world.step({0: Twist()})
    assert world.contacts == ()


def test_contacts_count_each_pair_once_and_only_who_is_there():
    place = [[0.0, 0.0], [0.3, 0.0], [0.0, 0.3], [0.2, 0.2], [9.0, 9.0]]
    start = Scene.of(place, external=[1, 1, 0, 0, 0], radius=0.2, active=[1, 1, 1, 0, 1])
    world = PlanarWorld(start, Wanderers(), {1: FAST, 0: FAST}, dt=0.1)
    world.step({0: Twist(), 1: Twist()})
    assert [(c.robot, c.other) for c in world.contacts] == [(0, 1), (0, 2)]
    assert world.contacts[0].clearance == pytest.approx(-0.1)


def test_overlaps_are_reported_not_resolved():
    start = Scene.of([[0.0, 0.0], [0.45, 0.0]], external=[1, 0], radius=0.2, heading=[0.0, 0.0])
    world = PlanarWorld(start, Wanderers(), {0: FAST}, dt=0.1)
    scenes = run(world, 9, Twist(1.0, 0.0))
    assert scenes[-1].position[0, 0, 0] == pytest.approx(0.9)
    assert scenes[-1].position[0, 1].tolist() == [0.45, 0.0]


def test_a_moving_robot_starts_with_the_speed_of_its_scene():
    start = Scene.of([[0.0, 0.0]], [[0.0, 0.7]], heading=math.pi / 2, external=True)
    world = PlanarWorld(start, ORCA(), {0: DifferentialDrive(max_acceleration=1.0)}, dt=0.1)
    world.step({0: Twist(1.0, 0.0)})
    assert world.twists[0].forward[0] == pytest.approx(0.8)


def test_an_omnidirectional_robot_slides():
    start = Scene.of([[0.0, 0.0]], external=True, heading=0.0)
    world = PlanarWorld(start, ORCA(), {0: Omnidirectional(max_acceleration=100.0)}, dt=0.1)
    scene = world.step({0: Twist(0.0, 0.0, left=1.0)})
    np.testing.assert_allclose(scene.position[0, 0], [0.0, 0.1])


def test_a_spawner_may_change_the_scene_between_steps():
    world = PlanarWorld(crossing(3), ORCA(), {0: FAST}, dt=0.1)
    world.step({0: Twist()})
    place = world.scene.position.copy()
    place[0, 3] = (30.0, 30.0)
    world.scene = world.scene.replace(position=place)
    after = world.step({0: Twist()})
    assert math.dist(after.position[0, 3], (30.0, 30.0)) < 0.2


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"drives": {12: FAST}}, "drive is given for agent 12, but the scene has agents 0 to 9"),
        ({"drives": {1: FAST}}, "agent 1 has a drive but is not external"),
        ({"robot_margin": -0.1}, "robot_margin -0.1 m must be finite and at least 0"),
        ({"leave_radius": -0.5}, "leave_radius -0.5 m must be finite and above 0"),
        ({"dt": 0.0}, "time step 0.0 s is outside"),
    ],
)
def test_a_wrong_world_is_explained(changes, message):
    with pytest.raises(InputError, match=message):
        PlanarWorld(**({"scene": crossing(0), "model": ORCA(), "drives": {0: FAST}, "dt": 0.1} | changes))


@pytest.mark.parametrize(
    ("commands", "message"),
    [
        ({}, "robot 0 has no command"),
        ({0: Twist(), 3: Twist()}, "agent 3 has a command but is not a robot; robots are \\[0\\]"),
        ({0: Twist(math.nan, 0.0)}, "forward = nan must be finite"),
    ],
)
def test_wrong_commands_are_explained_and_change_nothing(commands, message):
    world = PlanarWorld(crossing(0), ORCA(), {0: FAST}, dt=0.1)
    before = world.scene.digest()
    with pytest.raises(InputError, match=message):
        world.step(commands)
    assert (world.scene.digest(), world.clock.tick) == (before, 0)
