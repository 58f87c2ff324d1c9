"""Bodies: three-dimensional shapes of agents and props, in addition to their discs in the plane."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.typing import Floats, Ints

from .errors import InputError
from .tree import storable, take

STAGE = -1
"""Owner of shapes that belong to the stage instead of an agent."""


@dataclass(frozen=True)
class Skins:
    """Triangle meshes of posed people and robots, for ray casting at mesh accuracy.

    Fields:
        vertices: ``[E, V, 3]`` [m]; NaN where a skin is absent.
        faces: ``[F, 3]`` indices of vertices.
        owner: ``[F]`` index of the agent, or :data:`STAGE`.
        part: ``[F]`` index into ``Bodies.parts``, -1 for none.
    """

    vertices: Floats
    faces: Ints
    owner: Ints
    part: Ints
    shared_fields: ClassVar[tuple[str, ...]] = ("faces", "owner", "part")

    @classmethod
    def of(cls, vertices: ArrayLike, faces: ArrayLike, owner: ArrayLike, part: ArrayLike = -1) -> Skins:
        """Make skins from ``[V, 3]`` or ``[E, V, 3]`` vertices; ``owner`` and ``part`` may be scalars.

        Raises:
            InputError: a shape is wrong, or a face refers to a missing vertex.

        >>> Skins.of([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], owner=3).vertices.shape
        (1, 3, 3)
        """
        points = np.ascontiguousarray(np.asarray(vertices, dtype=np.float64))
        points = points[None] if points.ndim == 2 else points
        corners = np.ascontiguousarray(np.asarray(faces, dtype=np.int64).reshape(-1, 3))
        if points.ndim != 3 or points.shape[2] != 3:
            raise InputError(f"skins: vertices have shape {list(np.shape(vertices))}, it must be [V, 3] or [E, V, 3]")
        if len(corners) and not 0 <= corners.min() <= corners.max() < points.shape[1]:
            raise InputError(
                f"skins: a face refers to vertex {corners.max()}, but there are {points.shape[1]} vertices"
            )
        labels = [_labels(name, value, len(corners), "skins") for name, value in (("owner", owner), ("part", part))]
        return cls(points, corners, *labels)


@storable
@dataclass(frozen=True)
class Bodies:
    """Limbs, props and skins in E environments: capsules, boxes and upright cylinders, each with its owner.

    A shape that is absent in an environment has radius 0 or NaN. Owners and parts are shared by all environments.

    Fields:
        start, end: ``[E, B, 3]`` [m], ends of the axes of the capsules.
        radius: ``[E, B]`` [m].
        owner: ``[B]`` index of the agent, or :data:`STAGE` (-1).
        part: ``[B]`` index into ``parts``, -1 for none.
        parts: names of the parts.
        box_centre: ``[E, K, 3]`` [m]; box_half: ``[E, K, 3]`` [m], half the lengths of the sides;
            box_turn: ``[E, K, 4]``, unit quaternions w, x, y, z.
        post_foot: ``[E, C, 3]`` [m], middle of the lower end of the upright cylinders; post_radius: ``[E, C]`` [m];
            post_height: ``[E, C]`` [m].
        box_owner, box_part, post_owner, post_part: ``[K]`` and ``[C]``, as for capsules.
        skins: triangle skins, or None.

    >>> limbs = Bodies.of(start=[[[0.0, 0.0, 0.1]]], end=[[[0.0, 0.0, 0.8]]], radius=[[0.08]], owner=[0])
    >>> limbs.start.shape, limbs.box_half.shape
    ((1, 1, 3), (1, 0, 3))
    """

    start: Floats = field(default_factory=lambda: np.zeros((1, 0, 3)))
    end: Floats = field(default_factory=lambda: np.zeros((1, 0, 3)))
    radius: Floats = field(default_factory=lambda: np.zeros((1, 0)))
    owner: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    part: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    parts: tuple[str, ...] = ()
    box_centre: Floats = field(default_factory=lambda: np.zeros((1, 0, 3)))
    box_half: Floats = field(default_factory=lambda: np.zeros((1, 0, 3)))
    box_turn: Floats = field(default_factory=lambda: np.zeros((1, 0, 4)))
    box_owner: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    box_part: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    post_foot: Floats = field(default_factory=lambda: np.zeros((1, 0, 3)))
    post_radius: Floats = field(default_factory=lambda: np.zeros((1, 0)))
    post_height: Floats = field(default_factory=lambda: np.zeros((1, 0)))
    post_owner: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    post_part: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    skins: Skins | None = None
    shared_fields: ClassVar[tuple[str, ...]] = (
        "owner", "part", "parts", "box_owner", "box_part", "post_owner", "post_part",
    )  # fmt: skip

    @classmethod
    def of(cls, *, parts: tuple[str, ...] = (), skins: Skins | None = None, **arrays: ArrayLike) -> Bodies:
        """Make bodies from the given fields; the axis E is optional for one environment.

        Defaults: owner :data:`STAGE`, part -1, boxes not rotated.

        Raises:
            InputError: a field is unknown or its shape does not fit the others.
        """
        known = {f.name for f in dataclasses.fields(cls)} - {"parts", "skins"}
        for name in arrays:
            if name not in known:
                raise InputError(f"bodies: there is no field {name!r}; there are {', '.join(sorted(known))}")
        count = {_batch_size(name, value) for name, value in arrays.items() if name in AXES}
        count |= {len(skins.vertices)} if skins is not None else set()
        if len(count - {1}) > 1:
            raise InputError(f"bodies: the fields have {sorted(count - {1})} environments; they must agree")
        environments = max(count, default=1)
        values: dict[str, Any] = {}
        for size, labels, shapes in GROUPS:
            length = max((np.shape(arrays[n])[-1 - shapes[n]] for n in shapes if n in arrays), default=0)
            for name, vector in shapes.items():
                default = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (length, 4)) if name == "box_turn" else None
                values[name] = _broadcast_field(
                    name, arrays.get(name, default), (environments, length, *size[name]), vector
                )
            for name in labels:
                values[name] = _labels(name, arrays.get(name, -1), length, "bodies")
        if skins is not None and len(skins.vertices) != environments:
            skins = dataclasses.replace(skins, vertices=np.repeat(skins.vertices, environments, axis=0))
        return cls(**values, parts=tuple(parts), skins=skins)

    @property
    def batch(self) -> int:
        """Number of environments E."""
        return len(self.start)

    def environments(self, index: Ints) -> Bodies:
        """Return the environments with these indices along E."""
        return take(self, index)

    def stage_bodies(self) -> Bodies:
        """Return only the bodies of the stage.

        >>> both = Bodies.of(start=[[0, 0, 0], [1, 0, 0]], end=[[0, 0, 1], [1, 0, 1]], radius=[0.1, 0.1], owner=[4, -1])
        >>> both.stage_bodies().start[0].tolist()
        [[1.0, 0.0, 0.0]]
        """
        values: dict[str, Any] = {}
        for _, labels, shapes in GROUPS:
            keep = getattr(self, labels[0]) == STAGE
            values |= {name: getattr(self, name)[:, keep] for name in shapes}
            values |= {name: getattr(self, name)[keep] for name in labels}
        skins = self.skins
        if skins is not None:
            own = skins.owner == STAGE
            skins = Skins(skins.vertices, skins.faces[own], skins.owner[own], skins.part[own]) if own.any() else None
        return dataclasses.replace(self, **values, skins=skins)

    def digest_bytes(self, active: NDArray[np.bool_]) -> bytes:
        """Return the bytes of all arrays; limbs of agents that are not ``active`` ``[E, A]`` are zeros."""
        found = []
        for _, labels, shapes in GROUPS:
            here = _presence(getattr(self, labels[0]), active)
            for name in shapes:
                value = getattr(self, name)
                found.append(np.where(here.reshape(here.shape + (1,) * (value.ndim - 2)), value, 0.0).tobytes())
        if self.skins is not None:
            here = _presence(self.skins.owner, active)[..., None, None]
            found.append(np.where(here, self.skins.vertices[:, self.skins.faces], 0.0).tobytes())
        return b"".join(found)


def _presence(owner: Ints, active: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the mask ``[E, B]`` of shapes whose owner is active; the stage is always active."""
    agents = active.shape[1]
    inside = (owner >= 0) & (owner < agents)
    if agents == 0:
        return np.broadcast_to(owner == STAGE, (len(active), len(owner)))
    return np.where(inside, active[:, np.where(inside, owner, 0)], owner == STAGE)


GROUPS: tuple[tuple[dict[str, tuple[int, ...]], tuple[str, ...], dict[str, int]], ...] = (
    ({"start": (3,), "end": (3,), "radius": ()}, ("owner", "part"), {"start": 1, "end": 1, "radius": 0}),
    (
        {"box_centre": (3,), "box_half": (3,), "box_turn": (4,)},
        ("box_owner", "box_part"),
        {"box_centre": 1, "box_half": 1, "box_turn": 1},
    ),
    (
        {"post_foot": (3,), "post_radius": (), "post_height": ()},
        ("post_owner", "post_part"),
        {"post_foot": 1, "post_radius": 0, "post_height": 0},
    ),
)
"""For each kind of shape: lengths of the last axes, names of the labels, number of axes after the shapes."""
AXES = {name: vector for _, _, shapes in GROUPS for name, vector in shapes.items()}


def _batch_size(name: str, value: ArrayLike) -> int:
    shape = np.shape(value)
    return shape[0] if len(shape) == 2 + AXES[name] else 1


def _broadcast_field(name: str, value: ArrayLike | None, shape: tuple[int, ...], vector: int) -> Floats:
    if value is None:
        if shape[1]:
            raise InputError(f"bodies: {name} is missing for {shape[1]} shapes")
        return np.zeros(shape)
    array = np.asarray(value, dtype=np.float64)
    array = array[None] if array.ndim == 1 + vector else array
    try:
        return np.array(np.broadcast_to(array, shape))
    except ValueError:
        raise InputError(f"bodies: {name} has shape {list(np.shape(value))}, it must fit {list(shape)}") from None


def _labels(name: str, value: ArrayLike, count: int, whose: str) -> Ints:
    array = np.asarray(value, dtype=np.int64)
    if array.shape not in ((), (count,)):
        raise InputError(f"{whose}: {name} has shape {list(array.shape)}, it must be one for each of {count}")
    if array.size and array.min() < -1:
        raise InputError(f"{whose}: {name} {array.min()} is below -1")
    return np.array(np.broadcast_to(array, (count,)))  # a copy: kernels are compiled anew for read-only arrays
