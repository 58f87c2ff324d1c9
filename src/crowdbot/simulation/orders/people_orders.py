"""Orders that add, remove, move and redirect people and robots."""

from __future__ import annotations

from dataclasses import dataclass

from crowdbot.core import InputError
from crowdbot.world import (
    add_person,
    check_goal,
    check_place,
    check_room,
    move_agent,
    redirect_person,
    remove_person,
    slot_of,
)

from .order import Order, OrderTarget

FASTEST, WIDEST = 20.0, 5.0
"""Largest preferred speed [m/s] and radius [m] of a person."""


@dataclass(frozen=True, kw_only=True)
class AddPersonOrder(Order):
    """Add a person, who gets the next free id.

    Fields:
        x, y: position [m].
        goal_x, goal_y: goal [m].
        speed: preferred speed [m/s].
        radius: [m].
    """

    x: float
    y: float
    goal_x: float
    goal_y: float
    speed: float = 1.34
    radius: float = 0.25

    def check(self, simulation: OrderTarget) -> None:
        super().check(simulation)
        for name, value, most in (("speed", self.speed, FASTEST), ("radius", self.radius, WIDEST)):
            if not 0.0 < value <= most:
                raise InputError(f"AddPersonOrder: {name} = {value} must be above 0 and at most {most:g}")
        check_goal(simulation.world, (self.x, self.y), (self.goal_x, self.goal_y), self.environment)
        check_room(simulation.world, self.environment)

    def apply(self, simulation: OrderTarget) -> None:
        place, goal = (float(self.x), float(self.y)), (float(self.goal_x), float(self.goal_y))
        add_person(simulation.world, place, goal, float(self.speed), float(self.radius), self.environment)


@dataclass(frozen=True, kw_only=True)
class RemoveOrder(Order):
    """Remove a person.

    Fields:
        person: id of the person.
    """

    person: int

    def check(self, simulation: OrderTarget) -> None:
        super().check(simulation)
        check_person(simulation, self.person, self.environment)

    def apply(self, simulation: OrderTarget) -> None:
        if is_present(simulation, self.person, self.environment):
            remove_person(simulation.world, self.person, self.environment)


@dataclass(frozen=True, kw_only=True)
class MoveOrder(Order):
    """Move a person or robot to another place, at rest.

    Fields:
        person: id of the person or robot.
        x, y: position [m].
        heading: [rad]; None keeps the heading.
    """

    person: int
    x: float
    y: float
    heading: float | None = None

    def check(self, simulation: OrderTarget) -> None:
        super().check(simulation)
        check_place(self.x, self.y)
        check_place(self.heading or 0.0, 0.0)
        _check_avatar(simulation, slot_of(simulation.world, self.person, self.environment), self.person)

    def apply(self, simulation: OrderTarget) -> None:
        if is_present(simulation, self.person, self.environment):
            heading = None if self.heading is None else float(self.heading)
            move_agent(simulation.world, self.person, float(self.x), float(self.y), heading, self.environment)


@dataclass(frozen=True, kw_only=True)
class RedirectOrder(Order):
    """Give a person another goal, instead of their journey.

    Fields:
        person: id of the person.
        x, y: goal [m].
    """

    person: int
    x: float
    y: float

    def check(self, simulation: OrderTarget) -> None:
        super().check(simulation)
        slot = check_person(simulation, self.person, self.environment)
        x, y = simulation.world.scene.position[self.environment, slot].tolist()
        check_goal(simulation.world, (x, y), (self.x, self.y), self.environment)

    def apply(self, simulation: OrderTarget) -> None:
        if is_present(simulation, self.person, self.environment):
            redirect_person(simulation.world, self.person, float(self.x), float(self.y), self.environment)


def check_person(simulation: OrderTarget, person: int, environment: int) -> int:
    """Return the index of a present person, or raise :class:`InputError`: nobody has the id, or a robot or avatar."""
    slot = slot_of(simulation.world, person, environment)
    if slot in simulation.world.twists:
        raise InputError(f"{person} is the id of a robot; give the id of a person")
    _check_avatar(simulation, slot, person)
    return slot


def _check_avatar(simulation: OrderTarget, slot: int, person: int) -> None:
    trial, avatars = simulation.trial, simulation.trial.avatars
    if slot in simulation.world.twists:
        robot = next((robot for robot in trial.robots if simulation.agent_of(robot.name) == slot), None)
        if robot is not None and robot.mirror is not None:
            raise InputError(f"{person} is the id of robot {robot.name!r}, whose pose comes from its source")
        return
    recorded = sum(len(item.walks(trial.duration)) for item in trial.recorded)
    k = slot - (trial.people - recorded - len(avatars))
    if 0 <= k < len(avatars):
        raise InputError(f"{person} is the id of avatar {avatars[k].name!r}, whose pose comes from its source")


def is_present(simulation: OrderTarget, person: int, environment: int) -> bool:
    """Return whether a person or robot with this id is present."""
    world = simulation.world
    return bool((world.scene.active[environment] & (world.ids[environment] == person)).any())
