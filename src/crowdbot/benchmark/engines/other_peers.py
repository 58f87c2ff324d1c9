"""JuPedSim, navground and PySocialForce, optional packages."""

from __future__ import annotations

import contextlib
import logging
import os
import tempfile
from collections.abc import Callable

import numpy as np

from crowdbot.benchmark.speed.reference_engines import jupedsim_step
from crowdbot.core import Scene, import_optional
from crowdbot.models import ORCA, CollisionFreeSpeed, GroupForce

from .engine_peer import EnginePeer


class JuPedSimPeer(EnginePeer):
    """The collision-free speed model of JuPedSim, with direct steering, the least work for it."""

    name = "JuPedSim"
    packages = ("jupedsim",)
    people = (1000, 10_000)
    dt = 0.01
    protocol = (
        "collision-free speed model of version 2 with its default values, people within 3 m, no walls; JuPedSim"
        " computes in one thread"
    )

    def __init__(self) -> None:
        import_optional("jupedsim", "the comparison with JuPedSim", "peers")

    def threads(self) -> tuple[int, ...]:
        """Return 1 and 2: JuPedSim has one thread, ours can have more."""
        return (1, 2) if (os.cpu_count() or 1) > 1 else (1,)

    @property
    def model(self) -> CollisionFreeSpeed:
        """Our collision-free speed model."""
        return CollisionFreeSpeed()

    def step(self, scene: Scene, threads: int = 1) -> Callable[[], object]:
        """Return a function that makes one step of JuPedSim."""
        return jupedsim_step("CollisionFreeSpeedModelV2", scene)


class NavgroundOrcaPeer(EnginePeer):
    """ORCA of navground, a compiled world with its neighbour search."""

    name = "navground"
    packages = ("navground",)
    people = (1000,)
    dt = 0.1
    protocol = "ORCA of 10 neighbours within 5 m, horizon 2 s, no walls; navground also resolves contacts in each step"

    def __init__(self) -> None:
        self._core = import_optional("navground.core", "the comparison with navground", "peers")
        self._sim = import_optional("navground.sim", "the comparison with navground", "peers")

    @property
    def model(self) -> ORCA:
        """ORCA with the settings of navground."""
        return ORCA(neighbor_distance=5.0, max_neighbors=10.0, time_horizon=2.0)

    def step(self, scene: Scene, threads: int = 1) -> Callable[[], object]:
        """Return a function that makes one step of a world of navground."""
        core, sim, world = self._core, self._sim, self._sim.World()
        columns = (scene.position[0], scene.goal[0], scene.radius[0], scene.preferred_speed[0], scene.max_speed[0])
        for place, goal, radius, speed, top in zip(*(one.tolist() for one in columns), strict=True):
            kinematics = core.kinematics.OmnidirectionalKinematics(max_speed=top, max_angular_speed=1.5)
            behavior = core.behaviors.ORCABehavior(kinematics, radius)
            behavior.optimal_speed, behavior.safety_margin = speed, 0.0
            behavior.horizon, behavior.max_number_of_neighbors = 5.0, 10
            behavior.time_horizon = behavior.static_time_horizon = 2.0
            task = sim.tasks.WaypointsTask(waypoints=[goal], loop=False, tolerance=0.2)
            sight = [sim.state_estimations.BoundedStateEstimation(range=5.0)]
            agent = sim.Agent(radius, behavior, kinematics, task, sight, 0.0)
            agent.position = place
            world.add_agent(agent)
        return lambda: world.update(self.dt)


class PySocialForcePeer(EnginePeer):
    """PySocialForce, all pairs in compiled Python."""

    name = "PySocialForce"
    packages = ("pysocialforce",)
    people = (100, 500)
    dt = 0.4
    protocol = (
        "social force with contacts (ours: group-force, variant pysocialforce), no walls, no groups; it compares all"
        " pairs in one thread"
    )

    def __init__(self) -> None:
        root = logging.getLogger()
        level, handlers = root.level, list(root.handlers)
        logging.disable()  # its import writes a file, and prints the messages of every package
        try:
            with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
                self._module = import_optional("pysocialforce", "the comparison with PySocialForce", "peers")
        finally:  # also if the package is missing
            logging.disable(logging.NOTSET)
            root.setLevel(level)
            for handler in [handler for handler in root.handlers if handler not in handlers]:
                root.removeHandler(handler)
                handler.close()

    @property
    def model(self) -> GroupForce:
        """Our group force model in the variant of PySocialForce."""
        return GroupForce(variant="pysocialforce")

    def step(self, scene: Scene, threads: int = 1) -> Callable[[], object]:
        """Return a function that makes one step of PySocialForce."""
        state = np.concatenate([scene.position[0], scene.velocity[0], scene.goal[0]], axis=1)
        simulator = self._module.Simulator(state)
        return lambda: simulator.step(1)
