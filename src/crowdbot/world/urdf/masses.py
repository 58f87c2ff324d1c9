"""Masses of links that have none in the file."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np

from crowdbot.core import Element

from .elements import UrdfReader
from .inertia import DENSITY, solid_of
from .model import Joint, Link, LinkInertia

__all__ = ["add_missing_mass"]

TOKEN = LinkInertia(0.001, np.zeros(3), np.eye(3) * 1e-7)
"""Inertial of a moving link without mass and shape: a ball of 1 gram with a diameter of 16 mm."""
SMALL = 0.1
"""Maximum mass [kg] of a moving link with a shape but without mass."""


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
        found = {name: _at_water_density(reader, link, elements[name]) for name, link in links.items()}
    else:
        found = dict(links)
    above = {joint.child: joint for joint in joints.values()}
    part: dict[str, str] = {}
    members: dict[str, list[str]] = {}
    for name in found:
        joint = above.get(name)
        part[name] = part[joint.parent] if joint is not None and joint.kind == "fixed" else name
        members.setdefault(part[name], []).append(name)
    for first, names in members.items():
        if not any(found[name].inertial for name in names):
            shown = next((name for name in names if found[name].collisions or found[name].visuals), None)
            if shown is not None or first in above:
                name = shown or first
                found[name] = _with_small_mass(reader, found[name], elements[name])
    return found


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
