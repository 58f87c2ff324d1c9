"""DirectedSearch: the searches of calibration, for the worst or the most likely failure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy import special

from crowdbot.calibration import Search
from crowdbot.core import InputError
from crowdbot.typing import Floats

from .runner import MOST_SEEDS, SampleRunner
from .sampling import Sampling, SamplingResult

AIMS = ("worst", "likely")
EDGE = 1e-6
"""Distance of the box from 0 and 1, in shares of the distributions."""
FAR = 1e6
"""Cost of an impossible variant."""


@dataclass(frozen=True)
class DirectedSearch(Sampling):
    """A search of calibration over the shares of the distributions and the seed; it estimates no probability.

    The cost of ``worst`` is the robustness. That of ``likely`` is the robustness without a failure, and for a failure
    minus 1 over 1 plus the squared distance from the most likely point, so that the most likely failure is the best.

    Fields:
        method: the search.
        title: its name.
        aim: ``worst`` or ``likely``.

    >>> from crowdbot.calibration import CMAES
    >>> DirectedSearch(CMAES(), "cma-es", "likely").aim
    'likely'
    """

    method: Search
    title: str
    aim: str = "worst"

    name: ClassVar[str] = "directed"

    def __post_init__(self) -> None:
        if self.aim not in AIMS:
            raise InputError(f"aim {self.aim!r} must be {' or '.join(AIMS)}")

    def search(self, runner: SampleRunner, rng: np.random.Generator) -> SamplingResult:
        """Minimise the cost in the unit box of all factors and the seed."""
        sides = runner.dimensions + 1
        start = np.full((1, 1, 1, sides), 0.5)
        low, high = np.full(sides, EDGE), np.full(sides, 1.0 - EDGE)

        def cost(candidates: Floats, which: NDArray[np.int64]) -> Floats:
            shares = candidates[:, 0, 0, :]
            seeds = np.minimum((shares[:, -1] * MOST_SEEDS).astype(np.int64), MOST_SEEDS - 1)
            samples = runner.run(special.ndtri(shares[:, :-1]), seeds)
            values = np.array([self._cost(one.robustness, one.log_density) for one in samples])
            return values[:, None, None]

        self.method.minimize(cost, low, high, [rng], runner.budget, start)
        return SamplingResult(None, np.zeros(len(runner.samples)))

    def _cost(self, robustness: float, log_density: float) -> float:
        if not np.isfinite(robustness):
            return FAR
        if self.aim == "worst" or robustness > 0.0:
            return robustness
        return -1.0 / (1.0 - 2.0 * log_density)
