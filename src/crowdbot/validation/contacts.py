"""Contacts of people in built-in trials, by crowd model."""

from __future__ import annotations

import dataclasses
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crowdbot.measurement import mean_over_starts
from crowdbot.models import (
    ORCA,
    VBM,
    VOG,
    Boids,
    CrowdModel,
    GroupForce,
    Heuristics,
    PLEdestrians,
    SocialForce,
    Tangent,
    with_headway,
)
from crowdbot.simulation import Episode, simulate_seeds
from crowdbot.trials import Trial, load_trial

from .rimea import CORRIDOR_TIME
from .scenario import Report

CONTACT_TRIALS = (
    "crossing-flows",
    "two-way",
    "perpendicular-flow",
    "one-way-against",
    "square-crossing",
    "circle-crossing",
    "random-goals",
)
"""Built-in trials with less than 1 person/m2, from head-on to crossing and one-way flows."""
TOUCH = 1e-3
"""Bodies that overlap by more than this [m] are in contact; bodies with a smaller distance than this graze."""
LARGEST_OVERLAP = 0.02
"""Allowed overlap [m]."""
LARGEST_SHARE = 1e-3
"""Allowed share of the walking time in contact."""


@dataclass(frozen=True)
class ContactSummary:
    """Contacts of a model in one trial.

    Fields:
        trial: name of the trial.
        overlap: largest overlap of two people in any run [m].
        share: mean share of the time in contact over the runs; with its 95 % interval ``low`` to ``high``.
        grazing: mean share of the time nearer than 1 mm, contacts included; models without a margin pass like this.
        entries: number of people who were placed on somebody else. Such pairs count from the first instant at which
            they are apart, since a placement is not a motion of the model.
        starts: number of runs.
    """

    trial: str
    overlap: float
    share: float
    low: float
    high: float
    grazing: float
    entries: int
    starts: int

    @property
    def passed(self) -> bool:
        """Return whether overlap and share are allowed."""
        return self.overlap < LARGEST_OVERLAP and self.share < LARGEST_SHARE

    def as_dict(self) -> dict[str, Any]:
        """Return the fields and ``passed`` for JSON."""
        return {**dataclasses.asdict(self), "passed": self.passed}


def measure_contacts(model: CrowdModel, trial: Trial | str, seeds: Sequence[int], seconds: float) -> ContactSummary:
    """Run a trial with a model in place of its own and return the contacts between people.

    All runs are environments of one simulation. Contacts with robots are not counted, they depend on the navigator.

    Args:
        model: crowd model, at its defaults or not.
        trial: a trial or the name of a built-in one.
        seeds: one run for each.
        seconds: duration of the runs [s].

    Raises:
        TrialError: the trial is impossible with the model.

    >>> from crowdbot.models import ORCA
    >>> measure_contacts(ORCA(), "circle-crossing", range(2), 2.0).overlap
    0.0
    """
    given = load_trial(trial) if isinstance(trial, str) else trial
    episodes = simulate_seeds(dataclasses.replace(given, crowd=model, duration=seconds), list(seeds))
    found = [_contacts(episode) for episode in episodes]
    share = mean_over_starts([row.contact / max(row.total, 1) for row in found])
    grazing = float(np.mean([row.near / max(row.total, 1) for row in found]))
    deepest, entries = max(row.deepest for row in found), sum(row.entries for row in found)
    low, high = (share.mean, share.mean) if share.starts == 1 else (share.low, share.high)
    return ContactSummary(given.name, deepest, share.mean, low, high, grazing, entries, share.starts)


class _ContactCount(NamedTuple):
    """Largest overlap [m], person-steps in contact, near and in total, and the number of bad entries."""

    deepest: float
    contact: int
    near: int
    total: int
    entries: int


def _contacts(episode: Episode) -> _ContactCount:
    """Return the contacts of people in a run."""
    kept = np.ones(episode.active.shape[1], dtype=np.bool_)
    kept[list(episode.robots)] = False
    here, place = episode.active[:, kept], episode.position[:, kept]
    radius = np.broadcast_to(episode.radius, episode.active.shape)[:, kept]
    apart = np.zeros((here.shape[1], here.shape[1]), dtype=np.bool_)
    before = np.zeros(here.shape[1], dtype=np.bool_)
    deepest, contact, near, entries = 0.0, 0, 0, 0
    for k in range(len(here)):
        pair = here[k][:, None] & here[k] & ~np.eye(here.shape[1], dtype=np.bool_)
        away = place[k][:, None] - place[k]
        gap = np.where(pair, np.hypot(away[..., 0], away[..., 1]) - radius[k][:, None] - radius[k], np.inf)
        new = here[k] & ~before
        entries += int(np.any((gap < -TOUCH) & new[:, None], axis=1).sum())
        apart = pair & ((apart & ~(new[:, None] | new)) | (gap > 0.0))
        gap = np.where(apart, gap, np.inf)
        deepest = max(deepest, -float(gap.min(initial=np.inf)))
        contact += int(np.any(gap < -TOUCH, axis=1).sum())
        near += int(np.any(gap < TOUCH, axis=1).sum())
        before = here[k]
    return _ContactCount(deepest, contact, near, int(here.sum()), entries)


STARTS = 20
"""Runs of each model in each trial."""
CONTACT_SECONDS = 20.0

SLIDING: dict[str, Any] = {"headway_sliding": 1.0, "headway_time_gap": 0.3}
"""Values of the headway layer with which people neither walk through each other nor follow at a distance."""
_STAYS = (
    "the default stays that of the original, and trials, episodes and fits name it without its parameters; `{}` with"
    ' headway-sliding="1" headway-time-gap="0.3" has no contacts'
)
_REASONS = {
    "boids": "it has no contact force; overlaps are rare, below 0.01 % of the time",
    "social-force": "the default is the force of 1995, which does not depend on radii and vanishes on the line of a"
    ' neighbour\'s stride; strength="8" distance="0.5" look-ahead="0.5" keeps contacts below 0.01 %',
    "vbm": "the default gain of 1 is that of the paper: the cost of a wrong speed is so flat that a person alone does"
    ' not reach the free speed in 40 m, and the model has no contacts; gain="10" needs 32.7 s, gain="20" 32.1 s for'
    " 40 m, but overlaps remain with both",
    "group-force": "the measured interaction of 2009 has no contact force; it acts between centres, and people in dense"
    " crossings overlap",
    "orca": "the model leaves no margin: people slide along each other at a distance of 0, and where no velocity is"
    " free of collisions it takes the least overlap",
    "pledestrians": "it chooses among the velocities that ORCA permits, see orca",
    "tangent": "it avoids the next collision only and has no contact force",
    "vog": "it samples velocities, and takes the least bad one where all collide",
    "heuristics": "the contact force of the paper acts only once bodies overlap",
}
CONTACT_REASONS = {
    **{name: f"{why}; {_STAYS.format(name + '+headway')}" for name, why in _REASONS.items()},
    "vbm": f'{_REASONS["vbm"]}; {_STAYS.format("vbm+headway")} and, with gain="20", needs 32.1 s',
    "social-force, strength 8, distance 0.5, look-ahead 0.5": "forces do not depend on radii; overlaps are rare, below"
    " 0.01 % of the time",
    "vbm, gain 20": "the model has no contacts",
    "escape-panic": "people press against each other in contact, as the model intends",
}
"""Sentence for each model that exceeds a limit."""

OTHER_VALUES: dict[str, CrowdModel] = {
    "social-force, strength 8, distance 0.5, look-ahead 0.5": SocialForce(strength=8.0, distance=0.5, look_ahead=0.5),
    "vbm, gain 20": VBM(gain=20.0),
    "social-force+headway, sliding": with_headway(SocialForce)(**SLIDING),
    "vbm+headway, sliding, gain 20": with_headway(VBM)(**{"gain": 20.0, **SLIDING}),
    "orca+headway, sliding": with_headway(ORCA)(**SLIDING),
    "pledestrians+headway, sliding": with_headway(PLEdestrians)(**SLIDING),
    "group-force+headway, sliding": with_headway(GroupForce)(**SLIDING),
    "vog+headway, sliding": with_headway(VOG)(**SLIDING),
    "heuristics+headway, sliding": with_headway(Heuristics)(**SLIDING),
    "tangent+headway, sliding": with_headway(Tangent)(**SLIDING),
    "boids+headway, sliding": with_headway(Boids)(**SLIDING),
}
"""Other parameters, and the headway layer, for the models that exceed a limit at their defaults, as further rows."""

Rows = dict[str, dict[str, Any]]


def compare_contacts(
    models: Mapping[str, CrowdModel],
    file: Path,
    report: Report,
    trials: Sequence[str] = CONTACT_TRIALS,
    starts: int = STARTS,
    seconds: float = CONTACT_SECONDS,
) -> Rows:
    """Measure all models in all trials and the time for 40 m; each result is stored, so that a run can be resumed.

    Args:
        models: models by name in the table.
        file: JSON file of the results.
        report: called with the completed fraction.
        trials: names of built-in trials.
        starts: seeds 0 to starts - 1.
        seconds: duration of a run [s].

    Raises:
        TrialError: a trial is impossible with a model.
    """
    rows = _read(file)
    todo = [(name, trial) for name in models for trial in (*trials, "rimea-1")]
    for k, (name, trial) in enumerate(todo):
        settings = f"{models[name]!r} {starts} {seconds:g}"
        row = rows.setdefault(name, {})
        if row.get(trial, {}).get("settings") != settings:
            if trial == "rimea-1":
                alone = CORRIDOR_TIME.run(models[name], (0,), False, lambda share: None)[0]
                found = {**alone, "passed": CORRIDOR_TIME.judge(alone).passed}
            else:
                found = measure_contacts(models[name], trial, range(starts), seconds).as_dict()
            row[trial] = {**found, "settings": settings}
            _write(file, rows)
        report((k + 1) / len(todo))
    return {name: rows[name] for name in models}


def write_contact_page(rows: Rows, path: Path, command: str, reasons: Mapping[str, str]) -> Path:
    """Write the table as a Markdown page and return its path.

    Args:
        rows: results of :func:`compare_contacts`.
        path: file of the page.
        command: command that makes the page.
        reasons: sentence for each model that does not meet a limit.
    """
    trials = [trial for trial in next(iter(rows.values())) if trial != "rimea-1"]
    text = [
        "# Contacts and free walking of each crowd model",
        "",
        "Each model moves the people of built-in trials with less than 1 person/m2, and one person in an empty"
        f" corridor. Limits: overlaps below {100.0 * LARGEST_OVERLAP:g} cm, contacts below {LARGEST_SHARE:.1%} of the"
        " time, 26 to 34 s for 40 m (RiMEA 1). This page is generated by:",
        "",
        f"```\n{command}\n```",
        "",
        "Cells: largest overlap of any two people [cm], and share of the"
        " walking time in contact (overlaps of more than 1 mm) with the 95 % bootstrap interval of its mean over"
        " starts. People who are placed on others count from the first instant at which they are apart. ✗: a limit is"
        " exceeded. The JSON file also has the share of the time at a distance below 1 mm (`grazing`).",
        "",
        f"| model | starts | 40 m [s] | {' | '.join(trials)} | |",
        f"|---|---|---|{'---|' * len(trials)}---|",
    ]
    for name, row in rows.items():
        walk = row["rimea-1"]
        time = f"{walk['seconds']:.1f}" if walk["seconds"] is not None else "more than 60"
        cells = [_cell(row[trial]) for trial in trials]
        passed = all(item["passed"] for item in row.values())
        text.append(
            f"| {name} | {row[trials[0]]['starts']} | {time} | {' | '.join(cells)} | {'✓' if passed else '✗'} |"
        )
    failed = [name for name, row in rows.items() if not all(item["passed"] for item in row.values())]
    text += ["", "## Why a model exceeds a limit", ""]
    text += [f"* **{name}**: {reasons.get(name, 'not explained yet')}." for name in failed] or ["No model does."]
    path.write_text("\n".join(text) + "\n", encoding="utf-8")
    return path


def _cell(found: Mapping[str, Any]) -> str:
    share = f"{100.0 * found['share']:.2f} % ({100.0 * found['low']:.2f} to {100.0 * found['high']:.2f})"
    return (
        f"{100.0 * found['overlap']:.1f}, {share if found['share'] > 0.0 else '0 %'}{'' if found['passed'] else ' ✗'}"
    )


def _read(file: Path) -> Rows:
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}  # missing or incomplete file: start again
    return kept if isinstance(kept, dict) and all(isinstance(row, dict) for row in kept.values()) else {}


def _write(file: Path, rows: Rows) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    draft = file.with_suffix(".part")
    draft.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    os.replace(draft, file)
