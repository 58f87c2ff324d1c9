"""Things that people hold, carry, wear or push, as triangles in their current places."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from crowdbot.core import stream
from crowdbot.humans import ACTIVITIES, People, Posture, rest_skeleton, shapes
from crowdbot.typing import Floats

from .shape_meshes import ShapeMesh, box_mesh, cylinder_mesh, ellipsoid_mesh, flat_uv

Color = tuple[float, float, float]
COLORS = ((0.16, 0.20, 0.30), (0.45, 0.16, 0.14), (0.22, 0.26, 0.20), (0.10, 0.10, 0.11), (0.55, 0.42, 0.28))
METAL, DARK, PAPER, CARDBOARD = (0.62, 0.63, 0.65), (0.07, 0.07, 0.08), (0.93, 0.91, 0.86), (0.66, 0.49, 0.32)


class _Solid(NamedTuple):
    """What rays see of a shape: ``box``, ``cylinder`` or ``ellipsoid`` with sizes [m], or nothing if empty."""

    kind: str
    size: tuple[float, float, float]


NO_SOLID = _Solid("", (0.0, 0.0, 0.0))


class _Shape(NamedTuple):
    """The triangles of a shape, and what rays see of it."""

    mesh: ShapeMesh
    solid: _Solid


class CarriedPart(NamedTuple):
    """A shape in the world: its triangles, rotation ``[3, 3]``, place ``[3]`` [m], and colour."""

    shape: _Shape
    turn: Floats
    place: Floats
    color: Color

    @property
    def mesh(self) -> ShapeMesh:
        """Triangles in the frame of the shape."""
        return self.shape.mesh


class _Holder(NamedTuple):
    """A person with things: bones in the world, the ground below, and the axes of the trunk."""

    rotation: Floats
    position: Floats
    head: Floats
    hands: Floats
    ground: Floats
    trunk: Floats
    scale: float
    color: Color

    def hand(self, side: int) -> tuple[Floats, Floats]:
        """Return axes (fingers, left, back of the hand) and place of a hand."""
        bone = shapes().bone(f"hand_{'lr'[side]}")
        return self.rotation[bone] @ self.hands[side], self.position[bone]

    def between(self) -> Floats:
        """Return the middle between both palms."""
        palms = [place + turn @ (0.085, 0.0, -0.03) for turn, place in (self.hand(0), self.hand(1))]
        return np.asarray(0.5 * (palms[0] + palms[1]))

    def on_ground(self, ahead: float, left: float, up: float) -> Floats:
        """Return a point at this distance from the feet [m]."""
        return np.asarray(self.ground + self.trunk @ (ahead, left, up))


@functools.cache
def _box(x: float, y: float, z: float) -> _Shape:
    return _Shape(box_mesh(0.5 * np.array([x, y, z])), _Solid("box", (0.5 * x, 0.5 * y, 0.5 * z)))


@functools.cache
def _ball(x: float, y: float, z: float) -> _Shape:
    return _Shape(ellipsoid_mesh(np.array([x, y, z])), _Solid("ellipsoid", (x, y, z)))


def _cylinder(radius: float, half: float) -> _Shape:
    return _Shape(cylinder_mesh(radius, half), _Solid("cylinder", (radius, half, 0.0)))


def _rod(start: Floats, end: Floats, radius: float, color: Color) -> CarriedPart:
    way = end - start
    length = float(np.linalg.norm(way))
    z = way / max(length, 1e-9)
    x = np.cross((0.0, 1.0, 0.0) if abs(z[1]) < 0.9 else (1.0, 0.0, 0.0), z)
    x = x / np.linalg.norm(x)
    return CarriedPart(
        _cylinder(radius, 0.5 * length), np.stack([x, np.cross(z, x), z], axis=1), 0.5 * (start + end), color
    )


def _wheel(h: _Holder, ahead: float, left: float, radius: float) -> list[CarriedPart]:
    turn = h.trunk @ np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    tyre, spokes = _wheel_meshes(radius)
    place = h.on_ground(ahead, left, radius)
    solid = _Solid("cylinder", (radius, TYRE, 0.0))
    return [
        CarriedPart(_Shape(tyre, solid), turn, place, DARK),
        CarriedPart(_Shape(spokes, NO_SOLID), turn, place, METAL),
    ]


TYRE, SPOKES = 0.018, 5
"""Radius of the tyre of a wheel [m], and number of spokes across the wheel."""


@functools.cache
def _wheel_meshes(radius: float) -> tuple[ShapeMesh, ShapeMesh]:
    """Return the tyre, and spokes with the hub, of a wheel around the z axis."""
    around, along = np.linspace(0.0, 2.0 * math.pi, 29), np.linspace(0.0, 2.0 * math.pi, 9)
    turn, tube = np.meshgrid(around, along, indexing="ij")
    out = np.stack([np.cos(turn) * np.cos(tube), np.sin(turn) * np.cos(tube), np.sin(tube)], axis=-1)
    place = (radius - TYRE) * np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=-1) + TYRE * out
    i, j = (index.ravel() for index in np.meshgrid(np.arange(28), np.arange(8), indexing="ij"))
    rows = np.concatenate([[(i, j), (i + 1, j), (i + 1, j + 1)], [(i, j), (i + 1, j + 1), (i, j + 1)]], axis=-1)
    corner, normal = (np.stack([array[a, b] for a, b in rows], axis=1) for array in (place, out))
    rim = [(radius - TYRE) * np.array([math.cos(a), math.sin(a), 0.0]) for a in np.arange(SPOKES) * math.pi / SPOKES]
    hub = np.array([0.0, 0.0, 0.025])
    spokes = [_rod(-end, end, 0.004, METAL) for end in rim] + [_rod(-hub, hub, 0.12 * radius, METAL)]
    return ShapeMesh(corner, normal, flat_uv(corner, normal), True), _joined(spokes)


CALL = (0.62, -0.20, -0.76)
"""Direction of the lower end of a phone at the right ear, in the frame of the head."""


def _call(h: _Holder) -> list[CarriedPart]:
    """Return a phone in the hand that lies along the cheek, from the ear towards the mouth."""
    along = np.array(CALL) / math.sqrt(sum(part * part for part in CALL))
    out = np.cross(along, (-along[2], 0.0, along[0]))
    turn = h.rotation[shapes().bone("head")] @ np.stack([along, np.cross(out, along), out], axis=1)
    hand, place = h.hand(1)
    return _smartphone(turn, place + hand @ (0.055, 0.0, -0.034) + turn @ (-0.05, 0.0, 0.014))


def _phone(h: _Holder) -> list[CarriedPart]:
    turn, place = h.hand(1)
    return _smartphone(turn, place + turn @ (0.085, 0.0, -0.030))


def _smartphone(turn: Floats, middle: Floats) -> list[CarriedPart]:
    screen = middle - 0.006 * turn[:, 2]
    return [
        CarriedPart(_box(0.145, 0.072, 0.009), turn, middle, DARK),
        CarriedPart(_box(0.132, 0.064, 0.002), turn, screen, (0.55, 0.72, 0.86)),
    ]


def _bottle(h: _Holder) -> list[CarriedPart]:
    turn, place = h.hand(1)
    middle, up = place + turn @ (0.085, 0.0, -0.042), turn @ (0.0, 1.0, 0.0)
    return [
        _rod(middle - 0.11 * up, middle + 0.07 * up, 0.033, (0.45, 0.66, 0.78)),
        _rod(middle + 0.07 * up, middle + 0.11 * up, 0.016, (0.45, 0.66, 0.78)),
        _rod(middle + 0.11 * up, middle + 0.125 * up, 0.018, (0.16, 0.30, 0.62)),
    ]


def _book(h: _Holder) -> list[CarriedPart]:
    tilt = math.radians(-55.0)
    lean = np.array([[math.cos(tilt), 0, math.sin(tilt)], [0, 1, 0], [-math.sin(tilt), 0, math.cos(tilt)]])
    turn, middle = h.trunk @ lean, h.between() + (0.0, 0.0, 0.06)
    return [
        CarriedPart(_box(0.21, 0.30, 0.012), turn, middle, h.color),
        CarriedPart(_box(0.20, 0.28, 0.014), turn, middle + turn @ (0.0, 0.0, 0.006), PAPER),
    ]


def _parcel(h: _Holder) -> list[CarriedPart]:
    middle = h.between() + h.trunk @ (0.10, 0.0, 0.09)
    return [
        CarriedPart(_box(0.30, 0.36, 0.26), h.trunk, middle, CARDBOARD),
        CarriedPart(_box(0.302, 0.06, 0.262), h.trunk, middle, (0.80, 0.70, 0.52)),
    ]


def _stick(h: _Holder) -> list[CarriedPart]:
    turn, place = h.hand(1)
    grip = place + turn @ (0.08, 0.0, -0.02)
    foot = np.array([*(grip + h.trunk @ (0.10, -0.02, 0.0))[:2], h.ground[2]])
    across = h.trunk @ (0.06, 0.0, 0.0)
    return [_rod(foot, grip, 0.011, (0.34, 0.20, 0.10)), _rod(grip - across, grip + across, 0.013, (0.20, 0.12, 0.07))]


def _bar(h: _Holder) -> tuple[Floats, Floats]:
    """Return the ends of the handle in both hands."""
    ends = [place + turn @ (0.085, 0.0, -0.02) for turn, place in (h.hand(0), h.hand(1))]
    return ends[0], ends[1]


@functools.cache
def _bassinet() -> tuple[_Shape, _Shape]:
    """Return the tub and the hood of a pram, open above and towards the person; rays see them closed."""
    tub, hood = _half(np.array([0.39, 0.20, 0.30]), math.pi), _half(np.array([0.27, 0.205, 0.27]), 0.6)
    tub = tub._replace(corner=tub.corner + (0.0, 0.0, 0.12))
    return _Shape(tub, _Solid("box", (0.36, 0.19, 0.12))), _Shape(hood, _Solid("ellipsoid", (0.27, 0.20, 0.26)))


def _half(radius: Floats, pitch: float) -> ShapeMesh:
    """Return the half of an ellipsoid of radii ``[3]`` [m] around its upper end, pitched forward by an angle [rad]."""
    unit = ellipsoid_mesh(np.ones(3))
    upper = unit.corner.mean(axis=1)[:, 2] > 0.0
    cos, sin = math.cos(pitch), math.sin(pitch)
    turn = np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
    corner, normal = unit.corner[upper] @ turn * radius, unit.normal[upper] @ turn / radius
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return ShapeMesh(corner, normal, flat_uv(corner, normal), False)


def _pram(h: _Holder) -> list[CarriedPart]:
    left, right = _bar(h)
    near = float((h.trunk.T @ (0.5 * (left + right) - h.ground))[0])
    parts = [_rod(left, right, 0.014, DARK)]
    for x, r in ((0.22, 0.14), (0.78, 0.10)):
        parts += [*_wheel(h, near + x, 0.27, r), *_wheel(h, near + x, -0.27, r)]
    for y, end in ((0.24, left), (-0.24, right)):
        parts += [_rod(end, h.on_ground(near + 0.75, y, 0.20), 0.011, METAL)]
        parts += [_rod(h.on_ground(near + 0.22, y, 0.14), h.on_ground(near + 0.66, 0.65 * y, 0.66), 0.011, METAL)]
    tub, hood = _bassinet()
    parts.append(CarriedPart(tub, h.trunk, h.on_ground(near + 0.50, 0.0, 0.68), h.color))
    red, green, blue = h.color
    shade = 0.5 * red, 0.5 * green, 0.5 * blue
    parts.append(CarriedPart(hood, h.trunk, h.on_ground(near + 0.66, 0.0, 0.80), shade))
    parts.append(CarriedPart(_ball(0.28, 0.16, 0.07), h.trunk, h.on_ground(near + 0.36, 0.0, 0.80), PAPER))
    return parts


def _wheelchair(h: _Holder) -> list[CarriedPart]:
    left, right = _bar(h)
    near = float((h.trunk.T @ (0.5 * (left + right) - h.ground))[0])
    parts = [*_wheel(h, near + 0.22, 0.28, 0.30), *_wheel(h, near + 0.22, -0.28, 0.30)]
    parts += [*_wheel(h, near + 0.66, 0.22, 0.10), *_wheel(h, near + 0.66, -0.22, 0.10)]
    for y, end in ((0.22, left), (-0.22, right)):
        parts += [_rod(end, h.on_ground(near + 0.10, y, 0.92), 0.014, DARK)]
        parts += [_rod(h.on_ground(near + 0.10, y, 0.92), h.on_ground(near + 0.16, y, 0.30), 0.013, METAL)]
        parts += [_rod(h.on_ground(near + 0.14, y, 0.48), h.on_ground(near + 0.60, y, 0.46), 0.013, METAL)]
        parts += [_rod(h.on_ground(near + 0.60, y, 0.46), h.on_ground(near + 0.74, y, 0.12), 0.012, METAL)]
        parts += [_rod(h.on_ground(near + 0.18, 1.2 * y, 0.70), h.on_ground(near + 0.50, 1.2 * y, 0.70), 0.02, DARK)]
        parts += [_rod(h.on_ground(near + x, y, 0.47), h.on_ground(near + x, 1.2 * y, 0.69), 0.01, METAL)
                  for x in (0.22, 0.46)]  # fmt: skip
    parts.append(CarriedPart(_box(0.44, 0.42, 0.05), h.trunk, h.on_ground(near + 0.37, 0.0, 0.50), h.color))
    parts.append(CarriedPart(_box(0.03, 0.42, 0.42), h.trunk, h.on_ground(near + 0.13, 0.0, 0.72), h.color))
    parts.append(CarriedPart(_box(0.14, 0.34, 0.02), h.trunk, h.on_ground(near + 0.80, 0.0, 0.12), DARK))
    return parts


STRAP = ((-0.10, 1.0, 1.40), (0.035, 1.0, 1.435), (0.135, 1.05, 1.34), (0.13, 1.2, 1.18), (-0.10, 1.4, 1.08))
"""Points of the straps of a backpack on a body of 1.7 m, with the side as a factor."""


@functools.lru_cache(maxsize=1024)
def _backpack_meshes(s: float) -> tuple[ShapeMesh, ShapeMesh]:
    """Return the bag and the straps of a backpack on a body of 1.7 m times ``s``, in the frame of the trunk."""
    flat = np.eye(3)
    bag = [
        CarriedPart(_box(0.15, 0.29, 0.40), flat, np.array([-0.185 * s, 0.0, 1.21 * s]), DARK),
        CarriedPart(_ball(0.085, 0.145, 0.07), flat, np.array([-0.185 * s, 0.0, 1.41 * s]), DARK),
        CarriedPart(_box(0.05, 0.23, 0.17), flat, np.array([-0.27 * s, 0.0, 1.13 * s]), DARK),
    ]
    straps = []
    for y in (0.105, -0.105):
        points = np.array(STRAP) * (s, y * s, s)
        straps += [_rod(a, b, 0.014, DARK) for a, b in itertools.pairwise(points)]
    return _joined(bag), _joined(straps)


def _joined(parts: list[CarriedPart]) -> ShapeMesh:
    """Return parts as one shape."""
    return ShapeMesh(
        np.concatenate([part.mesh.corner @ part.turn.T + part.place for part in parts]),
        np.concatenate([part.mesh.normal @ part.turn.T for part in parts]),
        np.concatenate([part.mesh.uv for part in parts]),
        True,
    )


def _backpack(h: _Holder) -> list[CarriedPart]:
    bone = shapes().bone("spine_03")
    turn, (bag, straps) = h.rotation[bone], _backpack_meshes(h.scale)
    place = h.position[bone] - turn @ h.head[bone]
    return [
        CarriedPart(_Shape(bag, NO_SOLID), turn, place, h.color),
        CarriedPart(_Shape(straps, NO_SOLID), turn, place, DARK),
    ]


SHOULDER_STRAP = (
    (0.115, -0.150, 1.270), (0.115, -0.125, 1.340), (0.035, -0.110, 1.450), (-0.090, -0.120, 1.395),
    (-0.105, -0.155, 1.260),
)  # fmt: skip
"""Points of the strap of a handbag over the right shoulder of a body of 1.7 m, from the front to the back."""


def _handbag(h: _Holder) -> list[CarriedPart]:
    pelvis, chest = shapes().bone("pelvis"), shapes().bone("spine_03")
    turn, s = h.rotation[pelvis], h.scale
    bag = h.position[pelvis] + turn @ (np.array([-0.06, -0.245, 0.93]) * s - h.head[pelvis])
    over = h.position[chest] + (np.array(SHOULDER_STRAP) * s - h.head[chest]) @ h.rotation[chest].T
    strap = [bag + turn @ (0.12, 0.0, 0.10), *over, bag + turn @ (-0.12, 0.0, 0.10)]
    return [
        CarriedPart(_box(0.30, 0.10, 0.22), turn, bag, h.color),
        *(_rod(a, b, 0.009, h.color) for a, b in itertools.pairwise(strap)),
    ]


def _chair(h: _Holder) -> list[CarriedPart]:
    legs = [
        CarriedPart(_box(0.04, 0.04, 0.42), h.trunk, h.on_ground(x, y, 0.21), METAL)
        for x in (-0.16, 0.20)
        for y in (0.19, -0.19)
    ]
    back = [CarriedPart(_box(0.03, 0.42, 0.40), h.trunk, h.on_ground(-0.20, 0.0, 0.68), h.color)]
    return [*legs, *back, CarriedPart(_box(0.44, 0.44, 0.04), h.trunk, h.on_ground(0.02, 0.0, 0.43), h.color)]


HELD: dict[str, Callable[[_Holder], list[CarriedPart]]] = {
    "phone": _call, "text": _phone, "bottle": _bottle, "read": _book, "carry": _parcel, "stick": _stick, "pram": _pram,
    "wheelchair": _wheelchair,
}  # fmt: skip
HOLDING = [ACTIVITIES.index(name) for name in (*HELD, "sit")]
BAGS = {"backpack": _backpack, "handbag": _handbag}


def bag_of(people: People, row: int) -> str:
    """Return the bag of a person, ``backpack``, ``handbag`` or nothing; it depends on person and outfit.

    >>> {bag_of(People.of(["woman-36"], variation=k), 0) for k in range(40)} == {"", "backpack", "handbag"}
    True
    """
    person = people.persons[row]
    return _choice(person.name, person.sex, int(people.variation[row]))[0]


@functools.lru_cache(maxsize=4096)
def _choice(name: str, sex: str, variation: int) -> tuple[str, Color]:
    """Return the bag of a person, and the colour of bags and other things."""
    chance = float(stream(0, "bag", name, variation).random())
    bag = "backpack" if chance < 0.2 else "handbag" if chance < 0.4 and sex == "f" else ""
    color = COLORS[int(stream(0, "bag", name, variation, "color").integers(len(COLORS)))]
    return bag if sex else "", color


def has_things(blend: Floats, row: int) -> bool:
    """Return whether a person has a chair or what belongs to an activity."""
    return bool(blend[row, HOLDING].max() > 0.5)


def holds(people: People, blend: Floats, row: int) -> bool:
    """Return whether a person has anything: a bag, a chair, or what belongs to an activity."""
    return has_things(blend, row) or bag_of(people, row) != ""


def carried_parts(
    people: People, posture: Posture, yaw: Floats, blend: Floats, row: int, chair: bool
) -> list[CarriedPart]:
    """Return what a person holds, pushes and wears, and the ``chair`` of who sits.

    Things appear when more than half of an activity has begun.
    """
    holder, bag = _holder(people, posture, yaw, row)
    parts = _held(holder, blend, row, chair)
    if bag and blend[row, ACTIVITIES.index("sit")] < 0.1:
        parts += BAGS[bag](holder)
    return parts


def carried_solids(
    people: People, posture: Posture, yaw: Floats, blend: Floats, row: int, chair: bool
) -> list[tuple[str, Floats, Floats, Floats]]:
    """Return kind, rotation ``[3, 3]``, place ``[3]`` [m] and sizes ``[3]`` [m] of what rays see of held things.

    Bags are left out: they lie close to the body.
    """
    if not has_things(blend, row):
        return []
    parts = _held(_holder(people, posture, yaw, row)[0], blend, row, chair)
    return [
        (part.shape.solid.kind, part.turn, part.place, np.array(part.shape.solid.size))
        for part in parts
        if part.shape.solid.kind
    ]


def _held(holder: _Holder, blend: Floats, row: int, chair: bool) -> list[CarriedPart]:
    parts = [part for name, make in HELD.items() if blend[row, ACTIVITIES.index(name)] > 0.5 for part in make(holder)]
    if chair and blend[row, ACTIVITIES.index("sit")] > 0.5:
        parts += _chair(holder)
    return parts


def _holder(people: People, posture: Posture, yaw: Floats, row: int) -> tuple[_Holder, str]:
    """Return a person with the axes that things need, and the bag."""
    head = people.measures.head[row]
    cos, sin = math.cos(yaw[row]), math.sin(yaw[row])
    trunk = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    bones = posture.position[row]
    feet = [shapes().bone(f"foot_{side}") for side in "lr"]
    low = min(float(bones[foot, 2] - head[foot, 2]) for foot in feet)
    person = people.persons[row]
    bag, color = _choice(person.name, person.sex, int(people.variation[row]))
    holder = _Holder(
        posture.rotation[row], bones, head, rest_skeleton(people, row).hands, np.array([*bones[0, :2], low]), trunk,
        float(people.height[row]) / 1.70, color,
    )  # fmt: skip
    return holder, bag
