"""All scores of tracks as one row of a table."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .clear_mot import clear_mot
from .hota import hota
from .identity_f1 import identity_f1
from .latency import track_latency
from .occlusions import count_occlusions
from .ospa import gospa, ospa
from .track_comparison import TrackComparison

TRACKING_SCORES = {
    "mota": "",
    "motp": "m",
    "idf1": "",
    "hota": "",
    "ospa": "m",
    "gospa": "m",
    "switches": "",
    "misses": "",
    "false_tracks": "",
    "latency": "s",
    "kept_through_occlusion": "",
}
"""Names of the scores and their units. Misses and false tracks are shares of the people over all instants; switches are
numbers by 100 instants of people; latency is the median of people; the last one is the share of occlusions of at least
0.3 s after which a person has the same track."""


def tracking_scores(
    table: TrackComparison, times: ArrayLike, reach: float = 0.5, cutoff: float = 1.0
) -> dict[str, float]:
    """Return the scores of tracks by name, see :data:`TRACKING_SCORES`.

    Args:
        table: people and tracks.
        times: ``[T]`` [s].
        reach: largest distance of a person and a track in MOTA, MOTP, IDF1 and latency [m].
        cutoff: distance at which HOTA, OSPA and GOSPA see no similarity [m].

    >>> table = TrackComparison.of([{0: (0, 0)}] * 2, [{5: (0.1, 0)}] * 2)
    >>> scores = tracking_scores(table, [0.0, 0.1])
    >>> scores["mota"], round(scores["ospa"], 3), list(scores) == list(TRACKING_SCORES)
    (1.0, 0.1, True)
    """
    clear = clear_mot(table, reach)
    late = track_latency(table, times, reach)
    late = late[~np.isnan(late)]
    count = max(1, clear.people)
    occlusions = count_occlusions(table, times, reach)
    return {
        "mota": clear.mota,
        "motp": clear.motp,
        "idf1": identity_f1(table, reach),
        "hota": hota(table, cutoff).hota,
        "ospa": float(ospa(table, cutoff).mean()) if len(table.truth) else float("nan"),
        "gospa": float(gospa(table, cutoff).mean()) if len(table.truth) else float("nan"),
        "switches": 100.0 * clear.switches / count,
        "misses": clear.misses / count,
        "false_tracks": clear.false_tracks / count,
        "latency": float(np.median(late)) if len(late) else float("nan"),
        "kept_through_occlusion": occlusions.kept / occlusions.total if occlusions.total else float("nan"),
    }
