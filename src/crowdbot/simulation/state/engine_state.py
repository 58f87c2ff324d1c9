"""State of the physics engine: one vector for each set of rigid bodies that is simulated together."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["has_engine", "read_engine", "update_engine", "write_engine"]

Floats = NDArray[np.float64]


def has_engine(value: Any) -> bool:
    """Return whether an object is a set of rigid bodies with an engine state of its own."""
    return type(value).__name__ == "RigidBodies"


def read_engine(bodies: Any) -> Floats:
    """Return the state of the engine of such a set."""
    import mujoco as mj

    model, spec = bodies.compiled.base, mj.mjtState.mjSTATE_INTEGRATION
    state = np.zeros(mj.mj_stateSize(model, spec))
    mj.mj_getState(model, bodies.data, state, spec)
    return state


def write_engine(bodies: Any, state: Floats) -> None:
    """Set the state of the engine; :func:`update_engine` computes the frames afterwards."""
    import mujoco as mj

    mj.mj_setState(bodies.compiled.base, bodies.data, state, mj.mjtState.mjSTATE_INTEGRATION)


def update_engine(world: Any) -> None:
    """Compute the frames of all bodies of a world; the models get the limbs of people as after a step."""
    rigid = getattr(world, "rigid", None)
    if rigid is None:
        return
    with rigid.engine_steps():
        pass
    for ghost in rigid.ghosts.values():
        ghost.step_alone(0)
