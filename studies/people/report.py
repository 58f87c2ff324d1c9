"""Report of a fit: errors on experiments that were left out, the Pareto set, and the profile of each parameter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crowdbot.core import stream
from crowdbot.typing import Floats

from .experiments import FOLDS, RecordedExperiment
from .fit import BOX, WEIGHTS, Candidate, PopulationFit

__all__ = ["SetProfile", "fit_report", "fold_rows", "pareto_set", "profile_sets"]


BINS = 6
"""Parts of the range of a parameter."""
RESAMPLES = 500


@dataclass(frozen=True)
class SetProfile:
    """Lowest cost over parts of the range of a parameter, among all candidates of the searches.

    Fields:
        name: the searched value.
        best: its value in the chosen candidate.
        middle: middles of the parts of the range.
        above: lowest cost in each part less that of the chosen candidate; NaN without a candidate.
        interval: range of the parts whose cost is not significantly above (95 %, bootstrap over experiments).
    """

    name: str
    best: float
    middle: tuple[float, ...]
    above: tuple[float, ...]
    interval: tuple[float, float]

    @property
    def identified(self) -> str:
        """``yes``, ``no``, or the side without a limit."""
        low, high = BOX[self.name]
        below, over = self.interval[0] > low + 1e-9, self.interval[1] < high - 1e-9
        if below and over:
            return "yes"
        return "no" if not below and not over else "not from below" if over else "not from above"


def pareto_set(candidates: Sequence[Candidate], experiments: Sequence[RecordedExperiment]) -> list[Candidate]:
    """Return the candidates that no other one beats in all objectives, by cost."""
    values = np.array([candidate.objectives(experiments) for candidate in candidates])
    kept = [
        k for k, own in enumerate(values) if not np.any(np.all(values <= own, axis=1) & np.any(values < own, axis=1))
    ]
    return sorted((candidates[k] for k in kept), key=lambda one: one.cost(experiments))


def fold_rows(fit: PopulationFit, before: Candidate) -> list[tuple[int, Candidate, Floats, Floats]]:
    """Return, for each fold, the best candidate without it, its objectives there, and those of another candidate.

    The choice among the stored candidates uses the other folds only.
    """
    rows: list[tuple[int, Candidate, Floats, Floats]] = []
    for fold in range(FOLDS):
        own = [e for e in fit.experiments if e.fold == fold]
        if not own:
            continue
        best = fit.best(fold)
        rows.append((fold, best, np.array(best.objectives(own)), np.array(before.objectives(own))))
    return rows


def profile_sets(fit: PopulationFit, chosen: Candidate) -> list[SetProfile]:
    """Return the profile of each searched value: parts of its range that no candidate brings near the chosen one."""
    candidates = fit.candidates()
    costs = _costs(candidates, fit.experiments)
    k = next(i for i, candidate in enumerate(candidates) if candidate is chosen)
    set_profiles = []
    for name, (low, high) in BOX.items():
        edges = np.linspace(low, high, BINS + 1)
        part = np.clip(np.digitize([candidate.values[name] for candidate in candidates], edges) - 1, 0, BINS - 1)
        above, kept = [], []
        for b in range(BINS):
            own = np.flatnonzero(part == b)
            if not len(own):
                above.append(float("nan"))
                continue
            best = own[int(np.argmin(costs[own, 0]))]
            above.append(float(costs[best, 0] - costs[k, 0]))
            if np.percentile(costs[best, 1:] - costs[k, 1:], 2.5) <= 0.0 or best == k:
                kept.append(b)
        ends = (float(edges[min(kept)]), float(edges[max(kept) + 1])) if kept else (low, high)
        middle = tuple(float(edge) for edge in 0.5 * (edges[1:] + edges[:-1]))
        set_profiles.append(SetProfile(name, chosen.values[name], middle, tuple(above), ends))
    return set_profiles


def _costs(candidates: Sequence[Candidate], experiments: Sequence[RecordedExperiment]) -> Floats:
    """Return the costs ``[N, 1 + RESAMPLES]``: of all experiments, and of bootstrap samples of them within kinds."""
    rng = stream(0, "population", "profile")
    kinds: dict[str, list[str]] = {}
    for experiment in experiments:
        kinds.setdefault(experiment.kind, []).append(experiment.name)
    total = np.zeros((len(candidates), 1 + RESAMPLES, 3))
    for names in kinds.values():
        values = np.array([[candidate.tracks[name] for name in names] for candidate in candidates])
        drawn = rng.integers(0, len(names), (RESAMPLES, len(names)))
        total[:, 0] += values.mean(axis=1) / len(kinds)
        total[:, 1:] += values[:, drawn].mean(axis=2) / len(kinds)
    penalty = np.array([candidate.crowd.penalty for candidate in candidates])
    return np.asarray(total @ np.asarray(WEIGHTS[:3]) + WEIGHTS[3] * penalty[:, None])


def fit_report(fit: PopulationFit, before: Candidate) -> str:
    """Return the tables of a fit as Markdown.

    Args:
        fit: a fit with candidates.
        before: the candidate that it is compared with.
    """
    best = fit.best()
    return "\n".join([*_left_out(fit, before), "", *_pareto(fit), "", *_profiles(profile_sets(fit, best))])


def _left_out(fit: PopulationFit, before: Candidate) -> list[str]:
    lines = [
        "| experiments left out | error after 0.4 s | error over 4.8 s | times to collision | before: 0.4 s | 4.8 s"
        " | times to collision |",
        "|---|---|---|---|---|---|---|",
    ]
    for fold, _, own, old in fold_rows(fit, before):
        names = ", ".join(e.name for e in fit.experiments if e.fold == fold)
        cells = [f"{item:.3f}" for item in (*own[:3], *old[:3])]
        lines.append(f"| {names} | {' | '.join(cells)} |")
    return lines


def _pareto(fit: PopulationFit) -> list[str]:
    lines = [
        "| cost | 0.4 s | 4.8 s | times to collision | single file [m/s] | corridor [m/s] | flow [1/(m s)] | queues |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for item in pareto_set(fit.candidates(), fit.experiments)[:12]:
        early, mean, ttc, _ = item.objectives(fit.experiments)
        crowd = item.crowd
        lines.append(
            f"| {item.cost(fit.experiments):.3f} | {early:.3f} | {mean:.3f} | {ttc:.2f} | {crowd.single_file:.2f}"
            f" | {crowd.corridor:.2f} | {crowd.flow:.2f} | {crowd.queues[0]:.0f}, {crowd.queues[1]:.0f} |"
        )
    return lines


def _profiles(profiles: Sequence[SetProfile]) -> list[str]:
    lines = [
        "| value | chosen | 95 % | identified | lowest cost above the chosen, over its range |",
        "|---|---|---|---|---|",
    ]
    for profile in profiles:
        above = ", ".join("-" if np.isnan(v) else f"{v:.2f}" for v in profile.above)
        name = profile.name.replace("_", " ")
        low, high = profile.interval
        lines.append(f"| {name} | {profile.best:.3g} | {low:.3g} to {high:.3g} | {profile.identified} | {above} |")
    return lines
