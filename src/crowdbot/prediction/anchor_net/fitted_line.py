"""Least-squares lines through observed tracks, as coefficients of the residuals to constant velocity."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .agent_frame import PREDICTED_ROWS, ROWS, rotate

__all__ = ["LINE_SHARE", "line_coefficients"]

Floats = NDArray[np.float64]

LINE_SHARE = 0.2
"""Share of the least-squares line in the single trajectory of weights for other places. The last displacement, the base
of the network, is inaccurate in measured tracks. Chosen on five of six data sets that no training saw, the share is
0.15, 0.3 or (four times) 0.2."""


def line_coefficients(past: Floats, heading: Floats, basis: Floats) -> Floats:
    """Return coefficients ``[N, D]`` of the least-squares lines through tracks, in their frames.

    Args:
        past: ``[N, 8, 2]`` [m] tracks relative to their last position.
        heading: ``[N, 2]`` directions of the frames.
        basis: ``[D, 24]`` residuals of the coefficients, orthonormal.

    >>> straight = np.linspace([-2.8, 0.0], [0.0, 0.0], 8)[None]
    >>> bool(np.allclose(line_coefficients(straight, np.array([[1.0, 0.0]]), np.eye(24)[:6]), 0.0))
    True
    """
    row = np.arange(ROWS) - 0.5 * (ROWS - 1)
    middle, slope = np.zeros((len(past), 2)), np.zeros((len(past), 2))
    for number in range(ROWS):  # summation order independent of the batch
        middle += past[:, number] / ROWS
        slope += row[number] * past[:, number] / float((row * row).sum())
    ahead = np.arange(1.0, PREDICTED_ROWS + 1.0)[:, None]
    start = middle + row[-1] * slope
    step = past[:, -1] - past[:, -2]
    residual = rotate(start[:, None] + (slope - step)[:, None] * ahead, heading).reshape(len(past), 2 * PREDICTED_ROWS)
    found = np.zeros((len(past), len(basis)))
    for column in range(residual.shape[1]):
        found += residual[:, column, None] * basis[:, column]
    return found
