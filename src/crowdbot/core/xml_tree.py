"""XML from anywhere: a small tree with line numbers, and nothing that a hostile file could use.

Only elements, attributes and short texts are kept. A DOCTYPE is refused where it begins, so that no entity is ever
declared, expanded or fetched; size, depth and number of elements have limits.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat  # expat alone expands nothing from outside; entities are refused below
from xml.sax.saxutils import escape, quoteattr

from .errors import InputError

__all__ = ["Element", "format_xml", "parse_number", "parse_xml", "read_bytes", "reject_entities"]

MOST_BYTES = 4_000_000
MOST_DEPTH = 20
MOST_ELEMENTS = 50_000
MOST_ATTRIBUTES = 100
MOST_TEXT = 200
"""Longest text between tags that is kept; nothing that crowdbot reads is longer."""

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,4})?", re.ASCII)
Refusal = Callable[[str], InputError]


@dataclass
class Element:
    """One element with the line on which it begins; ``stray`` is the text between its tags, cut when long."""

    tag: str
    attributes: dict[str, str] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)
    line: int = 0
    stray: str = ""

    def each(self, tag: str) -> list[Element]:
        """Return the child elements of this name.

        >>> [inner.line for inner in parse_xml(b"<a><b/><c/>\\n<b/></a>", "t.xml").each("b")]
        [1, 2]
        """
        return [inner for inner in self.children if inner.tag == tag]


def read_bytes(path: Path, what: str = "file", refusal: Refusal = InputError) -> bytes:
    """Return what a small file holds, one byte more than :func:`parse_xml` takes at the most.

    Args:
        path: the file.
        what: it is meant to hold, for messages, such as ``trial``.
        refusal: the error to raise.

    Raises:
        InputError: the file is missing, no file, or unreadable.
    """
    if not path.exists():
        raise refusal(f"there is no {what} file {path}")
    if not path.is_file():
        raise refusal(f"{path} is not a file; give the {what} file itself")
    try:
        with path.open("rb") as stream:
            return stream.read(MOST_BYTES + 1)
    except OSError as error:
        raise refusal(f"{path} cannot be read: {error.strerror}") from None


def parse_xml(
    data: bytes,
    place: str,
    encoding: str | None = None,
    *,
    what: str = "file",
    root: str = "",
    refusal: Refusal = InputError,
) -> Element:
    """Return the root element of an XML text.

    Args:
        data: the bytes of the file.
        place: name for messages.
        encoding: of the bytes; None takes what they say themselves.
        what: the file is meant to be, for messages, such as ``trial``.
        root: name of the element that it should begin with, for messages.
        refusal: the error to raise.

    Raises:
        InputError: the text is not XML, or uses what no such file has a need of (DOCTYPE, entities, great depth or
            size).

    >>> parse_xml(b"<trial><robot name='r'/></trial>", "t.xml").children[0].attributes
    {'name': 'r'}
    """
    if len(data) > MOST_BYTES:
        raise refusal(f"{place} is larger than {MOST_BYTES} bytes, which no {what} needs to be")
    if not data.strip():
        begins = f" with the root element <{root}>" if root else ""
        raise refusal(f"{place} is empty; a {what} is an XML file{begins}")
    growth = _Growth(place, encoding, what, refusal)
    _fed(growth.parser, data, place, refusal)
    return growth.root


def reject_entities(data: bytes, place: str, refusal: Refusal = InputError) -> None:
    """Raise unless the bytes are well-formed XML without DOCTYPE and entities, of any size.

    For files that a library will read afterwards, such as COLLADA meshes.
    """
    growth = _Growth(place, None, "mesh", refusal)
    growth.parser.StartElementHandler = growth.parser.EndElementHandler = growth.parser.CharacterDataHandler = None
    _fed(growth.parser, data, place, refusal)


def _fed(parser: Any, data: bytes, place: str, refusal: Refusal) -> None:
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        reason = expat.errors.messages.get(error.code, "not well-formed")
        raise refusal(f"{place}:{error.lineno}: this is not well-formed XML: {reason}") from None
    except InputError:
        raise
    except (LookupError, ValueError) as error:
        raise refusal(f"{place}: this is not well-formed XML: {error}") from None


class _Growth:
    """The tree while expat reads it."""

    def __init__(self, place: str, encoding: str | None, what: str, refusal: Refusal) -> None:
        self.place, self.what, self.refusal = place, what, refusal
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
        raise self.refusal(
            f"{self.place}:{self.parser.CurrentLineNumber}: a {self.what} must not have a DOCTYPE or entities"
            " (they can read other files and grow without bound); write the values themselves"
        )

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        line = self.parser.CurrentLineNumber
        self.count += 1
        for amount, most, kind in (
            (self.count, MOST_ELEMENTS, "elements"),
            (len(self.open) + 1, MOST_DEPTH, "levels of elements"),
            (len(attributes), MOST_ATTRIBUTES, "attributes in one element"),
        ):
            if amount > most:
                raise self.refusal(f"{self.place}:{line}: more than {most} {kind}, which no {self.what} needs")
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
            self.open[-1].stray = text.strip()[:MOST_TEXT]


def parse_number(text: str, otherwise: str = "is not a number") -> float:
    """Return the finite number that a text is, in the plain notation ``-1.5e-3``.

    Raises:
        InputError: it is none.

    >>> parse_number(" -1.5e-3 ")
    -0.0015
    """
    text = text.strip()
    if NUMBER.fullmatch(text):
        value = float(text)
        if math.isfinite(value):
            return value
        raise InputError("is not finite")
    if text.lstrip("+-").lower() in ("nan", "inf", "infinity"):
        raise InputError("is not finite")
    raise InputError(otherwise)


def format_xml(root: Element) -> str:
    """Return the tree as an XML text, one element a line.

    >>> print(format_xml(Element("trial", {"name": "a & b"}, [Element("stage")])), end="")
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
