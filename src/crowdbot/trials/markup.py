"""XML from anywhere: a small tree with line numbers, and nothing that a hostile file could use.

Only elements and attributes are kept. A DOCTYPE is refused where it begins, so that no entity is ever declared,
expanded or fetched; size, depth and number of elements have limits.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat  # expat alone expands nothing from outside; entities are refused below
from xml.sax.saxutils import escape, quoteattr

from crowdbot.core import TrialError

__all__ = ["Element", "parse", "read_bytes", "written"]

MOST_BYTES = 4_000_000
MOST_DEPTH = 20
MOST_ELEMENTS = 50_000
MOST_ATTRIBUTES = 100


@dataclass
class Element:
    """One element with the line on which it begins."""

    tag: str
    attributes: dict[str, str] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)
    line: int = 0
    stray: str = ""


def read_bytes(path: Path) -> bytes:
    """Return what a trial file holds.

    Raises:
        TrialError: the file is missing, no file, unreadable or too large.
    """
    if not path.exists():
        raise TrialError(f"there is no trial file {path}")
    if not path.is_file():
        raise TrialError(f"{path} is not a file; give the trial file itself")
    try:
        with path.open("rb") as stream:
            data = stream.read(MOST_BYTES + 1)
    except OSError as error:
        raise TrialError(f"{path} cannot be read: {error.strerror}") from None
    return data


def parse(data: bytes, place: str, encoding: str | None = None) -> Element:
    """Return the root element of an XML text.

    Args:
        data: the bytes of the file.
        place: name for messages.
        encoding: of the bytes; None takes what they say themselves.

    Raises:
        TrialError: the text is not XML, or uses what a trial has no need of (DOCTYPE, entities, great depth or size).

    >>> parse(b"<trial><robot name='r'/></trial>", "t.xml").children[0].attributes
    {'name': 'r'}
    """
    if len(data) > MOST_BYTES:
        raise TrialError(f"{place} is larger than {MOST_BYTES} bytes, which no trial needs to be")
    if not data.strip():
        raise TrialError(f"{place} is empty; a trial is an XML file with the root element <trial>")
    growth = _Growth(place, encoding)
    try:
        growth.parser.Parse(data, True)
    except expat.ExpatError as error:
        reason = expat.errors.messages.get(error.code, "not well-formed")
        raise TrialError(f"{place}:{error.lineno}: this is not well-formed XML: {reason}") from None
    except TrialError:
        raise
    except (LookupError, ValueError) as error:
        raise TrialError(f"{place}: this is not well-formed XML: {error}") from None
    return growth.root


class _Growth:
    """The tree while expat reads it."""

    def __init__(self, place: str, encoding: str | None) -> None:
        self.place = place
        self.root = Element("")
        self.open: list[Element] = []
        self.count = 0
        self.parser = expat.ParserCreate(encoding)
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.text
        self.parser.StartDoctypeDeclHandler = self.refuse
        self.parser.EntityDeclHandler = self.refuse
        self.parser.ExternalEntityRefHandler = self.refuse

    def refuse(self, *_: Any) -> int:
        raise TrialError(
            f"{self.place}:{self.parser.CurrentLineNumber}: a trial must not have a DOCTYPE or entities"
            " (they can read other files and grow without bound); write the values themselves"
        )

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        line = self.parser.CurrentLineNumber
        self.count += 1
        for amount, most, what in (
            (self.count, MOST_ELEMENTS, "elements"),
            (len(self.open) + 1, MOST_DEPTH, "levels of elements"),
            (len(attributes), MOST_ATTRIBUTES, "attributes in one element"),
        ):
            if amount > most:
                raise TrialError(f"{self.place}:{line}: more than {most} {what}, which no trial needs")
        element = Element(tag, dict(attributes), line=line)
        if self.open:
            self.open[-1].children.append(element)
        else:
            self.root = element
        self.open.append(element)

    def end(self, tag: str) -> None:
        self.open.pop()

    def text(self, text: str) -> None:
        if text.strip() and not self.open[-1].stray:
            self.open[-1].stray = text.strip()[:40]


def written(root: Element) -> str:
    """Return the tree as an XML text, one element a line.

    >>> print(written(Element("trial", {"name": "a & b"}, [Element("stage")])), end="")
    <?xml version="1.0" encoding="UTF-8"?>
    <trial name="a &amp; b">
      <stage/>
    </trial>
    """
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + "".join(_lines(root, ""))


def _lines(element: Element, indent: str) -> list[str]:
    row = "".join(f" {escape(key)}={_quoted(value)}" for key, value in element.attributes.items())
    if not element.children:
        return [f"{indent}<{element.tag}{row}/>\n"]
    inside = [line for part in element.children for line in _lines(part, indent + "  ")]
    return [f"{indent}<{element.tag}{row}>\n", *inside, f"{indent}</{element.tag}>\n"]


def _quoted(value: str) -> str:
    return quoteattr(value, {"\n": "&#10;", "\r": "&#13;", "\t": "&#9;"})
