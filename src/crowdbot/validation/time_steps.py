"""Study of the time step: a lone walker, a single file, a one-way crowd and a bottleneck at several steps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from crowdbot.core import CrowdbotError, Scene
from crowdbot.models import CrowdModel

from .bottleneck import bottleneck_flow
from .corridor import LENGTH, SPREAD, WIDTH, corridor_crowd
from .crowd_motion import simulate_open, simulate_periodic
from .scenario import RADIUS, STEP, Check, Report, Row, Verdict, stream_of, substeps
from .single_file import file_crowd
from .statistics import summarize_starts

STUDIED = (0.01, 0.02, 0.05, 0.1)
"""Time steps [s]."""
DENSITY, FILE_DENSITY = 2.0, 1.0
DOOR, DOOR_PEOPLE = 1.2, 60
SECONDS, LAST = 20.0, 10.0
NAMES = ("walk", "file", "crowd", "flow")
TOLERANCE = 0.1
"""Relative difference to the time step of the other checks that counts as an effect of the step."""


def time_step(model: CrowdModel) -> float:
    """Return the time step [s] that the checks use for a model."""
    return STEP / substeps(model)


def run(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Measure the same four values at each time step; starts are environments."""
    steps = (0.05, 0.1) if quick else STUDIED
    rows: list[Row] = [{"own": time_step(model), "steps": list(steps)} for _ in numbers]
    for name in NAMES:
        for row in rows:
            row[name] = []
    for k, step in enumerate(steps):
        try:
            found = _measure(model, step, numbers, quick)
        except CrowdbotError:
            found = {name: [None] * len(numbers) for name in NAMES}  # the model is unstable at this step
        for name, values in found.items():
            for row, value in zip(rows, values, strict=True):
                row[name].append(value)
        report((k + 1) / len(steps))
    return rows


def _measure(model: CrowdModel, step: float, numbers: Sequence[int], quick: bool) -> dict[str, list[float | None]]:
    seconds, last = (4.0, 2.0) if quick else (SECONDS, LAST)
    rng = stream_of("time-step", step, numbers[0])

    def silent(part: float) -> None:
        pass

    alone = Scene.of([[0.0, 0.0]], radius=RADIUS, preferred_speed=1.33)
    walk = simulate_open(
        model, alone, lambda now: now + np.array([50.0, 0.0]), lambda now: now[..., 0] >= 40.0, 60.0, rng, silent, step
    )
    whole = float(walk.times[-1]) if walk.position[-1, 0, 0, 0] >= 40.0 else None
    speeds: dict[str, list[float | None]] = {}
    for name, crowd, length in (
        ("file", file_crowd([(round(20.0 * FILE_DENSITY), n) for n in numbers]), 20.0),
        ("crowd", corridor_crowd([("one-way", DENSITY, n) for n in numbers], LENGTH, WIDTH, two_way=False,
                                 spread=SPREAD), LENGTH),
    ):  # fmt: skip
        tracks = simulate_periodic(model, crowd, length, seconds, rng, silent, step)
        first = int(np.searchsorted(tracks.times, seconds - last - 1e-9))
        x = tracks.position[..., 0]
        speeds[name] = [float(v) for v in (x[-1] - x[first]).mean(axis=1) / (tracks.times[-1] - tracks.times[first])]
    flow = bottleneck_flow(model, DOOR, 10 if quick else DOOR_PEOPLE, numbers, step)
    return {"walk": [whole] * len(numbers), **speeds, "flow": list(flow)}


def summarize(rows: Sequence[Row]) -> dict[str, Any]:
    """Return means with intervals for each value and step; None where the model fails."""
    result: dict[str, Any] = {"own": rows[0]["own"], "steps": rows[0]["steps"]}
    for name in NAMES:
        table: list[list[float] | None] = []
        for k in range(len(rows[0]["steps"])):
            values = [row[name][k] for row in rows]
            if None in values:
                table.append(None)
            else:
                found = summarize_starts([values])
                table.append([found["mean"][0], found["low"][0], found["high"][0]])
        result[name] = table
    return result


def judge(result: dict[str, Any]) -> Verdict:
    """Name the steps at which a value differs from that at the model's own step."""
    if all(value is None for name in NAMES for value in result[name]):
        return Verdict("unstable", False, "the model is unstable at every time step")
    own = result["steps"].index(min(result["steps"], key=lambda step: abs(step - result["own"])))
    different = []
    for k, step in enumerate(result["steps"]):
        for name in NAMES:
            here, there = result[name][k], result[name][own]
            if (here is None) != (there is None) or (
                here is not None and abs(here[0] - there[0]) > TOLERANCE * max(abs(there[0]), 0.05)
            ):
                different.append(f"{step:g}")
                break
    words = f"results depend on the time step: they differ by more than 10 % at {', '.join(different)} s"
    text = f"own {result['own']:g} s" + (f", differs at {', '.join(different)} s" if different else ", same at all")
    return Verdict(text, not different, words if different else "")


TIME_STEPS = Check(
    "time-step",
    "time step",
    f"a lone walker over 40 m, a single file of {FILE_DENSITY:g} people/m, a one-way crowd of {DENSITY:g} people/m2 and"
    f" the flow through a bottleneck of {DOOR} m at steps of {', '.join(f'{step:g}' for step in STUDIED)} s differ by"
    " at most 10 % from those at the step of the checks",
    run,
    summarize,
    judge,
)
