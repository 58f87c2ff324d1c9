"""Recorded experiments that people are fitted to: windows of single tracks, by place and kind of flow."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data import Recording, Trajectories, Windows, load

__all__ = ["FOLDS", "KINDS", "RecordedExperiment", "read_experiments"]

STEP, OBSERVE, PREDICT = 0.4, 8, 12
"""Time step of the rows [s], observed rows and predicted rows: 3.2 s and 4.8 s."""
FOLDS = 4
"""Parts of the cross-validation; a part has whole places or experiments."""
CART_FPS = 29.97
CART_ROWS = (2, 8)
"""Observed and predicted rows in CITR, whose tracks last 4 to 8 s: 3.2 s are predicted."""
KINDS = ("street", "one-way", "two-way", "bottleneck", "cart")


class _Source(NamedTuple):
    """A recording: path below the folder (``*`` matches several), kind of flow, and fold."""

    path: str
    kind: str
    fold: int


SOURCES = (
    _Source("eth_biwi/seq_eth/obsmat.txt", "street", 0),
    _Source("eth_biwi/seq_hotel/obsmat.txt", "street", 0),
    _Source("ucy/students03/obsmat.txt", "street", 1),
    _Source("ucy/students01/students001.txt", "street", 1),
    _Source("ucy/zara01/obsmat.txt", "street", 2),
    _Source("ucy/zara02/obsmat.txt", "street", 2),
    _Source("sdd_trajnet/Train/stanford/gates_*.txt", "street", 3),
    _Source("sdd_trajnet/Train/stanford/hyang_*.txt", "street", 3),
    _Source("hermes/Corridor-1D/uo-050-180-180.txt", "one-way", 0),
    _Source("hermes/Corridor-1D/uo-060-180-180.txt", "one-way", 0),
    _Source("hermes/Corridor-1D/uo-100-180-180.txt", "one-way", 1),
    _Source("hermes/Corridor-1D/uo-145-180-180.txt", "one-way", 1),
    _Source("hermes/Corridor-1D/uo-080-240-240.txt", "one-way", 2),
    _Source("hermes/Corridor-1D/uo-145-240-240.txt", "one-way", 2),
    _Source("hermes/Corridor-1D/uo-100-300-300.txt", "one-way", 3),
    _Source("hermes/Corridor-1D/uo-180-300-300.txt", "one-way", 3),
    _Source("hermes/Corridor-2D/bo-360-050-050.txt", "two-way", 0),
    _Source("hermes/Corridor-2D/bo-360-090-090.txt", "two-way", 1),
    _Source("hermes/Corridor-2D/bot-360-075-075.txt", "two-way", 2),
    _Source("hermes/Corridor-2D/boa-300-050-070.txt", "two-way", 3),
    _Source("juelich/bidirectional/bi_corr_400_b_03.txt", "two-way", 0),
    _Source("juelich/bottleneck/040_c_56_h-.txt", "bottleneck", 3),
    _Source("hermes/Corridor-1D/uo-180-180-070.txt", "bottleneck", 1),
    _Source("hermes/Corridor-1D/uo-180-180-120.txt", "bottleneck", 2),
    _Source("citr/vci_front/*_traj_ped_filtered.csv", "cart", 0),
    _Source("citr/vci_back/*_traj_ped_filtered.csv", "cart", 1),
    _Source("citr/vci_lat_uni/*_traj_ped_filtered.csv", "cart", 2),
    _Source("citr/vci_lat_bi/*_traj_ped_filtered.csv", "cart", 3),
)
"""Recordings of the same place, or of the same kind of encounter with the cart, are in the same fold."""


@dataclass(frozen=True, eq=False)
class RecordedExperiment:
    """Windows of one recording, or of several that belong together.

    Fields:
        name: name of the recording.
        kind: one of :data:`KINDS`.
        fold: part of the cross-validation, 0 to 3.
        parts: past and future of the windows of each recording; the plan of a cart is its recorded path.
    """

    name: str
    kind: str
    fold: int
    parts: tuple[tuple[Windows, Windows], ...]


def read_experiments(folder: Path, windows: int = 12, first: int = 0) -> tuple[RecordedExperiment, ...]:
    """Return the experiments of a folder, with some windows of each at equal distances.

    Args:
        folder: folder of the recordings, with the subfolders of :data:`SOURCES`.
        windows: windows of each experiment; those with most people are the most expensive.
        first: shift of the windows, for another sample of the same experiments.

    Raises:
        DataError: the folder contains none of the recordings.
    """
    found = []
    for source in SOURCES:
        paths = sorted(folder.glob(source.path))
        loaded = [item for item in (_windows(path, source.kind) for path in paths) if len(item[0])]
        total = sum(len(past) for past, _ in loaded)
        if total == 0:
            continue
        share = windows / total
        parts = [_sample(past, future, max(1, round(share * len(past))), first) for past, future in loaded]
        found.append(RecordedExperiment(_name(source), source.kind, source.fold, tuple(parts)))
    if not found:
        raise DataError(f"{folder} contains none of the recordings, such as {SOURCES[0].path}")
    return tuple(found)


def _name(source: _Source) -> str:
    """Return a short name: that of the file, or of its folder if the files have general names."""
    path = Path(source.path)
    if source.kind == "cart":
        return f"citr {path.parent.name}"
    return path.stem.rstrip("_*") if path.stem not in {"obsmat"} else path.parent.name


def _windows(path: Path, kind: str) -> tuple[Windows, Windows]:
    """Return the windows of a file in which somebody is scored."""
    if kind == "cart":
        past, future = _with_cart(path).resample(STEP).windows(*CART_ROWS)
        plan = np.where(past.robot[:, None, :, None], future.position, np.nan)
        past = dataclasses.replace(past, plan=plan)
    else:
        past, future = Recording(str(path), step=STEP, observe=OBSERVE, predict=PREDICT).windows
    kept = np.any(future.scored, axis=1)
    return past[kept], future[kept]


def _with_cart(path: Path) -> Trajectories:
    """Return the people and the cart of a run of CITR as one recording."""
    people = load(path, fps=CART_FPS)
    cart = load(path.with_name(path.name.replace("traj_ped", "traj_veh")), fps=CART_FPS)
    number = int(people.ids.max()) + 1

    def both(one: NDArray[Any], other: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate([one, other])

    return Trajectories(
        both(people.id, np.full(len(cart), number)), both(people.frame, cart.frame),
        both(people.x, cart.x), both(people.y, cart.y),
        row_rate=people.row_rate, frame_step=people.frame_step, name=people.name, robots=frozenset({number}),
    )  # fmt: skip


def _sample(past: Windows, future: Windows, count: int, first: int) -> tuple[Windows, Windows]:
    """Return windows at equal distances, shifted by ``first``."""
    chosen = np.unique((np.floor((np.arange(count) + 0.5) * len(past) / count).astype(np.int64) + first) % len(past))
    past, future = past[chosen], future[chosen]
    people = np.any(past.present[:, -1], axis=0)
    return _narrow(past, people), _narrow(future, people)


def _narrow(windows: Windows, people: NDArray[np.bool_]) -> Windows:
    """Return the windows without the columns of people who are never present at the last observed row."""
    return dataclasses.replace(
        windows,
        position=windows.position[:, :, people],
        present=windows.present[:, :, people],
        scored=windows.scored[:, people],
        robot=windows.robot[:, people],
        id=windows.id[:, people],
        plan=None if windows.plan is None else windows.plan[:, :, people],
    )
