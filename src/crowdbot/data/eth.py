"""ETH and UCY recordings as their authors' ``obsmat.txt``, and the two time bases of the ETH one.

Eight columns: frame, id, x, z, y and the three velocities; the ground plane is columns 3 and 5. In the ETH file 6
frames are 0.4 s (a camera of 15 frames a second). The much used text of the same recording, ``biwi_eth.txt``, holds
every tenth frame, 0.667 s apart, and is published as if that were 0.4 s: people in it seem to walk 1.67 times too fast.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError

from .assemble import assemble
from .reader import Reader, ReadOptions
from .source import Source
from .trajectories import Trajectories

__all__ = ["READER", "eth_time_base"]

ETH_VIDEO_FPS = 15.0
ROOM = 50.0
"""No recording of the two families is so wide [m]."""

BEGINS = ((780, 1, 8.46, 3.59), (10240, 238, 12.5, 4.35))
"""First row of biwi_eth.txt and of its training part; first row of its validation part."""


def sniff(source: Source) -> bool:
    """Return whether the first rows are eight numbers with zeros where the height stands."""
    return source.numeric(8) and all(float(row[3]) == 0.0 for row in source.rows)


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read an obsmat; when half of the numbers are above 50 they are taken as pixels."""
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
        note="large numbers: taken as pixels; units overrides it" if pixels and options.units is None else "",
        line=line,
    )


def eth_time_base(values: NDArray[np.float64], options: ReadOptions) -> tuple[float | None, str]:
    """Return frames a second and a label when ``values`` (frame, id, x, y) are the text of the ETH recording.

    The true base says 15 frames a second, so that its rows are 0.667 s apart; the published one says 25, so 0.4 s.
    """
    order = np.lexsort((values[:, 1], values[:, 0]))
    first = tuple(values[order[0]])
    frames = np.unique(values[:, 0])
    known = first in BEGINS and len(frames) > 1 and np.all(np.diff(frames) % 10 == 0) and frames[-1] <= 12380
    if not known or options.fps is not None:
        return None, ""
    if options.time_base == "published":
        return 25.0, "time base published: 10 frames taken as 0.4 s, truly 0.667 s, so speeds are 1.67 times too high"
    return ETH_VIDEO_FPS, "time base true: 10 frames are 0.667 s; publications take them as 0.4 s (time_base published)"


READER = Reader("eth-obsmat", "ETH/UCY obsmat.txt: frame id x z y vx vz vy", sniff, read)
