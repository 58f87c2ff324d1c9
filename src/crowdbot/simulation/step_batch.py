"""StepBatch: the records of one time step of many environments, as arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.trials import Mount, RobotSpec
from crowdbot.typing import Bools, Floats, Ints
from crowdbot.world import gesture_codes, reaction_codes

from .mounted_sensor import SensorReadings
from .step_record import RobotContact

if TYPE_CHECKING:
    from crowdbot.world import BodyContactEvent, ContactForce, Fall

    from .orders.order import Order
    from .simulation import Simulation


class BatchReadings(NamedTuple):
    """Readings of one sensor in a batch: robot, mount, readings, and the row of the batch of each, -1 for none."""

    robot: RobotSpec
    mount: Mount
    readings: SensorReadings
    rows: Ints


@dataclass(frozen=True, eq=False)
class StepBatch:
    """The records of one time step of N environments; row n has the content of one :class:`StepRecord`.

    Fields:
        environments: ``[N]`` numbers of the environments.
        ticks, nanoseconds: ``[N]`` number of steps since the start, and simulated time [ns].
        due: ``[N]`` whether the scene is recorded; otherwise only readings, contacts and orders.
        slots: ``[N]`` number of agents; further columns have no meaning.
        ids, active, heading, radius: ``[N, A]``; radius in [m], heading in [rad].
        position, velocity: ``[N, A, 2]`` [m], [m/s].
        goals: ``[N, R, 2]`` current goal of each robot [m].
        twists, commands: ``[N, R, 3]`` forward [m/s], turn [rad/s], left [m/s] of each robot: actual and commanded.
        readings: readings of this step, sensor by sensor.
        touches, forces, collisions, falls, orders: as in :class:`StepRecord`, by row; rows without are missing.
        reactions: ``[N, A]`` codes of the reactions to robots, see :data:`crowdbot.world.REACTIONS`; None without.
        gestures: ``[N, A]`` codes of the gestures, see :data:`crowdbot.core.GESTURES`; None without.
    """

    environments: Ints
    ticks: Ints
    nanoseconds: Ints
    due: Bools
    slots: Ints
    ids: Ints
    active: Bools
    heading: Floats
    radius: Floats
    position: Floats
    velocity: Floats
    goals: Floats
    twists: Floats
    commands: Floats
    readings: tuple[BatchReadings, ...] = ()
    touches: Mapping[int, tuple[RobotContact, ...]] = field(default_factory=dict)
    forces: Mapping[int, tuple[ContactForce, ...]] = field(default_factory=dict)
    collisions: Mapping[int, tuple[BodyContactEvent, ...]] = field(default_factory=dict)
    falls: Mapping[int, tuple[Fall, ...]] = field(default_factory=dict)
    orders: Mapping[int, tuple[Order, ...]] = field(default_factory=dict)
    reactions: NDArray[np.int8] | None = None
    gestures: NDArray[np.int8] | None = None

    @classmethod
    def of(
        cls,
        simulation: Simulation,
        index: Ints,
        numbers: Ints,
        due: Bools,
        last: bool = False,
        orders: Mapping[int, tuple[Order, ...]] | None = None,
    ) -> StepBatch:
        """Return the records of some environments, as :meth:`Simulation.record` does for one.

        Args:
            simulation: a simulation that has made a step.
            index: ``[N]`` environments of the simulation.
            numbers: ``[N]`` their numbers in the records.
            due: ``[N]`` whether the scene is recorded.
            last: whether open contact events are included.
            orders: orders that were applied in this step, by environment of the simulation.

        >>> from crowdbot.simulation import Simulation
        >>> from crowdbot.trials import load_trial
        >>> simulation = Simulation(load_trial("frontal"), seeds=range(4))
        >>> simulation.advance()
        >>> batch = StepBatch.of(simulation, np.array([1, 3]), np.array([1, 3]), np.ones(2, dtype=bool))
        >>> bool((batch.position[1] == simulation.record(3).scene.position[0]).all())
        True
        """
        world, scene, robots = simulation.world, simulation.world.scene, simulation.robots
        N, ticks = len(index), world.ticks[index]
        twists, commands = np.empty((N, len(robots), 3)), np.empty((N, len(robots), 3))
        for k, robot in enumerate(robots):
            twist = world.twists[robot.agent]
            twists[:, k, 0], twists[:, k, 1], twists[:, k, 2] = (
                part[index] for part in (twist.forward, twist.turn, twist.left)
            )
            commands[:, k] = robot.command[index]
        place = np.full(simulation.count, -1, dtype=np.int64)
        place[index] = np.arange(N)
        names = [robot.robot for robot, _ in simulation.readings]
        readings = [
            BatchReadings(spec, robot.mount(told.name), told, place[told.environments])
            for spec, (robot, told) in zip(names, simulation.readings, strict=True)
        ]
        touches, forces, collisions, falls = _rare_parts(simulation, index, last)
        return cls(
            numbers,
            ticks,
            ticks * world.clock.step_ns,
            due,
            world.slots[index],
            world.ids[index],
            scene.active[index],
            scene.heading[index],
            scene.radius[index],
            scene.position[index],
            scene.velocity[index],
            scene.goal[index][:, [robot.agent for robot in robots]],
            twists,
            commands,
            tuple(reading for reading in readings if (reading.rows >= 0).any()),
            touches,
            forces,
            collisions,
            falls,
            {n: found for n, e in enumerate(index.tolist()) if (found := (orders or {}).get(e))},
            *(None if codes is None else codes[index] for codes in (reaction_codes(scene), gesture_codes(scene))),
        )

    def plain_ids(self) -> Bools:
        """Return ``[N]`` whether the ids are 0, 1, 2, ... in the columns of the agents."""
        count = np.arange(self.ids.shape[1])
        return np.asarray(np.all((self.ids == count) | (count >= self.slots[:, None]), axis=1))


def _rare_parts(simulation: Simulation, index: Ints, last: bool) -> tuple[dict[int, Any], ...]:
    """Return contacts, forces, contact events and falls by row."""
    world = simulation.world
    parts: tuple[Callable[[int], tuple[Any, ...]], ...] = (
        simulation.contacts,
        world.forces_of,
        lambda e: simulation.ended_contact_events(e, last),
        lambda e: simulation.ended_falls(e, last),
    )
    return tuple({n: found for n, e in enumerate(index.tolist()) if (found := part(e))} for part in parts)
