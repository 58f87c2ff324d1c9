"""Does the plan of a robot lower the error of forecasts? Pairs of errors by person, in CITR and in built-in trials."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

import crowdbot as cb
from citr_runs import cart_windows, citr_runs
from crowdbot.core import InputError
from crowdbot.data import Windows
from crowdbot.prediction import AnchorNet, Predictor, Simulated
from crowdbot.prediction.anchor_net.reaction_fit import ReactionSamples, fit_reaction

Row = dict[str, Any]
Job = tuple[str, Callable[[], Row]]
Case = tuple[str, Windows, Windows]
"""Name of a run, past with plan and radii, and future."""

NEAR = 2.0
"""People whose future passes the robot within this distance [m] count."""
GAIN = 0.05
"""Gain whose detection is given as power."""
ROOM = 0.3
"""Distance to the surface of a robot that people keep [m], as in the shipped reaction."""
STEP = 0.4
TRIALS = (
    "frontal", "intersection", "overtaking", "pedestrian-obstruction", "one-way-against", "perpendicular-flow",
    "circle-crossing", "random-goals", "crowdnav-circle-10", "crowdnav-square-10",
)  # fmt: skip
"""Built-in trials with a robot among people who see it, none of whose crowds the reaction was fitted to."""
SEEDS = range(100, 104)


def cart_rows(data: Path, predictor: Predictor) -> Row:
    """Return the row of a predictor in CITR."""
    return paired_rows(citr(data), predictor)


def left_out_cart_rows(data: Path, net: AnchorNet, work: Path) -> Row:
    """Return the row of AnchorNet in CITR with a reaction learned from the other runs."""
    return left_out_rows([*citr(data)], net, work)


def built_in_rows(name: str, predictor: Predictor) -> Row:
    """Return the row of a predictor in a built-in trial."""
    return paired_rows(trial_runs(name), predictor)


def jobs(data: Path, work: Path) -> Iterator[Job]:
    """Yield the jobs: predictors in CITR, AnchorNet in built-in trials; ``work`` is a folder for fits."""
    net = AnchorNet("open")
    for name, predictor in {"AnchorNet": net, "AnchorNet, all": AnchorNet("all")}.items():
        yield f"CITR: {name}", partial(cart_rows, data, predictor)
    yield "CITR: AnchorNet, reaction learned from the other runs", partial(left_out_cart_rows, data, net, work)
    for model in ("orca", "social-force", "power-law"):
        crowd = Simulated(model, substep=0.05, contact=0.0)
        yield f"CITR: {model}", partial(cart_rows, data, crowd)
    for trial in TRIALS:
        yield f"trial {trial}: AnchorNet", partial(built_in_rows, trial, net)


def citr(data: Path) -> Iterator[Case]:
    """Yield the runs of CITR with a cart."""
    for people, cart in citr_runs(data):
        try:
            yield people.stem, *cart_windows(people, cart)
        except InputError:  # the run is too short
            continue


def trial_runs(name: str) -> Iterator[Case]:
    """Yield runs of a built-in trial with new seeds; the plan of its robots is where they drive."""
    for seed in SEEDS:
        episode = cb.run(cb.load_trial(name, duration=20), seed=seed)
        try:
            past, future = episode.tracks(STEP).windows()
        except InputError:  # nobody is there long enough
            continue
        known = future.robot & future.present.all(axis=1)
        plan = np.where(known[:, None, :, None], future.position, np.nan)
        sizes = np.broadcast_to(episode.radius, episode.active.shape)[0]
        order = np.argsort(episode.ids)
        rank = np.minimum(np.searchsorted(episode.ids[order], past.id), len(order) - 1)
        radius = np.where(past.id >= 0, sizes[order[rank]], np.nan)
        yield f"{name}-{seed}", dataclasses.replace(past, plan=plan, radius=radius), future


def variants(predictor: Predictor) -> dict[str, tuple[Predictor, bool, bool]]:
    """Return the compared rows: predictor, whether it knows the plan, and the radii."""
    if not isinstance(predictor, AnchorNet):
        return {"without plan": (predictor, False, False), "plan": (predictor, True, False)}
    unmoved = dataclasses.replace(predictor, reaction="none")
    return {
        "without plan": (predictor, False, False), "plan, without reaction": (unmoved, True, False),
        "plan and radii, without reaction": (unmoved, True, True), "plan": (predictor, True, False),
        "plan and radii": (predictor, True, True),
    }  # fmt: skip


def person_errors(
    case: Case, predictor: Predictor, plan: bool, radii: bool, near: bool = True
) -> dict[tuple[str, int], list[float]]:
    """Return the errors [m] of the single trajectory by run and person, one for each window.

    Args:
        case: run.
        predictor: predictor.
        plan, radii: whether it knows them.
        near: people who pass a robot within :data:`NEAR`, or all others.
    """
    name, past, future = case
    assert past.plan is not None
    rows = future.position.shape[1]
    drive = past.plan[:, :rows]
    away = np.linalg.norm(future.position[:, :, :, None] - drive[:, :, None], axis=-1)
    close = np.where(np.isnan(away), np.inf, away).min(axis=(1, 3)) < NEAR
    window, person = np.nonzero(future.scored & (close if near else ~close))
    seen = dataclasses.replace(past, plan=past.plan if plan else None, radius=past.radius if radii else None)
    error = np.linalg.norm(predictor.predict(seen, rows).position[:, 0] - future.position, axis=-1).mean(axis=1)
    result: dict[tuple[str, int], list[float]] = {}
    for w, a in zip(window, person, strict=True):
        result.setdefault((name, int(past.id[w, a])), []).append(float(error[w, a]))
    return result


def paired_rows(cases: Iterable[Case], predictor: Predictor) -> Row:
    """Return the mean errors of people near a robot, and their differences to those without a plan."""
    kept = [*cases]
    asked = variants(predictor)
    found = {what: _mean_errors(kept, how, True) for what, how in asked.items()}
    row = {what: paired(found["without plan"], values) for what, values in found.items()}
    if isinstance(predictor, AnchorNet):
        far = {what: _mean_errors(kept, asked[what], False) for what in ("without plan", "plan and radii")}
        row |= {f"{what}, farther than 2 m": paired(far["without plan"], values) for what, values in far.items()}
    return row


def _mean_errors(cases: list[Case], how: tuple[Predictor, bool, bool], near: bool) -> np.ndarray:
    errors: dict[Any, list[float]] = {}
    for case in cases:
        errors |= person_errors(case, *how, near)
    return np.array([np.mean(own) for own in errors.values()])


def left_out_rows(cases: list[Case], net: AnchorNet, work: Path) -> Row:
    """Return the errors with a reaction that was learned from all other runs, near the robot and elsewhere."""
    unmoved = dataclasses.replace(net, reaction="none")
    samples = [ReactionSamples.of(unmoved, past, future, ROOM) for _, past, future in cases]
    row: Row = {}
    for place, near in (("", True), (", farther than 2 m", False)):
        found = []
        for number, case in enumerate(cases):
            file = work / f"plan-reaction-{number}.npz"
            numbers: dict[str, Any] = fit_reaction(samples[:number] + samples[number + 1 :], ROOM).numbers()
            np.savez(file, **numbers)
            own = dataclasses.replace(net, reaction=str(file))
            found.append([_mean_errors([case], how, near) for how in ((net, False, False), (own, True, True))])
            file.unlink()
        before, after = (np.concatenate(values) for values in zip(*found, strict=True))
        row |= {f"without plan{place}": paired(before, before), f"plan and radii{place}": paired(before, after)}
    return row


def paired(before: np.ndarray, after: np.ndarray) -> Row:
    """Return means, the paired difference with its 95 % interval, and the power to find a gain of 5 %."""
    if len(before) < 2:
        return {"people": len(before), "ADE": float(after.mean()) if len(after) else None, "power": None}
    away = after - before
    error = away.std(ddof=1) / np.sqrt(len(away))
    bound = stats.t.ppf(0.975, len(away) - 1)
    low, high = away.mean() - error * bound, away.mean() + error * bound
    row = {"people": len(away), "ADE": after.mean(), "difference": away.mean(), "low": low, "high": high}
    if error == 0.0:
        return row | {"power": None}
    reach = GAIN * before.mean() / error
    return row | {"power": float(1.0 - stats.nct.cdf(bound, len(away) - 1, reach))}
