"""Found failures as trial files that run by themselves."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import explain_write_errors
from crowdbot.recording import write_trial_files
from crowdbot.simulation import RunFailureWarning, simulate
from crowdbot.trials import load_trial

from .cluster import FailureCluster
from .sample import Sample
from .search_space import SearchSpace


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


def _digest(path: Path) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RunFailureWarning)
        return simulate(load_trial(str(path))).digest
