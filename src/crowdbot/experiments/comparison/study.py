"""Study: a kind of experiment with its measures, plot and emulated participant; where participants look."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

import numpy as np

from crowdbot.experiments.emulation import participant_agent
from crowdbot.experiments.streams import RecordedStream, read_streams, read_trial_clock
from crowdbot.metrics import GAZE_HALF_ANGLE, HEAD_HALF_ANGLE, gaze_dwell
from crowdbot.recording import RecordedEpisode
from crowdbot.simulation import AvatarOrder, OrderSource
from crowdbot.trials import Trial
from crowdbot.typing import Floats

if TYPE_CHECKING:
    from matplotlib.figure import Figure


COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
"""Colours of the conditions (Okabe, Ito)."""


@dataclass(frozen=True)
class Measure:
    """A column of the analysis.

    Fields:
        title: name with the unit.
        bound: default largest difference that counts as equivalent. The bounds are choices, not findings: about the
            smallest difference that an observer of the two would notice.
        binary: whether a trial has the value 0 or 1, such as a collision; the means are then shares of the trials.
        compared: whether the conditions are tested against each other; not so for what describes the apparatus.
    """

    title: str
    bound: float
    binary: bool = False
    compared: bool = True


class RecordedTrial(NamedTuple):
    """A recorded trial of one participant.

    Fields:
        trial: the trial of the episode.
        episode: what was recorded.
        folder: folder of the trial; streams of the session are beside it.
        settling: time at the start that is left out of steady motions [s].
    """

    trial: Trial
    episode: RecordedEpisode
    folder: Path
    settling: float


@dataclass(frozen=True, eq=False)
class TrialMeasures:
    """One trial of one participant.

    Fields:
        participant: number.
        condition: name of the trial in the experiment.
        values: measures by name, NaN where one is not known; empty with a ``reason``.
        reason: why there are none.
        labels: texts about the trial, such as who leads.
        curves: arrays for the plot of the study.
    """

    participant: int
    condition: str
    values: Mapping[str, float]
    reason: str = ""
    labels: Mapping[str, str] = field(default_factory=dict)
    curves: Mapping[str, Floats] = field(default_factory=dict)

    def record(self) -> dict[str, Any]:
        """Return the values as a row of a table."""
        head = {"participant": self.participant, "condition": self.condition}
        return {**head, **self.labels, **self.values, "reason": self.reason}


class EmulatedPerson(Protocol):
    """A program that takes the place of a participant in the trials of a study."""

    def source(self, trial: Trial) -> OrderSource:
        """Return the source of the orders of a run of the trial; it raises InputError for another kind of trial."""


class Study(ABC):
    """Contract of the kinds of experiments that ``crowdbot experiment analyse`` knows.

    Attributes:
        name: name in the attribute ``analysis`` of an experiment.
        title: heading of the report.
        measures: what is compared between the conditions, by name.
        about: what the plot of the trials shows, HTML.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    measures: ClassVar[Mapping[str, Measure]]
    about: ClassVar[str]

    @abstractmethod
    def evaluate(self, recorded: RecordedTrial) -> tuple[dict[str, float], dict[str, str], dict[str, Floats]]:
        """Return measures, labels and curves of a trial, see :class:`TrialMeasures`.

        Raises:
            InputError: it is a trial of another kind.
        """

    @abstractmethod
    def draw(self, trials: Sequence[TrialMeasures]) -> Figure:
        """Return a plot of trials, at least one, all with results."""

    @abstractmethod
    def participant(self, number: int) -> EmulatedPerson:
        """Return the emulated participant of a number."""


GAZE_TYPE = "Gaze"
GAZE_CHANNELS = ("direction_x", "direction_y", "direction_z")
"""Channels of a stream of the type ``Gaze``: the direction in the frame of the head (x ahead, y left, z up)."""
UNKNOWN = (float("nan"),) * 3
LATE = 0.1
"""Longest time between a sample of the gaze and the latest pose of the head [s]."""


class ViewTrack(NamedTuple):
    """Directions of the view of a participant.

    Fields:
        kind: ``head`` or ``gaze``.
        time: ``[T]`` simulated time [s].
        eye: ``[T, 3]`` middle between the eyes [m].
        direction: ``[T, 3]`` unit vectors.
    """

    kind: str
    time: Floats
    eye: Floats
    direction: Floats

    @property
    def half_angle(self) -> float:
        """Half angle of the cone of view [rad]."""
        return GAZE_HALF_ANGLE if self.kind == "gaze" else HEAD_HALF_ANGLE


def looking_shares(recorded: RecordedTrial) -> tuple[dict[str, float], str]:
    """Return the shares of time that the participant looks at the first robot, and by what: head, gaze or unknown."""
    avatar, agent = participant_agent(recorded.trial)
    view = view_track(recorded, avatar.name)
    if view is None:
        return {"looking": math.nan, "looking_visible": math.nan}, "unknown"
    episode, robot = recorded.episode, recorded.episode.robots[0]
    rows = np.clip(np.searchsorted(episode.times, view.time), 0, len(episode.times) - 1)
    others = [k for k in range(episode.robots[0]) if k != agent]
    people = np.where(episode.active[rows][:, others, None], episode.position[rows][:, others], np.nan)
    target = np.stack([np.interp(view.time, episode.times, column) for column in episode.position[:, robot].T], axis=1)
    spec = recorded.trial.robots[0]
    found = gaze_dwell(
        view.time,
        view.eye,
        view.direction,
        target,
        radius=float(episode.radius[robot]),
        height=float(spec.height),
        half_angle=view.half_angle,
        walls=episode.walls,
        people=people if others else None,
        people_radius=episode.radius[others],
    )
    return {"looking": found.share, "looking_visible": found.visible_share}, view.kind


def view_track(recorded: RecordedTrial, avatar: str) -> ViewTrack | None:
    """Return where the participant looks: by the gaze if the session recorded one, else by the head; None without both.

    The poses of the head, and the gaze of a headset that measures it, are those of the orders in the episode;
    directions are NaN while the eyes are closed. Otherwise a recorded stream of the type ``Gaze`` with the channels
    ``direction_x``, ``direction_y`` and ``direction_z`` turns with the latest pose of the head.
    """
    head = _head_track(recorded, avatar)
    if head is None:
        return None
    time, poses, eyes = head
    if np.isfinite(eyes).any():
        return ViewTrack("gaze", time, poses[:, :3], _rotate(poses[:, 3:], eyes))
    for stream in read_streams(recorded.folder.parent):
        if stream.type == GAZE_TYPE and all(name in stream.labels for name in GAZE_CHANNELS):
            gaze = _gaze_track(recorded, stream, time, poses)
            if gaze is not None:
                return gaze
    return ViewTrack("head", time, poses[:, :3], _rotate(poses[:, 3:], np.array([1.0, 0.0, 0.0])))


def _head_track(recorded: RecordedTrial, avatar: str) -> tuple[Floats, Floats, Floats] | None:
    """Return times, poses ``[T, 7]`` of the head and directions ``[T, 3]`` of the eyes in the orders for an avatar."""
    known = {
        float(at if order.time is None else order.time): (*order.head, *(order.gaze or UNKNOWN))
        for at, order in recorded.episode.orders
        if isinstance(order, AvatarOrder) and order.avatar == avatar and order.head is not None
    }
    if not known:
        return None
    times = np.array(sorted(known))
    rows = np.array([known[time] for time in times.tolist()], dtype=np.float64)
    return times, rows[:, :7], rows[:, 7:]


def _gaze_track(recorded: RecordedTrial, stream: RecordedStream, time: Floats, poses: Floats) -> ViewTrack | None:
    """Return the gaze during the trial, or None if the stream has no sample in it."""
    clock = read_trial_clock(recorded.folder)
    if clock is None:
        return None
    at = clock.simulation_time(stream.clock)
    rows = np.searchsorted(time, at + 1e-9) - 1
    fits = (rows >= 0) & np.isfinite(at)
    fits[fits] = at[fits] - time[rows[fits]] <= LATE
    kept = np.flatnonzero(fits)
    kept = kept[np.diff(np.maximum.accumulate(at[kept]), prepend=-np.inf) > 0.0]
    if not len(kept):
        return None
    way = stream.values[kept][:, [stream.labels.index(name) for name in GAZE_CHANNELS]]
    return ViewTrack("gaze", at[kept], poses[rows[kept], :3], _rotate(poses[rows[kept], 3:], way))


def _rotate(quaternion: Floats, vector: Floats) -> Floats:
    """Return vectors turned by quaternions w, x, y, z: ``v + 2 w (q x v) + 2 q x (q x v)``."""
    unit = quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)
    w, axis = unit[:, :1], unit[:, 1:]
    first = np.cross(axis, np.broadcast_to(vector, axis.shape))
    return np.asarray(vector + 2.0 * (w * first + np.cross(axis, first)))
