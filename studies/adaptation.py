"""Measures how much a recording of a new place improves the default weights: 0, 3, 10 and 30 minutes of it.

    python studies/adaptation.py DATA OUT

DATA holds sdd_trajnet/Train/stanford/ and sdd/hyang/. The place is SDD hyang, which no default weight saw: trained on
the first minutes of all its videos but one, as `crowdbot train anchor-net --from open` does, and scored on every fourth
window of that one. The videos of sdd/hyang are in pixels; their pedestrians follow those of TrajNet.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from crowdbot.data import Trajectories, load
from crowdbot.evaluation import score_predictor
from crowdbot.metrics import Score
from crowdbot.prediction import (
    AnchorNet,
    Predictor,
    Samples,
    TrainingSchedule,
    make_learner,
    torch_threads,
    train,
)

TEST = "hyang_6"
STEP = 0.4
SCALES = {"video12": 0.054104065, "video13": 0.0541, "video14": 0.0541}
"""Video in pixels -> metres per pixel, estimated by OpenTraj (Amirian et al. 2020)."""
MINUTES = (3, 10, 30)
UPDATES = {3: 150, 10: 300, 30: 600}
"""Minutes -> optimizer steps."""


def first_minutes(tracks: list[Trajectories], minutes: float) -> tuple[list[Trajectories], float]:
    """Return the first minutes of recordings, one after the other, and how many there are."""
    found, left = [], 60.0 * minutes
    for track in tracks:
        seconds = float(track.time[-1])
        if left < 10.0:
            break
        found.append(track if seconds <= left else track.split(left / seconds)[0])
        left -= min(seconds, left)
    return found, minutes - left / 60.0


def pixel_videos(folder: Path) -> list[Trajectories]:
    """Return the pedestrians of the videos in pixels, in metres at 0.4 s."""
    trajectories = []
    for video, scale in SCALES.items():
        tracks = load(folder / video / "annotations.txt", transform=scale)
        tracks = tracks.only("Pedestrian").metres() if tracks.units == "px" else tracks.only("Pedestrian")
        trajectories.append(tracks.resample(STEP))
    return trajectories


def samples_of(tracks: list[Trajectories]) -> Samples:
    """Return the samples of recordings."""
    return Samples.concatenate([Samples.from_windows(*track.windows(), track.name) for track in tracks])


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    files = sorted((options.data / "sdd_trajnet/Train/stanford").glob("hyang_*.txt"))
    test = load(next(path for path in files if path.stem == TEST))
    others = [load(path) for path in files if path.stem != TEST] + pixel_videos(options.data / "sdd/hyang")
    past, future = (windows[::4] for windows in test.windows())

    def row(name: str, predictor: Predictor, more: str) -> None:
        one, many = (score_predictor(predictor, past, future, samples) for samples in (1, 20))
        cells = " | ".join(f"{score.ade:.3f}/{score.fde:.3f}" for score in (one, many) if isinstance(score, Score))
        print(f"| {name} | {one.persons} | {cells} | {more} |", flush=True)

    print("| minutes | persons | K = 1 | 20 | |\n|---|---|---|---|---|")
    row("0", AnchorNet("open"), "the default weights")
    for minutes in MINUTES:
        tracks, there = first_minutes(others, minutes)
        samples = samples_of(tracks)
        kept = samples.select(np.arange(len(samples)) % 5 != 0), samples.select(np.arange(len(samples)) % 5 == 0)
        model = make_learner("anchor-net", "general", {}, *kept, start="open")
        begin, updates = time.process_time(), UPDATES[minutes]
        with torch_threads():
            train(model, TrainingSchedule(updates, check_every=updates), options.out / str(minutes))
        net = AnchorNet(file=str(options.out / str(minutes) / "best.npz"))
        words = f"{there:.1f} min, {samples.people} futures, {updates} updates, {time.process_time() - begin:.0f} CPU s"
        row(str(minutes), net, words)


if __name__ == "__main__":
    main()
