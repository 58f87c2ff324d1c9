"""Check that a user-defined calibration cost fulfils the contract."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, stream
from crowdbot.data import Windows, example_windows

from .cost import Cost
from .resimulation import ResimulatedTracks

ERROR = (0.0, 0.1, 0.5)
"""Maximum deviation [m] of the candidates from the recording."""


def check_cost(cost: Cost) -> None:
    """Check a cost with three candidates; the first one reproduces the recording exactly.

    Raises:
        InputError: the cost violates a rule of the contract.

    >>> from crowdbot.calibration import Absolute
    >>> check_cost(Absolute())
    """
    name = type(cost).__name__
    if not isinstance(cost, Cost):
        raise InputError(f"{name} is not a Cost")
    parameters = getattr(cost, "__dataclass_params__", None)
    if parameters is None or not parameters.frozen:
        raise InputError(f"{name} is not frozen; decorate the class with @dataclass(frozen=True)")
    past = example_windows()
    value = np.asarray(cost.measure(_candidates(past)))
    wanted = [len(ERROR), *past.robot.shape]
    if list(value.shape) != wanted:
        raise InputError(f"{name}.measure returned shape {list(value.shape)}, it must be [P, W, A] = {wanted}")
    counted = ~np.isnan(value)
    if np.any(counted != counted[:1]):
        raise InputError(
            f"{name}.measure: the people who count must depend on the recording only, not on the candidate"
        )
    if np.any(counted[0] & past.robot):
        raise InputError(f"{name}.measure counts robots; their cost must be NaN")
    if not np.any(counted):
        raise InputError(f"{name}.measure counts nobody")
    if np.any(value[counted] < 0.0) or not np.all(np.isfinite(value[counted])):
        raise InputError(f"{name}.measure must be finite and at least 0 for people who count")
    if np.any(value[0][counted[0]] > np.max(value[1:], axis=0)[counted[0]]):
        raise InputError(f"{name}.measure: the candidate that reproduces the recording must not be the worst")
    for window in range(len(past)):
        alone = np.asarray(cost.measure(_candidates(past, window)))[:, 0]
        if not np.array_equal(alone, value[:, window], equal_nan=True):
            raise InputError(f"{name}.measure of window {window} differs when it is computed alone")


def _candidates(past: Windows, window: int | None = None) -> ResimulatedTracks:
    """Return tracks that deviate from the recording by :data:`ERROR`, of all windows or one."""
    noise = stream(0, "contract").uniform(-1.0, 1.0, past.position.shape)
    tracks = past.position + np.array(ERROR)[:, None, None, None, None] * noise
    if window is not None:
        past, tracks = past[window : window + 1], tracks[:, window : window + 1]

    def rows_from(first: int) -> NDArray[np.float64]:
        return tracks[:, :, first:]

    return ResimulatedTracks(past, lambda: rows_from(1), lambda: rows_from(2))
