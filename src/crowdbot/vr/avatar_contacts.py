"""AvatarContacts: contacts of an avatar, for its participant to feel."""

from __future__ import annotations

from typing import Any

from crowdbot.simulation import Simulation

__all__ = ["AvatarContacts"]

STRONG = 60.0
"""Force [N] at which a controller vibrates with full strength."""
WEAKEST = 0.25
"""Strength of the vibration of a light contact."""


class AvatarContacts:
    """Contacts of one person, step by step.

    In the physics world each has a force: the mean over the last step, an estimate from the masses and velocities of
    both bodies. In the planar world bodies are discs, and a contact has no force.

    Args:
        agent: index of the person in the scene.

    >>> from crowdbot.trials import load_trial
    >>> AvatarContacts(0).update(Simulation(load_trial("frontal")))
    []
    """

    def __init__(self, agent: int) -> None:
        self.agent = agent
        self._held: set[tuple[str, int, str]] = set()

    def update(self, simulation: Simulation) -> list[dict[str, Any]]:
        """Return the contacts of the last step, JSON.

        Each has ``kind`` and ``number`` of the other body, ``limb``, ``side`` (``left``, ``right`` or empty), ``force``
        [N] or null, ``begins`` (whether there was none in the step before), and ``strength`` from 0 to 1.
        """
        found = self._forces(simulation) or self._overlaps(simulation)
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
        own = int(simulation.world.ids[0, self.agent])
        return [
            {"kind": "robot", "number": int(one.robot), "limb": "", "side": "", "force": None, "point": None,
             "strength": WEAKEST}
            for one in simulation.contacts()
            if one.other == own
        ]  # fmt: skip
