"""Trial preview: problems of a trial at its elements, and where people start and walk."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, TrialError, without_running_code
from crowdbot.navigation import PathPlanner
from crowdbot.trials import Trial, expand_sweeps, override_remarks, parse_trial, place, trial_remarks

from .xml_document import XmlDocument

__all__ = ["problems_at_elements", "read_trial", "start_and_ways"]

MESSAGE = re.compile(r":(\d+): (?:<([^>\s]+)>)?")
MOST_WAYS = 60
BODY = 0.25
"""Radius of the bodies whose ways are shown [m]."""


def read_trial(text: str, folder: Path) -> tuple[Trial | None, list[str], list[str]]:
    """Return the trial, or None, with the problems and remarks that ``crowdbot check`` prints; no code is run."""
    try:
        with without_running_code():
            trial = parse_trial(text, folder=folder)
            return trial, [], [*override_remarks(trial.robots), *trial_remarks(trial)]
    except TrialError as error:
        return None, list(error.problems), []
    except InputError as error:
        return None, [str(error)], []


def problems_at_elements(document: XmlDocument | None, problems: list[str]) -> list[dict[str, Any]]:
    """Return each problem with its line and the path of its element, None if it has none."""
    rows = []
    for sentence in problems:
        found = MESSAGE.search(sentence)
        line = int(found[1]) if found else None
        path = document.path_at(line, found[2] or "") if document and found and line else None
        rows.append({"message": sentence, "line": line, "path": None if path is None else list(path)})
    return rows


def start_and_ways(trial: Trial, seed: int) -> dict[str, Any]:
    """Return the start of people and robots with a seed, and the way of some people around walls to their goals.

    Raises:
        InputError: people do not fit with this seed.
    """
    first = expand_sweeps(trial)[0] if trial.sweeps else trial
    people, problems = place(first.stage, first.spawners, first.robots, seed, first.agents, avatars=first.avatars)
    if problems:
        raise InputError(problems[0][1])
    planner = PathPlanner.of(first.stage.walking_walls(), BODY, 0.0) if len(people) else None
    ends = zip(people.position[:MOST_WAYS], people.goal[:MOST_WAYS], strict=True)
    return {
        "seed": seed,
        "people": np.round(people.position, 3).tolist(),
        "radii": np.round(people.radius, 3).tolist(),
        "ways": [_way(planner, *one) for one in ends] if planner else [],
    }


def _way(planner: PathPlanner, start: NDArray[np.float64], goal: NDArray[np.float64]) -> list[list[float]]:
    """Return the corners of the shortest path, only the start where there is none."""
    try:
        corners = planner.waypoints(start, goal)
    except InputError:
        corners = start[None, :0].reshape(0, 2)
    way: list[list[float]] = np.round([start, *corners], 3).tolist()
    return way
