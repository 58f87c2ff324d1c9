"""ServerStream: what the streams of servers share: the address, the longest wait, and poses within bounds."""

from __future__ import annotations

import time
from abc import abstractmethod
from collections.abc import Callable
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.typing import Floats

from .pose_receiver import BadDatagram, PoseReceiver
from .rotations import normalize

AGAIN = 0.5
"""Time [s] between two requests, attempts to connect, or signs of life."""
FARTHEST = 1e4
"""Largest coordinate [m] of a pose."""


class ServerStream(PoseReceiver):
    """Receives the poses that a server sends.

    Args:
        server: address of the server.
        port: its port; None: the default port of the protocol.
        monotonic: local clock [s].
        timeout: longest time [s] to wait for the server.
    """

    default_port: ClassVar[int]

    def __init__(
        self,
        server: str = "127.0.0.1",
        port: int | None = None,
        monotonic: Callable[[], float] = time.monotonic,
        timeout: float = 5.0,
    ) -> None:
        super().__init__(monotonic)
        self.server, self.timeout = server, timeout
        self.port = self.default_port if port is None else port
        self.prepare()

    @abstractmethod
    def prepare(self) -> None:
        """Set what is known before a server has answered."""


def checked_pose(position: ArrayLike, quaternion: ArrayLike) -> tuple[Floats, Floats]:
    """Return positions ``[N, 3]`` [m] and unit quaternions ``[N, 4]`` (w, x, y, z).

    Raises:
        BadDatagram: a value is not finite, a position is farther than 10 km, or a quaternion is 0.
    """
    place = np.asarray(position, dtype=np.float64)
    unit = normalize(np.asarray(quaternion, dtype=np.float64))
    if unit is None or not np.all(np.abs(place) <= FARTHEST):
        raise BadDatagram("a pose has values that are not finite or out of range")
    return place, unit
