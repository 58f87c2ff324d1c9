"""URDF parser: reports all errors with file and line, and returns a robot only if there are none."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from crowdbot.core import Element, InputError, RobotError, did_you_mean, format_xml

from .elements import UrdfReader
from .joints import read_joint
from .links import read_link
from .masses import add_missing_mass
from .materials import read_materials
from .model import Joint, Link, Remark, RobotModel
from .robot_document import parse_robot_file

__all__ = ["read_urdf"]

MOST_LINKS = 2000


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
