"""Text with the columns frame, id, x, y: leave-one-out files of SGAN, TrajNet and others."""

from __future__ import annotations

from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .eth import eth_time_base
from .plausibility import exchange_warning
from .reader import Reader, ReadOptions

HIDDEN = "?"
FRAME_FIRST = "warning: id and frame seem to be swapped (read as frame id x y), format petrack reads id frame x y"


def sniff(source: Source) -> bool:
    """Return whether the first rows have four columns of numbers; x and y may both be "?"."""
    rows = [row for row in source.rows if row[2:] != [HIDDEN, HIDDEN]]
    return bool(rows) and all(len(row) == 4 and all(map(_number, row)) for row in rows)


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read frame, id, x, y; rows with "?" (hidden futures in test files of TrajNet) are skipped and counted."""
    text, note, left_out = source.text(), "", 0
    if HIDDEN in text:
        lines = text.splitlines()
        hidden = [line.split()[2:] == [HIDDEN, HIDDEN] for line in lines]
        left_out = sum(hidden)
        text = "\n".join("" if gone else line for gone, line in zip(hidden, lines, strict=True))
        note = f"{left_out} rows with '?' are excluded: a test file with hidden futures"
    values, line = source.table(4, text)
    fps, base = eth_time_base(values, options) if len(values) else (None, "")
    odd = exchange_warning(values[:, 1], values[:, 0], values[:, 2:4], FRAME_FIRST)
    return assemble(
        source,
        options,
        frame=values[:, 0],
        id=values[:, 1],
        x=values[:, 2],
        y=values[:, 3],
        fps=fps,
        note="; ".join(part for part in (note, base, odd) if part),
        line=line,
    )


def _number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


READER = Reader("sgan", "text of frame id x y (SGAN, TrajNet, ETH/UCY leave-one-out files)", sniff, read)
