"""EditorDesk: the trial that the editor tab shows, its edits, and its files."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from crowdbot.core import InputError
from crowdbot.trials import Trial, builtin_trials, load_builtin_trial, trial_titles, trial_xml
from crowdbot.web.command import command
from crowdbot.web.desk import Desk, DeskWindows
from crowdbot.web.draft_file import DraftFile

from .agents_of_spawner import agents_of_spawner, spawner_of_agents
from .edit_history import EditHistory
from .element_table import element_table
from .floor_picture import map_of_picture
from .trial_preview import problems_at_elements, read_trial, start_and_ways
from .xml_document import XmlDocument, XmlNode

__all__ = ["EditorDesk"]

EMPTY = """<?xml version="1.0" encoding="UTF-8"?>
<trial name="new-trial" duration="60" seed="1">
  <stage/>
  <crowd type="people"/>
</trial>
"""
MOST_TEXT = 2_000_000
"""Longest XML text [characters]."""


class EditorDesk(Desk):
    """The editor tab: a trial as XML text, edited by elements or as text, with checks, undo and files.

    The text is stored after each edit, so a server that is started again shows it. Every edit names the revision that
    it changes. An edit of an older revision is refused, so that two windows never
    overwrite each other's changes without a word.

    >>> import asyncio, tempfile
    >>> from pathlib import Path
    >>> from crowdbot.web import AppSession, Workspace
    >>> async def main():
    ...     space = Workspace(Path(tempfile.mkdtemp()))
    ...     session = AppSession("main", space, (EditorDesk,), asyncio.get_running_loop())
    ...     return await session.call("editor.insert", {"path": [0], "xml": '<wall points="0,0 4,0"/>', "revision": 0})
    >>> state = asyncio.run(main())
    >>> state["tree"]["children"][0]["children"][0]["attributes"], state["problems"]
    ({'points': '0,0 4,0'}, [])
    """

    name: ClassVar[str] = "editor"

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self._draft = DraftFile(session.workspace.folder, self.name)
        found = self._draft.load()
        text, file = found.get("text"), found.get("file")
        text = text if isinstance(text, str) and len(text) <= MOST_TEXT else EMPTY
        self._history, self._revision, self._file = EditHistory(text), 0, file if isinstance(file, str) else ""
        self._document = _document(text)
        self._trial: Trial | None = None
        self._check()

    def greet(self) -> dict[str, Any]:
        """Return the state for a new window."""
        return self._state()

    @command
    def table(self) -> dict[str, Any]:
        """Return the elements and attributes of trial files."""
        return element_table()

    @command
    def sources(self) -> dict[str, Any]:
        """Return what a new trial may start from: built-in trials and the files of the session."""
        titles = trial_titles()
        return {
            "trials": [{"name": name, "about": titles[name]} for name in builtin_trials()],
            "files": self.session.workspace.files("*.xml"),
            "maps": self.session.workspace.files("*.yaml"),
        }

    @command
    def start(self, trial: str = "", file: str = "") -> dict[str, Any]:
        """Open a built-in trial, a file of the session, or an empty trial; undo goes back to the trial before."""
        if file:
            path = self.session.workspace.readable(file)
            if path.stat().st_size > MOST_TEXT:
                raise InputError(f"{file} is larger than {MOST_TEXT} bytes, the limit of the editor")
            text = path.read_text(encoding="utf-8", errors="replace")
        else:
            text = trial_xml(load_builtin_trial(trial)) if trial else EMPTY
        self._file = file or f"{trial or 'new-trial'}.xml"
        return self._apply(text)

    @command
    def write(self, text: str, revision: int) -> dict[str, Any]:
        """Replace the whole text."""
        self._expect(revision)
        if len(text) > MOST_TEXT:
            raise InputError(f"the text has {len(text)} characters, at most {MOST_TEXT}")
        return self._apply(text)

    @command
    def change(self, changes: list, revision: int) -> dict[str, Any]:  # type: ignore[type-arg]
        """Set attributes in one edit: rows of path, name and value; without a value the attribute is removed."""

        def edit(document: XmlDocument) -> XmlDocument:
            for row in changes:
                if not isinstance(row, dict) or not isinstance(row.get("path"), list):
                    raise InputError(f"change = {row!r:.80}: expected path, name and value")
                value = row.get("value")
                if not isinstance(row.get("name"), str) or not isinstance(value, str | None):
                    raise InputError(f"change = {row!r:.80}: name and value must be text")
                document = document.set(row["path"], row["name"], value)
            return document

        return self._edit(revision, edit)

    @command
    def insert(self, path: list, xml: str, revision: int, position: int | None = None) -> dict[str, Any]:  # type: ignore[type-arg]
        """Add an element inside the one at the path."""
        return self._edit(revision, lambda document: document.insert(path, xml, position))

    @command
    def remove(self, paths: list, revision: int) -> dict[str, Any]:  # type: ignore[type-arg]
        """Remove elements."""

        def edit(document: XmlDocument) -> XmlDocument:
            for path in sorted((tuple(one) for one in paths), reverse=True):
                document = document.remove(path)
            return document

        return self._edit(revision, edit)

    @command
    def expand(self, path: list, seed: int, revision: int) -> dict[str, Any]:  # type: ignore[type-arg]
        """Replace a spawner by its people at the places drawn with a seed."""
        return self._edit(revision, lambda document: agents_of_spawner(document, path, self._whole(), seed))

    @command
    def gather(self, paths: list, revision: int) -> dict[str, Any]:  # type: ignore[type-arg]
        """Replace single people by a spawner over the area in which they stand."""
        return self._edit(revision, lambda document: spawner_of_agents(document, paths))

    @command
    def undo(self) -> dict[str, Any]:
        """Take the last edit back."""
        return self._show(self._history.undo())

    @command
    def redo(self) -> dict[str, Any]:
        """Repeat the edit that was taken back."""
        return self._show(self._history.redo())

    @command
    def preview(self, seed: int | None = None) -> dict[str, Any]:
        """Return where people start and the ways around walls to their goals."""
        trial = self._whole()
        return start_and_ways(trial, trial.seed if seed is None else seed)

    @command
    def floor(self, picture: str, resolution: float) -> str:
        """Make a map of a picture of a floor plan; return the name of its file for ``map`` of the stage.

        Args:
            picture: PNG or JPEG file of the session.
            resolution: size of a pixel [m].
        """
        path = self.session.workspace.readable(picture)
        if not path.is_relative_to(self.session.workspace.folder):
            raise InputError(f"file {picture!r} is outside the folder of the app")
        return map_of_picture(path, resolution).relative_to(self.session.workspace.folder).as_posix()

    @command
    def save(self, file: str) -> dict[str, Any]:
        """Write the text into a file of the session."""
        name = file if file.endswith(".xml") else f"{file}.xml"
        self.session.workspace.writable(name).write_text(self._history.text, encoding="utf-8", newline="")
        self._file = name
        return self._tell()

    def _whole(self) -> Trial:
        if self._trial is None:
            raise InputError("the trial has errors; correct them first")
        return self._trial

    def _expect(self, revision: int) -> None:
        if revision != self._revision:
            raise InputError("the trial was changed in another window or by a later edit; it is shown as it is now")

    def _edit(self, revision: int, edit: Callable[[XmlDocument], XmlDocument]) -> dict[str, Any]:
        self._expect(revision)
        if self._document is None:
            raise InputError("the text is not well-formed XML; correct it first")
        return self._apply(edit(self._document).text)

    def _apply(self, text: str) -> dict[str, Any]:
        self._history.add(text)
        return self._show(text)

    def _show(self, text: str) -> dict[str, Any]:
        self._revision += 1
        self._document = _document(text)
        self._draft.save({"text": text, "file": self._file})
        self._check()
        return self._tell()

    def _check(self) -> None:
        self._trial, problems, self._remarks = read_trial(self._history.text, self.session.workspace.folder)
        self._problems = problems_at_elements(self._document, problems)

    def _tell(self) -> dict[str, Any]:
        state = self._state()
        self.session.tell("editor.state", state)
        return state

    def _state(self) -> dict[str, Any]:
        return {
            "revision": self._revision,
            "file": self._file,
            "text": self._history.text,
            "tree": _tree(self._document.root) if self._document else None,
            "rings": self._rings(),
            "problems": self._problems,
            "remarks": self._remarks,
            "undo": self._history.can_undo,
            "redo": self._history.can_redo,
        }

    def _rings(self) -> list[list[list[float]]]:
        """Return the solid outlines of a map or area file, which the XML itself does not hold."""
        if self._trial is None or not (self._trial.stage.map or self._trial.stage.area):
            return []
        return [np.round(ring, 3).tolist() for ring in self._trial.stage.rings]


def _document(text: str) -> XmlDocument | None:
    """Return the document, or None if the text is not well-formed."""
    try:
        return XmlDocument(text)
    except InputError:
        return None


def _tree(node: XmlNode) -> dict[str, Any]:
    return {
        "tag": node.tag,
        "line": node.line,
        "attributes": node.attributes,
        "children": [_tree(one) for one in node.children],
    }
