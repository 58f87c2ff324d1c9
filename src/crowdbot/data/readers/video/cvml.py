"""CVML: boxes of objects by frame in XML, as CAVIAR, PETS 2009 and the ETH mobile scene sequences are labelled.

The root, ``dataset`` or ``result``, has ``frame`` elements with a ``number``, these an ``objectlist`` of ``object``
elements with an ``id`` and a ``box`` with its middle ``xc``, ``yc`` and size ``w``, ``h`` in pixels (List and Fisher,
CVML, an XML-based computer vision markup language, ICPR 2004). Boxes of a ``grouplist`` are of groups, and are not
read. The position of a person is the middle of the lower edge of the box. The file has no frame rate.
"""

from __future__ import annotations

import re
from typing import Any
from xml.parsers import expat  # expat loads no external entity; a DOCTYPE is rejected below

import numpy as np

from crowdbot.core import DataError
from crowdbot.data.readers.assemble import assemble
from crowdbot.data.readers.reader import Reader, ReadOptions
from crowdbot.data.source import MAX_ROWS, Source
from crowdbot.data.trajectories import Trajectories

FRAME, OBJECTS = re.compile(r"<frame\s[^<>]*\bnumber\s*="), re.compile(r"<object_?list\b")
BOX = ("xc", "yc", "h")
Row = tuple[float, float, float, float, int]


def sniff(source: Source) -> bool:
    """Return whether the text is XML with numbered frames that have lists of objects."""
    if source.kind != "text" or not source.lines or not source.lines[0].lstrip().startswith("<"):
        return False
    head = source.head.decode("utf-8", errors="replace")
    return bool(FRAME.search(head) and OBJECTS.search(head))


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read the feet of the boxes of all objects, in pixels."""
    boxes = _Boxes(source.name)
    boxes.feed(source.text())
    if not boxes.rows:
        raise DataError(f"{source.name} has no objects with a box in its {boxes.frames} frames")
    frame, id, x, y, line = zip(*boxes.rows, strict=True)
    lost = f"; {boxes.lost} objects without a box are left out" if boxes.lost else ""
    return assemble(
        source, options, id=id, frame=frame, x=x, y=y, units="px", note=f"feet of boxes in pixels{lost}",
        line=np.array(line, dtype=np.int64),
    )  # fmt: skip


class _Boxes:
    """Rows of frame, id, x, y and line, of the boxes in the objects of frames."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.rows: list[Row] = []
        self.frames = self.lost = 0
        self.frame: float | None = None
        self.id: float | None = None
        self.seen = False
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.StartDoctypeDeclHandler = self._refuse

    def feed(self, text: str) -> None:
        """Read the XML.

        Raises:
            DataError: it is not well-formed, has a DOCTYPE or too many rows, or a number is missing.
        """
        try:
            self.parser.Parse(re.sub(r"^\ufeff?\s*<\?xml[^>]*\?>", "", text).encode(), True)
        except expat.ExpatError as error:
            reason = expat.errors.messages.get(error.code, "not well-formed")
            raise DataError(f"{self.name} line {error.lineno}: this is not well-formed XML: {reason}") from None

    def _refuse(self, *_: Any) -> None:
        raise DataError(f"{self.name} has a DOCTYPE, which can read other files; remove it")

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        if tag == "frame":
            self.frame, self.frames = self._number(tag, attributes, "number"), self.frames + 1
        elif tag == "object":
            self.id, self.seen = self._number(tag, attributes, "id"), False
        elif tag == "box" and self.frame is not None and self.id is not None and not self.seen:
            x, y, height = (self._number(tag, attributes, key) for key in BOX)
            self.rows.append((self.frame, self.id, x, y + 0.5 * height, self.parser.CurrentLineNumber))
            self.seen = True
            if len(self.rows) > MAX_ROWS:
                raise DataError(f"{self.name} has more than {MAX_ROWS} boxes; split it in time")

    def _end(self, tag: str) -> None:
        if tag == "object":
            self.lost += not self.seen
            self.id = None

    def _number(self, tag: str, attributes: dict[str, str], key: str) -> float:
        text = attributes.get(key, "")
        try:
            return float(text)
        except ValueError:
            where = f"{self.name} line {self.parser.CurrentLineNumber}"
            raise DataError(f"{where}: {key}={text[:40]!r} of <{tag}> is not a number") from None


READER = Reader("cvml", "CVML (XML) of CAVIAR, PETS and ETH: boxes of objects by frame, in pixels", sniff, read)
