"""DraftFile: the state of a tab on disk, so that a server that is started again shows it."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import Any

FOLDER = ".crowdbot-drafts"


class DraftFile:
    """A JSON object in the folder of a session.

    Args:
        folder: folder of the session.
        name: name of the tab.

    >>> import tempfile
    >>> draft = DraftFile(Path(tempfile.mkdtemp()), "editor")
    >>> draft.save({"text": "<trial/>"})
    >>> draft.load()
    {'text': '<trial/>'}
    """

    def __init__(self, folder: Path, name: str) -> None:
        self._path = folder / FOLDER / f"{name}.json"

    def save(self, values: dict[str, Any]) -> None:
        """Write the state; a full disk must not stop the tab."""
        with contextlib.suppress(OSError):
            self._path.parent.mkdir(exist_ok=True)
            part = self._path.with_suffix(".part")
            part.write_text(json.dumps(values), encoding="utf-8")
            part.replace(self._path)

    def load(self) -> dict[str, Any]:
        """Return the state, empty if there is none or it is damaged."""
        try:
            document = json.loads(self._path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return document if isinstance(document, dict) else {}
