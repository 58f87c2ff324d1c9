"""Let the reference show the ``Fields:`` of a docstring as a table (an extension of griffe, used by mkdocs.yml)."""

from __future__ import annotations

import re
from typing import Any

import griffe

HEADING = re.compile(r"^Fields(?: \((?P<about>[^\n]*)\))?:$", flags=re.M)
DOCTEST = re.compile(r"(^|\n\n)(>>> (?:.|\n(?!\n))*)(?=\n\n|\n?\Z)")
UNIT = re.compile(r"\] \[(?=[a-zA-Z0-9/]+\])")
ROLE = re.compile(r":[a-z]+:`~?([^`]+)`")
SHARED = re.compile(r"^(?P<indent> +)(?P<names>\w+(?:, \w+)+): (?P<text>.*(?:\n(?P=indent) +.*)*)$", flags=re.M)


class Fields(griffe.Extension):
    """Turn the house's docstrings into those of Google style."""

    def on_instance(self, *, obj: griffe.Object, **kwargs: Any) -> None:
        """Rewrite the docstring of one object before it is parsed."""
        if obj.docstring is not None:
            obj.docstring.value = google(obj.docstring.value)


def google(text: str) -> str:
    """Return a docstring with ``Attributes:`` for ``Fields:``, one entry per name, and fenced examples.

    >>> print(google("A thing.\\n\\nFields (arrays over E):\\n    x, y: ``[E]`` [m].\\n"))
    A thing.
    <BLANKLINE>
    Fields: arrays over E.
    <BLANKLINE>
    Attributes:
        x: ``[E]`` [m].
        y: ``[E]`` [m].
    <BLANKLINE>
    """
    plain = DOCTEST.sub(r"\1```pycon\n\2\n```", ROLE.sub(r"`\1`", UNIT.sub(r"] \\[", text)))
    plain = HEADING.sub(lambda m: f"Fields: {m['about']}.\n\nAttributes:" if m["about"] else "Attributes:", plain)
    return SHARED.sub(
        lambda m: "\n".join(f"{m['indent']}{name}: {m['text']}" for name in m["names"].split(", ")), plain
    )
