"""Mass and inertia of links: what is physical, and what takes the place of what is not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .model import LinkInertia, LinkShape
from .shapes import Box, Solid, Sphere, together
from .transforms import frame, transform_points

__all__ = ["DENSITY", "default_inertia", "find_inertia_problems", "repair_inertia", "solid_of", "unphysical"]

Floats = NDArray[np.float64]
DENSITY = 1000.0
"""Density [kg/m3] of links that have a shape but no mass: that of water, as MuJoCo takes it."""
SMALLEST = 1e-12
TOO_LARGE = 3.0
"""An inertia is doubtful when it belongs to a body so many times the size of the shape."""
SLACK = 1e-6
"""Principal moments may miss the triangle inequality by so much of the largest: rounding in the file."""


def unphysical(tensor: Floats) -> str:
    """Return what is wrong with an inertia ``[3, 3]`` [kg m2] as the end of a sentence, empty when it can exist.

    >>> unphysical(np.diag([1.0, 1.0, 3.0]))
    'its principal moments 1, 1, 3 kg m2 break the triangle inequality'
    """
    moments = np.linalg.eigvalsh(tensor)
    words = ", ".join(f"{value:.3g}" for value in moments)
    if moments[0] <= 0.0:
        return f"its principal moments {words} kg m2 are not all above 0"
    if moments[2] > (moments[0] + moments[1]) + SLACK * moments[2]:
        return f"its principal moments {words} kg m2 break the triangle inequality"
    return ""


def solid_of(parts: Sequence[LinkShape]) -> Solid | None:
    """Return the shapes of a link as one solid of density 1, None when there are none."""
    return together([(part.shape.solid(), part.origin) for part in parts])


def repair_inertia(
    mass: float | None, center: Floats | None, tensor: Floats | None, shapes: Sequence[LinkShape]
) -> tuple[LinkInertia | None, str]:
    """Return a physical inertial, and what was done to get it as the end of a sentence; empty when nothing was.

    A missing mass is that of the shapes at the density of water; a missing or unphysical inertia is that of the shapes,
    homogeneous, at the mass given; without shapes it is that of a ball of water of this mass.

    Args:
        mass: as given [kg], None or 0 when missing.
        center: as given, in the link's frame.
        tensor: as given, about the centre in the axes of the link.
        shapes: colliders of the link; what is seen, when it has none.
    """
    solid = solid_of(shapes)
    if not mass:
        if solid is None:
            return None, ""
        weight = DENSITY * solid.volume
        why = "has no inertial" if mass is None else "has no mass"
        found = LinkInertia(weight, solid.center, solid.inertia(weight))
        return found, f"{why}; it got {weight:.3g} kg and its inertia from its shape at {DENSITY:g} kg/m3"
    wrong = "it has none" if tensor is None else unphysical(tensor)
    place = np.zeros(3) if center is None else center
    if not wrong:
        assert tensor is not None
        return LinkInertia(mass, place, _exact(tensor)), ""
    source = "its shape" if solid is not None else "a ball of water"
    if solid is None:
        solid = Sphere((mass / DENSITY * 3.0 / (4.0 * np.pi)) ** (1.0 / 3.0)).solid()
    return LinkInertia(
        mass, place, solid.inertia(mass)
    ), f"got a new inertia, from {source} at its {mass:g} kg: {wrong}"


def default_inertia(inertial: LinkInertia) -> tuple[LinkShape, str]:
    """Return what stands for a link whose shape is lost, and what it is.

    It is the homogeneous box that has this inertial; but a cube at the density of water when that box would be lighter
    than a tenth of it, because its inertia is no more than a placeholder then.

    >>> default_inertia(LinkInertia(6000.0, np.zeros(3), 1000.0 * np.eye(3)))[0].shape
    Box(size=(1.0, 1.0, 1.0))
    """
    moments, axes = np.linalg.eigh(inertial.tensor)
    if np.linalg.det(axes) < 0.0:
        axes = -axes
    sides = _sides(inertial.mass, moments)
    if inertial.mass < 0.1 * DENSITY * float(np.prod(sides)):
        sides, axes = np.full(3, (inertial.mass / DENSITY) ** (1.0 / 3.0)), np.eye(3)
        what = f"a cube of its mass at {DENSITY:g} kg/m3"
    else:
        what = "the box of equal inertia"
    size = (float(sides[0]), float(sides[1]), float(sides[2]))
    return LinkShape(Box(size), frame(inertial.center, axes), name=what), what


def find_inertia_problems(inertial: LinkInertia, shapes: Sequence[LinkShape]) -> str:
    """Return the end of a sentence when an inertia belongs to a body several times the size of the shapes."""
    if not shapes:
        return ""
    points = np.concatenate([transform_points(part.origin, part.shape.points()) for part in shapes])
    there = float(np.linalg.norm(np.ptp(points, axis=0)))
    needed = float(np.linalg.norm(_sides(inertial.mass, np.asarray(np.linalg.eigvalsh(inertial.tensor)))))
    if needed <= TOO_LARGE * there:
        return ""
    return (
        f"has the inertia of a body {needed:.2g} m across, but its shape is {there:.2g} m; check units or placeholders"
    )


def _sides(mass: float, moments: Floats) -> Floats:
    """Return the sides ``[3]`` [m] of the homogeneous box with these principal moments."""
    return np.asarray(np.sqrt(np.maximum(6.0 / mass * (moments.sum() - 2.0 * moments), 1e-6)).round(12))


def _exact(tensor: Floats) -> Floats:
    """Return a tensor that misses the triangle inequality by no rounding error, otherwise as it was."""
    moments, axes = np.linalg.eigh(tensor)
    lack = moments[2] - moments[0] - moments[1]
    if lack < -SMALLEST * moments[2]:
        return tensor
    moments[:2] += 0.5 * lack + 1e-9 * moments[2]
    return np.asarray(axes @ np.diag(moments) @ axes.T)
