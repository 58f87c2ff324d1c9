"""ForcePushes: forces from outside on the bodies of people in the engine, during one step of the world."""

from __future__ import annotations

import numpy as np

from crowdbot.core import Scene
from crowdbot.typing import Floats, Ints
from crowdbot.world.pushes import FORCE, LEFT, PUSH, acting_pushes

from .balance import Balance


class ForcePushes:
    """Forces on people, each for the rest of its time.

    Args:
        scene: the scene at the start of the step, E = 1.
        ids: identities ``[1, A]``.
        step: time step of the engine [s].
    """

    def __init__(self, scene: Scene, ids: Ints, step: float) -> None:
        self.step = step
        self._left: dict[int, float] = {}
        self._force: dict[int, Floats] = {}
        for agent in acting_pushes(scene, ids).tolist():
            row = scene.memory[PUSH][0, agent]
            if row[LEFT] > 0.0:
                self._left[agent], self._force[agent] = float(row[LEFT]), row[FORCE].copy()

    def __bool__(self) -> bool:
        """Whether a force acts in the next engine step."""
        return bool(self._left)

    def forces(self, agents: Ints, mass: Floats, balance: Balance | None) -> Floats:
        """Return the mean forces ``[P, 2]`` [N] on people in the next engine step, and push their balance.

        Args:
            agents: agents ``[P]`` with a body.
            mass: their masses ``[P]`` [kg].
            balance: balance of all agents; a force acts at the height of the centre of mass.
        """
        result = np.zeros((len(agents), 2))
        for k, agent in enumerate(agents.tolist()):
            if agent not in self._left:
                continue
            acts = min(self._left[agent], self.step)
            change = self._force[agent] * acts
            result[k] = mass[k] * change / self.step
            if balance is not None:
                balance.push(agent, change, float(balance.center[agent]), None)
        self._left = {agent: left - self.step for agent, left in self._left.items() if left - self.step > 1e-12}
        return result
