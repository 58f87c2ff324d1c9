"""The runs of CITR with a golf cart, in windows with the plan of the cart.

Yang et al., Top-view trajectories: a pedestrian dataset of vehicle-crowd interaction, IEEE IV 2019.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from crowdbot.data import Trajectories, Windows, load

BODY, CART = 0.25, 0.9
"""Radii of a person and of the golf cart [m]; the cart is 1.2 m wide and 2.4 m long."""
OBSERVED, PREDICTED = 5, 8
"""Rows of the windows: 1.6 s are observed, 3.2 s predicted, since the runs are short."""
PLANNED = 12
"""Rows of the plan of the cart: where it drives, and straight on where its recording ends."""
RATE, STEP = 29.97, 0.4
"""Rate of the recordings [Hz], and time step of the windows [s]."""


def citr_runs(data: Path) -> Iterator[tuple[Path, Path]]:
    """Yield the files of people and cart of the runs with a cart."""
    for people in sorted(data.glob("citr/vci_*/*ped_filtered.csv")):
        cart = people.with_name(people.name.replace("ped_filtered", "veh_filtered"))
        if cart.is_file():
            yield people, cart


def joined(people: Path, cart: Path) -> Trajectories:
    """Return people and cart as one recording at 0.4 s."""
    one, other = (load(path, fps=RATE, columns={"x": "x_est", "y": "y_est"}) for path in (people, cart))
    number = int(one.id.max()) + 1
    both = Trajectories(
        np.concatenate([one.id, np.full(len(other), number)]), np.concatenate([one.frame, other.frame]),
        np.concatenate([one.x, other.x]), np.concatenate([one.y, other.y]), row_rate=RATE, frame_step=1,
        name=people.name, robots=frozenset({number}),
    )  # fmt: skip
    return both.resample(STEP)


def cart_windows(people: Path, cart: Path) -> tuple[Windows, Windows]:
    """Return past and future, with the plan of the cart and all radii.

    Raises:
        DataError: the run is too short.
    """
    tracks = joined(people, cart)
    past, future = tracks.windows(observe=OBSERVED, predict=PREDICTED)
    (number,) = tracks.robots
    own = tracks.id == number
    place = dict(zip(tracks.frame[own].tolist(), np.stack([tracks.x[own], tracks.y[own]], axis=1), strict=True))
    step = int(future.frame[0, 1] - future.frame[0, 0])
    plan = np.full((len(past), PLANNED, past.present.shape[2], 2), np.nan)
    for window, slot in zip(*np.nonzero(past.robot & past.present[:, -2:].all(axis=1)), strict=True):
        now = int(past.frame[window, -1])
        drive = [past.position[window, -2, slot], past.position[window, -1, slot]]
        for row in range(1, PLANNED + 1):
            drive.append(place.get(now + row * step, 2.0 * drive[-1] - drive[-2]))
        plan[window, :, slot] = drive[2:]
    return dataclasses.replace(past, plan=plan, radius=np.where(past.robot, CART, BODY)), future
