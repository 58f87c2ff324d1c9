"""Safe XML: a small element tree with line numbers.

The tree has elements, attributes and short texts. A DOCTYPE is rejected at its start: no entity is declared, expanded
or fetched. Size, depth and number of elements are limited.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat  # expat loads no external entity; entities are rejected below

from crowdbot.core.errors import InputError

MOST_BYTES = 4_000_000
MOST_DEPTH = 20
MOST_ELEMENTS = 50_000
MOST_ATTRIBUTES = 100
MOST_TEXT = 200
"""Maximum length of the text between tags; longer text is cut."""

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,4})?", re.ASCII)
Refusal = Callable[[str], InputError]


@dataclass
class Element:
    """One element with the line of its start tag.

    ``stray`` is the text between its tags, cut if long. ``place`` is the name of its file for messages, where the
    elements of one tree are from several files, otherwise empty.
    """

    tag: str
    attributes: dict[str, str] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)
    line: int = 0
    stray: str = ""
    place: str = ""

    def each(self, tag: str) -> list[Element]:
        """Return the child elements with this tag.

        >>> [inner.line for inner in parse_xml(b"<a><b/><c/>\\n<b/></a>", "t.xml").each("b")]
        [1, 2]
        """
        return [inner for inner in self.children if inner.tag == tag]


def read_bytes(path: Path, what: str = "file", refusal: Refusal = InputError) -> bytes:
    """Return the content of a file, at most one byte more than the limit of :func:`parse_xml`.

    Args:
        path: the file.
        what: kind of file for messages, such as ``trial``.
        refusal: class of the error.

    Raises:
        InputError: the file is missing, is not a regular file, or cannot be read.
    """
    if not path.exists():
        raise refusal(f"there is no {what} file {path}")
    if not path.is_file():
        raise refusal(f"{path} is not a file; pass a {what} file")
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
        encoding: encoding of the bytes (default: from the XML declaration).
        what: kind of file for messages, such as ``trial``.
        root: expected root element, for messages.
        refusal: class of the error.

    Raises:
        InputError: the text is not well-formed XML, has a DOCTYPE or entities, or exceeds a limit.

    >>> parse_xml(b"<trial><robot name='r'/></trial>", "t.xml").children[0].attributes
    {'name': 'r'}
    """
    if len(data) > MOST_BYTES:
        raise refusal(f"{place} is larger than {MOST_BYTES} bytes, the limit of a {what}")
    if not data.strip():
        begins = f" with the root element <{root}>" if root else ""
        raise refusal(f"{place} is empty; a {what} is an XML file{begins}")
    builder = _TreeBuilder(place, encoding, what, refusal)
    _feed(builder.parser, data, place, refusal)
    return builder.root


def reject_entities(data: bytes, place: str, refusal: Refusal = InputError) -> None:
    """Raise an error unless the bytes are well-formed XML, of any size, without DOCTYPE and entities.

    It checks files that another library reads afterwards, such as COLLADA meshes.
    """
    builder = _TreeBuilder(place, None, "mesh", refusal)
    builder.parser.StartElementHandler = builder.parser.EndElementHandler = builder.parser.CharacterDataHandler = None
    _feed(builder.parser, data, place, refusal)


def _feed(parser: Any, data: bytes, place: str, refusal: Refusal) -> None:
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        reason = expat.errors.messages.get(error.code, "not well-formed")
        raise refusal(f"{place}:{error.lineno}: this is not well-formed XML: {reason}") from None
    except InputError:
        raise
    except (LookupError, ValueError) as error:
        raise refusal(f"{place}: this is not well-formed XML: {error}") from None


class _TreeBuilder:
    """Builds the tree from the events of expat."""

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
    """Return the finite number in a text, in plain notation such as ``-1.5e-3``.

    Raises:
        InputError: the text is not a finite number.

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
    """Return the tree as XML text with one element per line.

    >>> print(format_xml(Element("trial", {"name": "a & b"}, [Element("stage")])), end="")
    <?xml version="1.0" encoding="UTF-8"?>
    <trial name="a &amp; b">
      <stage/>
    </trial>
    """
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + "".join(_lines(root, ""))


def _lines(element: Element, indent: str) -> list[str]:
    row = "".join(f" {_escape(key)}={_quote(value)}" for key, value in element.attributes.items())
    if not element.children:
        return [f"{indent}<{element.tag}{row}/>\n"]
    inside = [line for part in element.children for line in _lines(part, indent + "  ")]
    return [f"{indent}<{element.tag}{row}>\n", *inside, f"{indent}</{element.tag}>\n"]


def _quote(value: str) -> str:
    """Return a quoted attribute value, as ``xml.sax.saxutils.quoteattr``, whose import takes longer than a command."""
    text = _escape(value).replace("\n", "&#10;").replace("\r", "&#13;").replace("\t", "&#9;")
    if '"' not in text:
        return f'"{text}"'
    return f"'{text}'" if "'" not in text else '"' + text.replace('"', "&quot;") + '"'


def _escape(text: str) -> str:
    return text.replace("&", "&amp;").replace(">", "&gt;").replace("<", "&lt;")


COMMENT = re.compile(rb"<!\[CDATA\[.*?\]\]>|<!--.*?-->", re.DOTALL)
DECLARATION = re.compile(rb"(\xef\xbb\xbf)?\s+(<\?xml\b[^>]{0,200}\?>)", re.DOTALL)
KEPT_ENCODING = re.compile(rb"encoding\s*=\s*[\"'](?!utf-?8)", re.IGNORECASE)
NO_LINE_END = re.compile(rb"[^\r\n]")


def strict_xml(data: bytes) -> bytes:
    """Return well-formed XML of a text that TinyXML reads, with all elements on their lines.

    Comments, in which ``--`` is not allowed by XML, become blanks: they end at the first ``-->``. So does a declaration
    in UTF-8 that does not begin the text.

    >>> strict_xml(b"\\n<?xml version='1.0'?>\\n<!-- run -- it -->\\n<a/>").split()
    [b'<a/>']
    >>> strict_xml(b"<a><!-- b\\nc --></a>").count(b"\\n")
    1
    """
    text = COMMENT.sub(_blank_comment, data)
    declaration = DECLARATION.match(text)
    if declaration and not KEPT_ENCODING.search(declaration[2]):
        text = NO_LINE_END.sub(b" ", declaration[0]) + text[declaration.end() :]
    return text


def _blank_comment(match: re.Match[bytes]) -> bytes:
    return NO_LINE_END.sub(b" ", match[0]) if match[0].startswith(b"<!--") else match[0]
