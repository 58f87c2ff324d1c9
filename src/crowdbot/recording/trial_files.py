"""Trials as files that run by themselves: the XML with copies of the files that it names beside it."""

from __future__ import annotations

import shutil
from pathlib import Path, PurePosixPath

from crowdbot.core import Element, explain_write_errors, format_xml, parse_xml, relative_name
from crowdbot.trials import Trial, trial_xml

from .attachments import named_files


def write_trial_files(trial: Trial, path: Path) -> None:
    """Write a trial with copies of its files beside it; the copies of files outside its folder have names inside.

    Args:
        trial: the trial, with its folder.
        path: the XML to write; the copies go into its folder.

    Raises:
        InputError: a file cannot be written.
    """
    with explain_write_errors(path):
        base = (trial.folder or Path.cwd()).resolve()
        sources = [source.resolve() for _, source in named_files(trial).values()]
        for source in sources:
            copy = path.parent / _name_inside(source, base)
            copy.parent.mkdir(parents=True, exist_ok=True)
            if copy.resolve() != source:
                shutil.copyfile(source, copy)
        root = parse_xml(trial_xml(trial).encode(), path.name)
        _rename(root, base, {place for source in sources for place in (source, *source.parents)} - {base})
        path.write_text(format_xml(root), encoding="utf-8")


def _name_inside(place: Path, base: Path) -> str:
    """Return the name of a file or folder relative to the trial; from outside, one that says how far outside."""
    parts = PurePosixPath(relative_name(place, base)).parts
    ups = parts.count("..")
    if not ups and not PurePosixPath(*parts).is_absolute():
        return "/".join(parts)
    return "/".join([f"outside{ups or ''}", *(part for part in parts if part not in ("..", "/"))])


def _rename(element: Element, base: Path, copied: set[Path]) -> None:
    """Let attributes that name a file, folder or code outside the folder of the trial name the copy."""
    for name, value in element.attributes.items():
        place, colon, code = value.rpartition(":")
        for text, rest in ((value, ""), (place, colon + code)):
            if (target := _outside(text, base)) in copied:
                element.attributes[name] = _name_inside(target, base) + rest
    for child in element.children:
        _rename(child, base, copied)


def _outside(text: str, base: Path) -> Path:
    """Return the place that a text names, or the folder of the trial if it names none outside of it."""
    try:
        place = (base / text).resolve()
    except (OSError, ValueError):  # too long for a name
        return base
    return base if base.is_relative_to(place) or place.is_relative_to(base) else place
