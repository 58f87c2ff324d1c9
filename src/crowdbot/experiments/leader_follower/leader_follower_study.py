"""The study of leaders and followers: coordination in each trial."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from crowdbot.experiments.comparison import (
    COLORS,
    EmulatedPerson,
    Measure,
    RecordedTrial,
    Study,
    TrialMeasures,
    read_trial_latency,
)
from crowdbot.metrics import coordination
from crowdbot.typing import Floats

from .emulated_participant import EmulatedParticipant
from .leading import Roles, roles_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class LeaderFollowerStudy(Study):
    """A robot or the participant leads, the other one keeps the distance.

    In virtual reality a participant sees the robot as late as the latency of the picture, and is seen as late as that
    of the motion. ``own_lag`` is the lag without the medians of both.

    >>> LeaderFollowerStudy().measures["lag"].title
    'lag of the follower [s]'
    """

    name: ClassVar[str] = "leader-follower"
    title: ClassVar[str] = "Leader and follower"
    about: ClassVar[str] = "Displacements along the line of the two, in the first trial of each condition."
    measures: ClassVar[Mapping[str, Measure]] = MappingProxyType(
        {
            "distance": Measure("mean distance [m]", 0.1),
            "distance_sd": Measure("standard deviation of the distance [m]", 0.05),
            "lag": Measure("lag of the follower [s]", 0.1),
            "own_lag": Measure("lag of a following participant without latency of motion and picture [s]", 0.1),
            "gain": Measure("gain at the frequency of the leader [1]", 0.1),
            "phase": Measure("phase at the frequency of the leader [rad]", 0.1),
        }
    )

    def evaluate(self, recorded: RecordedTrial) -> tuple[dict[str, float], dict[str, str], dict[str, Floats]]:
        """Return the coordination of the two; the avatar is the last person before the robots.

        Raises:
            InputError: it is not a leader-follower trial, or the leader does not move.
        """
        episode, roles = recorded.episode, roles_of(recorded.trial)
        late = episode.times >= recorded.settling
        robot = episode.position[late, episode.robots[0]]
        person = episode.position[late, episode.robots[0] - 1]
        times = episode.times[late]
        leader, follower = (robot, person) if roles.robot_leads else (person, robot)
        found = coordination(times, leader, times, follower)
        values = {k: float(v) for k, v in found._asdict().items()} | _own_lag(recorded, roles, found.lag)
        axis = follower.mean(axis=0) - leader.mean(axis=0)
        axis /= max(float(np.hypot(*axis)), 1e-9)
        leading, following = ((track - track.mean(axis=0)) @ axis for track in (leader, follower))
        curves = {"times": times, "leading": leading, "following": following}
        return values, {"leader": roles.leader}, curves

    def draw(self, trials: Sequence[TrialMeasures]) -> Figure:
        """Return the motion of leader and follower in the first trial of each condition."""
        import matplotlib.pyplot as plt

        first = {trial.condition: trial for trial in reversed(trials)}
        shown = [first[name] for name in dict.fromkeys(trial.condition for trial in trials)]
        figure, axes = plt.subplots(len(shown), 1, figsize=(9.0, 1.9 * len(shown)), sharex=True, squeeze=False)
        for axis, trial in zip(axes[:, 0], shown, strict=True):
            times, leading, following = (trial.curves[name] for name in ("times", "leading", "following"))
            axis.plot(times, leading, color=COLORS[0], label=f"leader ({trial.labels['leader']})")
            axis.plot(times, following, color=COLORS[1], linestyle="--", label="follower")
            axis.set_title(f"{trial.condition}, participant {trial.participant}", fontsize=9, loc="left")
            axis.set_ylabel("displacement [m]", fontsize=8)
            axis.legend(fontsize=7, loc="upper right", ncols=2)
        axes[-1, 0].set_xlabel("time [s]")
        figure.tight_layout()
        return figure

    def participant(self, number: int) -> EmulatedPerson:
        """Return the emulated participant of a number."""
        return EmulatedParticipant.draw(number)


def _own_lag(recorded: RecordedTrial, roles: Roles, lag: float) -> dict[str, float]:
    """Return the lag without measured latencies, if the participant follows and they are known."""
    latency = read_trial_latency(recorded.folder, roles.participant)
    if not roles.robot_leads or latency.motion is None or latency.picture is None:
        return {}
    return {"own_lag": lag - latency.motion - latency.picture}
