"""Stanford Drone Dataset, ``annotations.txt``: boxes in pixels at 30 Hz (Robicquet et al., ECCV 2016).

Ten columns: id xmin ymin xmax ymax frame lost occluded generated "label".
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.rows import integers
from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .reader import Reader, ReadOptions

__all__ = ["READER"]

VIDEO_FPS = 30.0
LABEL = re.compile(r'"([^"\n]*)"')


def sniff(source: Source) -> bool:
    """Return whether the first rows are nine whole numbers and a quoted label."""
    return bool(source.rows) and all(
        len(row) == 10 and row[9].startswith('"') and all(word.lstrip("-").isdigit() for word in row[:9])
        for row in source.rows
    )


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read the center of every box; rows marked lost are excluded, labels are stored by id."""
    text = source.text()
    names = sorted(set(LABEL.findall(text)))
    for number, name in enumerate(names):
        text = text.replace(f'"{name}"', str(number))
    values, line = source.table(10, text)
    _check_labels(source.name, values[:, 9], len(names), line)
    seen = values[:, 6] == 0.0
    if not np.any(seen):
        raise DataError(f"{source.name}: all of its {len(values)} rows are marked lost")
    lost = int(np.sum(~seen))
    values, line = values[seen], line[seen]
    id = integers(values[:, 0], "id", source.name, line)
    ids, first = np.unique(id, return_index=True)
    return assemble(
        source,
        options,
        id=id,
        frame=values[:, 5],
        x=(values[:, 1] + values[:, 3]) / 2.0,
        y=(values[:, 2] + values[:, 4]) / 2.0,
        fps=VIDEO_FPS,
        units="px",
        note=f"pixels; {lost} rows marked lost are excluded",
        line=line,
        labels={key: names[int(values[row, 9])] for key, row in zip(ids.tolist(), first, strict=True)},
    )


def _check_labels(name: str, label: NDArray[np.float64], count: int, line: NDArray[np.int64]) -> None:
    """Raise :class:`DataError` unless every label was quoted: a whole number from 0 to below ``count``."""
    wrong = ~((label >= 0.0) & (label < count) & (label == np.floor(label)))
    if np.any(wrong):
        row = int(np.argmax(wrong))
        raise DataError(
            f'{name} line {line[row]}: the label is {label[row]:g}, it must be a quoted word such as "Biker"'
        )


READER = Reader("sdd", "Stanford Drone Dataset annotations.txt: boxes in pixels, with labels", sniff, read)
