"""MJCF model of a world: stage, robots, and a pool of bodies for people near robots."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import Element, InputError, Scene, format_xml
from crowdbot.humans import LIMBS
from crowdbot.world.ground.ground import Ground
from crowdbot.world.robots.drives.ackermann import AckermannDrive, TricycleDrive
from crowdbot.world.robots.drives.skid_steer import SkidSteerDrive
from crowdbot.world.robots.robot import Robot
from crowdbot.world.robots.wheel import resistance
from crowdbot.world.urdf import BaseServo, mjcf
from crowdbot.world.urdf.geoms import row

from .engine import engine
from .layers import LIMB, PULLED, ROBOT, TRUNK
from .scenery import scenery
from .stage import PhysicsStage

PARKED = 60.0
"""Height [m] of the limbs of unused bodies."""
PULL, SPIN = 4.0, 1.5
"""Maximum force [N] and torque [N m] of a pulled base, per kg of the robot."""
ROTOR = 1e-4
"""Minimum inertia [kg m2] about the axis of a hinge (assumed: a small geared motor)."""
QUICKEST = 0.5
"""Minimum response time of joint motors, in engine steps."""
GRAVITY = 9.81
FIRM = 0.99
"""Solver impedance of tyres; that of other contacts is 0.9 to 0.95."""
YIELDING = 0.8
"""Solver impedance of tyres of skid-steer bases: they are pressed in by about a millimetre."""
LEAN = 1e-6
"""Angle [rad] about x and y by which cylinders lean."""
SKIN = "0.85 0.70 0.60 1"
ARENA = "64M"
SPRING = "0.5 0.5 0.001 0.5 2"
"""Solver parameters of limb contacts: a spring and a damper whose force does not depend on the number of limbs."""


class MjcfModel(NamedTuple):
    """A world model: XML tree, mesh files, name ``prefixes`` of the robots, joints of all ``wheels``, largest
    ``torques`` [N m] of the motors that drive and steer wheels by joint, joints of wheels of ``skidding`` bases, and of
    those that carry their robots (``bearing``).
    """

    root: Element
    files: dict[str, bytes]
    prefixes: dict[int, str]
    wheels: frozenset[str]
    torques: dict[str, float]
    skidding: frozenset[str] = frozenset()
    bearing: frozenset[str] = frozenset()

    def load(self, timestep: float) -> Any:
        """Return the ``mujoco.MjModel``.

        Raises:
            InputError: MuJoCo refuses the model.
        """
        try:
            model = engine().MjModel.from_xml_string(format_xml(self.root), self.files)
        except ValueError as error:
            raise InputError(f"MuJoCo refuses the world: {' '.join(str(error).split())[:300]}") from None
        model.opt.timestep = timestep
        _steadied(model, self.wheels)
        _lean(model)
        _firm(model, self.bearing, self.skidding)
        return model


def build_mjcf_model(
    scene: Scene,
    stage: PhysicsStage,
    robots: Mapping[int, Robot],
    slots: int,
    motors: Mapping[int, Mapping[str, str]] | None = None,
    posed: bool = False,
) -> MjcfModel:
    """Return the MJCF model of a world.

    Args:
        scene: initial scene with walls and robots.
        stage: props and lights.
        robots: robots by agent index.
        slots: number of people that can have a body at the same time.
        motors: command types of robot joints by agent and joint, see :func:`crowdbot.world.urdf.mjcf`.
        posed: robots are placed from outside instead of simulated.

    Raises:
        InputError: a robot has no driven or steered wheels.
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
            base = base_height(stage.ground, scene, agent, robot)
            made = _robot(scene, agent, robot, prefixes[agent], (motors or {}).get(agent), base)
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
    wheels = {prefixes[agent] + wheel.joint for agent, robot in robots.items() for wheel in robot.wheels}
    torques = {
        prefixes[agent] + joint: most
        for agent, robot in robots.items()
        for joint, most in _torques(robot).items()
        if robot.base != "planar" and not posed
    }
    skidding = {
        prefixes[agent] + wheel.joint
        for agent, robot in robots.items()
        for wheel in robot.wheels
        if isinstance(robot.drive, SkidSteerDrive)
    }
    bearing = {
        prefixes[agent] + wheel.joint
        for agent, robot in robots.items()
        for wheel in robot.wheels
        if robot.base != "planar" and not posed
    }
    return MjcfModel(root, files, prefixes, frozenset(wheels), torques, frozenset(skidding), frozenset(bearing))


def _torques(robot: Robot) -> dict[str, float]:
    """Return the largest torques [N m] of the motors that drive and steer wheels; without a limit, enough to spin."""
    torques = {}
    for wheel in robot.wheels:
        for joint in (wheel.joint if wheel.driven else "", wheel.steering):
            if joint:
                effort = robot.model.joints[joint].motor.effort
                limited = math.isfinite(effort) and effort > 0.0
                speed = float(getattr(robot.drive, "max_speed", 0.0)) / wheel.radius
                spin = GRAVITY * robot.model.mass * wheel.radius + resistance(robot.model.joints[joint], speed)
                torques[joint] = effort if limited else spin
    return torques


def _firm(model: Any, bearing: Collection[str], skidding: Collection[str]) -> None:
    """Make the tyres of wheels firm, with their friction on this floor.

    Soft tyres creep sideways in curves, and castors would take the load off them. Tyres of a skid-steer base yield:
    four firm ones on a rigid frame lose contact in turns, and hop. They are equally stiff, so that middle axles bear
    their share; the engine would make contacts stiffer near the centre of mass.
    """
    bodies = [int(model.jnt_bodyid[model.joint(name).id]) for name in bearing]
    tires = np.isin(model.geom_bodyid, bodies) & (model.geom_contype > 0)
    model.geom_solimp[tires, :2] = FIRM
    yielding = [int(model.jnt_bodyid[model.joint(name).id]) for name in sorted(bearing) if name in skidding]
    for root in {int(model.body_rootid[body]) for body in yielding}:
        own = [body for body in yielding if model.body_rootid[body] == root]
        model.body_invweight0[own, 0] = model.body_invweight0[own, 0].mean()
    model.geom_solimp[tires & np.isin(model.geom_bodyid, yielding), :2] = YIELDING
    model.geom_friction[tires, 0] *= model.geom("floor").friction[0]


def _lean(model: Any) -> None:
    """Lean upright cylinders by a millionth of a radian, 0.3 um over a robot.

    The engine divides the distance of a disc and a floor by the sine of the angle between them. If the angle is a
    rounding error, it finds a contact a whole radius deep, which throws the robot.
    """
    mj = engine()
    turn, found = np.array([1.0, 0.5 * LEAN, 0.5 * LEAN, 0.0]), np.zeros(4)
    for geom in np.flatnonzero(model.geom_type == mj.mjtGeom.mjGEOM_CYLINDER):
        mj.mju_mulQuat(found, model.geom_quat[geom], turn)
        model.geom_quat[geom] = found / np.linalg.norm(found)
        model.geom_sameframe[geom] = 0


def _steadied(model: Any, wheels: Collection[str]) -> None:
    """Increase the inertia of light joints for a stable simulation; joints of wheels carry the whole robot.

    Hinges of light links get the rotor inertia of a motor. The stiffness of a motor is reduced with the inertia of its
    joint, since a stiff motor would oscillate between its force limits.
    """
    mj = engine()
    hinge = model.jnt_type == mj.mjtJoint.mjJNT_HINGE
    turned = model.jnt_dofadr[hinge]
    lack = ROTOR - model.dof_M0[turned]
    if np.any(lack > 0.0):
        model.dof_armature[turned] += np.maximum(lack, 0.0)
        mj.mj_setConst(model, mj.MjData(model))
    for motor in range(model.nu):
        name = model.actuator(motor).name
        if model.actuator_trntype[motor] != mj.mjtTrn.mjTRN_JOINT or name in wheels:
            continue
        inertia = float(model.dof_M0[model.jnt_dofadr[model.actuator_trnid[motor, 0]]])
        quickest = QUICKEST / model.opt.timestep
        if model.actuator_biasprm[motor, 1] < -inertia * quickest**2:
            model.actuator_gainprm[motor, 0] = inertia * quickest**2
            model.actuator_biasprm[motor, 1:3] = -inertia * quickest**2, -2.0 * inertia * quickest
        elif model.actuator_biasprm[motor, 1] == 0.0 and model.actuator_biasprm[motor, 2] < -inertia * quickest:
            model.actuator_gainprm[motor, 0] = inertia * quickest
            model.actuator_biasprm[motor, 2] = -inertia * quickest


def _settings() -> list[Element]:
    compiler = {"angle": "radian", "autolimits": "false", "inertiafromgeom": "false", "balanceinertia": "false"}
    # the mid-phase would miss limbs that move on their bodies; islands would copy shared data
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


def _robot(scene: Scene, agent: int, robot: Robot, prefix: str, motors: Mapping[str, str] | None, height: float) -> Any:
    planar = robot.base == "planar"
    steers = any(wheel.steering for wheel in robot.wheels)
    who = f"robot {robot.name} of agent {agent}"
    if not planar and not any(wheel.driven for wheel in robot.wheels):
        raise InputError(f"{who} has no driven wheels; list them in its robot.xml")
    if not planar and steers != isinstance(robot.drive, AckermannDrive | TricycleDrive):
        raise InputError(
            f"{who} has a drive {type(robot.drive).__name__} and {'' if steers else 'no '}steered wheels; use"
            ' base="planar", or an AckermannDrive or TricycleDrive with steered wheels'
        )
    kinds = {wheel.joint: "velocity" for wheel in robot.wheels if wheel.driven and not planar}
    kinds |= {wheel.steering: "position" for wheel in robot.wheels if wheel.steering and not planar}
    x, y = scene.position[0, agent]
    mass = robot.model.mass
    return mjcf(
        robot.model,
        base="planar" if planar else "free",
        place=(0.0, 0.0, height) if planar else (float(x), float(y), height),
        heading=0.0 if planar else float(scene.heading[0, agent]),
        prefix=prefix,
        motors={**(motors or {}), **kinds},
        servo=BaseServo(PULL * mass, SPIN * mass) if planar else None,
        contact=PULLED if planar else ROBOT,
        wheels={} if planar else {wheel.joint: wheel.radius for wheel in robot.wheels},
    )


def _person(slot: int) -> Element:
    """Return a body with 17 limbs that slides on the floor; mass, limbs and stiffness are set when it is assigned."""
    name = f"person{slot}"
    body = Element("body", {"name": name})
    body.children.append(Element("inertial", {"pos": "0 0 1", "mass": "70", "diaginertia": "5 5 1"}))
    for letter, axis in (("x", "1 0 0"), ("y", "0 1 0")):
        body.children.append(Element("joint", {"name": f"{name}/{letter}", "type": "slide", "axis": axis}))
    for limb in LIMBS:
        layer = TRUNK if limb.region == "torso" else LIMB
        values = {"name": f"{name}/{limb.name}", "type": "capsule", "size": "0.05 0.1", "pos": f"0 0 {PARKED}"}
        values["quat"] = "0.5 0.5 0.5 0.5"  # an upright capsule in the model would be kept upright by the engine
        soft = {"priority": "2", "friction": row((0.4, 0.005, 0.0001)), "solimp": SPRING}
        body.children.append(Element("geom", {**values, **soft, **layer, "group": "4", "rgba": SKIN}))
    return body


LIMB_COUNT = len(LIMBS)
LIMB_NAMES = tuple(limb.name for limb in LIMBS)


def base_height(ground: Ground | None, scene: Scene, agent: int, robot: Robot) -> float:
    """Return the height [m] of the root of a robot at its place in a scene, on the highest ground under it."""
    if ground is None:
        return robot.lift
    return robot.lift + float(ground.support(scene.position[0, agent], robot.radius))
