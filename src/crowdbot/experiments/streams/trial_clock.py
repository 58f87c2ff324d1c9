"""Clocks of a trial: simulated time, the monotonic clock of the computer, and the time of day."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import EpisodeError
from crowdbot.simulation import StepRecord
from crowdbot.typing import Floats

CLOCK_FILE = "clock.csv"
HEAD = "time,monotonic,utc\n"


class TrialClock(NamedTuple):
    """When the steps of a trial were recorded.

    Fields:
        time: ``[T]`` simulated time [s].
        monotonic: ``[T]`` monotonic clock of the computer [s], as Python's ``time.monotonic``.
        utc: ``[T]`` seconds since 1970.
    """

    time: Floats
    monotonic: Floats
    utc: Floats

    @property
    def offset(self) -> float:
        """UTC minus the monotonic clock [s], median over the steps."""
        return float(np.median(self.utc - self.monotonic))

    def simulation_time(self, monotonic: ArrayLike) -> Floats:
        """Return the simulated times of instants of the monotonic clock [s]; NaN outside of the trial.

        >>> clock = TrialClock(np.array([0.0, 1.0, 2.0]), np.array([50.0, 51.0, 51.5]), np.zeros(3))
        >>> clock.simulation_time([50.5, 51.25, 60.0]).tolist()
        [0.5, 1.5, nan]
        """
        instants = np.asarray(monotonic, dtype=np.float64)
        return np.asarray(np.interp(instants, self.monotonic, self.time, left=np.nan, right=np.nan))


class TrialClockLog:
    """Writes the clocks at each recorded step of a trial to ``clock.csv``; a sink of step records.

    Args:
        folder: folder of the trial.
        monotonic, utc: clocks [s].

    Raises:
        EpisodeError: the file cannot be written.
    """

    def __init__(
        self, folder: Path, monotonic: Callable[[], float] = time.monotonic, utc: Callable[[], float] = time.time
    ) -> None:
        self.path = folder / CLOCK_FILE
        self._monotonic, self._utc = monotonic, utc
        try:
            self._file = self.path.open("w", encoding="utf-8")
            self._file.write(HEAD)
        except OSError as error:
            raise EpisodeError(f"cannot write {self.path}: {error.strerror}") from None

    def take(self, frame: StepRecord) -> None:
        """Write the clocks of a recorded step."""
        if frame.due and not self._file.closed:
            self._file.write(f"{frame.nanoseconds / 1e9:.9f},{self._monotonic():.6f},{self._utc():.6f}\n")

    def close(self) -> None:
        """Close the file; more steps are left out."""
        self._file.close()


def read_trial_clock(folder: Path) -> TrialClock | None:
    """Return the clocks of a trial; None if they were not recorded.

    Raises:
        EpisodeError: the file is damaged.
    """
    path = folder / CLOCK_FILE
    if not path.is_file():
        return None
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    whole = [line for line in lines[1:] if line.endswith("\n")]
    try:
        rows = np.array([[float(cell) for cell in line.split(",")] for line in whole], dtype=np.float64).reshape(-1, 3)
    except ValueError:
        raise EpisodeError(f"{path} is damaged; expected rows of {HEAD.strip()}") from None
    return TrialClock(*rows.T) if len(rows) else None
