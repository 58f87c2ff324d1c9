"""Two trainings of a navigator among recorded people: a table of docs/results/learned-navigator.md.

    python examples/train_navigator.py --network attention --environments 416 --steps 1000000 --cases 0 \
        --seed 0:5 --out own
    python examples/train_navigator.py --network attention --environments 416 --steps 1000000 --cases 0 \
        --seed 0:5 --crowd orca --out orca
    python studies/recorded_crowds.py zara01/obsmat.txt zara02/obsmat.txt --weights orca own --people 100

In each case a robot replaces one person of a recording, with the start, the goal, the starting time and about the speed
of this person, and has three times the time of the person. The people are evenly chosen among those who end at least
5 m from their start. All others follow the recording (`replayed`), or `orca` from when the robot, which they see, is
nearer than 5 m (`reactive`). The walls of the place are not there. A difference is the second training minus the first
one in the same cases: of the shares of success and collisions, and of the times of the cases in which both succeed.
Intervals of 95 % are bootstrap intervals over the people. If both folders have trainings of several seeds (``seed-0``,
``seed-1``, ...), the values of a case are means over the seeds that both have.
"""

from __future__ import annotations

import argparse
import dataclasses
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crowdbot.core import CrowdbotError, InputError
from crowdbot.evaluation import Estimate, EvaluationPlan, bootstrap_estimate, evaluate, parse_methods
from crowdbot.trials import Trial, recorded_trial
from crowdbot.typing import Floats

LEAST = 5.0
"""Least distance from the start to the end of a person whom a robot replaces [m]."""
SLOWER = 3.0
"""Time limit of the robot, as a multiple of the time of the person."""
MODES = {"replayed": "scripted", "reactive": "reactive"}
"""How people move, with the name in trials."""
METRICS = ("success", "collision", "time_to_goal")
HEAD = "| recording | people | cases | success, {0} | success, {1} | difference | of collisions | of time [s] |"


def cases(path: Path, mode: str, count: int) -> list[Trial]:
    """Return trials in which a robot replaces one of so many people of a recording, in the order of their ids."""
    tracks = recorded_trial(path).recorded[0].tracks()
    walks = {}
    for person in np.unique(tracks.id).tolist():
        rows = np.flatnonzero(tracks.id == person)
        rows = rows[np.argsort(tracks.time[rows])]
        if np.hypot(*(tracks.position[rows[-1]] - tracks.position[rows[0]])) >= LEAST:
            walks[person] = float(tracks.time[rows[-1]] - tracks.time[rows[0]])
    if not walks:
        raise InputError(f"{path}: nobody ends at least {LEAST:g} m from the start; give another recording")
    people = list(walks)
    chosen = [people[k] for k in np.unique(np.linspace(0, len(people) - 1, min(count, len(people))).astype(int))]
    found = []
    for person in chosen:
        trial = recorded_trial(path, mode=MODES[mode], replace=person, name=f"{path.parent.name}-{person}")
        found.append(dataclasses.replace(trial, duration=SLOWER * walks[person]))
    return found


def values(trials: Sequence[Trial], file: Path) -> Floats:
    """Return the metrics ``[M, N]`` of a navigator with these weights in each trial; NaN where one has none.

    All are NaN where a run is impossible, such as one that begins in a contact.
    """
    method = parse_methods(f"{file.stem} file={file}")
    found = evaluate(EvaluationPlan(trials, method, seeds=(0,), families=("task",))).cells
    return np.array([[next(iter(cell.values(metric)), np.nan) for cell in found] for metric in METRICS])


def pairs(first: Path, second: Path) -> list[tuple[Path, Path]]:
    """Return the weights that are in both folders, also of trainings of several seeds, which have a folder each."""
    names = sorted(file.relative_to(first) for pattern in ("*.npz", "seed-*/*.npz") for file in first.glob(pattern))
    found = [(first / name, second / name) for name in names if (second / name).is_file()]
    if not found:
        raise InputError(f"{first} and {second} have no weights of the same name, such as seed-0/attention-policy.npz")
    return found


def row(name: str, mode: str, first: Floats, second: Floats) -> str:
    """Return a row of the table from the metrics ``[K, M, N]`` of K trainings in N cases, without impossible ones."""
    possible = np.isfinite(first[:, 0]).all(axis=0) & np.isfinite(second[:, 0]).all(axis=0)
    first, second = first[..., possible], second[..., possible]
    shares = [str(bootstrap_estimate(each[:, 0].mean(axis=0))) for each in (first, second)]
    known = np.isfinite(first) & np.isfinite(second)
    gap = np.where(known, second - first, 0.0).sum(axis=0)
    count = known.sum(axis=0)
    gaps = [str(_rounded(gap[m, count[m] > 0] / count[m, count[m] > 0])) for m in range(len(METRICS))]
    return f"| {name} | {mode} | {first.shape[2]} | {' | '.join([*shares, *gaps])} |"


def _rounded(differences: Floats) -> Estimate:
    """Return their mean with its interval, without what the sum of shares leaves instead of 0."""
    found = bootstrap_estimate(differences)
    return found._replace(value=round(found.value, 9) + 0.0, low=round(found.low, 9), high=round(found.high, 9))


def print_table(recordings: Sequence[Path], weights: Sequence[Path], people: int) -> None:
    """Print the rows of all recordings, with replayed people and then with reactive ones."""
    first, second = weights
    files = pairs(first, second)
    head = HEAD.format(first.name, second.name)
    print(head, "|---" * (head.count("|") - 1) + "|", sep="\n", flush=True)
    for mode in MODES:
        whole = []
        for path in recordings:
            trials = cases(path, mode, people)
            both = [np.array([values(trials, pair[side]) for pair in files]) for side in (0, 1)]
            print(row(path.parent.name, mode, *both), flush=True)
            whole.append(both)
        if len(whole) > 1:
            print(row("all", mode, *(np.concatenate([both[side] for both in whole], axis=2) for side in (0, 1))))
    print(f"\nTrainings of each: {', '.join(str(file.relative_to(first)) for file, _ in files)}")


def main(words: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recordings", nargs="+", type=Path, help="files of recordings, each in a folder with its name")
    parser.add_argument("--weights", nargs=2, type=Path, required=True, help="folders of the two trainings")
    parser.add_argument("--people", type=int, default=100, help="largest number of cases of a recording")
    options = parser.parse_args(words)
    try:
        print_table(options.recordings, options.weights, options.people)
    except CrowdbotError as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
