"""What the policy is trained on: trials with their share of the environments, and its inputs as an observation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.gym.action_form import ActionForm
from crowdbot.gym.crowd_task import CrowdTask
from crowdbot.gym.observation_form import ObservationForm
from crowdbot.gym.reward import Reward
from crowdbot.navigation import OWN_VALUES, PERSON_VALUES, ObservationBatch, policy_inputs
from crowdbot.trials import load_trial

__all__ = ["PolicyObservation", "TrainingTask", "standard_tasks"]

Arrays = dict[str, NDArray[np.float32]]


@dataclass(frozen=True)
class PolicyObservation(ObservationForm):
    """The inputs of the navigator ``policy`` as an observation.

    ``own`` has the values of the robot, ``people`` a row for each person, nearest first, ``present`` their number, and
    ``turn`` cosine and sine of the direction of the waypoint from the heading.

    >>> PolicyObservation(max_people=5).shapes(beams=0)
    {'own': (6,), 'people': (5, 11), 'present': (1,), 'turn': (2,)}
    """

    def shapes(self, beams: int) -> dict[str, tuple[int, ...]]:
        """Return the shape of each part for one environment."""
        people = (self.max_people, len(PERSON_VALUES))
        return {"own": (len(OWN_VALUES),), "people": people, "present": (1,), "turn": (2,)}

    def arrays(self, batch: ObservationBatch, scan: Any) -> Arrays:
        """Return the parts ``[N, ...]`` as float32."""
        found = policy_inputs(batch, self.max_people)
        cos, sin = np.cos(batch.pose[:, 2]), np.sin(batch.pose[:, 2])
        ax, ay = found.axis.T
        turn = np.stack([cos * ax + sin * ay, cos * ay - sin * ax], axis=1)
        parts = {"own": found.own, "people": found.people, "present": found.present[:, None], "turn": turn}
        return {name: value.astype(np.float32) for name, value in parts.items()}


@dataclass(frozen=True)
class TrainingTask:
    """A trial with its number of environments.

    Fields:
        trial: a built-in name or a trial file, whose robot moves in every direction.
        environments: number of environments.
        values: values by path for the trial, such as ``{"people": 10}``.

    Raises:
        InputError: there is no environment.
    """

    trial: str
    environments: int
    values: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.environments < 1:
            raise InputError(f"task {self.trial!r}: environments = {self.environments} must be at least 1")

    def crowd_task(self, reward: Reward) -> CrowdTask:
        """Return the task with the inputs of the policy and holonomic actions.

        Raises:
            InputError: the trial has no robot that moves in every direction.
        """
        trial = load_trial(self.trial, self.values)
        if not trial.robots or not trial.robots[0].holonomic:
            raise InputError(f'task {self.trial!r}: the first robot must have holonomic="true"')
        people = sum(one.count for one in trial.spawners) + len(trial.agents) + len(trial.robots) - 1
        people += sum(one.max_count or 20 for one in trial.sources)
        form = PolicyObservation("people", max_people=max(1, min(people, 20)))
        return CrowdTask(trial, form, ActionForm("holonomic"), reward)


def standard_tasks(environments: int = 256) -> tuple[TrainingTask, ...]:
    """Return CrowdNav's crossings with 1 to 20 people and several densities, seen by people and unseen.

    Args:
        environments: approximate number of all environments.

    >>> sum(task.environments for task in standard_tasks(256))
    256
    """
    shares: tuple[tuple[str, float, dict[str, Any]], ...] = (
        ("crowdnav-circle-5", 112, {}),
        ("crowdnav-circle-10", 64, {}),
        ("crowdnav-square-10", 56, {"people": 8}),
        ("crowdnav-circle-20", 24, {"radius": 6.0}),
    )
    count = [max(1, round(share * environments / 256)) for _, share, _ in shares]
    return tuple(TrainingTask(name, n, values) for n, (name, _, values) in zip(count, shares, strict=True))
