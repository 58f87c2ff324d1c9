"""Plausibility of a recording: whether the speeds, times and places in a file can be those of people.

Nothing is converted here: a wrong guess would be silent. Each warning in the note of the tracks says which number is
odd, and which option corrects it.
"""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.trajectories import Trajectories
from crowdbot.typing import Floats

from .columns import LONGITUDE
from .reader import ReadOptions
from .time_base import RowRateError

LONG_ROW, LONGEST_ROW = 1.0, 2.0
"""Time step [s] above which the speed decides whether ``fps`` is a row rate, and above which it always is one."""
MIN_ROW_RATE, MAX_ROW_RATE = 0.5, 15.0
"""Range of row rates of recordings of people [1/s]; another ``fps`` is not taken for one."""
SLOWEST, FASTEST = 0.02, 5.0
"""Range of the median speed of people [m/s]."""
SPEED_TIME = 0.4
"""Time over which speeds are measured in recordings with shorter steps [s]."""
MOVING, SLOW_WALK, FAST_WALK = 0.2, 0.3, 2.5
"""Speed above which people move, and range of the median speed of those who do [m/s]."""
LONG_STAMPS = 60.0
"""Time between rows [s] above which time stamps are not in seconds, whatever the speeds are."""
STAMP_UNITS = (("ms", "milliseconds", 1e3), ("us", "microseconds", 1e6), ("ns", "nanoseconds", 1e9))
"""Units of time stamps, per second."""
TRACKER_STEPS = (1e-3, 10.0)
"""Shortest and longest plausible time between rows [s]."""
WALKED = 1.0
"""Shortest way [m] of somebody in a recording whose slow speeds are judged: people who stand are slow, too."""
WIDEST_DEGREES = 0.1
"""Largest extent of places or areas in degrees: 11 km, and as metres too small for one person."""
METRES_PER_DEGREE = 111_195.0
POLE = 90.0
"""Largest latitude [degrees]."""
UNEVEN = 0.2
"""Logarithm of the ratio of speeds to the east and to the north by which one order of coordinates is more even."""
SMALLER_UNITS = (("cm", 100.0), ("mm", 1000.0))
HEAD_RANGE = 0.6
"""Largest range [m] of the heights of heads, 5 to 95 %: adults differ by 0.3 m, children and adults by 0.5 m."""
LINE = 0.01
"""Extent [m] below which a coordinate is constant."""
OVERLAP, OVERLAP_SHARE = 0.2, 0.02
"""Distance [m] at which bodies overlap, and the share of rows above which people seem to walk through each other."""


ENOUGH = 100
"""Smallest number of steps of tracks that decides whether two columns are exchanged."""
SMOOTHER = 5.0
"""Columns are probably exchanged if steps are this much shorter the other way."""
JUMP, FASTER = 0.5, 3.0
"""Length [m] of a step that is impossible, if it is also faster than ``FASTEST`` and this many times as fast as nearly
all other steps."""
FEW = 0.02
"""Largest share of impossible steps that are jumps of single people, instead of a wrong unit or frame rate."""
LONG_PAUSE = 86_400.0
"""Time without anybody [s] after which a time stamp is probably wrong: a day."""


class FileColumns(NamedTuple):
    """What a reader knows of the columns of a file.

    Fields:
        time: name of the time column that gives the time step; empty if frames and a frame rate do.
        height: name of the third coordinate; empty if there is none.
        heights: ``[N]`` values of the third coordinate, in the units of x and y.
        x, y: names of the coordinates, if the user can choose the columns by name.
        origin: x and y [degrees] of the origin if places were converted from degrees.
    """

    time: str = ""
    height: str = ""
    heights: NDArray[np.float64] | None = None
    x: str = ""
    y: str = ""
    origin: tuple[float, float] | None = None

    @property
    def exchange(self) -> str:
        """What to do if x and y are exchanged."""
        named = self.x and self.x.strip().lower() not in LONGITUDE
        return f"give --columns x={self.y} y={self.x}" if named else "write a table with x and y exchanged"


def check_walkers(tracks: Trajectories, options: ReadOptions, columns: FileColumns | None = None) -> Trajectories:
    """Return the tracks, with warnings in their note if their speeds, times or places are not those of people.

    Raises:
        RowRateError: ``options.fps`` is 0.5 to 15 and makes the time step longer than 2 s, or longer than 1 s at a
            speed that is impossible, but possible with the same number as rows per second.
        DataError: ``options.fps`` is given and the time stamps are not in seconds.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # coordinates may be as large as numbers get
        return _check(tracks, options, columns or FileColumns())


def _check(tracks: Trajectories, options: ReadOptions, columns: FileColumns) -> Trajectories:
    stamps = _stamp_warning(tracks, columns)
    speed = _median_speed(tracks)
    fps, step = options.fps, tracks.frame_step
    if fps is not None and step > 1:
        slow = tracks.dt > LONG_ROW and _impossible(speed) and not _impossible(speed * step)
        if MIN_ROW_RATE <= fps <= MAX_ROW_RATE and (tracks.dt > LONGEST_ROW or slow):
            if stamps:
                raise DataError(f"{tracks.name}: {stamps}")
            moved = "" if math.isnan(speed) else f" and the median speed {speed:.2g} m/s"
            raise RowRateError(
                f"{tracks.name}: fps {fps:g} makes the time step {tracks.dt:.4g} s ({step} frames per row){moved};"
                f" fps is frames per second, for {fps:g} rows per second give fps {fps * step:g}",
                fps * step,
            )
    odd = stamps or _degree_warning(tracks, options, columns) or _speed_warning(tracks, options, speed)
    steps = ("", "") if odd else (_jump_warning(tracks), _pause_warning(tracks))
    sentences = (odd, _order_warning(tracks, options, columns), _height_warning(tracks, columns), *steps)
    warnings = [f"warning: {sentence}" for sentence in sentences if sentence]
    new = [warning for warning in warnings if warning not in tracks.note]
    return dataclasses.replace(tracks, note="; ".join(filter(None, (tracks.note, *new)))) if new else tracks


def _stamp_warning(tracks: Trajectories, columns: FileColumns) -> str:
    """Return a warning if the times of a file are probably not in seconds, else an empty text."""
    dt = tracks.dt
    if not columns.time or dt < 1.0:
        return ""
    speed = _speeds(tracks)
    fast = float(np.percentile(speed, 90)) if len(speed) else math.nan
    fits = [unit for unit in STAMP_UNITS if TRACKER_STEPS[0] <= dt / unit[2] <= TRACKER_STEPS[1]]
    walks = [unit for unit in fits if SLOW_WALK <= fast * unit[2] <= FASTEST]
    if dt <= LONG_STAMPS and not (walks and fast < SLOWEST and _longest_way(tracks) > WALKED):
        return ""
    short, unit, _ = next(iter(walks or fits), STAMP_UNITS[-1])
    moved = "" if math.isnan(fast) else f" and 90 % of the speeds are below {fast:.2g} m/s"
    return (
        f"the times in {columns.time} are {dt:.4g} s apart{moved}: they are probably in {unit},"
        f" give --columns time_{short}={columns.time}"
    )


def _degree_warning(tracks: Trajectories, options: ReadOptions, columns: FileColumns) -> str:
    """Return a warning if places are probably degrees of longitude and latitude, in any order, else an empty text."""
    x, y = tracks.x, tracks.y
    extent = max(float(np.ptp(x)), float(np.ptp(y)))
    if tracks.units != "m" or options.units is not None or not 0.0 < extent < WIDEST_DEGREES:
        return ""
    farthest = sorted((float(np.max(np.abs(x))), float(np.max(np.abs(y)))))
    if farthest[0] > POLE or farthest[1] > 2.0 * POLE:
        return ""
    speed = _speeds(tracks)
    fast = float(np.percentile(speed, 90)) if len(speed) else 0.0
    walks = SLOW_WALK <= fast * METRES_PER_DEGREE <= FASTEST
    if not walks or _longest_way(tracks) * METRES_PER_DEGREE < WALKED:
        return ""
    latitude_first: bool | None = float(np.max(np.abs(y))) > POLE
    if farthest[1] <= POLE:
        latitude_first = _is_latitude_first(METRES_PER_DEGREE * _velocities(tracks), _median(x), _median(y))
    order = "latitude (x) and longitude (y)" if latitude_first else "longitude (x) and latitude (y)"
    remedy = ", give --units deg"
    if latitude_first:
        remedy += f", and {columns.exchange}"
    elif latitude_first is None:
        remedy += f", and if x, {np.median(x):.6g}, is the latitude, also {columns.exchange}"
    return (
        f"all places are within {extent:.2g} m and 90 % of the speeds are below {fast:.2g} m/s: they are probably"
        f" degrees of {order}{remedy}"
    )


def _order_warning(tracks: Trajectories, options: ReadOptions, columns: FileColumns) -> str:
    """Return a warning if degrees that were converted are perhaps in the other order, else an empty text."""
    if columns.origin is None or max(map(abs, columns.origin)) > POLE or columns.x.strip().lower() in LONGITUDE:
        return ""
    x, y = columns.origin
    cos_x, cos_y = (max(1e-6, math.cos(math.radians(angle))) for angle in (x, y))
    latitude_first = _is_latitude_first(_velocities(tracks) / (cos_y, 1.0), x, y)
    east, north = float(np.ptp(tracks.x)), float(np.ptp(tracks.y))
    other = north * cos_x, east / cos_y
    extents = f"{east:.3g} m to the east and {north:.3g} m to the north as read, {other[0]:.3g} m and {other[1]:.3g} m"
    if latitude_first:
        return (
            f"places extend {extents} exchanged, and only exchanged people walk as fast to the east as to the north:"
            f" the degrees are probably of latitude (x) and longitude (y), {columns.exchange}"
        )
    given = options.columns is not None and "x" in options.columns
    if latitude_first is None and not given and abs(math.log(cos_x * cos_y)) > UNEVEN:
        keep = f", if not, give --columns x={columns.x} y={columns.y}" if columns.x else ""
        return (
            f"places extend {extents} if x, {x:.6g}, is the latitude, which the speeds do not decide: if it is,"
            f" {columns.exchange}{keep}"
        )
    return ""


def _is_latitude_first(velocities: Floats, x: float, y: float) -> bool | None:
    """Return whether x is the latitude; None if the speeds do not decide.

    A degree of longitude is shorter than one of latitude, so people who walk to the east are faster in degrees.

    Args:
        velocities: ``[N, 2]`` along x and y, degrees of both with the length of one of latitude [m/s].
        x, y: place [degrees].
    """
    east, north = np.abs(velocities.T)
    moves = np.hypot(east, north) > MOVING
    along = east[moves & (east > 2.0 * north)], north[moves & (north > 2.0 * east)]
    if min(map(len, along)) < ENOUGH:
        return None
    ratio = math.log(float(np.median(along[0]) / np.median(along[1])))
    cos_x, cos_y = (max(1e-6, math.cos(math.radians(angle))) for angle in (x, y))
    given, exchanged = abs(ratio + math.log(cos_y)), abs(ratio - math.log(cos_x))
    return exchanged < given if abs(exchanged - given) > UNEVEN else None


def _median(values: Floats) -> float:
    return float(np.median(values))


def _height_warning(tracks: Trajectories, columns: FileColumns) -> str:
    """Return a warning if x or y is probably the height of heads, else an empty text."""
    if tracks.units != "m":
        return ""
    place = {"y": tracks.y, "x": tracks.x}
    spread = {name: _spread(values) for name, values in place.items()}
    varied = 0.0 if columns.heights is None else _spread(columns.heights)
    remedy = f"give --columns y={columns.height or 'NAME'}" if columns.x else "write a CSV and give --columns"
    for name, values in place.items():
        if spread[name] < HEAD_RANGE and varied > max(1.0, 4.0 * spread[name]):
            return (
                f"{name} stays within {spread[name]:.2g} m at {np.median(values):.3g} m while {columns.height} varies"
                f" by {varied:.3g} m: {name} is probably the height, {remedy.replace('y=', name + '=')}"
            )
    flat = next((name for name, values in place.items() if float(np.ptp(values)) < LINE), "")
    if not flat or max(spread.values()) < 1.0:
        return ""
    share = _overlap_share(tracks)
    if share < OVERLAP_SHARE:
        return ""
    return (
        f"{flat} is constant at {np.median(place[flat]):.3g} m, and {100.0 * share:.2g} % of the positions are within"
        f" {OVERLAP} m of somebody: {flat} is perhaps the height, {remedy.replace('y=', flat + '=')}"
    )


def _spread(values: NDArray[np.float64]) -> float:
    """Return the range of 5 to 95 % of the values."""
    finite = values[np.isfinite(values)]
    return float(np.ptp(np.percentile(finite, [5, 95]))) if len(finite) else 0.0


def _longest_way(tracks: Trajectories) -> float:
    """Return the largest extent of a track along x or y, in the units of the tracks."""
    order = np.argsort(tracks.id, kind="stable")
    begins = np.flatnonzero(np.diff(tracks.id[order], prepend=tracks.id[order[0]] - 1))
    place = tracks.position[order]
    return float(np.max(np.maximum.reduceat(place, begins) - np.minimum.reduceat(place, begins)))


def _overlap_share(tracks: Trajectories) -> float:
    """Return the share of positions that have another one of the same frame within ``OVERLAP`` along x and y."""
    order = np.lexsort((tracks.y, tracks.x, tracks.frame))
    near = (np.diff(tracks.frame[order]) == 0) & np.all(np.abs(np.diff(tracks.position[order], axis=0)) < OVERLAP, 1)
    return float(np.mean(np.append(near, False) | np.insert(near, 0, False)))


def _speed_warning(tracks: Trajectories, options: ReadOptions, speed: float) -> str:
    """Return a warning if people are too fast or too slow, else an empty text."""
    given = options.fps is not None or options.units is not None
    if not (speed > FASTEST or (given and speed < SLOWEST)):
        return _crowded_warning(tracks, options) or _walking_warning(tracks)
    smaller = () if options.units is not None else SMALLER_UNITS
    fits = next((unit for unit, per in smaller if SLOW_WALK < speed / per < FAST_WALK), "")
    hint = f" (with --units {fits} it is {speed / dict(SMALLER_UNITS)[fits]:.2g} m/s)" if fits else ""
    if speed > FASTEST and options.units is None:
        hint += ", or give --scale or --homography if the places are pixels"
    return f"the median speed {speed:.2g} m/s is impossible for people: check the frame rate (fps) and the units{hint}"


def _crowded_warning(tracks: Trajectories, options: ReadOptions) -> str:
    """Return a warning if bodies would be inside each other, as in kilometres that are read as metres."""
    if tracks.units != "m" or options.units is not None or len(tracks) < ENOUGH:
        return ""
    extent = float(max(np.ptp(tracks.x), np.ptp(tracks.y)))
    if not 0.0 < extent < OVERLAP or len(np.unique(tracks.id[tracks.frame == tracks.frame[0]])) < 2:
        return ""
    return f"all people are within {extent:.2g} m at all times: the places are probably in kilometres, give --units km"


def _jump_warning(tracks: Trajectories) -> str:
    """Return a warning if single steps of people are impossible, as where a tracker exchanges two people."""
    if tracks.units != "m":
        return ""
    others = np.asarray(sorted(tracks.robots | tracks.other_agents.keys()), dtype=np.int64)
    velocity = tracks.velocities()
    speed = np.hypot(velocity[:, 0], velocity[:, 1])
    speed[np.isin(tracks.id, others)] = np.nan
    known = speed[np.isfinite(speed)]
    if len(known) < ENOUGH:
        return ""
    limit = max(FASTEST, FASTER * float(np.percentile(known, 90)))
    jumps = np.flatnonzero((speed > limit) & (speed * tracks.dt > JUMP))
    if not len(jumps) or len(jumps) > max(2.0, FEW * len(known)):
        return ""
    first = jumps[0]
    people = np.unique(tracks.id[jumps[tracks.frame[jumps] == tracks.frame[first]]])
    who = " and ".join(map(str, people[:2].tolist()))
    why = f"the ids {who} are perhaps exchanged there" if len(people) > 1 else "the track is perhaps of two people"
    count = f"{len(jumps)} steps are" if len(jumps) > 1 else "a step is"
    return (
        f"{count} impossible for people: person {tracks.id[first]} moves at {speed[first]:.2g} m/s at frame"
        f" {tracks.frame[first]}, {why}, give each part an id of its own"
    )


def _pause_warning(tracks: Trajectories) -> str:
    """Return a warning if the recording is interrupted for more than a day."""
    frames = np.unique(tracks.frame)
    if len(frames) < 2:
        return ""
    gaps = np.diff(frames) / tracks.frame_step * tracks.dt
    longest = int(np.argmax(gaps))
    if gaps[longest] <= LONG_PAUSE:
        return ""
    last = (frames[longest] - frames[0]) / tracks.frame_step * tracks.dt
    return (
        f"nobody is there for {gaps[longest]:.3g} s after {last:.4g} s: a time stamp or a frame is probably wrong,"
        " remove its rows"
    )


def exchange_warning(id: Floats, frame: Floats, place: Floats, sentence: str) -> str:
    """Return a sentence if tracks are much smoother with ids and frames exchanged, else an empty text.

    Args:
        id, frame: columns ``[N]`` as they are read.
        place: positions ``[N, 2]``.
        sentence: what is wrong and how it is corrected.
    """
    given, exchanged = _usual_step(id, frame, place), _usual_step(frame, id, place)
    return sentence if given is not None and exchanged is not None and given > SMOOTHER * exchanged else ""


def _usual_step(id: Floats, frame: Floats, place: Floats) -> float | None:
    """Return the median distance between consecutive rows of a track; None with too few rows."""
    order = np.lexsort((frame, id))
    same = np.diff(id[order]) == 0
    if np.sum(same) < ENOUGH:
        return None
    away = np.diff(place[order], axis=0)[same]
    return float(np.median(np.hypot(away[:, 0], away[:, 1])))


def _walking_warning(tracks: Trajectories) -> str:
    """Return a warning if the people who move do not walk, else an empty text."""
    speed = _speeds(tracks)
    moving = speed[speed > MOVING]
    usual = float(np.median(moving)) if len(moving) > 0.1 * len(speed) else math.nan
    if SLOW_WALK <= usual <= FAST_WALK or math.isnan(usual):
        return ""
    return (
        f"people who move have a median speed of {usual:.2g} m/s, people who walk {SLOW_WALK:g} to"
        f" {FAST_WALK:g} m/s, check fps and units"
    )


def _median_speed(tracks: Trajectories) -> float:
    """Return the median speed of people [m/s]; NaN if no one has two rows, or the units are pixels."""
    known = _speeds(tracks)
    return float(np.median(known)) if len(known) else math.nan


def _speeds(tracks: Trajectories) -> NDArray[np.float64]:
    """Return the speeds of people [m/s]; none if the units are pixels."""
    velocity = _velocities(tracks)
    return np.asarray(np.hypot(velocity[:, 0], velocity[:, 1]))


def _velocities(tracks: Trajectories) -> NDArray[np.float64]:
    """Return velocities ``[N, 2]`` of people [m/s]; none if the units are pixels.

    Rows of a video are compared with those about 0.4 s before: boxes of whole pixels stand still from frame to frame.
    """
    if tracks.units != "m":
        return np.empty((0, 2))
    others = sorted(tracks.robots | tracks.other_agents.keys())
    people = ~np.isin(tracks.id, np.asarray(others, dtype=np.int64))
    apart = _velocities_over(tracks, people, round(SPEED_TIME / tracks.dt))
    if len(apart):
        return apart
    velocity = tracks.velocities()[people]
    return np.asarray(velocity[~np.any(np.isnan(velocity), axis=1)])


def _velocities_over(tracks: Trajectories, people: NDArray[np.bool_], rows: int) -> NDArray[np.float64]:
    """Return velocities ``[N, 2]`` between rows of a track that are this many rows apart [m/s]; none below 2 rows."""
    if rows < 2:
        return np.empty((0, 2))
    order = np.lexsort((tracks.frame[people], tracks.id[people]))
    id, frame = tracks.id[people][order], tracks.frame[people][order]
    place = tracks.position[people][order]
    whole = (id[rows:] == id[:-rows]) & (frame[rows:] - frame[:-rows] == rows * tracks.frame_step)
    return np.asarray((place[rows:] - place[:-rows])[whole] / (rows * tracks.dt))


def _impossible(speed: float) -> bool:
    return speed < SLOWEST or speed > FASTEST
