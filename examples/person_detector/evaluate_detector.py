"""Recall and precision of a person detector on images of the simulation, by distance.

    python examples/person_detector/evaluate_detector.py --seeds 3 --upscale 1 2 --plot detector.png

The robot of hall.xml drives through people; an image of each second is searched. A detection is right if its box and a
true box overlap by at least half of their union (IoU). True boxes come from the segmentation of the same image.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
from detectors import add_options, detectors_of
from truth import standard_width, true_boxes

from crowdbot.core import Twist
from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial

TRIAL = Path(__file__).with_name("hall.xml")
EDGES = (0.0, 4.0, 6.0, 8.0, 10.0, 12.0, 20.0)
"""Edges of the classes of distance [m]."""
OVERLAP = 0.5


@dataclass
class Tally:
    """What was right and wrong in a number of images.

    Fields:
        scores, right: of each detection that counts.
        estimate: distance [m] of each of them, from the height of its box.
        distance, score: of each person that counts; score of its detection, -inf without one.
        images: number of images.
    """

    scores: list = field(default_factory=list)
    right: list = field(default_factory=list)
    estimate: list = field(default_factory=list)
    distance: list = field(default_factory=list)
    score: list = field(default_factory=list)
    images: int = 0

    def add(self, found, truth, focal):
        """Count an image: detections from the highest score on take the true box that they overlap most."""
        true, boxes = standard_width(truth.boxes), standard_width(found.boxes)
        overlaps = overlap(boxes, true)
        free, score = np.ones(len(true), dtype=bool), np.full(len(true), -np.inf)
        for k in np.argsort(-found.scores, kind="stable"):
            rivals = np.where(free & (overlaps[k] >= OVERLAP), overlaps[k] + truth.counts, -1.0)  # counted ones first
            best = int(np.argmax(rivals)) if len(rivals) else -1
            matches = best >= 0 and rivals[best] > 0.0
            if matches:
                free[best], score[best] = not truth.counts[best], found.scores[k]
            if not matches or truth.counts[best]:
                self.scores.append(float(found.scores[k]))
                self.right.append(matches)
                self.estimate.append(focal * 1.7 / (boxes[k, 3] - boxes[k, 1]))
        self.distance += truth.distance[truth.counts].tolist()
        self.score += score[truth.counts].tolist()
        self.images += 1

    def recall(self, low=0.0, high=np.inf):
        """Return recall and the number of people between two distances [m]; nan without people."""
        away = np.array(self.distance)
        inside = (away >= low) & (away < high)
        return share(np.isfinite(np.array(self.score))[inside]), int(inside.sum())

    def precision(self, low=0.0, high=np.inf):
        """Return precision and the number of detections between two distances [m]; nan without detections."""
        away = np.array(self.estimate)
        inside = (away >= low) & (away < high)
        return share(np.array(self.right, dtype=bool)[inside]), int(inside.sum())

    def curve(self):
        """Return recall and precision ``[N]`` for falling thresholds."""
        order = np.argsort(-np.array(self.scores), kind="stable")
        right = np.array(self.right, dtype=float)[order].cumsum()
        return right / max(1, len(self.distance)), right / np.arange(1, len(right) + 1)

    def average_precision(self):
        """Return the area under the curve of precision over recall, precision made monotone (PASCAL VOC 2010)."""
        recall, precision = self.curve()
        highest = np.maximum.accumulate(precision[::-1])[::-1]
        return float((np.diff(recall, prepend=0.0) * highest).sum())


def overlap(boxes, others):
    """Return the intersection over union ``[N, M]`` of boxes ``[N, 4]`` and ``[M, 4]``."""
    one, other = boxes[:, None], others[None]
    sides = np.minimum(one[..., 2:], other[..., 2:]) - np.maximum(one[..., :2], other[..., :2])
    common = np.clip(sides, 0.0, None).prod(axis=-1)
    return common / ((one[..., 2:] - one[..., :2]).prod(-1) + (other[..., 2:] - other[..., :2]).prod(-1) - common)


def share(values):
    """Return the mean of booleans, nan without any."""
    return float(values.mean()) if len(values) else float("nan")


def pictures(trial, seed, seconds, every):
    """Yield the readings of the camera, one of each ``every`` seconds, and the scene of their instant."""
    simulation = Simulation(trial, seeds=[seed])
    simulation.begin()
    steps = round(every / trial.step)
    while simulation.tick < round(seconds / trial.step):
        simulation.command("robot", Twist(0.4, 0.0, 0.0))
        simulation.advance()
        for _, mount, reading in simulation.new_readings():
            if mount.name == "camera" and simulation.tick % steps == 0:
                yield reading, simulation.world.scene


def evaluate(detectors, seeds, seconds=12.0, every=1.0, trial=None):
    """Return the tally of each detector, by name, over the seeds of a trial; all get the same images."""
    tallies, trial = {name: Tally() for name in detectors}, trial or load_trial(str(TRIAL))
    for seed in seeds:
        for reading, scene in pictures(trial, seed, seconds, every):
            truth = true_boxes(reading.hit[0], reading.lens, reading.pose.position[0], scene.position[0])
            for name, detector in detectors.items():
                tallies[name].add(detector.detect(reading.rgb[0]), truth, reading.lens.fy)
    return tallies


def print_table(name, tally):
    """Print recall and precision by distance."""
    print(f"{name}, {tally.images} images")
    print("distance [m]   people  recall   detections  precision")
    for low, high in [*pairwise(EDGES), (0.0, np.inf)]:
        (recall, people), (precision, count) = tally.recall(low, high), tally.precision(low, high)
        name = f"{low:.0f} to {high:.0f}" if np.isfinite(high) else "all"
        print(f"{name:<12} {people:>8} {recall:>7.2f} {count:>12} {precision:>10.2f}")
    print(f"average precision {tally.average_precision():.3f}")


def plot(tallies, file):
    """Write a plot of recall and precision by distance, and of precision over recall."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    bins = list(pairwise(EDGES))
    middles = [0.5 * (low + high) for low, high in bins]
    for k, (name, tally) in enumerate(tallies.items()):
        left.plot(middles, [tally.recall(*one)[0] for one in bins], "o-", color=f"C{k}", label=f"recall, {name}")
        left.plot(middles, [tally.precision(*one)[0] for one in bins], "s:", color=f"C{k}", label=f"precision, {name}")
        right.plot(*tally.curve(), color=f"C{k}", label=f"{name}, area {tally.average_precision():.2f}")
    left.set(xlabel="distance [m]", ylim=(0.0, 1.03), xlim=(0.0, EDGES[-1]))
    right.set(xlabel="recall", ylabel="precision", xlim=(0.0, 1.0), ylim=(0.0, 1.03))
    for axes in (left, right):
        axes.legend(loc="lower left", fontsize="small")
        axes.grid(alpha=0.3)
    figure.savefig(file, dpi=110)


def main():
    """Evaluate a detector and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3, help="number of runs, with the seeds from 0 on")
    parser.add_argument("--seconds", type=float, default=12.0, help="simulated time of each run [s]")
    parser.add_argument("--trial", default=str(TRIAL), help="trial with a robot 'robot' and its sensor 'camera'")
    parser.add_argument("--plot", help="file of a plot")
    add_options(parser)
    options = parser.parse_args()
    detectors = detectors_of(options)
    tallies = evaluate(detectors, range(options.seeds), options.seconds, trial=load_trial(options.trial))
    for name, tally in tallies.items():
        print_table(name, tally)
    if options.plot:
        plot(tallies, options.plot)


if __name__ == "__main__":
    main()
