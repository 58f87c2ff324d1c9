"""MountedSensor: a sensor on a robot with its schedule, latency and state, in all environments of a simulation."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import (
    InputError,
    MissingExtra,
    Pose,
    RandomStreams,
    SpatialPose,
    Storage,
    every,
    some,
    storable,
    tree,
)
from crowdbot.sensors import (
    Reading,
    SensorSchedule,
    SensorView,
    TrackedPeople,
    WheelGeometry,
    measure_rows,
    put_state_rows,
    take_state_rows,
)
from crowdbot.trials import Mount, RobotSpec, Trial
from crowdbot.typing import Bools, Floats, Ints
from crowdbot.world import MountPlacement, PlanarWorld, World, wheel_geometry, wheel_rotation

from .world_view import WorldView

LEVEL = 1e-9


@storable
@dataclass(frozen=True)
class SensorReadings:
    """Readings of one sensor in some environments, with agent indices until they are read.

    Fields:
        name: name of the sensor.
        environments: ``[N]`` indices of the environments.
        reading: reading with N rows.
        ids: ``[N, A]`` ids of the agents at the time of the measurement.
        slots: ``[N]`` number of agents of each environment.
        arrival: ``[N]`` ticks at which they arrive.
        people: ``[N, A, 4]`` positions and velocities then, for a sensor whose readings can be old.
    """

    name: str
    environments: Ints
    reading: Reading
    ids: Ints
    slots: Ints
    arrival: Ints
    people: NDArray[np.float64] | None = None

    def row(self, number: int) -> Reading:
        """Return the reading in row ``number`` with person ids instead of agent indices."""
        alone = len(self.environments) == 1
        reading = self.reading if alone else self.reading.environment(number)
        slots = int(self.slots[number])
        if isinstance(reading, TrackedPeople) and reading.present.shape[1] > slots:
            reading = tracked_columns(reading, np.arange(slots))
        return name_by_id(reading, self.ids[number, :slots])

    def without(self, excluded: Bools) -> SensorReadings | None:
        """Return the readings without the environments ``excluded`` ``[E]``, None if none is left."""
        kept = ~excluded[self.environments]
        if kept.all():
            return self
        return self.where(kept) if kept.any() else None

    def where(self, chosen: Bools) -> SensorReadings:
        """Return the readings of the rows ``chosen`` ``[N]``."""
        rows = np.flatnonzero(chosen)
        return self.select(rows, self.environments[rows])

    def matching(self, environments: Ints) -> SensorReadings | None:
        """Return the readings of some environments, which may be repeated and are numbered anew; None for none."""
        rows, places = np.nonzero(self.environments[:, None] == environments[None, :])
        return self.select(rows, places) if len(rows) else None

    def renumber(self, numbers: Ints) -> SensorReadings:
        """Return the readings with environment e as ``numbers[e]``."""
        return dataclasses.replace(self, environments=numbers[self.environments])

    def select(self, rows: Ints, environments: Ints) -> SensorReadings:
        """Return some rows, which belong to other environments now."""
        tree.check(self, len(self.environments), self.name)
        return dataclasses.replace(tree.take(self, rows), environments=environments)


@dataclass
class MountedSensor:
    """A sensor of a running simulation of E environments.

    A built-in sensor in the plane measures all environments that are due in one call, any other sensor one by one.

    Fields:
        mount: the sensor and its mounting pose.
        placed: x, y, z [m], roll, pitch, yaw [rad] on the robot in its posture.
        schedule: sampling times and latency.
        rngs: random number generator of each environment.
        space: whether it senses bodies in space; otherwise discs in the plane.
        together: whether one call measures all environments that are due.
        state: state of the sensor in all environments if ``together``, otherwise ``[E]`` one object for each.
        waiting: readings not yet delivered.
        latest, latest_row: ``[E]`` latest readings and the row of the environment in them.
        moved: ``[E, 6]`` place on the robot after its joints moved, as ``placed``; None before.
        seen, seen_ids: ``[E, A]`` agents in the latest reading, and their ids then.
        wheels: wheels of the robot, for a sensor with encoders.
        keeps_people: whether readings hold the states of people.
    """

    mount: Mount
    placed: tuple[float, float, float, float, float, float]
    schedule: SensorSchedule
    rngs: RandomStreams
    space: bool
    together: bool
    state: Any
    waiting: list[SensorReadings] = field(default_factory=list)
    latest: NDArray[Any] = field(default_factory=lambda: np.empty(0, dtype=object))
    latest_row: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    moved: NDArray[np.float64] | None = None
    seen: Bools | None = None
    seen_ids: Ints | None = None
    wheels: WheelGeometry | None = None
    keeps_people: bool = False
    storage = Storage(
        constants=("mount", "placed", "schedule", "space", "together", "wheels", "keeps_people"),
        shared=("state", "waiting"),
    )

    def __post_init__(self) -> None:
        if not len(self.latest):
            self.latest = np.empty(len(self.rngs), dtype=object)
            self.latest_row = np.zeros(len(self.rngs), dtype=np.int64)

    @property
    def name(self) -> str:
        """Name of the sensor."""
        return self.mount.name

    def has_work(self, tick: int) -> bool:
        """Return whether the sensor measures, or may deliver a reading, at a tick."""
        return bool(self.waiting) or self.schedule.measures(tick)

    def work(
        self, ticks: Ints, live: Bools, agent: int, around: WorldView, lateness: Ints | None = None
    ) -> tuple[list[SensorReadings], list[tuple[int, Exception]]]:
        """Measure where due, and return the readings that arrive now, oldest first, and exceptions by environment.

        A measurement of several environments that raises an exception fails in all of them.

        Args:
            ticks: ``[E]`` tick of each environment.
            live: ``[E]`` environments that run.
            agent: index of the robot.
            around: the world.
            lateness: ``[E]`` additional ticks until a reading arrives, by a fault.
        """
        common = around.world.environment_time.common_tick
        measuring = self.schedule.measures(ticks) if common is None else self.schedule.measures(common)
        due = (live if measuring is True else live & measuring).nonzero()[0]
        errors: list[tuple[int, Exception]] = []
        for part in [due] if self.together else [due[k : k + 1] for k in range(len(due))]:
            try:
                self.waiting += (
                    [self._measure(part, agent, around, self._arrival(part, ticks, lateness))] if len(part) else []
                )
            except MissingExtra:
                raise
            except Exception as error:  # sensors may raise anything
                errors += [(int(e), error) for e in part]
        if not self.waiting:
            return [], errors
        ready, later = list[SensorReadings](), list[SensorReadings]()
        for readings in self.waiting:
            now = readings.arrival <= ticks[readings.environments]
            if every(now):
                ready.append(readings)
            elif not some(now):
                later.append(readings)
            else:
                ready.append(readings.where(now))
                later.append(readings.where(~now))
        self.waiting = later
        for readings in ready:
            self._keep(readings)
        return ready, errors

    def visible(self, ids: Ints) -> Bools | None:
        """Return ``[E, A]`` the agents in the latest readings, None if the sensor does not detect people."""
        if self.seen is None or self.seen_ids is None:
            return None
        seen, seen_ids = _fit(self.seen, ids.shape[1]), _fit(self.seen_ids, ids.shape[1])
        return np.asarray(seen & (seen_ids == ids))

    def reading(self, environment: int) -> Reading | None:
        """Return the latest reading in an environment, with person ids."""
        readings = self.latest[environment]
        return None if readings is None else readings.row(int(self.latest_row[environment]))

    def known_people(self, environment: int) -> NDArray[np.float64] | None:
        """Return ``[A, 4]`` positions and velocities of agents in the latest reading, None without one."""
        readings: SensorReadings | None = self.latest[environment]
        return None if readings is None or readings.people is None else readings.people[self.latest_row[environment]]

    def _keep(self, readings: SensorReadings) -> None:
        index: Any = readings.environments
        rows, seen = np.arange(len(index)), visible_agents(readings.reading, readings.ids.shape[1])
        if len(index) == len(self.latest):
            index = slice(None)  # faster than an array of indices
        self.latest[index], self.latest_row[index] = readings, rows
        if seen is None:
            return
        known, ids = self._seen_agents(readings.ids.shape[1])
        known[index], ids[index] = seen, readings.ids

    def _seen_agents(self, agents: int) -> tuple[Bools, Ints]:
        """Make room for a number of agents in the latest readings and their ids ``[E, A]``, and return both."""
        none = np.zeros((len(self.rngs), 0), dtype=np.int64)
        self.seen = _fit(none > 0 if self.seen is None else self.seen, agents)
        self.seen_ids = _fit(none if self.seen_ids is None else self.seen_ids, agents)
        return self.seen, self.seen_ids

    def _arrival(self, due: Ints, ticks: Ints, lateness: Ints | None) -> Ints:
        """Return ``[N]`` the ticks at which new readings arrive; late ones arrive in their order."""
        arrival: Ints = self.schedule.arrives(ticks[due])
        if lateness is None:
            return arrival
        arrival = arrival + lateness[due]
        for readings in self.waiting:
            rows, places = np.nonzero(readings.environments[:, None] == due[None, :])
            arrival[places] = np.maximum(arrival[places], readings.arrival[rows])
        return arrival

    def _measure(self, due: Ints, agent: int, around: WorldView, arrival: Ints) -> SensorReadings:
        if not self.together:
            return self._measure_one(int(due[0]), agent, around, arrival)
        ids, slots = around.world.ids, around.world.slots
        whole = len(due) == len(self.rngs)
        scene, pose = around.flat, self.pose(agent, around)
        if not whole:
            scene, pose = scene.environments(due), tree.take(pose, due)
        count, rngs = len(self.rngs), self.rngs if whole else self.rngs.rows(due)
        state = self.state if whole or self.state is None else take_state_rows(self.state, due)
        wheels = wheel_rotation(around.world, agent, self.wheels)
        view = SensorView(scene.without(agent), pose, wheels=wheels)
        reading, new = measure_rows(self.mount.sensor, view, state, rngs if len(rngs) > 1 else rngs[0])
        if new is not None or self.state is not None:
            self.state = new if whole else put_state_rows(self.state, due, new, count)
        ids, slots = (ids.copy(), slots.copy()) if whole else (ids[due], slots[due])
        return SensorReadings(self.name, due, reading, ids, slots, arrival, self._people(around, due))

    def _measure_one(self, e: int, agent: int, around: WorldView, arrival: Ints) -> SensorReadings:
        index = np.array([e])
        scene = (around.space(e) if self.space else around.flat_of(e)).without(agent)
        pose = self.pose(agent, around, e)
        world = around.world
        view = SensorView(scene, pose, around.of(e), wheel_rotation(world, agent, self.wheels, e))
        reading, self.state[e] = self._ask(view, self.state[e], self.rngs[e])
        people = self._people(around, index)
        return SensorReadings(self.name, index, reading, world.ids[index], world.slots[index], arrival, people)

    def _people(self, around: WorldView, due: Ints) -> Floats | None:
        """Return ``[N, A, 4]`` positions [m] and velocities [m/s] now, None for a sensor that keeps none."""
        scene = around.world.scene
        return np.concatenate([scene.position[due], scene.velocity[due]], axis=-1) if self.keeps_people else None

    def _ask(self, view: SensorView, state: Any, rng: Any) -> tuple[Reading, Any]:
        answer: Any = self.mount.sensor.measure(view, state, rng)
        if not (isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[0], Reading)):
            raise InputError(
                f"sensor {type(self.mount.sensor).__name__} {self.mount.name!r}: measure returned a"
                f" {type(answer).__name__}; it must return (reading, state)"
            )
        return answer

    def pose(self, agent: int, around: WorldView, environment: int | None = None) -> Pose | SpatialPose:
        """Return the pose of the sensor, in the plane or in space: in all environments, or in one."""
        placed: Any = self.placed
        if self.moved is not None:
            placed = tuple(
                np.ascontiguousarray(self.moved.T) if environment is None else self.moved[environment].tolist()
            )
        mount = MountPlacement(self.mount.link, self.mount.origin, placed)
        return around.sensor_pose(agent, mount, self.space, environment)

    def move(self, environments: int | Ints | slice, placed: Any) -> None:
        """Set x, y, z [m], roll, pitch, yaw [rad] on the robot in some environments."""
        moved = np.tile(np.array(self.placed), (len(self.rngs), 1)) if self.moved is None else self.moved.copy()
        moved[environments] = placed
        self.moved = moved

    def select(self, environments: Ints) -> MountedSensor:
        """Return an independent sensor with some environments."""
        other = tree.take(self, environments)
        other.state = take_state_rows(self.state, environments)
        other.waiting = [part for item in self.waiting if (part := item.matching(environments)) is not None]
        return other

    def put(self, environments: Ints, other: MountedSensor) -> None:
        """Replace some environments by those of another simulation of the same trial."""
        state = put_state_rows(self.state, environments, other.state, len(self.rngs))
        fresh = np.isin(np.arange(len(self.rngs)), environments)
        waiting = [part for item in self.waiting if (part := item.without(fresh)) is not None]
        waiting += [item.renumber(environments) for item in other.waiting]
        both = (self, other)
        if seen := [sensor.seen for sensor in both if sensor.seen is not None]:
            for sensor in both:
                sensor._seen_agents(max(item.shape[1] for item in seen))
        if any(sensor.moved is not None for sensor in both):
            for sensor in both:
                sensor.move(slice(None), sensor.placed if sensor.moved is None else sensor.moved)
        vars(self).update(
            vars(tree.put(self, environments, other, len(self.rngs))) | {"state": state, "waiting": waiting}
        )


def needs_bodies(trial: Trial) -> bool:
    """Return whether a world needs bodies of people: in physics, or for sensors that see them."""
    if trial.world == "physics":
        return True
    kind = people_shape(trial, PlanarWorld)
    return any(spatial(robot, mount, kind) for robot in trial.robots for mount in robot.sensors)


def people_shape(trial: Trial, world: World | type[World]) -> str:
    """Return the shape of people for laser scanners: that of the trial, limbs where avatars are, or of the world."""
    return trial.bodies or ("limbs" if trial.avatars else world.people_shape)


def shows_avatars(trial: Trial) -> bool:
    """Return whether rays hit the skins of avatars, while other people consist of limbs or are discs."""
    return bool(trial.avatars) and trial.bodies != "discs"


def spatial(robot: RobotSpec, mount: Mount, bodies: str) -> bool:
    """Return whether a sensor senses bodies in space."""
    _, _, _, roll, pitch, _ = robot.sensor_pose(mount)
    tilted = max(abs(roll), abs(pitch)) > LEVEL
    return bodies != "discs" or tilted or mount.sensor.spatial or mount.sensor.sees_skins


def mounted_sensors(
    trial: Any, robot: RobotSpec, world: World, seeds: Sequence[int], known: Mapping[str, MountedSensor] | None = None
) -> tuple[MountedSensor, ...]:
    """Return the sensors of a robot; those in ``known`` keep their random state and pending readings."""
    bodies = people_shape(trial, world)
    skins = bodies == "skins" or shows_avatars(trial)
    found = []
    for mount in robot.sensors:
        sensor = mount.sensor
        space = spatial(robot, mount, bodies)
        probe = MountedSensor(
            dataclasses.replace(mount, sensor=sensor.with_skins()) if skins else mount,
            robot.sensor_pose(mount),
            robot.schedule(mount, world.clock),
            RandomStreams(seeds, "sensor", robot.name, mount.name),
            space,
            sensor.batched and not space and not sensor.renders and not world.has_own_walls,
            None,
            wheels=wheel_geometry(robot.body) if sensor.encoders else None,
            keeps_people=any(getattr(spec.fault, "sensor", None) in ("", mount.name) for spec in robot.faults),
        )
        probe.state = sensor.begin() if probe.together else tree.objects(sensor.begin() for _ in seeds)
        old = (known or {}).get(mount.name)
        if old is not None:
            same = type(old.mount.sensor) is type(sensor) and old.together == probe.together
            probe.rngs, probe.latest, probe.latest_row = old.rngs, old.latest, old.latest_row
            probe.seen, probe.seen_ids = old.seen, old.seen_ids
            if same:
                probe.state, probe.waiting = old.state, old.waiting
        found.append(probe)
    return tuple(found)


def visible_agents(reading: Reading, agents: int) -> Bools | None:
    """Return ``[N, A]`` the agents in a reading; None for sensors that do not detect people."""
    if isinstance(reading, TrackedPeople):
        return _fit(reading.present, agents)
    hit = getattr(reading, "hit", None)
    if hit is None or not hasattr(reading, "visible_agents"):
        return None
    return np.asarray(reading.visible_agents(agents))


def _fit(values: NDArray[Any], agents: int) -> NDArray[Any]:
    """Return ``[E, A]`` with zeros for further agents, or without the last ones."""
    if values.shape[1] == agents:
        return values
    if values.shape[1] > agents:
        return values[:, :agents]
    return np.concatenate([values, np.zeros((len(values), agents - values.shape[1]), dtype=values.dtype)], axis=1)


def name_by_id(reading: Reading, ids: Ints) -> Reading:
    """Return a reading of one environment with person ids instead of agent indices."""
    if np.array_equal(ids, np.arange(len(ids))):
        return reading
    if isinstance(reading, TrackedPeople):
        return _tracked(reading, ids)
    hit = getattr(reading, "hit", None)
    if hit is None:
        return reading
    return dataclasses.replace(reading, hit=np.where(hit >= 0, ids[np.maximum(hit, 0)], hit))  # type: ignore[call-arg]


def _tracked(reading: TrackedPeople, ids: Ints) -> TrackedPeople:
    """Return the rows ordered by id: row k belongs to person k."""
    there = np.flatnonzero(ids >= 0)
    count = int(ids.max(initial=-1)) + 1
    rows: dict[str, Any] = {}
    for part in ("present", "position", "velocity", "radius", "heading"):
        value = getattr(reading, part)
        wide = np.full((len(value), count, *value.shape[2:]), False if part == "present" else np.nan)
        wide[:, ids[there]] = value[:, there]
        rows[part] = wide
    return dataclasses.replace(reading, **rows)


def tracked_columns(reading: TrackedPeople, agents: Ints) -> TrackedPeople:
    """Return the rows of some agents."""
    parts = ("present", "position", "velocity", "radius", "heading")
    return dataclasses.replace(reading, **{part: getattr(reading, part)[:, agents] for part in parts})
