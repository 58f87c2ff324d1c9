"""Steps of two other headed social force models from random states, against which the tests hold ours.

``PYTHONPATH=JHSFM:SOCIAL_NAVIGATION_PYENVS python tools/headed_states.py`` writes
``tests/models/golden/headed_states.npz``. It needs jax and checkouts of TommasoVandermeer/JHSFM (commit cd1d670) and
TommasoVandermeer/Social-Navigation-PyEnvs (commit 114ea50). 50 crowds with 20 people each: states, and velocities along
the heading, left of it, and angular velocities after a step.
"""

from __future__ import annotations

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

jax.config.update("jax_enable_x64", True)
jnp.float32 = jnp.float64  # a constant of JHSFM has this type, which its own lax.cond rejects beside 64 bits

from crowd_nav.policy_no_train.hsfm_farina import HSFMFarina  # noqa: E402
from crowd_nav.utils.state import FullStateHeaded, JointState, ObservableState  # noqa: E402
from jhsfm.hsfm import get_linear_velocity, step  # noqa: E402
from jhsfm.utils import get_standard_humans_parameters  # noqa: E402

FILE = Path(__file__).parents[1] / "tests/models/golden/headed_states.npz"
CROWDS, PEOPLE, DT = 50, 20, 0.001
RADIUS, NEAREST = 0.3, 0.5
"""Radius, and smallest distance of two people [m]: some are in contact."""
WALL = [(-9.0, -2.7), (9.0, -2.7)]
WALL_SLIDING, SPEED = 9, 2
"""Columns of the parameters of JHSFM: tangential force of walls, desired and maximum speed."""


def states(rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Return people at random places above the wall, with velocities, headings, turns and goals."""
    place: list[np.ndarray] = []
    while len(place) < PEOPLE:
        new = rng.uniform(-2.4, 2.4, 2)
        if all(np.hypot(*(new - other)) >= NEAREST for other in place):
            place.append(new)
    way, speed = rng.uniform(-np.pi, np.pi, PEOPLE), rng.uniform(0.0, 0.8, PEOPLE)
    return {
        "position": np.array(place),
        "velocity": np.stack([speed * np.cos(way), speed * np.sin(way)], axis=-1),
        "heading": rng.uniform(-np.pi, np.pi, PEOPLE),
        "angular_velocity": rng.normal(0.0, 1.0, PEOPLE),
        "goal": rng.uniform(5.0, 9.0, (PEOPLE, 2)),
        "preferred_speed": rng.uniform(0.9, 1.6, PEOPLE),
    }


def along_heading(people: dict[str, np.ndarray]) -> np.ndarray:
    """Return the velocities along the headings and left of them, ``[A, 2]`` [m/s]."""
    return np.stack([get_linear_velocity(-h, v) for h, v in zip(people["heading"], people["velocity"], strict=True)])


def jhsfm(people: dict[str, np.ndarray]) -> np.ndarray:
    """Return the velocities after a step of JHSFM beside a wall, ``[A, 3]``."""
    columns = (people["position"], along_heading(people), people["heading"], people["angular_velocity"])
    state = jnp.column_stack([jnp.asarray(column) for column in columns])
    numbers = get_standard_humans_parameters(PEOPLE).at[:, SPEED].set(people["preferred_speed"])
    numbers = numbers.at[:, WALL_SLIDING].set(0.0)  # drives people along walls instead of braking them
    others = ~jnp.eye(PEOPLE, dtype=bool)
    walls = jnp.tile(jnp.array([[WALL]]), (PEOPLE, 1, 1, 1, 1))
    after = step(state, others, jnp.asarray(people["goal"]), numbers, walls, DT)
    return np.asarray(after)[:, [2, 3, 5]]


def farina(people: dict[str, np.ndarray]) -> np.ndarray:
    """Return the velocities after a step of the policy ``hsfm_farina``, which knows no walls, ``[A, 3]``."""
    policy, out = HSFMFarina(), []
    policy.time_step = DT
    own, place, velocity = along_heading(people), people["position"], people["velocity"]
    for a in range(PEOPLE):
        others = [ObservableState(*place[b], *velocity[b], RADIUS) for b in range(PEOPLE) if b != a]
        numbers = (*people["goal"][a], people["preferred_speed"][a], people["heading"][a])
        me = FullStateHeaded(*place[a], *own[a], RADIUS, *numbers, people["angular_velocity"][a])
        out.append(tuple(policy.predict(JointState(me, others))))
    return np.array(out)


def main() -> None:
    """Write the file."""
    rng = np.random.default_rng(2017)
    crowds = [states(rng) for _ in range(CROWDS)]
    values = {name: np.stack([people[name] for people in crowds]) for name in crowds[0]}
    values["jhsfm"] = np.stack([jhsfm(people) for people in crowds])
    values["farina2017"] = np.stack([farina(people) for people in crowds])
    np.savez_compressed(FILE, **values)
    print(f"{FILE}: {FILE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
