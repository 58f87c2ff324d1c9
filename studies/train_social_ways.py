"""Trains Social Ways fold by fold and seed by seed, and scores it; what was stopped goes on.

    python studies/train_social_ways.py fold DATA OUT --fold eth hotel univ zara1 zara2 --seed 0 1 2
    python studies/train_social_ways.py split DATA OUT --fold eth hotel univ zara1 zara2
    python studies/train_social_ways.py table OUT OUT
    python studies/train_social_ways.py ship OUT ASSETS

``fold``: leave-one-out. DATA holds train/, val/ and all_data/ as SGAN published them; only train/ of the other places
is learned from, val/ of the other places chooses the checkpoint. ``split``: the report's own protocol. DATA holds
eth_biwi/ and ucy/ with an obsmat.txt for every place; the first four fifths of each are learned from, and the last
weights are scored on the last fifth. Each run is the loop that ``crowdbot train social-ways`` runs.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from crowdbot.data import Trajectories, load
from crowdbot.evaluation import score_predictor
from crowdbot.metrics import Score
from crowdbot.prediction import SocialWays
from crowdbot.prediction.pretrained_weights import FOLDS, is_held_out
from crowdbot.prediction.training.checkpoint import load_checkpoint, save_checkpoint
from crowdbot.prediction.training.loop import BEST, LogRow, TrainingSchedule, train
from crowdbot.prediction.training.samples import Samples
from crowdbot.prediction.training.torch_backend import torch_threads

SHOWN = ("ade", "fde", "nll", "energy", "collisions")
OBSMAT = {"eth": "eth_biwi/seq_eth", "hotel": "eth_biwi/seq_hotel", "univ": "ucy/students03", "zara1": "ucy/zara01",
          "zara2": "ucy/zara02"}  # fmt: skip
KIND = "social-ways"
ALONE = "20 draws without contact"


def samples_of(recordings: list[Trajectories], protocol: str = "all") -> Samples:
    """Return all windows of some recordings."""
    return Samples.concatenate(
        [Samples.from_windows(*recording.windows(protocol=protocol), recording.name) for recording in recordings]
    )


def texts(folder: Path, fold: str, left_out: bool = False) -> list[Trajectories]:
    """Return the recordings of a folder that belong to the training of a fold, or those that are left out."""
    found = [load(path, fps=25) for path in sorted(folder.glob("*.txt"))]
    return [one for one in found if is_held_out(fold, one.name) == left_out]


def leave_one_out(options: argparse.Namespace, fold: str, seed: int) -> None:
    """Train without a place and score on it."""
    data, folder = options.data, options.out / f"{fold}-seed{seed}"
    if (folder / "scores.json").exists():
        return
    learned, watched = samples_of(texts(data / "train", fold)), samples_of(texts(data / "val", fold))
    trained(options, folder, learned, watched, seed, options.check_every)
    scored(options, folder, texts(data / "all_data", fold, left_out=True), "all", seed)


def time_split(options: argparse.Namespace, fold: str, seed: int) -> None:
    """Train on the first four fifths of a place and score on the rest."""
    folder = options.out / f"split-{fold}-seed{seed}"
    if (folder / "scores.json").exists():
        return
    tracks = load(options.data / OBSMAT[fold] / "obsmat.txt")
    learned = samples_of([tracks], "timesplit-train")
    trained(options, folder, learned, learned, seed, options.updates)
    scored(options, folder, [tracks], "timesplit", seed)


def trained(
    options: argparse.Namespace, folder: Path, learned: Samples, watched: Samples, seed: int, every: int
) -> None:
    """Train, or go on."""
    from crowdbot.prediction.social_ways.training import learner

    values = dict(word.split("=", 1) for word in options.set)
    model = learner("variety", values, learned, watched, seed, "cpu")
    schedule = TrainingSchedule(options.updates, check_every=every, keep_every=100, watch=("ade", "fde"), seed=seed)

    def tell(row: LogRow) -> None:
        print(folder.name, *(f"{name} {value:.4g}" for name, value in row.items()), flush=True)

    with torch_threads():
        train(model, schedule, folder, resume=True, report=tell)


def scored(options: argparse.Namespace, folder: Path, recordings: list[Trajectories], protocol: str, seed: int) -> None:
    """Write the scores of the checkpoint: best of 20 draws, one draw, and 20 draws as the report has them."""
    predictor = SocialWays(checkpoint=str(folder / BEST))
    alone = dataclasses.replace(predictor, contact=0.0)
    rows = {}
    cut = [recording.windows(protocol=protocol) for recording in recordings]
    for name, count, chosen in (("20 draws", 20, predictor), ("one draw", 1, predictor), (ALONE, 20, alone)):
        parts = [score_predictor(chosen, past[:: options.every], future[:: options.every], count, seed=seed)
                 for past, future in cut]  # fmt: skip
        found = Score.total(parts)
        rows[name] = {key: float(getattr(found, key)) for key in (*SHOWN, "persons", "miss_rate")}
        print(folder.name, name, *(f"{key} {value:.3f}" for key, value in rows[name].items()), flush=True)
    (folder / "scores.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


def table(options: argparse.Namespace) -> None:
    """Print the scores of all that is done, a line a seed, and means and spread over seeds."""
    for kind in ("", "split-"):
        for name in ("20 draws", "one draw", ALONE):
            means = []
            for seed in options.seed:
                files = {fold: options.data / f"{kind}{fold}-seed{seed}" / "scores.json" for fold in FOLDS}
                scores = {fold: json.loads(file.read_text()) for fold, file in files.items() if file.exists()}
                rows = {fold: score[name] for fold, score in scores.items() if name in score}
                if rows:
                    said = " ".join(f"{fold} {row['ade']:.3f}/{row['fde']:.3f}" for fold, row in rows.items())
                    mean = [np.mean([row[key] for row in rows.values()]) for key in ("ade", "fde")]
                    hits = " ".join(f"{100 * row['collisions']:.1f}" for row in rows.values())
                    print(f"{kind}{name} seed {seed}: {said} mean {mean[0]:.3f}/{mean[1]:.3f} collisions % {hits}")
                    means.append(mean)
            if len(means) > 1:
                print(f"{kind}{name}: mean of {len(means)} seeds {np.mean(means, axis=0).round(3).tolist()}"
                      f" +- {np.std(means, axis=0, ddof=1).round(3).tolist()}")  # fmt: skip


def ship(options: argparse.Namespace) -> None:
    """Write the weights of the leave-one-out folds in half as many bytes, as they go into the package."""
    for fold in options.fold:
        content = load_checkpoint(options.data / f"{fold}-seed{options.seed[0]}" / BEST, KIND)
        content["weights"] = {name: np.asarray(value).astype(np.float16) for name, value in content["weights"].items()}
        file = options.out / f"{KIND}-{fold}.npz"
        save_checkpoint(file, KIND, content)
        print(file.name, f"{file.stat().st_size / 1e6:.2f} MB")


def main() -> None:
    """Do what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    runs: dict[str, Callable[[argparse.Namespace, str, int], None]] = {"fold": leave_one_out, "split": time_split}
    parser.add_argument("what", choices=(*runs, "table", "ship"))
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--fold", nargs="+", default=[*FOLDS], choices=[*FOLDS])
    parser.add_argument("--seed", type=int, nargs="+", default=[0])
    parser.add_argument("--updates", type=int, default=1000)
    parser.add_argument("--check-every", type=int, default=250)
    parser.add_argument("--every", type=int, default=1, help="score every so many-th window only")
    parser.add_argument("--set", nargs="+", default=["variety-draws=6"], metavar="NAME=VALUE", help="other settings")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    if options.what in ("table", "ship"):
        (table if options.what == "table" else ship)(options)
        return
    for seed in options.seed:
        for fold in options.fold:
            runs[options.what](options, fold, seed)


if __name__ == "__main__":
    main()
