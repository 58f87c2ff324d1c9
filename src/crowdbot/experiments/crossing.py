"""The study of a participant who crosses the way of a robot."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from crowdbot.core import InputError
from crowdbot.metrics import swept_clearance
from crowdbot.typing import Floats

from .comparison import EmulatedPerson, Measure, RecordedTrial, Study, TrialMeasures, draw_paths
from .emulation import EmulatedPedestrian, participant_agent

if TYPE_CHECKING:
    from matplotlib.figure import Figure


PARALLEL = math.sin(math.radians(10.0))
"""Sine of the smallest angle between the two ways."""


class CrossingStudy(Study):
    """A participant crosses the way of a robot.

    The crossing is the point where the lines from both starts in their headings meet. Each of the two passes it when
    its way along its own line reaches it.

    Source: the order of passing and the clearance of Vassallo et al. (2017), How do walkers avoid a mobile robot
    crossing their way?, doi 10.1016/j.gaitpost.2016.09.022.

    >>> CrossingStudy().measures["first"].binary
    True
    """

    name: ClassVar[str] = "crossing"
    title: ClassVar[str] = "Crossing the way of a robot"
    about: ClassVar[str] = (
        "Ways from above: participants thin with a mark where they pass the crossing, the robot dashed [m]."
    )
    measures: ClassVar[Mapping[str, Measure]] = MappingProxyType(
        {
            "first": Measure("share of trials in which the participant passes first [1]", 0.2, binary=True),
            "clearance": Measure("smallest clearance of the bodies [m]", 0.1),
            "collision": Measure("share of trials with a collision [1]", 0.1, binary=True),
            "gap": Measure("time between the two at the crossing [s]", 0.3),
            "person_time": Measure("time until the participant passes [s]", 0.3),
            "robot_time": Measure("time until the robot passes [s]", 0.5),
            "deviation": Measure("largest deviation of the participant from the straight way [m]", 0.1),
        }
    )

    def evaluate(self, recorded: RecordedTrial) -> tuple[dict[str, float], dict[str, str], dict[str, Floats]]:
        """Return order, times and clearance.

        Raises:
            InputError: the trial has no robot or participant, or their ways are parallel.
        """
        episode, trial = recorded.episode, recorded.trial
        avatar, agent = participant_agent(trial)
        robot, spec = episode.robots[0], trial.robots[0]
        person, machine = episode.position[:, agent], episode.position[:, robot]
        starts, headings = (person[0], machine[0]), (avatar.heading, spec.heading)
        ways = [np.array([math.cos(heading), math.sin(heading)]) for heading in headings]
        stations = _crossing(starts, ways, trial.name)
        times = [
            _passing(episode.times, (track - start) @ way, station)
            for track, start, way, station in zip((person, machine), starts, ways, stations, strict=True)
        ]
        gaps = swept_clearance(episode.times, episode.position, episode.radius, episode.active, robot)[:, agent]
        clearance = float(gaps.min())
        touched = any(contact.other == str(int(episode.ids[agent])) for contact in episode.contacts)
        side = np.array([-ways[0][1], ways[0][0]])
        values = {
            "first": _first(*times),
            "clearance": clearance,
            "collision": float(touched or clearance < 0.0),
            "gap": abs(times[0] - times[1]),
            "person_time": times[0],
            "robot_time": times[1],
            "deviation": float(np.abs((person - starts[0]) @ side).max()),
        }
        mark = np.array([np.interp(times[0], episode.times, column) for column in person.T])
        return values, {}, {"person": person, "robot": machine, "mark": mark}

    def draw(self, trials: Sequence[TrialMeasures]) -> Figure:
        return draw_paths(trials)

    def participant(self, number: int) -> EmulatedPerson:
        return EmulatedPedestrian.draw(number)


def _crossing(starts: Sequence[Floats], ways: Sequence[Floats], name: str) -> tuple[float, float]:
    """Return the distances [m] of the crossing from both starts along their ways."""
    apart = float(ways[0][0] * ways[1][1] - ways[0][1] * ways[1][0])
    if abs(apart) < PARALLEL:
        raise InputError(f"trial {name!r}: the headings of participant and robot are parallel; their ways do not cross")
    away = starts[1] - starts[0]
    own = float(away[0] * ways[1][1] - away[1] * ways[1][0]) / apart
    other = float(away[0] * ways[0][1] - away[1] * ways[0][0]) / apart
    if own <= 0.0 or other <= 0.0:
        raise InputError(f"trial {name!r}: the crossing is behind the participant or the robot at the start")
    return own, other


def _first(person: float, robot: float) -> float:
    """Return 1 if the participant passes first, 0 if the robot does; NaN if neither passes."""
    if math.isnan(person):
        return math.nan if math.isnan(robot) else 0.0
    return float(math.isnan(robot) or person < robot)


def _passing(times: Floats, along: Floats, station: float) -> float:
    """Return when a way reaches the station first [s]; NaN if it does not."""
    past = along >= station
    if not past.any():
        return math.nan
    k = int(np.argmax(past))
    if k == 0:
        return float(times[0])
    share = (station - along[k - 1]) / (along[k] - along[k - 1])
    return float(times[k - 1] + share * (times[k] - times[k - 1]))
