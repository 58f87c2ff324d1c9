"""XmlDocument: XML text whose elements and attributes are changed in place."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from html import unescape
from xml.sax.saxutils import escape

from crowdbot.core import Element, InputError, parse_xml

TOKEN = re.compile(
    r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>"
    r"|<(?P<close>/?)(?P<tag>[^\s/>!?]+)(?P<rest>(?:[^>\"']|\"[^\"]*\"|'[^']*')*?)(?P<empty>/?)>",
    re.DOTALL,
)
ATTRIBUTE = re.compile(r"(?P<space>\s+)(?P<name>[^\s=/>]+)\s*=\s*(?P<value>\"[^\"]*\"|'[^']*')", re.DOTALL)
NAME = re.compile(r"[A-Za-z_][\w.\-]*\Z", re.ASCII)
INDENT = "  "


@dataclass
class XmlNode:
    """An element and where it stands in the text.

    Fields:
        tag: name of the element.
        begin: position of ``<``.
        inner: position after the start tag.
        end: position after the end tag, or after the start tag of an empty element.
        empty: whether it is written as ``<tag/>``.
        line: line of the start tag, from 1.
        attributes: decoded values by name.
        values: begin and end of each value between its quotation marks.
        children: the elements inside.
    """

    tag: str
    begin: int
    inner: int
    end: int
    empty: bool
    line: int
    attributes: dict[str, str] = field(default_factory=dict)
    values: dict[str, tuple[int, int]] = field(default_factory=dict)
    children: list[XmlNode] = field(default_factory=list)

    def each(self) -> Iterator[XmlNode]:
        """Yield this element and all elements inside, in the order of the text."""
        yield self
        for child in self.children:
            yield from child.each()


class XmlDocument:
    """XML text that is edited by elements; everything else in it, such as comments and spaces, stays as it is.

    An element is named by the positions of its ancestors and itself among the child elements, from the root: ``()`` is
    the root, ``(0, 2)`` the third element in the first one. Each edit returns a new document.

    Args:
        text: the XML.
        place: name for messages.

    Raises:
        InputError: the text is not well-formed XML, has a DOCTYPE or entities, or exceeds a limit.

    >>> document = XmlDocument('<trial>\\n  <stage/> <!-- empty -->\\n</trial>')
    >>> document.insert((0,), '<wall points="0,0 1,0"/>').set((0, 0), "points", "0,0 2,0").text
    '<trial>\\n  <stage>\\n    <wall points="0,0 2,0"/>\\n  </stage> <!-- empty -->\\n</trial>'
    """

    def __init__(self, text: str, place: str = "trial") -> None:
        self.text, self.place = text, place
        self._tree = parse_xml(text.encode("utf-8", "surrogatepass"), place, "utf-8", what="trial")
        self.root = self._scan()

    def node(self, path: Sequence[int]) -> XmlNode:
        """Return the element at a path.

        Raises:
            InputError: there is no such element.
        """
        xml_node = self.root
        for number in path:
            if not isinstance(number, int) or not 0 <= number < len(xml_node.children):
                raise InputError(f"the element at {list(path)} does not exist in <{xml_node.tag}>")
            xml_node = xml_node.children[number]
        return xml_node

    def set(self, path: Sequence[int], name: str, value: str | None) -> XmlDocument:
        """Return a document with another value of an attribute; None removes it.

        Raises:
            InputError: there is no such element, or the name or value cannot stand in XML.
        """
        node = self.node(path)
        if not NAME.match(name):
            raise InputError(f"name of an attribute = {name!r:.60}: expected letters, digits, - and _")
        if name in node.values:
            begin, end = node.values[name]
            if value is not None:
                return self._edited(begin, end, _quoted(value, self.text[end]))
            before = self.text[:begin]
            return self._edited(len(before[: before.rindex(name)].rstrip()), end + 1, "")
        if value is None:
            return self
        here = node.inner - (2 if node.empty else 1)
        here -= len(self.text[:here]) - len(self.text[:here].rstrip())
        return self._edited(here, here, f' {name}="{_quoted(value, chr(34))}"')

    def insert(self, path: Sequence[int], xml: str, position: int | None = None) -> XmlDocument:
        """Return a document with one more element inside an element.

        Args:
            path: the element that gets it.
            xml: the new element.
            position: its number among the children (default: the last).

        Raises:
            InputError: the text is not one well-formed element, or the path does not exist.
        """
        parent = self.node(path)
        parse_xml(xml.encode("utf-8", "surrogatepass"), "element", "utf-8", what="trial")
        indent = self._indent(parent.begin)
        lines = f"\n{indent}{INDENT}" + xml.strip().replace("\n", f"\n{indent}{INDENT}")
        if parent.empty:
            opened = self.text[parent.begin : parent.inner - 2].rstrip()
            return self._edited(parent.begin, parent.end, f"{opened}>{lines}\n{indent}</{parent.tag}>")
        count = len(parent.children) if position is None else max(0, min(position, len(parent.children)))
        here = parent.children[count - 1].end if count else parent.inner
        tail = "" if self.text[here : parent.end].lstrip(" \t").startswith(("\n", "\r")) else f"\n{indent}"
        return self._edited(here, here, lines + tail)

    def remove(self, path: Sequence[int]) -> XmlDocument:
        """Return a document without an element, and without its line if nothing else stands there.

        Raises:
            InputError: there is no such element, or it is the root.
        """
        if not path:
            raise InputError("the root element cannot be removed")
        node = self.node(path)
        begin = node.begin - (len(self.text[: node.begin]) - len(self.text[: node.begin].rstrip(" \t")))
        rest = re.compile(r"[ \t]*(?=\r?\n|\Z)").match(self.text, node.end)
        if rest and self.text[:begin].endswith("\n"):
            return self._edited(begin - (2 if self.text[:begin].endswith("\r\n") else 1), rest.end(), "")
        return self._edited(node.begin, node.end, "")

    def replace(self, path: Sequence[int], xml: str) -> XmlDocument:
        """Return a document with another element in the place of one.

        Raises:
            InputError: the text is not one well-formed element, or there is no such element.
        """
        node = self.node(path)
        parse_xml(xml.encode("utf-8", "surrogatepass"), "element", "utf-8", what="trial")
        return self._edited(node.begin, node.end, xml.strip().replace("\n", f"\n{self._indent(node.begin)}"))

    def path_at(self, line: int, tag: str = "") -> tuple[int, ...] | None:
        """Return the path of the first element whose start tag is on a line, or None."""

        def find(node: XmlNode, path: tuple[int, ...]) -> tuple[int, ...] | None:
            if node.line == line and tag in ("", node.tag):
                return path
            return next(
                (found for i, child in enumerate(node.children) if (found := find(child, (*path, i))) is not None), None
            )

        return find(self.root, ())

    def _edited(self, begin: int, end: int, text: str) -> XmlDocument:
        return XmlDocument(self.text[:begin] + text + self.text[end:], self.place)

    def _indent(self, position: int) -> str:
        line = self.text[self.text.rfind("\n", 0, position) + 1 : position]
        return line[: len(line) - len(line.lstrip())]

    def _scan(self) -> XmlNode:
        """Return the elements with their places; the text is well-formed."""
        stack: list[XmlNode] = []
        root: XmlNode | None = None
        line, counted = 1, 0
        for token in TOKEN.finditer(self.text):
            tag = token.group("tag")
            if tag is None:
                continue
            if token.group("close"):
                stack.pop().end = token.end()
                continue
            line, counted = line + self.text.count("\n", counted, token.start()), token.start()
            node = XmlNode(tag, token.start(), token.end(), token.end(), bool(token.group("empty")), line)
            for item in ATTRIBUTE.finditer(token.group("rest")):
                begin, end = item.span("value")
                node.values[item["name"]] = (token.start("rest") + begin + 1, token.start("rest") + end - 1)
            if stack:
                stack[-1].children.append(node)
            root = root or node
            if not node.empty:
                stack.append(node)
        assert root is not None
        _decode(root, self._tree)
        return root


def _decode(node: XmlNode, element: Element) -> None:
    """Take the decoded values of the parser."""
    if node.tag != element.tag or len(node.children) != len(element.children):
        raise InputError(f"<{element.tag}> in line {element.line} is written in a way that the editor cannot change")
    node.attributes, node.line = dict(element.attributes), element.line
    for child, other in zip(node.children, element.children, strict=True):
        _decode(child, other)


def _quoted(value: str, mark: str) -> str:
    if re.search("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", value):
        raise InputError("the value of an attribute holds a character that XML cannot hold")
    text = escape(value, {"\n": "&#10;", "\t": "&#9;", "\r": "&#13;", mark: "&quot;" if mark == '"' else "&apos;"})
    assert unescape(text) == value or "\r" in value
    return text
