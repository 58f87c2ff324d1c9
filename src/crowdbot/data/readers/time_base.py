"""Time base of a recording: frames per second and rows per second.

``fps`` is frames per second of the frame counter. Rows of one track are ``step`` frames apart, so a row lasts
``step / fps`` seconds.
"""

from __future__ import annotations

import math

from crowdbot.core import DataError

from .reader import ReadOptions

CONVENTIONAL_FPS = {6: 15.0, 10: 25.0, 12: 30.0}
"""fps by frame step of files with rows of 0.4 s: ETH, UCY and the leave-one-out files, and SDD in the TrajNet cut."""
MAX_FPS = 10_000.0


class RowRateError(DataError):
    """``fps`` is given in rows per second; the attribute ``fps`` has it in frames per second [1/s]."""

    def __init__(self, message: str, fps: float) -> None:
        self.fps = fps
        super().__init__(message)


def check_fps(fps: float, name: str = "") -> float:
    """Return ``fps`` [1/s] as a float.

    Raises:
        DataError: it is not above 0 and at most 10000.
    """
    if not 0.0 < fps <= MAX_FPS or not math.isfinite(fps):
        place = f"{name}: " if name else ""
        raise DataError(
            f"{place}fps {fps} is not allowed, it is the number of frames per second: above 0, at most {MAX_FPS:g}"
        )
    return float(fps)


def row_rate_of(
    step: int, options: ReadOptions, name: str, fps: float | None, row_rate: float | None
) -> tuple[float, str]:
    """Return rows per second of a track [1/s], and a note if the value is assumed.

    The option ``fps`` wins over the ``fps`` of the file, that over its ``row_rate``, and that over the conventions.

    Args:
        step: frames between two rows of a track.
        options: options of the user.
        name: name of the file, for messages.
        fps: frames per second according to the file or its format.
        row_rate: rows per second according to the file.

    Raises:
        DataError: a rate is not allowed, or there is none.
    """
    if options.fps is not None:
        return check_fps(options.fps) / step, ""
    if fps is not None:
        return check_fps(fps / step, name), ""
    if row_rate is not None:
        return check_fps(row_rate, name), ""
    if step in CONVENTIONAL_FPS:
        note = f"no frame rate in the file: {step} frames are interpreted as 0.4 s, as in ETH/UCY; fps overrides this"
        return CONVENTIONAL_FPS[step] / step, note
    raise DataError(
        f"{name} has no frame rate, and rows {step} frame{'s' * (step != 1)} apart are not a convention of the field;"
        f" give fps, the frames per second (rows of a track are then {step} / fps seconds apart)"
    )
