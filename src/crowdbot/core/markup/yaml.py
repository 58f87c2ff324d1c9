"""A small part of YAML: mappings, sequences and scalars, as in parameter files of robots and simulators.

Anchors, aliases, merge keys, tags other than ``!degrees`` and ``!radians``, and several documents are refused.
"""

from __future__ import annotations

import math
import re
from typing import Any, NamedTuple

from crowdbot.core.errors import InputError

__all__ = ["parse_yaml"]

MOST_LINES = 20_000
MOST_DEPTH = 20
KEY = re.compile(
    r"""(?P<key>"[^"]*"|'[^']*'|[^\s\[\]{},&*!|>%@`"'#-][^:#]*?|-[^\s:#][^:#]*?)\s*:(?:\s+(?P<rest>.*))?$"""
)
NUMBER = re.compile(r"[+-]?(?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][+-]?\d{1,4})?", re.ASCII)
WORDS = {"true": True, "false": False, "yes": True, "no": False, "on": True, "off": False, "null": None, "~": None}


class _Line(NamedTuple):
    number: int
    indent: int
    text: str


def parse_yaml(text: str, place: str) -> Any:
    """Return the content of a YAML text: dictionaries, lists, strings, numbers, booleans and None.

    Args:
        text: the text.
        place: file name for messages.

    Raises:
        InputError: the text is not in the supported part of YAML.

    >>> parse_yaml("wheel: {radius: 0.1, turns: [1, 2]}  # m\\nangle: !degrees 180", "w.yaml")
    {'wheel': {'radius': 0.1, 'turns': [1, 2]}, 'angle': 3.141592653589793}
    """
    rows = _lines(text, place)
    if not rows:
        return None
    reader = _Reader(rows, place)
    found = reader.block(rows[0].indent, 0)
    if reader.place < len(rows):
        reader.refuse("is indented differently from the lines above")
    return found


def _lines(text: str, place: str) -> list[_Line]:
    lines = text.splitlines()
    if len(lines) > MOST_LINES:
        raise InputError(f"{place} has more than {MOST_LINES} lines, the maximum of a YAML file")
    found: list[_Line] = []
    for number, line in enumerate(lines, 1):
        plain = _without_comment(line).rstrip()
        if not plain.strip() or (plain.startswith(("---", "%YAML")) and not found):
            continue
        indent = len(plain) - len(plain.lstrip(" "))
        if "\t" in plain[: indent + 1]:
            raise InputError(f"{place}:{number}: a tab cannot indent YAML")
        found.append(_Line(number, indent, plain.strip()))
    return found


def _without_comment(line: str) -> str:
    quote = ""
    for k, letter in enumerate(line):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"":
            quote = letter
        elif letter == "#" and (k == 0 or line[k - 1] in " \t"):
            return line[:k]
    return line


class _Reader:
    def __init__(self, rows: list[_Line], place: str) -> None:
        self.rows, self.file, self.place = rows, place, 0

    def refuse(self, what: str) -> None:
        line = self.rows[min(self.place, len(self.rows) - 1)]
        raise InputError(f"{self.file}:{line.number}: {line.text[:60]!r} {what}")

    def block(self, indent: int, depth: int) -> Any:
        """Return the value of the lines at an indentation."""
        if depth > MOST_DEPTH:
            self.refuse(f"is nested more than {MOST_DEPTH} levels deep")
        line = self.rows[self.place]
        if line.text == "-" or line.text.startswith("- "):
            return self.sequence(indent, depth)
        if KEY.match(line.text):
            return self.mapping(indent, depth)
        self.place += 1
        return self.scalar(line.text)

    def sequence(self, indent: int, depth: int) -> list[Any]:
        found = []
        while self.place < len(self.rows):
            line = self.rows[self.place]
            if line.indent != indent or not (line.text == "-" or line.text.startswith("- ")):
                break
            rest = line.text[1:].lstrip()
            if not rest:
                self.place += 1
                found.append(self.inner(indent, depth))
                continue
            deeper = line.indent + len(line.text) - len(rest)
            self.rows[self.place] = _Line(line.number, deeper, rest)
            found.append(self.block(deeper, depth + 1))
        return found

    def mapping(self, indent: int, depth: int) -> dict[Any, Any]:
        found: dict[Any, Any] = {}
        while self.place < len(self.rows):
            line = self.rows[self.place]
            match = KEY.match(line.text)
            if line.indent != indent or line.text.startswith("- "):
                break
            if match is None:
                self.refuse("is not 'key: value'")
                break
            key, rest = self.scalar(match.group("key")), match.group("rest") or ""
            if isinstance(key, str) and key == "<<":
                self.refuse("is a merge key, which is not supported")
            self.place += 1
            found[key] = self.flow(rest) if rest else self.inner(indent, depth, sequence=True)
        return found

    def inner(self, indent: int, depth: int, sequence: bool = False) -> Any:
        """Return the block below a line, or None if nothing is indented deeper."""
        if self.place >= len(self.rows):
            return None
        line = self.rows[self.place]
        is_sequence = line.text == "-" or line.text.startswith("- ")
        if line.indent > indent or (sequence and is_sequence and line.indent == indent):
            return self.block(line.indent, depth + 1)
        return None

    def flow(self, text: str) -> Any:
        """Return a value on one line, or a flow collection that goes on over several lines."""
        while text[:1] in ("[", "{") and _open_brackets(text) > 0 and self.place < len(self.rows):
            text += " " + self.rows[self.place].text
            self.place += 1
            if len(text) > 20_000:
                self.refuse("continues a collection that is too long")
        return self.scalar(text)

    def scalar(self, text: str) -> Any:
        value, rest = self.value(text.strip(), 0)
        if rest.strip():
            self.refuse(f"has an unexpected {rest.strip()[:20]!r}")
        return value

    def value(self, text: str, depth: int) -> tuple[Any, str]:
        """Return the value at the beginning of a text, and the rest of the text."""
        if depth > MOST_DEPTH:
            self.refuse(f"is nested more than {MOST_DEPTH} levels deep")
        if text[:1] in ("&", "*", "|", ">", "@", "`"):
            self.place = max(0, self.place - 1)
            self.refuse("uses an anchor, alias or block text, which is not supported; write the value itself")
        if text[:1] == "!":
            return self.angle(text, depth)
        if text[:1] in ("'", '"'):
            end = text.find(text[0], 1)
            if end < 0:
                self.refuse("has a quote that is not closed")
            return text[1:end], text[end + 1 :]
        if text[:1] == "[":
            return self.items(text[1:], depth)
        if text[:1] == "{":
            return self.entries(text[1:], depth)
        stop = re.search(r"[,\]}]", text) if depth else None
        plain, rest = (text, "") if stop is None else (text[: stop.start()], text[stop.start() :])
        return _plain(plain.strip()), rest

    def angle(self, text: str, depth: int) -> tuple[Any, str]:
        tag, _, rest = text.partition(" ")
        if tag not in ("!degrees", "!radians"):
            self.place = max(0, self.place - 1)
            self.refuse(f"uses the tag {tag[:20]!r}; only !degrees and !radians are supported")
        value, rest = self.value(rest.strip(), depth)
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.refuse(f"needs a number after {tag}")
        return math.radians(value) if tag == "!degrees" else float(value), rest

    def items(self, text: str, depth: int) -> tuple[list[Any], str]:
        found = []
        text = text.strip()
        while not text.startswith("]"):
            value, text = self.value(text, depth + 1)
            found.append(value)
            text = self.next(text, "]")
        return found, text[1:]

    def entries(self, text: str, depth: int) -> tuple[dict[Any, Any], str]:
        found = {}
        text = text.strip()
        while not text.startswith("}"):
            match = re.match(r"\s*(\"[^\"]*\"|'[^']*'|[^:,\[\]{}]+?)\s*:\s*", text)
            if match is None:
                self.refuse("has an entry that is not 'key: value'")
                break
            found[self.scalar(match.group(1))], text = self.value(text[match.end() :], depth + 1)
            text = self.next(text, "}")
        return found, text[1:]

    def next(self, text: str, last: str) -> str:
        text = text.strip()
        if text.startswith(","):
            return text[1:].strip()
        if not text.startswith(last):
            self.refuse(f"has no closing {last!r}")
        return text


def _open_brackets(text: str) -> int:
    plain = re.sub(r"'[^']*'|\"[^\"]*\"", "", text)
    return sum(plain.count(sign) for sign in "[{") - sum(plain.count(sign) for sign in "]}")


def _plain(text: str) -> Any:
    if text.lower() in WORDS:
        return WORDS[text.lower()]
    if not text:
        return None
    if NUMBER.fullmatch(text) and len(text) < 100:
        digits = text.replace("_", "")
        return int(digits) if digits.lstrip("+-").isdigit() else float(digits)
    return text
