"""Withdrawal of a participant: everything that was recorded is deleted, and the number is not used again."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from crowdbot.core import EpisodeError, InputError

from .log import SessionLog
from .session_folder import LOG, WITHDRAWN, folder_of, withdrawn


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
