"""Folders of participants, and the withdrawal of a participant."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

from crowdbot.core import EpisodeError, InputError

from .log import SessionLog

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
    if not isinstance(numbers, list) or not all(type(number) is int and number > 0 for number in numbers):
        raise EpisodeError(f"{path} must be a list of the numbers of participants who have withdrawn")
    return tuple(numbers)


def withdraw(out: Path, participant: int) -> Path:
    """Delete the session of a participant with all its files, and return the deleted folder.

    The number is kept in ``withdrawn.json``, so that no other participant gets it and the number of people who withdrew
    can be reported. Tables and reports that were made before still contain the participant.

    Args:
        out: output folder of all participants.
        participant: number.

    Raises:
        EpisodeError: there is no session of this participant, it is running, or a file cannot be deleted.
        InputError: the list of withdrawn numbers cannot be written.
    """
    folder = folder_of(out, participant)
    if not (folder / LOG).is_file() or folder.is_symlink():
        raise EpisodeError(f"participant {participant} has no session in {out}")
    log, _ = SessionLog.open(folder / LOG)  # refuses a session that is in use
    log.close()
    numbers = sorted({*withdrawn(out), participant})
    try:
        (out / WITHDRAWN).write_text(json.dumps(numbers) + "\n", encoding="utf-8")
    except OSError as error:
        raise InputError(f"cannot write {out / WITHDRAWN}: {error.strerror}") from None
    try:
        shutil.rmtree(folder)
    except OSError as error:
        raise EpisodeError(f"cannot delete {error.filename or folder}: {error.strerror}") from None
    return folder
