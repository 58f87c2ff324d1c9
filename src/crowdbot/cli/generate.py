"""``crowdbot generate SOURCE ...``: labelled sensor data from trials, with true people, in shards."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from crowdbot.cli.output import add_json, note, print_json, print_robots, print_table, progress
from crowdbot.cli.settings import add_seeds, add_settings, add_world, load_settings_trial, settings

if TYPE_CHECKING:
    from crowdbot.generation import DataCard, GenerationPlan
    from crowdbot.trials import Trial


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("sources", nargs="+", metavar="SOURCE", help="trial files, built-in trials, or the recipe flow or"
        " corridor-clouds")  # fmt: skip
    add("--out", type=Path, required=True, metavar="DIR", help="folder of the data; the same command continues")
    add_seeds(parser, "0:10, or those of the recipe")
    add("--sensors", default="", metavar="LIST", help="sensor presets on the first robot, separated by commas:"
        " sick-tim571, front=realsense-d435 (default: none)")  # fmt: skip
    add("--noise", action="store_true", help="add the noise of the products to sensor presets")
    add("--format", default="npz", metavar="NAME", help="npz, parquet, webdataset or mcap (default: npz)")
    add("--coco", action="store_true", help="write colour images as PNG with boxes, masks and keypoints in coco.json")
    add("--kitti", action="store_true", help="write images, boxes and point clouds in the folders of KITTI")
    add("--compress", action="store_true", help="compress the files: smaller and slower")
    add("--shard-size", type=float, default=400.0, metavar="MB", help="approximate size of a shard (default: 400)")
    add("--workers", type=int, default=1, metavar="N", help="number of processes (default: 1)")
    add("--cluster", metavar="ADDRESS", help="address of a Ray cluster with a shared file system, auto, or local")
    add("--trust", action="store_true", help="allow code outside the folders of the trials")
    add_world(parser)
    add_settings(parser)
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Generate the data and print the card."""
    from crowdbot.generation import generate

    plan, begin = make_plan(options), time.perf_counter()
    print_robots(plan.trials, options.json)
    try:
        with progress(options.json) as report:
            card = generate(
                plan,
                options.out,
                workers=options.workers,
                cluster=options.cluster,
                progress=lambda share: report("generate", share),
            )
    except KeyboardInterrupt:
        note(f"crowdbot: finished shards are in {options.out}; the same command continues")
        raise
    if options.json:
        print_json(card.values() | {"wall": time.perf_counter() - begin})
    else:
        _print(card, options.out, time.perf_counter() - begin)
    return 0


def make_plan(options: argparse.Namespace) -> GenerationPlan:
    """Return the plan of the options; recipes add their trials and sensors.

    Raises:
        InputError: recipes are mixed with trials, or a value is not allowed.
    """
    from crowdbot.core import InputError
    from crowdbot.evaluation import parse_seeds
    from crowdbot.generation import RECIPES, GenerationPlan

    chosen = [name for name in options.sources if name in RECIPES]
    if chosen and len(options.sources) > 1:
        raise InputError(f"recipe {chosen[0]!r} must be the only source; give trials without a recipe instead")
    seeds: Sequence[int] = parse_seeds("0:10" if options.seeds is None else options.seeds)
    sensors = tuple(name.strip() for name in options.sensors.split(",") if name.strip())
    if chosen:
        recipe = RECIPES[chosen[0]]
        seeds = range(recipe.seeds) if options.seeds is None else parse_seeds(options.seeds)
        sensors = sensors or recipe.sensors
        trials = [_load(options, name, dict(values)) for name, values in recipe.trials]
    else:
        trials = [_load(options, name, {}) for name in options.sources]
    return GenerationPlan(
        trials,
        seeds,
        sensors,
        options.format,
        options.coco,
        options.compress,
        int(1e6 * options.shard_size),
        options.noise,
        options.trust,
        options.kitti,
    )


def _load(options: argparse.Namespace, name: str, values: dict[str, str]) -> Trial:
    from crowdbot.core import InputError, did_you_mean
    from crowdbot.generation import RECIPES
    from crowdbot.trials import builtin_trials

    hint = did_you_mean(name, RECIPES)
    if hint and name not in builtin_trials() and not Path(name).exists():
        raise InputError(f"there is no trial or recipe {name!r}{hint}")
    return load_settings_trial(name, values | settings(options), options.trust)


def _print(card: DataCard, out: Path, wall: float) -> None:
    rows = [[name, str(count)] for name, count in card.rows.items()]
    minutes = card.seconds / 60.0
    outcomes = ", ".join(f"{count} {name}" for name, count in sorted(card.outcomes.items()))
    print_table(card.title, ["table", "rows"], rows)
    print(f"outcomes  {outcomes}")
    print(f"size      {card.size / 1e6:.1f} MB in {len(card.files)} files ({card.form})")
    print(f"time      {minutes:.1f} simulated minutes in {wall:.1f} s, {60.0 * minutes / max(wall, 1e-9):.0f} times"
          " real time")  # fmt: skip
    print(f"card      {out / 'README.md'}")
