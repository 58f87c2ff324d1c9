"""The whole world as one MuJoCo model: stage, robots, and bodies that people take when something is near them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import InputError, Scene
from crowdbot.core.markup import Element, written
from crowdbot.humans import LIMBS
from crowdbot.world.ackermann import AckermannDrive
from crowdbot.world.robot import Robot
from crowdbot.world.urdf.geoms import row
from crowdbot.world.urdf.mjcf import BaseServo, mjcf

from .engine import engine
from .layers import LIMB, ROBOT, TRUNK
from .scenery import scenery
from .stage import PhysicsStage

__all__ = ["PARKED", "Built", "built"]

PARKED = 60.0
"""Height [m] at which limbs that nobody has wait."""
PULL, SPIN = 4.0, 1.5
"""Largest force [N] and torque [N m] of a base that is pulled, per kg of the robot."""
SKIN = "0.85 0.70 0.60 1"
ARENA = "64M"
SPRING = "0.5 0.5 0.001 0.5 2"
"""Of the touch of a limb: so the engine solves it as a spring and a damper, whose force two limbs cannot drive up."""


class Built(NamedTuple):
    """A model as XML tree with its mesh files; ``prefixes`` of the names of each robot."""

    root: Element
    files: dict[str, bytes]
    prefixes: dict[int, str]

    def load(self, timestep: float) -> Any:
        """Return the ``mujoco.MjModel``."""
        model = engine().MjModel.from_xml_string(written(self.root), self.files)
        model.opt.timestep = timestep
        return model


def built(
    scene: Scene,
    stage: PhysicsStage,
    robots: Mapping[int, Robot],
    slots: int,
    motors: Mapping[int, Mapping[str, str]] | None = None,
    posed: bool = False,
) -> Built:
    """Return the model of a world.

    Args:
        scene: with walls, and robots where they begin.
        stage: what else stands there.
        robots: by agent.
        slots: how many people can have a body at a time.
        motors: how joints of robots are commanded, by agent and joint, see :func:`crowdbot.world.urdf.mjcf`.
        posed: robots are not moved by the engine but put where they are.

    Raises:
        InputError: a robot steers on wheels of its own.
    """
    assets, world = scenery(scene.walls, stage)
    sections: dict[str, list[Element]] = {"contact": [], "equality": [], "actuator": []}
    files: dict[str, bytes] = {}
    prefixes = {}
    for agent, robot in sorted(robots.items()):
        prefixes[agent] = f"robot{agent}/"
        if posed:
            made = mjcf(robot.model, base="kinematic", prefix=prefixes[agent], contact=ROBOT)
        else:
            made = _robot(scene, agent, robot, prefixes[agent], (motors or {}).get(agent))
        files |= made.assets
        for section in made.root.children:
            if section.tag == "asset":
                assets += section.children
            elif section.tag == "worldbody":
                world += section.children
            elif section.tag in sections:
                sections[section.tag] += section.children
    world += [_person(slot) for slot in range(slots)]
    root = Element("mujoco", {"model": "crowdbot"}, _settings())
    root.children += [Element("asset", {}, assets), Element("worldbody", {}, world)]
    root.children += [Element(tag, {}, rows) for tag, rows in sections.items() if rows]
    return Built(root, files, prefixes)


def _settings() -> list[Element]:
    compiler = {"angle": "radian", "autolimits": "false", "inertiafromgeom": "false", "balanceinertia": "false"}
    # limbs move on their bodies, which the boxes of the mid-phase would not notice; islands would copy what is shared
    flags = Element("flag", {"midphase": "disable", "island": "disable"})
    looks = Element("global", {"offwidth": "1920", "offheight": "1200"})
    near = Element("map", {"znear": "0.005", "zfar": "60", "shadowclip": "0.7"})
    quality = Element("quality", {"shadowsize": "4096", "offsamples": "0", "numslices": "16", "numstacks": "8"})
    light = Element("headlight", {"ambient": "0.38 0.38 0.38", "diffuse": "0.3 0.3 0.3", "specular": "0 0 0"})
    return [
        Element("compiler", compiler),
        Element("option", {"integrator": "implicitfast", "cone": "elliptic"}, [flags]),
        Element("size", {"memory": ARENA}),
        Element("statistic", {"extent": "10", "center": "0 0 1"}),
        Element("visual", {}, [looks, quality, light, near]),
    ]


def _robot(scene: Scene, agent: int, robot: Robot, prefix: str, motors: Mapping[str, str] | None) -> Any:
    planar = robot.base == "planar"
    if isinstance(robot.drive, AckermannDrive) and not planar:
        raise InputError(
            f"robot {robot.name} of agent {agent} steers its wheels, which the physics world cannot; give it"
            ' base="planar"'
        )
    if not planar and not robot.wheels:
        raise InputError(f"robot {robot.name} of agent {agent} has no wheels that a motor turns; name them in its file")
    x, y = scene.position[0, agent]
    mass = robot.model.mass
    return mjcf(
        robot.model,
        base="planar" if planar else "free",
        place=(0.0, 0.0, 0.0) if planar else (float(x), float(y), 0.0),
        heading=0.0 if planar else float(scene.heading[0, agent]),
        prefix=prefix,
        motors=motors,
        servo=BaseServo(PULL * mass, SPIN * mass) if planar else None,
        contact=ROBOT,
    )


def _person(slot: int) -> Element:
    """Return a body of 17 limbs that glides on the floor; who takes it gives it mass, limbs and softness."""
    name = f"person{slot}"
    body = Element("body", {"name": name})
    body.children.append(Element("inertial", {"pos": "0 0 1", "mass": "70", "diaginertia": "5 5 1"}))
    for letter, axis in (("x", "1 0 0"), ("y", "0 1 0")):
        body.children.append(Element("joint", {"name": f"{name}/{letter}", "type": "slide", "axis": axis}))
    for limb in LIMBS:
        layer = TRUNK if limb.region == "torso" else LIMB
        values = {"name": f"{name}/{limb.name}", "type": "capsule", "size": "0.05 0.1", "pos": f"0 0 {PARKED}"}
        touch = {"priority": "2", "friction": row((0.4, 0.005, 0.0001)), "solimp": SPRING}
        body.children.append(Element("geom", {**values, **touch, **layer, "group": "4", "rgba": SKIN}))
    return body


LIMB_COUNT = len(LIMBS)
LIMB_NAMES = tuple(limb.name for limb in LIMBS)
LIMB_PARTS = np.array([("head", "torso", "arm", "leg").index(limb.region) for limb in LIMBS])
