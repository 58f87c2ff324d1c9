"""Number of the description of a scene, which changes when people, robots or props are added or removed."""

from __future__ import annotations

import itertools
import threading
import weakref
from typing import Any

_numbers: dict[int, tuple[weakref.ref[Any], int]] = {}
_count = itertools.count(1)
_lock = threading.Lock()


def scene_revision(simulation: Any, motion: Any) -> int:
    """Return a number that is the same as long as the description of the scene is.

    Args:
        simulation: the simulation; an order that changes elements gives it another trial.
        motion: its people; an order can add some.
    """
    return (_number(simulation.trial) * 65_536 + len(motion.agents)) % 2**32


def _number(trial: Any) -> int:
    """Return the number of a trial object. Trials that are equal can be different objects, with different numbers."""
    key = id(trial)
    with _lock:
        known = _numbers.get(key)
        if known is None or known[0]() is not trial:
            known = _numbers[key] = (weakref.ref(trial, lambda gone: _forget(key, gone)), next(_count))
        return known[1]


def _forget(key: int, gone: weakref.ref[Any]) -> None:
    known = _numbers.get(key)
    if known is not None and known[0] is gone:
        del _numbers[key]
