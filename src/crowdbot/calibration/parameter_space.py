"""ParameterSpace: the calibrated parameters, their bounds, and how they are applied to a crowd."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import InputError, Parameter, Scene, did_you_mean, kebab_case, parameters
from crowdbot.data import Windows, fill_gaps, observed_velocity
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats

from .rollout import Rollout, set_preferred_speed

RADIUS = Parameter("radius", "m", 0.25, 0.1, 0.4, "half the width of shoulders", 0.01)
"""Radius of people. It belongs to the scene, and is calibrated together with the model parameters."""
PREFERRED_SPEED = Parameter("preferred_speed", "m/s", 1.34, 0.0, 2.5, "Weidmann 1993")
"""Preferred walking speed; without calibration, the observed speed of each person."""


@dataclass(frozen=True)
class ParameterSpace:
    """D parameters of each person: those of the model, then radius and preferred speed.

    Fields:
        model: the crowd model; parameters that are not free keep their values.
        free: names of the calibrated parameters; empty means all.
        shared: one set for all people; the preferred speed is then the observed speed of each person.

    Raises:
        InputError: a name is not a parameter.

    >>> from crowdbot.models import ORCA
    >>> ParameterSpace(ORCA(), ("radius", "time_horizon")).names
    ('time_horizon', 'radius')
    """

    model: CrowdModel
    free: tuple[str, ...] = ()
    shared: bool = False

    def __post_init__(self) -> None:
        known = [row.name for row in self._all]
        for name in self.free:
            if name.replace("-", "_") not in known:
                raise InputError(
                    f"calibration: {kebab_case(type(self.model).__name__)} has no parameter {name!r} to calibrate"
                    f"{did_you_mean(name, known)}; it has {', '.join(known)}"
                )

    @property
    def _all(self) -> tuple[Parameter, ...]:
        own = (*parameters(self.model), RADIUS)
        return own if self.shared else (*own, PREFERRED_SPEED)

    @property
    def table(self) -> tuple[Parameter, ...]:
        """Rows of the parameter table for the calibrated parameters."""
        chosen = {name.replace("-", "_") for name in self.free}
        return tuple(row for row in self._all if not chosen or row.name in chosen)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the D parameters."""
        return tuple(row.name for row in self.table)

    @property
    def low(self) -> Floats:
        """Lower bounds ``[D]``."""
        return np.array([row.low for row in self.table])

    @property
    def high(self) -> Floats:
        """Upper bounds ``[D]``."""
        return np.array([row.high for row in self.table])

    def initial_values(self, past: Windows, rollout: Rollout) -> Floats:
        """Return the initial values ``[W, A, D]``; speeds are the observed speeds.

        Raises:
            InputError: a free parameter of the model already has one value per agent.
        """
        velocity = rollout.goal.velocity(fill_gaps(past))
        observed = np.sqrt(velocity[..., 0] ** 2 + velocity[..., 1] ** 2)
        values = np.zeros((*observed.shape, len(self.table)))
        for column, row in enumerate(self.table):
            value = {RADIUS.name: rollout.radii(past), PREFERRED_SPEED.name: observed}.get(row.name)
            if value is None:
                value = getattr(self.model, row.name)
                if np.ndim(value) > 0:
                    raise InputError(
                        f"calibration: {row.name} must be one number before a calibration, not one for each agent"
                    )
            values[..., column] = value
        return values

    def with_mean_speed(self, past: Windows, values: Floats) -> Floats:
        """Return the values ``[W, A, D]`` with the mean speed over all rows, which is less noisy."""
        values = values.copy()
        velocity = observed_velocity(past, past.position.shape[1])
        for column, name in enumerate(self.names):
            if name == PREFERRED_SPEED.name:
                values[..., column] = np.sqrt(velocity[..., 0] ** 2 + velocity[..., 1] ** 2)
        return values

    def apply(self, rollout: Rollout, values: Floats) -> Rollout:
        """Return the rollout with these values, ``[W, A, D]``, or ``[D]`` for all people."""
        one = values.ndim == 1
        columns = {name: (float(values[k]) if one else values[..., k]) for k, name in enumerate(self.names)}
        radius: Any = columns.pop(RADIUS.name, rollout.radius)
        speed: Any = columns.pop(PREFERRED_SPEED.name, rollout.preferred_speed)
        model = dataclasses.replace(self.model, **columns) if columns else self.model
        return dataclasses.replace(rollout, model=model, radius=radius, preferred_speed=speed)

    def apply_to_scene(self, rollout: Rollout, scene: Scene, values: Floats) -> tuple[Rollout, Scene]:
        """Return rollout and scene with the values ``[E, A, D]`` of each agent."""
        taken = self.apply(rollout, values)
        if RADIUS.name in self.names:
            scene = scene.replace(radius=np.ascontiguousarray(taken.radius))
        if taken.preferred_speed is not None:
            scene = set_preferred_speed(scene, np.ascontiguousarray(taken.preferred_speed))
        return taken, scene
