"""RiMEA tests, and the cases of RiMEA and ISO 20414.

The components of ISO 20414:2020 are listed by name, after NIST TN 1822 (Ronchi, Kuligowski, Reneke, Peacock, Nilsson
2013, doi 10.6028/NIST.TN.1822), from which the standard was developed; its own numbers are not public.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats

from .crowd_motion import each_start, safety_of, simulate_open
from .scenario import (
    CORNER_SOLIDS,
    RADIUS,
    STEP,
    Check,
    Report,
    Row,
    Solid,
    Verdict,
    crowds,
    free_speeds,
    gate,
    rings,
    share,
    stream_of,
)
from .statistics import mean_of, worst_of

SPEED = 1.33
FASTEST, SLOWEST = 26.0, 34.0
"""Allowed times [s] for 40 m at 1.33 m/s, from the guideline."""


def run_corridor(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Simulate one person who walks 40 m in a corridor 2 m wide, from rest."""
    solids: list[Solid] = [(-2.0, 2.0, 44.0, 2.5), (-2.0, -0.5, 44.0, 0.0)]
    crowd = Scene.of([[0.0, 1.0]], radius=RADIUS, preferred_speed=SPEED, walls=rings(solids))
    distance = 40.0

    def left(now: Floats) -> NDArray[np.bool_]:
        return np.asarray(now[..., 0] >= distance)

    rng = stream_of("rimea-1", "model")
    walk = simulate_open(model, crowd, lambda now: np.array([[[60.0, 1.0]]]), left, 60.0, rng, report)
    arrived = bool(walk.position[-1, 0, 0, 0] >= distance)
    return [{"seconds": float(walk.times[-1]) if arrived else None, "way": float(walk.position[-1, 0, 0, 0])}]


def summarize_one(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the row of a test without chance."""
    return dict(rows[0])


def judge_corridor(result: dict[str, Any]) -> Verdict:
    """Check that the time is in the range of the guideline."""
    if result["seconds"] is None:
        way = f"{result['way']:.0f} m in 60 s"
        return Verdict(way, False, f"a person alone in an empty corridor walks only {way}")
    seconds = result["seconds"]
    passed = FASTEST <= seconds <= SLOWEST
    words = "" if passed else f"a person alone in an empty corridor needs {seconds:.0f} s for 40 m"
    return Verdict(f"{seconds:.1f} s", passed, words)


CORRIDOR_TIME = Check(
    "rimea-1",
    "RiMEA 1",
    f"one person with a free speed of 1.33 m/s needs {FASTEST:g} to {SLOWEST:g} s for 40 m in a corridor 2 m"
    " wide, from rest",
    run_corridor,
    summarize_one,
    judge_corridor,
    most=1,
)

CORNER_PEOPLE = 20
CORNER_SECONDS = 60.0


def run_corner(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Simulate twenty people who walk around a corner to the left; starts are environments."""
    place, speed = crowds("rimea-6", CORNER_PEOPLE, numbers, (0.3, 0.25), (6.3, 1.75))
    crowd = Scene.of(place, radius=RADIUS, preferred_speed=speed, walls=rings(CORNER_SOLIDS))

    def goals(now: Floats) -> Floats:
        there, passed = gate(now, (10.0, 2.0), (12.0, 0.0))
        out = np.stack([np.clip(now[..., 0], 10.3, 11.7), now[..., 1] + 3.0], axis=-1)
        return np.where(passed[..., None], out, there)

    def left(now: Floats) -> NDArray[np.bool_]:
        return np.asarray(now[..., 1] > 12.0)

    rng = stream_of("rimea-6", "model", numbers[0])
    walk = simulate_open(model, crowd, goals, left, CORNER_SECONDS, rng, report)
    rows: list[Row] = []
    for own in each_start(walk):
        out = np.any((own.position[..., 1] > 12.0) & own.present, axis=0)
        rows.append(
            {
                "out": int(out.sum()),
                "seconds": float(own.times[-1]),
                **safety_of(own, CORNER_SOLIDS),
            }
        )
    return rows


def summarize_corner(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the smallest number of arrivals, and the mean time with its interval."""
    seconds, ends = mean_of([row["seconds"] for row in rows])
    return {
        "out": min(row["out"] for row in rows),
        "seconds": seconds,
        "interval": ends,
        **worst_of(rows),
    }


def judge_corner(result: dict[str, Any]) -> Verdict:
    """Check that nobody passes through a wall and all arrive."""
    words = []
    if result["outside"] > 0.0:
        words.append(f"{share(result['outside'])} of {CORNER_PEOPLE} people walk through the walls of a corner")
    if result["out"] < CORNER_PEOPLE:
        words.append(
            f"up to {CORNER_PEOPLE - result['out']} of {CORNER_PEOPLE} people do not get around a corner within"
            f" {CORNER_SECONDS:g} s"
        )
    value = f"{result['seconds']:.1f} s" if result["out"] == CORNER_PEOPLE else f"{result['out']} of {CORNER_PEOPLE}"
    return Verdict(value, not words, "; ".join(words))


CORNER = Check(
    "rimea-6",
    "RiMEA 6",
    f"{CORNER_PEOPLE} people walk around the corner of a corridor 2 m wide within {CORNER_SECONDS:g} s in every start,"
    " and nobody's centre enters a wall",
    run_corner,
    summarize_corner,
    judge_corner,
)

WALKERS = 50
WALKED = 20.0
SPEED_TOLERANCE = 0.05


def run_speeds(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Simulate fifty people with different speeds, each alone in an environment, from rest."""
    speed = free_speeds((WALKERS, 1), stream_of("rimea-7"))
    crowd = Scene.of(np.zeros((WALKERS, 1, 2)), radius=RADIUS, preferred_speed=speed)
    rng = stream_of("rimea-7", "model")
    walk = simulate_open(
        model,
        crowd,
        lambda now: now + np.array([100.0, 0.0]),
        lambda now: np.zeros(now.shape[:2], dtype=np.bool_),
        WALKED,
        rng,
        report,
    )
    last = round(5.0 / STEP)
    reached = (walk.position[-1, :, 0, 0] - walk.position[-1 - last, :, 0, 0]) / (last * STEP)
    return [{"wanted": speed[:, 0].tolist(), "reached": reached.tolist()}]


def judge_speeds(result: dict[str, Any]) -> Verdict:
    """Compare the speed of each person with the free speed."""
    worst = float(np.max(np.abs(np.divide(result["reached"], result["wanted"]) - 1.0)))
    passed = worst <= SPEED_TOLERANCE
    words = (
        ""
        if passed
        else f"the speed of a person alone deviates by up to {worst:.0%} from the free speed after {WALKED:g} s"
    )
    return Verdict(f"{worst:.1%}", passed, words)


FREE_SPEEDS = Check(
    "rimea-7",
    "RiMEA 7",
    f"{WALKERS} people with free speeds of 1.34 +- 0.26 m/s, each alone and initially at rest, walk within"
    f" {SPEED_TOLERANCE:.0%} of their free speed in the last 5 of {WALKED:g} s",
    run_speeds,
    summarize_one,
    judge_speeds,
    most=1,
)


class Case(NamedTuple):
    """One case of a guideline.

    Fields:
        name: number or name in the guideline.
        about: what it tests.
        where: names of the checks that run it, empty if none does.
        why: why it is not run, or how the check differs.
    """

    name: str
    about: str
    where: tuple[str, ...] = ()
    why: str = ""


STAIRS = "stairs and ramps slow people down by fixed shares in the physics world, for all crowd models alike"
CHOICE = "crowd models receive goals; the trial or the user chooses exits and routes"
STATE = "the preferred speed is an input of every crowd model"

RIMEA_CASES = (
    Case("1", "speed in a corridor", ("rimea-1",)),
    Case("2", "speed up stairs", (), STAIRS),
    Case("3", "speed down stairs", (), STAIRS),
    Case("4", "fundamental diagram", ("single-file", "corridor")),
    Case("5", "premovement times", ("premovement",)),
    Case("6", "movement around a corner", ("rimea-6",)),
    Case("7", "assignment of demographic parameters", ("rimea-7",)),
    Case("8", "parameter study in a building with storeys", (), "storeys are not supported"),
    Case("9", "crowd that leaves a large room", ("rimea-9",), "a quarter of the people and of the area"),
    Case("10", "assigned exits", ("exits",), "other dimensions of the cabins"),
    Case("11", "choice of an exit", (), CHOICE),
    Case("12", "effect of a bottleneck", ("rimea-12",)),
    Case("13", "jam in front of stairs", (), STAIRS),
    Case("14", "choice of a route", (), CHOICE),
    Case("15", "crowd around a corner", ("rimea-15",), "half of the lengths and a quarter of the people"),
)
"""Tests of the RiMEA guideline 3.0.0."""

ISO_CASES = (
    Case("pre-evacuation times", "people start at their times", ("premovement",)),
    Case("speed in a corridor", "a lone walker keeps the speed", ("rimea-1",)),
    Case("speed on stairs", "a lone walker on stairs", (), STAIRS),
    Case("movement around a corner", "nobody passes through walls", ("rimea-6", "rimea-15")),
    Case("assigned demographics", "free speeds of a population", ("rimea-7",)),
    Case("reduced visibility", "speed falls with visibility", (), STATE),
    Case("incapacitation", "people become unable to move", (), STATE),
    Case("elevators", "people use elevators", (), "elevators are not supported"),
    Case(
        "horizontal counter-flow", "time rises with the people against", ("counter-flow", "narrow"), "half the people"
    ),
    Case("group behaviour", "a group waits for its slow member", ("group",), "20 m in the open"),
    Case("people with disabilities", "slow and large bodies", (), "speed and radius of each person are inputs"),
    Case("exit route allocation", "people use assigned exits", ("exits",)),
    Case("social influence", "exits are chosen by imitation", (), CHOICE),
    Case("affiliation", "familiar exits are preferred", (), CHOICE),
    Case("dynamic availability of exits", "an exit closes", (), "doors of a trial open and close; " + CHOICE),
    Case("congestion", "a queue forms before a narrow passage", ("rimea-12",)),
    Case("maximum flow rates", "the flow through an exit is limited", ("bottleneck", "rimea-9")),
)
"""Components of ISO 20414 and NIST TN 1822."""
