"""Attachments: files that a trial refers to, stored in its episode for replay on another machine.

Maps, areas and recorded people lie in the folder of a trial, and so may code of navigators, sensors and models. An
episode holds them as MCAP attachments; those that are too large, or lie outside the folder, are only named. It knows
the digest of each. Data are used as they were recorded. Code runs from beside the episode when it has the bytes that
were recorded; other code, and code that only the episode holds, runs when it is trusted.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

from crowdbot.core import EpisodeError, relative_name, sources_of
from crowdbot.data import McapError, McapOpcode, McapReader, read_attachment
from crowdbot.trials import (
    RandomizedModel,
    Trial,
    code_references,
    is_area_file,
    is_code,
    map_files,
    outline,
    resolve_file,
)

__all__ = [
    "AttachedFile",
    "SkippedAttachmentWarning",
    "UnpackedFiles",
    "collect_attachments",
    "named_files",
    "skip_message",
    "unpack_attachments",
]

MOST = 64 << 20
"""Maximum total size of the files in an episode [bytes]."""
DATA, CODE = "data", "code"


class SkippedAttachmentWarning(UserWarning):
    """Files that a trial names are not kept in its recording."""


@dataclass(frozen=True)
class AttachedFile:
    """A file that belongs to an episode.

    Fields:
        name: as the trial has it, relative to its folder.
        kind: ``data`` or ``code``.
        size: [bytes].
        digest: of its bytes.
        kept: whether the episode holds it; otherwise it was too large, or lies outside the folder.
    """

    name: str
    kind: str
    size: int
    digest: str
    kept: bool

    @property
    def inside(self) -> bool:
        """Whether it lies in the folder of the trial."""
        return _is_inside(self.name)

    @property
    def code(self) -> bool:
        """Whether Python may run it, whatever the episode says of its kind."""
        return self.kind == CODE or is_code(self.name)

    def is_in(self, folder: Path) -> bool:
        """Whether a file of this name is there, seen from a folder."""
        try:
            return (folder / self.name).is_file()
        except (OSError, ValueError):
            return False

    def lies_in(self, folder: Path) -> bool:
        """Whether it is there with these bytes, seen from a folder."""
        path = folder / self.name
        return self.is_in(folder) and path.stat().st_size == self.size and _digest(path) == self.digest


class UnpackedFiles(NamedTuple):
    """The folder to read the trial of an episode from, and the code there that is not the recorded one."""

    folder: Path
    changed: tuple[str, ...] = ()


def named_files(trial: Trial) -> dict[str, tuple[str, Path]]:
    """Return kind and place of every file that a trial names, by its name as seen from the folder of the trial.

    An element that refers to other files lists them in a method ``files() -> tuple[Path, ...]``.

    Raises:
        InputError: one is missing.
    """
    found: dict[str, tuple[str, Path]] = {}
    stage = trial.stage
    if stage.area and is_area_file(stage.area):
        found[stage.area] = DATA, resolve_file(stage.area, stage.folder, stage.trust)
    if stage.map:
        for name, path in map_files(stage.map, stage.folder, stage.trust).items():
            found[name] = DATA, path
    for one in trial.recorded:
        found[one.data] = DATA, resolve_file(one.data, one.folder, one.trust)
    for thing in _parts(trial):
        if hasattr(thing, "files"):
            for path in thing.files():
                if "__pycache__" not in path.parts:  # made by Python from what is kept anyway
                    found[relative_name(path, trial.folder)] = CODE if is_code(path.name) else DATA, path
        for path in sources_of(type(thing)):
            found[relative_name(path, trial.folder)] = CODE, path
    return dict(sorted(found.items()))


def _parts(thing: Any) -> Iterator[Any]:
    """Yield an element and everything in it, the plugs too."""
    yield thing
    cls: type = type(thing)
    for part in outline(cls):
        value = getattr(thing, part.name)
        if part.role in ("plugged", "mounted"):
            yield value.model if isinstance(value, RandomizedModel) else value
        elif part.role == "child" and value is not None:
            yield from _parts(value)
        elif part.role == "children":
            for one in part.into.spread(value) if part.into else value:
                yield from _parts(one)


def collect_attachments(trials: Iterable[Trial]) -> list[tuple[AttachedFile, Path]]:
    """Return the files of trials with their places, and which of them an episode keeps."""
    named: dict[str, tuple[str, Path]] = {}
    for trial in trials:
        named = named_files(trial) | named
    rows, total = [], 0
    for name, (kind, path) in named.items():
        size = path.stat().st_size
        kept = _is_inside(name) and total + size <= MOST
        total += size if kept else 0
        rows.append((AttachedFile(name, kind, size, _digest(path), kept), path))
    return rows


def skip_message(rows: Iterable[AttachedFile]) -> str:
    """Return a sentence about the files that an episode does not keep, empty when there are none."""
    gone = [row for row in rows if not row.kept]
    if not gone:
        return ""
    parts = []
    for why, ones in (
        ("outside the folder of the trial", [row.name for row in gone if not row.inside]),
        (f"too large, at most {MOST} bytes are kept together", [row.name for row in gone if row.inside]),
    ):
        more = f" and {len(ones) - 3} more" if len(ones) > 3 else ""
        parts += [f"{', '.join(map(repr, ones[:3]))}{more} ({why})"] if ones else []
    return (
        f"the recording leaves out {' and '.join(parts)}: it replays only where files with the same bytes lie at the"
        " same places as seen from its folder (or from --folder), not from the file alone; move what lies outside into"
        " the folder of the trial, or take the files along"
    )


@contextlib.contextmanager
def unpack_attachments(
    path: Path, known: Mapping[str, str], folder: Path | None, trust: bool
) -> Iterator[UnpackedFiles]:
    """Give the folder that the trial of an episode is to be read from, for as long as the context lasts.

    It is ``folder`` itself (default: the folder of the episode) when everything lies there as it was recorded, and
    otherwise a temporary one.

    Args:
        path: of the episode.
        known: its metadata.
        folder: where files of the trial lie.
        trust: whether code may be run that the episode holds or that is not the recorded one, and whether files may
            lie outside the folder.

    Raises:
        EpisodeError: a file is damaged, is not kept and not there, or is outside or code that is not trusted.
    """
    own = folder or path.parent
    rows = _rows(path, known)
    for row in rows:
        if not row.inside:
            _check_outside(path, own, row, trust)
    changed = tuple(row.name for row in rows if row.code and trust and row.is_in(own) and not row.lies_in(own))
    if all(row.lies_in(own) or row.name in changed for row in rows):
        if not trust:
            _check_named(path, own, known, rows)
        yield UnpackedFiles(own, changed)
        return
    inside = _attached(path)
    with tempfile.TemporaryDirectory(prefix="crowdbot-") as top:
        place = _deep(Path(top), [row.name for row in rows])
        for row in rows:
            target = Path(os.path.normpath(place / row.name))
            if not target.is_relative_to(top):  # it has an absolute name and is there
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            if row.inside:
                target.write_bytes(_content(path, own, row, inside, trust))
            else:
                shutil.copyfile(own / row.name, target)
        yield UnpackedFiles(place, changed)


def _deep(top: Path, names: Iterable[str]) -> Path:
    """Return a new folder in ``top`` from which none of the relative names leads out of ``top``."""
    ups = [Path(os.path.normpath(name)).parts.count("..") for name in names]
    place = top.joinpath(*["trial"] * max([1, *ups]))
    place.mkdir(parents=True)
    return place


def _rows(path: Path, known: Mapping[str, str]) -> list[AttachedFile]:
    try:
        rows = [AttachedFile(**row) for row in json.loads(known.get("files", "[]"))]
    except (ValueError, TypeError) as error:
        raise EpisodeError(f"{path} does not say which files belong to it: {error}") from None
    for row in rows:
        if not isinstance(row.name, str) or (row.kept and not row.inside) or not row.name.strip("\0"):
            raise EpisodeError(f"{path} names a file outside its folder, {str(row.name)[:80]!r}; it is not read")
    return rows


def _check_outside(path: Path, own: Path, row: AttachedFile, trust: bool) -> None:
    what = f"the file {row.name[:80]!r}, which lies outside the folder of its trial"
    if not trust:
        raise EpisodeError(f"{path} needs {what}; pass --trust to allow it")
    if not row.is_in(own):
        raise EpisodeError(
            f"{path} was recorded with {what} and is not kept in the episode, and there is none, seen from {own}; put"
            " it there, or say with --folder where the trial lies"
        )
    if not row.code and not row.lies_in(own):
        raise EpisodeError(
            f"{path} was recorded with {what} and is not kept in the episode, and the one there, seen from {own}, has"
            " other bytes than the recorded one; bring that back"
        )


def _check_named(path: Path, own: Path, known: Mapping[str, str], rows: Iterable[AttachedFile]) -> None:
    """Refuse code that the trial names but of which the episode does not say what was recorded."""
    sure = {(own / row.name).resolve() for row in rows if row.code}
    for name in code_references(known, own):
        if (own / name).resolve() not in sure:
            raise EpisodeError(
                f"{path} needs the code {name[:80]!r} and does not say with which bytes it was recorded; the one in"
                f" {own} runs only when you pass --trust"
            )


def _content(path: Path, own: Path, row: AttachedFile, inside: Mapping[str, bytes], trust: bool) -> bytes:
    if row.lies_in(own) or (row.code and trust and row.is_in(own)):
        return (own / row.name).read_bytes()
    if row.code and row.is_in(own) and not trust:
        raise EpisodeError(
            f"{path} needs the code {row.name!r}, and the one in {own} has other bytes than the recorded one; bring"
            " that back, or pass --trust to run the one that is there"
        )
    if not row.kept or row.name not in inside:
        raise EpisodeError(
            f"{path} was recorded with the file {row.name!r} of {row.size} bytes, too large to be kept in it (at most"
            f" {MOST} bytes are), and it does not lie in {own} with the same bytes; put it there"
        )
    data = inside[row.name]
    if hashlib.blake2b(data, digest_size=16).hexdigest() != row.digest:
        raise EpisodeError(f"{path} is damaged: the file {row.name!r} in it is not the one that was recorded")
    if row.code and not trust:
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
            for kind, _, body in McapReader(stream).records():
                if kind == McapOpcode.ATTACHMENT:
                    name, data = read_attachment(body)
                    found[name] = data
                elif kind == McapOpcode.CHUNK:
                    break
    except McapError as error:
        raise EpisodeError(f"{path} is damaged: {error}") from None
    return found


def _is_inside(name: str) -> bool:
    """Whether a name stays in its folder, on any system."""
    parts = PurePosixPath(name).parts
    return bool(parts) and ".." not in parts and not name.startswith("/") and not set(name) & set("\\:\0")


def _digest(path: Path) -> str:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, lambda: hashlib.blake2b(digest_size=16)).hexdigest()
