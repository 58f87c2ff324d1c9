"""Detectors, trackers and motion models of the command line, in all combinations."""

from __future__ import annotations

import argparse
import dataclasses
from typing import TYPE_CHECKING

from crowdbot.cli.settings import add_settings, parse_settings

if TYPE_CHECKING:
    from crowdbot.perception import Detector, PredictorMotion, Tracker


STEADY = "constant-velocity"
TRACKER = "global-nearest-neighbor"


def add_choice(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("--detector", nargs="+", metavar="NAME", help="detectors: names from `crowdbot list detectors`, or file.py:Name"
        " (default: lidar-clusters, or cloud-clusters for L-CAS)")  # fmt: skip
    add_settings(parser, "fields of the detector")
    add("--tracker", nargs="+", default=[], metavar="NAME", help="trackers: names from"
        f" `crowdbot list trackers`, or file.py:Name (default: {TRACKER})")  # fmt: skip
    add("--motion", nargs="+", default=[], metavar="NAME", help="motion models of the trackers: predictors or"
        f" crowd models (default: {STEADY})")  # fmt: skip


def chosen_detectors(options: argparse.Namespace) -> dict[str, Detector]:
    """Return the detectors by name.

    Raises:
        InputError: a name or a field is unknown.
    """
    from crowdbot import perception
    from crowdbot.core import InputError, find_class, from_attributes

    values = parse_settings(options.set)
    if values and len(options.detector) > 1:
        raise InputError(f"--set is for one detector, {len(options.detector)} are given")
    kinds = {name: find_class(name, perception, perception.Detector) for name in options.detector}
    return {name: from_attributes(kind, values) for name, kind in kinds.items()}


def chosen_trackers(options: argparse.Namespace) -> dict[str, Tracker]:
    """Return the trackers by name, each with each motion model.

    Raises:
        InputError: a name is unknown, or a tracker has no motion model.
    """
    from crowdbot import perception
    from crowdbot.core import InputError, find_class

    result: dict[str, Tracker] = {}
    for name in options.tracker or [TRACKER]:
        tracker = find_class(name, perception, perception.Tracker)()
        for motion in options.motion or [STEADY]:
            if motion == STEADY:
                result[name] = tracker
            elif "motion" in {field.name for field in dataclasses.fields(tracker)}:
                result[f"{name} + {motion}"] = dataclasses.replace(tracker, motion=_motion(motion))
            else:
                raise InputError(f"--motion {motion}: the tracker {name} has no other motion than {STEADY}")
    return result


def _motion(name: str) -> PredictorMotion:
    """Return the motion model of a predictor or of a crowd model."""
    from crowdbot import models, prediction
    from crowdbot.cli.schemes import build_predictor
    from crowdbot.core import InputError, builtin_classes, find_class
    from crowdbot.perception import PredictorMotion

    try:
        return PredictorMotion(predictor=build_predictor(name, None, {}))
    except InputError:
        if name not in builtin_classes(models, models.CrowdModel) and ":" not in name:
            raise
    return PredictorMotion(predictor=prediction.Simulated(find_class(name, models, models.CrowdModel)(), contact=0.0))
