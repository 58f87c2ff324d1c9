"""Boxes in pictures: Stanford Drone Dataset, MOT Challenge and KITTI tracking labels.

The position of a person is the middle of the lower edge of the box, where the feet are; boxes of the Stanford Drone
Dataset are seen from above, their position is the center.

* Stanford Drone Dataset, 30 Hz (Robicquet et al., ECCV 2016): id xmin ymin xmax ymax frame lost occluded generated
  "label".
* MOT Challenge (Milan et al., 2016): frame, id, left, top, width, height, confidence, then either class and visibility,
  or x, y, z in the world, which are -1 where they are unknown. ``seqinfo.ini`` beside the folder has the frame rate.
  Trackers write it without the columns at the end, too, or with the class last, and with right, bottom instead of width
  and height.
* KITTI tracking labels, 10 Hz (Geiger et al., CVPR 2012): frame, id, type, truncated, occluded, alpha, left, top,
  right, bottom, height, width, length, x, y, z, rotation; x, y, z are coordinates of the camera [m], which moves.
  Results without places, and boxes with width and height instead of right and bottom, as JRDB has them, are read.
"""

from __future__ import annotations

import configparser
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.readers.assemble import assemble
from crowdbot.data.readers.reader import Reader, ReadOptions
from crowdbot.data.rows import integers
from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories
from crowdbot.typing import Floats

SDD_FPS, KITTI_FPS = 30.0, 10.0
LABEL = re.compile(r'"([^"\n]*)"')
MOT_CLASSES = (
    "", "pedestrian", "person on vehicle", "car", "bicycle", "motorcycle", "vehicle", "static person", "distractor",
    "occluder", "occluder on the ground", "occluder full", "reflection",
)  # fmt: skip
"""Classes of MOT Challenge by number; those from 8 on are no road users."""
MOST_CLASS = 7
MOT_COLUMNS = (7, 8, 9, 10)
SMALLEST_BOX = 5.0
"""Smallest height [px] of boxes in files with fewer columns: speeds in m/s are lower."""
STANDARD = 9
"""Columns of ground truth: those of trackers are fewer, or ten."""
KITTI_COLUMNS = (17, 18)
"""Columns of KITTI labels; results have a score at the end."""
UNKNOWN = -1.0
NO_PLACE = (UNKNOWN, -1000.0, 0.0)
"""Values of x, y and z where there are none."""
KITTI_TYPES = frozenset(
    ("Car", "Van", "Truck", "Pedestrian", "Person", "Person_sitting", "Cyclist", "Tram", "Misc", "DontCare")
)
LARGEST_INFO = 64 * 1024


def sniff_sdd(source: Source) -> bool:
    """Return whether the first rows are nine whole numbers and a quoted label."""
    return bool(source.rows) and all(
        len(row) == 10 and row[9].startswith('"') and all(word.lstrip("-").isdigit() for word in row[:9])
        for row in source.rows
    )


def read_sdd(source: Source, options: ReadOptions) -> Trajectories:
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
        fps=SDD_FPS,
        units="px",
        note=f"pixels; {lost} rows marked lost are excluded",
        line=line,
        labels={key: names[int(values[row, 9])] for key, row in zip(ids.tolist(), first, strict=True)},
    )


def _check_labels(name: str, label: Floats, count: int, line: NDArray[np.int64]) -> None:
    """Raise :class:`DataError` unless every label was quoted: a whole number from 0 to below ``count``."""
    wrong = ~((label >= 0.0) & (label < count) & (label == np.floor(label)))
    if np.any(wrong):
        row = int(np.argmax(wrong))
        raise DataError(
            f'{name} line {line[row]}: the label is {label[row]:g}, it must be a quoted word such as "Biker"'
        )


def sniff_mot(source: Source) -> bool:
    """Return whether the first rows have 7 to 10 numbers with commas: frame, id, a box of positive size, confidence."""
    if not source.lines or "," not in source.lines[0]:
        return False
    if not any(source.numeric(columns) for columns in MOT_COLUMNS):
        return False
    rows = [list(map(float, row)) for row in source.rows]
    scored = len(rows[0]) >= STANDARD or all(
        row[6] <= 1.0 and row[-1] >= UNKNOWN and row[5] >= SMALLEST_BOX for row in rows
    )
    return scored and all(row[0].is_integer() and row[1].is_integer() and row[4] > 0.0 and row[5] > 0.0 for row in rows)


def read_mot(source: Source, options: ReadOptions) -> Trajectories:
    """Read the feet of all boxes in pixels, or the places in the world if every row has one."""
    width = len(source.rows[0]) if source.rows else 10
    values, line = source.table(width)
    known = values[:, 6] != 0.0 if width == STANDARD else np.ones(len(values), dtype=np.bool_)
    if width == STANDARD:  # rows with the flag 0 are not to be counted
        known &= (values[:, 7] >= 1.0) & (values[:, 7] <= MOST_CLASS)
    values, line = values[known], line[known]
    if len(values) == 0:
        raise DataError(f"{source.name} has no boxes of people or vehicles that count (column 7 is 0 in all rows)")
    if np.all(values[:, 1] < 0.0):
        raise DataError(f"{source.name}: the id of all rows is {values[0, 1]:g}, these are detections without tracks")
    x, y, units = values[:, 2] + 0.5 * values[:, 4], values[:, 3] + values[:, 5], "px"
    note = "feet of boxes in pixels"
    if width < STANDARD and np.all(values[:, 4:6] > values[:, 2:4]):
        # with sizes, the boxes of some row begin farther from the corner of the picture than their own size
        x, y = 0.5 * (values[:, 2] + values[:, 4]), values[:, 5]
        note += "; the columns 5 and 6 are right and bottom, as they are above left and top in all rows"
    elif width == 10 and options.units is None and not np.any((values[:, 7] == -1.0) & (values[:, 8] == -1.0)):
        x, y, units, note = values[:, 7], values[:, 8], "m", "places in the world, columns 8 and 9"
    id = integers(values[:, 1], "id", source.name, line)
    ids, first = np.unique(id, return_index=True)
    left_out = int(np.sum(~known))
    labels = (
        {key: MOT_CLASSES[int(values[row, 7])] for key, row in zip(ids.tolist(), first, strict=True)}
        if width == STANDARD
        else {}
    )
    return assemble(
        source,
        options,
        id=id,
        frame=values[:, 0],
        x=x,
        y=y,
        fps=_sequence_rate(source.path),
        units=units,
        note=note + (f"; {left_out} rows that do not count are left out" if left_out else ""),
        line=line,
        labels=labels,
    )


def _sequence_rate(path: Path) -> float | None:
    """Return the frame rate [1/s] in ``seqinfo.ini`` of the folder above or of the same folder, if there is one."""
    for folder in (path.parent, path.parent.parent):
        info = folder / "seqinfo.ini"
        if info.is_file() and info.stat().st_size <= LARGEST_INFO:
            parser = configparser.ConfigParser(interpolation=None)
            try:
                parser.read_string(info.read_text(encoding="utf-8", errors="replace"))
                return parser.getfloat("Sequence", "frameRate")
            except (configparser.Error, ValueError) as error:
                raise DataError(f"{info}: there is no number frameRate in its section Sequence: {error!r}") from None
    return None


def sniff_kitti(source: Source) -> bool:
    """Return whether the first rows have the columns of KITTI labels, with a type as the third."""
    return bool(source.rows) and all(len(row) in KITTI_COLUMNS and row[2] in KITTI_TYPES for row in source.rows)


def read_kitti(source: Source, options: ReadOptions) -> Trajectories:
    """Read the feet of boxes if pixels are converted, else places relative to the camera: x forward, y to the left.

    Files without boxes and sizes, where all of these columns are -1, are tracks of a fixed place in the columns of
    KITTI, as AgentFormer has ETH/UCY: x and y are the columns 14 and 16, and the frame rate is not that of KITTI.
    """
    rows, kinds, lines, has_boxes = [], dict[int, str](), [], False
    for number, text in enumerate(source.text().splitlines(), 1):
        words = text.split()
        if not words or words[2:3] == ["DontCare"]:
            continue
        if len(words) not in KITTI_COLUMNS:
            raise DataError(f"{source.name} line {number} has {len(words)} columns, KITTI labels have 17")
        try:
            row = [float(word) for word in (*words[:2], *words[6:10], words[13], words[15], words[14])]
            has_boxes = has_boxes or any(float(word) != UNKNOWN for word in words[6:13])
        except ValueError:
            raise DataError(f"{source.name} line {number}: a column other than the type is not a number") from None
        if row[1].is_integer():  # the reader of rows names the line of another id
            kinds.setdefault(int(row[1]), words[2])
        rows.append(row)
        lines.append(number)
    if not rows:
        raise DataError(f"{source.name} has no boxes but those of the type DontCare")
    values = np.asarray(rows, dtype=np.float64)
    fps: float | None = KITTI_FPS
    note = "feet of boxes in pixels; 10 Hz is assumed, as in KITTI; fps overrides this"
    x, y, units = 0.5 * (values[:, 2] + values[:, 4]), values[:, 5], "px"
    sizes = bool(has_boxes and np.any(values[:, 4:6] <= values[:, 2:4]))
    if sizes:
        x, y = values[:, 2] + 0.5 * values[:, 4], values[:, 3] + values[:, 5]
        note += "; the columns 9 and 10 are width and height, as some are below left and top"
    placed = ~np.any([np.all(values[:, 6:9] == none, axis=1) for none in NO_PLACE], axis=0)
    if not has_boxes:
        x, y, fps, units = values[:, 6], values[:, 7], None, "m"
        note = "places of the columns 14 (x) and 16 (y), there are no boxes"
    elif options.units is None and not np.any(placed):
        note += "; the file has no places"
    elif options.units is None:
        if lost := int(np.sum(~placed)):
            values, lines = values[placed], [number for number, there in zip(lines, placed, strict=True) if there]
            kinds = {id: kind for id, kind in kinds.items() if np.any(values[:, 1] == id)}
        x, y, units = values[:, 7], -values[:, 6], "m"
        note = (
            "warning: positions are relative to the camera, which moves with the car, x forward and y to the left;"
            " 10 Hz is assumed, as in KITTI, fps overrides this"
        )
        note += f"; {lost} rows without a place are left out" if lost else ""
    return assemble(
        source, options, id=values[:, 1], frame=values[:, 0], x=x, y=y, fps=fps, units=units, note=note,
        line=np.asarray(lines), frame_step=1, labels=kinds,
    )  # fmt: skip


SDD = Reader("sdd", "Stanford Drone Dataset annotations.txt: boxes in pixels, with labels", sniff_sdd, read_sdd)
MOT = Reader("mot", "MOT Challenge gt.txt or results: boxes in pixels, or places in the world", sniff_mot, read_mot)
KITTI = Reader("kitti", "KITTI tracking labels: boxes, and places relative to the camera", sniff_kitti, read_kitti)
