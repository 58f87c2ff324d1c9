"""PushOrder: a force on a person for a time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import InputError, stream
from crowdbot.humans import People
from crowdbot.trials import people_appearance
from crowdbot.world import push_person, slot_of

from .order import Order
from .people_orders import check_person, is_present

STRONGEST, LONGEST, LARGEST = 5000.0, 10.0, 500.0
"""Largest force [N], duration [s] and impulse [N s]; the latter makes an adult about 7 m/s faster."""


@dataclass(frozen=True, kw_only=True)
class PushOrder(Order):
    """Push or pull a person with a horizontal force for a time, from the next step on.

    In the physics world the force acts on the body at the height of the centre of mass; with ``balance="true"`` the
    person braces, steps, stumbles or falls. In the plane the velocity of the person changes by ``force * duration /
    mass``, with the mass of the body that cameras show, and the person then recovers. A second push replaces the rest
    of the first.

    Fields:
        person: id of the person.
        force: [N], above 0 and at most 5000.
        direction: direction of the force in the world [rad], counter-clockwise from +x.
        duration: time for which it acts [s], at most 10; ``force * duration`` is at most 500 N s.

    Raises:
        InputError: a value is not allowed.

    >>> PushOrder(person=2, force=200, direction=0.0, duration=0.25).impulse
    50.0
    """

    person: int
    force: float
    direction: float = 0.0
    duration: float = 0.2

    def __post_init__(self) -> None:
        for name, most, unit in (("force", STRONGEST, "N"), ("duration", LONGEST, "s")):
            value = getattr(self, name)
            if not 0.0 < value <= most:
                raise InputError(f"PushOrder: {name} = {value} {unit} must be above 0 and at most {most:g}")
        if not math.isfinite(self.direction):
            raise InputError(f"PushOrder: direction = {self.direction} rad must be finite")
        if self.impulse > LARGEST:
            raise InputError(
                f"PushOrder: force * duration = {self.impulse:g} N s must be at most {LARGEST:g}; give a smaller force"
                " or a shorter duration"
            )

    @property
    def impulse(self) -> float:
        """Force times duration [N s]."""
        return float(self.force) * float(self.duration)

    def check(self, simulation: Any) -> None:
        super().check(simulation)
        slot = check_person(simulation, self.person, self.environment)
        trial = simulation.trial
        recorded = sum(len(item.walks(trial.duration)) for item in trial.recorded)
        if trial.people - recorded <= slot < trial.people:
            raise InputError(f"{self.person} is the id of a recorded person, who keeps to the recording")
        world, _ = simulation.world.part(self.environment)
        if world.walls_fixed and not len(world.rigid.people.agent):
            raise InputError("PushOrder: the physics world has no bodies for people; use slots of at least 1")

    def apply(self, simulation: Any) -> None:
        if not is_present(simulation, self.person, self.environment):
            return
        slot = slot_of(simulation.world, self.person, self.environment)
        mass, height = body_of(simulation, slot, self.environment)
        angle = float(self.direction)
        force = float(self.force) * math.cos(angle), float(self.force) * math.sin(angle)
        push_person(simulation.world, self.person, force, float(self.duration), mass, height, self.environment)


def body_of(simulation: Any, slot: int, environment: int) -> tuple[float, float]:
    """Return mass [kg] and stature [m] of a person, also in a simulation without bodies, where they are drawn alike.

    Args:
        simulation: the simulation.
        slot: index of the person.
        environment: index of the environment.
    """
    motion = simulation.world.part(environment)[0].people
    if motion is not None and motion.row[slot] >= 0:
        row = int(motion.row[slot])
        return float(motion.people.mass[row]), float(motion.people.height[row])
    seed, count = simulation.seeds[environment], int(simulation.world.slots[environment])
    robots = np.array([robot.agent for robot in (*simulation.robots, *simulation.former_robots)], dtype=np.int64)
    trial, number = simulation.trial, slot - int(np.count_nonzero(robots < slot))
    people = count - int(np.count_nonzero(robots < count))
    figures = people_appearance(trial, simulation.people, people + len(trial.robots), seed).people
    if number >= people:
        figures, number = People.sample(1, stream(seed, "people", "agent", slot)), 0
    return float(figures.mass[number]), float(figures.height[number])
