"""ETH and UCY recordings in the original format ``obsmat.txt``, and the two time bases of the ETH recording.

The eight columns are frame, id, x, z, y and three velocities; columns 3 and 5 are the ground plane. In the ETH file 6
frames are 0.4 s (15 frames/s). The common text version ``biwi_eth.txt`` has every tenth frame, which is 0.667 s, but is
published with a step of 0.4 s: its speeds are 1.67 times too high.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .reader import Reader, ReadOptions

ETH_VIDEO_FPS = 15.0
ROOM = 50.0
"""Coordinates [m] beyond this are pixels; no recording of ETH and UCY is wider."""

BEGINS = ((780, 1, 8.46, 3.59), (10240, 238, 12.5, 4.35))
"""First row of biwi_eth.txt and of its training part; first row of its validation part."""


def sniff(source: Source) -> bool:
    """Return whether the first rows have eight numbers and a height of 0."""
    return source.numeric(8) and all(float(row[3]) == 0.0 for row in source.rows)


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read an obsmat; coordinates with a median above 50 are pixels."""
    values, line = source.table(8)
    if len(values) == 0:
        raise DataError(f"{source.name} has no rows")
    x, y = values[:, 2], values[:, 4]
    pixels = bool(np.median(np.abs(values[:, 2:5:2])) > ROOM)
    return assemble(
        source,
        options,
        frame=values[:, 0],
        id=values[:, 1],
        x=x,
        y=y,
        units="px" if pixels else "m",
        note="large coordinates are interpreted as pixels; units overrides this"
        if pixels and options.units is None
        else "",
        line=line,
    )


def eth_time_base(values: NDArray[np.float64], options: ReadOptions) -> tuple[float | None, str]:
    """Return the frame rate [Hz] and a note if ``values`` (frame, id, x, y) are the text version of the ETH recording.

    The true time base is 15 frames/s, 0.667 s between rows; the published one is 25 frames/s, 0.4 s between rows.
    """
    order = np.lexsort((values[:, 1], values[:, 0]))
    first = tuple(values[order[0]])
    frames = np.unique(values[:, 0])
    known = first in BEGINS and len(frames) > 1 and np.all(np.diff(frames) % 10 == 0) and frames[-1] <= 12380
    if not known or options.fps is not None:
        return None, ""
    if options.time_base == "published":
        return 25.0, "time base published: 10 frames are 0.4 s instead of 0.667 s, so speeds are 1.67 times too high"
    return ETH_VIDEO_FPS, "time base true: 10 frames are 0.667 s; publications use 0.4 s (time_base published)"


READER = Reader("eth-obsmat", "ETH/UCY obsmat.txt: frame id x z y vx vz vy", sniff, read)
