"""Orders: everything that a program outside asks of a running simulation."""

from __future__ import annotations

import dataclasses
import inspect
import json
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from crowdbot.core import InputError, Twist, did_you_mean, kebab_case
from crowdbot.trials import Trial
from crowdbot.world import World

MOST_TEXT = 1_000_000
"""Largest size of an order [characters]."""


class OrderTarget(Protocol):
    """What orders can change: a simulation."""

    trial: Trial
    world: World

    @property
    def count(self) -> int:
        """Number of environments."""

    def agent_of(self, robot: str) -> int:
        """Return the index of a robot, or raise an InputError."""

    def command(self, robot: str, twist: Twist, environment: int = 0) -> None:
        """Set the command of a robot."""


@dataclass(frozen=True, kw_only=True)
class Order(ABC):
    """A request from outside a simulation, applied in part 7 of a step, recorded, and applied again in a replay.

    Orders of one instant are applied in the order of ``environment``, then ``source``, then as given.

    Fields:
        environment: index of the environment.
        source: name of the program that asks, such as ``ros``; it orders requests of several programs.
    """

    environment: int = 0
    source: str = ""

    @abstractmethod
    def apply(self, simulation: OrderTarget) -> None:
        """Change the simulation; :meth:`check` has passed."""

    def check(self, simulation: OrderTarget) -> None:
        """Raise :class:`InputError` if the order is impossible now, for instance for an unknown environment."""
        if not 0 <= self.environment < simulation.count:
            raise InputError(
                f"{type(self).__name__}: environment = {self.environment} must be from 0 to {simulation.count - 1}"
            )


@dataclass(frozen=True, kw_only=True)
class VelocityOrder(Order):
    """Command a robot to move until its navigator, or the next order, decides otherwise.

    Fields:
        robot: name of the robot.
        forward, turn, left: velocity in the frame of the robot [m/s], [rad/s], [m/s].

    Raises:
        InputError: a velocity is not finite.

    >>> VelocityOrder(robot="pepper", forward=0.5).twist
    Twist(forward=0.5, turn=0.0, left=0.0)
    """

    robot: str
    forward: float = 0.0
    turn: float = 0.0
    left: float = 0.0

    def __post_init__(self) -> None:
        for name in ("forward", "turn", "left"):
            _check_number(self, name)

    @property
    def twist(self) -> Twist:
        """The velocity as a twist."""
        return Twist(float(self.forward), float(self.turn), float(self.left))

    def check(self, simulation: OrderTarget) -> None:
        super().check(simulation)
        simulation.agent_of(self.robot)
        if any(robot.name == self.robot and robot.mirror is not None for robot in simulation.trial.robots):
            raise InputError(f"VelocityOrder: robot {self.robot!r} has <pose>; it is where its source says")

    def apply(self, simulation: OrderTarget) -> None:
        simulation.command(self.robot, self.twist, self.environment)


def order_kinds() -> dict[str, type[Order]]:
    """Return the classes of orders by name, such as ``velocity``."""
    found: dict[str, type[Order]] = {}
    rest = list(Order.__subclasses__())
    while rest:
        kind = rest.pop()
        rest += kind.__subclasses__()
        if not inspect.isabstract(kind):
            found[order_name(kind)] = kind
    return dict(sorted(found.items()))


def order_name(kind: type[Order]) -> str:
    """Return the name of a class of orders: ``velocity`` for :class:`VelocityOrder`."""
    return kebab_case(kind.__name__.removesuffix("Order"))


def write_order(order: Order) -> str:
    """Return an order as JSON.

    >>> write_order(VelocityOrder(robot="pepper", forward=0.5))
    '{"order": "velocity", "robot": "pepper", "forward": 0.5}'
    """
    values = {"order": order_name(type(order))}
    for part in sorted(dataclasses.fields(order), key=lambda field: field.name in ("environment", "source")):
        value = getattr(order, part.name)
        if value != part.default:
            values[part.name] = value
    return json.dumps(values, allow_nan=False)


def read_order(text: str) -> Order:
    """Return an order from JSON.

    Raises:
        InputError: the text is not an order, or a value is not allowed.

    >>> read_order('{"order": "velocity", "robot": "pepper", "forward": 0.5}').forward
    0.5
    """
    if len(text) > MOST_TEXT:
        raise InputError(f"an order has {len(text)} characters, at most {MOST_TEXT} are allowed")
    try:
        values: Any = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"an order is not JSON: {error}") from None
    if not isinstance(values, dict) or not isinstance(values.get("order"), str):
        raise InputError('an order must be a JSON object with "order", such as {"order": "velocity"}')
    kinds, name = order_kinds(), values.pop("order")
    if name not in kinds:
        raise InputError(f"order {name!r} is unknown{did_you_mean(name, kinds)}; known are {', '.join(kinds)}")
    return _checked(kinds[name], name, values)


def _checked(kind: type[Order], name: str, values: Mapping[str, Any]) -> Order:
    parts = {part.name: part for part in dataclasses.fields(kind)}
    for key, value in values.items():
        if key not in parts:
            raise InputError(
                f"order {name!r} has no value {key!r}{did_you_mean(key, parts)}; it has {', '.join(parts)}"
            )
        _check_type(name, key, str(parts[key].type), value)
    missing = [key for key, part in parts.items() if part.default is dataclasses.MISSING and key not in values]
    if missing:
        raise InputError(f"order {name!r} lacks {', '.join(missing)}")
    return kind(**values)


def _check_type(name: str, key: str, wanted: str, value: Any) -> None:
    kinds: dict[str, tuple[type, ...]] = {"float": (int, float), "int": (int,), "str": (str,), "bool": (bool,)}
    kinds["tuple[float, ...]"] = (list, tuple)
    allowed = tuple(item for part in wanted.split(" | ") for item in kinds.get(part, ()))
    if value is None and "None" in wanted:
        return
    if not isinstance(value, allowed) or (isinstance(value, bool) and bool not in allowed):
        raise InputError(f"order {name!r}: {key} = {value!r} must be of type {wanted}")


def _check_number(order: Order, name: str) -> None:
    value = getattr(order, name)
    if not (isinstance(value, int | float) and math.isfinite(value)):
        raise InputError(f"{type(order).__name__}: {name} = {value!r} must be a finite number")
