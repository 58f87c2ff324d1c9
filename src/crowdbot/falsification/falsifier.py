"""Falsify: search a trial for failures of its navigator, and estimate how likely they are."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from crowdbot.calibration import resolve_search
from crowdbot.core import InputError, stream
from crowdbot.trials import blind_remarks, passage_remarks

from .failure import FailureCriterion, parse_failure
from .result import FalsificationResult, FoundFailure, find_clusters, select_failures, write_failures
from .sample import SampleRunner
from .search_space import SearchSpace
from .searches import CrossEntropy, DirectedSearch, PlainSampling, Sampling, Splitting

SAMPLINGS = (CrossEntropy, Splitting, PlainSampling)


def falsify(
    space: SearchSpace,
    failure: FailureCriterion | str = "collision",
    sampling: Sampling | None = None,
    *,
    runs: int = 1000,
    seed: int = 0,
    folder: Path | None = None,
    keep: int = 10,
    method: str = "own",
    workers: int = 1,
    cluster: str | None = None,
    progress: Callable[[float], None] | None = None,
) -> FalsificationResult:
    """Search for failures of the navigator of a trial.

    The result depends on the space, the failure, the sampling, the runs and the seed only, not on workers or
    interruptions.

    Args:
        space: the trial and what is varied.
        failure: when a run fails.
        sampling: the search (default: :class:`CrossEntropy`).
        runs: number of runs.
        seed: seed of the search.
        folder: folder of samples, from which an interrupted search continues, and of the trials found.
        keep: largest number of failures that are kept as trials.
        method: name of the navigator for the result.
        workers, cluster: as in :func:`crowdbot.core.each`.
        progress: called with the completed share, 0 to 1.

    Raises:
        InputError: a number is out of range, or the runs do not have the metric of the criterion.
        MissingExtra: the navigator or the cluster needs a package that is not installed.

    >>> from crowdbot.falsification import PlainSampling, SearchSpace, falsify, parse_factor
    >>> from crowdbot.trials import load_trial
    >>> trial = load_trial("frontal", duration=6.0)
    >>> space = SearchSpace(trial, (parse_factor("robot/y=uniform(-0.4, 0.4)"),))
    >>> result = falsify(space, "timeout", PlainSampling(), runs=4)
    >>> result.failures, result.clusters[0].event
    (4, 'timeout')
    """
    if runs < 2:
        raise InputError(f"runs = {runs} must be at least 2")
    if keep < 0:
        raise InputError(f"keep = {keep} failures must be at least 0")
    criterion = parse_failure(failure) if isinstance(failure, str) else failure
    search = sampling or CrossEntropy()
    parts = None if folder is None else folder / "parts"
    runner = SampleRunner(space, criterion, runs, parts, workers, cluster, progress)
    match = search.search(runner, stream(seed, "falsify"))
    samples = tuple(runner.samples)
    clusters = tuple(find_clusters(samples, match.weights))
    chosen = select_failures(clusters, keep)
    kept = [
        FoundFailure(
            k,
            next(n for n, cluster in enumerate(clusters, 1) if k in cluster.members),
            space.values(np.array(samples[k].point)),
        )
        for k in chosen
    ]
    if folder is not None:
        files = write_failures(space, samples, chosen, folder / "found")
        kept = [
            dataclasses.replace(item, file=f"found/{file.path.name}", same=file.same)
            for item, file in zip(kept, files, strict=True)
        ]
    return FalsificationResult(
        space.trial.name,
        method,
        criterion.text,
        search.title if isinstance(search, DirectedSearch) else search.name,
        seed,
        space.factors,
        samples,
        match.weights,
        match.levels,
        match.estimate,
        clusters,
        tuple(kept),
        Path(space.trial.robots[0].type).name if space.trial.robots else "",
        (*passage_remarks(space.trial), *blind_remarks(space.trial)),
    )


def parse_sampling(name: str, aim: str = "worst") -> Sampling:
    """Return a search by name: cross-entropy, splitting, plain, or a search of calibration.

    Args:
        name: name of the search, such as ``splitting``, ``cma-es`` or ``FILE.py:Class``.
        aim: ``worst`` or ``likely``, for a search of calibration.

    Raises:
        InputError: there is no such search.

    >>> parse_sampling("cma-es").title
    'cma-es'
    """
    for kind in SAMPLINGS:
        if kind.name == name:
            return kind()
    try:
        method = resolve_search(name)
    except InputError as error:
        own = ", ".join(kind.name for kind in SAMPLINGS)
        raise InputError(f"search {name!r} is unknown; known are {own}, and searches of calibration: {error}") from None
    return DirectedSearch(dataclasses.replace(method, tolerance=-math.inf), name, aim)
