"""``crowdbot track SOURCE --predictor``: what tracking costs predictors."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import print_table

if TYPE_CHECKING:
    from crowdbot.evaluation import TrackingRun


def score_downstream(options: argparse.Namespace, runs: dict[str, list[TrackingRun]]) -> dict[str, Any]:
    """Return the scores by tracker, predictor and input."""
    from crowdbot.cli.schemes import build_predictor
    from crowdbot.evaluation import estimate_downstream

    predictors = {name: build_predictor(name, None, {}) for name in options.predictor or []}
    return {
        label: {name: estimate_downstream(some, one, options.reach) for name, one in predictors.items()}
        for label, some in runs.items()
    }


def print_downstream(scores: dict[str, Any]) -> None:
    """Print one table for each tracker."""
    from crowdbot.evaluation import DOWNSTREAM_SCORES

    head = ("predictor", "input", "ADE [m]", "FDE [m]", "inside 90 %")
    for label, by_predictor in scores.items():
        rows = [
            [name, given, *(str(found[score]) for score in DOWNSTREAM_SCORES)]
            for name, inputs in by_predictor.items()
            for given, found in inputs.items()
        ]
        caption = "forecasts of 3.2 s every 0.4 s of people who are tracked; the same people for all inputs"
        print_table(f"prediction of tracks of {label}", head, rows, caption, words=2)
