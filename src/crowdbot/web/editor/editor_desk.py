"""EditorDesk: the trial that the editor tab shows, its edits, and its files."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, TrialError, without_running_code
from crowdbot.navigation import PathPlanner
from crowdbot.trials import (
    MOST_CELLS,
    Avatar,
    Points,
    Trial,
    builtin_trials,
    expand_spawners,
    expand_sweeps,
    load_builtin_trial,
    override_remarks,
    parse_trial,
    place,
    trial_remarks,
    trial_titles,
    trial_xml,
)
from crowdbot.web.command import command
from crowdbot.web.desk import Desk, DeskWindows
from crowdbot.web.draft_file import DraftFile

from .edit_history import EditHistory
from .element_table import element_table
from .xml_document import XmlDocument, XmlNode

EMPTY = """<?xml version="1.0" encoding="UTF-8"?>
<trial name="new-trial" duration="60" seed="1">
  <stage/>
  <crowd type="people"/>
</trial>
"""
MOST_TEXT = 2_000_000
"""Longest XML text [characters]."""
ROOM = 0.3
"""Distance between the people and the border of their zone [m]."""
SAME = ("journey", "speed", "radius", "arrival", "crowd", "body", "activity")
"""Attributes that a spawner takes over if all its people have the same value."""
MESSAGE = re.compile(r":(\d+): (?:<([^>\s]+)>)?")
MOST_WAYS = 60
BODY = 0.25
"""Radius of the bodies whose ways are shown [m]."""


class EditorDesk(Desk):
    """The editor tab: a trial as XML text, edited by elements or as text, with checks, undo and files.

    The text is stored after each edit with the texts before and after it, so a server that is started again shows it
    and can undo. Every edit names the revision that it changes. An edit of an older revision is refused, so that two
    windows never overwrite each other's changes without a word.

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
        draft = self._draft.load()
        file = draft.get("file")
        self._history = EditHistory.restored(draft, MOST_TEXT) or EditHistory(EMPTY)
        self._revision, self._file = 0, file if isinstance(file, str) else ""
        self._document = _document(self._history.text)
        self._trial: Trial | None = None
        self._check()

    def greet(self) -> dict[str, Any]:
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
            for path in sorted((tuple(path) for path in paths), reverse=True):
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
        self._draft.save({**self._history.stored(), "file": self._file})
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
        "children": [_tree(child) for child in node.children],
    }


def agents_of_spawner(document: XmlDocument, path: Sequence[int], trial: Trial, seed: int) -> XmlDocument:
    """Return a document with the people of a spawner as single agents, at the places drawn with a seed.

    Args:
        document: the text of the trial.
        path: the spawner.
        trial: the trial in the text.
        seed: seed of the placement.

    Raises:
        InputError: the element is not a spawner, or people do not fit with this seed.
    """
    node = document.node(path)
    if node.tag != "spawner" or len(path) != 1:
        raise InputError(f"<{node.tag}> is not a spawner")
    if trial.sweeps:
        raise TrialError("the trial has sweeps; take one of its variants")
    number = [child for child in document.root.children if child.tag == "spawner"].index(node)
    spawner = trial.spawners[number]
    people, _ = place(trial.stage, trial.spawners, trial.robots, seed, trial.agents, avatars=trial.avatars)
    owners = [people.owners[int(item)] for item in people.owner]
    walking = [owner for owner in owners if not isinstance(owner, Avatar)]
    agents = expand_spawners(trial, seed).agents
    mine = tuple(agent for agent, owner in zip(agents, walking, strict=True) if owner is spawner)
    text = trial_xml(dataclasses.replace(trial, agents=mine, spawners=()))
    source = XmlDocument(text)
    for child in source.root.children:
        if child.tag == "agent":
            document = document.insert((), source.text[child.begin : child.end])
    return document.remove(path)


def spawner_of_agents(document: XmlDocument, paths: Sequence[Sequence[int]]) -> XmlDocument:
    """Return a document with a spawner in the place of single agents.

    Its zone is the rectangle around the agents and its goal the rectangle around their goals; attributes that all of
    them have are kept.

    Raises:
        InputError: an element is not an agent, or there is none.
    """
    nodes = [document.node(path) for path in paths]
    if not nodes or any(node.tag != "agent" for node in nodes):
        raise InputError("choose one or more agents")
    rows = [node.attributes for node in nodes]
    try:
        starts = np.array([[float(row["x"]), float(row["y"])] for row in rows])
        goals = [point for row in rows for point in Points.parse(row.get("goal") or row.get("goal-zone") or "")]
    except (KeyError, ValueError):
        raise InputError("an agent has no readable place or goal; correct it first") from None
    words = {"count": str(len(rows)), "zone": _rectangle(starts)}
    if goals:
        words["goal"] = _rectangle(np.array(goals))
    for name in SAME:
        if len(values := {row.get(name) for row in rows}) == 1 and (value := values.pop()) is not None:
            words[name] = value
    for path in sorted((tuple(path) for path in paths), reverse=True):
        document = document.remove(path)
    document = document.insert((), "<spawner/>")
    last = (len(document.root.children) - 1,)
    for name, value in words.items():
        document = document.set(last, name, value)
    return document


def _rectangle(points: NDArray[np.float64]) -> str:
    (left, low), (right, high) = points.min(axis=0) - ROOM, points.max(axis=0) + ROOM
    return str(Points.of(np.round([(left, low), (right, low), (right, high), (left, high)], 3)))


def map_of_picture(picture: Path, resolution: float) -> Path:
    """Write a picture as the map of a stage and return its ``.yaml`` file.

    Pixels darker than 35 % are walls, the others are free; the lower left corner is the origin. The grey picture is
    written beside it as ``.pgm``.

    Args:
        picture: PNG or JPEG.
        resolution: size of a pixel [m].

    Raises:
        InputError: the file is not a picture or too large, or the resolution is not between 1 mm and 10 m.
    """
    from PIL import Image, UnidentifiedImageError

    if not 0.001 <= resolution <= 10.0:
        raise InputError(f"size of a pixel = {resolution:g} m: expected 0.001 to 10 m")
    try:
        with Image.open(picture, formats=("PNG", "JPEG")) as image:
            if image.width * image.height > MOST_CELLS:
                raise InputError(
                    f"{picture.name} has {image.width} x {image.height} pixels, at most {MOST_CELLS} in all"
                )
            paper = Image.new("RGBA", image.size, "white")
            grey = Image.alpha_composite(paper, image.convert("RGBA")).convert("L")
    except (UnidentifiedImageError, OSError, Image.DecompressionBombError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{picture.name} is not a PNG or JPEG picture") from None
    grey.save(picture.with_suffix(".pgm"))
    path = picture.with_suffix(".yaml")
    rows = {
        "image": picture.with_suffix(".pgm").name,
        "resolution": f"{resolution:g}",
        "origin": "[0.0, 0.0, 0.0]",
        "negate": "0",
        "occupied_thresh": "0.65",
        "free_thresh": "0.65",
    }
    path.write_text("".join(f"{name}: {value}\n" for name, value in rows.items()), encoding="utf-8")
    return path


def read_trial(text: str, folder: Path) -> tuple[Trial | None, list[str], list[str]]:
    """Return the trial, or None, with the problems and remarks that ``crowdbot check`` prints; no code is run."""
    try:
        with without_running_code():
            trial = parse_trial(text, folder=folder)
            return trial, [], [*override_remarks(trial.robots), *trial_remarks(trial)]
    except TrialError as error:
        return None, list(error.problems), []
    except InputError as error:
        return None, [str(error)], []


def problems_at_elements(document: XmlDocument | None, problems: list[str]) -> list[dict[str, Any]]:
    """Return each problem with its line and the path of its element, None if it has none."""
    rows = []
    for sentence in problems:
        match = MESSAGE.search(sentence)
        line = int(match[1]) if match else None
        path = document.path_at(line, match[2] or "") if document and match and line else None
        rows.append({"message": sentence, "line": line, "path": None if path is None else list(path)})
    return rows


def start_and_ways(trial: Trial, seed: int) -> dict[str, Any]:
    """Return the start of people and robots with a seed, and the way of some people around walls to their goals.

    Raises:
        InputError: people do not fit with this seed.
    """
    first = expand_sweeps(trial)[0] if trial.sweeps else trial
    people, problems = place(first.stage, first.spawners, first.robots, seed, first.agents, avatars=first.avatars)
    if problems:
        raise InputError(problems[0][1])
    planner = PathPlanner.of(first.stage.walking_walls(), BODY, 0.0) if len(people) else None
    ends = zip(people.position[:MOST_WAYS], people.goal[:MOST_WAYS], strict=True)
    return {
        "seed": seed,
        "people": np.round(people.position, 3).tolist(),
        "radii": np.round(people.radius, 3).tolist(),
        "ways": [_way(planner, *end) for end in ends] if planner else [],
    }


def _way(planner: PathPlanner, start: NDArray[np.float64], goal: NDArray[np.float64]) -> list[list[float]]:
    """Return the corners of the shortest path, only the start where there is none."""
    try:
        corners = planner.waypoints(start, goal)
    except InputError:
        corners = start[None, :0].reshape(0, 2)
    way: list[list[float]] = np.round([start, *corners], 3).tolist()
    return way
