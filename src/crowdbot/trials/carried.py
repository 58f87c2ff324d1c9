"""Carried: the files that a trial names, kept in its recording, so that it replays on another machine.

Maps, areas and recorded people lie in the folder of a trial, and so may code of navigators, sensors and models. An
episode holds them as MCAP attachments, each with its digest; those that are too large are only named. Data are used as
they were recorded. Code is run from beside the episode; from out of it only when it is trusted.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from crowdbot.core import EpisodeError
from crowdbot.data.tape import Kind, Tape, TapeError, attachment

from .attribute import outline
from .beside import beside
from .drawn import Drawn
from .ground import is_file_of_area, map_files
from .trial import Trial

__all__ = ["Carried", "carried", "named_files", "unpacked"]

MOST = 64 << 20
"""An episode keeps files of at most so many bytes together."""
DATA, CODE = "data", "code"


@dataclass(frozen=True)
class Carried:
    """A file that belongs to an episode.

    Fields:
        name: as the trial has it, relative to its folder.
        kind: ``data`` or ``code``.
        size: [bytes].
        digest: of its bytes.
        kept: whether the episode holds it; otherwise it was too large.
    """

    name: str
    kind: str
    size: int
    digest: str
    kept: bool

    def lies_in(self, folder: Path) -> bool:
        """Whether it lies in a folder: code of this name, data with these bytes."""
        path = folder / self.name
        if not path.is_file():
            return False
        return self.kind == CODE or (path.stat().st_size == self.size and _digest(path) == self.digest)


def named_files(trial: Trial) -> dict[str, tuple[str, Path]]:
    """Return kind and place of every file that a trial names in its folder, by its name there.

    An element that names other files tells of them by a method ``files() -> tuple[Path, ...]``.

    Raises:
        InputError: one is missing.
    """
    found: dict[str, tuple[str, Path]] = {}
    stage = trial.stage
    if stage.area and is_file_of_area(stage.area):
        found[stage.area] = DATA, beside(stage.area, stage.folder, stage.trust)
    if stage.map:
        for name, path in map_files(stage.map, stage.folder, stage.trust).items():
            found[name] = DATA, path
    for one in trial.recorded:
        found[one.data] = DATA, beside(one.data, one.folder, one.trust)
    for thing in _parts(trial):
        if hasattr(thing, "files"):
            found |= {_name(path, trial.folder): (DATA, path) for path in thing.files()}
        module = sys.modules.get(type(thing).__module__)
        if type(thing).__module__.startswith("crowdbot_plug_") and module is not None and module.__file__:
            path = Path(module.__file__)
            found[_name(path, trial.folder)] = CODE, path
    return {name: row for name, row in sorted(found.items()) if _is_inside(name)}


def _name(path: Path, folder: Path | None) -> str:
    """Return how a trial names a file; see :mod:`crowdbot.trials.writing`."""
    return path.name if folder is None else Path(os.path.relpath(path, folder.resolve())).as_posix()


def _parts(thing: Any) -> Iterator[Any]:
    """Yield an element and everything in it, the plugs too."""
    yield thing
    cls: type = type(thing)
    for part in outline(cls):
        value = getattr(thing, part.name)
        if part.role in ("plugged", "mounted"):
            yield value.model if isinstance(value, Drawn) else value
        elif part.role == "child" and value is not None:
            yield from _parts(value)
        elif part.role == "children":
            for one in part.into.spread(value) if part.into else value:
                yield from _parts(one)


def carried(trials: Iterable[Trial]) -> list[tuple[Carried, Path]]:
    """Return the files of trials with their places, and which of them an episode keeps."""
    named: dict[str, tuple[str, Path]] = {}
    for trial in trials:
        named = named_files(trial) | named
    rows, total = [], 0
    for name, (kind, path) in named.items():
        size = path.stat().st_size
        kept = total + size <= MOST
        total += size if kept else 0
        rows.append((Carried(name, kind, size, _digest(path), kept), path))
    return rows


@contextlib.contextmanager
def unpacked(path: Path, known: Mapping[str, str], folder: Path | None, trust: bool) -> Iterator[Path]:
    """Give the folder that the trial of an episode is to be read from, for as long as the context lasts.

    It is ``folder`` itself (default: the folder of the episode) when everything lies there as it was recorded, and
    otherwise a temporary one.

    Args:
        path: of the episode.
        known: its metadata.
        folder: where files of the trial lie.
        trust: whether code that the episode holds may be run.

    Raises:
        EpisodeError: a file is damaged, was too large to be kept and is not there, or is code that is not trusted.
    """
    own = folder or path.parent
    rows = _rows(path, known)
    if all(row.lies_in(own) for row in rows):
        yield own
        return
    inside = _attached(path)
    with tempfile.TemporaryDirectory(prefix="crowdbot-") as place:
        for row in rows:
            target = Path(place, row.name)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(_content(path, own, row, inside, trust))
        yield Path(place)


def _rows(path: Path, known: Mapping[str, str]) -> list[Carried]:
    try:
        rows = [Carried(**row) for row in json.loads(known.get("files", "[]"))]
    except (ValueError, TypeError) as error:
        raise EpisodeError(f"{path} does not say which files belong to it: {error}") from None
    for row in rows:
        if not (isinstance(row.name, str) and _is_inside(row.name)):
            raise EpisodeError(f"{path} names a file outside its folder, {str(row.name)[:80]!r}; it is not read")
    return rows


def _content(path: Path, own: Path, row: Carried, inside: Mapping[str, bytes], trust: bool) -> bytes:
    if row.lies_in(own):
        return (own / row.name).read_bytes()
    if not row.kept or row.name not in inside:
        raise EpisodeError(
            f"{path} was recorded with the file {row.name!r} of {row.size} bytes, too large to be kept in it (at most"
            f" {MOST} bytes are), and it does not lie in {own} with the same bytes; put it there"
        )
    data = inside[row.name]
    if hashlib.blake2b(data, digest_size=16).hexdigest() != row.digest:
        raise EpisodeError(f"{path} is damaged: the file {row.name!r} in it is not the one that was recorded")
    if row.kind == CODE and not trust:
        raise EpisodeError(
            f"{path} needs the code {row.name!r}, which does not lie in {own}; the episode brings it, and runs it only"
            " when you pass --trust"
        )
    return data


def _attached(path: Path) -> dict[str, bytes]:
    """Return the files in an episode; they stand before its messages."""
    found = {}
    try:
        with path.open("rb") as stream:
            for kind, _, body in Tape(stream).records():
                if kind == Kind.ATTACHMENT:
                    name, data = attachment(body)
                    found[name] = data
                elif kind == Kind.CHUNK:
                    break
    except TapeError as error:
        raise EpisodeError(f"{path} is damaged: {error}") from None
    return found


def _is_inside(name: str) -> bool:
    """Whether a name stays in its folder, on any system."""
    parts = PurePosixPath(name).parts
    return bool(parts) and ".." not in parts and not name.startswith("/") and not set(name) & set("\\:\0")


def _digest(path: Path) -> str:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, lambda: hashlib.blake2b(digest_size=16)).hexdigest()
