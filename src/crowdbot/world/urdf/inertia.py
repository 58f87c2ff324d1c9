"""Mass and inertia of links: validation, and replacement of missing or unphysical values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crowdbot.typing import Floats

from .model import LinkInertia, LinkShape
from .shapes import Box, Solid, Sphere, together
from .transforms import frame, transform_points

DENSITY = 1000.0
"""Density [kg/m3] of water, for a mass without shape, and for shapes of a file without any mass."""
SMALLEST = 1e-12
TOO_LARGE = 3.0
"""An inertia is reported if it fits a body larger than the shape by this factor."""
SLACK = 1e-6
"""Relative tolerance of the triangle inequality of principal moments, for rounding in the file."""


def unphysical(tensor: Floats) -> str:
    """Return what is wrong with an inertia ``[3, 3]`` [kg m2] as the end of a sentence; empty if it is physical.

    >>> unphysical(np.diag([1.0, 1.0, 3.0]))
    'its principal moments 1, 1, 3 kg m2 violate the triangle inequality'
    """
    moments = np.linalg.eigvalsh(tensor)
    words = ", ".join(f"{value:.3g}" for value in moments)
    if moments[0] <= 0.0:
        return f"its principal moments {words} kg m2 must all be above 0"
    if moments[2] > (moments[0] + moments[1]) + SLACK * moments[2]:
        return f"its principal moments {words} kg m2 violate the triangle inequality"
    return ""


def solid_of(parts: Sequence[LinkShape]) -> Solid | None:
    """Return the shapes of a link as one solid of density 1, or None without shapes."""
    return together([(part.shape.solid(), part.origin) for part in parts])


def repair_inertia(
    mass: float | None, center: Floats | None, tensor: Floats | None, shapes: Sequence[LinkShape]
) -> tuple[LinkInertia | None, str]:
    """Return a physical inertial, and the repair as the end of a sentence; empty if nothing was repaired.

    A link without mass has no inertial. A missing or unphysical inertia is replaced by that of the homogeneous shapes
    at the given mass, or without shapes by that of a ball of water of this mass.

    Args:
        mass: given mass [kg]; None or 0 if missing.
        center: given centre of mass in the frame of the link.
        tensor: given inertia about the centre, in the axes of the link.
        shapes: colliders of the link, or its visuals if it has none.
    """
    solid = solid_of(shapes)
    if not mass:
        return None, ""
    wrong = "it has no inertia" if tensor is None else unphysical(tensor)
    place = np.zeros(3) if center is None else center
    if not wrong:
        assert tensor is not None
        return LinkInertia(mass, place, _round_tensor(tensor)), ""
    source = "its shape" if solid is not None else "a ball of water"
    if solid is None:
        solid = Sphere((mass / DENSITY * 3.0 / (4.0 * np.pi)) ** (1.0 / 3.0)).solid()
    return LinkInertia(
        mass, place, solid.inertia(mass)
    ), f"its inertia is replaced by that of {source} with a mass of {mass:g} kg: {wrong}"


def default_inertia(inertial: LinkInertia) -> tuple[LinkShape, str]:
    """Return a replacement shape for a link whose shape is missing, and its description.

    The shape is the homogeneous box with this inertial. If that box has less than a tenth of the density of water, the
    inertia is taken as a placeholder and the shape is a cube at the density of water.

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


def replacement_shape(inertial: LinkInertia) -> tuple[tuple[float, float, float], Floats, str]:
    """Return sides [m], frame ``[4, 4]`` and description of the box of :func:`default_inertia`."""
    part, what = default_inertia(inertial)
    assert isinstance(part.shape, Box)
    return part.shape.size, part.origin, what


def find_inertia_problems(inertial: LinkInertia, shapes: Sequence[LinkShape]) -> str:
    """Return the end of a sentence if an inertia fits a body several times the size of the shapes, otherwise ""."""
    if not shapes:
        return ""
    points = np.concatenate([transform_points(part.origin, part.shape.points()) for part in shapes])
    there = float(np.linalg.norm(np.ptp(points, axis=0)))
    needed = float(np.linalg.norm(_sides(inertial.mass, np.asarray(np.linalg.eigvalsh(inertial.tensor)))))
    if needed <= TOO_LARGE * there:
        return ""
    return (
        f"has the inertia of a body {needed:.2g} m across, but its shape is {there:.2g} m across; check units or "
        f"placeholders"
    )


def _sides(mass: float, moments: Floats) -> Floats:
    """Return the sides ``[3]`` [m] of the homogeneous box with these principal moments."""
    return np.asarray(np.sqrt(np.maximum(6.0 / mass * (moments.sum() - 2.0 * moments), 1e-6)).round(12))


def _round_tensor(tensor: Floats) -> Floats:
    """Return a tensor without rounding errors in the triangle inequality."""
    moments, axes = np.linalg.eigh(tensor)
    lack = moments[2] - moments[0] - moments[1]
    if lack < -SMALLEST * moments[2]:
        return tensor
    moments[:2] += 0.5 * lack + 1e-9 * moments[2]
    return np.asarray(axes @ np.diag(moments) @ axes.T)
