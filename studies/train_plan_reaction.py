"""Fits how people react to the plan of a robot, and scores the fit on encounters that it did not see.

    python studies/train_plan_reaction.py train DATA OUT
    python studies/train_plan_reaction.py train DATA OUT --citr
    python studies/train_plan_reaction.py score DATA OUT

DATA holds eth_ucy_splits/ and citr/ in the formats of their authors. `train` writes OUT/plan-reaction-open.npz, the
coefficients that ship: simulated encounters of four crowd models and encounters of people in the UCY recordings, whose
terms allow it. With --citr it learns from all CITR runs, whose terms are not stated, and writes
OUT/plan-reaction-citr.npz: AnchorNet(reaction="OUT/plan-reaction-citr.npz") uses them.
`score` prints the errors on simulated encounters of another seed, on UCY recordings left out, and on CITR, where no run
was learned from, or all others (one run left out after the other).
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from citr_runs import cart_windows, citr_runs
from crowdbot.core import InputError
from crowdbot.data import Windows, load
from crowdbot.prediction import AnchorNet, Kalman
from crowdbot.prediction.anchor_net.plan_reaction import PlanReaction
from crowdbot.prediction.anchor_net.reaction_fit import ReactionSamples, fit_reaction
from training_crowds import people_encounters, robot_encounters

ROOM = 0.3
"""Distance to the surface of a robot that people keep [m]."""
ROOMS = (0.2, 0.3, 0.45, 0.6, 1.0)
"""Distances that `score` compares."""
CREDITED = {"crowds_zara01": 6, "crowds_zara02": 6, "crowds_zara03": 6, "students001": 40, "students003": 40}
"""UCY recordings, and the distance of their windows."""
SCENES = 30
"""Simulated scenes per crowd model and kind of encounter."""
REAL = 30
"""Weight of a real recording, relative to a crowd model and kind of encounter: the largest of 3, 10, 30 and 100 with
which simulated encounters of another seed do not get worse."""

Pairs = dict[str, tuple[Windows, Windows]]
Groups = list[ReactionSamples]


def real_encounters(data: Path) -> Pairs:
    """Return the encounters of people in the UCY recordings."""
    train = data / "eth_ucy_splits/train"
    return {name: people_encounters(load(train / f"{name}_train.txt", fps=25), n) for name, n in CREDITED.items()}


def citr_encounters(data: Path) -> Pairs:
    """Return the encounters with the golf cart of CITR by run, with its plan."""
    pairs = {}
    for people, cart in citr_runs(data):
        try:
            pairs[people.stem] = cart_windows(people, cart)
        except InputError:  # the run is too short
            continue
    return pairs


def samples_of(pairs: Pairs, room: float, net: bool) -> dict[str, ReactionSamples]:
    """Return what AnchorNet misses without reaction, or the Kalman filter for people whom AnchorNet learned from."""
    predictor = AnchorNet("open", reaction="none") if net else Kalman()
    return {name: ReactionSamples.of(predictor, *pair, room) for name, pair in pairs.items()}


def shipped_fit(simulated: Sequence[ReactionSamples], real: Sequence[ReactionSamples], room: float) -> PlanReaction:
    """Return the coefficients from simulated and real encounters."""
    return fit_reaction([*simulated, *(item for item in real for _ in range(REAL))], room)


def errors(samples: Sequence[ReactionSamples], reaction: PlanReaction) -> np.ndarray:
    """Return sums of the errors without and with reaction over rows [m], and the number of rows."""
    found = np.zeros(3)
    for sample in samples:
        moved = sample.displacements(reaction)
        known = ~np.isnan(sample.missed[..., 0])
        found += [np.linalg.norm(rest[known], axis=1).sum() for rest in (sample.missed, sample.missed - moved)] + [
            known.sum()
        ]
    return found


def train(options: argparse.Namespace) -> None:
    """Fit and write the coefficients."""
    if options.citr:
        groups = samples_of(citr_encounters(options.data), ROOM, net=True)
        reaction, name = fit_reaction([*groups.values()], ROOM), "plan-reaction-citr.npz"
    else:
        simulated = samples_of(robot_encounters(SCENES), ROOM, net=True)
        real = samples_of(real_encounters(options.data), ROOM, net=False)
        reaction, name = shipped_fit([*simulated.values()], [*real.values()], ROOM), "plan-reaction-open.npz"
    numbers: dict[str, Any] = reaction.numbers()
    np.savez(options.out / name, **numbers)
    said = ", ".join(f"{field} {np.round(values, 2).tolist()}" for field, values in reaction._asdict().items())
    print(f"{options.out / name}: {said}")


def score(options: argparse.Namespace) -> None:
    """Print the table of errors without and with reaction, by room."""
    simulated, other = robot_encounters(SCENES), robot_encounters(SCENES // 2, seed=1)
    real, citr = real_encounters(options.data), citr_encounters(options.data)
    print(
        "| room [m] | simulated, other seed | UCY, left out | CITR | CITR, learned from other runs |\n"
        + "|---" * 5
        + "|"
    )
    for room in ROOMS:
        seen, unseen, cart = (samples_of(pairs, room, net=True) for pairs in (simulated, other, citr))
        people = samples_of(real, room, net=False)
        shipped = shipped_fit([*seen.values()], [*people.values()], room)
        left_out = np.zeros(3)
        for name, own in people.items():
            rest = [person for other_name, person in people.items() if other_name[:8] != name[:8]]
            left_out += errors([own], shipped_fit([*seen.values()], rest, room))
        runs = np.zeros(3)
        for name, own in cart.items():
            if len(own.missed):
                runs += errors([own], fit_reaction([item for n, item in cart.items() if n != name], room))
        cells = (errors([*unseen.values()], shipped), left_out, errors([*cart.values()], shipped), runs)
        print(f"| {room} | " + " | ".join(_cell(cell) for cell in cells) + " |", flush=True)


def _cell(cell: np.ndarray) -> str:
    before, after = cell[:2] / cell[2]
    return f"{before:.3f} -> {after:.3f} ({100.0 * (after / before - 1.0):+.1f} %, {int(cell[2])} rows)"


def main() -> None:
    """Do what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("train", "score"))
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--citr", action="store_true", help="learn from CITR instead of simulated and UCY encounters")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    (train if options.what == "train" else score)(options)


if __name__ == "__main__":
    main()
