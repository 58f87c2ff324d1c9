"""Trains the shipped weights of AnchorNet and Anchors on the leave-one-out files of ETH/UCY, and scores them.

    python tools/train_anchor_net.py train DATA OUT --fold eth hotel univ zara1 zara2 all --seed 0
    python tools/train_anchor_net.py score DATA OUT --seed 0

DATA holds train/, val/ and all_data/ as SGAN published them. A training that was stopped goes on where it was; one
that is done is not repeated. Only train/ of the other places is learned from; val/ of the other places gives the
temperature; the last weights are taken, so nothing is chosen by the place that is left out.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import time
from pathlib import Path

import numpy as np

from crowdbot.data import Trajectories, load
from crowdbot.metrics import Score
from crowdbot.prediction import AnchorNet, Anchors, ConstantVelocity, evaluate
from crowdbot.prediction.learned.anchor_data import Variation, gathered
from crowdbot.prediction.learned.anchor_training import AnchorTraining, calibrated, train
from crowdbot.prediction.places import ALL, FOLDS, kept_out

SMALL = ("basis", "centres", "spread", "width", "temperature", "widening")


def recordings(folder: Path, fold: str, left_out: bool = False) -> list[Trajectories]:
    """Return the recordings of a folder that belong to the training of a fold, or those that are left out."""
    found = [load(path, fps=2.5) for path in sorted(folder.glob("*.txt"))]
    return [tracks for tracks in found if kept_out(fold, tracks.name) == left_out]


def train_fold(options: argparse.Namespace, fold: str, seed: int) -> None:
    """Train, calibrate and write one fold."""
    name = f"anchor-net-{fold}" + (f"-seed{seed}" if seed else "")
    done = options.out / f"{name}.npz"
    if done.exists():
        print(f"{done} is there already")
        return
    used = recordings(options.data / "train", fold)
    if seed == 0:
        anchors = Anchors.fit(*(tracks.windows() for tracks in used))
        np.savez(options.out / f"anchors-{fold}.npz", shapes=anchors.shapes.astype(np.float32), share=anchors.share)
    material = gathered(used)
    how = AnchorTraining(seed=seed, updates=options.updates, **_changes(options.set))
    begin, work = time.perf_counter(), time.process_time()

    def tell(update: int, loss: float) -> None:
        if update % 500 == 0:
            print(f"{name}: update {update} of {how.updates}, loss {loss:.3f}, {time.process_time() - work:.0f} CPU s,"
                  f" {time.perf_counter() - begin:.0f} s", flush=True)  # fmt: skip

    state = options.out / f"{name}.state"
    numbers = train(material, how, tell, state)
    numbers = calibrated(numbers, gathered(recordings(options.data / "val", fold), reverse=False))
    kept = {k: v.astype(np.float32 if k in SMALL else np.float16) for k, v in numbers.items()}
    np.savez(done, **kept)
    state.unlink(missing_ok=True)
    print(f"{name}: {sum(v.size for v in kept.values())} numbers, {done.stat().st_size / 1e6:.2f} MB,"
          f" temperature {float(numbers['temperature']):.2f}, widening {float(numbers['widening']):.2f},"
          f" {time.process_time() - work:.0f} CPU s", flush=True)  # fmt: skip


def _changes(words: list[str]) -> dict[str, object]:
    """Return settings of the training; those of the variation may be named too."""
    pairs = {k: float(v) for k, _, v in (word.partition("=") for word in words)}
    fields = {f.name for f in dataclasses.fields(Variation)}
    varied = dataclasses.replace(Variation(), **{k: v for k, v in pairs.items() if k in fields})
    return {k: v for k, v in pairs.items() if k not in fields} | {"variation": varied}


def score_fold(options: argparse.Namespace, fold: str, seed: int) -> dict[str, dict[str, float]]:
    """Return the scores of everything on the place that a fold leaves out."""
    file = str(options.out / f"anchor-net-{fold}{f'-seed{seed}' if seed else ''}.npz")
    with np.load(options.out / f"anchors-{fold}.npz") as kept:
        anchors = Anchors(shapes=kept["shapes"].astype(float), share=kept["share"].astype(float))
    asked = {
        "constant velocity": (ConstantVelocity(), 1),
        "anchors, set of 20": (anchors, 20),
        "set of 20": (AnchorNet(file=file), 20),
        "single": (AnchorNet(file=file), 1),
        "20 draws": (AnchorNet(file=file, sample="draws"), 20),
        "set of 20, not joint": (AnchorNet(file=file, contact=0.0), 20),
        "single, not joint": (AnchorNet(file=file, contact=0.0), 1),
    }
    cut = [tracks.windows() for tracks in recordings(options.data / "all_data", fold, left_out=True)]
    if options.every > 1:
        cut = [(past[:: options.every], future[:: options.every]) for past, future in cut]
    rows = {}
    for name, (predictor, samples) in asked.items():
        found = Score.total([evaluate(predictor, past, future, samples) for past, future in cut])
        rows[name] = {k: getattr(found, k) for k in ("ade", "fde", "nll", "energy", "collisions", "persons", "miss_rate")}
        print(f"{fold} seed {seed} {name:22}"
              + " ".join(f"{k} {v:.3f}" for k, v in rows[name].items()), flush=True)  # fmt: skip
    return rows


def main() -> None:
    """Do what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("train", "score"))
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--fold", nargs="+", default=[*FOLDS], choices=[*FOLDS, ALL])
    parser.add_argument("--seed", type=int, nargs="+", default=[0])
    parser.add_argument("--updates", type=int, default=AnchorTraining.updates)
    parser.add_argument("--every", type=int, default=1, help="score every so many-th window only")
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", help="other settings of the training")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    if options.what == "train":
        import torch

        torch.set_num_threads(1)
        for seed in options.seed:
            for fold in options.fold:
                train_fold(options, fold, seed)
        return
    for seed in options.seed:
        rows = {fold: score_fold(options, fold, seed) for fold in options.fold if fold != ALL}
        (options.out / f"scores-seed{seed}.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
        for name in next(iter(rows.values())):
            mean = {k: np.mean([row[name][k] for row in rows.values()]) for k in ("ade", "fde", "nll", "energy", "collisions")}
            print(f"mean of {len(rows)}, seed {seed}, {name:22}" + " ".join(f"{k} {v:.3f}" for k, v in mean.items()))


if __name__ == "__main__":
    main()
