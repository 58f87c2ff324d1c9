"""Profiles of the values of a preset: how far each one can move before the errors rise; errors of left-out folds."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot.core import stream
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats

from .crowd_values import CrowdValues, measure_crowds
from .experiments import FOLDS, KINDS, RecordedExperiment
from .fit import WEIGHTS
from .track_errors import keep_velocity, measure_tracks, ttc_distance

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["RANGES", "ValueProfile", "ValueStudy", "draw_profiles", "study_values", "write_study"]


RANGES: dict[str, tuple[float, float]] = {
    "headway_time_gap": (1.2, 2.2),
    "headway_anticipation": (0.3, 1.2),
    "headway_width": (0.4, 0.8),
    "headway_taper": (0.4, 1.0),
    "headway_oncoming": (0.2, 1.0),
    "headway_sidestep": (0.1, 0.8),
    "headway_step_back": (0.0, 0.4),
    "strength": (3.0, 12.0),
    "range": (0.02, 0.12),
    "oncoming": (0.0, 1.0),
    "wall_strength": (0.5, 6.0),
    "wall_range": (0.01, 0.08),
}
"""Values of the preset that a fit chooses, and the range of their profiles."""
AT_ONCE = 12
"""Sets that are simulated together."""
RESAMPLES = 1000
NOISE = WEIGHTS[3]
"""Differences of the cost below one tolerance of the crowds do not count: crowds have one start."""
SMALLEST = 1e-6
"""Smallest error that others are compared with [m]."""


@dataclass(frozen=True)
class ValueProfile:
    """Cost over the range of one value, all others as in the preset.

    Fields:
        name: the value.
        shipped: its value in the preset.
        values, cost, low, high: the values, the cost less that of the preset, and its 95 % interval (bootstrap over
            experiments within their kinds).
        tracks: part of ``cost`` that recorded tracks have; the rest is that of whole crowds.
        interval: smallest and largest value whose cost is not significantly above the lowest of the profile, with a
            margin of :data:`NOISE`.
    """

    name: str
    shipped: float
    values: tuple[float, ...]
    cost: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    tracks: tuple[float, ...]
    interval: tuple[float, float]

    @property
    def identified(self) -> str:
        """``yes``, ``no``, or the side on which the data set no limit in the range of the profile."""
        below, above = self.interval[0] > self.values[0], self.interval[1] < self.values[-1]
        if below and above:
            return "yes"
        return "no" if not below and not above else "not from below" if above else "not from above"


@dataclass(frozen=True)
class ValueStudy:
    """Sets of values around a preset with their errors.

    Fields:
        names: names of the experiments.
        kinds, folds: kind and fold of each.
        sets: the sets; the first is the preset, each other one differs in one value.
        tracks: ``[S, E, 3]`` errors after 0.4 s and over all rows relative to constant velocity, and distance of the
            times to collision.
        crowds: values of whole crowds of each set.
    """

    names: tuple[str, ...]
    kinds: tuple[str, ...]
    folds: tuple[int, ...]
    sets: tuple[dict[str, float], ...]
    tracks: Floats
    crowds: tuple[CrowdValues, ...]

    def costs(self) -> tuple[Floats, Floats, Floats]:
        """Return the costs ``[S]``, their part of tracks ``[S]``, and bootstrap draws of the costs ``[S, R]``."""
        each = self.tracks @ np.asarray(WEIGHTS[:3])
        crowd = WEIGHTS[3] * np.array([crowd.penalty for crowd in self.crowds])
        rng = stream(0, "population", "values")
        mean, drawn = np.zeros(len(each)), np.zeros((len(each), RESAMPLES))
        groups = [[k for k, kind in enumerate(self.kinds) if kind == wanted] for wanted in KINDS]
        groups = [group for group in groups if group]
        for own in groups:
            mean += each[:, own].mean(axis=1) / len(groups)
            drawn += each[:, own][:, rng.integers(0, len(own), (RESAMPLES, len(own)))].mean(axis=2) / len(groups)
        return mean + crowd, mean, drawn + crowd[:, None]

    def profiles(self) -> list[ValueProfile]:
        """Return the profile of each value."""
        cost, tracks, drawn = self.costs()
        value_profiles = []
        for name in RANGES:
            own = [0, *(k for k, set_ in enumerate(self.sets) if set_[name] != self.sets[0][name])]
            own.sort(key=lambda k: self.sets[k][name])
            best = min(own, key=lambda k: cost[k])
            kept = [k for k in own if np.percentile(drawn[k] - drawn[best], 2.5) <= NOISE]
            ends = np.percentile(drawn[own] - drawn[0], (2.5, 97.5), axis=1)
            values = [self.sets[k][name] for k in own]
            columns = [tuple(map(float, row)) for row in (cost[own] - cost[0], *ends, tracks[own] - tracks[0])]
            limits = values[own.index(kept[0])], values[own.index(kept[-1])]
            above, low, high, part = columns
            value_profiles.append(ValueProfile(name, self.sets[0][name], tuple(values), above, low, high, part, limits))
        return value_profiles

    def fold_errors(self) -> list[tuple[int, list[str], Floats, Floats]]:
        """Return, for each fold, its experiments, the errors of the preset there, and those of the best other set.

        The best set is chosen on the other folds, so its errors are those of experiments that it has not seen. Errors
        are means over the experiments of the fold.
        """
        cost = self.tracks @ np.asarray(WEIGHTS[:3])
        penalty = WEIGHTS[3] * np.array([crowd.penalty for crowd in self.crowds])
        rows = []
        for fold in range(FOLDS):
            out = np.array([item == fold for item in self.folds])
            if not np.any(out) or np.all(out):
                continue
            best = int(np.argmin(cost[:, ~out].mean(axis=1) + penalty))
            names = [name for name, left in zip(self.names, out, strict=True) if left]
            rows.append((fold, names, self.tracks[0, out].mean(axis=0), self.tracks[best, out].mean(axis=0)))
        return rows

    def markdown(self) -> str:
        """Return the tables of folds and of profiles."""
        lines = ["| experiments left out | 0.4 s | 4.8 s | times to collision | chosen without them: 0.4 s | 4.8 s |"
                 " times to collision |", "|---|---|---|---|---|---|---|"]  # fmt: skip
        rows = self.fold_errors()
        for _, names, own, other in rows:
            lines.append(f"| {', '.join(names)} | {' | '.join(f'{item:.3f}' for item in (*own, *other))} |")
        if rows:
            means = np.mean([np.concatenate([own, other]) for *_, own, other in rows], axis=0)
            lines.append(f"| mean | {' | '.join(f'{item:.3f}' for item in means)} |")
        head = (
            "| value | preset | 95 % | identified | cost above the preset, from low to high values | of which tracks |"
        )
        lines += ["", head, "|---|---|---|---|---|---|"]
        for profile in self.profiles():
            cells = [", ".join(f"{v:.2f}" for v in row) for row in (profile.cost, profile.tracks)]
            low, high = profile.interval
            name = profile.name.replace("_", " ")
            lines.append(
                f"| {name} | {profile.shipped:g} | {low:.3g} to {high:.3g} | {profile.identified}"
                f" | {cells[0]} | {cells[1]} |"
            )
        return "\n".join(lines)


def study_values(
    model: CrowdModel,
    experiments: Sequence[RecordedExperiment],
    points: int,
    state: Path,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> ValueStudy:
    """Measure a preset and sets that differ from it in one value; measured sets are stored, so a run can be resumed.

    Args:
        model: the preset.
        experiments: recorded experiments.
        points: values of each profile besides that of the preset, at equal distances over :data:`RANGES`.
        state: file of the measured sets (JSON lines); sets of another preset or other experiments are not in it.
        report: called with the numbers of measured sets and of all sets.
    """
    shipped = {name: float(getattr(model, name)) for name in RANGES}
    sets = [shipped]
    for name, ends in RANGES.items():
        sets += [{**shipped, name: float(v)} for v in np.linspace(*ends, points).round(4) if v != shipped[name]]
    constant = [keep_velocity(experiment) for experiment in experiments]
    known = {}
    if state.exists():
        known = {row["key"]: row for row in map(json.loads, state.read_text(encoding="utf-8").splitlines())}
    todo = [set_ for set_ in sets if _key(set_) not in known]
    for begin in range(0, len(todo), AT_ONCE):
        report(len(sets) - len(todo) + begin, len(sets))
        for row in _measure(model, todo[begin : begin + AT_ONCE], experiments, constant):
            known[row["key"]] = row
            with state.open("a", encoding="utf-8") as out:
                out.write(json.dumps(row) + "\n")
    rows = [known[_key(set_)] for set_ in sets]
    return ValueStudy(
        tuple(experiment.name for experiment in experiments),
        tuple(experiment.kind for experiment in experiments),
        tuple(experiment.fold for experiment in experiments),
        tuple(sets),
        np.array([row["tracks"] for row in rows]),
        tuple(CrowdValues(*row["crowd"]) for row in rows),
    )


def draw_profiles(study: ValueStudy) -> Figure:
    """Return a plot of the cost over the range of each value, with its interval and the value of the preset."""
    from matplotlib.figure import Figure

    profiles = study.profiles()
    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    axes = figure.subplots(2, -(-len(profiles) // 2), sharey=True, squeeze=False)
    for axis, profile in zip(axes.flat, profiles, strict=False):
        axis.axvspan(*profile.interval, color="0.9", lw=0)
        axis.fill_between(profile.values, profile.low, profile.high, color="tab:blue", alpha=0.25, lw=0)
        axis.plot(profile.values, profile.cost, ".-", color="tab:blue", label="all")
        axis.plot(profile.values, profile.tracks, ":", color="tab:orange", label="tracks alone")
        axis.axvline(profile.shipped, color="0.3", lw=0.8)
        axis.axhline(0.0, color="0.3", lw=0.5)
        axis.set_xlabel(profile.name.replace("_", " "))
        axis.set_ylim(-0.1, 0.6)
    for axis in axes.flat[len(profiles) :]:
        axis.axis("off")
    for axis in axes[:, 0]:
        axis.set_ylabel("cost above the preset")
    axes.flat[0].legend(frameon=False, fontsize=8)
    return figure


def write_study(study: ValueStudy, page: Path, head: str) -> None:
    """Write the tables with a heading as a page, and the plot beside it."""
    page.write_text(f"{head}\n{study.markdown()}\n\n![Profiles]({page.stem}.png)\n", encoding="utf-8")
    draw_profiles(study).savefig(page.with_suffix(".png"), dpi=110)


def _measure(
    model: CrowdModel,
    sets: Sequence[Mapping[str, float]],
    experiments: Sequence[RecordedExperiment],
    constant: Sequence[tuple[float, float]],
) -> list[dict[str, Any]]:
    tracks: list[list[tuple[float, float, float]]] = [[] for _ in sets]
    for experiment, (early, mean) in zip(experiments, constant, strict=True):
        errors = measure_tracks(model, sets, experiment)
        distance = ttc_distance(errors.ttc, errors.ttc_real)
        for k, row in enumerate(tracks):
            near, far = errors.early[k].mean() / max(early, SMALLEST), errors.mean[k].mean() / max(mean, SMALLEST)
            row.append((float(near), float(far), float(distance[k])))
    crowds = measure_crowds(model, sets)
    return [
        {"key": _key(set_), "tracks": own, "crowd": crowd}
        for set_, own, crowd in zip(sets, tracks, crowds, strict=True)
    ]


def _key(values: Mapping[str, float]) -> str:
    return " ".join(f"{name}={value:.6g}" for name, value in values.items())
