"""Rider: a seated person as rigid parts of a robot, with mass and contacts."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from crowdbot.humans import LIMBS, WHEELCHAIR, Gait, People
from crowdbot.typing import Floats
from crowdbot.world.robots.robot import Robot
from crowdbot.world.urdf import Capsule, Joint, Link, LinkInertia, LinkShape
from crowdbot.world.urdf.transforms import frame

RIDER = "rider/"
"""Prefix of the links of a rider, before the name of the limb."""


def seat_rider(robot: Robot, people: People, row: int) -> Robot:
    """Return a robot with the limbs of a seated person as links that are fixed to its root.

    Each limb has the mass and the capsule of that of the person, in the posture of a person in the seat. Sensors see
    the rider among the people, so that the links have no visual shapes.

    Args:
        robot: the robot, with the seat of the type ``wheelchair``.
        people: bodies of people.
        row: the rider in ``people``.

    >>> chair, people = Robot.load("wheelchair"), People.of(["woman-36"])
    >>> seated = seat_rider(chair, people, 0)
    >>> round(seated.model.mass, 1) == round(chair.model.mass + float(people.mass[0]), 1)
    True
    """
    person = people.persons[row]
    return _seated(robot, person.name, float(people.height[row]))


@functools.lru_cache(maxsize=64)
def _seated(robot: Robot, name: str, height: float) -> Robot:
    """Return the robot with a rider; equal riders give the same robot, so that worlds share its engine model."""
    people = People.of([name], height=[height])
    gait = Gait(people, 0, seat=[WHEELCHAIR])
    state = gait.start(np.zeros((1, 2)), np.zeros(1), np.zeros((1, 2)), ["sit"])
    limbs = people.limbs(gait.posture(state))
    links, joints = dict(robot.model.links), dict(robot.model.joints)
    for k, limb in enumerate(LIMBS):
        part = RIDER + limb.name
        links[part] = _limb(part, limbs.start[0, k], limbs.end[0, k], float(limbs.radius[0, k]), people.limb_mass[0, k])
        joints[part] = Joint(part, "fixed", robot.model.root, part, np.eye(4), np.array([0.0, 0.0, 1.0]))
    return dataclasses.replace(robot, model=dataclasses.replace(robot.model, links=links, joints=joints))


def _limb(name: str, start: Floats, end: Floats, radius: float, mass: float) -> Link:
    """Return the link of a limb with its capsule between two points of the frame of the robot [m]."""
    way = end - start
    length = float(np.sqrt(way @ way))
    shape = Capsule(radius, max(length, 1e-6))
    along = way / length if length > 1e-6 else np.array([0.0, 0.0, 1.0])
    side = np.cross((0.0, 1.0, 0.0) if abs(along[1]) < 0.9 else (1.0, 0.0, 0.0), along)
    side = side / np.sqrt(side @ side)
    turn = np.column_stack([side, np.cross(along, side), along])
    origin = frame(0.5 * (start + end), turn)
    tensor = turn @ shape.solid().inertia(float(mass)) @ turn.T
    whole = LinkInertia(float(mass), origin[:3, 3], 0.5 * (tensor + tensor.T))
    return Link(name, whole, (), (LinkShape(shape, origin),))
