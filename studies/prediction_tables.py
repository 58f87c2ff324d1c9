"""Measures all tables of prediction, and writes them as OUT/tables.md.

    python studies/prediction_tables.py DATA OUT [--weights DIR] [--part leave-one-out ...]

DATA holds eth_ucy_splits/, eth_biwi/, sdd_trajnet/, citr/, hermes/, juelich/ and trajnetpp/ in the formats of their
authors. Every result is a file in OUT/parts: the same command continues after an interruption. --weights DIR has the
weights of other seeds, anchor-net-FOLD-seedN.npz of studies/train_anchor_net.py.
"""

from __future__ import annotations

import argparse
import dataclasses
import hashlib
import json
import os
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import crowdbot as cb
import robot_plans
import zero_shot as places
from crowdbot.core import InputError, source_digest, stream
from crowdbot.data import TRAJNET_CATEGORIES, Forecast, Trajectories, Windows, load, primary_windows, scenes_of_category
from crowdbot.metrics import (
    ade,
    best_of,
    collision_mask,
    energy_score,
    fde,
    kde_nll,
    neighbor_mask,
    swept_collisions,
)
from crowdbot.prediction import (
    AnchorNet,
    Anchors,
    ConstantVelocity,
    Kalman,
    LeastSquares,
    Predictor,
    SampledConstantVelocity,
)
from crowdbot.trials import PRESETS
from prediction_page import page

FOLDS = {
    "eth": ("biwi_eth",), "hotel": ("biwi_hotel",), "univ": ("students001", "students003"),
    "zara1": ("crowds_zara01",), "zara2": ("crowds_zara02",),
}  # fmt: skip
TRAJNET = {"biwi_hotel": "hotel", "crowds_zara01": "zara1", "crowds_students001": "univ"}
"""File of TrajNet++ -> fold of the weights that did not see its place."""
AT_ONCE = 60
"""Windows that are predicted and scored together."""
MOST_SCENES = 1000
"""Scenes of a TrajNet++ file, evenly spaced."""

Row = dict[str, Any]


def chunks(past: Windows, future: Windows) -> Iterator[tuple[Windows, Windows]]:
    """Yield a few windows at a time."""
    for first in range(0, len(past), AT_ONCE):
        yield past[first : first + AT_ONCE], future[first : first + AT_ONCE]


def measure(predictor: Predictor, samples: int, pairs: list[tuple[Windows, Windows]], deep: bool = True) -> Row:
    """Return sums over persons of every score; ``deep`` adds those that take long."""
    found: dict[str, list[float]] = {}
    rng, begin = stream(0, "predict"), time.process_time()
    for past, future in (pair for both in pairs for pair in chunks(*both)):
        if not future.scored.any():
            continue
        forecast = predictor.predict(past, future.position.shape[1], samples, rng)
        for name, values in scores(forecast, past, future, deep).items():
            known = values[~np.isnan(values)]
            total = found.setdefault(name, [0.0, 0.0])
            total[0] += float(known.sum())
            total[1] += len(known)
    return {name: total / count if count else None for name, (total, count) in found.items()} | {
        "persons": int(found["ADE"][1]), "seconds": time.process_time() - begin,
    }  # fmt: skip


def scores(forecast: Forecast, past: Windows, future: Windows, deep: bool) -> dict[str, np.ndarray]:
    """Return the scores of every scored person."""
    who = future.scored
    errors = ade(forecast, future), fde(forecast, future)
    result = {}
    for rule, names in (("person", ("ADE", "FDE")), ("scene", ("JADE", "JFDE")), ("same", ("", "FDE of the same"))):
        for name, values in zip(names, best_of(*errors, rule), strict=True):
            if name:
                result[name] = values[who]
    result["missed"] = np.where(result["FDE"] > 2.0, 1.0, 0.0)
    together = neighbor_mask(future)
    if together.any():
        hit = np.einsum("wk,wka->wa", forecast.weight, collision_mask(forecast, future))
        result["collisions"] = hit[together]
        for limit in (0.2, 0.4):
            own, true = swept_collisions(forecast, past, future, limit)
            result[f"swept {limit}"], result[f"truth {limit}"] = own[together], true[together]
    if deep and forecast.samples > 1:
        result["energy"], result["NLL"] = energy_score(forecast, future)[who], kde_nll(forecast, future)[who]
    return result


def tracks_of(options: argparse.Namespace, fold: str) -> list[Trajectories]:
    """Return the recordings of a fold."""
    return [load(options.data / f"eth_ucy_splits/all_data/{name}.txt", fps=25) for name in FOLDS[fold]]


def nets(options: argparse.Namespace, fold: str) -> dict[str, AnchorNet]:
    """Return the nets of a fold by seed."""
    result = {"0": AnchorNet(fold)}
    if options.weights is not None:
        for path in sorted(options.weights.glob(f"anchor-net-{fold}-seed*.npz")):
            result[path.stem.partition("-seed")[2]] = AnchorNet(file=str(path))
    return result


def leave_one_out(options: argparse.Namespace) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Yield the jobs of the leave-one-out table."""
    for fold in FOLDS:
        asked: dict[str, tuple[Predictor, int]] = {
            "constant velocity": (ConstantVelocity(), 1), "Kalman": (Kalman(), 1),
            "sampled constant velocity, 20": (SampledConstantVelocity(), 20), "anchors, 20": (Anchors(fold), 20),
        }  # fmt: skip
        for seed, net in nets(options, fold).items():
            asked |= {f"AnchorNet, 1, seed {seed}": (net, 1), f"AnchorNet, 20, seed {seed}": (net, 20)}
        asked["AnchorNet, 20 draws, seed 0"] = (AnchorNet(fold, sample="draws"), 20)
        for name, (predictor, samples) in asked.items():
            for protocol in ("all", "sgan"):
                if protocol == "all" or "seed 0" in name:
                    yield f"{protocol}|{fold}|{name}", partial(fold_row, options, fold, protocol, predictor, samples)


def fold_row(options: argparse.Namespace, fold: str, protocol: str, predictor: Predictor, samples: int) -> Row:
    """Return the errors on the place that a fold leaves out."""
    pairs = [tracks.windows(protocol=protocol) for tracks in tracks_of(options, fold)]
    return measure(predictor, samples, pairs, protocol == "all")


def lazy_row(predictor: Predictor, samples: int, cut: Callable[[], list[tuple[Windows, Windows]]]) -> Row:
    """Return the errors on windows that are cut when they are needed."""
    return measure(predictor, samples, cut(), False)


def degraded_row(options: argparse.Namespace, cost: str, predictor: Predictor, samples: int) -> Row:
    """Return the errors on degraded tracks."""
    return measure(predictor, samples, [worse(options, cost)], False)


def zero_shot(options: argparse.Namespace) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Yield the jobs of the data sets that no default weight saw."""
    for place, patterns in places.RECORDINGS.items():

        def cut(patterns: tuple[str, ...] = patterns) -> list[tuple[Windows, Windows]]:
            found = [item for item in places.read(options.data, patterns) if np.unique(item.frame).size >= places.ROWS]
            return places.thinned(found, options.windows)

        asked: dict[str, tuple[Predictor, int]] = {
            "constant velocity": (ConstantVelocity(), 1), "Kalman": (Kalman(), 1), "least squares": (LeastSquares(), 1),
            "anchors, 20": (Anchors("open"), 20),
        }  # fmt: skip
        for seed, net in nets(options, "open").items():
            asked |= {f"AnchorNet, 1, seed {seed}": (net, 1), f"AnchorNet, 20, seed {seed}": (net, 20)}
        for name, (predictor, samples) in asked.items():
            yield f"{place}|{name}", partial(lazy_row, predictor, samples, cut)


def trajnet(options: argparse.Namespace) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Yield the jobs of TrajNet++: one answer, and the best of three."""
    for file, fold in TRAJNET.items():
        net = AnchorNet(fold)
        for name, predictor, samples in (
            ("constant velocity", ConstantVelocity(), 1), ("Kalman", Kalman(), 1), ("AnchorNet, 1", net, 1),
            ("AnchorNet, 3", net, 3),
        ):  # fmt: skip
            yield f"{file}|{name}", partial(trajnet_row, options, file, predictor, samples)


def trajnet_row(options: argparse.Namespace, file: str, predictor: Predictor, samples: int) -> Row:
    """Return scores by category of TrajNet++."""
    past, future, kept = primary_windows(load(options.data / f"trajnetpp/{file}.ndjson"))
    every = 1 + len(past) // MOST_SCENES
    past, future, kept = past[::every], future[::every], kept[::every]
    rng = stream(0, "predict")
    forecast = Forecast.concatenate([predictor.predict(few, 12, samples, rng) for few, _ in chunks(past, future)])
    best = best_of(ade(forecast, future), fde(forecast, future), "same")
    mean, last = (values[future.scored] for values in best)
    first = dataclasses.replace(
        forecast,
        position=forecast.position[:, :1],
        weight=np.ones((len(past), 1)),
        person_weight=None,
        future_covariance=None,
    )
    hits = [
        collision_mask(first, future, 0.2, "predicted", 2, everyone=True),
        collision_mask(first, future, 0.2, "true", 2),
    ]
    one, two = (hit[:, 0][future.scored] for hit in hits)
    result = {}
    for name in ("all", *TRAJNET_CATEGORIES):
        rows = np.arange(len(kept)) if name == "all" else scenes_of_category(kept, name)
        if len(rows):
            result[name] = {
                "scenes": len(rows), "ADE": mean[rows].mean(), "FDE": last[rows].mean(), "Col-I": one[rows].mean(),
                "Col-II": two[rows].mean(),
            }  # fmt: skip
    return result


def degraded(options: argparse.Namespace) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Yield the jobs of the cost of noise, occlusion, short histories and frame rates, on zara1."""
    for cost in (
        "clean",
        "noise 0.05 m",
        "noise 0.1 m",
        "half of the rows missing",
        "2 rows",
        "4 rows",
        "10 Hz",
        "5 Hz",
    ):
        for name, predictor, samples in (
            ("constant velocity", ConstantVelocity(), 1), ("Kalman", Kalman(), 1), ("least squares", LeastSquares(), 1),
            ("anchors, 20", Anchors("zara1"), 20), ("AnchorNet, 1", AnchorNet("zara1"), 1),
            ("AnchorNet, 20", AnchorNet("zara1"), 20),
        ):  # fmt: skip
            yield f"{cost}|{name}", partial(degraded_row, options, cost, predictor, samples)


def worse(options: argparse.Namespace, cost: str) -> tuple[Windows, Windows]:
    """Return every fourth window of zara1, degraded."""
    tracks = tracks_of(options, "zara1")[0]
    if cost.endswith(" Hz"):
        rate = int(cost.split(maxsplit=1)[0])
        past, future = tracks.resample(1.0 / rate).windows(observe=round(2.8 * rate) + 1, predict=round(4.8 * rate))
        return past[:: 4 * rate // 2], future[:: 4 * rate // 2]
    past, future = (windows[::4] for windows in tracks.windows())
    rng = stream(0, "degraded", cost)
    place, here = past.position.copy(), past.present.copy()
    if cost.startswith("noise"):
        place += float(cost.split()[1]) * rng.standard_normal(place.shape)
    if cost.startswith("half"):
        here[:, :-1] &= rng.random(here[:, :-1].shape) < 0.5
    if cost.endswith(" rows"):
        here[:, : -int(cost.split(maxsplit=1)[0])] = False
    return dataclasses.replace(past, position=np.where(here[..., None], place, 0.0), present=here), future


def robot_plan(options: argparse.Namespace) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Yield the jobs of the plans of robots."""
    return robot_plans.jobs(options.data, options.out)


def trials(options: argparse.Namespace) -> Iterator[tuple[str, Callable[[], Row]]]:
    """Yield the jobs of the built-in trials with people."""
    for name in options.trial or PRESETS:
        yield name, partial(trial_row, name, options.windows)


def trial_row(name: str, windows: int) -> Row:
    """Return the errors of constant velocity and of AnchorNet in a built-in trial; empty if nobody can be scored."""
    try:
        pairs = places.thinned([cb.run(cb.load_trial(name, duration=20)).tracks(places.STEP)], windows)
    except InputError as error:
        return {"left out": str(error)[:120]}
    net = AnchorNet("open")
    return {
        word: measure(predictor, samples, pairs, False)
        for word, predictor, samples in (
            ("constant velocity", ConstantVelocity(), 1), ("AnchorNet, 1", net, 1),
            ("anchors, 20", Anchors("open"), 20), ("AnchorNet, 20", net, 20),
        )
    }  # fmt: skip


PARTS = {
    "zero-shot": zero_shot, "leave-one-out": leave_one_out, "trajnet": trajnet, "degraded": degraded,
    "robot-plan": robot_plan, "trials": trials,
}  # fmt: skip


def main() -> None:
    """Run what is missing, and write the results of all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--weights", type=Path, help="folder of the weights of other seeds")
    parser.add_argument("--windows", type=int, default=60, help="windows of each recording of the other data sets")
    parser.add_argument("--trial", nargs="+", metavar="NAME", help="trials of the part trials (default: all built-in)")
    parser.add_argument("--part", nargs="+", choices=PARTS, default=[*PARTS])
    options = parser.parse_args()
    kept = options.out / "parts"
    kept.mkdir(parents=True, exist_ok=True)
    for part in options.part:
        for name, job in PARTS[part](options):
            digest = hashlib.blake2b(repr((source_digest(), part, name, options.windows)).encode(), digest_size=10)
            file = kept / f"{part}-{digest.hexdigest()}.json"
            if file.is_file():
                continue
            begin = time.process_time()
            draft = file.with_suffix(".part")
            content = {"part": part, "name": name, "source": source_digest(), "row": job()}
            draft.write_text(json.dumps(content), encoding="utf-8")
            os.replace(draft, file)
            print(f"{part}: {name}, {time.process_time() - begin:.1f} CPU s", flush=True)
    (options.out / "tables.md").write_text(page(kept, source_digest()), encoding="utf-8")
    print(f"wrote {options.out / 'tables.md'}")


if __name__ == "__main__":
    main()
