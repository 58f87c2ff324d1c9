"""Protocols of trajectory prediction: which windows of a recording are cut, and who is scored.

Every protocol cuts one window of consecutive rows per last observed instant, and scores the people who are present at
all rows that it requires. Results of different protocols are not comparable.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, did_you_mean
from crowdbot.typing import Bools, Floats, Ints

from .rows import Runs, runs
from .track_table import TrackTable
from .windows import Windows

PROTOCOLS = {
    "all": "all windows with a person who is present at all rows; frames without people are skipped",
    "sgan": "as all, but only windows with at least two such persons, as in SGAN (Gupta et al. 2018)",
    "partial": "as all, but futures need only 2 rows, and existing rows are scored (Schöller et al. 2020)",
    "timesplit": "windows with exact time steps from the last fifth of the recording (Social Ways, Amirian et al."
    " 2019)",
    "timesplit-train": "the training part of timesplit, the first four fifths of the recording",
    "trajnet++": "the scenes of a TrajNet++ file; only their primary persons are scored (Kothari et al. 2021)",
}
LATE = {
    "skip": "people who appear during the observed part are excluded",
    "extrapolate": "they are extrapolated backwards with their first velocity, and not scored",
}

SHORTEST_FUTURE = 2
"""Minimum number of future rows of a scored person in protocol ``partial``."""
MAX_BYTES = 4 * 1024**3
"""Maximum memory of windows [bytes]."""


class NoWindowError(DataError):
    """A recording has no window of the protocol, for example because its tracks are too short."""


@dataclass(frozen=True)
class _Rows:
    """The rows of a recording by id, then frame, with their runs, and whether each is a robot."""

    runs: Runs
    id: Ints
    position: Floats
    robot: Bools

    @classmethod
    def of(cls, tracks: TrackTable, step: int | None) -> _Rows:
        found = runs(tracks.id, tracks.frame, step)
        id = tracks.id[found.order]
        return cls(found, id, tracks.position[found.order], np.isin(id, np.asarray(sorted(tracks.robots), np.int64)))


def cut_windows(
    tracks: TrackTable, observe: int, predict: int, protocol: str, near: float | None, late: str
) -> tuple[Windows, Windows]:
    """Return the past and the future of every window; see :meth:`Trajectories.windows`."""
    _check(tracks, observe, predict, protocol, near, late)
    exact = protocol.startswith("timesplit")
    rows = _Rows.of(tracks, tracks.frame_step if exact else None)
    need = min(SHORTEST_FUTURE, predict) if protocol == "partial" else predict
    scored = (rows.runs.behind >= observe) & (rows.runs.ahead >= need) & ~rows.robot
    if not np.any(scored):
        raise NoWindowError("; ".join([_why_none(tracks, rows, observe, need, protocol), *tracks.warnings]))
    if protocol == "trajnet++":
        scored = _primary(tracks, rows, scored, observe, predict)
    scored = _apply_protocol(tracks, rows, scored, protocol)
    if near is not None:
        scored = _near_robot(tracks, rows, scored, near)
    chosen = np.unique(rows.runs.instant[scored])
    return _fill_windows(tracks, rows, chosen, scored, observe, predict, protocol, late)


def cut_past(tracks: TrackTable, observe: int, frame: int | None, late: str) -> Windows:
    """Return one window of everyone at ``frame``; see :meth:`Trajectories.past`."""
    _check(tracks, observe, 1, "all", None, late)
    rows = _Rows.of(tracks, None)
    instant = len(rows.runs.frames) - 1
    if frame is not None:
        instant = int(np.searchsorted(rows.runs.frames, frame))
        if instant == len(rows.runs.frames) or rows.runs.frames[instant] != frame:
            raise DataError(f"{tracks.name} has no frame {frame}; they go from {tracks.frame[0]} to {tracks.frame[-1]}")
    here = rows.runs.instant == instant
    if instant + 1 < observe or not np.any(here & (rows.runs.behind >= _shortest(observe, late))):
        raise DataError(
            f"{tracks.name}: nobody at frame {rows.runs.frames[instant]} was seen for long enough; {observe} rows are"
            f" asked for, and the longest there has {rows.runs.behind[here].max()}"
        )
    chosen = np.asarray([instant])
    return _fill_windows(tracks, rows, chosen, np.zeros(len(here), np.bool_), observe, 1, "none", late)[0]


def _check(tracks: TrackTable, observe: int, predict: int, protocol: str, near: float | None, late: str) -> None:
    for name, value in (("observe", observe), ("predict", predict)):
        if not isinstance(value, int | np.integer) or value < 1:
            raise InputError(f"windows: {name} is {value!r}, it is a number of rows: a whole number of at least 1")
    for name, word, known in (("protocol", protocol, PROTOCOLS), ("late", late, LATE)):
        if word not in known:
            raise InputError(f"unknown {name} {word!r}{did_you_mean(str(word), known)}; known are {', '.join(known)}")
    if near is None:
        return
    if not near > 0.0:
        raise InputError(f"windows: near is {near} m, it must be above 0")
    if not tracks.robots:
        raise DataError(f"{tracks.name} has no robot, which near requires; use a recorded trial, or set robots")
    if tracks.units != "m":
        raise DataError(f"{tracks.name} is in pixels, but near is in metres; convert the recording to metres first")


def _apply_protocol(tracks: TrackTable, rows: _Rows, scored: Bools, protocol: str) -> Bools:
    """Return who is scored in the windows that the protocol selects."""
    instants = rows.runs.instant
    if protocol == "sgan":
        crowd = np.bincount(instants[scored], minlength=len(rows.runs.frames))
        scored = scored & (crowd[instants] >= 2)
        why = "no window has two people who are present at all rows; protocol sgan requires two, protocol all one"
    elif protocol.startswith("timesplit"):
        every = np.unique(instants[scored])
        border = len(every) * 4 // 5
        late = instants >= every[border]
        scored = scored & (late if protocol == "timesplit" else ~late)
        why = "it has a single window, which belongs to the last fifth; no window is left for training"
    else:
        return scored
    if not np.any(scored):
        raise NoWindowError(f"{tracks.name}: {why}")
    return scored


def _primary(tracks: TrackTable, rows: _Rows, scored: Bools, observe: int, predict: int) -> Bools:
    """Return who is scored and is the primary person of a scene with these rows."""
    if not tracks.scenes:
        raise DataError(f"{tracks.name} has no scenes with a primary person, as TrajNet++ files have")
    known = {(scene.person, scene.first, scene.last) for scene in tracks.scenes}
    frames = rows.runs.frames
    primary = np.zeros_like(scored)
    place = np.flatnonzero(scored)
    at = rows.runs.instant[place]
    first, last = frames[at - observe + 1], frames[at + predict]
    whole = zip(rows.id[place].tolist(), first.tolist(), last.tolist(), strict=True)
    primary[place] = [person in known for person in whole]
    if not np.any(primary):
        raise NoWindowError(
            f"{tracks.name}: no scene has {observe} + {predict} rows of its primary person;"
            " the scenes of TrajNet++ have 9 + 12"
        )
    return primary


def _near_robot(tracks: TrackTable, rows: _Rows, scored: Bools, near: float) -> Bools:
    """Return who is scored and within ``near`` [m] of a robot at the last observed step."""
    distance = np.full(len(rows.id), np.inf)
    for robot in sorted(tracks.robots):
        place = np.full((len(rows.runs.frames), 2), np.nan)
        own = rows.id == robot
        place[rows.runs.instant[own]] = rows.position[own]
        away = rows.position - place[rows.runs.instant]
        distance = np.fmin(distance, np.hypot(away[:, 0], away[:, 1]))
    close = scored & (distance <= near)
    if not np.any(close):
        nearest = distance[scored].min()
        how = f"the nearest is {nearest:.2f} m away" if np.isfinite(nearest) else "no robot is present at these times"
        raise NoWindowError(f"{tracks.name}: no scored person comes within {near} m of a robot; {how}")
    return close


def _shortest(observe: int, late: str) -> int:
    return observe if late == "skip" else min(2, observe)


def _fill_windows(
    tracks: TrackTable,
    rows: _Rows,
    chosen: Ints,
    scored: Bools,
    observe: int,
    predict: int,
    protocol: str,
    late: str,
) -> tuple[Windows, Windows]:
    """Return past and future at the ``chosen`` instants [W], people in slots by id."""
    instant = rows.runs.instant
    members = np.flatnonzero((rows.runs.behind >= _shortest(observe, late)) & np.isin(instant, chosen))
    members = members[np.argsort(instant[members], kind="stable")]
    window = np.searchsorted(chosen, instant[members])
    slot = np.arange(len(members)) - np.searchsorted(window, window)
    shape = len(chosen), int(slot.max()) + 1
    _check_size(tracks.name, shape, observe, predict)

    def place(values: NDArray[Any], empty: int = 0) -> NDArray[Any]:
        table = np.full(shape, empty, dtype=values.dtype)
        table[window, slot] = values[members]
        return table

    frames = _frames(tracks, rows, chosen, observe, predict, protocol)
    counted = place(scored)
    common: dict[str, Any] = {
        "robot": place(rows.robot),
        "id": place(rows.id, -1),
        "dt": tracks.dt,
        "protocol": protocol,
        "source": tracks.name,
        "walls": tracks.walls,
        "units": tracks.units,
    }
    before = _part(rows, members, window, slot, range(1 - observe, 1), shape)
    after = _part(rows, members, window, slot, range(1, predict + 1), shape)
    past = Windows(*before, scored=np.zeros_like(counted), frame=frames[:, :observe], **common)
    return past, Windows(*after, scored=counted, frame=frames[:, observe:], **common)


def _check_size(name: str, shape: tuple[int, int], observe: int, predict: int) -> None:
    size = shape[0] * shape[1] * (observe + predict) * 17
    if size > MAX_BYTES:
        raise DataError(
            f"{name}: {shape[0]} windows of {observe} + {predict} rows and up to {shape[1]} people would take"
            f" {size / 1024**3:.1f} GiB; resample to longer steps or split the recording"
        )


def _part(
    rows: _Rows,
    members: NDArray[np.intp],
    window: NDArray[np.intp],
    slot: NDArray[np.intp],
    offsets: range,
    shape: tuple[int, int],
) -> tuple[Floats, Bools]:
    """Return position [W, T, A, 2] and present [W, T, A] at offsets from the last observed row."""
    position = np.zeros((shape[0], len(offsets), shape[1], 2))
    present = np.zeros(position.shape[:3], np.bool_)
    for step, offset in enumerate(offsets):
        there, place = _positions(rows, members, offset)
        position[window[there], step, slot[there]] = place
        present[window[there], step, slot[there]] = True
    return position, present


def _positions(rows: _Rows, members: NDArray[np.intp], offset: int) -> tuple[Bools, Floats]:
    """Return which members have a position ``offset`` rows after the last observed row, and the positions [n, 2].

    Observed rows before the start of a run are extrapolated backwards with its first velocity.
    """
    if offset > 0:
        there = rows.runs.ahead[members] >= offset
        return there, rows.position[members[there] + offset]
    behind = rows.runs.behind[members]
    too_early = np.maximum(-offset - (behind - 1), 0)
    place = rows.position[members + offset + too_early]
    begin = members - behind + 1
    late = too_early > 0
    velocity = rows.position[begin[late] + 1] - rows.position[begin[late]]
    place[late] -= velocity * too_early[late, None]
    return np.ones(len(members), np.bool_), place


def _frames(tracks: TrackTable, rows: _Rows, chosen: Ints, observe: int, predict: int, protocol: str) -> Ints:
    """Return the frames [W, observe + predict]; they continue after the end of the file."""
    offsets = np.arange(1 - observe, predict + 1)
    frames, step = rows.runs.frames, tracks.frame_step
    if protocol.startswith("timesplit"):
        return np.asarray(frames[chosen][:, None] + offsets * step)
    index = chosen[:, None] + offsets
    beyond = np.maximum(index - (len(frames) - 1), 0)
    return np.asarray(frames[np.minimum(index, len(frames) - 1)] + beyond * step)


def _why_none(tracks: TrackTable, rows: _Rows, observe: int, need: int, protocol: str) -> str:
    """Return the reason why no person can be scored, with the lengths of the tracks."""
    people = ~rows.robot
    if not np.any(people):
        return f"{tracks.name} contains only robots, no people to predict"
    longest = int(rows.runs.behind[people].max())
    lengths = np.unique(rows.id[people], return_counts=True)[1]
    crowd = np.unique(rows.runs.instant, return_counts=True)[1]
    holes = f" without gaps ({int(lengths.max())} with gaps)" if lengths.max() > longest else ""
    future = f"at least {need}" if protocol == "partial" else str(need)
    return (
        f"{tracks.name}: no window of {observe} observed and {future} predicted rows was found (protocol {protocol}),"
        f" because the longest of {len(lengths)} tracks has {longest} rows{holes} and {observe + need} are needed;"
        f" a row is {tracks.frame_step} frame{'s' if tracks.frame_step != 1 else ''} or {tracks.dt:.4g} s,"
        f" {len(rows.runs.frames)} frames hold {crowd.min()} to {crowd.max()} tracks each;"
        " ask for fewer rows, or resample to shorter steps"
    )
