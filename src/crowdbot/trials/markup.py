"""The XML of trials: :mod:`crowdbot.core.markup` with the words and the error of trials."""

from __future__ import annotations

from pathlib import Path

from crowdbot.core import TrialError, markup
from crowdbot.core.markup import Element, written

__all__ = ["Element", "parse", "read_bytes", "written"]


def read_bytes(path: Path) -> bytes:
    """Return what a trial file holds.

    Raises:
        TrialError: the file is missing, no file, unreadable or too large.
    """
    return markup.read_bytes(path, "trial", TrialError)


def parse(data: bytes, place: str, encoding: str | None = None) -> Element:
    """Return the root element of a trial; see :func:`crowdbot.core.markup.parse`.

    Raises:
        TrialError: the text is not XML, or uses what a trial has no need of (DOCTYPE, entities, great depth or size).

    >>> parse(b"<trial><robot name='r'/></trial>", "t.xml").children[0].attributes
    {'name': 'r'}
    """
    return markup.parse(data, place, encoding, what="trial", root="trial", refusal=TrialError)
