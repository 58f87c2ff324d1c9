"""Real rooms of participants: their limits, and several participants in one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from crowdbot.core import InputError

from .rigid_transform import RigidFit, RigidTransform, fit_rigid


@dataclass(frozen=True)
class RoomLimits:
    """Free floor of a room.

    Fields:
        corners: corners of a polygon without crossings, x, y [m], in the frame of the room.

    Raises:
        InputError: there are fewer than 3 or more than 100 corners, or a coordinate is not a finite number.

    >>> limits = RoomLimits(((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)))
    >>> limits.margin(1.0, 1.5), limits.margin(5.0, 1.0)
    (1.0, -1.0)
    """

    corners: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        rows = [tuple(corner) if isinstance(corner, list | tuple) else () for corner in self.corners]
        if not 3 <= len(rows) <= 100 or any(len(row) != 2 for row in rows):
            raise InputError("limits of a room: expected 3 to 100 corners x, y")
        if not all(isinstance(item, int | float) and abs(item) <= 1e3 for row in rows for item in row):
            raise InputError("limits of a room: each coordinate must be a number of at most 1000 m")
        object.__setattr__(self, "corners", tuple((float(x), float(y)) for x, y in rows))

    def margin(self, x: float, y: float) -> float:
        """Return the distance [m] to the nearest side; negative outside."""
        a = np.array(self.corners)
        b = np.roll(a, -1, axis=0)
        along, point = b - a, np.array([x, y]) - a
        square = np.maximum(np.sum(along * along, axis=1), 1e-12)
        share = np.clip(np.sum(point * along, axis=1) / square, 0.0, 1.0)
        gap = float(np.min(np.linalg.norm(point - share[:, None] * along, axis=1)))
        above, next_above = a[:, 1] > y, b[:, 1] > y
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
        inside = bool(np.sum((above != next_above) & (x < crossing)) % 2)
        return gap if inside else -gap


ROOMS = ("person", "robot")
FEWEST = 3
"""Points that define the place of a room."""
PERSON = "person"
"""Room of the first participant, and begin of the names of the rooms of others."""
MOST = 200
"""Largest number of calibration points of a room."""


@dataclass
class RealRoom:
    """A real room and its place in the virtual one.

    Fields:
        place: transform from the room to the virtual room.
        limits: free floor in the frame of the room, or None.
        source, target: touched points in the frame of the room and of the virtual room [m].
        fit: the calibration, or None without one.
        chosen: whether the operator has set the place; otherwise it is a guess.
    """

    place: RigidTransform = field(default_factory=lambda: RigidTransform.at(0.0, 0.0))
    limits: RoomLimits | None = None
    source: list[list[float]] = field(default_factory=list)
    target: list[list[float]] = field(default_factory=list)
    fit: RigidFit | None = None
    chosen: bool = False

    def set_place(self, place: RigidTransform) -> None:
        """Set the place without points."""
        self.place, self.chosen = place, True
        self.source, self.target, self.fit = [], [], None

    def guess_place(self, x: float | None, y: float | None, heading: float) -> None:
        """Set the place [m], [rad] unless it is known better."""
        if self.fit is None and not self.chosen and x is not None and y is not None:
            self.place = RigidTransform.at(x, y, heading)

    def state(self) -> dict[str, Any]:
        """Return the room as JSON: place, limits, points, and the residuals [m] of the calibration."""
        fit = self.fit
        return {
            "x": float(self.place.translation[0]),
            "y": float(self.place.translation[1]),
            "z": float(self.place.translation[2]),
            "heading": self.place.heading,
            "limits": [] if self.limits is None else [list(corner) for corner in self.limits.corners],
            "source": self.source,
            "target": self.target,
            "rms": None if fit is None else fit.rms,
            "noise": None if fit is None or fit.noise != fit.noise else fit.noise,
            "residual": [] if fit is None else fit.residual.tolist(),
        }


class SharedRooms:
    """Three workspaces: the room of the person, that of the robot, and the virtual room of the trial.

    A point that is touched in a real room, with its coordinates in the virtual one, is a pair of the calibration. After
    it, real walls are where virtual walls are. The place of the robot's room is the origin of its motion capture in the
    trial.

    Each headset has an origin of its own, so a second participant has a room of its own, ``person NAME``.

    >>> rooms = SharedRooms()
    >>> for x, y in ((0, 0), (2, 0), (2, 3)):
    ...     rooms.add_pair("person", [x, y, 1], [x + 5, y - 1, 1])
    >>> rooms.calibrate("person").rms < 1e-9, rooms.rooms["person"].place.apply([0, 0, 0]).round(6).tolist()
    (True, [5.0, -1.0, 0.0])
    """

    def __init__(self) -> None:
        self.rooms = {name: RealRoom() for name in ROOMS}

    def room(self, name: str) -> RealRoom:
        """Return a room by its name, such as ``person`` or ``robot``; raises InputError for another name."""
        if name not in self.rooms:
            raise InputError(f"room = {name!r}: expected {' or '.join(self.rooms)}")
        return self.rooms[name]

    def add_person(self, name: str) -> str:
        """Add the room of one more participant, by the name of the avatar, and return the name of the room."""
        room = f"{PERSON} {name}"
        self.rooms.setdefault(room, RealRoom())
        return room

    def add_pair(self, name: str, source: Sequence[float], target: Sequence[float]) -> None:
        """Add a point of a room and the same point of the virtual room [m]; raises InputError for other values."""
        room = self.room(name)
        for item in (source, target):
            if len(item) != 3 or not all(isinstance(k, int | float) and abs(k) <= 1e3 for k in item):
                raise InputError(f"calibration: a point {list(item)} must be 3 numbers x, y, z of at most 1000 m")
        if len(room.source) >= MOST:
            raise InputError(f"calibration: more than {MOST} points; clear them first")
        room.source.append([float(item) for item in source])
        room.target.append([float(item) for item in target])

    def clear(self, name: str) -> None:
        """Remove the points of a room; its place stays."""
        room = self.room(name)
        room.source, room.target, room.fit = [], [], None

    def calibrate(self, name: str) -> RigidFit:
        """Compute the place of a room from its points; raises InputError if they do not define it."""
        room = self.room(name)
        room.fit = fit_rigid(room.source, room.target)
        room.place, room.chosen = room.fit.transform, True
        return room.fit

    def record(self) -> dict[str, Any]:
        """Return places, points and limits of the rooms, JSON, for :meth:`restore`."""
        keys = ("x", "y", "z", "heading", "limits", "source", "target")
        return {name: {key: room.state()[key] for key in keys} for name, room in self.rooms.items()}

    def restore(self, record: Any) -> None:
        """Take the rooms of a record; a room with at least 3 points is calibrated again.

        Raises:
            InputError: it is no record of rooms; nothing changes.
        """
        made = SharedRooms()
        if not isinstance(record, dict) or len(record) > MOST or not all(map(_is_room, record)):
            raise InputError(f"a file of rooms must have the keys {' and '.join(ROOMS)}")
        try:
            for name, item in record.items():
                room = made.rooms.setdefault(name, RealRoom())
                numbers = [float(item[key]) for key in ("x", "y", "z", "heading")]
                room.set_place(RigidTransform.at(numbers[0], numbers[1], numbers[3], numbers[2]))
                room.limits = RoomLimits(tuple(tuple(row) for row in item["limits"])) if item["limits"] else None
                for source, target in zip(item["source"], item["target"], strict=True):
                    made.add_pair(name, source, target)
                if len(room.source) >= FEWEST:
                    made.calibrate(name)
        except InputError:
            raise
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(f"a file of rooms is damaged: {error!r}") from None
        self.rooms.update({name: made.rooms[name] for name in record})

    def margin(self, name: str, x: float, y: float) -> float | None:
        """Return the distance [m] of a place of the virtual room to the limits of a real one; None without limits."""
        room = self.room(name)
        if room.limits is None:
            return None
        inside = room.place.inverse().apply([x, y, 0.0])
        return room.limits.margin(float(inside[0]), float(inside[1]))


def _is_room(name: object) -> bool:
    return isinstance(name, str) and (name in ROOMS or name.startswith(f"{PERSON} "))
