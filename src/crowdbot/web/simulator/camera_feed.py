"""CameraFeed: images of camera sensors for the windows of a session."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from crowdbot.core import InputError
from crowdbot.sensors import Reading
from crowdbot.simulation import Simulation
from crowdbot.web.desk import DeskWindows
from crowdbot.web.scene import SensorImage, encode_image, sensor_images

Recorded = Callable[[SensorImage], Reading | None]
SHARE = 0.15
"""Largest share of a processor core for making images."""
PATIENCE = 0.25
"""Longest time [s] that an image waits for a window that is busy; then the window gets the newest when it is ready."""


class CameraFeed:
    """Sends the newest images of the chosen cameras, each reading at most once, from a thread of its own.

    The run only hands its readings over. An image that has not been made when the next one comes is left out. So
    neither many pixels nor a slow window slow the run.

    Args:
        session: the windows.

    Attributes:
        chosen: names of the images that are sent, see :func:`crowdbot.web.scene.sensor_images`.
        sent: number of images that were sent.
    """

    def __init__(self, session: DeskWindows) -> None:
        self._session = session
        self.chosen: frozenset[str] = frozenset()
        self.sent = 0
        self._changed = threading.Condition()
        self._closed = False
        self._thread: threading.Thread | None = None
        self._known: dict[str, Any] = {}
        self._waiting: dict[str, tuple[SensorImage, int, int, Callable[[], Reading]]] = {}
        self._images: tuple[tuple[Simulation, Any], list[SensorImage]] | None = None

    def choose(self, names: frozenset[str]) -> None:
        """Send the images with these names from now on, beginning with the current ones."""
        with self._changed:
            self.chosen = names
            self._known.clear()
            self._waiting.clear()
            if names and self._thread is None and not self._closed:
                self._thread = threading.Thread(target=self._serve, name="crowdbot-cameras", daemon=True)
                self._thread.start()

    def renew(self) -> None:
        """Send the current images again, for a new window."""
        with self._changed:
            self._known.clear()

    def offer(
        self, simulation: Simulation, revision: int, recorded: Callable[[SensorImage], Reading | None] | None = None
    ) -> None:
        """Take the readings that are new; called in the thread of the run.

        Args:
            simulation: the simulation.
            revision: number of its description.
            recorded: returns the recorded reading of an image, for the picture of an episode.
        """
        if not self.chosen:
            return
        for number, image in enumerate(self._of(simulation)):
            if image.name not in self.chosen:
                continue
            token, make = _newest(image, recorded)
            with self._changed:  # another thread may choose in the meantime
                if token is None or image.name not in self.chosen or self._known.get(image.name) is token:
                    continue
                self._known[image.name] = token
                self._waiting[image.name] = image, number, revision, make
                self._changed.notify_all()

    def close(self) -> None:
        """End the thread."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        if self._thread is not None:
            self._thread.join()

    def _of(self, simulation: Simulation) -> list[SensorImage]:
        known = self._images
        if known is None or known[0][0] is not simulation or known[0][1] is not simulation.trial:
            known = self._images = (simulation, simulation.trial), sensor_images(simulation)
        return known[1]

    def _serve(self) -> None:
        while True:
            with self._changed:
                while not self._waiting and not self._closed:
                    self._changed.wait()
            self._await_window()
            with self._changed:
                if self._closed:
                    return
                if not self._waiting:
                    continue
                image, number, revision, make = self._waiting.pop(next(iter(self._waiting)))
            begin = time.thread_time()
            try:
                self._session.show(encode_image(make(), image, f"cam{number}", revision))
                self.sent += 1
            except InputError:  # a sensor of the user that delivers something else has no image
                continue
            cost = time.thread_time() - begin
            with self._changed:
                self._changed.wait_for(lambda: self._closed, cost / SHARE - cost)

    def _await_window(self) -> None:
        end = time.monotonic() + PATIENCE
        while not (self._closed or self._session.is_ready()) and time.monotonic() < end:
            time.sleep(0.01)


def _newest(image: SensorImage, recorded: Recorded | None) -> tuple[Any, Callable[[], Reading]]:
    """Return what identifies the newest reading, None without one, and a function that returns the reading."""
    if recorded is not None:
        reading: Any = recorded(image)
        return reading, lambda: reading
    batch = image.sensor.latest[0]
    row = int(image.sensor.latest_row[0])
    return batch, lambda: batch.row(row)
