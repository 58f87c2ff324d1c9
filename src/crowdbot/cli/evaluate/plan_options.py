"""Trials, sweeps and families of metrics of ``crowdbot evaluate`` from its options."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from crowdbot.cli.settings import load_settings_trial, settings

if TYPE_CHECKING:
    from crowdbot.evaluation import EvaluationPlan


def add_plan_options(parser: argparse.ArgumentParser) -> None:
    """Add the options for sweeps and paired runs."""
    parser.add_argument(
        "--sweep",
        nargs="+",
        action="append",
        default=[],
        metavar="NAME=VALUES",
        help="factors with their levels, such as robot.visible=true,false; all combinations, with main effects and"
        " interactions",
    )
    parser.add_argument(
        "--disturbance",
        action="store_true",
        help="also measure the effect on the crowd: each seed runs again with a ghost, and with the robot 1 mm aside",
    )


def statistic_names(options: argparse.Namespace, usual: tuple[str, ...]) -> list[str]:
    """Return the columns: those of ``--metrics``, in which a family with paired runs stands for its first metrics."""
    from crowdbot.evaluation import PAIRED_FAMILIES
    from crowdbot.metrics import metric_families

    names = [*usual] if options.metrics is None else [name.strip() for name in options.metrics.split(",")]
    if options.disturbance and "crowd-disturbance" not in names:
        names.append("crowd-disturbance")
    found: list[str] = []
    for name in names:
        few = metric_families()[name][:3] if name in PAIRED_FAMILIES else ()
        found += [row.name.replace("_", "-") for row in few] or [name]
    return list(dict.fromkeys(found))


def plan_of(options: argparse.Namespace, names: list[str]) -> EvaluationPlan:
    """Return the plan of the options; ``names`` are those of all statistics, of columns and requirements."""
    from crowdbot.core import InputError
    from crowdbot.evaluation import (
        EvaluationPlan,
        check_metrics,
        families_of,
        parse_factors,
        parse_methods,
        parse_robots,
        parse_seeds,
        parse_statistic,
        sweep_trials,
        with_safety,
    )
    from crowdbot.metrics import LOG_FAMILIES

    seeds = parse_seeds("0:20" if options.seeds is None else options.seeds)
    values = settings(options)
    factors = parse_factors([text for texts in options.sweep for text in texts])
    trials, levels = [], {}
    for name in options.trials:
        if not factors:
            trials.append(load_settings_trial(name, values, options.trust))
            continue
        again = [factor.name for factor in factors if factor.name in values]
        if again:
            raise InputError(f"--sweep {again[0]} and --set {again[0]} conflict; give one of them")
        base = load_settings_trial(name, values, options.trust).name
        for trial, row in sweep_trials(
            lambda row, name=name: load_settings_trial(name, {**values, **row}, options.trust),  # type: ignore[misc]
            factors,
        ):
            trials.append(trial)
            levels[trial.name] = (base, row)
    statistics = [parse_statistic(name) for name in names]
    check_metrics(statistics)
    own = dict.fromkeys(statistic.address for statistic in statistics if statistic.address)
    families = (*LOG_FAMILIES, *own, *families_of([statistic.metric for statistic in statistics]))
    methods = parse_methods(options.navigators)
    return EvaluationPlan(
        trials,
        with_safety(methods) if options.safety == "both" else methods,
        parse_robots(options.robots),
        seeds,
        families=families,
        factors=levels,
    )
