"""Conversion of a robot to MJCF, the XML format of MuJoCo.

Links fixed to each other become one body. Each link has a site with its name; its geoms are named ``link/0``,
``link/1`` (colliders, geom group 3) and ``link/seen/0`` (visuals, group 2).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import Element, InputError, did_you_mean, format_xml, import_optional
from crowdbot.typing import Floats

from .geoms import Geoms, row
from .inertia import unphysical
from .model import Joint, RobotModel
from .transforms import across, axis_rotation, frame, quaternion

BASES = ("free", "planar", "fixed", "kinematic")
KINDS = ("position", "velocity", "effort")
REACHED = 0.1
"""A velocity motor reaches its maximum force at an error of this share of its maximum speed.

A stiffer motor does not follow better: MuJoCo's ``implicitfast`` integrator corrects velocities for stiff motors after
solving contacts. With a gain of 0.02 and 5 ms steps, wheels run ahead of an increasing command by a third and slip.
"""
BENT = 0.05
"""A position motor reaches its maximum force at this error [rad or m]."""


class Mjcf(NamedTuple):
    """The MJCF of a robot as text and as a tree, and its mesh files."""

    xml: str
    assets: dict[str, bytes]
    root: Element

    def load(self) -> Any:
        """Return the ``mujoco.MjModel``.

        Raises:
            MissingExtra: mujoco is not installed.
        """
        mujoco = import_optional("mujoco", "the physics of robots", "sim")
        return mujoco.MjModel.from_xml_string(self.xml, self.assets)


@dataclass(frozen=True)
class BaseServo:
    """Actuators of a planar base: three velocity actuators at the centre of mass, in the frame of the base.

    Fields:
        max_force: maximum force [N] of ``base_forward`` and ``base_left``.
        max_torque: maximum torque [N m] of ``base_turn``.
        time_constant: time in which a velocity error falls to a third [s]. On a curve, the velocity lags by this time
            times turn rate times speed.
    """

    max_force: float
    max_torque: float
    time_constant: float = 0.01

    def __post_init__(self) -> None:
        for name in ("max_force", "max_torque", "time_constant"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise InputError(f"BaseServo: {name} = {getattr(self, name)} must be finite and above 0")


@dataclass
class _Build:
    """State shared by the functions below."""

    model: RobotModel
    base: str
    prefix: str
    geoms: Geoms
    collision: list[str]
    wheels: Mapping[str, float]

    def called(self, name: str) -> str:
        return f"{self.prefix}{name}"


def mjcf(
    model: RobotModel,
    *,
    base: str = "free",
    place: tuple[float, float, float] = (0.0, 0.0, 0.0),
    heading: float = 0.0,
    prefix: str = "",
    motors: Mapping[str, str] | None = None,
    servo: BaseServo | None = None,
    contact: tuple[int, int] = (1, 1),
    inside: bool = False,
    floor: bool = False,
    wheels: Mapping[str, float] | None = None,
) -> Mjcf:
    """Return a robot as MJCF.

    Args:
        model: the robot.
        base: motion of the root: ``free``; ``planar`` (joints ``base_x``, ``base_y``, ``base_yaw`` in the world);
            ``fixed``; ``kinematic`` (a mocap body).
        place: position of the root [m].
        heading: heading of the root about z [rad].
        prefix: prefix of all names, for several robots in one world.
        motors: command type of joints by name: ``position``, ``velocity``, ``effort``, or empty for no motor (default:
            as in the URDF, otherwise no motor). Actuators have the names of their joints.
        servo: actuators that move the base at a commanded twist.
        contact: MuJoCo's contype and conaffinity of the colliders.
        inside: whether self-collisions are enabled.
        floor: add a floor, a light and gravity, to view the robot alone.
        wheels: radii [m] of wheels by joint. Their colliders that are meshes become ellipsoids: a tyre of a mesh is a
            polygon, and the robot would hop from corner to corner.

    Raises:
        InputError: an option is unknown, or a moving base has no mass.
    """
    if base not in BASES:
        raise InputError(f"base = {base!r} must be one of {', '.join(BASES)}{did_you_mean(base, BASES)}")
    kinds = _motor_kinds(model, motors or {})
    build = _Build(model, base, prefix, Geoms(model, prefix, contact), [], wheels or {})
    body = _body(build, model.root, frame(place, axis_rotation((0.0, 0.0, 1.0), heading)))
    root = Element("mujoco", {"model": f"{prefix}{model.name}"})
    root.children.append(
        Element(
            "compiler",
            {"angle": "radian", "autolimits": "false", "inertiafromgeom": "false", "balanceinertia": "false"},
        )
    )
    root.children.append(Element("option", {"integrator": "implicitfast"}))
    world = Element("worldbody", {}, [*(_floor() if floor else []), body])
    sections = (
        Element("asset", {}, [*(_floor_assets() if floor else []), *build.geoms.meshes]),
        world,
        Element("contact", {}, [] if inside else _excluded(build)),
        Element("equality", {}, _equalities(build)),
        Element("actuator", {}, [*_servo(build, servo), *_motors(build, kinds)]),
    )
    root.children += [section for section in sections if section.children]
    return Mjcf(format_xml(root), build.geoms.files, root)


def _motor_kinds(model: RobotModel, given: Mapping[str, str]) -> dict[str, str]:
    free = {joint.name: joint for joint in model.movable}
    kinds = {name: joint.motor.kind for name, joint in free.items() if joint.size == 1 and not _is_locked(joint)}
    for name, kind in given.items():
        if name not in kinds:
            raise InputError(f"{model.name} has no movable joint {name!r}{did_you_mean(name, kinds)}")
        if kind and kind not in KINDS:
            raise InputError(f"motor of {name!r}: {kind!r} must be {', '.join(KINDS)}, or empty for no motor")
        kinds[name] = kind
    return kinds


def _is_locked(joint: Joint) -> bool:
    """Return whether the limits of a joint allow no motion."""
    return joint.upper - joint.lower < 1e-9


def _body(build: _Build, link: str, origin: Floats, joint: Joint | None = None) -> Element:
    """Return the body of a link, including the links fixed to it, and its child bodies."""
    body = Element("body", {"name": build.called(link), **_placed(origin)})
    fixed, moving = _fixed_links(build.model, link)
    if joint is not None:
        body.children += _joints(build, joint)
    elif build.base == "kinematic":
        body.attributes["mocap"] = "true"
    else:
        body.children += _base_joints(build)
    body.children += _mass(build, fixed, joint)
    if joint is None:
        height = float(build.model.inertial().center[2])
        body.children.append(
            Element("site", {"name": build.called("base/pull"), "group": "4", "pos": row((0.0, 0.0, height))})
        )
    axle = joint.axis if joint is not None and joint.kind in ("continuous", "revolute") else None
    for name, matrix in fixed.items():
        body.children.append(
            Element("site", {"name": build.called(name), "group": "4", "size": "0.01", **_placed(matrix)})
        )
        radius = build.wheels.get(joint.name, 0.0) if joint is not None else 0.0
        shapes = build.geoms.of(build.model.links[name], matrix, axle, radius)
        body.children += shapes
        if any(shape.attributes.get("group") == "3" for shape in shapes) and build.called(link) not in build.collision:
            build.collision.append(build.called(link))
    for inner, matrix in moving:
        body.children.append(_body(build, inner.child, matrix, inner))
    return body


def _fixed_links(model: RobotModel, link: str) -> tuple[dict[str, Floats], list[tuple[Joint, Floats]]]:
    """Return the links fixed to a link with their frames in it, and the joints that move relative to them."""
    below: dict[str, list[Joint]] = {}
    for joint in model.joints.values():
        below.setdefault(joint.parent, []).append(joint)
    fixed, moving, waiting = {link: np.eye(4)}, [], [link]
    while waiting:
        name = waiting.pop(0)
        for joint in below.get(name, ()):
            place = fixed[name] @ joint.origin
            if joint.kind == "fixed":
                fixed[joint.child] = place
                waiting.append(joint.child)
            else:
                moving.append((joint, place))
    return fixed, moving


def _placed(matrix: Floats) -> dict[str, str]:
    return {"pos": row(matrix[:3, 3]), "quat": row(quaternion(matrix[:3, :3]))}


def _base_joints(build: _Build) -> list[Element]:
    if build.base == "free":
        return [Element("freejoint", {"name": build.called("base")})]
    if build.base == "fixed":
        return []
    axes = (("x", "slide", "1 0 0"), ("y", "slide", "0 1 0"), ("yaw", "hinge", "0 0 1"))
    return [
        Element("joint", {"name": build.called(f"base_{name}"), "type": kind, "axis": axis, "limited": "false"})
        for name, kind, axis in axes
    ]


def _joints(build: _Build, joint: Joint) -> list[Element]:
    name = build.called(joint.name)
    if joint.kind == "floating":
        slides = [("slide", axis) for axis in np.eye(3)]
        words = [f"{name}/{letter}" for letter in "xyz"]
        rows = [
            Element("joint", {"name": w, "type": k, "axis": row(a)}) for w, (k, a) in zip(words, slides, strict=True)
        ]
        return [*rows, Element("joint", {"name": name, "type": "ball"})]
    if joint.kind == "planar":
        plane = across(joint.axis)
        shared = _dynamics(joint)
        rows = [
            Element("joint", {"name": f"{name}/{w}", "type": "slide", "axis": row(plane[:, k]), **shared})
            for k, w in enumerate("xy")
        ]
        return [*rows, Element("joint", {"name": name, "type": "hinge", "axis": row(joint.axis), **shared})]
    if _is_locked(joint):
        return []
    kind = "slide" if joint.kind == "prismatic" else "hinge"
    values = {"name": name, "type": kind, "axis": row(joint.axis), **_dynamics(joint)}
    if joint.upper - joint.lower < 1e5:
        values |= {"limited": "true", "range": row((joint.lower, joint.upper))}
    return [Element("joint", values)]


def _dynamics(joint: Joint) -> dict[str, str]:
    named = {"damping": joint.damping, "frictionloss": joint.friction, "stiffness": joint.stiffness}
    if joint.stiffness:
        named["springref"] = joint.rest
    return {key: row((value,)) for key, value in named.items() if value}


def _mass(build: _Build, fixed: Mapping[str, Floats], joint: Joint | None) -> list[Element]:
    """Return the inertial of a body, from all its links."""
    links = {name: build.model.links[name] for name in fixed}
    part = dataclasses.replace(
        build.model,
        links=links,
        joints={name: j for name, j in build.model.joints.items() if j.kind == "fixed" and j.child in fixed},
        root=next(iter(fixed)),
    )
    whole = part.inertial()
    if whole.mass <= 0.0:
        if joint is None and build.base in ("free", "planar"):
            raise InputError(
                f"the base {part.root!r} of {build.model.name} has no mass; use base='fixed' or base='kinematic'"
            )
        return []
    tensor = whole.tensor
    assert not unphysical(tensor)
    values = [tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2]]
    return [Element("inertial", {"pos": row(whole.center), "mass": row((whole.mass,)), "fullinertia": row(values)})]


def _excluded(build: _Build) -> list[Element]:
    names = build.collision
    return [
        Element("exclude", {"body1": name, "body2": other}) for k, name in enumerate(names) for other in names[k + 1 :]
    ]


def _equalities(build: _Build) -> list[Element]:
    rows = []
    for joint in build.model.joints.values():
        if joint.mimic is None or _is_locked(joint) or _is_locked(build.model.joints[joint.mimic.joint]):
            continue
        line = (joint.mimic.offset, joint.mimic.multiplier, 0.0, 0.0, 0.0)
        names = {"joint1": build.called(joint.name), "joint2": build.called(joint.mimic.joint)}
        rows.append(Element("joint", {**names, "polycoef": row(line)}))
    return rows


def _servo(build: _Build, servo: BaseServo | None) -> list[Element]:
    if servo is None:
        return []
    if build.base not in ("free", "planar"):
        raise InputError(f"a base servo needs base='free' or base='planar', not {build.base!r}")
    whole = build.model.inertial()
    rows = []
    for name, gear, force, load in (
        ("base_forward", "1 0 0 0 0 0", servo.max_force, whole.mass),
        ("base_left", "0 1 0 0 0 0", servo.max_force, whole.mass),
        ("base_turn", "0 0 0 0 0 1", servo.max_torque, float(whole.tensor[2, 2])),
    ):
        values = {"name": build.called(name), "site": build.called("base/pull"), "gear": gear}
        values |= {"kv": row((load / servo.time_constant,)), **_capped(force)}
        rows.append(Element("velocity", values))
    return rows


def _motors(build: _Build, kinds: Mapping[str, str]) -> list[Element]:
    rows = []
    for name, kind in kinds.items():
        if not kind:
            continue
        motor = build.model.joints[name].motor
        named = {"name": build.called(name), "joint": build.called(name), **_capped(motor.effort)}
        finite = math.isfinite(motor.effort) and motor.effort > 0.0
        if kind == "velocity":
            speed = motor.velocity if math.isfinite(motor.velocity) and motor.velocity > 0.0 else 1.0
            rows.append(
                Element("velocity", named | {"kv": row((motor.effort / (REACHED * speed) if finite else 10.0,))})
            )
        elif kind == "position":
            stiff = {"kp": row((motor.effort / BENT if finite else 100.0,)), "dampratio": "1"}
            joint = build.model.joints[name]
            if joint.upper - joint.lower < 1e5:  # a servo does not push against its own limits
                stiff |= {"ctrllimited": "true", "ctrlrange": row((joint.lower, joint.upper))}
            rows.append(Element("position", named | stiff))
        else:
            rows.append(Element("motor", named))
    return rows


def _capped(force: float) -> dict[str, str]:
    if not math.isfinite(force) or force <= 0.0:
        return {"forcelimited": "false"}
    return {"forcelimited": "true", "forcerange": row((-force, force))}


def _floor() -> list[Element]:
    return [
        Element("light", {"pos": "2 -2 4", "dir": "-0.4 0.4 -1", "diffuse": "0.7 0.7 0.7"}),
        Element("geom", {"name": "floor", "type": "plane", "size": "5 5 0.1", "material": "floor"}),
    ]


def _floor_assets() -> list[Element]:
    return [Element("material", {"name": "floor", "rgba": "0.86 0.87 0.88 1"})]
