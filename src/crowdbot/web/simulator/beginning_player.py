"""BeginningPlayer: a thread that shows a recording while the same run is prepared."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from crowdbot.trials import Trial
from crowdbot.web.desk import DeskWindows, Resource

from .recorded_beginning import RecordedBeginning

TICK = 0.05
"""Real time [s] between two looks at the clock."""


class BeginningPlayer:
    """Sends the frames of a recording to the windows, again and again, until it is stopped.

    Args:
        recorded: the recording.
        trial: the trial of the run that is prepared.
        session: the windows.
        speed: returns simulated time over real time, 0 in a pause.
    """

    def __init__(
        self, recorded: RecordedBeginning, trial: Trial, session: DeskWindows, speed: Callable[[], float]
    ) -> None:
        self.recorded, self._session, self._speed = recorded, session, speed
        self._revision = recorded.revision(trial)
        self._now, self._shown = 0.0, -1
        self._stopped = threading.Event()
        self._sending = threading.Lock()
        self._loaded = threading.Event()
        self._thread = threading.Thread(target=self._play, name="crowdbot-beginning", daemon=True)

    @property
    def active(self) -> bool:
        """Whether it is shown."""
        return not self._stopped.is_set()

    @property
    def now(self) -> float:
        """Time of the recording [s]; grows beyond its end, because it begins again there."""
        return self._now

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """Send nothing more."""
        with self._sending:
            self._stopped.set()

    def show(self) -> None:
        """Send the current frame again, for a new window."""
        with self._sending:
            if self.active:
                self._session.show(self.recorded.frame(max(0, self._shown), self._revision))

    def description(self) -> dict[str, Any]:
        """Return what stands still."""
        return self.recorded.description(self._revision)

    def resource(self, path: str) -> Resource:
        """Return a mesh; raises KeyError if there is none."""
        result = self.recorded.resource(path)
        self._loaded.set()
        return result

    def wait_for_page(self, seconds: float) -> None:
        """Wait until a page loads the picture, at most some seconds, because the compiler then slows the server."""
        self._loaded.wait(seconds)

    def _play(self) -> None:
        before = time.monotonic()
        while not self._stopped.is_set():
            index = int((self._now % (self.recorded.seconds + TICK)) / self.recorded.seconds * (len(self.recorded) - 1))
            if index != self._shown:
                self._shown = index
                self.show()
            self._stopped.wait(TICK)
            now = time.monotonic()
            self._now += (now - before) * self._speed()
            before = now
