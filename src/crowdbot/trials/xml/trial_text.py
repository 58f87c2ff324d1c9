"""XML text of trials: :mod:`crowdbot.core.markup.xml_tree` with the errors of trials."""

from __future__ import annotations

from pathlib import Path

from crowdbot.core import Element, TrialError, parse_xml, read_bytes


def read_trial_bytes(path: Path) -> bytes:
    """Return the content of a trial file.

    Raises:
        TrialError: the file is missing, not a file, unreadable or too large.
    """
    return read_bytes(path, "trial", TrialError)


def parse_trial_xml(data: bytes, place: str, encoding: str | None = None) -> Element:
    """Return the root element of a trial; see :func:`crowdbot.core.parse_xml`.

    Raises:
        TrialError: the text is not XML, or uses unsupported features (DOCTYPE, entities, excessive depth or size).

    >>> parse_trial_xml(b"<trial><robot name='r'/></trial>", "t.xml").children[0].attributes
    {'name': 'r'}
    """
    return parse_xml(data, place, encoding, what="trial", root="trial", refusal=TrialError)
