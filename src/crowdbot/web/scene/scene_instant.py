"""SceneInstant: what a frame of a scene is made of, from a simulation or from a recording."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene
from crowdbot.sensors import Reading
from crowdbot.simulation import RobotControl, Simulation
from crowdbot.typing import Floats
from crowdbot.world import PeopleMotion, worlds_of

from .robot_links import link_poses


@dataclass(frozen=True, eq=False)
class SceneInstant:
    """State of a scene at one instant.

    Fields:
        simulation: robots, sensors, doors and props.
        motion: bodies and gaits of people.
        scene: people and robots, E = 1.
        ids: ids of the agents ``[A]``.
        time: simulated time [s].
        links: returns poses ``[L, 7]`` of the links of a robot, see :func:`link_poses`.
        reading: returns the latest reading of a sensor of a robot, or None.
        forces: returns point [m] and vector [N] of contact forces, rows of 6.
        goals_known: whether the goals in the scene are those of this instant.
        paths: returns predicted paths, see :meth:`PredictedPaths.update`.
    """

    simulation: Simulation
    motion: PeopleMotion
    scene: Scene
    ids: NDArray[np.int64]
    time: float
    links: Callable[[RobotControl], Floats]
    reading: Callable[[RobotControl, Any], Reading | None]
    forces: Callable[[], list[tuple[float, ...]]]
    goals_known: bool = True
    paths: Callable[[], NDArray[np.float32]] = lambda: np.zeros((0, 2), dtype=np.float32)

    @classmethod
    def of(cls, simulation: Simulation, people: PeopleMotion | None = None) -> SceneInstant:
        """Return the current instant of a simulation.

        Args:
            simulation: the simulation.
            people: bodies and gaits, for a simulation without them.

        Raises:
            InputError: the simulation has no bodies of people.
        """
        motion = people or worlds_of(simulation.world)[0].people
        if motion is None:
            raise InputError("the simulation has no bodies of people: make it with posed=True")
        scene = simulation.world.environment_scene(0)
        return cls(
            simulation,
            motion,
            scene,
            simulation.world.ids[0],
            float(simulation.world.times[0]),
            lambda control: link_poses(simulation, scene, control),
            lambda control, sensor: sensor.reading(0),
            lambda: [(*item.point, *item.vector) for item in simulation.world.forces_of(0)],
        )
