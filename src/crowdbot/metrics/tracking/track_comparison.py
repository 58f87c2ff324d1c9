"""TrackComparison: true people and tracks at the same instants, as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Bools, Floats, Ints

FORBIDDEN = 1e9


@dataclass(frozen=True, eq=False)
class TrackComparison:
    """Positions of A true people and of B tracks at T instants; each column is one identity.

    Fields:
        truth: ``[T, A, 2]`` [m]; NaN where absent.
        estimate: ``[T, B, 2]`` [m]; NaN where absent.
        hidden: ``[T, A]`` people who need not be found; default nobody.

    Raises:
        InputError: a shape is wrong.

    >>> table = TrackComparison.of([{3: (0.0, 0.0)}, {3: (1.0, 0.0)}], [{0: (0.1, 0.0)}, {}])
    >>> table.truth.shape, table.estimate[:, 0].tolist()
    ((2, 1, 2), [[0.1, 0.0], [nan, nan]])
    """

    truth: Floats
    estimate: Floats
    hidden: Bools | None = None

    def __post_init__(self) -> None:
        T = len(self.truth)
        for name in ("truth", "estimate"):
            shape = getattr(self, name).shape
            if len(shape) != 3 or shape[0] != T or shape[2] != 2:
                raise InputError(f"tracks: {name} has shape {list(shape)}, it must be [{T}, people, 2]")
        if self.hidden is not None and self.hidden.shape != self.truth.shape[:2]:
            raise InputError(
                f"tracks: hidden has shape {list(self.hidden.shape)}, it must be {list(self.truth.shape[:2])}"
            )

    @classmethod
    def of(
        cls,
        truth: Sequence[Mapping[int, Sequence[float]]],
        estimate: Sequence[Mapping[int, Sequence[float]]],
        hidden: Sequence[Sequence[int]] | None = None,
    ) -> TrackComparison:
        """Return the table of positions by identity at each instant, and identities of the hidden people.

        Raises:
            InputError: the numbers of instants differ.
        """
        if len(truth) != len(estimate) or (hidden is not None and len(hidden) != len(truth)):
            raise InputError(f"tracks: {len(truth)} instants of people, {len(estimate)} of tracks; they must be equal")
        people, columns = _columns(truth)
        tracks, _ = _columns(estimate)
        if hidden is None:
            return cls(people, tracks)
        marks = np.zeros(people.shape[:2], dtype=np.bool_)
        for t, ids in enumerate(hidden):
            marks[t, [columns[who] for who in ids if who in columns]] = True
        return cls(people, tracks, marks)

    def distances(self) -> Floats:
        """Return the distances ``[T, A, B]`` between people and tracks [m]; NaN where one is absent."""
        away = self.truth[:, :, None] - self.estimate[:, None]
        return np.asarray(np.hypot(away[..., 0], away[..., 1]))

    def visible_only(self, reach: float) -> TrackComparison:
        """Return the table without hidden people and without their tracks, assigned within ``reach`` [m].

        A track of a hidden person is then neither right nor wrong, as in the preprocessing of MOTChallenge (Milan et
        al. (2016), MOT16, arXiv 1603.00831).
        """
        if self.hidden is None:
            return self
        truth, estimate = self.truth.copy(), self.estimate.copy()
        for t, distance in enumerate(self.distances()):
            if self.hidden[t].any():
                people, tracks = match_nearest(distance, reach)
                estimate[t, tracks[self.hidden[t, people]]] = np.nan
        truth[self.hidden] = np.nan
        return TrackComparison(truth, estimate)

    def subset(self, people: Bools, tracks: Bools, reach: float) -> TrackComparison:
        """Return the table of some people and of their tracks.

        Tracks within ``reach`` of a person belong to the person; the others are kept where ``tracks`` is true.

        Args:
            people: ``[T, A]`` the people who count.
            tracks: ``[T, B]`` tracks of nobody that count.
            reach: largest distance of a person and a track [m].

        >>> table = TrackComparison.of([{0: (0, 0), 1: (5, 0)}], [{3: (0, 0), 4: (5, 0), 5: (9, 9)}])
        >>> part = table.subset(np.array([[True, False]]), np.array([[True, True, True]]), 0.5)
        >>> np.isnan(part.truth[0, :, 0]).tolist(), np.isnan(part.estimate[0, :, 0]).tolist()
        ([False, True], [False, True, False])
        """
        truth, estimate = self.truth.copy(), self.estimate.copy()
        for t, distance in enumerate(self.distances()):
            chosen = tracks[t].copy()
            who, which = match_nearest(distance, reach)
            chosen[which] = people[t, who]
            estimate[t, ~chosen] = np.nan
        truth[~people] = np.nan
        return TrackComparison(truth, estimate, self.hidden)


def match_nearest(distance: Floats, reach: float) -> tuple[Ints, Ints]:
    """Return the pairs of people and tracks with the smallest sum of distances, as many pairs within reach as possible.

    Args:
        distance: ``[A, B]`` [m], NaN where one is absent.
        reach: largest distance of a pair [m].

    >>> [one.tolist() for one in match_nearest(np.array([[0.2, 0.1], [0.3, 9.0]]), 0.5)]
    [[0, 1], [1, 0]]
    """
    from scipy.optimize import linear_sum_assignment

    fits = distance <= reach  # False for NaN
    people, tracks = linear_sum_assignment(np.where(fits, distance, FORBIDDEN))
    kept = fits[people, tracks]
    return people[kept], tracks[kept]


def _columns(rows: Sequence[Mapping[int, Sequence[float]]]) -> tuple[Floats, dict[int, int]]:
    column = {who: k for k, who in enumerate(sorted({who for row in rows for who in row}))}
    table = np.full((len(rows), len(column), 2), np.nan)
    for t, row in enumerate(rows):
        for who, place in row.items():
            table[t, column[who]] = place
    return table, column
