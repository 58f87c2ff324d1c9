"""Fit the preset ``people`` to recorded people.

    python tools/fit_people.py --data DIR --state FILE [--budget 96] [--windows 8]

Two searches by CMA-ES minimise errors of single tracks and the distance of whole crowds from published values. The
command appends every candidate to FILE (JSON lines) and continues an interrupted run. It prints the errors on folds of
experiments that the choice among the candidates has not seen, the Pareto set, and the profile of each value.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from crowdbot.models import People
from crowdbot.validation.population import Candidate, PopulationFit, fit_report, read_experiments

STARTS = (
    {"follow_gap": 0.85, "headway_anticipation": 0.55, "headway_spacing": 0.0, "headway_width": 0.55,
     "headway_taper": 1.0, "headway_oncoming": 1.0, "strength": 8.6, "range": 0.08, "wall_strength": 6.2,
     "wall_range": 0.034},
    {"follow_gap": 0.85, "headway_anticipation": 0.85, "headway_spacing": 0.0, "headway_width": 0.55,
     "headway_taper": 1.0, "headway_oncoming": 1.0, "strength": 8.6, "range": 0.06, "wall_strength": 3.5,
     "wall_range": 0.034},
    {"follow_gap": 0.94, "headway_anticipation": 0.77, "headway_spacing": 0.009, "headway_width": 0.493,
     "headway_taper": 0.974, "headway_oncoming": 0.794, "strength": 6.2, "range": 0.041, "wall_strength": 1.87,
     "wall_range": 0.041},
)  # fmt: skip
"""First values: those that were chosen by hand, the preset, and a set that predicts tracks better."""


def main() -> int:
    """Search and print the report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder of the recordings")
    parser.add_argument("--state", type=Path, required=True, help="file of the candidates")
    parser.add_argument("--budget", type=int, default=96, help="candidates of each search (default: 96)")
    parser.add_argument("--windows", type=int, default=8, help="windows of each experiment (default: 8)")
    parser.add_argument("--report", action="store_true", help="only print the report of the stored candidates")
    options = parser.parse_args()
    model = People(headway_sliding=1.0, headway_reaction_time=0.0, time_gap=0.0)
    fit = PopulationFit(model, read_experiments(options.data, options.windows), options.state, _progress)
    if not options.report:
        best = fit.search("wide", STARTS, options.budget, 0.1)
        fit.search("narrow", [best.values], options.budget, 0.05)
    before = fit.evaluate("before", [STARTS[0]])[0]
    print(fit_report(fit, before))
    return 0


def _progress(name: str, best: Candidate, cost: float) -> None:
    crowd = best.crowd
    print(
        f"{name}: {cost:.3f}, single file {crowd.single_file:.2f}, corridor {crowd.corridor:.2f},"
        f" flow {crowd.flow:.2f}, queues {crowd.queues}, stuck {crowd.stuck:.2f}, two-way {crowd.two_way:.2f}",
        flush=True,
    )


if __name__ == "__main__":
    raise SystemExit(main())
