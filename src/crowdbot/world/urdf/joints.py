"""Parser of URDF joints."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import Element, did_you_mean

from .elements import UrdfReader
from .model import JOINT_KINDS, Joint, Mimic, Motor

__all__ = ["read_joint"]


def read_joint(reader: UrdfReader, element: Element) -> Joint | None:
    """Return the joint that an element describes, or None after an error."""
    before = len(reader.found)
    name, kind = element.attributes.get("name", ""), element.attributes.get("type", "")
    if not name:
        reader.say(element, "needs the attribute 'name'")
    if kind not in JOINT_KINDS:
        reader.say(element, f"type={kind[:40]!r} must be {', '.join(JOINT_KINDS)}{did_you_mean(kind, JOINT_KINDS)}")
        return None
    parent, child = _link(reader, element, "parent"), _link(reader, element, "child")
    if parent and parent == child:
        reader.say(element, f"connects the link {parent!r} to itself")
    origin, axis = reader.origin(element), _axis(reader, element, kind)
    lower, upper, motor = _limits(reader, element, name, kind)
    spring = reader.springs.get(name, {})
    dynamics = reader.one(element, "dynamics") or Element("dynamics")
    values = {key: reader.value(dynamics, key, 0.0, 0.0) or 0.0 for key in ("damping", "friction")}
    values |= {
        key: reader.optional_value(dynamics, key, least)
        for key, least in (("spring_stiffness", 0.0), ("spring_reference", -1e6))
    }
    mimic = _mimic(reader, element, kind)
    if len(reader.found) > before:
        return None
    return Joint(
        name, kind, parent, child, origin, axis, lower, upper, motor,
        damping=values["damping"],
        friction=values["friction"],
        stiffness=values["spring_stiffness"] or spring.get("springStiffness", 0.0),
        rest=values["spring_reference"] or spring.get("springReference", 0.0),
        mimic=mimic,
    )  # fmt: skip


def _link(reader: UrdfReader, element: Element, role: str) -> str:
    inner = reader.one(element, role)
    name = inner.attributes.get("link", "") if inner else ""
    if not name:
        reader.say(element, f'needs <{role} link="...">')
    return name


def _axis(reader: UrdfReader, element: Element, kind: str) -> np.ndarray:
    inner = reader.one(element, "axis")
    values = None if inner is None else reader.row(inner, "xyz", 3, (1.0, 0.0, 0.0))
    if inner is None or values is None:
        return np.array([1.0, 0.0, 0.0])
    length = float(np.linalg.norm(values))
    if length < 1e-9:
        if kind not in ("fixed", "floating"):  # exporters write a zero axis for joints without an axis
            reader.say(inner, f'xyz="{inner.attributes["xyz"][:40]}" has no direction')
        return np.array([1.0, 0.0, 0.0])
    return np.asarray(values / length)


def _limits(reader: UrdfReader, element: Element, name: str, kind: str) -> tuple[float, float, Motor]:
    """Return the lower and upper limit of the position, and the motor."""
    inner = reader.one(element, "limit")
    commanded = reader.motors.get(name, "")
    if inner is None:
        if kind in ("revolute", "prismatic"):
            unit = "rad" if kind == "revolute" else "m"
            reader.say(element, f"({kind}) needs <limit lower= upper= effort= velocity=> [{unit}]")
        return -math.inf, math.inf, Motor(kind=commanded)
    effort = reader.value(inner, "effort", math.inf, 0.0)
    velocity = reader.value(inner, "velocity", math.inf, 0.0)
    motor = Motor(math.inf if effort is None else effort, math.inf if velocity is None else velocity, commanded)
    lower, upper = reader.value(inner, "lower", 0.0) or 0.0, reader.value(inner, "upper", 0.0) or 0.0
    if kind not in ("revolute", "prismatic"):
        return -math.inf, math.inf, motor
    if lower > upper:
        reader.say(inner, f"lower = {lower:g} is above upper = {upper:g}")
    elif lower == upper:
        reader.remark("noted", element, f"has the limits {lower:g} to {upper:g}, which allow no motion")
    return lower, upper, motor


def _mimic(reader: UrdfReader, element: Element, kind: str) -> Mimic | None:
    inner = reader.one(element, "mimic")
    if inner is None:
        return None
    if kind == "fixed":
        reader.remark("ignored", inner, "is ignored: a fixed joint does not move")
        return None
    joint = inner.attributes.get("joint", "")
    if not joint:
        reader.say(inner, "needs the attribute 'joint'")
    multiplier, offset = reader.value(inner, "multiplier", 1.0), reader.value(inner, "offset", 0.0)
    return Mimic(joint, 1.0 if multiplier is None else multiplier, offset or 0.0)
