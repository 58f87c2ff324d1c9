"""Times of steps of two engines, measured in turn, so that other work on the machine slows both."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

Start = Callable[[], Callable[[], object]]
"""Makes an engine at the start, and returns the function that makes one step of it."""


def time_steps(ours: Start, theirs: Start, steps: int, repeats: int) -> NDArray[np.float64]:
    """Return the mean time [s] of a step of both engines, ``[2, repeats]``.

    Each repetition begins at the start in both engines, with one step that is not timed.

    >>> def start(count):
    ...     return lambda: (lambda: sum(range(count)))
    >>> found = time_steps(start(1), start(10_000), 5, 3)
    >>> bool((found[0] < found[1]).all()), found.shape
    (True, (2, 3))
    """
    found = np.empty((2, repeats))
    for k in range(repeats):
        for row, start in enumerate((ours, theirs)):
            step = start()
            step()
            begin = time.perf_counter()
            for _ in range(steps):
                step()
            found[row, k] = (time.perf_counter() - begin) / steps
    return found


@contextmanager
def kernel_threads(count: int) -> Iterator[None]:
    """Run kernels in ``count`` threads inside of the context."""
    import numba

    before = numba.get_num_threads()
    numba.set_num_threads(count)
    try:
        yield
    finally:
        numba.set_num_threads(before)
