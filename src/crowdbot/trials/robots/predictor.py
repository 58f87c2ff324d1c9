"""Predictor of a robot, with which its navigator forecasts people."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from crowdbot.core import InputError, kebab_case
from crowdbot.core.fields import attribute, check, mounted_field, quote_value
from crowdbot.navigation import MPCNavigator, Navigator
from crowdbot.prediction import WEIGHTS_FIELDS, Predictor
from crowdbot.trials.files.trial_files import resolve_file

SAME = 1e-6
"""Tolerance of times [s] and of numbers of steps."""


@dataclass(frozen=True, kw_only=True)
class RobotPredictor:
    """Predictor of a robot: the default of ``observation.forecast``.

    It is a built-in predictor (``crowdbot list predictors``) or an address such as ``mine.py:Mine``.

    Raises:
        InputError: a value is not allowed, the weights do not exist, or the predictor requires the future.

    >>> from crowdbot.prediction import ConstantVelocity
    >>> RobotPredictor(predictor=ConstantVelocity()).build()
    ConstantVelocity(displacements=1)
    """

    predictor: Predictor = mounted_field("prediction", "Predictor", about="predictor")
    weights: str = attribute(
        "",
        about="weights of a learned predictor, a file of crowdbot train in the folder of the trial (default: shipped)",
    )
    step: float | None = attribute(
        None,
        about="time between rows of the tracks and of the forecast (default: the control period)",
        unit="s",
        exclusive_min=0.0,
        max=10.0,
    )
    folder: Path | None = dataclasses.field(default=None, compare=False, repr=False)
    trust: bool = dataclasses.field(default=True, compare=False, repr=False)
    """Folder of the weights, and whether they may lie outside; not part of the XML."""

    def __post_init__(self) -> None:
        self._take_weights()
        check(self)
        kind = kebab_case(type(self.predictor).__name__)
        if self.weights and not self._weights_field:
            raise InputError(f"has weights={quote_value(self.weights)}, but {kind} takes none; leave them out")
        if self.weights:
            try:
                self.build()
            except InputError as error:
                raise InputError(f"weights={quote_value(self.weights)}: {error}") from None
        goal = getattr(self.predictor, "goal", None)
        if getattr(goal, "knows_future", False):
            raise InputError(
                f"has the goal {kebab_case(type(goal).__name__)}, which requires the future; take current-direction"
            )

    def build(self) -> Predictor:
        """Return the predictor with its weights.

        Raises:
            InputError: the file of the weights does not exist, or lies outside the folder of the trial.
        """
        return self._built

    def files(self) -> tuple[Path, ...]:
        """Return the file of the weights."""
        return (resolve_file(self.weights, self.folder, self.trust),) if self.weights else ()

    @functools.cached_property
    def _built(self) -> Predictor:
        if not self.weights:
            return self.predictor
        path = resolve_file(self.weights, self.folder, self.trust)
        return dataclasses.replace(self.predictor, **{self._weights_field: str(path)})

    @property
    def _weights_field(self) -> str:
        """Name of the parameter that takes the file of the weights; empty for a predictor that is not learned."""
        names = (kebab_case(kind.__name__) for kind in type(self.predictor).__mro__)
        return next((WEIGHTS_FIELDS[name] for name in names if name in WEIGHTS_FIELDS), "")

    def _take_weights(self) -> None:
        """Move weights that were given to the predictor itself to :attr:`weights`."""
        name = self._weights_field
        given = getattr(self.predictor, name) if name else ""
        if not given or getattr(self.predictor, "is_pretrained", False):
            return
        default = next(field.default for field in dataclasses.fields(self.predictor) if field.name == name)
        object.__setattr__(self, "weights", self.weights or given)
        object.__setattr__(self, "predictor", dataclasses.replace(self.predictor, **{name: default}))


def forecast_problems(
    predictor: RobotPredictor | None, tracks: float | None, control_period: float, navigator: Navigator | None = None
) -> Iterator[str]:
    """Yield why a robot cannot use its predictor.

    Args:
        predictor: the predictor, or None.
        tracks: time span of the tracks of the robot [s], or None.
        control_period: time between their rows [s].
        navigator: navigator of the robot.

    >>> from crowdbot.prediction import ConstantVelocity
    >>> list(forecast_problems(RobotPredictor(predictor=ConstantVelocity()), None, 0.1))
    ['has <predictor> but no tracks to predict from; add tracks="4"']
    """
    if predictor is None:
        if isinstance(navigator, MPCNavigator) and navigator.mixture:
            yield (
                'has <navigator type="mpc" mixture="true"/> but no predictor; add tracks="3.2" and'
                ' <predictor type="anchor-net" step="0.4"/>'
            )
        return
    if tracks is None:
        yield 'has <predictor> but no tracks to predict from; add tracks="4"'
    elif predictor.step is not None:
        step, steps = predictor.step, predictor.step / control_period
        if round(steps) < 1 or abs(steps - round(steps)) > SAME:
            yield f'has <predictor step="{step:g}"/>, no multiple of its control period of {control_period:g} s'
        elif step > tracks + SAME:
            yield f'has <predictor step="{step:g}"/> but tracks="{tracks:g}", which hold no earlier row'
