"""BodyShapes: limbs and masses of the bodies of people, which are parts of the engine model."""

from __future__ import annotations

from typing import Any, NamedTuple

from crowdbot.core import storable
from crowdbot.typing import Floats, Ints

from .mjcf_model import LIMB_COUNT


@storable
class BodyShapes(NamedTuple):
    """Limbs and masses of the bodies, which are parts of the engine model; S bodies, L limbs.

    Fields:
        position, rotation: ``[S, L, 3]`` [m] and quaternions ``[S, L, 4]`` of the limbs relative to their bodies.
        size: radius, half length and 0 ``[S, L, 3]`` [m].
        bound: radius of the bounding sphere ``[S, L]`` [m].
        softness: stiffness and damping of contacts ``[S, L, 2]``, negated.
        mass: ``[S]`` [kg].
        inverse_weight: inverse of mass and inertia ``[S, 2]``.
    """

    position: Floats
    rotation: Floats
    size: Floats
    bound: Floats
    softness: Floats
    mass: Floats
    inverse_weight: Floats

    @classmethod
    def of(cls, model: Any, geoms: Ints, bodies: Ints) -> BodyShapes:
        """Return a copy of the shapes of a model."""
        position, rotation, size, bound, softness = (
            array.reshape(len(bodies), LIMB_COUNT, *array.shape[1:])
            for array in (getattr(model, name)[geoms] for name in (*POSES, "geom_solref"))
        )
        return cls(position, rotation, size, bound, softness, model.body_mass[bodies], model.body_invweight0[bodies])

    def copy(self) -> BodyShapes:
        """Return an independent copy."""
        return BodyShapes(*(array.copy() for array in self))

    def write_all(self, model: Any, geoms: Ints, bodies: Ints) -> None:
        """Write the shapes to a model."""
        if not len(bodies):
            return
        self.write_poses(model, geoms)
        model.geom_solref[int(geoms[0]) : int(geoms[-1]) + 1] = self.softness.reshape(-1, 2)
        model.body_mass[bodies], model.body_invweight0[bodies] = self.mass, self.inverse_weight

    def write_poses(self, model: Any, geoms: Ints) -> None:
        """Write poses and sizes of the limbs to a model."""
        rows = slice(int(geoms[0]), int(geoms[-1]) + 1)
        for name, array in zip(POSES, self, strict=False):
            getattr(model, name)[rows] = array.reshape(len(geoms), *array.shape[2:])


POSES = ("geom_pos", "geom_quat", "geom_size", "geom_rbound")
"""Arrays of an engine model with the poses and sizes of limbs, in the order of :class:`BodyShapes`."""
