"""``crowdbot run TRIAL``: run one trial, record it and print what happened."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from .output import add_json, number, print_json, print_metrics, print_table, progress
from .settings import add_settings, chosen, settings


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("trial", metavar="TRIAL", help="a trial file or a built-in name, such as crossing-flows")
    parser.add_argument("--seed", type=int, help="seed of everything random (default: the trial's own)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="record to DIR/episode.mcap")
    parser.add_argument("--trust", action="store_true", help="let the trial load code from outside its own folder")
    add_settings(parser)
    parser.add_argument("--variant", type=int, metavar="N", help="of a trial with sweeps: which one, from 1")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Run the trial."""
    from crowdbot.trials import load_trial

    trial = chosen(load_trial(options.trial, trust=options.trust, **settings(options)), options.variant)
    file = None if options.out is None else options.out / "episode.mcap"
    begin = time.perf_counter()
    with progress(options.json) as report:
        episode = trial.run(seed=options.seed, out=file, progress=lambda share: report(f"run {trial.name}", share))
    wall = time.perf_counter() - begin
    summary = {
        "trial": trial.name,
        "seed": episode.seed,
        "outcome": episode.outcome,
        "steps": episode.steps,
        "sim_seconds": float(episode.times[-1]),
        "wall_seconds": wall,
        "digest": episode.digest,
        "episode": None if file is None else str(file),
    }
    if options.json:
        print_json({**summary, "metrics": episode.metrics})
        return 0
    print_table(f"{trial.name}, seed {episode.seed}", ("", ""), [(key, number(v)) for key, v in summary.items()])
    print_metrics("navigation", episode.metrics)
    return 0
