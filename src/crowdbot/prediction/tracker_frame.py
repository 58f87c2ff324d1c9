"""TrackerFrame: one frame of a tracker, checked before it changes anything."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from numbers import Real
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError
from crowdbot.typing import Floats


@dataclass(frozen=True)
class TrackerFrame:
    """What a tracker says about N people at one time.

    Fields:
        labels: N different identities.
        position: ``[N, 2]`` [m].
        robots: identities of robots.
        time: time stamp [s], or None.
        covariance: ``[N, 2, 2]`` [m^2] of the positions, NaN where unknown, or None.
        radius: ``[N]`` [m], NaN where unknown.
        existence: ``[N]`` probability that there is a person, 1 where the tracker does not say.
        uncertainty: ``[N, 3, 3]`` covariance of the placement of the coordinate frame in which each person was seen
            (see :meth:`crowdbot.data.Frames.pose_covariance`), or None.
    """

    labels: list[Hashable]
    position: Floats
    robots: list[Hashable]
    time: float | None
    covariance: Floats | None
    radius: Floats
    existence: Floats
    uncertainty: Floats | None = None

    @classmethod
    def of(
        cls, ids: Iterable[Hashable], position: ArrayLike, robots: Iterable[Hashable] = (), time: float | None = None,
        covariances: ArrayLike | None = None, radii: ArrayLike | None = None, existence: ArrayLike | None = None,
    ) -> Self:  # fmt: skip
        """Return a frame of checked values, see :meth:`Live.update`.

        Raises:
            InputError: a value has a wrong type or shape or is impossible; the sentence names it.

        >>> frame = TrackerFrame.of([7.0, "a"], [[0.0, 1.0], [2.0, 3.0]])
        >>> frame.labels, frame.position.shape, frame.time
        ([7, 'a'], (2, 2), None)
        """
        labels = _checked_labels(ids, "ids")
        place = _checked_positions(position, labels)
        repeated = [label for label, count in Counter(labels).items() if count > 1]
        if repeated:
            raise InputError(
                f"live: identity {repeated[0]!r} occurs {labels.count(repeated[0])} times in a frame of"
                f" {len(labels)}; identities must be distinct, send each person once"
            )
        return cls(
            labels, place, _checked_labels(robots, "robots"), _checked_stamp(time),
            _checked_covariances(covariances, labels), _checked_radii(radii, labels),
            _checked_existence(existence, labels),
        )  # fmt: skip


def _checked_labels(ids: Iterable[Hashable], name: str) -> list[Hashable]:
    """Return identities; numbers of NumPy and of tensors become those of Python, and 7.0 becomes 7."""
    if isinstance(ids, str | bytes) or not isinstance(ids, Iterable):
        raise InputError(
            f"live: {name} = {ids!r} must be a list of identities, one for each"
            f" {'position' if name == 'ids' else 'robot'}; for one alone write [{ids!r}]"
        )
    ndim = getattr(ids, "ndim", 1)
    if ndim != 1:
        raise InputError(f"live: {name} have shape {list(ids.shape)}, they must be [N]; flatten them")  # type: ignore[attr-defined]
    labels = ids.tolist() if isinstance(ids, np.ndarray) else list(ids)
    return labels if all(type(label) is int for label in labels) else [_checked_label(label, name) for label in labels]


def _checked_label(label: Hashable, name: str) -> Hashable:
    if getattr(label, "shape", None) == () and hasattr(label, "item"):
        label = label.item()  # two tensors of the same number have different hashes
    if isinstance(label, float) and label.is_integer():
        return int(label)
    if label is None or isinstance(label, bool | float):
        raise InputError(
            f"live: {label!r} in {name} is no identity; an identity is a whole number, a text or any other hashable"
            " value that stays the same while a person is tracked; leave people without one out of the frame"
        )
    try:
        hash(label)
    except TypeError:
        raise InputError(
            f"live: {label!r} in {name} is no identity: a {type(label).__name__} is not hashable; use a whole number,"
            " a text or a tuple"
        ) from None
    return label


def _checked_positions(position: ArrayLike, labels: list[Hashable]) -> Floats:
    count = len(labels)
    try:
        place = np.array(position, dtype=float)  # a copy: trackers write into the same buffer again
    except (TypeError, ValueError):
        raise InputError(
            f"live: position must be numbers [N, 2], x and y [m] of each of {count} identities; it is not, or its"
            " rows differ in length"
        ) from None
    if count == 0 and place.size == 0:
        return np.zeros((0, 2))
    if place.ndim != 2 or place.shape[1] != 2:
        extra = place.ndim == 2 and place.shape[1] > 2
        remedy = "pass position[:, :2] without height and others" if extra else "pass one row for each identity"
        raise InputError(
            f"live: position has shape {list(place.shape)}, it must be [{count}, 2], x and y [m]; {remedy}"
        )
    if len(place) != count:
        raise InputError(f"live: {count} identities and {len(place)} positions; the numbers must be equal")
    finite = np.isfinite(place)
    if not finite.all():
        bad = int(np.argmin(finite.all(axis=1)))
        raise InputError(
            f"live: the position of {labels[bad]!r} is not finite: {place[bad].tolist()}; leave people without a"
            " position out of the frame"
        )
    return place


def _checked_stamp(time: object) -> float | None:
    if time is None:
        return None
    if not isinstance(time, Real):
        raise InputError(
            f"live: time = {time!r} must be a number of seconds; of a ROS stamp it is stamp.sec + 1e-9 *"
            " stamp.nanosec, of a datetime its timestamp()"
        )
    if not math.isfinite(time):
        raise InputError(f"live: time stamp {time} s must be finite; leave it out (None) if the tracker has no clock")
    return float(time)


def _checked_covariances(covariances: ArrayLike | None, labels: list[Hashable]) -> Floats | None:
    """Return covariances ``[N, 2, 2]`` [m^2], or None.

    Raises:
        InputError: the shape is wrong, or a matrix is not finite, symmetric and positive semidefinite.
    """
    if covariances is None:
        return None
    count = len(labels)
    try:
        spread = np.array(covariances, dtype=float)
    except (TypeError, ValueError):
        raise InputError("live: covariances must be numbers [N, 2, 2]") from None
    if count == 0 and spread.size == 0:
        return np.zeros((0, 2, 2))
    if spread.shape != (count, 2, 2):
        raise InputError(f"live: covariances have shape {list(spread.shape)}, they must be [{count}, 2, 2] [m^2]")
    unknown = np.isnan(spread).all(axis=(1, 2))
    known = np.where(unknown[:, None, None], 0.0, spread)
    size = np.abs(known).max(axis=(1, 2))
    infinite = ~np.isfinite(size)
    skew = np.abs(known[:, 0, 1] - known[:, 1, 0]) > 1e-6 * size
    smallest = np.linalg.eigvalsh(np.where(infinite[:, None, None], 0.0, known))[:, 0]
    negative = smallest < -1e-6 * np.where(infinite, 0.0, size)
    wrong = infinite | skew | negative
    if wrong.any():
        bad = int(np.argmax(wrong))
        why = "not finite" if infinite[bad] else "not symmetric" if skew[bad] else "not positive semidefinite"
        raise InputError(
            f"live: covariance of {labels[bad]!r} is {why}: {spread[bad].tolist()}; it must be finite, symmetric and"
            " positive semidefinite [m^2], or all NaN if it is unknown"
        )
    return np.asarray(0.5 * (spread + np.swapaxes(spread, 1, 2)))


def _checked_radii(radii: ArrayLike | None, labels: list[Hashable]) -> Floats:
    """Return radii ``[N]`` [m], NaN where unknown.

    Raises:
        InputError: the shape is wrong, or a radius is not above 0 and finite.
    """
    numbers = _numbers(radii, labels, "radii", "radius [m]", np.nan)
    wrong = ~np.isnan(numbers) & ~((numbers > 0.0) & (numbers < np.inf))
    if wrong.any():
        bad = int(np.argmax(wrong))
        raise InputError(
            f"live: radius {numbers[bad]} m of {labels[bad]!r} must be above 0 and finite, or NaN if it is unknown"
        )
    return numbers


def _checked_existence(existence: ArrayLike | None, labels: list[Hashable]) -> Floats:
    """Return probabilities ``[N]``, 1 where unknown.

    Raises:
        InputError: the shape is wrong, or a probability is not above 0 and at most 1.
    """
    numbers = _numbers(existence, labels, "existence", "probability", 1.0)
    numbers = np.where(np.isnan(numbers), 1.0, numbers)
    wrong = ~((numbers > 0.0) & (numbers <= 1.0))
    if wrong.any():
        bad = int(np.argmax(wrong))
        raise InputError(
            f"live: existence {numbers[bad]} of {labels[bad]!r} must be above 0 and at most 1; leave people who do not"
            " exist out of the frame"
        )
    return numbers


def _numbers(values: ArrayLike | None, labels: list[Hashable], name: str, what: str, unknown: float) -> Floats:
    """Return one number for each identity, ``unknown`` if there are none."""
    if values is None:
        return np.full(len(labels), unknown)
    try:
        numbers = np.array(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"live: {name} must be numbers [N], the {what} of each identity") from None
    if numbers.shape != (len(labels),):
        raise InputError(f"live: {name} have shape {list(numbers.shape)}, they must be [{len(labels)}]")
    return numbers
