"""RoomsDesk: the commands of the operator about the rooms of person and robot."""

from __future__ import annotations

import json
import threading
from typing import Any

from crowdbot import web
from crowdbot.core import InputError
from crowdbot.web import Desk, DeskWindows

from .rigid_transform import RigidTransform
from .room_limits import RoomLimits
from .shared_rooms import SharedRooms

__all__ = ["RoomsDesk"]


class RoomsDesk(Desk):
    """A desk with rooms that are placed, calibrated and limited, and files of their calibration."""

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self.rooms = SharedRooms()
        self._lock = threading.RLock()

    @web.command
    def add_pair(self, room: str, source: list[float], target: list[float]) -> None:
        """Add a calibration point: coordinates in a room, such as ``robot``, and in the virtual room [m]."""
        with self._lock:
            self.rooms.add_pair(room, source, target)
        self._tell_state()

    @web.command
    def clear_points(self, room: str) -> None:
        """Remove the calibration points of a room."""
        with self._lock:
            self.rooms.clear(room)
        self._tell_state()

    @web.command
    def calibrate(self, room: str) -> dict[str, Any]:
        """Compute the place of a room from its points; returns it with the residuals."""
        with self._lock:
            self.rooms.calibrate(room)
            found = self.rooms.room(room).state()
            self._note_all({"calibration": {"room": room, **found}})
        self._tell_state()
        return found

    @web.command
    def place_room(self, room: str, x: float, y: float, heading: float = 0.0) -> None:
        """Set the place of a room without calibration: its origin and heading in the virtual room [m], [rad]."""
        with self._lock:
            self.rooms.room(room).set_place(RigidTransform.at(float(x), float(y), float(heading)))
        self._tell_state()

    @web.command
    def limit_room(self, room: str, corners: list[Any]) -> None:
        """Set the free floor of a room: corners x, y [m] in its frame; an empty list removes the limits."""
        with self._lock:
            self.rooms.room(room).limits = RoomLimits(tuple(corners)) if corners else None
        self._tell_state()

    @web.command
    def save_rooms(self, name: str = "rooms") -> str:
        """Write places, points and limits of the rooms to NAME.json in the folder of the app; returns its name."""
        target = name if name.endswith(".json") else f"{name}.json"
        with self._lock:
            text = json.dumps(self.rooms.record(), indent=1)
        self.session.workspace.writable(target).write_text(text + "\n", encoding="utf-8")
        return target

    @web.command
    def load_rooms(self, name: str = "rooms") -> None:
        """Take the rooms of a file that :meth:`save_rooms` has written."""
        path = self.session.workspace.readable(name if name.endswith(".json") else f"{name}.json")
        try:
            record = json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise InputError(f"{path.name} is not JSON: {error}") from None
        with self._lock:
            self.rooms.restore(record)
            self._note_all({"rooms": self.rooms.record()})
        self._tell_state()

    def _note_all(self, values: dict[str, Any]) -> None:
        """Write something to the recordings of all participants."""

    def _tell_state(self) -> None:
        """Tell all windows the state."""
