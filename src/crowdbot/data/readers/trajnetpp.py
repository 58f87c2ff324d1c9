"""TrajNet++ ndjson: one JSON object per line, scenes and rows of tracks.

The key "fps" of a scene is rows per second; frames have their own step (10 in ETH/UCY, 12 in SDD).

Kothari, Kreiss, Alahi (2021), https://doi.org/10.1109/TITS.2021.3069362
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from crowdbot.core import DataError
from crowdbot.data.rows import LARGEST
from crowdbot.data.source import Source
from crowdbot.data.track_table import PrimaryScene
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .reader import Reader, ReadOptions

MAX_LINE = 1_000_000
"""Characters of one line; a line of the format has about 100."""


def sniff(source: Source) -> bool:
    """Return whether the first line is an object that holds a scene or a track."""
    if not source.lines or not source.lines[0].lstrip().startswith("{"):
        return False
    try:
        record = json.loads(source.lines[0])
    except (ValueError, RecursionError):
        return False
    return isinstance(record, dict) and bool({"scene", "track"} & set(record))


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read rows and scenes; rows of predictions (with a prediction number) are rejected."""
    rows: list[tuple[Any, ...]] = []
    scenes: list[dict[str, Any]] = []
    for number, line in enumerate(source.text().split("\n"), 1):
        if not line.strip():
            continue
        kind, record = _record(source.name, number, line)
        if kind == "scene":
            scenes.append(record)
        elif record.get("prediction_number") is not None:
            raise DataError(f"{source.name} line {number} is a prediction, not a recording; remove such rows")
        else:
            rows.append((number, *(_value(record, key, source.name, number) for key in "fpxy")))
    if not rows:
        raise DataError(f"{source.name} has {len(scenes)} scenes but no rows")
    lines, frame, id, x, y = (np.asarray(column) for column in zip(*rows, strict=True))
    return assemble(
        source,
        options,
        id=id,
        frame=frame,
        x=x,
        y=y,
        row_rate=_row_rate(source.name, scenes, options),
        line=lines,
        scenes=tuple(_scene(source.name, scene) for scene in scenes),
    )


def _record(name: str, number: int, line: str) -> tuple[str, dict[str, Any]]:
    if len(line) > MAX_LINE:
        raise DataError(
            f"{name} line {number} has {len(line)} characters, more than {MAX_LINE}; it is not a TrajNet++ row"
        )
    try:
        record = json.loads(line)
    except (ValueError, RecursionError):
        raise DataError(
            f"{name} line {number} is not JSON: {line.strip()[:40]!r}; the file is truncated or damaged"
        ) from None
    for kind in ("track", "scene"):
        if isinstance(record, dict) and isinstance(record.get(kind), dict):
            return kind, record[kind]
    raise DataError(f"{name} line {number} is neither a scene nor a track: {line.strip()[:40]!r}")


def _value(record: dict[str, Any], key: str, name: str, number: int) -> float:
    value = record.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise DataError(f"{name} line {number}: {key} is {json.dumps(value)[:40]}, it must be a number")
    if key in "fp" and not abs(value) < LARGEST:
        raise DataError(f"{name} line {number}: {key} is {value}, it must be a whole number")
    return float(value) if key in "xy" else value


def _row_rate(name: str, scenes: list[dict[str, Any]], options: ReadOptions) -> float | None:
    rates = sorted({float(s["fps"]) for s in scenes if isinstance(s.get("fps"), int | float)})
    if len(rates) > 1 and options.fps is None:
        raise DataError(f"{name}: its scenes have {len(rates)} values of fps, {rates[0]} to {rates[-1]}; give fps")
    return rates[0] if rates else None


def _scene(name: str, scene: dict[str, Any]) -> PrimaryScene:
    tag = scene.get("tag") or []
    parts = tag if isinstance(tag, list) else [tag]
    flat = [number for part in parts for number in (part if isinstance(part, list) else [part])]
    try:
        id, person, first, last = (int(scene[key]) for key in ("id", "p", "s", "e"))
        return PrimaryScene(id, person, first, last, tuple(int(number) for number in flat))
    except (KeyError, TypeError, ValueError, OverflowError):
        raise DataError(f"{name}: scene {json.dumps(scene)[:80]} lacks one of the whole numbers id, p, s, e") from None


READER = Reader("trajnetpp", "TrajNet++ ndjson: JSON lines of scenes and tracks", sniff, read)
