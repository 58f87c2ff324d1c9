"""When a collision is, how fast what touches is, and which forces on people count as such."""

import numpy as np
import pytest
from physics_worlds import alone, facing, ram

from crowdbot.core import Twist
from crowdbot.world import ContactBody, Cube, PhysicsStage, Robot, two_body_force
from crowdbot.world.physics.contact_events import BodyContactTracker
from crowdbot.world.physics.contacts import EngineContact
from crowdbot.world.physics.mjcf_model import LIMB_NAMES
from crowdbot.world.physics.people_bodies import LIFTED, QUICK

ROBOT, PERSON = ContactBody("robot", 0), ContactBody("person", 1)
STEP = 0.005


def book() -> BodyContactTracker:
    """Return a book of a robot of 50 kg and a person of 70 kg with limbs of 4 kg who looks at it, along -x."""
    return BodyContactTracker(
        STEP, {ROBOT: 50.0, PERSON: 70.0}.get, lambda agent, limb, point, normal: 4.0, lambda agent: np.pi
    )


def contact(force, normal=(1.0, 0.0, 0.0), limb="shank_l", robot=(0.0, 0.0, 0.0), person=(0.0, 0.0, 0.0), swing=None):
    """Return a touch of the robot with the person, by what the robot does to the person."""
    rows = [np.array(row, dtype=float) for row in (normal, (0.0, 0.0, 0.2), robot, person, swing or person)]
    return EngineContact(ROBOT, PERSON, "base", limb, np.array(force, dtype=float), 0.002, *rows)


def test_collisions_are_in_the_time_of_the_scene():
    """A robot at 0.5 m/s whose front is at 0.25 m meets a wall at 0.75 m when it has gone 0.5 m."""
    world = alone(Robot.load("differential"), walls=[[(0.75, -1.0), (0.75, 1.0)]], dt=0.1)
    front = 0.75 - 0.01 - 0.25  # walls of no thickness are 2 cm thick
    met = None
    for _ in range(40):
        before = float(world.scene.position[0, 0, 0])
        scene = world.step({0: Twist(0.5, 0.0)})
        now = float(scene.time)
        assert bool(world.forces) <= (len(world.contact_events) > 0)
        if met is None and world.contact_events:
            met = now
            (event,) = world.contact_events
            assert now - world.dt - 1e-9 <= event.begin < event.end <= now + 1e-9
            share = (front - before) / (0.5 * world.dt)
            assert event.begin == pytest.approx(now - world.dt + share * world.dt, abs=0.03)
    (event,) = world.contact_events
    assert event.end <= float(world.scene.time) + 1e-9
    assert met is not None


class Watched:
    """Follows both ends of all limbs of the first body in the engine, step by step, and what touches them."""

    def __init__(self, world) -> None:
        self.world, self.rows, self._last = world, [], None
        look, add = world.rigid.reader.look, world._contact_tracker.add
        world.rigid.reader.look = lambda: (look(), self._seen())
        world._contact_tracker.add = lambda time, contacts: (add(time, contacts), self._record(time, contacts))

    def _seen(self) -> None:
        model, data, geoms = self.world.engine_model, self.world.data, self.world._people_bodies.geoms[0]
        reach = model.geom_size[geoms, 1:2] * data.geom_xmat[geoms].reshape(-1, 3, 3)[:, :, 2]
        now = np.stack([data.geom_xpos[geoms] - reach, data.geom_xpos[geoms] + reach], axis=1)
        self.speed = np.zeros_like(now) if self._last is None else (now - self._last) / STEP
        self._last = now

    def _record(self, time, contacts) -> None:
        for item in contacts:
            ends = self.speed[LIMB_NAMES.index(item.second_part)] @ item.normal
            self.rows.append((time, ends.min(), ends.max(), item))


def walked_into(ahead: float, steps: int):
    """Return a watched world in which somebody walks into a low beam that drives at them, and does not see it."""
    world = facing(ram(60.0, 0.12), gap=4.0, heading=np.pi, dt=0.02)
    fast = np.array([[1.0, 1.3]])
    goal = np.array([[[0.0, 0.0], [-9.0, 0.0]]])
    unseen = np.array([[False, True]])
    world.scene = world.scene.replace(goal=goal, preferred_speed=fast, max_speed=fast, visible=unseen)
    watched = Watched(world)
    while not world.contact_events:
        world.step({0: Twist(ahead, 0.0)})
        assert world.scene.time < 5.0
    for _ in range(steps):
        world.step({0: Twist(ahead, 0.0)})
    return watched


@pytest.mark.parametrize("ahead", [0.0, 0.6])
def test_the_impact_speed_is_that_of_the_limb_against_the_robot(ahead):
    """The limb as the engine moves it, between its ends, along the normal; a foot swings faster than its person."""
    watched = walked_into(ahead, steps=40)
    for _, low, high, item in watched.rows[:1]:
        own = float(item.second_velocity @ item.normal)
        assert low - 0.05 <= own <= high + 0.05
    event = watched.world.contact_events[0]
    time, low, high, first = watched.rows[0]
    assert event.begin == pytest.approx(time - STEP)
    assert event.part == "leg"
    assert first.first_velocity[0] == pytest.approx(ahead, abs=0.01)
    assert ahead - high - 0.05 <= event.impact_speed <= ahead - low + 0.05
    assert 0.8 + ahead < event.impact_speed < 4.0 * 1.3 + ahead
    assert event.cause == "second"


def test_what_swings_is_known_at_every_touch_and_never_faster_than_legs_are():
    """Nothing comes faster than is told; a limb that gives way leaves faster."""
    watched = walked_into(0.6, steps=60)
    assert len(watched.rows) > 10
    for _, _, high, item in watched.rows:
        assert float(item.second_velocity @ item.normal) <= high + 0.15
        assert np.sqrt(item.swing @ item.swing) <= QUICK + 1e-9


def test_an_impact_of_known_values():
    """A foot at 3 m/s, its person at 1.2 m/s, on a robot at 1 m/s: the leg hits at 4 m/s, the body at 2.2 m/s."""
    known = book()
    known.add(
        1.0, (contact((500.0, 0.0, 0.0), robot=(1.0, 0.0, 0.0), person=(-3.0, 0.0, 0.0), swing=(-1.8, 0.0, 0.0)),)
    )
    (event,) = known.contact_events
    assert event.impact_speed == 4.0
    assert event.cause == "second"
    leg = two_body_force(4.0, 50.0, "lower leg", 4.0)
    assert leg == pytest.approx(4.0 * np.sqrt(60e3 * 50.0 * 4.0 / 54.0))
    assert event.peak_force == max(leg, two_body_force(2.2, 50.0, "lower leg", 70.0))
    assert (event.begin, event.end) == (1.0 - STEP, 1.0)


def test_what_bears_a_person_is_no_injury():
    """Who treads on something is held by it; what presses aside or down counts."""
    for normal, share in (((0.0, 0.0, 1.0), 0.0), ((0.6, 0.0, 0.8), 0.6), ((0.6, 0.0, -0.8), 1.0)):
        known = book()
        for k in range(200):
            known.add(k * STEP, (contact(1000.0 * np.array(normal), normal, robot=np.array(normal)),))
        (event,) = known.contact_events
        assert event.steady_force == pytest.approx(1000.0 * share)
        assert event.peak_force == pytest.approx(share * two_body_force(1.0, 50.0, "lower leg", 70.0))
        assert event.simulated_peak == pytest.approx(1000.0)
        assert event.severity == pytest.approx(max(event.peak_force / 260.0, event.steady_force / 130.0))


def test_repeated_knocks_are_no_clamping():
    known = book()
    for k in range(400):
        known.add(k * STEP, (contact((900.0, 0.0, 0.0)),) if k % 50 < 10 else ())
    (event,) = known.contact_events
    assert event.duration > 1.0
    assert event.steady_force == 0.0
    assert event.simulated_peak == 900.0


def test_a_leg_over_a_cube_is_lifted():
    """A cube appears under a foot: the engine's limb rises at once and stays above it, and nothing is clamped."""
    world = facing(Robot.load("turtlebot2"), gap=3.0, dt=0.05, stage=PhysicsStage(props=(Cube(3.0, 0.0, size=0.08),)))
    forces, heights = [], []
    for _ in range(40):
        world.step({0: Twist()})
        forces.append(sum(row.force for row in world.forces))
        feet = world._people_bodies.geoms[0][[LIMB_NAMES.index("foot_l"), LIMB_NAMES.index("foot_r")]]
        heights.append(float(world.data.geom_xpos[feet, 2].max()))
    assert max(heights) < LIFTED + 0.2
    assert np.mean(forces[10:]) < 100.0
    assert all(event.steady_force < 100.0 for event in world.contact_events)
