"""FaultState: the faults of one robot in all environments, and the events of their begin and end."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import InputError, RandomStreams, Storage, kebab_case, stream
from crowdbot.navigation import ObservationBatch
from crowdbot.simulation.mounted_sensor import MountedSensor
from crowdbot.simulation.orders.decision_orders import DecisionOrder
from crowdbot.simulation.orders.order import OrderTarget
from crowdbot.trials import BlindSensor, Fault, FrozenSensor, LateSensor, RobotSpec, SensorFault
from crowdbot.typing import Bools, Floats, Ints
from crowdbot.world import World


@dataclass(frozen=True, kw_only=True)
class FaultOrder(DecisionOrder):
    """Record that a fault begins or ends; the trial says when, so a replay does not need it.

    Fields:
        fault: name of the fault, or its kind and number, such as ``frozen-sensor 1``.
        state: ``begin`` or ``end``.

    >>> from crowdbot.simulation import write_order
    >>> write_order(FaultOrder(robot="pepper", fault="lost-commands 1", state="begin"))
    '{"order": "fault", "robot": "pepper", "fault": "lost-commands 1", "state": "begin"}'
    """

    fault: str
    state: str

    def check(self, simulation: OrderTarget) -> None:
        raise InputError("a fault order is written by a run and cannot be given to one; write a <fault> in the trial")

    def apply(self, simulation: OrderTarget) -> None:
        """Do nothing: the fault acts by itself."""


COLUMNS = 8
"""Largest number of numbers of a fault."""
INSTANT = 1e-9
"""Tolerance of times [s]."""


@dataclass
class FaultState:
    """Faults of one robot in E environments, which can differ in the numbers of their faults.

    Fields:
        faults: the F faults of the robot.
        names: their names in events.
        numbers: ``[E, F, 8]`` numbers of each fault, begin and end first.
        draws: ``[E, F, 3]`` standard normal numbers, drawn once for each run.
        rngs: random generators of each fault, for each decision.
    """

    faults: tuple[Fault, ...]
    names: tuple[str, ...]
    numbers: Floats
    draws: Floats
    rngs: tuple[RandomStreams, ...]
    storage = Storage(constants=("faults", "names"))

    @classmethod
    def of(cls, robot: RobotSpec, seeds: Sequence[int]) -> FaultState | None:
        """Return the state before the first step; None for a robot without faults."""
        if not robot.faults:
            return None
        faults = tuple(spec.fault for spec in robot.faults)
        kinds = [kebab_case(type(fault).__name__) for fault in faults]
        names = tuple(spec.name or f"{kinds[k]} {k + 1}" for k, spec in enumerate(robot.faults))
        draws = [
            [stream(int(seed), "fault", robot.name, k, "draw").standard_normal(3) for k in range(len(faults))]
            for seed in seeds
        ]
        rngs = tuple(RandomStreams(seeds, "fault", robot.name, k) for k in range(len(faults)))
        return cls(faults, names, np.tile(_numbers(robot), (len(seeds), 1, 1)), np.array(draws), rngs)

    def change(self, environment: int, robot: RobotSpec) -> None:
        """Take the numbers of the faults of a variant of the robot in one environment."""
        self.numbers[environment] = _numbers(robot)

    def active(self, k: int, times: Floats) -> Bools:
        """Return where fault ``k`` is active at times ``[E]`` [s]."""
        begin, end = self.numbers[:, k, 0], self.numbers[:, k, 1]
        return np.asarray((times >= begin - INSTANT) & (times < end - INSTANT))

    def measuring(self, sensor: MountedSensor, world: World, live: Bools) -> tuple[Bools, Ints | None]:
        """Return ``[E]`` where a sensor may measure, and how many ticks late its readings are, None if never."""
        times, step = world.times, world.clock.dt
        lateness = np.zeros(len(times), dtype=np.int64)
        silent = np.zeros(len(times), dtype=np.bool_)
        own = self._of_sensor(sensor.name)
        for k, fault in own:
            active = self.active(k, times)
            if isinstance(fault, LateSensor):
                lateness += np.where(active, np.rint(self.numbers[:, k, 2] / step).astype(np.int64), 0)
            elif isinstance(fault, FrozenSensor | BlindSensor):
                silent |= active
        return live & ~silent, lateness if any(isinstance(item, LateSensor) for _, item in own) else None

    def clear_blind(self, sensors: Sequence[MountedSensor], times: Floats) -> None:
        """Forget the readings of the sensors that are blind."""
        for sensor in sensors:
            for k, fault in self._of_sensor(sensor.name):
                if isinstance(fault, BlindSensor):
                    blind = self.active(k, times)
                    sensor.latest[blind] = None
                    if sensor.seen is not None:
                        sensor.seen[blind] = False

    def distort(
        self, batch: ObservationBatch, world: World, sensors: Sequence[MountedSensor], environments: Ints
    ) -> ObservationBatch:
        """Return observations as the robot believes them: people of old readings, and a wrong pose.

        Without sensors, the people of the observations are those of the latest readings already.
        """
        changed = self._with_old_people(batch, world, sensors, environments)
        return self._with_wrong_pose(changed, world.times, environments)

    def lost_commands(self, times: Floats, environments: Ints) -> Bools:
        """Return ``[N]`` which of the new commands in some environments are lost."""
        lost = np.zeros(len(environments), dtype=np.bool_)
        for k, fault in enumerate(self.faults):
            rows = np.flatnonzero(self.active(k, times)[environments])
            if not len(rows) or type(fault).lose_commands is Fault.lose_commands:
                continue
            chosen = environments[rows]
            shares = np.array([self.rngs[k][int(e)].random() for e in chosen])
            lose_commands = fault.lose_commands(self.numbers[chosen, k], shares)
            if lose_commands is not None:
                lost[rows] |= lose_commands
        return lost

    def change_commands(self, command: Floats, times: Floats, radius: float) -> Floats:
        """Return ``[E, 3]`` the commands as the drive gets them."""
        changed = command
        for k, fault in enumerate(self.faults):
            rows = np.flatnonzero(self.active(k, times))
            found = fault.change_commands(self.numbers[rows, k], changed[rows], radius) if len(rows) else None
            if found is not None:
                changed = changed.copy()
                changed[rows] = found
        return changed

    def orders(self, robot: RobotSpec, ticks: Ints, step: float) -> list[tuple[int, FaultOrder]]:
        """Return the faults that begin or end at the current ticks ``[E]``, with their environments."""
        result = []
        for k, name in enumerate(self.names):
            now = self.active(k, ticks.astype(np.float64) * step)
            before = self.active(k, (ticks - 1).astype(np.float64) * step) & (ticks > 0)
            for e in np.flatnonzero(now != before).tolist():
                state = "begin" if now[e] else "end"
                result.append((e, FaultOrder(robot=robot.name, fault=name, state=state)))
        return result

    def _of_sensor(self, name: str) -> list[tuple[int, SensorFault]]:
        return [
            (k, fault)
            for k, fault in enumerate(self.faults)
            if isinstance(fault, SensorFault) and fault.sensor in ("", name)
        ]

    def _with_old_people(
        self, batch: ObservationBatch, world: World, sensors: Sequence[MountedSensor], environments: Ints
    ) -> ObservationBatch:
        """Return people who are seen by frozen or late sensors only as they were in the latest reading."""
        count, times = batch.people.seen.shape[1], world.times
        fresh = np.zeros(batch.people.seen.shape, dtype=np.bool_)
        old: list[tuple[MountedSensor, Bools]] = []
        for sensor in sensors:
            visible = sensor.visible(world.ids)
            if visible is None:
                continue
            stale = np.zeros(len(times), dtype=np.bool_)
            for k, fault in self._of_sensor(sensor.name):
                if isinstance(fault, FrozenSensor | LateSensor):
                    stale |= self.active(k, times)
            seen = visible[environments][:, :count]
            fresh |= seen & ~stale[environments, None]
            old.append((sensor, seen & stale[environments, None]))
        rows = [(sensor, seen & ~fresh) for sensor, seen in old if seen.any()]
        if not any(seen.any() for _, seen in rows):
            return batch
        people = batch.people
        position, velocity, gesture = people.position.copy(), people.velocity.copy(), people.gesture.copy()
        for sensor, seen in rows:
            for n in np.flatnonzero(seen.any(axis=1)).tolist():
                known = sensor.known_people(int(environments[n]))
                who = np.flatnonzero(seen[n])
                gesture[n, who] = 0  # that of an old reading is not known
                if known is not None:
                    position[n, who], velocity[n, who] = known[who, :2], known[who, 2:]
        old_people = dataclasses.replace(people, position=position, velocity=velocity, gesture=gesture)
        return dataclasses.replace(batch, people=old_people)

    def _with_wrong_pose(self, batch: ObservationBatch, times: Floats, environments: Ints) -> ObservationBatch:
        """Return the pose that the robot believes, and people relative to that pose."""
        error = np.zeros((len(environments), 3))
        for k, fault in enumerate(self.faults):
            rows = np.flatnonzero(self.active(k, times)[environments])
            chosen = environments[rows]
            found = fault.shift_pose(self.numbers[chosen, k], self.draws[chosen, k]) if len(rows) else None
            if found is not None:
                error[rows] += found
        if not error.any():
            return batch
        pose = batch.pose + error
        cos, sin = np.cos(error[:, 2])[:, None], np.sin(error[:, 2])[:, None]
        away = batch.people.position - batch.pose[:, None, :2]
        people: dict[str, Any] = {
            "position": _turn(away, cos, sin) + pose[:, None, :2],
            "velocity": _turn(batch.people.velocity, cos, sin),
        }
        return dataclasses.replace(batch, pose=pose, people=dataclasses.replace(batch.people, **people))


def _numbers(robot: RobotSpec) -> Floats:
    """Return ``[F, 8]`` the numbers of the faults of a robot."""
    rows = np.zeros((len(robot.faults), COLUMNS))
    for k, spec in enumerate(robot.faults):
        numbers = spec.fault.numbers()
        rows[k, : len(numbers)] = numbers
    return rows


def _turn(vectors: Floats, cos: Floats, sin: Floats) -> Floats:
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
