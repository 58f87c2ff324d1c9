"""Parser of URDF materials."""

from __future__ import annotations

from crowdbot.core import Element

from .elements import Color, UrdfReader

__all__ = ["read_color", "read_materials"]


def read_materials(reader: UrdfReader, root: Element) -> dict[str, Color]:
    """Return the colours of the materials of the robot and of named materials in visuals, by name."""
    inside = [m for link in root.each("link") for visual in link.each("visual") for m in visual.each("material")]
    found: dict[str, Color] = {}
    for element in [*root.each("material"), *inside]:
        name = element.attributes.get("name", "")
        if name and name not in found:
            color = _color(reader, element)
            if color is not None:
                found[name] = color
    return found


def read_color(reader: UrdfReader, visual: Element) -> Color | None:
    """Return the colour of a visual; None without a colour, or with a texture (not supported)."""
    material = reader.one(visual, "material")
    if material is None:
        return None
    color = _color(reader, material)
    if color is not None:
        return color
    name = material.attributes.get("name", "")
    if name in reader.materials:
        return reader.materials[name]
    if material.each("texture"):
        reader.remark("ignored", material, "has a texture; textures are not supported")
    elif name:
        reader.remark("ignored", material, f"uses the colour {name[:40]!r}, which is not defined; grey is used")
    return None


def _color(reader: UrdfReader, material: Element) -> Color | None:
    element = next(iter(material.each("color")), None)
    values = None if element is None else reader.row(element, "rgba", 4, None)
    if element is None or values is None:
        return None
    if values.min() < 0.0 or values.max() > 1.0:
        reader.remark("repaired", element, f'rgba="{element.attributes["rgba"][:40]}" was clipped to 0 to 1')
    red, green, blue, alpha = (min(1.0, max(0.0, float(value))) for value in values)
    return red, green, blue, alpha
