"""StageView: what a window sees of a simulation: description, frames and live values."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

from crowdbot.simulation import Simulation
from crowdbot.web.desk import DeskWindows
from crowdbot.web.scene import LAYERS, scene_description, scene_frame

from .live_values import live_values
from .walking_bodies import WalkingBodies

__all__ = ["StageView"]

FRAME = 1.0 / 60.0
"""Shortest real time [s] between two frames."""
SHARE = 0.15
"""Largest share of a processor core for the frames; large crowds get fewer of them."""
STATUS = 0.2
"""Shortest real time [s] between two events with the status."""


class StageView:
    """Sends a simulation to the windows of a session: at most 60 frames a second, however fast it runs.

    Args:
        session: the windows.
        layers: names of the layers that a window shows.
        channel: channel of the frames.
    """

    def __init__(self, session: DeskWindows, layers: frozenset[str] = frozenset(), channel: str = "scene") -> None:
        self.session, self.layers, self.channel = session, layers, channel
        self._bodies: WalkingBodies | None = None
        self._simulation: Simulation | None = None
        self._shown = self._told = 0.0
        self._closed, self._cost = False, 0.0
        self._rate: tuple[float, float] | None = None
        self.factor: float | None = None
        """Simulated time over real time since the status before."""

    def open(self, simulation: Simulation) -> None:
        """Show another simulation, or the same one after a jump in time."""
        self._simulation, self._bodies, self._rate = simulation, WalkingBodies(simulation), None

    def close(self) -> None:
        """Send nothing more: the windows show something else. Called from any thread."""
        self._closed = True

    def description(self) -> dict[str, Any]:
        """Return what stands still."""
        if self._simulation is None or self._bodies is None:
            return {}
        return scene_description(self._simulation, self._bodies.motion)

    def show(self, always: bool = False) -> bool:
        """Send a frame if one is due; return whether it was sent."""
        now = time.monotonic()
        if self._closed or self._simulation is None or self._bodies is None:
            return False
        if now - self._shown < max(FRAME, self._cost / SHARE) and not always:
            return False
        self._shown = now
        layers = [name for name in LAYERS if name in self.layers]
        begin = time.thread_time()
        self._bodies.follow(self._simulation)
        frame = scene_frame(self._simulation, layers, self._bodies.motion)
        self.session.show(replace(frame, channel=self.channel))
        self._cost = time.thread_time() - begin
        return True

    def is_status_due(self) -> bool:
        """Return whether the windows should get the status."""
        return time.monotonic() - self._told >= STATUS

    def measure(self) -> dict[str, float | None]:
        """Return the live values, and note the real-time factor."""
        now = self._told = time.monotonic()
        if self._simulation is None:
            return {}
        at = float(self._simulation.world.times[0])
        if self._rate is not None and now - self._rate[1] > 0.05:
            self.factor = (at - self._rate[0]) / (now - self._rate[1])
        self._rate = (at, now)
        return live_values(self._simulation)
