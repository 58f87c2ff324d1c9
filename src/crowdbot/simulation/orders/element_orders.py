"""Orders that change the trial of a running simulation: its values, and elements such as robots, props and exits."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError
from crowdbot.simulation.mounted_sensor import needs_bodies
from crowdbot.simulation.overrides import apply_overrides, check_overrides
from crowdbot.trials import Trial, add_element, apply_values, needs_trust, remove_element

from .order import Order, OrderTarget


@dataclass(frozen=True, kw_only=True)
class TrialOrder(Order):
    """Base of orders that change the trial; E = 1, since a trial belongs to all environments."""

    @abstractmethod
    def new_trial(self, simulation: Any) -> Trial:
        """Return the changed trial."""

    def check(self, simulation: OrderTarget) -> None:
        super().check(simulation)
        if simulation.count > 1:
            name = type(self).__name__
            raise InputError(f"{name}: a trial belongs to all environments; use a simulation of one environment")
        check_overrides(simulation, self.new_trial(simulation), added=True)

    def apply(self, simulation: Any) -> None:
        apply_overrides(simulation, self.new_trial(simulation))


@dataclass(frozen=True, kw_only=True)
class ParameterOrder(TrialOrder):
    """Change a value of the trial, such as ``crowd.neighbor-distance`` or ``robot.goal.x``; E = 1.

    Fields:
        path: path of the value, see :class:`crowdbot.trials.Sweep`.
        value: the new value as text.
    """

    path: str
    value: str

    def new_trial(self, simulation: Any) -> Trial:
        trial: Trial = simulation.trial
        return apply_values(trial, {self.path: self.value}, place=f"order parameter of trial {trial.name!r}")


@dataclass(frozen=True, kw_only=True)
class AddElementOrder(TrialOrder):
    """Add a robot, a prop, a wall, an exit or a sensor to the running trial.

    The new trial is checked like a file. Code and files outside the folder of the trial are not loaded. A new robot
    starts at rest at its place, and gets the next free id.

    Fields:
        xml: the element, such as ``<cube x="1" y="2"/>``.
        parent: path of the element that gets it, such as ``stage``; empty for the trial itself.

    >>> from crowdbot.simulation import Simulation
    >>> from crowdbot.trials import load_trial
    >>> simulation = Simulation(load_trial("frontal"), 0)
    >>> order = AddElementOrder(xml='<cube x="0" y="1"/>', parent="stage")
    >>> order.check(simulation)
    >>> order.apply(simulation)
    >>> len(simulation.trial.stage.props)
    1
    """

    xml: str
    parent: str = ""

    def new_trial(self, simulation: Any) -> Trial:
        trial: Trial = simulation.trial
        place = f"order add-element of trial {trial.name!r}"
        new = add_element(trial, self.xml, self.parent, place=place, trust=needs_trust(trial))
        if needs_bodies(new) and not needs_bodies(trial):
            raise InputError(
                f"{place}: a sensor of the new element sees the bodies of people, and this run has none; run the trial"
                ' with bodies="limbs" and a sensor, or give the element sensors that measure discs, such as lidar2d'
            )
        return new


@dataclass(frozen=True, kw_only=True)
class RemoveElementOrder(TrialOrder):
    """Remove a robot, a prop, a wall, an exit or a sensor from the running trial.

    Fields:
        path: path of the element, such as ``robot[pepper]`` or ``stage/cube[2]``.
    """

    path: str

    def new_trial(self, simulation: Any) -> Trial:
        trial: Trial = simulation.trial
        place = f"order remove-element of trial {trial.name!r}"
        return remove_element(trial, self.path, place=place, trust=needs_trust(trial))
