"""RunEnd: how a run ended, and RunFailure: an exception that ended it, as data."""

from __future__ import annotations

import sysconfig
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import storable

PACKAGE = Path(__file__).resolve().parents[1]
INSTALLED = [Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "platstdlib", "purelib", "platlib")]


class RunFailureWarning(UserWarning):
    """An exception ended a run; the outcome of its episode is ``error``."""


@storable
@dataclass(frozen=True)
class RunFailure:
    """An exception in a navigator, sensor, crowd model or bridge that ended a run.

    Fields:
        message: type and text of the exception, in one line.
        place: file and line of the exception, in the user's code if the trace has any: ``my_navigator.py:12``.
        time: simulated time [s].
        trace: the Python traceback, empty for an episode from a file.

    >>> try:
    ...     1 / 0
    ... except ZeroDivisionError as error:
    ...     failure = RunFailure.of(error, 1.25)
    >>> failure.message, failure.time
    ('ZeroDivisionError: division by zero', 1.25)
    """

    message: str
    place: str
    time: float
    trace: str = field(default="", compare=False, repr=False)

    @classmethod
    def of(cls, error: Exception, time: float, folder: Path | None = None) -> RunFailure:
        """Describe an exception; files in ``folder`` have relative paths, others only their name."""
        message = " ".join(f"{type(error).__name__}: {error}".split()).removesuffix(":")
        place = getattr(error, "place", "") or _place(error, folder)  # of a replayed decision that hangs
        return cls(message, place, time, "".join(traceback.format_exception(error)))

    def __str__(self) -> str:
        """Return a sentence without full stop."""
        return f"{self.message} ({self.place}) at {self.time:g} s"


class RunEnd(NamedTuple):
    """The end of a run.

    Fields:
        outcome: outcome of the episode.
        steps: number of steps.
        failure: the exception that ended it, or None.
        decision_times: compute times [s] of the measured decisions by robot, see :class:`Episode`.
    """

    outcome: str
    steps: int
    failure: RunFailure | None = None
    decision_times: Mapping[str, tuple[float, ...]] = {}


def _place(error: Exception, folder: Path | None) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    if not frames:
        return "unknown"
    own = [frame for frame in frames if not _is_library(Path(frame.filename))]
    frame = (own or frames)[-1]
    path = Path(frame.filename)
    if folder is not None and path.is_relative_to(folder.resolve()):
        return f"{path.relative_to(folder.resolve()).as_posix()}:{frame.lineno}"
    return f"{path.name}:{frame.lineno}"


def _is_library(path: Path) -> bool:
    """Return whether a file belongs to crowdbot, Python or an installed package."""
    real = path.resolve()  # an environment may be a symbolic link
    return path.name.startswith("<frozen") or any(real.is_relative_to(place) for place in (PACKAGE, *INSTALLED))
