"""JRDB 3D labels: a JSON object of boxes by point cloud (Martín-Martín et al., TPAMI 2023).

The coordinates are those of the robot, which moves: tracks are relative to it.
"""

from __future__ import annotations

import json
import re
from typing import Any

from crowdbot.core import DataError
from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .reader import Reader, ReadOptions

FPS = 15.0
START = re.compile(r'^\s*\{\s*"labels"\s*:\s*\{')
NUMBER = re.compile(r"\d+")


def sniff(source: Source) -> bool:
    """Return whether the text begins with an object of labels."""
    return source.kind == "text" and bool(START.match(source.head.decode("utf-8", errors="replace")))


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read the centers of the boxes; the class, such as ``pedestrian``, is the label."""
    try:
        clouds = json.loads(source.text())["labels"]
        rows = [row for name, boxes in clouds.items() for row in _rows(name, boxes)]
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError) as error:
        raise DataError(f"{source.name} is not a file of JRDB labels, or is damaged: {error!r}") from None
    if not rows:
        raise DataError(f"{source.name} has no boxes")
    frame, kind, id, x, y = zip(*rows, strict=True)
    return assemble(
        source,
        options,
        id=id,
        frame=frame,
        x=x,
        y=y,
        fps=FPS,
        frame_step=1,
        note="coordinates of the robot, which moves; 15 Hz is assumed, as in JRDB; fps overrides this",
        labels=dict(zip(id, kind, strict=True)),
    )


def _rows(name: str, boxes: list[dict[str, Any]]) -> list[tuple[int, str, int, float, float]]:
    """Return frame, class, id, x and y of the boxes of a point cloud."""
    number = NUMBER.search(name)
    if number is None:
        raise ValueError(f"the point cloud {name!r} has no number")
    rows = []
    for box in boxes:
        kind, _, id = str(box["label_id"]).partition(":")
        rows.append((int(number[0]), kind, int(id), float(box["box"]["cx"]), float(box["box"]["cy"])))
    return rows


READER = Reader("jrdb", "JRDB 3D labels: JSON boxes by point cloud, relative to the robot", sniff, read)
