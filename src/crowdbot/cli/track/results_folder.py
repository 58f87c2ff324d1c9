"""Results of ``crowdbot track --out``: the tracks as recordings, and the scores."""

from __future__ import annotations

import argparse
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import json_text

if TYPE_CHECKING:
    from crowdbot.perception import Tracks

    Run = tuple[str, int | None]
    """``tracker`` or ``detector, tracker``, and the seed of the trial."""


def write_results(folder: Path, tracks: Mapping[Run, Sequence[Tracks]], summary: Mapping[str, Any]) -> list[Path]:
    """Write ``tracks.csv``, or a file for each tracker and run, and ``scores.json``; return the files.

    Args:
        folder: the folder; it is made.
        tracks: tracks after each reading, by run.
        summary: content of ``scores.json``.

    Raises:
        InputError: a file cannot be written.
    """
    from crowdbot.core import explain_write_errors
    from crowdbot.evaluation import write_tracks

    with explain_write_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
        files = [write_tracks(tracks[key], folder / name) for key, name in _names(list(tracks)).items()]
        scores = folder / "scores.json"
        scores.write_text(json_text(summary) + "\n", encoding="utf-8")
    return [*files, scores]


def plots(options: argparse.Namespace) -> list[Path]:
    """Return the files of the plot: ``tracks.png`` in the folder of ``--out``, and that of ``--plot``."""
    files = [] if options.out is None else [options.out / "tracks.png"]
    return files if options.plot is None else [*files, options.plot]


def _names(keys: list[Run]) -> dict[Run, str]:
    """Return a name of a file for each tracker and seed, of the parts in which they differ."""
    labels, seeds = ({key[item] for key in keys} for item in (0, 1))
    names: dict[Run, str] = {}
    for label, seed in keys:
        parts = [re.sub(r"[^\w-]+", "-", label).strip("-")] if len(labels) > 1 else []
        parts += [f"seed-{seed}"] if len(seeds) > 1 else []
        stem = "-".join(["tracks", *parts])
        name, count = f"{stem}.csv", 2
        while name in names.values():
            name, count = f"{stem}-{count}.csv", count + 1
        names[label, seed] = name
    return names
