"""Folders of participants: their names, the files in them, and the numbers of those who have withdrawn."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from crowdbot.core import EpisodeError

LOG, COPY, ANSWERS = "session.jsonl", "experiment.xml", "answers.jsonl"
WITHDRAWN = "withdrawn.json"
"""File beside the folders of the participants."""


def folder_of(out: Path, participant: int) -> Path:
    """Return the folder of a participant."""
    return out / f"participant-{participant:03d}"


def withdrawn(out: Path) -> tuple[int, ...]:
    """Return the numbers of the participants who have withdrawn.

    Raises:
        EpisodeError: the list is damaged.
    """
    path = out / WITHDRAWN
    try:
        numbers: Any = json.loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        return ()
    except (OSError, ValueError):
        numbers = None
    if not isinstance(numbers, list) or not all(type(one) is int and one > 0 for one in numbers):
        raise EpisodeError(f"{path} must be a list of the numbers of participants who have withdrawn")
    return tuple(numbers)
