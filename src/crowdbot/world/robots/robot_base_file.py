"""Robot files that extend a built-in robot: a version of it with other sensors, limits or a rider."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from crowdbot.core import Element, parse_xml, read_bytes

__all__ = ["extend_robot"]

NAMED = {"sensor": "name", "wheel": "joint", "posture": "joint", "link": "name"}
"""Elements of which there may be several, with the attribute that tells them apart."""


def extend_robot(root: Element, folder: Path, shipped: Callable[[str], Path]) -> tuple[Element, Path]:
    """Return the element of a robot file with what it takes from the built-in robot that it extends.

    Attributes, drive and footprint of the file replace those of the built-in robot; so do sensors of the same name,
    wheels and postures of the same joint, and links of the same name. ``default-sensors="false"`` takes no sensors.

    Args:
        root: element of the file, with the attribute ``extends``.
        folder: its folder.
        shipped: returns the robot file of a built-in robot, or raises an error.

    Returns:
        The element, and the folder of its URDF file.
    """
    name = root.attributes.pop("extends", "")
    own_sensors = root.attributes.pop("default-sensors", "true") == "false"
    if not name:
        return root, folder
    path = shipped(name)
    base = parse_xml(read_bytes(path, "robot"), str(path), what="robot", root="robot")
    base, place = extend_robot(base, path.parent, shipped)
    given, model = {_key(one) for one in root.children}, root.attributes.get("urdf")
    taken = [one for one in base.children if _key(one) not in given and not (own_sensors and one.tag == "sensor")]
    root.attributes = {**base.attributes, "name": folder.resolve().name, **root.attributes}
    root.children = [*taken, *root.children]
    return root, folder if model else place


def _key(element: Element) -> tuple[str, str]:
    return element.tag, element.attributes.get(NAMED.get(element.tag, ""), "")
