"""WalkingBodies: bodies and gaits of the people of a simulation that has none, for its picture."""

from __future__ import annotations

import numpy as np

from crowdbot.simulation import Simulation
from crowdbot.trials import people_appearance
from crowdbot.world import PeopleMotion, worlds_of


class WalkingBodies:
    """Bodies that walk along with a simulation and change nothing in it.

    A simulation whose sensors see limbs has bodies itself; then this has none.

    Args:
        simulation: the simulation, at any time; all bodies begin to walk there.

    Attributes:
        motion: the bodies, or None.

    >>> from crowdbot.trials import load_trial
    >>> simulation = Simulation(load_trial("circle-crossing"))
    >>> bodies = WalkingBodies(simulation)
    >>> simulation.advance()
    >>> bodies.follow(simulation)
    >>> len(bodies.motion.agents)
    5
    """

    def __init__(self, simulation: Simulation) -> None:
        self.motion: PeopleMotion | None = None
        self._time = float(simulation.world.times[0])
        if worlds_of(simulation.world)[0].people is not None:
            return
        trial, scene, seed = simulation.trial, simulation.world.environment_scene(0), simulation.seeds[0]
        count = trial.people + len(trial.robots)
        looks = people_appearance(trial, simulation.people, max(count, scene.shape[1]), seed)
        robots = [robot.agent for robot in (*simulation.robots, *simulation.former_robots)]
        afoot = np.setdiff1d(np.arange(scene.shape[1]), robots)
        wanted = len(afoot) + len(looks.riders)
        people = looks.people if len(looks.people) == wanted else None
        riders = [trial.people + k for k in looks.riders] if people is not None else []
        ground = trial.stage.physical().ground
        self.motion = PeopleMotion(scene, afoot, people, seed, riders, ground)
        if people is not None and set(looks.activity) - {"walk"}:
            self.motion.begin(scene, looks.activity)

    def follow(self, simulation: Simulation) -> None:
        """Walk to the current positions; people who were added get a body."""
        if self.motion is None:
            return
        scene, now = simulation.world.environment_scene(0), float(simulation.world.times[0])
        if scene.shape[1] > len(self.motion.row):
            robots = [robot.agent for robot in simulation.robots]
            new = np.setdiff1d(np.arange(len(self.motion.row), scene.shape[1]), robots)
            self.motion.grow(scene.shape[1], new.tolist())
        if now > self._time:
            avatars = worlds_of(simulation.world)[0].avatars
            if avatars is not None:
                self.motion.set_poses(avatars.poses(0))
            self.walk(simulation, min(now - self._time, 1.0))
            self._time = now

    def walk(self, simulation: Simulation, seconds: float) -> None:
        """Walk to the current positions in a time [s]."""
        if self.motion is not None:
            after = self.motion.next_state(simulation.world.environment_scene(0), seconds)
            self.motion.take(after, self.motion.ends)  # nobody touches these limbs, so their ends are not computed
