"""Trains the shipped weights of AnchorNet and Anchors, and scores those of the leave-one-out files of ETH/UCY.

    python studies/train_anchor_net.py train DATA OUT --fold open
    python studies/train_anchor_net.py train DATA OUT --fold eth hotel univ zara1 zara2 all --seed 0
    python studies/train_anchor_net.py calibrate DATA OUT --fold eth --seed 0
    python studies/train_anchor_net.py describe DATA OUT --fold all
    python studies/train_anchor_net.py score DATA OUT --seed 0
    python studies/train_anchor_net.py reliability DATA OUT --seed 0

A training that was stopped goes on where it was; one that is done is not repeated.

Fold `open`, the default weights: DATA holds eth_ucy_splits/, hermes/ and juelich/. The training learns from data whose
terms allow it: UCY, the corridors and bottlenecks of the Jülich archive, and simulated crowds with and without robots,
with at most so many futures of each (`SOURCES`). --leave-out NAME leaves some of them out, --research DIR adds the
Stanford Drone Dataset in the TrajNet cut (non-commercial; such weights do not ship).

Other folds: DATA holds train/, val/ and all_data/ as SGAN published them. Only train/ of the other places is learned
from; val/ of the other places gives the temperature; the last weights are taken, so nothing is chosen by the place that
is left out. The fold `all` is trained and then described, which limits it to near neighbors.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import shutil
import time
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import stream
from crowdbot.data import Recording, Trajectories, Windows, load
from crowdbot.evaluation import score_predictor
from crowdbot.metrics import Score
from crowdbot.prediction import AnchorNet, Anchors, ConstantVelocity
from crowdbot.prediction.anchor_net.agent_frame import REACH
from crowdbot.prediction.anchor_net.filtered_line import LINE_SHARE
from crowdbot.prediction.anchor_net.training import (
    PRESETS,
    UPDATES,
    AnchorNetTraining,
    AnchorTraining,
    calibrate_confidence,
)
from crowdbot.prediction.anchor_net.training_data import (
    NO_AUGMENTATION,
    Augmentation,
    TrainingSet,
    make_batch,
    training_set,
    training_set_of,
)
from crowdbot.prediction.pretrained_weights import ALL, FOLDS, OPEN, STEP, is_held_out
from crowdbot.prediction.training.loop import TrainingSchedule, train
from crowdbot.prediction.training.samples import Samples, recordings_with_windows, split_in_time
from crowdbot.prediction.training.torch_backend import torch_threads
from training_crowds import robot_encounters, simulated_crowds

SHOWN = ("ade", "fde", "nll", "energy", "collisions")
EDGES = np.concatenate([[0.0], np.geomspace(0.005, 1.0, 13)])
"""Borders of the probabilities that are counted together."""
CREDITED = ("crowds_", "students", "uni_examples")
"""Recordings of UCY, free for use with credit to the authors. ETH states no terms, SDD forbids commercial use."""
SOURCES = {"ucy": 30000, "hermes": 8000, "juelich": 8000, "simulated": 4000, "robots": 2000, "sdd": 8000}
"""Data of the fold `open` -> largest number of futures; `sdd` with --research only."""
ARCHIVE: dict[str, tuple[str, dict[str, Any]]] = {
    "hermes": ("hermes/Corridor-*/*.txt", {"fps": 16.0, "units": "cm"}),
    "juelich": ("juelich/b*/*.txt", {}),
}
"""Data -> pattern of the files, and options of their reader."""
HOLD = 0.15
"""Final share of the recordings of the archive that gives the temperature."""
OPEN_UPDATES = 8000
"""Optimizer steps of the fold `open`."""
CROWDS, MEETINGS = 5, 30
"""Simulated scenes per crowd model and layout, and per crowd model and kind of encounter with a robot."""
SMALL = ("basis", "centres", "spread", "share", "width", "temperature", "widening", "reach", "line_share")


def recordings(folder: Path, fold: str, left_out: bool = False) -> list[Trajectories]:
    """Return the recordings of a folder that belong to the training of a fold, or those that are left out."""
    found = [load(path, fps=25) for path in sorted(folder.glob("*.txt"))]
    return [tracks for tracks in found if is_held_out(fold, tracks.name) == left_out]


def open_samples(options: argparse.Namespace) -> tuple[Samples, Samples]:
    """Return the balanced training and validation samples of the fold `open`."""
    found: dict[str, list[Samples]] = {}
    for name, limit in SOURCES.items():
        if name in options.leave_out or (name == "sdd" and options.research is None):
            continue
        for part, samples in zip(("train", "val"), _source(options, name), strict=True):
            kept = samples.limit(limit if part == "train" else limit // 5)
            found.setdefault(part, []).append(kept)
            print(f"{name}, {part}: {kept.people} of {samples.people} futures", flush=True)
    return Samples.concatenate(found["train"]), Samples.concatenate(found["val"])


def _source(options: argparse.Namespace, name: str) -> tuple[Samples, Samples]:
    """Return the training and validation samples of one source."""
    if name == "ucy":
        parts = (sorted((options.data / "eth_ucy_splits" / part).glob("*.txt")) for part in ("train", "val"))
        one, other = (
            Samples.of([Recording(str(path), fps=25) for path in paths if path.name.startswith(CREDITED)])
            for paths in parts
        )
        return one, other
    if name == "simulated":
        crowds = simulated_crowds(CROWDS, seed=0), simulated_crowds(2, seed=1)
        one, other = (
            Samples.concatenate([Samples.from_windows(*tracks.windows(), tracks.name) for tracks in found])
            for found in crowds
        )
        return one, other
    if name == "robots":
        met = robot_encounters(MEETINGS, seed=0), robot_encounters(8, seed=1)
        one, other = (
            Samples.concatenate([Samples.from_windows(*pair, kind) for kind, pair in found.items()]) for found in met
        )
        return one, other
    if name == "sdd":
        files = [Recording(str(path)) for path in sorted(options.research.glob("*.txt"))]
    else:
        pattern, how = ARCHIVE[name]
        files = [Recording(str(path), step=STEP, **how) for path in sorted(options.data.glob(pattern))]
    split = split_in_time(recordings_with_windows(files)[0], HOLD)
    return split.training, split.validation


def training_data(options: argparse.Namespace, fold: str) -> tuple[tuple[str, ...], TrainingSet, TrainingSet]:
    """Return the names of the recordings, the training data and the validation data of a fold."""
    if fold == OPEN:
        samples, other = open_samples(options)
        return samples.names, training_set_of(samples), training_set_of(other, reverse=False)
    used = recordings(options.data / "train", fold)
    watched = training_set(recordings(options.data / "val", fold), reverse=False)
    return tuple(tracks.name for tracks in used), training_set(used), watched


def train_fold(options: argparse.Namespace, fold: str, seed: int) -> None:
    """Train, calibrate and write one fold."""
    name = f"anchor-net-{fold}" + (f"-seed{seed}" if seed else "")
    done = options.out / f"{name}.npz"
    if done.exists():
        print(f"{done} is there already")
        return
    names, material, watched = training_data(options, fold)
    model = AnchorNetTraining(_recipe(options.set, fold, seed), material, watched, names)
    if seed == 0:
        write_anchors(options.out / f"anchors-{fold}.npz", material)
    updates = options.updates or (OPEN_UPDATES if fold == OPEN else UPDATES)
    schedule = TrainingSchedule(updates, check_every=updates, keep_every=500, seed=seed)
    work, folder = time.process_time(), options.out / name

    def tell(update: int, total: int) -> None:
        if update % 500 == 0:
            print(f"{name}: update {update} of {total}, {time.process_time() - work:.0f} CPU s", flush=True)

    with torch_threads():
        course = train(model, schedule, folder, resume=True, tick=tell)
    write(done, model.numbers(), watched)
    shutil.rmtree(folder)
    watch = " ".join(f"{key} {value:.3f}" for key, value in course.rows[-1].items())
    print(f"{name}: {watch}, {time.process_time() - work:.0f} CPU s", flush=True)


def write_anchors(file: Path, material: TrainingSet) -> None:
    """Write the fixed anchors of the training data."""
    missed = make_batch(material, np.arange(len(material)), NO_AUGMENTATION, stream(0, "anchors")).missed
    anchors = Anchors.fit_residuals(missed)
    assert anchors.share is not None
    assert anchors.shapes is not None
    np.savez(file, shapes=anchors.shapes.astype(np.float32), share=anchors.share)


def write(file: Path, numbers: dict[str, np.ndarray], watched: TrainingSet) -> None:
    """Calibrate on validation data of what was learned from, and write the numbers in as few bytes as they need."""
    kept = {k: v.astype(np.float32 if k in SMALL else np.float16) for k, v in numbers.items()}
    kept = calibrate_confidence(kept, watched)
    arrays: dict[str, Any] = {k: v.astype(np.float32) if k in SMALL else v for k, v in kept.items()}
    np.savez(file, **arrays)
    size = sum(values.size for values in kept.values())
    said = {name: kept[name].round(2).tolist() for name in ("temperature", "widening")}
    print(f"{file.name}: {size} numbers, {file.stat().st_size / 1e6:.2f} MB, {said}", flush=True)


def describe(options: argparse.Namespace, fold: str) -> None:
    """Limit weights that learned from unbounded features to near neighbors, with a share of the filtered line."""
    used = [load(path, fps=25) for path in sorted((options.data / "train").glob("*.txt"))]
    used = [tracks for tracks in used if not is_held_out(fold, tracks.name)]
    material, file = training_set(used), Path(weights_file(options, fold, 0))
    with np.load(file) as kept:
        numbers = {name: kept[name] for name in kept.files}
    missed = make_batch(material, np.arange(len(material)), NO_AUGMENTATION, stream(0, "share")).missed
    points = missed.reshape(len(missed), -1) @ numbers["basis"].T
    nearest = np.argmin([((points - centre) ** 2).sum(axis=1) for centre in numbers["centres"]], axis=0)
    count = np.bincount(nearest, minlength=len(numbers["centres"])) + 1.0
    found = {
        "reach": np.array(REACH), "unbounded": np.array(1.0), "line_share": np.array(LINE_SHARE),
        "share": count / count.sum(),
    }  # fmt: skip
    np.savez(file, **numbers | {name: values.astype(np.float32) for name, values in found.items()})
    print(f"{file.name}: neighbors within {REACH} m")


def _recipe(words: list[str], fold: str, seed: int) -> AnchorTraining:
    """Return the settings of the training of a fold; those of the variation may be named too."""
    pairs = {k: float(v) for k, _, v in (word.partition("=") for word in words)}
    fields = {f.name for f in dataclasses.fields(Augmentation)}
    preset = PRESETS["general" if fold == OPEN else "shipped"]
    varied = dataclasses.replace(preset.variation, **{k: v for k, v in pairs.items() if k in fields})
    others: dict[str, Any] = {k: v for k, v in pairs.items() if k not in fields}
    return dataclasses.replace(preset, **others, seed=seed, variation=varied)


def score_fold(options: argparse.Namespace, fold: str, seed: int) -> dict[str, dict[str, float]]:
    """Return the scores of everything on the place that a fold leaves out."""
    file = weights_file(options, fold, seed)
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
    cut = windows_left_out(options, fold)
    rows = {}
    for name, (predictor, samples) in asked.items():
        found = Score.total([score_predictor(predictor, past, future, samples) for past, future in cut])
        rows[name] = {k: getattr(found, k) for k in (*SHOWN, "persons", "miss_rate")}
        print(f"{fold} seed {seed} {name:22}"
              + " ".join(f"{k} {v:.3f}" for k, v in rows[name].items()), flush=True)  # fmt: skip
    return rows


def reliability(options: argparse.Namespace) -> None:
    """Draw how often a future was the nearest that was said to be so with some probability, and where truth falls."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    for fold in options.fold:
        net = AnchorNet(file=weights_file(options, fold, options.seed[0]))
        said, was, level = [], [], []
        for past, future in windows_left_out(options, fold):
            hit, ranks = believed(net, past, future)
            said.append(hit[0].ravel())
            was.append(hit[1].ravel())
            level.append(ranks)
        chance, true, inside = np.concatenate(said), np.concatenate(was), np.concatenate(level)
        place = np.minimum(np.searchsorted(EDGES, chance, side="right") - 1, len(EDGES) - 2)
        count = np.bincount(place, minlength=len(EDGES) - 1)
        kept = np.flatnonzero(count > 100)
        x = np.bincount(place, chance, len(count))[kept] / count[kept]
        y = np.bincount(place, true, len(count))[kept] / count[kept]
        gap = float(np.sum(count[kept] * np.abs(x - y)) / count[kept].sum())
        left.plot(x, y, "o-", ms=3, lw=1, label=f"{fold}: {100 * gap:.2f} %")
        shares = np.linspace(0.05, 0.95, 19)
        held = np.array([np.mean(inside <= share) for share in shares])
        right.plot(shares, held, "-", lw=1, label=fold)
        likely, sure = true.reshape(-1, 20)[:, 0].mean(), chance.reshape(-1, 20)[:, 0].mean()
        shown = " ".join(f"{np.mean(inside <= share):.3f}" for share in (0.5, 0.8, 0.95))
        print(
            f"{fold}: mean gap between said and true probability {gap:.4f}, the likeliest is the nearest in"
            f" {likely:.3f} (said {sure:.3f}); inside 50, 80, 95 % of draws: {shown}", flush=True,
        )  # fmt: skip
    for axes, low in ((left, 0.005), (right, 0.0)):
        axes.plot([low, 1], [low, 1], color="0.6", lw=1)
        axes.legend(fontsize=7)
    left.set(xscale="log", yscale="log", xlabel="probability said", ylabel="share that was the nearest of 20")
    right.set(xlabel="innermost share of 100 draws, end point", ylabel="share of true end points inside")
    figure.savefig(options.out / "reliability.png", dpi=130)


def believed(net: AnchorNet, past: Windows, future: Windows) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray]:
    """Return probabilities ``[N, 20]`` and which was the nearest, and the share of draws nearer the middle."""
    modes = net.modes(past)
    kept = future.scored[modes.window, modes.slot]
    window, slot = modes.window[kept], modes.slot[kept]
    truth = future.position[window, :, slot] - past.position[window, -1, slot][:, None]
    error = np.linalg.norm(modes.path[kept] - truth[:, None], axis=3).mean(axis=2)
    nearest = np.arange(error.shape[1]) == error.argmin(axis=1)[:, None]
    draws = dataclasses.replace(net, sample="draws").predict(past, future.present.shape[1], 100)
    end = draws.position[:, :, -1][window, :, slot]
    middle = end.mean(axis=1)
    away = end - middle[:, None]
    inverse = np.linalg.inv(np.einsum("nki,nkj->nij", away, away) / 99.0 + 1e-9 * np.eye(2))
    own = truth[:, -1] + past.position[window, -1, slot] - middle
    far = np.einsum("nki,nij,nkj->nk", away, inverse, away)
    rank = np.mean(far < np.einsum("ni,nij,nj->n", own, inverse, own)[:, None], axis=1)
    return (modes.probability[kept], nearest), rank


def weights_file(options: argparse.Namespace, fold: str, seed: int) -> str:
    """Return the file of the weights of a fold."""
    return str(options.out / f"anchor-net-{fold}{f'-seed{seed}' if seed else ''}.npz")


def windows_left_out(options: argparse.Namespace, fold: str) -> list[tuple[Windows, Windows]]:
    """Return past and future of every window, or of every so many-th, of the recordings that a fold leaves out."""
    found = recordings(options.data / "all_data", fold, left_out=True)
    if fold == "eth" and options.eth is not None:
        found = [load(options.eth)]
    cut = [tracks.windows() for tracks in found]
    return [(past[:: options.every], future[:: options.every]) for past, future in cut]


def main() -> None:
    """Do what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("train", "calibrate", "describe", "score", "reliability"))
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--fold", nargs="+", default=[*FOLDS], choices=[*FOLDS, ALL, OPEN])
    parser.add_argument("--seed", type=int, nargs="+", default=[0])
    parser.add_argument("--leave-out", nargs="+", default=[], choices=SOURCES, help="fold open: sources left out")
    parser.add_argument("--research", type=Path, metavar="DIR", help="fold open: SDD in the TrajNet cut, stanford/")
    parser.add_argument("--updates", type=int, help=f"default: {OPEN_UPDATES} for the fold open, else {UPDATES}")
    parser.add_argument("--every", type=int, default=1, help="score every so many-th window only")
    parser.add_argument("--eth", type=Path, help="obsmat.txt of eth, its true time base, in place of biwi_eth.txt")
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", help="other settings of the training")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    if options.what == "train":
        for seed in options.seed:
            for fold in options.fold:
                train_fold(options, fold, seed)
        return
    if options.what == "calibrate":
        for seed in options.seed:
            for fold in options.fold:
                file = Path(weights_file(options, fold, seed))
                _, _, watched = training_data(options, fold)
                with np.load(file) as kept:
                    write(file, {name: kept[name] for name in kept.files}, watched)
        return
    if options.what == "describe":
        for fold in options.fold:
            describe(options, fold)
        return
    if options.what == "reliability":
        reliability(options)
        return
    for seed in options.seed:
        rows = {fold: score_fold(options, fold, seed) for fold in options.fold if fold in FOLDS}
        (options.out / f"scores-seed{seed}.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
        for name in next(iter(rows.values())):
            mean = {k: np.mean([row[name][k] for row in rows.values()]) for k in SHOWN}
            print(f"mean of {len(rows)}, seed {seed}, {name:22}" + " ".join(f"{k} {v:.3f}" for k, v in mean.items()))


if __name__ == "__main__":
    main()
