"""Output of crowd simulators: Vadere ``.traj`` and Viswalk ``.pp``.

* Vadere: a line of names, separated by blanks, such as ``pedestrianId simTime endTime-PID1 startX-PID1 startY-PID1
  endX-PID1 endY-PID1 targetId-PID2``; a row is a footstep of a person, at times of its own. The endings of names are
  numbers of processors. Older files have ``timeStep pedestrianId x-PID1 y-PID1``.
* Viswalk: ``$VISION``, comments with ``*``, then ``$PEDESTRIAN:SIMSEC;NO;COORDCENTX;COORDCENTY`` and rows.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.source import MAX_ROWS, Source
from crowdbot.data.trajectories import Trajectories
from crowdbot.typing import Floats

from .assemble import assemble
from .clock import regular_rows
from .reader import Reader, ReadOptions

STEP = 0.4
"""Time step of tracks from footsteps [s], that of Vadere unless a scenario changes it."""
TOLERANCE = 1e-6
PROCESSOR = re.compile(r"-PID\d+$")
FOOTSTEP = ("pedestrianId", "simTime", "endTime", "startX", "startY", "endX", "endY")
TIME_STEP = ("timeStep", "pedestrianId", "x", "y")
MARK = "$PEDESTRIAN:"
VISWALK_COLUMNS = ("NO", "SIMSEC", "COORDCENTX", "COORDCENTY")


def _vadere_names(source: Source) -> list[str]:
    """Return the names of the columns without the numbers of processors; none if the file is of another kind."""
    line = next((line for line in source.lines[:5] if not line.startswith("#")), "")
    names = [PROCESSOR.sub("", name) for name in line.split()]
    return names if "pedestrianId" in names and {"simTime", "timeStep"} & set(names) else []


def sniff_vadere(source: Source) -> bool:
    """Return whether the line of names has pedestrianId, and simTime or timeStep."""
    return bool(_vadere_names(source))


def read_vadere(source: Source, options: ReadOptions) -> Trajectories:
    """Read positions; footsteps are interpolated at regular times."""
    names = _vadere_names(source)
    needed = TIME_STEP if "timeStep" in names else FOOTSTEP
    if missing := [name for name in needed if name not in names]:
        held = ", ".join(names) or "no line of names"
        raise DataError(f"{source.name} lacks the columns {', '.join(missing)} of Vadere; it has {held}")
    if wrong := [name for name in needed if names.count(name) > 1]:
        raise DataError(f"{source.name} has several columns {wrong[0]}")
    text = source.text()
    begin = next(k for k, line in enumerate(text.splitlines(keepends=True)) if "pedestrianId" in line)
    lines = text.splitlines()
    lines[begin] = ""
    values, line = source.table(len(names), "\n".join(lines))
    if len(values) == 0:
        raise DataError(f"{source.name} has no rows")
    column = {name: values[:, names.index(name)] for name in needed}
    if needed is TIME_STEP:
        return assemble(
            source, options, id=column["pedestrianId"], frame=column["timeStep"], x=column["x"], y=column["y"],
            row_rate=1.0 / STEP, line=line, note=f"a step of {STEP} s is assumed, as in Vadere; fps overrides this",
        )  # fmt: skip
    rate = options.fps or 1.0 / STEP
    id, frame, x, y = _at_regular_times(source.name, column, line, 1.0 / rate)
    note = f"footsteps are interpolated at a step of {1.0 / rate:.4g} s" + (
        "" if options.fps else "; fps overrides this"
    )
    return assemble(source, options, id=id, frame=frame, x=x, y=y, fps=rate, frame_step=1, note=note)


def _at_regular_times(
    name: str, column: dict[str, Floats], line: NDArray[np.int64], dt: float
) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats, Floats]:
    """Return id, frame, x and y of persons at multiples of a step, between the begins and ends of their footsteps."""
    begin, end = column["simTime"], column["endTime"]
    bad = ~(np.isfinite(begin) & np.isfinite(end) & (end >= begin))
    if np.any(bad):
        row = int(np.argmax(bad))
        raise DataError(f"{name} line {line[row]}: the footstep ends at {end[row]:g} s, it begins at {begin[row]:g} s")
    order = np.lexsort((begin, column["pedestrianId"]))
    borders = np.flatnonzero(np.diff(column["pedestrianId"][order])) + 1
    groups = np.split(order, borders)
    spans = [(np.ceil(begin[g[0]] / dt - TOLERANCE), np.floor(end[g].max() / dt + TOLERANCE)) for g in groups]
    count = sum(max(0.0, last - first + 1) for first, last in spans)
    if count > MAX_ROWS:
        raise DataError(f"{name} has {count:.3g} rows at a step of {dt:g} s, more than the limit of {MAX_ROWS}")
    parts = []
    for group, (first, last) in zip(groups, spans, strict=True):
        frame = np.arange(first, last + 1, dtype=np.int64)
        times = np.stack([begin[group], end[group]], axis=1).ravel()
        places = [
            np.stack([column[f"start{axis}"][group], column[f"end{axis}"][group]], axis=1).ravel() for axis in "XY"
        ]
        sort = np.argsort(times, kind="stable")
        x, y = (np.interp(frame * dt, times[sort], place[sort]) for place in places)
        parts.append((np.full(len(frame), column["pedestrianId"][group[0]]), frame, x, y))
    id, frame, xs, ys = (np.concatenate(part) for part in zip(*parts, strict=True))
    if len(id) == 0:
        raise DataError(f"{name}: no footstep lasts over a multiple of {dt:g} s; give a higher fps")
    return id.astype(np.int64), frame.astype(np.int64), xs, ys


def sniff_viswalk(source: Source) -> bool:
    """Return whether a line among the first names the columns of pedestrians."""
    return any(line.lstrip("\ufeff ").startswith(MARK) for line in source.lines[:200])


def read_viswalk(source: Source, options: ReadOptions) -> Trajectories:
    """Read the centers of pedestrians; other tables of the file are skipped."""
    names: list[str] = []
    rows, lines = list[list[float]](), list[int]()
    for number, text in enumerate(source.text().splitlines(), 1):
        if text.startswith("$"):
            if names and rows:
                break
            names = text.strip()[len(MARK) :].split(";") if text.startswith(MARK) else []
            if names and (missing := [name for name in VISWALK_COLUMNS if name not in names]):
                raise DataError(f"{source.name} line {number} lacks the columns {', '.join(missing)}")
        elif names and text.strip() and not text.startswith("*"):
            words = text.strip().split(";")
            if len(words) != len(names):
                raise DataError(f"{source.name} line {number} has {len(words)} columns, the line of names {len(names)}")
            try:
                rows.append([float(words[names.index(name)]) for name in VISWALK_COLUMNS])
            except ValueError:
                raise DataError(f"{source.name} line {number}: {', '.join(VISWALK_COLUMNS)} must be numbers") from None
            lines.append(number)
    if not rows:
        raise DataError(f"{source.name} has no rows after {MARK}")
    values, line = np.asarray(rows, dtype=np.float64), np.asarray(lines, dtype=np.int64)
    if not np.all(
        np.isfinite(values[:, 0]) & (np.abs(values[:, 0]) < 2.0**53) & (values[:, 0] == np.rint(values[:, 0]))
    ):
        raise DataError(f"{source.name}: NO must be whole numbers")
    id, time, x, y = values.T
    kept = regular_rows(id.astype(np.int64), time, x, y, options.fps, source.name, line)
    return assemble(source, options, id=kept.id, frame=kept.frame, x=kept.x, y=kept.y, fps=kept.fps, note=kept.note,
                    clock_origin=kept.origin)  # fmt: skip


VADERE = Reader("vadere", "Vadere .traj: footsteps, or positions by time step", sniff_vadere, read_vadere)
VISWALK = Reader("viswalk", "Viswalk .pp: rows after $PEDESTRIAN:", sniff_viswalk, read_viswalk)
