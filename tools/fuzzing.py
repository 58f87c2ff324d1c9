"""Mutations and checks for fuzzers: hostile values, changed texts and bytes, error messages that are sentences."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

_VALUES = """
nan inf -inf 1e999 1e308 -1e308 1e-320 0 -0 -1 1 2 1e6 1e7 99999 100000 100001 2147483648 9007199254740993 0x10 1_000
true false 1,0 0,0 1e6,1e6 0,0,0 normal(1,1) uniform(2,1) normal(1) x(1) () ( , ; : / .. ../x /etc/passwd ~ - é
${HOME} %s {0} \\ ' &amp; &lt; &#0; &#x41; <!--x--> ]]> POLYGON
"""
HOSTILE = _VALUES.split()
"""Values that parsers often get wrong."""
FACTORS = (-1.0, 0.1, 0.5, 0.9, 1.1, 2.0, 3.0, 100.0)
"""Factors for numbers."""
ENDS = (b"\x00", b"\xff", b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\x00\x00\x00\x80", b"\x00" * 8, b"\xff" * 8)
"""Bytes of integers at the ends of their ranges."""
NUMBER = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]+)?")
WORD = re.compile(r"[^\s,;:]+")


def replace_one(text: str, pattern: re.Pattern[str], rng: random.Random, change: Callable[[str], str]) -> str:
    """Return the text with one match of the pattern changed."""
    found = list(pattern.finditer(text))
    if not found:
        return text
    one = rng.choice(found)
    return text[: one.start()] + change(one.group()) + text[one.end() :]


def mutate_lines(text: str, rng: random.Random) -> str:
    """Return the text with lines dropped, doubled, swapped, or cut."""
    lines = text.splitlines(keepends=True)
    at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(5)
    if kind == 0:
        del lines[at : at + rng.choice((1, 2, 50))]
    elif kind == 1:
        lines[at:at] = lines[other : other + rng.choice((1, 3))]
    elif kind == 2:
        lines[at], lines[other] = lines[other], lines[at]
    elif kind == 3:
        lines[at] = lines[at][: rng.randrange(len(lines[at]) + 1)]
    else:
        lines[at] = lines[at].rstrip("\n") + rng.choice((" ", ",", ";", "\t", '"', " # ", "\r")) + lines[at]
    return "".join(lines)


def mutate_text(text: str, rng: random.Random) -> str:
    """Return a table or a list of records with one to four changes."""
    for _ in range(rng.choice((1, 1, 2, 4))):
        kind = rng.random()
        if not text.strip():
            return text
        if kind < 0.25:
            text = replace_one(text, NUMBER, rng, lambda word: f"{float(word) * rng.choice(FACTORS):g}")
        elif kind < 0.6:
            text = replace_one(text, WORD, rng, lambda _: rng.choice(HOSTILE))
        elif kind < 0.8:
            text = mutate_lines(text, rng)
        else:
            at = rng.randrange(len(text) + 1)
            odd = rng.choice(('"', "{", "}", "[", "#", "\x00", "\x1a", "", " ", "\n", "é", "\u2028", "9" * 400))
            text = text[:at] + odd + text[at + rng.choice((0, 0, 1, 5, 200)) :]
    return text


def mutate_bytes(data: bytes, rng: random.Random) -> bytes:
    """Return a binary file with one to four changes; half of them near its ends, where headers and indexes are."""
    raw = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 4))):
        if not raw:
            break
        reach = rng.choice((len(raw), len(raw), 64, 512, 4096))
        at = rng.randrange(min(reach, len(raw)))
        at = len(raw) - 1 - at if rng.random() < 0.5 else at
        kind = rng.random()
        if kind < 0.4:
            raw[at] ^= 1 << rng.randrange(8)
        elif kind < 0.7:
            end = rng.choice(ENDS)
            raw[at : at + len(end)] = end
        elif kind < 0.8:
            del raw[at : at + rng.choice((1, 8, 4096))]
        elif kind < 0.9:
            other = rng.randrange(len(raw))
            raw[at : at + 64] = raw[other : other + 64]
        else:
            del raw[at:]
    return bytes(raw)


def check_sentence(message: str) -> None:
    """Raise :class:`AssertionError` unless an error message is text for a user: no trace, no address of an object."""
    if not message.strip() or "Traceback" in message or "object at 0x" in message:
        raise AssertionError(f"not a sentence: {message!r}")
