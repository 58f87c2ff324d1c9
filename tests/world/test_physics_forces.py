"""Forces in the physics world: steady pushes, impacts on known masses, and who hit whom."""

import dataclasses
import math

import numpy as np
import pytest
from physics_worlds import alone, coasting, facing, ram

from crowdbot.core import InputError, Twist
from crowdbot.world import (
    BODY_REGION_LIMITS,
    Cube,
    PhysicsStage,
    Robot,
    frame,
    permitted_speed,
    region_of,
    two_body_force,
)
from crowdbot.world.physics.balance.recovery import REACTION
from crowdbot.world.physics.body_region_limits import reduced_mass, softness
from crowdbot.world.physics.people_bodies import GIVEN
from crowdbot.world.urdf import Box, LinkShape
from samples import sample


def weak(beam=False):
    """Return a robot whose two wheels of 0.08 m push with 3 N m each: 75 N; with a beam at the height of shins."""
    robot = Robot.load("differential")
    if beam:
        part = LinkShape(Box((0.04, 0.6, 0.08)), frame((0.3, 0.0, 0.18)))
        links = {**robot.model.links}
        links["base_link"] = dataclasses.replace(links["base_link"], collisions=(part,))
        robot = dataclasses.replace(robot, model=dataclasses.replace(robot.model, links=links))
    joints = {
        name: dataclasses.replace(joint, motor=dataclasses.replace(joint.motor, effort=3.0), damping=0.0)
        if name in {wheel.joint for wheel in robot.wheels}
        else joint
        for name, joint in robot.model.joints.items()
    }
    return dataclasses.replace(robot, model=dataclasses.replace(robot.model, joints=joints))


def pushing(world, steps, first, second):
    """Return the sums of the forces on one kind, step by step, along x [N]."""
    measured = []
    for _ in range(steps):
        world.step({0: Twist(0.5, 0.0)})
        assert {(row.first.kind, row.second.kind) for row in world.forces} <= {(first, second)}
        measured.append(sum(row.vector[0] for row in world.forces))
    return measured


def test_a_steady_push_on_a_wall_is_75_newton():
    world = alone(weak(), walls=[[(0.5, -1.0), (0.5, 1.0)]])
    measured = pushing(world, 45, "robot", "wall")
    assert measured[0] == 0.0
    assert measured[-20:] == pytest.approx([75.0] * 20, rel=0.02)
    (event,) = world.contact_events
    assert event.steady_force == pytest.approx(75.0, rel=0.02)
    assert math.isnan(event.peak_force)
    assert math.isnan(event.severity)
    assert event.cause == "first"


def test_a_steady_push_on_a_person_is_75_newton_and_the_person_yields():
    """The person steps back slowly, and the robot does not knock its way through."""
    world = facing(weak(beam=True), gap=0.7, dt=0.05)
    measured = pushing(world, 80, "robot", "person")
    assert np.mean(measured[-20:]) == pytest.approx(75.0, rel=0.02)
    assert measured[-20:] == pytest.approx([75.0] * 20, rel=0.05)
    assert {row.part for row in world.forces} == {"leg"}
    robot, person = world.scene.position[0, :, 0]
    assert 0.8 < person < 1.7
    assert 0.25 < person - robot < 0.45
    speed = 75.0 * REACTION / world.people.people.mass[0]  # the push against what braces the person
    assert world.scene.velocity[0, 1, 0] == pytest.approx(speed, rel=0.05)
    (event,) = world.contact_events
    assert 30.0 < event.steady_force < 80.0  # one foot may carry all of it
    assert event.steady_region == "lower leg"
    assert event.severity < 2.5  # the knocks of a leg that comes back


def test_more_than_people_can_brace_against_pushes_them_along():
    world = facing(Robot.load("wheelchair"), gap=1.0, dt=0.05)
    for _ in range(100):
        scene = world.step({0: Twist(0.5, 0.0)})
    robot, person = scene.position[0, :, 0]
    assert robot > 1.0
    assert person > robot + 0.3
    limbs = world.limbs()
    assert np.abs(limbs.start[0, :, 0] - person).max() < 0.6 + GIVEN


IMPACTS = [(1.0, 60.0, 1.3, "chest"), (1.0, 20.0, 1.3, "chest"), (0.5, 150.0, 1.05, "belly"), (0.6, 60.0, 1.6, "face")]


@pytest.mark.parametrize(("speed", "mass", "height", "region"), sample(IMPACTS, 1, rows=True))
def test_an_impact_gives_the_force_of_the_two_body_model(speed, mass, height, region):
    """The engine's own peak agrees with the formula, although in it the whole person is behind the limb."""
    world = facing(ram(mass, height))
    for _ in range(20):
        world.step({0: Twist(speed, 0.0)})
    coasting(world)
    for _ in range(100):
        world.step({0: Twist(speed, 0.0)})
    event = world.contact_events[0]
    assert event.region == region
    assert event.impact_speed == pytest.approx(speed, rel=0.01)
    tissue = BODY_REGION_LIMITS[region]
    expected = speed * math.sqrt(tissue.stiffness / (1.0 / mass + 1.0 / tissue.mass))
    assert event.peak_force == pytest.approx(expected, rel=0.01)
    assert event.simulated_peak == pytest.approx(expected, rel=0.1)
    assert event.cause == "first"


def test_an_impact_keeps_momentum():
    world = facing(ram(60.0, 1.3))
    for _ in range(20):
        world.step({0: Twist(1.0, 0.0)})
    coasting(world)
    while not world.contact_events:
        world.step({0: Twist(1.0, 0.0)})
    before = 60.0
    for _ in range(5):
        scene = world.step({0: Twist(1.0, 0.0)})
    mass = world.people.people.mass[0]
    after = 60.0 * scene.velocity[0, 0, 0] + mass * scene.velocity[0, 1, 0]
    assert scene.velocity[0, 1, 0] > 0.3
    assert after == pytest.approx(before, rel=0.05)


def test_from_behind_it_is_the_back_and_the_one_who_walks_is_the_cause():
    world = facing(ram(60.0, 1.3), heading=0.0)
    for _ in range(80):
        world.step({0: Twist(1.0, 0.0)})
    assert world.contact_events[0].region == "back"
    walking = facing(ram(60.0, 1.3), gap=2.0)
    walking.scene = walking.scene.replace(external=np.array([[True, True]]), velocity=np.array([[[0, 0], [-1.0, 0]]]))
    for _ in range(100):
        walking.scene = walking.scene.replace(velocity=np.array([[[0.0, 0.0], [-1.0, 0.0]]]))
        walking.step({0: Twist()})
        if walking.contact_events:
            break
    event = walking.contact_events[0]
    assert event.cause == "second"
    assert event.impact_speed == pytest.approx(1.0, abs=0.25)


def test_a_cube_is_pushed_and_a_fixed_one_is_not():
    robot = Robot.load("cuybot")
    free = alone(robot, stage=PhysicsStage(props=(Cube(1.0, 0.0, size=0.4, mass=5.0),)))
    fast = alone(robot, stage=PhysicsStage(props=(Cube(1.0, 0.0, size=0.4, fixed=True),)))
    forces = []
    for _ in range(60):
        free.step({0: Twist(0.5, 0.0)})
        fast.step({0: Twist(0.5, 0.0)})
        forces.append(sum(row.force for row in free.forces))
    assert free.prop(0)[0, 3] > 1.4
    assert free.prop(0)[2, 3] == pytest.approx(0.2, abs=0.01)
    assert fast.prop(0)[0, 3] == 1.0
    assert fast.scene.position[0, 0, 0] < 0.55
    assert {event.second.kind for event in free.contact_events} == {"prop"}
    assert np.mean(forces[-20:]) == pytest.approx(0.5 * 5.0 * 9.81, rel=0.5)  # it slides in jerks


def test_tissues():
    assert two_body_force(1.0, 60.0, "chest") == pytest.approx(775.0, abs=1.0)
    assert permitted_speed(60.0, "chest") == pytest.approx(0.36, abs=0.005)
    assert permitted_speed(60.0, "face") == 0.0
    assert two_body_force(1.0, math.inf, "hand") == pytest.approx(math.sqrt(75e3 * 0.6))
    assert two_body_force(1.0, 60.0, "lower leg", person_mass=30.0) < two_body_force(1.0, 60.0, "lower leg")
    assert reduced_mass(math.inf, math.inf) == math.inf
    assert softness("hand", 70.0, 20.0, 0.005)[0] <= (math.pi / 0.03) ** 2
    with pytest.raises(InputError, match="unknown limb 'tail'; use one of pelvis"):
        region_of("tail")
