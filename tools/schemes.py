"""Measure calibrated crowds against baselines and write docs/schemes.md with its plots.

python tools/schemes.py SHARED docs        SHARED holds data/; about half an hour on two cores, and it resumes
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Sequence
from pathlib import Path

from crowdbot.benchmark import Result, Study, plot_errors
from crowdbot.data import Recording
from crowdbot.models.goals import CurrentDirection
from crowdbot.prediction import ConstantVelocity, Kalman, Recipe, Simulated

MODELS = ("orca", "social-force", "power-law", "boids")
COSTS = ("absolute", "inter-pedestrian", "progressive")
SEARCHES = ("greedy", "annealing", "genetic")
GOALS = ("ground-truth", "current-direction")
BUDGET = 300
VARIANTS = tuple(ConstantVelocity(count) for count in (1, 2, 3, 5, 7))

TEXT = """# Calibrated crowds against baselines

Made by `python tools/schemes.py SHARED docs` (SHARED holds the recordings). Every number is an ADE [m] over about one
second, the mean over people, protocol `all`; the 95 % intervals draw people, with all their windows, 1000 times.

## The experiment of the report (its figure 15)

ORCA, SocialForce, PowerLaw and Boids x three costs x three searches x two goals = 72 schemes, each person's own
parameters, {budget} evaluations for each window; rows of the ETH recording (`obsmat.txt`) are 0.4 s apart, 8 observed,
3 predicted (1.2 s), every 4th window; those of the laboratory corridor (`bo-360-090-090.txt`, two-way) are 0.2 s apart,
5 observed, 5 predicted (1 s), every 8th window.

```
crowdbot predict --data obsmat.txt --every 4 --predict 3 --predictor constant-velocity kalman simulated \\
    --model orca social-force power-law boids --cost absolute inter-pedestrian progressive \\
    --search greedy annealing genetic --goal ground-truth current-direction --budget 300 --out DIR
crowdbot predict --data bo-360-090-090.txt --step 0.2 --observe 5 --predict 5 --every 8 ... --out DIR
```
"""


def main() -> None:
    shared, docs = Path(sys.argv[1]) / "data", Path(sys.argv[2])
    folder = docs / "schemes"
    folder.mkdir(parents=True, exist_ok=True)
    parts = [TEXT.format(budget=BUDGET), _report(shared, folder), _learned(shared, folder)]
    (docs / "schemes.md").write_text("\n".join(parts), encoding="utf-8")


def _report(shared: Path, folder: Path) -> str:
    recordings = (
        Recording(str(shared / "eth_biwi/seq_eth/obsmat.txt"), predict=3, every=4),
        Recording(
            str(shared / "hermes/Corridor-2D/bo-360-090-090.txt"), step=0.2, observe=5, predict=5, every=8
        ),
    )  # fmt: skip
    recipes = [Recipe(predictor) for predictor in (*VARIANTS, Kalman())]
    for model, cost, search, goal in itertools.product(MODELS, COSTS, SEARCHES, GOALS):
        crowd = Simulated(model, CurrentDirection(), cost, search, BUDGET)
        recipes.append(Recipe(crowd, goal if goal == "ground-truth" else None))
    results = _run(Study(recordings, tuple(recipes)), folder, "report")
    lines = ["![ADE of every scheme and baseline](schemes/report.png)\n"]
    for recording in recordings:
        own = [one for one in results if one.recording is recording]
        lines += [f"### {recording.name}\n", *_summary(own)]
    return "\n".join(lines)


def _summary(results: Sequence[Result]) -> list[str]:
    """Say which scheme beats the best baseline, and give the table model x cost with the best search of each goal."""
    base = min((one for one in results if not one.frames.calibrated), key=lambda one: one.score.ade)
    real = [one for one in results if one.frames.calibrated and one.recipe.goal != "ground-truth"]
    best = min(real, key=lambda one: one.score.ade)
    beaten = [one for one in real if one.score.ade < base.score.ade]
    oracle = min((one for one in results if one.recipe.goal == "ground-truth"), key=lambda one: one.score.ade)
    away, (low, high) = best.score.difference(base.score)
    lines = [
        f"{base.score.persons} persons in {base.score.windows} windows. The best baseline is {base.label}"
        f" ({base.score.ade:.4f}). Of {len(real)} schemes without knowledge of the future {len(beaten)} are better; the"
        f" best one is {best.label} ({best.score.ade:.4f}; less the baseline {away:+.4f}, 95 % {low:+.4f} to"
        f" {high:+.4f}). With true destinations the best is {oracle.label} ({oracle.score.ade:.4f}).\n",
        "| model | cost | " + " | ".join(f"{search}, {goal}" for goal in GOALS for search in SEARCHES) + " |",
        "|---|---" + "|---" * 6 + "|",
    ]
    found = {one.label: one.score.ade for one in results}
    for model, cost in itertools.product(MODELS, COSTS):
        cells = [f"{found[f'{model}, {cost}, {search}, {goal}']:.3f}" for goal in GOALS for search in SEARCHES]
        lines.append(f"| {model} | {cost} | " + " | ".join(cells) + " |")
    return [*lines, ""]


PLACES = {
    "eth": ("eth_biwi/seq_eth/obsmat.txt", {"predict": 3}),
    "hotel": ("eth_ucy_splits/all_data/biwi_hotel.txt", {"fps": 25.0, "predict": 3}),
    "univ": ("eth_ucy_splits/all_data/students003.txt", {"fps": 25.0, "predict": 3, "every": 4}),
    "zara1": ("eth_ucy_splits/all_data/crowds_zara01.txt", {"fps": 25.0, "predict": 3}),
    "zara2": ("eth_ucy_splits/all_data/crowds_zara02.txt", {"fps": 25.0, "predict": 3}),
    "corridor, one-way": ("hermes/Corridor-1D/uo-080-240-240.txt", {"step": 0.2, "observe": 5, "predict": 5}),
    "corridor, two-way": ("hermes/Corridor-2D/bo-360-090-090.txt", {"step": 0.2, "observe": 5, "predict": 5}),
    "corridor, bi_corr": (
        "juelich/bidirectional/bi_corr_400_b_03.txt", {"step": 0.2, "observe": 5, "predict": 5, "every": 4},
    ),
}  # fmt: skip

LEARNED = """## Learned goals, layout, population prior, shared parameters

The first half of each recording, in time, is learned from; the second half is predicted (univ and bi_corr every 4th
window). `learned`: destinations learned there; `layout`: exits derived from where people were; `prior`: the joint
distribution of everyone's parameters there; `shared`: one set of parameters fitted there. Progressive cost, genetic
search, {budget} evaluations. In brackets the share of people predicted closer than 0.2 m to another.

```
crowdbot predict --data FILE --learn 0.5 --predict 3 --predictor constant-velocity simulated --model orca \\
    --goal learned-destinations --cost progressive --search genetic --budget 300 [--prior learn | --shared]
```
"""


def _learned(shared: Path, folder: Path) -> str:
    recordings = tuple(Recording(str(shared / path), learn=0.5, **more) for path, more in PLACES.values())

    def scheme(model: str = "orca") -> Simulated:
        return Simulated(model, CurrentDirection(), "progressive", "genetic", BUDGET)

    made: dict[str, Recipe] = {f"cv, mean of {one.displacements}": Recipe(one) for one in VARIANTS}
    made |= {
        "Kalman": Recipe(Kalman()),
        "ORCA, current direction, as given": Recipe(Simulated("orca")),
        "ORCA, current direction, each": Recipe(scheme()),
        "ORCA, layout, each": Recipe(scheme(), "environment-layout"),
        "ORCA, learned, as given": Recipe(Simulated("orca"), "learned-destinations"),
        "ORCA, learned, each": Recipe(scheme(), "learned-destinations"),
        "ORCA, learned, prior": Recipe(scheme(), "learned-destinations", prior=True),
        "ORCA, learned, shared": Recipe(scheme(), "learned-destinations", shared=True),
        "SocialForce, learned, shared": Recipe(scheme("social-force"), "learned-destinations", shared=True),
        "PowerLaw, learned, shared": Recipe(scheme("power-law"), "learned-destinations", shared=True),
    }
    results = _run(Study(recordings, tuple(made.values())), folder, "learned")
    found = {(one.recording.path, one.recipe.name): one for one in results}
    lines = [LEARNED.format(budget=BUDGET), "| | " + " | ".join(PLACES) + " |", "|---" * (len(PLACES) + 1) + "|"]
    for label, recipe in made.items():
        cells = [_cell(found[recording.path, recipe.name]) for recording in recordings]
        lines.append(f"| {label} | " + " | ".join(cells) + " |")
    return "\n".join([*lines, "", *_verdicts(recordings, made, found)])


def _cell(result: Result) -> str:
    return f"{result.score.ade:.4f} ({100.0 * result.score.collisions:.1f} %)"


def _verdicts(
    recordings: Sequence[Recording], made: dict[str, Recipe], found: dict[tuple[str, str], Result]
) -> list[str]:
    """Say for each scheme on how many recordings it beats the best constant velocity, and whether collisions fell."""
    lines = [
        "| scheme | better than the best constant velocity | fewer collisions than constant velocity |",
        "|---|---|---|",
    ]
    variants = [made[f"cv, mean of {one.displacements}"].name for one in VARIANTS]
    for label, recipe in made.items():
        if not isinstance(recipe.predictor, Simulated):
            continue
        better, fewer = [], 0
        for (place, _), recording in zip(PLACES.items(), recordings, strict=True):
            one = found[recording.path, recipe.name].score
            best = min((found[recording.path, name].score for name in variants), key=lambda score: score.ade)
            away, (_, high) = one.difference(best)
            better += [f"{place}{' (95 %)' if high < 0.0 else ''}"] if away < 0.0 else []
            fewer += one.collisions <= found[recording.path, variants[0]].score.collisions
        count = len(recordings)
        lines.append(f"| {label} | {len(better)} of {count}: {', '.join(better) or '-'} | {fewer} of {count} |")
    return [*lines, "", "(95 %): the interval of the difference, drawn by person, lies below 0.", ""]


def _run(study: Study, folder: Path, name: str) -> list[Result]:
    done = []
    pieces = len(study.pieces())
    for piece, part in study.run(keep=Path("build/schemes")):
        done.append((piece, part))
        print(f"\r{name}: {len(done)} of {pieces}", end="", file=sys.stderr, flush=True)
    results = study.results(done)
    plot_errors(results, folder / f"{name}.png")
    return results


if __name__ == "__main__":
    main()
