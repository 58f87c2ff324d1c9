"""Parser of URDF materials."""

from __future__ import annotations

from crowdbot.core import Element, InputError

from .elements import Color, UrdfReader
from .mesh_colors import mean_color


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
