"""Safety layer of a robot in a trial."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from crowdbot.navigation import ExternalNavigator, SafetyLayer
from crowdbot.trials.fields import attribute, check

DEFAULT = SafetyLayer()


@dataclass(frozen=True, kw_only=True)
class SafetySpec:
    """Safety layer between the navigator and the drive, see :class:`crowdbot.navigation.SafetyLayer`.

    Raises:
        InputError: a value is not allowed.

    >>> SafetySpec(slow=0.2).layer().slow
    0.2
    """

    approach: float = attribute(
        DEFAULT.approach, about="speed at which people approach, K of ISO 13855", unit="m/s", min=0.0, max=10.0
    )
    response: float = attribute(
        DEFAULT.response, about="time from the measurement to the beginning of braking", unit="s", min=0.0, max=10.0
    )
    intrusion: float = attribute(
        DEFAULT.intrusion, about="distance for late or inexact detection, C of ISO 13855", unit="m", min=0.0, max=10.0
    )
    deceleration: float = attribute(
        DEFAULT.deceleration, about="braking deceleration", unit="m/s2", exclusive_min=0.0, max=1000.0
    )
    side: float = attribute(
        DEFAULT.side, about="width of the fields beyond the robot on each side", unit="m", min=0.0, max=10.0
    )
    warning: float = attribute(
        DEFAULT.warning, about="length of the warning field beyond the protective field", unit="m", min=0.0, max=100.0
    )
    slow: float = attribute(
        DEFAULT.slow, about="largest speed with a violated warning field", unit="m/s", exclusive_min=0.0, max=10.0
    )
    restart: float = attribute(
        DEFAULT.restart, about="time without a violation before the robot moves again", unit="s", min=0.0, max=3600.0
    )

    def __post_init__(self) -> None:
        check(self)

    def layer(self) -> SafetyLayer:
        """Return the safety layer."""
        return SafetyLayer(**{field.name: getattr(self, field.name) for field in dataclasses.fields(self)})


def safety_problems(safety: Any, navigator: Any) -> Iterator[str]:
    """Yield why a robot cannot have its safety layer."""
    if safety is not None and isinstance(navigator, ExternalNavigator):
        yield 'has <safety> in addition to <navigator type="external"/>, which decides nothing; leave it out'
