"""Contacts of people in built-in trials, by crowd model: overlaps and the share of time in contact."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from crowdbot.measurement import mean_over_starts
from crowdbot.models import CrowdModel
from crowdbot.simulation import Episode, simulate_seeds
from crowdbot.trials import Trial, load_trial

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
