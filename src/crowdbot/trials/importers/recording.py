"""Trials from recordings: the recorded people are the crowd, and a robot may replace one of them."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot import navigation
from crowdbot.core import InputError
from crowdbot.models import ORCA
from crowdbot.sensors import Gaussian, Lidar2D
from crowdbot.trials.recorded_people import RecordedPeople, Walk
from crowdbot.trials.robot import Mount, RobotGoal, RobotSpec
from crowdbot.trials.trial import RecordingSpec, Trial
from crowdbot.world import DifferentialDrive

if TYPE_CHECKING:
    from crowdbot.data import Trajectories


TICK = 0.05
"""Longest time step [s]; the time between two rows of a recording is a whole number of steps."""
SHORTEST = 0.01
"""Shortest time step [s]."""
SLOWER = 2.0
"""Time limit of the robot, as a multiple of the time of the person whom it replaces."""
AHEAD = 1.0


def recorded_trial(
    path: str | Path,
    *,
    mode: str = "scripted",
    near: float = 5.0,
    replace: int | None = None,
    name: str = "",
    **options: Any,
) -> Trial:
    """Return a trial with the people of a recording.

    The trial lasts as long as the recording. With ``replace`` it begins when that person appears, and lasts until the
    end of the recording, or twice as long as the person walked if that is longer, since a robot may be slower.

    Args:
        path: recording. The trial refers to it by file name, so it must be in the folder of the trial file.
        mode: ``scripted`` (people follow the recording) or ``reactive`` (people nearer to the robot than ``near``
            follow a model).
        near: distance to the robot below which people react [m].
        replace: id of the person that a robot replaces; it has the person's start, goal and starting time.
        name: name of the trial (default: the file name).
        options: how the file is read, as in :class:`RecordedPeople`: ``fps``, ``format``, ``units``, ``columns``, ...

    Raises:
        InputError: no person has this id, or the person stands still.
        DataError: the file cannot be read.
    """
    path = Path(path)
    crowd = RecordedPeople(data=path.name, mode=mode, reaction_distance=near, folder=path.parent, **options)
    tracks = crowd.tracks()
    step = _step(tracks)
    period = step * round(tracks.dt / step) if tracks.dt <= 0.5 else step * max(1, round(0.1 / step))
    recording = RecordingSpec(period=period, markers=period * math.ceil(0.5 / period - 1e-9))
    whole = max(step, float(tracks.time[-1]))
    robots: tuple[RobotSpec, ...] = ()
    if replace is not None:
        walk = _walk_of(crowd, replace, whole)
        crowd = dataclasses.replace(crowd, begin=float(walk.time[0]), exclude=str(replace))
        robots = (_robot(walk, step),)
        whole = max(whole - float(walk.time[0]), SLOWER * float(walk.time[-1] - walk.time[0]))
    return Trial(
        name=(name or path.stem)[:80] or "recorded",
        about=f"The people of {path.name[:60]}, {mode}.",
        duration=min(whole, 86_400.0),
        step=step,
        crowd=ORCA(),
        recorded=(crowd,),
        robots=robots,
        recording=recording,
        folder=path.parent,
    )


def _step(tracks: Trajectories) -> float:
    """Return a time step [s] that divides the time between any two frames, also across gaps."""
    shared = int(np.gcd.reduce(np.diff(np.unique(tracks.frame)), initial=tracks.frame_step))
    base = tracks.dt * shared / tracks.frame_step
    base = base if base >= SHORTEST else tracks.dt
    return round(base / math.ceil(base / TICK - 1e-9), 9)


def _walk_of(crowd: RecordedPeople, person: int, duration: float) -> Walk:
    walks = [walk for walk in crowd.walks(duration) if walk.person == person]
    if not walks:
        ids = sorted({walk.person for walk in crowd.walks(duration)})
        raise InputError(f"nobody in {crowd.data} has the id {person}; ids go from {ids[0]} to {ids[-1]}")
    walk = max(walks, key=lambda walk: float(walk.time[-1] - walk.time[0]))
    if float(np.hypot(*(walk.position[-1] - walk.position[0]))) < 1.0:
        raise InputError(f"person {person} of {crowd.data} ends less than 1 m from the start, which is too short")
    return walk


def _robot(walk: Walk, step: float) -> RobotSpec:
    """Return a robot that goes from the start to the end of a walk, at about the same speed."""
    way = np.hypot(*np.diff(walk.position, axis=0).T)
    speed = float(np.clip(way.sum() / (walk.time[-1] - walk.time[0]), 0.3, 3.0))
    later = walk.position[min(int(np.searchsorted(walk.time, walk.time[0] + AHEAD)), len(walk.time) - 1)]
    ahead = later - walk.position[0]
    control = step * max(1, round(0.1 / step))
    (x, y), (goal_x, goal_y) = walk.position[[0, -1]].tolist()
    return RobotSpec(
        x=x,
        y=y,
        heading=float(np.arctan2(ahead[1], ahead[0])),
        control_period=control,
        goal=RobotGoal(goal_x, goal_y, 0.3),
        drive=DifferentialDrive(max_speed=max(1.0, speed), max_turn_rate=1.5),
        navigator=navigation.ORCANavigator(speed=speed),
        sensors=(Mount(sensor=Lidar2D(rays=360, range_max=10.0, rate=1.0 / control, noise=Gaussian(0.01))),),
    )
