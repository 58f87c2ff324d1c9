"""RobotControl: sensors, navigator and command of one robot in all environments of a simulation."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, InputError, MissingExtra, Storage, TickSchedule, Twist, Walls, every, some, tree
from crowdbot.navigation import (
    DISC,
    AgentsInView,
    DriveLimits,
    ExternalNavigator,
    Observation,
    ObservationBatch,
    PathPlanner,
    TrackBatch,
    copy_memory,
)
from crowdbot.sensors import Reading
from crowdbot.trials import Mount, RobotSpec, Trial
from crowdbot.typing import Bools, Floats, Ints
from crowdbot.world import Doors, Twists, World, add_rings, free_joints, gesture_codes

from .decision_timer import DecisionTimer
from .fault_state import FaultState
from .mounted_sensor import MountedSensor, mounted_sensors
from .world_builder import limits_of
from .world_view import WorldView

if TYPE_CHECKING:
    from crowdbot.perception import Detector, GlobalNearestNeighbor, Tracks

PATH_COLUMNS = 9
"""Numbers of the state of a path; see :class:`crowdbot.navigation.Waypoints`."""
SAME = 1e-6
"""Tolerance of a number of rows."""
NEVER = -1
"""Tick of the latest order before there is one."""
PerceivedPeople: TypeAlias = "tuple[Any, Tracks]"
"""State of the tracker and its latest tracks, in one environment."""
RADIUS = 0.25
"""Radius of a tracked person [m], which a scanner does not measure."""


class _Known(NamedTuple):
    """What a robot remembers in N environments besides the memory of its navigator."""

    path: Floats
    """``[N, 9]`` state of the path planner."""
    tracks: TrackBatch
    """N histories of the visible people, or empty."""
    perceived: list[PerceivedPeople]
    """States of N trackers and their tracks, or empty."""
    failures: dict[int, Exception]
    """Environments without a path or with invalid tracks."""


@dataclass(frozen=True, kw_only=True)
class _Observations(ObservationBatch):
    """Observations that look the readings up when somebody asks for a single environment."""

    latest: Callable[[int], Mapping[str, Reading]]

    def environment(self, k: int) -> Observation:
        return dataclasses.replace(super().environment(k), readings=self.latest(k))


@dataclass
class RobotControl:
    """State of one robot in E environments: sensors, memory of the navigator, and current command.

    Fields:
        robot: the robot of the trial.
        agent: its index in the scene.
        limits: limits of its drive.
        control: ticks at which the navigator decides.
        sensors: its sensors.
        command: ``[E, 3]`` current command: forward [m/s], turn [rad/s], left [m/s].
        memories: memory of the navigator in each environment; ``UNSET`` before its first decision.
        begun: ``[E]`` whether the navigator has decided.
        arrived: ``[E]`` whether the robot has reached its goal.
        planner: path planner, or None.
        path: ``[E, 9]`` state of the path planner; NaN before the first decision.
        tracks: history of the visible people in each environment, or empty.
        timer: real time of the decisions.
        goal: ``[E, 2]`` current goal [m], which orders can change.
        tolerance: ``[E]`` distance [m] to the goal below which the robot has arrived.
        ordered: ``[E]`` tick of the latest velocity order, -1 for none.
        joints: ``[E, J]`` target of each joint [rad or m] that has been moved, otherwise NaN.
        faults: faults of the robot, or None.
        perceived: state of the tracker and tracks in each environment, or empty.
        wanted: targets of joints from the latest decisions by environment, until they are applied.
    """

    robot: RobotSpec
    agent: int
    limits: DriveLimits
    control: TickSchedule
    sensors: tuple[MountedSensor, ...]
    command: Floats
    memories: list[Any]
    begun: Bools
    arrived: Bools
    planner: PathPlanner | None
    path: Floats
    tracks: TrackBatch
    timer: DecisionTimer
    ordered: Ints
    goal: Floats
    tolerance: Floats
    joints: Floats
    faults: FaultState | None = None
    perceived: list[PerceivedPeople] = field(default_factory=list)
    wanted: dict[int, Mapping[str, float]] = field(default_factory=dict)
    storage = Storage(
        constants=("robot", "agent", "limits", "control", "wanted", "planner"),
        shared=("sensors", "memories", "tracks", "perceived"),
    )

    @classmethod
    def of(cls, trial: Trial, robot: RobotSpec, agent: int, world: World, seeds: Sequence[int]) -> RobotControl:
        """Return the state of a robot before its first decision.

        Raises:
            InputError: no space between the walls is wide enough for the path planner of the robot.
        """
        count = len(seeds)
        return cls(
            robot,
            agent,
            limits_of(robot.drive, robot.holonomic),
            decision_schedule(robot, world.clock),
            mounted_sensors(trial, robot, world, seeds),
            np.zeros((count, 3)),
            [None] * count,
            np.zeros(count, dtype=np.bool_),
            np.zeros(count, dtype=np.bool_),
            robot.stage_planner(trial.stage),
            np.full((count, PATH_COLUMNS), np.nan),
            _empty_tracks(robot, count),
            DecisionTimer.of(count),
            np.full(count, NEVER, dtype=np.int64),
            np.tile(np.array(robot.goal.position, dtype=np.float64), (count, 1)),
            np.full(count, robot.goal.tolerance),
            np.full((count, len(free_joints(robot.body))), np.nan),
            FaultState.of(robot, seeds),
            begin_tracking(count) if robot.people == "tracked" else [],
        )

    def joint_targets(self, environment: int) -> dict[str, float]:
        """Targets [rad or m] of the joints that have one in an environment."""
        row = zip(free_joints(self.robot.body), self.joints[environment].tolist(), strict=True)
        return {name: value for name, value in row if not math.isnan(value)}

    def change_memory(self, trial: Trial, robot: RobotSpec) -> RobotControl:
        """Return the state with paths and tracks for another specification of the robot.

        Raises:
            InputError: no space between the walls is wide enough for the path planner.
        """
        old, count = self.robot, len(self.memories)
        planner = robot.stage_planner(trial.stage)
        same = (robot.tracks, robot.control_period) == (old.tracks, old.control_period)
        kept = self.perceived if robot.people == old.people else []
        return dataclasses.replace(
            self,
            planner=planner,
            path=self.path if planner is self.planner else np.full_like(self.path, np.nan),
            tracks=self.tracks if same and robot.people == old.people else _empty_tracks(robot, count),
            perceived=kept or (begin_tracking(count) if robot.people == "tracked" else []),
        )

    def commands(self, world: World) -> Twists:
        """Return the current commands as twists, as the drive gets them now."""
        command = self.command
        if self.faults is not None:
            command = self.faults.change_commands(command, world.times, self.robot.radius)
        return Twists.of_columns(command.T.copy())

    def mount(self, name: str) -> Mount:
        """Return a mounted sensor by name."""
        return next(sensor.mount for sensor in self.sensors if sensor.name == name)

    def observation(self, around: WorldView, environment: int) -> Observation:
        """Return the observation in one environment; see :meth:`observations`."""
        batch, known = self._observe(around, np.array([environment]))
        for error in known.failures.values():
            raise error
        return batch.environment(0)

    def observations(self, around: WorldView, environments: Ints) -> ObservationBatch:
        """Return the observations in some environments: the people in the latest readings of the sensors.

        Positions and velocities are exact, as from a perfect tracker. In a world whose environments have different
        outlines of props, there must be one environment.
        """
        return self._observe(around, environments)[0]

    def _observe(self, around: WorldView, environments: Ints) -> tuple[ObservationBatch, _Known]:
        """Return the observations, and the state of paths and tracks after them."""
        perceived = self._track_people(around, environments)
        batch = self._perceive(around, environments, perceived)
        path, tracks = self.path[environments], self.tracks
        failures: dict[int, Exception] = {}
        changes: dict[str, Any] = {}
        if tracks:
            tracks, people = tree.take(tracks, environments), batch.people
            fresh = ~(batch.time <= tracks.times[:, -1])  # one row for each time; NaN before the first row
            tracks = tracks.update(batch.time, people.ids, people.position, people.seen, fresh)
            changes["tracks"] = tracks
        if self.planner is not None:
            found, goal = next_waypoints(self.planner, around.world, environments, batch.pose[:, :2], batch.goal, path)
            changes |= {} if goal is batch.goal else {"goal": goal}
            path, changes["waypoint"] = found.path, found.point
            failures |= {k: InputError(f"robot {self.robot.name!r}: {error}") for k, error in found.failures.items()}
        return dataclasses.replace(batch, **changes) if changes else batch, _Known(path, tracks, perceived, failures)

    def _track_people(self, around: WorldView, environments: Ints) -> list[PerceivedPeople]:
        """Return the people tracked in the latest readings, for a robot that tracks people."""
        perceived_peoples = []
        for e in environments.tolist() if self.perceived else ():
            walls = (around.flat_of(e) if around.world.has_own_walls else around.flat).walls
            perceived_peoples.append(track_readings(self.perceived[e], self.sensors, e, walls))
        return perceived_peoples

    def _perceive(self, around: WorldView, environments: Ints, perceived: list[PerceivedPeople]) -> ObservationBatch:
        """Return the observations without paths and tracks."""
        world = around.world
        ids, twists = world.ids, world.twists[self.agent]
        seen = np.full(ids.shape, self.robot.people == "true")
        for sensor in self.sensors if self.robot.people == "seen" else ():
            visible = sensor.visible(ids)
            if visible is not None:
                seen |= visible
        twist = np.empty((len(ids), 3))
        twist[:, 0], twist[:, 1], twist[:, 2] = twists.forward, twists.turn, twists.left
        if world.has_own_walls and len(world.slots) > 1:
            scene = around.flat_of(int(environments[0]))
            slots = scene.shape[1]
            ids, seen, twist = ids[environments, :slots], seen[environments, :slots], twist[environments]
            rows = np.zeros(1, dtype=np.int64)
        else:
            rows, scene = environments, around.flat
        batch = _Observations.of(
            scene,
            self.agent,
            self.limits,
            dt=self.robot.control_period,
            twist=twist,
            seen=seen,
            environments=rows,
            ids=ids,
            gesture=gesture_codes(scene),
            predictor=None if self.robot.predictor is None else self.robot.predictor.build(),
            predictor_step=None if self.robot.predictor is None else self.robot.predictor.step,
            latest=lambda k: self._latest(int(environments[k])),
            outline=DISC if self.robot.body.outline is None else self.robot.body.outline,
        )
        if perceived:
            batch = dataclasses.replace(batch, people=view_tracks(perceived, world.times[environments]))
        if self.faults is None:
            return batch
        seeing = self.sensors if self.robot.people == "seen" else ()
        return self.faults.distort(batch, world, seeing, environments)

    def _latest(self, environment: int) -> dict[str, Reading]:
        """Return the latest reading of each sensor that has one."""
        readings = {sensor.name: sensor.reading(environment) for sensor in self.sensors}
        return {name: reading for name, reading in readings.items() if reading is not None}

    def decide(self, around: WorldView, environments: Ints) -> dict[int, Exception]:
        """Let the navigator decide in some environments; return the exceptions of those in which it failed.

        Raises:
            MissingExtra: the navigator needs a package that is not installed.
        """
        if isinstance(self.robot.navigator, ExternalNavigator):
            self._wait_for_orders(self.robot.navigator, around, environments)
            return {}
        if around.world.has_own_walls and len(environments) > 1:
            found: dict[int, Exception] = {}
            for e in environments:
                found |= self.decide(around, np.array([e]))
            return found
        ticks = around.world.ticks[environments]
        hangs = self.timer.recorded_hangs(self.robot, environments, ticks)
        if hangs:
            rest = environments[~np.isin(environments, list(hangs))]
            return hangs | (self.decide(around, rest) if len(rest) else {})
        batch, known = self._observe(around, environments)
        failures: dict[int, Exception] = {}
        whole = len(environments) == len(self.begun)
        if not every(self.begun if whole else self.begun[environments]):
            new = np.flatnonzero(~self.begun[environments])
            first = batch if len(new) == len(environments) else self.observations(around, environments[new])
            memories, failed = self.timer.first_memories(self.robot, first, environments[new])
            failures |= {int(new[k]): error for k, error in failed.items()}
            for k, memory in zip(new.tolist(), memories, strict=True):
                self.memories[int(environments[k])] = memory
            self.begun[environments[new]] = True
        memories = list(self.memories) if whole else [self.memories[e] for e in environments]
        decisions = self.timer.decide(self.robot, batch, memories, environments)
        decisions.failures.update(failures | known.failures)
        failures = decisions.failures
        for error in failures.values():
            if isinstance(error, MissingExtra):
                raise error
        late = self.timer.judge(self.robot, environments, ticks, decisions)
        if self.faults is not None:
            late = late | self.faults.lost_commands(around.world.times, environments)
        self._remember(environments, known)
        self.wanted = {}
        if whole and not (failures or some(late)):
            self.memories[:] = decisions.memories
            self.command[:] = decisions.twist
            if any(decisions.joints):
                self.wanted = {e: joints for e, joints in enumerate(decisions.joints) if joints}
            return {}
        for k, e in enumerate(environments.tolist()):
            if k not in failures:
                self.memories[e] = decisions.memories[k]
        decided = ~late
        decided[list(failures)] = False
        self.command[environments[decided]] = decisions.twist[decided]
        self.wanted = {
            int(environments[k]): decisions.joints[k] for k in np.flatnonzero(decided) if decisions.joints[k]
        }
        return {int(environments[k]): error for k, error in failures.items()}

    def _remember(self, environments: Ints, known: _Known) -> None:
        if self.planner is not None:
            self.path[environments] = known.path
        for e, item in zip(environments.tolist() if known.perceived else (), known.perceived, strict=False):
            self.perceived[e] = item
        if self.tracks:
            whole = len(environments) == len(self.tracks)
            self.tracks = known.tracks if whole else self.tracks.put(environments, known.tracks)

    def _wait_for_orders(self, navigator: ExternalNavigator, around: WorldView, environments: Ints) -> None:
        """Stop where the latest order is too old; plan paths and keep tracks for the program outside."""
        world = around.world
        ticks, ordered = world.ticks[environments], self.ordered[environments]
        stale = (ordered == NEVER) | navigator.is_stale(ticks - ordered, world.clock.step_ns)
        self.command[environments[stale]] = 0.0
        self.begun[environments] = True
        self.timer.repeat_misses(environments, ticks)
        if self.planner is None and self.robot.tracks is None and not self.perceived:
            return
        due = environments[world.clock.schedule(self.robot.control_period).is_due(ticks)]
        for part in np.split(due, len(due)) if world.has_own_walls and len(due) > 1 else [due]:
            if len(part):
                self._remember(part, self._observe(around, part)[1])

    def ask(self, environments: int | Ints | slice, twist: Twist, ticks: Ints) -> None:
        """Set the command in some environments, by an order at the current ticks ``[E]``."""
        self.command[environments] = tuple(map(float, twist))
        self.ordered[environments] = ticks[environments]

    def arrive(self, position: Floats) -> None:
        """Note where the robot, at positions ``[E, 2]`` [m], is at its goal."""
        away = np.hypot(position[:, 0] - self.goal[:, 0], position[:, 1] - self.goal[:, 1])
        self.arrived |= away < self.tolerance

    def change_goal(self, environment: int, goal: tuple[float, float], tolerance: float | None = None) -> None:
        """Set the goal [m] in one environment, and its tolerance [m] (default: as before); the robot drives again."""
        self.goal[environment] = goal
        self.arrived[environment] = False
        if tolerance is not None:
            self.tolerance[environment] = tolerance

    def select(self, environments: Ints) -> RobotControl:
        """Return an independent state of some environments."""
        other = tree.take(self, environments)
        other.sensors = tuple(sensor.select(environments) for sensor in self.sensors)
        other.memories = [copy_memory(self.memories[e], type(self.robot.navigator).__name__) for e in environments]
        other.tracks = tree.take(self.tracks, environments) if self.tracks else self.tracks
        other.perceived = [self.perceived[e] for e in environments.tolist()] if self.perceived else []
        return other

    def put(self, environments: Ints, other: RobotControl) -> None:
        """Replace the state of some environments."""
        vars(self).update(vars(tree.put(self, environments, other, len(self.begun))))
        for mine, new in zip(self.sensors, other.sensors, strict=True):
            mine.put(environments, new)
        for k, e in enumerate(environments.tolist()):
            self.memories[e] = other.memories[k]
        for e, item in zip(environments.tolist(), other.perceived, strict=False):
            self.perceived[e] = item
        if self.tracks:
            self.tracks = self.tracks.put(environments, other.tracks)


def _empty_tracks(robot: RobotSpec, count: int) -> TrackBatch:
    """Return an empty history for each environment, none for a robot without tracks."""
    if robot.tracks is None:
        return TrackBatch.empty(0)
    return TrackBatch.empty(count, max(2, math.ceil(robot.tracks / robot.control_period - SAME) + 1))


def decision_schedule(robot: RobotSpec, clock: Clock) -> TickSchedule:
    """Return the ticks at which the navigator decides; the timeout of an external one is judged at each tick."""
    return clock.schedule(clock.dt if isinstance(robot.navigator, ExternalNavigator) else robot.control_period)


def next_waypoints(
    planner: PathPlanner, world: World, environments: NDArray[np.int64], place: Floats, goal: Floats, path: Floats
) -> tuple[Any, Floats]:
    """Return the next points of the paths of a robot, around doors that are closed now, and its goals.

    With doors, paths are planned anew, since a door may have opened or closed. A robot whose goal is behind a closed
    door has its own place as the goal until the door opens.

    Args:
        planner: planner among walls without doors.
        world: the world.
        environments: ``[N]`` indices of the environments; with doors, N = 1.
        place, goal: ``[N, 2]`` [m].
        path: ``[N, 9]`` states of the paths.
    """
    doors: Doors | None = world.part(int(environments[0]))[0].doors
    if doors is None:
        return planner.next_waypoints(place, goal, path), goal
    lines = doors.path_lines()
    walls = add_rings(planner.walls, lines) if lines else planner.walls
    found = PathPlanner.for_stage(walls, planner.radius, planner.margin, planner.half_width).next_waypoints(place, goal)
    if not any(doors.blocked) or not found.failures:
        return found, goal
    point, own = found.point.copy(), goal.copy()
    for k in found.failures:
        point[k], own[k] = place[k], place[k]
    return found._replace(point=point, failures={}), own


def begin_tracking(count: int) -> list[PerceivedPeople]:
    """Return the states of ``count`` environments before the first reading."""
    from crowdbot.perception import Tracks

    tracker, _ = _tracking()
    return [(tracker.begin(), Tracks.none(0.0)) for _ in range(count)]


@functools.cache
def _tracking() -> tuple[GlobalNearestNeighbor, tuple[Detector, ...]]:
    """Return the tracker and its detectors, which few trials need: they load a tenth of the package."""
    from crowdbot.perception import CloudClusters, GlobalNearestNeighbor, LidarClusters

    return GlobalNearestNeighbor(), (LidarClusters(), CloudClusters())


def track_readings(before: PerceivedPeople, sensors: Sequence[MountedSensor], environment: int, walls: Walls) -> Any:
    """Return the state and the tracks after the latest readings of the laser scanners in an environment.

    Args:
        before: state and tracks until now.
        sensors: sensors of the robot.
        environment: the environment.
        walls: map of the stage.
    """
    tracker, detectors = _tracking()
    state, tracks = before
    last = state.time
    new: list[tuple[float, Detector, Reading]] = []
    for sensor in sensors:
        reading = sensor.reading(environment)
        detector = next((item for item in detectors if isinstance(reading, item.reads)), None)
        if reading is not None and detector is not None and not float(np.max(reading.time)) <= last:
            new.append((float(np.max(reading.time)), detector, reading))
    for time, detector, reading in sorted(new, key=lambda row: row[0]):
        tracks, state = tracker.update(detector.detect(reading, walls), time, state)
    return state, tracks


def view_tracks(perceived: Sequence[PerceivedPeople], times: Floats) -> AgentsInView:
    """Return the tracked people of N environments at times ``[N]`` [s], where constant velocities take them."""
    N, A = len(perceived), max((len(tracks) for _, tracks in perceived), default=0)
    position, velocity = np.zeros((N, A, 2)), np.zeros((N, A, 2))
    seen, ids, existence = np.zeros((N, A), dtype=np.bool_), np.zeros((N, A), dtype=np.int64), np.ones((N, A))
    for k, (_, tracks) in enumerate(perceived):
        count = len(tracks)
        position[k, :count], velocity[k, :count] = tracks.at(float(times[k])), tracks.velocity
        seen[k, :count], ids[k, :count], existence[k, :count] = True, tracks.ids, tracks.existence
    return AgentsInView(position, velocity, np.full((N, A), RADIUS), seen, ids, existence)
