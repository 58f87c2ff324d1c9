"""Parser of URDF links: shapes, colours and inertial."""

from __future__ import annotations

import numpy as np

from crowdbot.core import Element, InputError
from crowdbot.typing import Floats

from .elements import LARGEST, Color, UrdfReader
from .inertia import default_inertia, find_inertia_problems, repair_inertia
from .mesh_colors import mean_color
from .model import Link, LinkInertia, LinkShape
from .shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere


def read_materials(reader: UrdfReader, root: Element) -> dict[str, Color]:
    """Return the colours of the materials of the robot and of named materials in visuals, by name."""
    inside = [m for link in root.each("link") for visual in link.each("visual") for m in visual.each("material")]
    materials: dict[str, Color] = {}
    for element in [*root.each("material"), *inside]:
        name = element.attributes.get("name", "")
        if name and name not in materials:
            color = _color(reader, element)
            if color is not None:
                materials[name] = color
    return materials


def read_color(reader: UrdfReader, visual: Element) -> Color | None:
    """Return the colour of a visual, or the mean colour of its texture; None without both."""
    material = reader.first(visual, "material")
    if material is None:
        return None
    color = _color(reader, material)
    if color is not None:
        return color
    name = material.attributes.get("name", "")
    if name in reader.materials:
        return reader.materials[name]
    for texture in material.each("texture"):
        mean = _mean_color(reader, texture)
        if mean is not None:
            return mean
    if name and not material.each("texture"):
        reader.remark("ignored", material, f"uses the colour {name[:40]!r}, which is not defined; grey is used")
    return None


def _mean_color(reader: UrdfReader, texture: Element) -> Color | None:
    """Return the mean colour of an image, since shapes of a URDF have no texture coordinates."""
    name = texture.attributes.get("filename", "").strip()
    if not name:
        return None
    if name not in reader.mean_colors:
        try:
            path = reader.folders.find(name)
            if path is None:
                raise InputError("is missing")
            reader.mean_colors[name] = mean_color(path)
        except (InputError, OSError) as error:
            reader.remark("ignored", texture, f"the texture {name[:80]!r} {error}; grey is used")
            reader.mean_colors[name] = None
    return reader.mean_colors[name]


def _color(reader: UrdfReader, material: Element) -> Color | None:
    element = next(iter(material.each("color")), None)
    values = None if element is None else reader.row(element, "rgba", 4, None)
    if element is None or values is None:
        return None
    if values.min() < 0.0 or values.max() > 1.0:
        reader.remark("repaired", element, f'rgba="{element.attributes["rgba"][:40]}" was clipped to 0 to 1')
    red, green, blue, alpha = (min(1.0, max(0.0, float(value))) for value in values)
    return red, green, blue, alpha


SHAPES = ("box", "cylinder", "sphere", "capsule", "mesh")
OTHERS_REFUSE = "RViz, Gazebo and MuJoCo refuse this, too: write its size, or leave out the <visual> or <collision>"
THINNEST = 1e-9
"""Smallest length [m] of a shape."""


def read_link(reader: UrdfReader, element: Element) -> Link | None:
    """Return the link that an element describes, or None after an error."""
    before = len(reader.found)
    name = element.attributes.get("name", "")
    if not name:
        reader.say(element, "needs the attribute 'name'")
    visuals, unseen = _parts(reader, element, "visual")
    collisions, untouched = _parts(reader, element, "collision")
    mass, center, tensor = _inertial(reader, element)
    if len(reader.found) > before:
        return None
    inertial, done = repair_inertia(mass, center, tensor, collisions or visuals)
    if done:
        reader.remark("repaired", element, done)
    elif inertial is not None:
        doubt = find_inertia_problems(inertial, collisions or visuals)
        if doubt:
            reader.remark("noted", element, doubt)
    if untouched:
        collisions = _replace_colliders(reader, element, untouched, collisions, visuals, inertial)
    if unseen:
        visuals = _replace_visuals(reader, element, unseen, visuals, collisions)
    return Link(name, inertial, tuple(visuals), tuple(collisions), reader.friction.get(name))


def _parts(reader: UrdfReader, element: Element, tag: str) -> tuple[list[LinkShape], list[str]]:
    """Return the shapes, and the reasons why other shapes are unavailable."""
    parts: list[LinkShape] = []
    lost: list[str] = []
    for inner in element.each(tag):
        geometry = reader.first(inner, "geometry")
        if geometry is None:
            reader.say(inner, "needs <geometry>")
            continue
        shape = _parse_shape(reader, geometry, collision=tag == "collision")
        origin = reader.origin(inner)
        color = read_color(reader, inner) if tag == "visual" else None
        if isinstance(shape, str):
            lost.append(shape)
        elif shape is not None:
            parts.append(LinkShape(shape, origin, inner.attributes.get("name", ""), color))
    return parts, lost


def _parse_shape(reader: UrdfReader, geometry: Element, collision: bool) -> Shape | str | None:
    """Return the shape, the reason why its mesh is unavailable, or None after an error."""
    inner = [child for child in geometry.children if child.tag in SHAPES]
    if not inner:
        reader.say(geometry, f"must contain one of {', '.join(f'<{word}>' for word in SHAPES)}")
        return None
    if len(inner) > 1:
        reader.remark("ignored", geometry, f"contains {len(inner)} shapes; the first one, <{inner[0].tag}>, is used")
    element = inner[0]
    if element.tag == "mesh":
        return reader.mesh(element, collision)
    if element.tag == "box":
        sides = reader.row(element, "size", 3, None)
        if sides is None:
            if "size" not in element.attributes:
                reader.say(element, "needs the attribute 'size', three numbers")
            return None
        if not np.all(sides > 0.0):
            reader.say(element, f'size="{element.attributes["size"][:40]}" must be above 0')
            return None
        if sides.min() < THINNEST:
            reader.say(element, f'size="{element.attributes["size"][:40]}" must be at least {THINNEST:g} m')
            return None
        return Box((float(sides[0]), float(sides[1]), float(sides[2])))
    if element.tag == "sphere" and "radius" not in element.attributes:
        # urdfdom, PyBullet and MuJoCo refuse the robot, too: a sphere has no usual size
        reader.say(element, f"needs the attribute 'radius', a number; {OTHERS_REFUSE}")
        return None
    radius = _length(reader, element, "radius")
    if element.tag == "sphere":
        return Sphere(radius) if radius else None
    length = _length(reader, element, "length")
    if not radius or not length:
        return None
    return Cylinder(radius, length) if element.tag == "cylinder" else Capsule(radius, length)


def _length(reader: UrdfReader, element: Element, key: str) -> float | None:
    length = reader.required_value(element, key)
    if length is not None and length <= 0.0:
        reader.say(element, f'{key}="{element.attributes[key][:40]}" must be above 0')
        return None
    if length is not None and not THINNEST <= length <= LARGEST:
        text = element.attributes[key][:40]
        reader.say(element, f'{key}="{text}" must be at least {THINNEST:g} m and at most {LARGEST:g} m')
        return None
    return length


def _inertial(reader: UrdfReader, element: Element) -> tuple[float | None, Floats | None, Floats | None]:
    """Return mass, centre and inertia in the axes of the link; None for missing values."""
    inner = reader.first(element, "inertial")
    if inner is None:
        return None, None, None
    origin = reader.origin(inner)
    weight = reader.first(inner, "mass")
    mass = reader.required_value(weight, "value", 0.0) if weight is not None else 0.0
    moments = reader.first(inner, "inertia")
    if moments is None:
        return mass, origin[:3, 3], None
    xx, xy, xz, yy, yz, zz = (
        reader.value(moments, key, 0.0) or 0.0 for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return mass, origin[:3, 3], origin[:3, :3] @ tensor @ origin[:3, :3].T


def _replace_colliders(
    reader: UrdfReader,
    element: Element,
    lost: list[str],
    collisions: list[LinkShape],
    visuals: list[LinkShape],
    inertial: LinkInertia | None,
) -> list[LinkShape]:
    """Return the colliders of a link with a missing mesh, and record the replacement."""
    if collisions:
        place = "only its other colliders are used"
    elif visuals:
        collisions, place = [_find_contacts(reader, part) for part in visuals], "its visuals are used"
    elif inertial is not None:
        part, what = default_inertia(inertial)
        collisions, place = [part], f"{what} is used"
    else:
        place = "the link has no colliders"
    reader.remark("replaced", element, f"{_listed(lost)}; for contacts, {place}")
    return collisions


def _replace_visuals(
    reader: UrdfReader, element: Element, lost: list[str], visuals: list[LinkShape], collisions: list[LinkShape]
) -> list[LinkShape]:
    """Return the visuals of a link with a missing mesh, and record the replacement."""
    if collisions:
        place = "its colliders are shown instead"
    else:
        place = "it has no colliders to show instead" + ("" if visuals else " and the link is invisible")
    reader.remark("replaced", element, f"{_listed(lost)}; {place}")
    return [*visuals, *collisions]


def _find_contacts(reader: UrdfReader, part: LinkShape) -> LinkShape:
    if not isinstance(part.shape, Mesh) or part.shape.pieces:
        return part
    from .meshes import with_pieces

    return LinkShape(with_pieces(part.shape, reader.colliders)[0], part.origin, part.name, part.color)


def _listed(lost: list[str]) -> str:
    return "; ".join(dict.fromkeys(lost))
