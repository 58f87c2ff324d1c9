"""The study of a participant in a crowd who meets robots with different navigators."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.metrics import swept_clearance
from crowdbot.typing import Floats

from .comparison import EmulatedPerson, Measure, RecordedTrial, Study, TrialMeasures, draw_paths
from .emulation import EmulatedPedestrian, participant_agent

if TYPE_CHECKING:
    from matplotlib.figure import Figure


PERSONAL = 1.2
"""Personal distance of Hall (1966), The Hidden Dimension [m], between the centres."""
ARRIVAL = 0.3
"""Distance to the end of the way at which the participant has arrived [m]."""


class EncounterStudy(Study):
    """A participant walks in a crowd through which a robot drives; navigators, or robots, are the conditions.

    >>> EncounterStudy().measures["collisions"].title
    'virtual collisions of robot and participant'
    """

    name: ClassVar[str] = "encounters"
    title: ClassVar[str] = "A participant among a crowd and a robot"
    about: ClassVar[str] = "Ways from above: participants thin, the robot dashed [m]."
    measures: ClassVar[Mapping[str, Measure]] = MappingProxyType(
        {
            "collisions": Measure("virtual collisions of robot and participant", 0.2),
            "crowd_collisions": Measure("virtual collisions of the robot with others in the crowd", 0.5),
            "clearance": Measure("smallest clearance of robot and participant [m]", 0.1),
            "personal": Measure(f"share of time with the robot within {PERSONAL:g} m [1]", 0.05),
            "person_speed": Measure("speed of the participant over the way [m/s]", 0.1),
            "robot_time": Measure("time of the robot to its goal [s]", 2.0),
        }
    )

    def evaluate(self, recorded: RecordedTrial) -> tuple[dict[str, float], dict[str, str], dict[str, Floats]]:
        """Return collisions, clearance and times.

        Raises:
            InputError: the trial has no robot or participant.
        """
        episode = recorded.episode
        _, agent = participant_agent(recorded.trial)
        robot = episode.robots[0]
        gaps = swept_clearance(episode.times, episode.position, episode.radius, episode.active, robot)
        events = _contact_counts(gaps)
        people = [k for k in range(robot) if k != agent]
        person, machine = episode.position[:, agent], episode.position[:, robot]
        apart = np.hypot(*(person - machine).T)
        held = np.append(np.diff(episode.times), 0.0)
        values = {
            "collisions": float(events[agent]),
            "crowd_collisions": float(events[people].sum()),
            "clearance": float(gaps[:, agent].min()),
            "personal": float(held[apart < PERSONAL].sum() / held.sum()),
            "person_speed": _speed(episode.times, person),
            "robot_time": float(episode.metrics.get("time_to_goal", math.nan)),
        }
        values["robot_time"] = values["robot_time"] if math.isfinite(values["robot_time"]) else math.nan
        walls = {f"wall {k}": np.asarray(ring) for k, ring in enumerate(episode.walls, 1)}
        return values, {}, {"person": person, "robot": machine, **walls}

    def draw(self, trials: Sequence[TrialMeasures]) -> Figure:
        return draw_paths(trials)

    def participant(self, number: int) -> EmulatedPerson:
        return EmulatedPedestrian.draw(number)


def _contact_counts(gaps: Floats) -> NDArray[np.int64]:
    """Return ``[A]`` the number of times at which a clearance ``[T, A]`` falls below 0."""
    touch = gaps < 0.0
    begins = touch.copy()
    begins[1:] &= ~touch[:-1]
    return np.asarray(begins.sum(axis=0), dtype=np.int64)


def _speed(times: Floats, place: Floats) -> float:
    """Return the distance from the first to the last place over the time until 0.3 m before the last one [m/s]."""
    way = float(np.hypot(*(place[-1] - place[0])))
    k = int(np.argmax(np.hypot(*(place - place[-1]).T) <= ARRIVAL))
    return max(way - ARRIVAL, 0.0) / float(times[k] - times[0]) if k else math.nan
