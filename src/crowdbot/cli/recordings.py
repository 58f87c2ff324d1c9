"""Options for recordings, shared by several commands. Options state whether they count rows, frames or seconds."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .output import note

if TYPE_CHECKING:
    from crowdbot.data import Recording, Trajectories

    from .parser import CommandParser, Options


WINDOW_OPTIONS = ("step", "observe", "predict", "protocol", "near", "late", "learn", "every")
"""Options that are fields of :class:`crowdbot.data.Recording` of the same name."""
PER_FILE = (
    "; 10 frames per row at 25 Hz are 0.4 s. PART=FRAMES is for files with PART in their path; repeatable, the last"
    " that fits counts"
)


def add_recordings(parser: CommandParser, required: bool = True) -> None:
    """Add the options for files, their time base and their windows."""
    group = parser.add_argument_group("recordings")
    add = group.add_argument
    add("--data", nargs="+", type=Path, required=required, metavar="PATH", help="recordings")
    add("--observe", type=int, default=8, metavar="ROWS", help="observed rows of a window (default: 8)")
    add("--predict", type=int, default=12, metavar="ROWS", help="predicted rows of a window (default: 12)")
    add(
        "--protocol",
        default="all",
        metavar="NAME",
        help="protocol, see `crowdbot list protocols` (default: all)",
    )
    add("--step", type=float, metavar="SECONDS", help="time step after resampling (default: from the file)")
    group = parser.add_rare_group("reading of recordings")
    add_file_options(group)
    add = group.add_argument
    _add_stage(group)
    add(
        "--near",
        type=float,
        metavar="METRES",
        help="maximum distance of scored people from a recorded robot (default: none)",
    )
    add(
        "--late",
        default="skip",
        metavar="NAME",
        help="people who appear during the observation: skip or extrapolate (default: skip)",
    )
    add(
        "--learn", type=float, default=0.0, metavar="SHARE",
        help="initial share of each recording for learning goals; only the rest is predicted (default: 0)",
    )  # fmt: skip
    add("--every", type=int, default=1, metavar="N", help="use every N-th window of each recording (default: 1)")


def _add_stage(parser: Options) -> None:
    parser.add_argument(
        "--stage",
        metavar="FILE",
        help="walls and exits of the place in metres: a trial, a stage of an experiment such as hermes-corridor-180, a"
        " ROS map (.yaml), or an area (.wkt, .geojson)",
    )


def add_file_options(parser: Options, agents: str = "pedestrians") -> None:
    """Add the options for the content of a file, see :data:`crowdbot.data.FILE_OPTIONS`.

    Frame rate, units and scale may differ between the files of a command, see :func:`value_for`.

    Args:
        parser: parser of the command.
        agents: default of ``--agents``.
    """
    from crowdbot.data import FILE_OPTIONS

    for name, option in FILE_OPTIONS.items():
        text = f"{option.about} (default: {option.default or agents})"
        kind = float if option.number else Path if option.metavar == "FILE" else str
        given: dict[str, Any] = {"metavar": option.metavar, "type": kind}
        if option.per_file:
            given |= {"type": per_file(kind), "action": "append"}
            text += PER_FILE if name == "fps" else f"; PART={option.metavar} as for --fps"
        elif name == "columns":
            given |= {"nargs": "+", "default": []}
        elif name in ("time_base", "agents"):
            given |= {"default": option.default or agents}
        parser.add_argument(f"--{name.replace('_', '-')}", help=text, **given)


def per_file(kind: Callable[[str], Any]) -> Callable[[str], tuple[str, Any]]:
    """Return a parser of ``VALUE`` or ``PART=VALUE`` to the part of a path and the value."""

    def parse(text: str) -> tuple[str, Any]:
        part, _, value = text.rpartition("=")
        try:
            return part, kind(value)
        except ValueError:
            raise argparse.ArgumentTypeError(f"invalid {kind.__name__} value: {value!r}") from None

    return parse


def value_for(path: Path | str, pairs: Sequence[tuple[str, Any]] | None) -> Any:
    """Return the last value of an option whose part is in the path of a file, or None.

    >>> [value_for(path, [("", 25.0), ("citr", 29.97)]) for path in ("zara01.txt", "citr/front_01.csv")]
    [25.0, 29.97]
    """
    return next((value for part, value in reversed(pairs or ()) if part in str(path)), None)


def check_no_file_options(options: argparse.Namespace, recordings: str) -> None:
    """Raise :class:`InputError` if an option of :func:`add_file_options` is given without the recordings it is for."""
    from crowdbot.core import InputError
    from crowdbot.data import FILE_OPTIONS

    for name in FILE_OPTIONS:
        if name not in ("time_base", "agents") and getattr(options, name):
            raise InputError(f"--{name.replace('_', '-')} is for recordings; give {recordings}")


def check_parts(options: argparse.Namespace, paths: Sequence[Path]) -> None:
    """Raise :class:`InputError` for a part of ``--fps PART=FRAMES`` and the like that is in no path."""
    from crowdbot.core import InputError

    for name in ("fps", "units", "scale"):
        for part, value in getattr(options, name) or ():
            if not any(part in str(path) for path in paths):
                raise InputError(f"--{name} {part}={value}: no recording has {part!r} in its path")


def transform(options: argparse.Namespace, path: Path) -> float | tuple[tuple[float, ...], ...] | None:
    """Return metres per pixel or a homography of a file, or None."""
    from crowdbot.core import InputError
    from crowdbot.data import read_homography

    if options.scale is not None and options.homography is not None:
        raise InputError("--scale and --homography are given; coordinates have one scale")
    if options.homography is None:
        return value_for(path, options.scale)  # type: ignore[no-any-return]
    return tuple(map(tuple, read_homography(options.homography).tolist()))


def recording(options: argparse.Namespace, path: Path, **windows: Any) -> Recording:
    """Return one file with the options of :func:`add_file_options`; ``windows`` are other fields of
    :class:`crowdbot.data.Recording`.
    """
    from crowdbot.data import Recording, parse_columns

    return Recording(
        str(path),
        fps=value_for(path, options.fps),
        format=options.format,
        units=value_for(path, options.units),
        time_base=options.time_base,
        columns=parse_columns(options.columns),
        transform=transform(options, path),
        topic=options.topic,
        frame=options.frame,
        agents=options.agents,
        **windows,
    )


def recordings(options: argparse.Namespace, paths: Sequence[Path] | None = None) -> tuple[Recording, ...]:
    """Return the recordings of ``--data``, or of other paths with the same options."""
    check_parts(options, [*options.data, *(getattr(options, "check", None) or ())])
    layout = None
    if options.stage is not None:
        from crowdbot.trials import load_layout

        layout = load_layout(options.stage)
    windows = {name: getattr(options, name) for name in WINDOW_OPTIONS}
    return tuple(
        recording(options, path, layout=layout, **windows) for path in (options.data if paths is None else paths)
    )


def print_notes(found: tuple[Recording, ...]) -> None:
    """Print what was understood of each recording, in two lines, and the notes on it, without duplicates."""
    for entry in dict.fromkeys(found):
        tracks = entry.tracks
        for sentence in (*describe_tracks(tracks), *((tracks.note,) if tracks.note else ())):
            note(f"{entry.name}: {sentence}")


def describe_tracks(tracks: Trajectories) -> tuple[str, str]:
    """Return two lines on tracks: rows, people and seconds; extent and speeds.

    >>> from crowdbot.data import Trajectories
    >>> describe_tracks(Trajectories([7, 7], [0, 10], [0.0, 0.5], [2.0, 2.0], row_rate=2.5))
    ('2 rows of 1 person, 0.4 s with a step of 0.4 s', '0.5 x 0 m; speed 1.25 m/s (5 to 95 %: 1.2 to 1.2 m/s)')
    """
    import numpy as np

    robots = len(tracks.robots)
    people = len(tracks.ids) - robots
    who = f"{people} {'person' if people == 1 else 'people'}" + (f" and {robots} robots" if robots else "")
    first = f"{len(tracks)} rows of {who}, {tracks.time[-1]:.4g} s with a step of {tracks.dt:.4g} s"
    width, height = np.ptp(tracks.position, axis=0)
    extent = f"{width:.3g} x {height:.3g} {tracks.units}"
    speed = np.hypot(*tracks.velocities()[~np.isin(tracks.id, list(tracks.robots))].T)
    speed = speed[~np.isnan(speed)]
    if len(speed) == 0:
        return first, f"{extent}; no speeds, each person has one row"
    low, middle, high = np.percentile(speed, [5, 50, 95])
    per = f"{tracks.units}/s"
    return first, f"{extent}; speed {middle:.3g} {per} (5 to 95 %: {low:.2g} to {high:.2g} {per})"


def horizon(steps: Sequence[float], observe: int, predict: int) -> str:
    """Return observed and predicted rows with their durations, for recordings with these time steps [s].

    >>> horizon([0.4], 8, 12)
    '8 rows (3.2 s) observed, 12 rows (4.8 s) predicted'
    >>> horizon([0.4, 0.04], 8, 12)
    '8 rows (0.32 to 3.2 s) observed, 12 rows (0.48 to 4.8 s) predicted'
    """

    def seconds(rows: int) -> str:
        low, high = rows * min(steps), rows * max(steps)
        return f"{rows} rows ({low:.3g} s)" if high - low < 1e-6 * high else f"{rows} rows ({low:.3g} to {high:.3g} s)"

    return f"{seconds(observe)} observed, {seconds(predict)} predicted"
