"""URDF parser: reports all errors with file and line, and returns a robot only if there are none."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from crowdbot.core import Element, InputError, RobotError, did_you_mean, format_xml

from .elements import UrdfReader
from .inertia import DENSITY, solid_of
from .links import read_link, read_materials
from .model import JOINT_KINDS, Joint, Link, LinkInertia, Mimic, Motor, Remark, RobotModel
from .robot_document import parse_robot_file

MOST_LINKS = 2000
TOKEN = LinkInertia(0.001, np.zeros(3), np.eye(3) * 1e-7)
"""Inertial of a moving link without mass and shape: a ball of 1 gram with a diameter of 16 mm."""
SMALL = 0.1
"""Maximum mass [kg] of a moving link with a shape but without mass."""


def read_urdf(
    source: str | Path,
    *,
    folder: Path | None = None,
    packages: Mapping[str, Path] | None = None,
    colliders: str = "auto",
    arguments: Mapping[str, str] | None = None,
    environment: Mapping[str, str] | None = None,
) -> RobotModel:
    """Read a robot from a URDF, xacro or SDF file.

    Repairs are listed in ``remarks``. A missing or broken mesh is replaced by the other colliders of the link,
    otherwise by its visuals, otherwise by the box of equal inertia. A missing or unphysical inertia is computed from
    mass and shape.

    Args:
        source: the path of a URDF, xacro or SDF file, or the XML text itself (it begins with ``<``).
        folder: robot folder; files outside it are not read (default: :func:`crowdbot.world.urdf.robot_folder`, and
            the packages beside it that the file names).
        packages: ROS package folders by name, for ``package://name/...``; files in them may be read, too.
        colliders: conversion of meshes to convex shapes: ``auto``, ``hull`` or ``pieces``, see
            :func:`crowdbot.world.urdf.with_pieces`.
        arguments: values of ``<xacro:arg>`` by name.
        environment: values of ``$(env)`` and ``$(optenv)`` in xacro; the environment of the process is not read.

    Raises:
        RobotError: the URDF has errors; the exception lists all of them in line order.
        MissingExtra: the URDF names meshes and trimesh is not installed.

    >>> read_urdf("<robot name='r'><link name='a'/><link name='b'/></robot>")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    crowdbot.core.errors.RobotError: urdf:1: <robot> the links 'a' and 'b' are both the root: no joint has them as ...
    """
    if colliders not in ("auto", "hull", "pieces"):
        raise InputError(f"colliders = {colliders!r} must be auto, hull or pieces")
    parsed = parse_robot_file(source, folder=folder, packages=packages, arguments=arguments, environment=environment)
    reader = UrdfReader(parsed.place, parsed.folders, colliders)
    reader.remarks += [Remark("ignored", sentence) for sentence in parsed.ignored]
    return _robot(reader, parsed.root)


def _robot(reader: UrdfReader, root: Element) -> RobotModel:
    name = root.attributes.get("name", "").strip() or "robot"
    reader.materials = read_materials(reader, root)
    reader.notes(root)
    links: dict[str, Link] = {}
    elements: dict[str, Element] = {}
    joints: dict[str, Joint] = {}
    lines: dict[str, int] = {}
    if len(root.each("link")) > MOST_LINKS:
        raise RobotError(f"{reader.place}:{root.line}: more than {MOST_LINKS} links, the maximum")
    for element in root.each("link"):
        link = read_link(reader, element)
        if link is not None and reader.new(element, link.name, links):
            links[link.name], elements[link.name] = link, element
    for element in root.each("joint"):
        joint = read_joint(reader, element)
        if joint is not None and reader.new(element, joint.name, joints):
            joints[joint.name], lines[joint.name] = joint, element.line
    if not root.each("link"):
        reader.say(root, "contains no <link>; a robot needs at least one")
    if not reader.found:
        _check_tree(reader, root, links, joints, lines)
        _check_mimics(reader, joints, lines)
    reader.finish()
    first = next(iter(links.keys() - {joint.child for joint in joints.values()}))
    ordered = _sort_outwards(first, joints)
    chain = [first, *(joint.child for joint in ordered.values())]
    kept = add_missing_mass(reader, {key: links[key] for key in chain}, ordered, elements)
    for package, names in reversed(reader.missing.items()):
        count = "a mesh file" if len(names) == 1 else f"{len(names)} mesh files"
        reader.remarks.insert(
            0,
            Remark(
                "replaced",
                f"the package {package[:60]!r} is not found, and {count} of it {'is' if len(names) == 1 else 'are'}"
                f" missing (give --package {package[:60]}=FOLDER if you have it)",
            ),
        )
    files, textures = dict(reader.files), dict(reader.textures)
    return RobotModel(name, kept, ordered, first, tuple(reader.remarks), files, _text(name, root), textures)


def _text(name: str, root: Element) -> str:
    """Return the URDF text of links, joints and materials."""
    rows = [element for element in root.children if element.tag in ("link", "joint", "material")]
    return format_xml(Element("robot", {"name": name}, rows))


def _check_tree(
    reader: UrdfReader, root: Element, links: dict[str, Link], joints: dict[str, Joint], lines: dict[str, int]
) -> None:
    """Record errors if links and joints do not form one tree."""
    above: dict[str, Joint] = {}
    for joint in joints.values():
        at = Element("joint", {"name": joint.name}, line=lines[joint.name])
        for role, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in links:
                reader.say(at, f"has the {role} {name!r}, which is not a link{did_you_mean(name, links)}")
        if joint.child in above:
            other = above[joint.child].name
            reader.say(at, f"moves the link {joint.child!r}, which is also moved by {other!r}: the links form a loop")
        above[joint.child] = joint
    if reader.found:
        return
    roots = [name for name in links if name not in above]
    if len(roots) > 1:
        both = " and ".join(repr(name) for name in roots[:2])
        which = f"the links {both} are both" if len(roots) == 2 else f"{len(roots)} links, {both} among them, are each"
        reader.say(root, f"{which} the root: no joint has them as a child; exactly one link must be the root")
    reached: set[str] = set(roots)
    for name in links:
        chain: dict[str, None] = {}
        while name not in reached and name not in chain:
            chain[name] = None
            name = above[name].parent  # noqa: PLW2901
        if name in chain:
            joint = above[name]
            at = Element("joint", {"name": joint.name}, line=lines[joint.name])
            circle = [*chain][[*chain].index(name) :]
            reader.say(at, f"closes a loop of links: {' <- '.join([*circle, name][:8])}")
        reached |= chain.keys()


def _check_mimics(reader: UrdfReader, joints: dict[str, Joint], lines: dict[str, int]) -> None:
    for joint in joints.values():
        at = Element("joint", {"name": joint.name}, line=lines[joint.name])
        leader, seen = joint, {joint.name}
        while leader.mimic:
            name = leader.mimic.joint
            if name not in joints:
                reader.say(at, f"mimics {name!r}, which is not a joint{did_you_mean(name, joints)}")
                break
            if name in seen:
                reader.say(at, f"mimics itself through {name!r}")
                break
            leader = joints[name]
            seen.add(name)
        if joint.mimic and not leader.mimic and (leader.size != 1 or joint.size != 1):
            reader.say(
                at, f"mimics {leader.name!r}; only revolute, continuous and prismatic joints can mimic each other"
            )


def _sort_outwards(first: str, joints: dict[str, Joint]) -> dict[str, Joint]:
    """Return the joints sorted from the root outwards."""
    below: dict[str, list[Joint]] = {}
    for joint in joints.values():
        below.setdefault(joint.parent, []).append(joint)
    ordered: dict[str, Joint] = {}
    waiting = [first]
    while waiting:
        for joint in below.get(waiting.pop(0), ()):
            ordered[joint.name] = joint
            waiting.append(joint.child)
    return ordered


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
    dynamics = reader.first(element, "dynamics") or Element("dynamics")
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
    inner = reader.first(element, role)
    name = inner.attributes.get("link", "") if inner else ""
    if not name:
        reader.say(element, f'needs <{role} link="...">')
    return name


def _axis(reader: UrdfReader, element: Element, kind: str) -> np.ndarray:
    inner = reader.first(element, "axis")
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
    inner = reader.first(element, "limit")
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
    inner = reader.first(element, "mimic")
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


def add_missing_mass(
    reader: UrdfReader, links: Mapping[str, Link], joints: Mapping[str, Joint], elements: Mapping[str, Element]
) -> dict[str, Link]:
    """Return the links, with a small inertial for each moving part that has no mass.

    In URDF a link without ``<inertial>`` has no mass. A part is a link with all links fixed to it; if one of them has
    mass, nothing is added. If no link of the file has mass, every link with a shape gets the mass of its shape at the
    density of water, since forces need masses and only their ratio is known. Each addition is a remark.

    Args:
        reader: collects the remarks.
        links, joints: by name; parents come before their children.
        elements: the elements of the links, for line numbers.
    """
    if not any(link.inertial for link in links.values()):
        missing_mass = {name: _at_water_density(reader, link, elements[name]) for name, link in links.items()}
    else:
        missing_mass = dict(links)
    above = {joint.child: joint for joint in joints.values()}
    part: dict[str, str] = {}
    members: dict[str, list[str]] = {}
    for name in missing_mass:
        joint = above.get(name)
        part[name] = part[joint.parent] if joint is not None and joint.kind == "fixed" else name
        members.setdefault(part[name], []).append(name)
    for first, names in members.items():
        if not any(missing_mass[name].inertial for name in names):
            shown = next((name for name in names if missing_mass[name].collisions or missing_mass[name].visuals), None)
            if shown is not None or first in above:
                name = shown or first
                missing_mass[name] = _with_small_mass(reader, missing_mass[name], elements[name])
    return missing_mass


def _at_water_density(reader: UrdfReader, link: Link, element: Element) -> Link:
    solid = solid_of(link.collisions or link.visuals)
    if solid is None:
        return link
    mass = DENSITY * solid.volume
    reader.remark(
        "repaired",
        element,
        f"has no inertial, like all links of the file; mass {mass:.3g} kg and inertia are computed from its shape at"
        f" {DENSITY:g} kg/m3",
    )
    return dataclasses.replace(link, inertial=LinkInertia(mass, solid.center, solid.inertia(mass)))


def _with_small_mass(reader: UrdfReader, link: Link, element: Element) -> Link:
    """Return a moving link with at most 0.1 kg, or 1 gram without a shape."""
    solid = solid_of(link.collisions or link.visuals)
    if solid is None:
        reader.remark(
            "repaired", element, f"moves but has neither mass nor shape; its mass is set to {TOKEN.mass:g} kg"
        )
        return dataclasses.replace(link, inertial=TOKEN)
    mass = min(SMALL, DENSITY * solid.volume)
    reader.remark(
        "repaired",
        element,
        f"moves but neither it nor a link fixed to it has a mass; its mass is set to {mass:.3g} kg, add <inertial> if"
        " it is heavier",
    )
    return dataclasses.replace(link, inertial=LinkInertia(mass, solid.center, solid.inertia(mass)))
