"""Impacts of mirrored robots and walking people against the two-body model, and how pushed people recover."""

import math

import numpy as np
import pytest
from physics_worlds import facing, ram

from crowdbot.core import InputError, Twist
from crowdbot.humans import Gait, People, limb_chain, striking_mass
from crowdbot.simulation import AvatarOrder, RobotPoseOrder, Simulation, SimulationRun, VelocityOrder
from crowdbot.trials import parse_trial
from crowdbot.world import two_body_force
from crowdbot.world.physics.balance.recovery import BRACE, GRIP, REACTION, STEPPING, recovery_force
from crowdbot.world.physics.body_region_limits import region_of
from samples import sample

TRIAL = """<trial name="impact" duration="20" world="physics" physics-step="{step}"><stage/><crowd type="orca"/>
<{person} x="{x}" y="{y}" heading="{facing}" body="man-36"/>
<robot name="twin" type="{kind}" x="0" y="0" heading="{heading}" visible="false" default-sensors="false">
<goal x="6" y="0"/>{pose}<navigator type="external"/></robot><end collision="false" goal="false"/></trial>"""
POSE = '<pose source="external"/>'


def hit(kind, speed, mirrored=True, heading=0.0, step=0.005, walking=0.0, after=1.0):
    """Return the hardest contact event, and the masses of robot and person, until some seconds after the first."""
    cos, sin = math.cos(heading), math.sin(heading)
    away = 2.4 if walking else 1.2
    person = 'avatar name="guide" source="external"' if walking else "agent"
    text = TRIAL.format(
        step=step, person=person, x=away * cos, y=away * sin, facing=heading + math.pi, kind=kind, heading=heading,
        pose=POSE if mirrored else "",
    )  # fmt: skip
    run, end = SimulationRun(Simulation(parse_trial(text))), math.inf
    for tick in range(1, 200):
        time = tick * run.simulation.trial.step
        x = away - walking * time
        orders = [VelocityOrder(robot="twin", forward=speed)]
        if mirrored:
            orders = [
                RobotPoseOrder(robot="twin", time=time, x=speed * time * cos, y=speed * time * sin, heading=heading)
            ]
        if walking:
            orders.append(AvatarOrder(avatar="guide", time=time, x=x * cos, y=x * sin, heading=heading + math.pi))
        run.step(orders)
        world = run.simulation.world
        if world.contact_events and math.isinf(end):
            end = time + after
        if time >= end:
            break
    event = max(world.contact_events, key=lambda contact_event: contact_event.peak_force)
    return event, world.robot_bodies[1].mass, float(world.people.people.mass[0])


CASES = [("pepper", 1.0, 0.002), ("pepper", 0.5, 0.005), ("wheelchair", 1.0, 0.005), ("pepper", 1.0, 0.01)]


@pytest.mark.parametrize(("kind", "speed", "step"), sample(CASES, 1, rows=True))
def test_no_contact_of_a_mirrored_robot_exceeds_the_force_of_its_speed(kind, speed, step):
    """The torso of Pepper does not swing on its knee, and the legs of the person do not kick."""
    event, mass, person = hit(kind, speed, step=step)
    assert event.peak_force == pytest.approx(two_body_force(speed, mass, event.region, person), rel=0.1)
    assert event.cause == "first"


def test_forces_grow_with_speed_and_do_not_depend_on_the_heading_or_on_who_drives():
    ahead = hit("wheelchair", 1.0)[0]
    turned = hit("wheelchair", 1.0, heading=2.0)[0]
    driven = hit("wheelchair", 1.0, mirrored=False)[0]
    slow = hit("wheelchair", 0.5)[0]
    assert ahead.region == turned.region == driven.region == slow.region == "lower leg"
    assert turned.peak_force == pytest.approx(ahead.peak_force, rel=0.05)
    assert driven.peak_force == pytest.approx(ahead.peak_force, rel=0.1)
    assert slow.peak_force == pytest.approx(0.5 * ahead.peak_force, rel=0.05)
    assert ahead.peak_force == pytest.approx(1702.0, rel=0.005)


@pytest.mark.parametrize(
    ("kind", "speed"), sample([("cuybot", 1.0), ("turtlebot2", 1.3), ("pepper", 1.3)], 1, rows=True)
)
def test_a_walking_person_hits_with_the_momentum_of_the_body_and_not_the_speed_of_the_foot(kind, speed):
    event, mass, person = hit(kind, 0.0, mirrored=False, walking=speed)
    assert event.part == "leg"
    assert event.peak_force == pytest.approx(two_body_force(speed, mass, event.region, person), rel=0.1)


def test_two_led_bodies_do_not_press_without_limit():
    event, mass, person = hit("cuybot", 0.0, walking=1.0)
    whole = two_body_force(1.0, mass, "lower leg", person)
    assert event.peak_force < 1.1 * whole
    assert event.simulated_peak < 4.0 * whole


def standing():
    people = People.of(["man-36"])
    gait = Gait(people, 0)
    limbs = people.limbs(gait.posture(gait.start(np.zeros((1, 2)), np.zeros(1))))
    return limbs.start[0], limbs.end[0], people.limb_mass[0]


def test_the_mass_of_a_striking_limb():
    start, end, mass = standing()
    whole = float(mass.sum())
    ahead, turned = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    for limb in ("foot_l", "shank_l", "thigh_l", "hand_r", "forearm_r", "upperarm_r"):
        shares = [striking_mass(start, end, mass, limb, share, ahead) for share in (0.0, 0.5, 1.0)]
        assert all(0.0 < share < whole for share in shares)
        assert striking_mass(start, end, 2.0 * mass, limb, 0.5, ahead) == pytest.approx(2.0 * shares[1], rel=1e-3)
        spun = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        found = striking_mass(start @ spun.T, end @ spun.T, mass, limb, 0.5, turned)
        assert found == pytest.approx(shares[1], rel=1e-3)
    foot = striking_mass(start, end, mass, "foot_l", 1.0, ahead)
    assert 0.01 * whole < foot < 0.05 * whole  # crouched walking: 3.7 % (Chi and Schmitt 2005)
    assert striking_mass(start, end, mass, "foot_l", 0.5, ahead) == pytest.approx(GOLDEN_FOOT, rel=1e-3)
    assert striking_mass(start, end, mass, "chest", 0.5, ahead) == pytest.approx(mass[2])
    assert limb_chain("shank_r") == ("thigh_r", "shank_r", "foot_r")


GOLDEN_FOOT = 1.616


def test_a_rod_that_hangs_free_has_the_mass_of_mechanics():
    """A rod on a joint of a heavy body has a third of its mass at its end."""
    start, end = np.zeros((17, 3)), np.zeros((17, 3))
    rows = {name: k for k, name in enumerate(("upperarm_l", "forearm_l", "hand_l"), start=5)}
    mass = np.full(17, 1e9)
    for name, k in rows.items():
        start[k], end[k] = (0.0, 0.0, -float(k)), (0.0, 0.0, -float(k + 1))
        mass[k] = 3.0 if name == "upperarm_l" else 1e-9
    found = striking_mass(start, end, mass, "upperarm_l", 1.0, np.array([1.0, 0.0, 0.0]))
    assert found == pytest.approx(1.0, rel=1e-4)


def test_recovery_waits_braces_and_steps():
    error = np.array([[-0.5, 0.0]] * 5)
    since = np.array([0.0, REACTION, STEPPING, STEPPING, 1.0])
    free = np.array([True, True, True, False, True])
    error[4] = (-3.0, -4.0)
    force = recovery_force(error, np.full(5, 70.0), np.ones(5), since, free)
    sizes = np.hypot(*force.T)
    assert sizes.tolist() == pytest.approx([0.0, BRACE, 70.0 * 0.5 * math.sqrt(9.81), BRACE, 70.0 * GRIP * 9.81])
    assert (force[1:] @ np.array([1.0, 0.0]) < 0.0).all()
    np.testing.assert_allclose(force[4] / sizes[4], (-0.6, -0.8))


@pytest.mark.parametrize(("speed", "farthest"), sample([(1.0, 0.25), (3.0, 1.05)], 2, rows=True))
def test_a_struck_person_stops_after_recovery_steps(speed, farthest):
    world = facing(ram(60.0, 1.05), gap=1.5, dt=0.05)
    fastest = 0.0
    for _ in range(80):
        scene = world.step({0: Twist(0.0 if world.contact_events else speed, 0.0)})
        fastest = max(fastest, float(scene.velocity[0, 1, 0]))
    assert fastest > 0.4 * speed
    assert 0.05 < scene.position[0, 1, 0] - 1.5 < farthest
    assert float(np.hypot(*scene.velocity[0, 1])) < 0.02
    assert region_of("abdomen") == "belly"
    with pytest.raises(InputError, match="unknown limb"):
        region_of("wing")
