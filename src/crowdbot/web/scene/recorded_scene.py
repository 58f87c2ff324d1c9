"""RecordedScene: the picture of an episode at any instant, from what was recorded, without simulating it again."""

from __future__ import annotations

import bisect
import json
import math
from typing import Any

import numpy as np

from crowdbot.core import Scene
from crowdbot.humans import FallPose, blend_fall_poses
from crowdbot.recording import RecordedEpisode, RecordedRows
from crowdbot.sensors import Reading
from crowdbot.simulation import AddPersonOrder, RobotControl, Simulation
from crowdbot.typing import Floats, Ints
from crowdbot.world import GESTURE, PeopleMotion, worlds_of

from .robot_links import link_frames, poses_of, standing_links
from .scene_instant import SceneInstant
from .walking_bodies import WalkingBodies

STRIDE, BEFORE = 0.1, 1.0
"""Time step [s] of gaits, and time [s] that people have walked before an instant that was jumped to."""
FAR = 1.0
"""Distance [m] above which somebody has not walked between two records."""
OLD = 1.0
"""Age [s], or twice the mean interval of the sensor if that is longer, after which a reading is not shown."""


def simulation_reason(simulation: Simulation, episode: RecordedEpisode, changes: int) -> str:
    """Return what of an episode is not in its records, so that it must be simulated to be seen; empty for nothing.

    Args:
        simulation: the simulation of its trial, at the start.
        episode: the episode.
        changes: number of orders that have changed the trial.
    """
    world = worlds_of(simulation.world)[0]
    if changes or any(isinstance(order, AddPersonOrder) for _, order in episode.orders):
        return "people, robots or props are added"
    if world.doors is not None or any(prop.movable for prop in (world.stage.props if world.walls_fixed else ())):
        return "doors or props move"
    return (
        ""
        if recorded_slots(simulation.world.ids[0], episode.rows) is not None
        else "more people are present than at once"
    )


def recorded_slots(first: Ints, rows: RecordedRows) -> Ints | None:
    """Return the row in a scene of each id of an episode; None if the scene has too few rows.

    Somebody who enters, or comes out of a portal, takes the row of somebody who has left: the one who left at the same
    time, otherwise the lowest free one.

    Args:
        first: ids in the scene at the start ``[A]``.
        rows: people and robots of the episode.

    >>> from crowdbot.metrics import AgentStates
    >>> present = [np.array(ids) for ids in ([0, 1], [0, 2], [2, 3])]
    >>> still = np.zeros((2, 2))
    >>> states = [AgentStates(0.1 * k, ids, still, still, still[0], still[0]) for k, ids in enumerate(present)]
    >>> recorded_slots(np.array([0, 1]), RecordedRows.of(states, [[], [], []], 4)).tolist()
    [0, 1, 1, 0]
    """
    slots = np.full(len(rows.every), -1, dtype=np.int64)
    known = np.flatnonzero((first >= 0) & (first < len(slots)))
    slots[first[known]] = known
    before = rows.ids[rows.at(0)]
    free = set(range(len(first))) - set(slots[before].tolist())
    for k in range(len(rows.times)):
        now = rows.ids[rows.at(k)]
        if k > 0 and np.array_equal(now, before):
            continue
        left = [] if k == 0 else sorted(slots[np.setdiff1d(before, now, assume_unique=True)].tolist())
        new = now[slots[now] < 0].tolist()
        free |= set(left)
        free -= set(slots[now[slots[now] >= 0]].tolist())
        for item in new:
            same = next((slot for slot in left if slot in free), None)
            chosen = min(free, default=None) if same is None else same
            if chosen is None:
                return None
            slots[item] = chosen
            free.discard(chosen)
        before = now
    return slots


class RecordedScene:
    """The picture of an episode between its records: positions are interpolated, and people walk along with them.

    Args:
        simulation: the simulation of the trial, at any time: shapes of robots, sensors, and bodies of people.
        episode: the episode; :func:`simulation_reason` is empty for it.

    Attributes:
        scene, ids: people and robots at the instant of the last call of :meth:`at`, and their ids.
    """

    def __init__(self, simulation: Simulation, episode: RecordedEpisode) -> None:
        self.simulation, self.episode = simulation, episode
        motion = worlds_of(simulation.world)[0].people or WalkingBodies(simulation).motion
        assert motion is not None  # WalkingBodies makes it for a simulation without one
        self.motion: PeopleMotion = motion
        self.scene: Scene = simulation.world.environment_scene(0)
        self._first, self._last = float(episode.times[0]), float(episode.times[-1])
        slots = recorded_slots(simulation.world.ids[0], episode.rows)
        assert slots is not None  # see simulation_reason
        self._slots = slots
        self.ids = simulation.world.ids[0].copy()
        self._at = math.nan
        self._reading_times = {name: rows.times for name, rows in episode.readings.items()}
        self._robot_names = [str(load["name"]) for load in json.loads(episode.metadata["robots"])]
        self._force_times = [force.time for force in episode.forces]
        trial = simulation.trial
        self._fixed_goals = not (
            trial.journeys or trial.portals or trial.sources or episode.rows.reactions is not None or episode.orders
        )

    def at(self, seconds: float) -> SceneInstant:
        """Return an instant [s]; people walk on from the instant before, or begin to walk a second before it."""
        step = seconds - self._at
        if not 0.0 <= step <= 2.0 * STRIDE:
            self._begin(seconds)
        self.scene = self.scene_at(seconds)
        if 1e-9 < step <= 2.0 * STRIDE:
            self._walk(self.scene, step)
        self._at = seconds
        self.motion.fallen = self._fall_poses(seconds)
        return SceneInstant(
            self.simulation, self.motion, self.scene, self.ids, seconds,
            self._links, self.reading, self._forces, self._fixed_goals,
        )  # fmt: skip

    def scene_at(self, seconds: float) -> Scene:
        """Return people and robots at an instant [s]."""
        one, (k, share) = self.episode.rows, self._place(seconds)
        here = one.at(k)
        following, present = one.find(min(k + 1, len(one.times) - 1), one.ids[here])
        way = one.position[following] - one.position[here]
        stays = present & (np.abs(way).max(axis=-1) < FAR)
        part = np.where(stays, share, 0.0)
        turn = one.heading[following] - one.heading[here]
        faster = one.velocity[following] - one.velocity[here]
        rest, slots = self.simulation.world.environment_scene(0), self._slots[one.ids[here]]
        position, velocity = np.zeros(rest.position.shape), np.zeros(rest.position.shape)
        heading, active = np.zeros(rest.shape), np.zeros(rest.shape, dtype=bool)
        position[0, slots] = one.position[here] + part[:, None] * way
        velocity[0, slots] = one.velocity[here] + part[:, None] * faster
        heading[0, slots] = one.heading[here] + part * np.arctan2(np.sin(turn), np.cos(turn))
        active[0, slots] = True
        self.ids[slots] = one.ids[here]
        memory = dict(rest.memory)
        if one.gestures is not None:
            memory[GESTURE] = np.zeros(rest.shape)
            memory[GESTURE][0, slots] = one.gestures[here]
        return rest.replace(position=position, velocity=velocity, heading=heading, active=active, memory=memory)

    def _fall_poses(self, seconds: float) -> dict[int, FallPose]:
        """Return the poses of people out of balance by row of their body; none in files that do not have them."""
        k, share = self._place(seconds)
        known = self.episode.fall_poses
        before, after = (known[min(item, len(known) - 1)] if known else {} for item in (k, k + 1))
        found = {}
        for person in {*before, *after}:
            if self.episode.rows.find(k, np.array([person]))[1][0]:
                row = int(self.motion.row[self._slots[person]])
                found[row] = blend_fall_poses(before.get(person), after.get(person), share)
        return {row: pose for row, pose in sorted(found.items()) if row >= 0}

    def _place(self, seconds: float) -> tuple[int, float]:
        times = self.episode.times
        k = min(max(int(np.searchsorted(times, seconds + 1e-9, side="right")) - 1, 0), len(times) - 1)
        if k + 1 >= len(times):
            return k, 0.0
        return k, min(1.0, max(0.0, float((seconds - times[k]) / (times[k + 1] - times[k]))))

    def _begin(self, seconds: float) -> None:
        """Let people walk for a while up to an instant, so that their legs do not depend on the way to it."""
        count = min(round(BEFORE / STRIDE), math.floor((seconds - self._first) / STRIDE + 1e-9))
        first = self.scene_at(seconds - count * STRIDE)
        usual = self.motion.usual[: len(self.motion.afoot)]
        self.motion.begin(first, [self.motion.people.activities[k] for k in usual.tolist()])
        for k in range(count - 1, -1, -1):
            self._walk(self.scene_at(seconds - k * STRIDE), STRIDE)

    def _walk(self, scene: Scene, step: float) -> None:
        self.motion.take(self.motion.next_state(scene, step), self.motion.ends)

    def _links(self, control: RobotControl) -> Floats:
        rows, body = self.episode.joints.get(control.robot.name, {}), control.robot.body
        k, share = self._place(self._at)
        following = min(k + 1, len(self.episode.times) - 1)
        joints = {
            item.name: _between(rows[item.name][k], rows[item.name][following], share)
            for item in body.model.movable
            if item.name in rows
        }
        known = {name: at for name, at in joints.items() if math.isfinite(at)}
        tilt = self._tilt(control.robot.name, k, following, share)
        return standing_links(self.scene, control.agent, poses_of(link_frames(body, known, tilt)))

    def _tilt(self, robot: str, k: int, following: int, share: float) -> tuple[float, float, float] | None:
        """Return height [m], roll and pitch [rad] of the root link; None if they are not those of an engine."""
        names, rows = self._robot_names, self.episode.tilts
        if self.episode.metadata.get("world") != "physics" or robot not in names or not len(rows):
            return None
        before, after = rows[k, names.index(robot)], rows[following, names.index(robot)]
        found = before + share * (after - before) if np.isfinite(after).all() else before
        z, roll, pitch = found.tolist()
        return (z, roll, pitch) if math.isfinite(z) else None

    def reading(self, control: RobotControl, sensor: Any, seconds: float | None = None) -> Reading | None:
        """Return the latest reading of a sensor at a time [s] (default: that of :meth:`at`), None if it is old."""
        now = self._at if seconds is None else seconds
        name = f"{control.robot.name}/{sensor.name}"
        times = self._reading_times.get(name, [])
        k = bisect.bisect_right(times, now + 1e-9) - 1
        if k < 0 or now - times[k] > max(OLD, 2.0 * (times[-1] - times[0]) / max(1, len(times) - 1)):
            return None
        return self.episode.readings[name][k]

    def _forces(self) -> list[tuple[float, ...]]:
        times = self._force_times
        k, _ = self._place(self._at)
        begin = self.episode.times[k] - 1e-9
        rows = self.episode.forces[bisect.bisect_left(times, begin) : bisect.bisect_right(times, self._at + 1e-9)]
        latest = {(row.first, row.second, row.first_part, row.limb): row for row in rows}
        return [(*item.point, *item.vector) for item in latest.values()]


def _between(a: float, b: float, share: float) -> float:
    """Return a value between two; angles that jump by more than half a turn have wrapped and are not blended."""
    return float(a + share * (b - a)) if abs(b - a) < math.pi else float(a)
