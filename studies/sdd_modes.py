"""Draws the report's figure 19: Social Ways and a Vanilla GAN on two places of the Stanford Drone Dataset.

    python studies/sdd_modes.py SDD TRAJNET OUT --updates 500
    python studies/sdd_modes.py SDD TRAJNET OUT --updates 1000 --place gates-2 --method social-ways modes vanilla

SDD holds gates/video2/annotations.txt, TRAJNET holds Train/stanford/hyang_6.txt. Both networks see the coordinates of
the place, as in the report, learn from the first four fifths in time and draw 128 futures of people of the last fifth.
A mode is a place where at least a tenth of the draws end within 1 m; the next is looked for among the draws that are
more than 2 m away from it. People are at a fork when those who came by before them went on in several modes: at least
eight people who were within 2 m, headed the same way within 30 degrees, and about as fast.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import stream
from crowdbot.data import Trajectories, Windows, load
from crowdbot.prediction import SocialWays
from crowdbot.prediction.training.loop import BEST, TrainingSchedule, train
from crowdbot.prediction.training.samples import Samples
from crowdbot.prediction.training.torch_backend import torch_threads

SCALE = 0.0373
"""Metres of a pixel in gates/video2, as estimated_scales.yaml says."""
DRAWS, SHOWN, ROWS = 128, 5, 12
PLACE = {"frame": "world", "mirror": "false", "reverse": "false", "scale-sd": "0"}
METHODS = {
    "social-ways": ("variety", PLACE),
    "discrete-codes": ("variety", PLACE | {"code-levels": "3", "noise": "4", "noise-gain": "3.46"}),
    "modes": ("modes", PLACE | {"hidden": "64"}),
    "vanilla": ("report", {"frame": "world", "use-info-loss": "false", "latent-codes": "0"}),
}
Windowed = tuple[Windows, Windows]


def places(options: argparse.Namespace) -> dict[str, Trajectories]:
    """Return both recordings in metres at 0.4 s."""
    raw = load(options.sdd / "gates" / "video2" / "annotations.txt").resample(0.4)
    gates = Trajectories(
        raw.id, raw.frame, SCALE * raw.x, SCALE * raw.y, row_rate=1.0 / raw.dt, frame_step=raw.frame_step,
        name="gates-2",
    )  # fmt: skip
    return {"hyang-6": load(options.trajnet / "Train" / "stanford" / "hyang_6.txt"), "gates-2": gates}


def drawn(options: argparse.Namespace, place: str, method: str, learned: Windowed, asked: Windowed) -> np.ndarray:
    """Return futures ``[N, 128, T, 2]`` [m] of everyone scored."""
    from crowdbot.prediction.social_ways.training import learner

    settings, values = METHODS[method]
    samples, folder = Samples.from_windows(*learned, place), options.out / f"{place}-{method}"
    model = learner(settings, values, samples, samples, 0, "cpu")
    with torch_threads():
        train(
            model, TrainingSchedule(options.updates, check_every=options.updates, keep_every=100), folder, resume=True
        )
    past, future = asked
    window, person = np.nonzero(future.scored)
    found = SocialWays(str(folder / BEST), contact=0.0).predict(past, ROWS, DRAWS, stream(0, "draws"))
    return found.position[window, :, :, person]


def modes(paths: np.ndarray) -> int:
    """Return how many modes the ends of draws ``[K, T, 2]`` have."""
    left, count = paths[:, -1], 0
    while len(left):
        near = np.linalg.norm(left[:, None] - left, axis=-1)
        middle = int((near <= 1.0).sum(axis=1).argmax())
        if (near[middle] <= 1.0).sum() < 0.1 * len(paths):
            break
        count, left = count + 1, left[near[middle] > 2.0]
    return count


def ways(past: np.ndarray, seen: np.ndarray, went: np.ndarray) -> np.ndarray:
    """Return in how many modes those went on who came by like each of ``past [N, T, 2]``; 0 when they are too few.

    Args:
        past: tracks that are asked about.
        seen, went: ``[M, T, 2]`` tracks of others and how they went on.
    """
    found, heading = [], seen[:, -1] - seen[:, -4]
    for item in past:
        own = item[-1] - item[-4]
        ratio = np.linalg.norm(heading, axis=1) / max(float(np.linalg.norm(own)), 1e-9)
        angle = np.abs(np.angle((heading @ [1, 1j]) * np.conj(own @ [1, 1j])))
        like = (
            (np.linalg.norm(seen[:, -1] - item[-1], axis=1) < 2.0)
            & (angle < np.pi / 6)
            & (abs(np.log(ratio + 1e-9)) < 0.35)
        )
        found.append(modes(went[like] - seen[like, -1:]) if like.sum() >= 8 else 0)
    return np.array(found)


def _mean(counts: np.ndarray) -> str:
    return f"{counts.mean():.2f} modes of {len(counts)}" if len(counts) else "nobody"


def main() -> None:
    """Train, count and draw."""
    from matplotlib.figure import Figure

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sdd", type=Path)
    parser.add_argument("trajnet", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--updates", type=int, default=500)
    parser.add_argument("--place", nargs="+", default=["hyang-6", "gates-2"], choices=("hyang-6", "gates-2"))
    parser.add_argument("--method", nargs="+", default=[*METHODS], choices=METHODS)
    options = parser.parse_args()
    rows = len(options.place) * len(options.method)
    figure = Figure(figsize=(3.2 * SHOWN, 3.2 * rows), layout="constrained")
    grid: Any = figure.subplots(rows, SHOWN)
    known = places(options)
    for number, place in enumerate(options.place):
        tracks = known[place]
        learned, asked = tracks.windows(protocol="timesplit-train"), tracks.windows(protocol="timesplit")
        past, future = asked
        window, person = np.nonzero(future.scored)
        truth, seen = future.position[window, :, person], past.position[window, :, person]
        walked = np.flatnonzero(np.linalg.norm(truth[:, -1] - seen[:, -1], axis=1) > 3.0)
        before, who_before = np.nonzero(learned[1].scored)
        went = ways(
            seen[walked], learned[0].position[before, :, who_before], learned[1].position[before, :, who_before]
        )
        forks, plain = walked[went > 1], walked[went == 1]
        some = walked if len(forks) < SHOWN else forks
        chosen = some[np.linspace(0, len(some) - 1, SHOWN).round().astype(int)]
        for row, method in enumerate(options.method):
            paths = drawn(options, place, method, learned, asked)
            count = np.array([modes(path) for path in paths])
            error = np.linalg.norm(paths[:, :20] - truth[:, None], axis=-1)
            best = error.mean(axis=2).min(axis=1).mean(), error[:, :, -1].min(axis=1).mean()
            spread = paths[:, :, -1].std(axis=1).mean()
            print(f"{place}, {method}: {len(paths)} people, {count[walked].mean():.2f} modes of who walks over 3 m,"
                  f" {np.mean(count[walked] > 1):.0%} of them with several; {_mean(count[forks])} at forks,"
                  f" {_mean(count[plain])} where all went one way; ends scatter {spread:.2f} m;"
                  f" best of 20 {best[0]:.3f}/{best[1]:.3f} m", flush=True)  # fmt: skip
            for axes, who in zip(grid[len(options.method) * number + row], chosen, strict=True):
                axes.plot(*tracks.position.T, ",", color="0.8", zorder=0)
                start = np.broadcast_to(seen[who, -1], (DRAWS, 1, 2))
                axes.plot(*np.moveaxis(np.concatenate([start, paths[who]], axis=1), -1, 0).swapaxes(1, 2),
                          color="#e69f00", lw=0.5, alpha=0.4)  # fmt: skip
                axes.plot(*seen[who].T, "-o", color="#0072b2", ms=2.5)
                axes.plot(*truth[who].T, "-", color="#009e73", lw=1.6)
                middle = (seen[who, -1] + truth[who, -1]) / 2.0
                axes.set(xlim=middle[0] + np.array([-9, 9]), ylim=middle[1] + np.array([-9, 9]), aspect="equal",
                         xticks=[], yticks=[], title=f"{place}, {method}: {count[who]} modes")  # fmt: skip
                axes.title.set_fontsize(9)
    figure.savefig(options.out / "sdd.png", dpi=80, metadata={"Software": None})


if __name__ == "__main__":
    main()
