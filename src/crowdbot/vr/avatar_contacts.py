"""AvatarContacts: contacts of an avatar, for its participant to feel."""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.simulation import Simulation
from crowdbot.typing import Floats
from crowdbot.world import two_body_force

REGION = "chest"
"""Region of the body that a disc of the planar world touches."""
STRONG = 60.0
"""Force [N] at which a controller vibrates with full strength."""
WEAKEST = 0.25
"""Strength of the vibration of a light contact."""


class AvatarContacts:
    """Contacts of one person, step by step.

    In the physics world each has a force: the mean over the last step, an estimate from the masses and velocities of
    both bodies. In the planar world bodies are discs: the force is the peak of the two-body model of ISO/TS 15066, from
    the closing speed of both and the mass of the robot, for the chest of a person.

    Args:
        agent: index of the person in the scene.

    >>> from crowdbot.trials import load_trial
    >>> AvatarContacts(0).update(Simulation(load_trial("frontal")))
    []
    """

    def __init__(self, agent: int) -> None:
        self.agent = agent
        self._held: set[tuple[str, int, str]] = set()
        self._velocity: Floats | None = None

    def update(self, simulation: Simulation) -> list[dict[str, Any]]:
        """Return the contacts of the last step, JSON.

        Each has ``kind`` and ``number`` of the other body, ``limb``, ``side`` (``left``, ``right`` or empty), ``force``
        [N], ``point`` [m] or null, ``begins`` (whether there was none in the step before), ``strength`` from 0 to 1.
        """
        found = self._forces(simulation) or self._overlaps(simulation)
        self._velocity = simulation.world.environment_scene(0).velocity[0].copy()
        keys = {(one["kind"], one["number"], one["limb"]) for one in found}
        for one in found:
            one["begins"] = (one["kind"], one["number"], one["limb"]) not in self._held
        self._held = keys
        return found

    def _forces(self, simulation: Simulation) -> list[dict[str, Any]]:
        found = []
        for one in simulation.world.forces_of(0):
            pair = (one.first, one.second)
            if not any(body.kind == "person" and body.number == self.agent for body in pair) or one.force <= 0.0:
                continue
            own = pair.index(next(body for body in pair if body.kind == "person" and body.number == self.agent))
            other = pair[1 - own]
            limb = one.limb
            side = {"_l": "left", "_r": "right"}.get(limb[-2:], "")
            strength = min(1.0, max(WEAKEST, one.force / STRONG))
            found.append(
                {"kind": other.kind, "number": int(other.number), "limb": limb, "side": side,
                 "force": round(float(one.force), 2), "point": [round(float(k), 4) for k in one.point],
                 "strength": round(strength, 3)}
            )  # fmt: skip
        return found

    def _overlaps(self, simulation: Simulation) -> list[dict[str, Any]]:
        ids = simulation.world.ids[0].tolist()
        own = ids[self.agent]
        found = []
        for one in simulation.contacts():
            if one.other != own:
                continue
            force = self._impact(simulation, ids.index(one.robot))
            strength = round(min(1.0, max(WEAKEST, force / STRONG)), 3)
            found.append(
                {"kind": "robot", "number": int(one.robot), "limb": "", "side": "", "force": round(force, 2),
                 "point": None, "strength": strength}
            )  # fmt: skip
        return found

    def _impact(self, simulation: Simulation, robot: int) -> float:
        """Return the peak force [N] of an impact at the closing speed before or after the last step."""
        scene = simulation.world.environment_scene(0)
        apart = scene.position[0, self.agent] - scene.position[0, robot]
        normal = apart / max(1e-9, float(np.hypot(*apart)))
        moves = [scene.velocity[0]]
        if self._velocity is not None and self._velocity.shape == scene.velocity[0].shape:
            moves.append(self._velocity)
        speed = max(float((move[robot] - move[self.agent]) @ normal) for move in moves)
        mass = next(float(one.robot.mass) for one in simulation.robots if one.agent == robot)
        return two_body_force(speed, mass, REGION)
