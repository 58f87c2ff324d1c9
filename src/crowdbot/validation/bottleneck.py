"""Bottleneck test: flow out of a room by the width of its exit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.measurement import MeasurementLine, crossing_times, mean_flow
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats

from .crowd_motion import deepest_overlap, each_start, simulate_open
from .scenario import (
    RADIUS,
    SPECIFIC_FLOW,
    Check,
    CrowdTracks,
    Report,
    Row,
    Verdict,
    bottleneck_solids,
    crowds,
    inside_solids,
    opening,
    portion,
    rings,
    share,
    stream_of,
    tracks_of,
)
from .statistics import mean_of, text_of

PEOPLE = 60
ROOM, HALF = 8.0, 3.0
"""Length and half width of the room [m]."""
LENGTH = 2.8
"""Widths of the bottleneck [m], as in Seyfried et al. 2009."""
WIDTHS = (0.8, 1.0, 1.2, 1.6, 2.0)
TRANSIENT = 1.0 / 6.0
"""Share of the crossings at either end that is left out: the first people meet no jam, the last ones leave it."""
SECONDS = 120.0
TOLERANCE = 0.25
"""Allowed mean relative deviation of the flow from 1.9 persons per second and metre."""


def run(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Measure the flow for each width; starts are environments."""
    widths, people, seconds = ((0.8, 1.2), 20, 30.0) if quick else (WIDTHS, PEOPLE, SECONDS)
    rows: list[Row] = [
        {"width": list(widths), "people": people, "flow": [], "passed": [], "outside": 0.0, "overlap": 0.0}
        for _ in numbers
    ]
    for k, width in enumerate(widths):
        solids = bottleneck_solids(ROOM, HALF, width, LENGTH)

        walk = _leave(model, width, people, numbers, seconds, portion(report, k, len(widths)))
        for own, row in zip(each_start(walk), rows, strict=True):
            flow, passed = _flow(crossings(own, 0.5 * LENGTH), people, seconds)
            row["flow"].append(flow)
            row["passed"].append(passed)
            row["outside"] = max(row["outside"], inside_solids(own, solids))
            row["overlap"] = max(row["overlap"], deepest_overlap(own))
    return rows


def summarize(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the flows of all starts by width, and the interval of the specific flow."""
    flows = np.asarray([row["flow"] for row in rows]).T.tolist()
    return {
        "width": rows[0]["width"],
        "flows": flows,
        "interval": _specific_interval(flows, rows[0]["width"]),
        "passed": np.asarray([row["passed"] for row in rows]).T.tolist(),
        "people": rows[0]["people"],
        "outside": max(row["outside"] for row in rows),
        "overlap": max(row["overlap"] for row in rows),
    }


def judge(result: dict[str, Any]) -> Verdict:
    """Compare the specific flow with the published one, and count stuck people."""
    width, flow = np.asarray(result["width"]), np.mean(result["flows"], axis=1)
    stuck = np.asarray(result["passed"]) < result["people"]
    specific = flow / width
    distance = float(np.mean(np.abs(specific / SPECIFIC_FLOW - 1.0)))
    words = []
    if np.any(stuck):
        worst = width[np.any(stuck, axis=1)]
        words.append(
            f"a crowd of {result['people']} clogs bottlenecks up to {worst.max():g} m wide"
            f" ({int(stuck.sum())} of {stuck.size} runs)"
        )
    if distance > TOLERANCE and not np.all(np.any(stuck, axis=1)):
        kind = "too high" if specific.mean() > SPECIFIC_FLOW else "too low"
        words.append(f"the flow through bottlenecks is {kind}, {specific.mean():.1f} persons per second and metre")
    if result["outside"] > 0.0:
        words.append(f"up to {share(result['outside'])} of people are pushed through the walls of a bottleneck")
    passed = distance <= TOLERANCE and not np.any(stuck) and result["outside"] == 0.0
    return Verdict(f"{text_of(float(specific.mean()), result.get('interval'))} /(m s)", passed, "; ".join(words))


BOTTLENECK = Check(
    "bottleneck",
    "bottleneck",
    f"the mean relative deviation of the flow from {SPECIFIC_FLOW} persons per second and metre is at most"
    f" {TOLERANCE:.0%}, all people leave the room, and nobody's centre enters a wall",
    run,
    summarize,
    judge,
)


def crossings(walk: CrowdTracks, x: float, e: int = 0) -> Floats:
    """Return the sorted times [s] at which people of environment ``e`` first pass ``x`` [m]."""
    return crossing_times(tracks_of(walk, e), MeasurementLine((x, -HALF - 1.0), (x, HALF + 1.0)))


def bottleneck_flow(model: CrowdModel, width: float, people: int, numbers: Sequence[int], step: float) -> list[float]:
    """Return the flow [1/s] through a bottleneck for some starts, with a time step of the model [s]."""
    walk = _leave(model, width, people, numbers, SECONDS, lambda part: None, step)
    return [_flow(crossings(walk, 0.5 * LENGTH, e), people, SECONDS)[0] for e in range(len(numbers))]


def _specific_interval(flows: Sequence[Sequence[float]], widths: Sequence[float]) -> tuple[float, float]:
    """Return the interval of the specific flow [1/(m s)], mean over widths, over the starts."""
    specific = np.mean(np.asarray(flows) / np.asarray(widths)[:, None], axis=0)
    low, high = mean_of(specific)[1]
    return low, high


def steady_flow(times: Floats) -> float:
    """Return the flow [1/s] of the sorted crossings without the transients at both ends: (n - 1) / (t_n - t_1).

    >>> steady_flow(np.array([0.0, 5.0, 6.0, 7.0, 8.0, 20.0]))
    1.0
    """
    cut = round(TRANSIENT * len(times))
    return mean_flow(times[cut : len(times) - cut])


def _flow(times: Floats, people: int, seconds: float) -> tuple[float, int]:
    """Return the steady flow of n people, or (n - 1) / (time limit - t_1) if somebody does not pass; and n."""
    if len(times) < 2:
        return 0.0, len(times)
    return steady_flow(times) if len(times) == people else mean_flow(times, seconds), len(times)


def _leave(
    model: CrowdModel,
    width: float,
    people: int,
    numbers: Sequence[int],
    seconds: float,
    report: Report,
    step: float | None = None,
) -> CrowdTracks:
    place, speed = crowds("bottleneck", people, numbers, (-ROOM + 0.3, -HALF + 0.3), (-1.0, HALF - 0.3))
    crowd = Scene.of(
        place, radius=RADIUS, preferred_speed=speed, walls=rings(bottleneck_solids(ROOM, HALF, width, LENGTH))
    )

    def goals(now: Floats) -> Floats:
        ahead = opening(now, 0.3, 0.0, width)
        ahead[..., 0] = np.where(now[..., 0] > 0.0, now[..., 0] + 3.0, 0.3)
        return ahead

    def left(now: Floats) -> NDArray[np.bool_]:
        return np.asarray(now[..., 0] > LENGTH + 2.0)

    rng = stream_of("bottleneck", "model", width, numbers[0])
    return simulate_open(model, crowd, goals, left, seconds, rng, report, step)
