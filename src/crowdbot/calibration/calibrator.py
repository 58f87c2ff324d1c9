"""Calibration of windows and of whole recordings with a scheme of model, goal, cost and search."""

from __future__ import annotations

import dataclasses
import hashlib
import pickle
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from crowdbot import models
from crowdbot.core import InputError, Scene, find_class, kebab_case, run_saved_jobs, source_digest, stream
from crowdbot.data import Recording, Windows
from crowdbot.models import CrowdModel, Goal, GroundTruth, goals
from crowdbot.typing import Floats, Ints

from .cost import Cost
from .fit import Fit
from .parameter_space import RADIUS, ParameterSpace
from .population_prior import PopulationPrior
from .rollout import Resimulation, Rollout
from .search import Search, SearchResult, TimeLimit


def resolve_model(value: CrowdModel | str) -> CrowdModel:
    """Return a crowd model from an instance, a name or an address, with default parameters."""
    return cast(CrowdModel, _resolve(value, models, CrowdModel))


def resolve_goal(value: Goal | str) -> Goal:
    """Return a goal from an instance, a name or an address, with default parameters."""
    return cast(Goal, _resolve(value, goals, Goal))


def goal_class(name: str) -> type[Goal]:
    """Return the class of a goal by its name or address."""
    return cast(type[Goal], find_class(name, goals, Goal))


def goal_for(name: str, recording: Recording) -> Goal:
    """Return a goal for a recording: with its true future, fitted to its learning part, or for its layout.

    Raises:
        InputError: the name is unknown, or the goal is learned and the recording has no learning part.
    """
    kind = goal_class(name)
    if issubclass(kind, GroundTruth):
        return GroundTruth(*recording.windows)
    if kind.learns:
        known = recording.layout is not None and recording.learn == 0.0
        return kind.at(recording.layout) if known and recording.layout else kind.learn(recording.learning_part)
    return resolve_goal(name)


def resolve_cost(value: Cost | str) -> Cost:
    """Return a cost from an instance, a name or an address."""
    return cast(Cost, _resolve(value, sys.modules[__package__ or ""], Cost))


def resolve_search(value: Search | str) -> Search:
    """Return a search from an instance, a name or an address, with default parameters."""
    return cast(Search, _resolve(value, sys.modules[__package__ or ""], Search))


def _resolve(value: object, room: ModuleType, contract: type) -> object:
    """Return the value itself, or an instance of the class with this name.

    Raises:
        InputError: the name is unknown, the class has no default values, or the value does not fulfil the contract.
    """
    if isinstance(value, str):
        kind = find_class(value, room, contract)
        try:
            return kind()
        except TypeError:
            raise InputError(
                f"{kebab_case(kind.__name__)} has no default values; pass an instance instead of the name"
            ) from None
    if not isinstance(value, contract):
        raise InputError(f"{value!r} is not a {contract.__name__} or the name of one")
    return value


Progress = Callable[[float], None]
Report = Callable[[int], None]
"""Callback with the number of completed evaluations (candidates times windows)."""

AGENTS_AT_ONCE = 200_000
"""Approximate number of agents (candidates x windows x people) in one batch."""
AGENTS_PER_CALL = 20_000
"""Approximate number of agents (candidates x windows x people x rows) per call; Ctrl-C waits for one call."""
CANDIDATES = 100
"""Expected number of candidates that a search evaluates at once."""


@dataclass(frozen=True)
class Calibrator:
    """Fits the parameters of a crowd to the observed rows of windows: a scheme is model x cost x search x goal.

    Each person has individual parameters and each window is a separate problem, unless the parameters are shared. The
    initial values are evaluated first, so a fit is never worse than they are.

    Fields:
        model, cost, search, goal: instances, or their names.
        budget: number of whole-crowd evaluations, per window or, if shared, in total.
        shared: one set of parameters for all people.
        free: names of the calibrated parameters: parameters of the model, ``radius``, ``preferred_speed`` (not if
            shared); empty means all.
        prior: distribution of the parameters in a population; unusual parameters have a penalty.
        radius: initial radius of people [m].
        substep: maximum time step of the simulation [s].

    Raises:
        InputError: a name is unknown, or the budget is below 1.

    >>> from crowdbot.data import Trajectories
    >>> rows = range(20)
    >>> tracks = Trajectories([7] * 20, rows, [0.5 * row for row in rows], [0.0] * 20, row_rate=2.5)
    >>> past, _ = tracks.windows(observe=8, predict=12)
    >>> fit = Calibrator("orca", budget=4, shared=True).fit(past, seed=0)
    >>> fit.shared, fit.persons, "time_horizon" in fit.table()
    (True, 1, True)
    """

    model: CrowdModel | str = "orca"
    cost: Cost | str = "progressive"
    search: Search | str = "genetic"
    goal: Goal | str = "current-direction"
    budget: int = 500
    shared: bool = False
    free: tuple[str, ...] = ()
    prior: PopulationPrior | None = None
    radius: float = RADIUS.default
    substep: float = 0.1

    def __post_init__(self) -> None:
        for name, value in (
            ("model", resolve_model(self.model)),
            ("cost", resolve_cost(self.cost)),
            ("search", resolve_search(self.search)),
            ("goal", resolve_goal(self.goal)),
        ):
            object.__setattr__(self, name, value)
        if self.budget < 1:
            raise InputError(f"calibration: budget = {self.budget} evaluations must be at least 1")
        if self.shared and self.prior is not None:
            raise InputError("calibration: a population prior requires individual parameters (shared=False)")
        _ = self.space, self.rollout  # raises an error for an unknown name or a wrong number

    @property
    def space(self) -> ParameterSpace:
        """The calibrated parameters."""
        return ParameterSpace(cast(CrowdModel, self.model), tuple(self.free), self.shared)

    @property
    def rollout(self) -> Rollout:
        """The crowd before the calibration."""
        model, goal = cast(CrowdModel, self.model), cast(Goal, self.goal)
        return Rollout(model, goal, self.radius, None, self.substep)

    @property
    def scheme(self) -> str:
        """Names of model, cost, search and goal."""
        return ", ".join(kebab_case(type(part).__name__) for part in (self.model, self.cost, self.search, self.goal))

    def fit(
        self,
        past: Windows | Sequence[Windows],
        seed: int = 0,
        progress: Progress | None = None,
        start: Fit | None = None,
        limit: TimeLimit | None = None,
    ) -> Fit:
        """Fit the parameters to the observed rows.

        Args:
            past: windows with at least two rows; the future is not used, unless the goal requires it. A shared fit
                accepts windows of several recordings.
            seed: seed of the search.
            progress: called with the completed share, 0 to 1.
            start: an earlier fit, for example of the previous frame; its values are evaluated early.
            limit: time at which the searches stop, whatever ``budget`` is.

        Raises:
            InputError: there are too few rows, or nobody can be compared.
        """
        pasts = [past] if isinstance(past, Windows) else list(past)
        if len(pasts) != 1 and not self.shared:
            raise InputError(
                f"calibration: {len(pasts)} recordings can only be fitted together with shared parameters; "
                "fit each alone, or pass shared=True"
            )
        if self.shared:
            fit = self._fit_all(pasts, stream(seed, "calibrate"), progress, limit)
        else:
            rngs = [stream(seed, "calibrate", w) for w in range(len(pasts[0]))]
            fit = self.fit_each(pasts[0], rngs, progress, start, limit)
        if fit.persons == 0:
            where = f"{fit.windows} windows of {', '.join(past.source for past in pasts) or 'no recording'}"
            raise InputError(
                f"calibration: nobody in {where} can be compared by {kebab_case(type(self.cost).__name__)};"
                " people must be observed at enough rows, and with others if the cost compares distances"
            )
        return fit

    def fit_each(
        self,
        past: Windows,
        rngs: Sequence[np.random.Generator],
        progress: Progress | None = None,
        start: Fit | None = None,
        limit: TimeLimit | None = None,
    ) -> Fit:
        """Fit individual parameters, window by window; ``rngs`` has one generator for each window.

        With a time limit, groups of windows that are searched together have equal times. Windows in which nobody can
        be compared keep the initial values and have the cost NaN.
        """
        space, begin = self.space, time.perf_counter()
        given = space.initial_values(past, self.rollout)
        starts = self._starts(past, given, start)
        size = max(1, AGENTS_AT_ONCE // (CANDIDATES * max(1, past.position.shape[2])))
        counted = np.zeros(past.id.shape, dtype=np.bool_)
        search_results: list[SearchResult] = []
        for first in range(0, len(past), size):
            part = slice(first, first + size)
            task = _Task(self, past[part], given[part], _part_of(progress, first, len(past), self.budget))
            search = cast(Search, self.search)
            own = None if limit is None else limit.share(-(-(len(past) - first) // size))
            search_results.append(
                search.minimize(task, space.low, space.high, list(rngs[part]), self.budget, starts[:, part], own)
            )
            counted[part] = task.counted
        return self._fit(search_results, given, past, counted, begin)

    def person_costs(self, past: Windows, values: Floats) -> Floats:
        """Return the costs ``[S, W, A]`` [m] of people for S sets of shared parameters ``[S, D]``; NaN without a cost.

        Raises:
            InputError: the windows have fewer than two rows.
        """
        task = _Task(self, past, self.space.initial_values(past, self.rollout), None)
        each = np.asarray(values, dtype=np.float64)[:, None, None]
        return task(each, np.arange(len(past)))

    def _fit_all(
        self, pasts: list[Windows], rng: np.random.Generator, progress: Progress | None, limit: TimeLimit | None
    ) -> Fit:
        space, begin = self.space, time.perf_counter()
        windows = sum(len(past) for past in pasts)
        parts: list[_Task] = []
        for past in pasts:
            size = max(1, AGENTS_AT_ONCE // max(1, past.position.shape[2]))
            given = space.initial_values(past, self.rollout)
            parts += [
                _Task(self, past[first : first + size], given[first : first + size], None)
                for first in range(0, len(past), size)
            ]
        task = _SharedTask(parts, _part_of(progress, 0, 1, self.budget))
        given = parts[0].given[:1, :1] if parts and parts[0].given.size else np.zeros((1, 1, len(space.names)))
        search = cast(Search, self.search)
        found = search.minimize(task, space.low, space.high, [rng], self.budget, given[None], limit)
        counted = [part.counted.ravel() for part in parts]
        nobody = np.zeros((0,), dtype=np.bool_)
        fit = self._fit([found], given, None, np.concatenate(counted or [nobody])[None], begin)
        return dataclasses.replace(fit, windows=windows)

    def _fit(
        self, found: list[SearchResult], given: Floats, past: Windows | None, counted: NDArray[np.bool_], begin: float
    ) -> Fit:
        def merge(name: str, empty: tuple[int, ...]) -> NDArray[Any]:
            return np.concatenate([getattr(one, name) for one in found] or [np.zeros(empty)])

        history = merge("history", (0, self.budget))
        return Fit(
            scheme=self.scheme,
            space=self.space,
            base=self.rollout,
            values=merge("best", given.shape),
            given=given,
            id=np.full(counted.shape, -1, dtype=np.int64) if past is None else past.id,
            counted=counted,
            cost=merge("cost", (0,)),
            given_cost=history[:, 0],
            evaluations=merge("evaluations", (0,)).astype(np.int64),
            history=history,
            seconds=time.perf_counter() - begin,
            windows=len(found) if past is None else len(past),
        )

    def _starts(self, past: Windows, given: Floats, start: Fit | None) -> Floats:
        """Return the start candidates ``[S, W, A, D]``: initial, of the previous frame, typical."""
        starts = [given]
        if start is not None:
            starts.append(start.values_of(past))
        if self.prior is not None:
            starts.append(self.prior.typical(self.space, given))
        starts.append(self.space.with_mean_speed(past, given))
        return np.stack(starts)


class _Task:
    """Objective of a search: cost of each person ``[P, L, A]`` for candidates ``[P, L, A, D]`` in windows ``[L]``.

    ``counted [W, A]`` is set by the first evaluation.
    """

    def __init__(self, calibrator: Calibrator, past: Windows, given: Floats, report: Report | None) -> None:
        if past.position.shape[1] < 2:
            raise InputError(f"calibration needs at least 2 observed rows, {past.source} has {past.position.shape[1]}")
        self.calibrator, self.space = calibrator, calibrator.space
        self.given, self.report = given, report
        self.resimulation = Resimulation(calibrator.rollout, past)
        self.counted = np.zeros(past.id.shape, dtype=np.bool_)
        self.done = 0

    def __call__(self, values: Floats, which: Ints) -> Floats:
        T, A = self.resimulation.past.position.shape[1:3]
        each = np.broadcast_to(values, (len(values), len(which), *values.shape[2:]))
        largest = max(1, AGENTS_PER_CALL // max(1, A * (T - 1)))
        length = min(max(1, len(which)), largest)
        size = max(1, largest // length)
        chunks = [
            [
                self._measure(each[first : first + size, begin : begin + length], which[begin : begin + length])
                for begin in range(0, max(1, len(which)), length)
            ]
            for first in range(0, len(values), size)
        ]
        cost = np.concatenate([np.concatenate(row, axis=1) for row in chunks])
        if self.calibrator.prior is not None:
            cost = cost + self.calibrator.prior.penalty(self.space, values, self.given[which])
        self.counted[which] |= np.any(~np.isnan(cost), axis=0)
        self.done += len(values) * len(which)
        if self.report is not None:
            self.report(self.done)
        return cost

    def _measure(self, values: Floats, which: Ints) -> Floats:
        A, D = self.given.shape[1:]
        everyone = np.broadcast_to(values, (len(values), len(which), A, D))

        def candidate(rollout: Rollout, scene: Scene, copies: int) -> tuple[Rollout, Scene]:
            # each parameter is contiguous: the models need it so
            each = np.repeat(np.moveaxis(everyone, -1, 0), copies, axis=2).reshape(D, len(scene.position), A)
            return self.space.apply_to_scene(rollout, scene, np.moveaxis(each, 0, -1))

        return cast(Cost, self.calibrator.cost).measure(self.resimulation.resimulate(candidate, len(values), which))


class _SharedTask:
    """Objective of a search for one shared set: mean cost of all people ``[P, 1, 1]``."""

    def __init__(self, parts: list[_Task], report: Report | None) -> None:
        self.parts = parts
        self.report = report
        self.done = 0

    def __call__(self, values: Floats, which: Ints) -> Floats:
        total, persons = np.zeros(len(values)), np.zeros(len(values), dtype=np.int64)
        for part in self.parts:
            cost = part(values, np.arange(len(part.given)))
            total += np.nansum(cost, axis=(1, 2))
            persons += np.sum(~np.isnan(cost), axis=(1, 2))
        self.done += len(values)
        if self.report is not None:
            self.report(self.done)
        mean = np.where(persons > 0, total / np.maximum(persons, 1), np.nan)
        return np.asarray(mean[:, None, None])


def _part_of(progress: Progress | None, first: int, whole: int, budget: int) -> Report | None:
    """Return a callback that reports the completed share, for a part that starts at window ``first``."""
    if progress is None:
        return None
    return lambda done: progress(min(1.0, (first + done / budget) / whole))


PIECES = 8
"""Minimum number of chunks of a recording."""
AGENTS = 2_000
"""Approximate number of people in a chunk, summed over its windows; an interrupted run loses at most a chunk."""


@dataclass(frozen=True)
class CalibrationChunk:
    """Calibration of the windows ``first`` to ``last`` (not included) of a recording.

    Fields:
        frame, people: ``[W]``, last observed frame of each window, and number of people present.
        arrays: arrays of :class:`Fit` by name.
    """

    first: int
    last: int
    frame: NDArray[np.int64]
    people: NDArray[np.int64]
    arrays: dict[str, NDArray[Any]]


@dataclass(frozen=True)
class RecordingCalibration:
    """The calibration of a recording with a scheme.

    Fields:
        recording: the recording; only observed rows are used, unless the goal requires the future.
        calibrator: calibrator with individual parameters; ``goal`` replaces its goal, if given.
        goal: name of a goal that depends on the recording, see :func:`goal_for`.
        seed: seed of the search; each window has its own random stream.
    """

    recording: Recording
    calibrator: Calibrator
    goal: str | None = None
    seed: int = 0

    @property
    def goal_calibrator(self) -> Calibrator:
        """The calibrator with the goal of this recording."""
        if self.goal is None:
            return self.calibrator
        return dataclasses.replace(self.calibrator, goal=goal_for(self.goal, self.recording))

    @property
    def key(self) -> str:
        """Hash of all inputs that determine the result."""
        content = pickle.dumps((source_digest(), self, self.recording.digest))
        return hashlib.blake2b(content, digest_size=12).hexdigest()

    @property
    def past(self) -> Windows:
        """The windows used for the calibration."""
        return self.recording.windows[0]

    def run(self, workers: int = 1, cluster: str | None = None, keep: Path | None = None) -> Iterator[CalibrationChunk]:
        """Yield finished chunks; chunks stored in the folder ``keep`` come first."""
        past = self.past
        people = int(past.present[:, -1].sum())
        size = max(1, min(len(past) // PIECES, AGENTS * len(past) // max(1, people)))
        jobs = [(self, first, min(first + size, len(past))) for first in range(0, len(past), size)]
        files = [] if keep is None else [keep / f"{self.key}-{first}.npz" for _, first, _ in jobs]
        for _, chunk in run_saved_jobs(_calibrate_chunk, jobs, files, _save, _load, workers, cluster):
            yield chunk

    def merge(self, chunks: Sequence[CalibrationChunk]) -> Fit:
        """Return the fit of the whole recording from all its chunks."""
        ordered = sorted(chunks, key=lambda chunk: chunk.first)
        calibrator = self.goal_calibrator
        whole = {name: np.concatenate([chunk.arrays[name] for chunk in ordered]) for name in ordered[0].arrays}
        seconds = float(whole.pop("seconds").sum())
        return Fit(
            calibrator.scheme, calibrator.space, calibrator.rollout, **whole, seconds=seconds, windows=len(self.past)
        )


ARRAYS = ("values", "given", "id", "counted", "cost", "given_cost", "evaluations", "history")


def _calibrate_chunk(job: tuple[RecordingCalibration, int, int]) -> CalibrationChunk:
    campaign, first, last = job
    past = campaign.past[first:last]
    rngs = [stream(campaign.seed, "calibrate", window) for window in range(first, last)]
    fit = campaign.goal_calibrator.fit_each(past, rngs)
    arrays = {name: getattr(fit, name) for name in ARRAYS}
    arrays["seconds"] = np.array([fit.seconds])
    return CalibrationChunk(first, last, past.frame[:, -1], past.present[:, -1].sum(axis=1), arrays)


def _save(chunk: CalibrationChunk, file: Path) -> None:
    with file.open("wb") as stream_:
        bounds = np.array([chunk.first, chunk.last])
        arrays: dict[str, Any] = {"bounds": bounds, "frame": chunk.frame, "people": chunk.people, **chunk.arrays}
        np.savez_compressed(stream_, **arrays)


def _load(file: Path) -> CalibrationChunk:
    with file.open("rb") as stream_, np.load(stream_, allow_pickle=False) as kept:
        first, last = kept["bounds"].tolist()
        arrays = {name: kept[name] for name in (*ARRAYS, "seconds")}
        return CalibrationChunk(first, last, kept["frame"], kept["people"], arrays)
