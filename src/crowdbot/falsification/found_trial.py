"""Found failures as trial files that run by themselves."""

from __future__ import annotations

import dataclasses
import shutil
import warnings
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from crowdbot.core import Element, explain_write_errors, format_xml, parse_xml, relative_name
from crowdbot.recording import named_files
from crowdbot.simulation import RunFailureWarning, simulate
from crowdbot.trials import Trial, load_trial, trial_xml

from .cluster import FailureCluster
from .sample import Sample
from .search_space import SearchSpace

__all__ = ["FoundTrial", "select_failures", "write_failures", "write_trial_files"]


class FoundTrial(NamedTuple):
    """A failure in a file.

    Fields:
        path: the trial.
        sample: index of the run.
        same: whether the trial in the file gives the digest of the run.
    """

    path: Path
    sample: int
    same: bool


def select_failures(clusters: Sequence[FailureCluster], most: int) -> list[int]:
    """Return the failures to keep: the most likely one of each cluster, then the worst ones."""
    found = [cluster.likely for cluster in clusters] + [cluster.worst for cluster in clusters]
    return [*dict.fromkeys(found)][:most]


def write_failures(
    space: SearchSpace, samples: Sequence[Sample], chosen: Sequence[int], folder: Path
) -> list[FoundTrial]:
    """Write failures to ``1.xml``, ``2.xml`` and so on, with the files that they need, and run each once.

    Files of an earlier search in the folder are replaced.

    Args:
        space: the search space.
        samples: all samples.
        chosen: indices of the failures.
        folder: where to write.

    Raises:
        InputError: a file cannot be written.
    """
    found = []
    with explain_write_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
        for old in folder.glob("*.xml"):
            if old.stem.isdecimal():
                old.unlink()
        for number, k in enumerate(chosen, 1):
            sample, path = samples[k], folder / f"{number}.xml"
            variant = space.variant_of(sample.point)
            name = f"{variant.name[:60]}, failure {number}"
            write_trial_files(dataclasses.replace(variant, seed=sample.seed, name=name), path)
            found.append(FoundTrial(path, k, _digest(path) == sample.digest))
    return found


def write_trial_files(trial: Trial, path: Path) -> None:
    """Write a trial with copies of its files beside it; the copies of files outside its folder have names inside."""
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


def _digest(path: Path) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RunFailureWarning)
        return simulate(load_trial(str(path))).digest
