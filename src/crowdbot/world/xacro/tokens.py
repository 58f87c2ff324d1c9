"""Tokens of xacro expressions, and the parts of a text with expressions."""

from __future__ import annotations

import re
from typing import NamedTuple

from crowdbot.core import InputError

MOST_CHARACTERS = 4000
"""Maximum length of one expression."""
PATTERN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,4})?)"
    r"|(?P<text>'[^']*'|\"[^\"]*\")"
    r"|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<sign>\*\*|//|<=|>=|==|!=|[-+*/%<>()\[\]{},.:=]))",
    re.ASCII,
)


class Token(NamedTuple):
    """A token: its kind (``number``, ``text``, ``name``, ``sign``, ``end``) and its characters."""

    kind: str
    text: str


class TextPart(NamedTuple):
    """A part of a text: plain ``text``, the inside of ``${...}`` (``expression``) or of ``$(...)`` (``call``)."""

    kind: str
    text: str


def tokens(text: str) -> list[Token]:
    """Return the tokens of an expression, with an ``end`` token.

    Raises:
        InputError: the text is too long or has a character that no expression contains.

    >>> [token.text for token in tokens("a + 2.5")]
    ['a', '+', '2.5', '']
    """
    if len(text) > MOST_CHARACTERS:
        raise InputError(f"an expression has {len(text)} characters, at most {MOST_CHARACTERS} are allowed")
    found: list[Token] = []
    place, text = 0, text.rstrip()
    while place < len(text):
        match = PATTERN.match(text, place)
        if match is None or match.lastgroup is None:
            raise InputError(f"the expression {_cut(text)} has an unexpected {text[place:].lstrip()[:1]!r}")
        found.append(Token(match.lastgroup, match.group(match.lastgroup)))
        place = match.end()
    return [*found, Token("end", "")]


def split_text(text: str) -> list[TextPart]:
    """Return the parts of a text; ``$${`` and ``$$(`` stand for ``${`` and ``$(``.

    Raises:
        InputError: a bracket is not closed.

    >>> [tuple(part) for part in split_text("x${1 + 2}$(arg a)")]
    [('text', 'x'), ('expression', '1 + 2'), ('call', 'arg a')]
    """
    parts: list[TextPart] = []
    plain, place = "", 0
    while place < len(text):
        two = text[place : place + 2]
        if two in ("${", "$("):
            end = _closing(text, place + 1)
            parts += [TextPart("text", plain)] if plain else []
            parts.append(TextPart("expression" if two == "${" else "call", text[place + 2 : end]))
            plain, place = "", end + 1
        elif two == "$$" and re.match(r"\$+[{(]", text[place:]):
            run = re.match(r"\$+[{(]", text[place:])
            assert run is not None
            plain, place = plain + run.group()[1:], place + run.end()
        else:
            plain, place = plain + text[place], place + 1
    return [*parts, TextPart("text", plain)] if plain or not parts else parts


def _closing(text: str, opening: int) -> int:
    """Return the index of the bracket that closes the one at ``opening``, outside of quotes."""
    pair = {"{": "}", "(": ")"}
    first, last, depth, quote = text[opening], pair[text[opening]], 0, ""
    for k in range(opening, len(text)):
        letter = text[k]
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"" and letter in text[k + 1 :]:
            quote = letter
        elif letter == first:
            depth += 1
        elif letter == last:
            depth -= 1
            if depth == 0:
                return k
    raise InputError(f"{_cut(text[opening - 1 :])} has no closing {last!r}")


def _cut(text: str) -> str:
    return repr(text if len(text) <= 80 else text[:77] + "...")
