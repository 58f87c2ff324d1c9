"""RiMEA tests with a crowd: doors of a hall (9), bottleneck between rooms (12), corner (15)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats

from .crowd_motion import deepest_overlap, each_start, safety_of, simulate_open
from .scenario import (
    RADIUS,
    STEP,
    Check,
    CrowdTracks,
    Report,
    Row,
    Verdict,
    crowds,
    gate,
    hall_solids,
    inside_solids,
    long_corner_solids,
    opening,
    portion,
    rings,
    share,
    stream_of,
    stuck_part,
    stuck_start,
    two_rooms,
)
from .statistics import ends_of, mean_of, summarize_starts, text_of, worst_of

LIMIT = 240.0
"""Time limit of a run [s]."""

HALL, DEPTH = 15.0, 10.0
DOOR = 1.0
DOOR_PEOPLE = 250
"""A quarter of the people in a quarter of the hall of the guideline (30 x 20 m), with doors of the same width."""
LEAST, MOST = 1.6, 2.4
"""Range of time ratios that count as doubling, as in the system test of JuPedSim."""


def run_doors(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Simulate a crowd that leaves a hall by four doors, then by two; starts are environments."""
    people, limit = (40, 20.0) if quick else (DOOR_PEOPLE, LIMIT)
    rows: list[Row] = [
        {"seconds": [], "out": [], "people": people, "limit": limit, "outside": 0.0, "overlap": 0.0} for _ in numbers
    ]
    solids = hall_solids(HALL, DEPTH, DOOR)
    for k, sides in enumerate(((-1.0, 1.0), (-1.0,))):
        walk = hall_walks(model, people, sides, numbers, limit, portion(report, k, 2))
        for own, row in zip(each_start(walk), rows, strict=True):
            y = own.position[..., 1]
            row["seconds"].append(float(own.times[-1]))
            row["out"].append(int(np.any(((y < -0.5) | (y > DEPTH + 0.5)) & own.present, axis=0).sum()))
            row["outside"] = max(row["outside"], inside_solids(own, solids))
            row["overlap"] = max(row["overlap"], deepest_overlap(own))
    return rows


def summarize_doors(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the ratio of the times with its interval, over the starts in which all people leave."""
    done = [row for row in rows if min(row["out"]) == row["people"]]
    ratio, ends = mean_of([row["seconds"][1] / row["seconds"][0] for row in done]) if done else (None, None)
    return {
        "ratio": ratio,
        "interval": ends,
        "seconds": np.mean([row["seconds"] for row in rows], axis=0).tolist(),
        "limit": rows[0]["limit"],
        "out": min(min(row["out"]) for row in rows),
        "people": rows[0]["people"],
        "stuck": len(rows) - len(done),
        "starts": len(rows),
        **worst_of(rows),
    }


def judge_doors(result: dict[str, Any]) -> Verdict:
    """Check that half of the doors takes about twice the time."""
    words, ratio = [], result["ratio"]
    if result["stuck"]:
        words.append(
            f"{stuck_start(result)} not all of {result['people']} people leave a hall within {result['limit']:g} s"
            f" (at least {result['out']} do)"
        )
    if ratio is None:
        value = f"{result['stuck']} of {result['starts']} stuck"
    else:
        value = f"{text_of(ratio, result['interval'])}{stuck_part(result)}"
        if not LEAST <= ratio <= MOST:
            words.append(f"a hall takes {ratio:.1f} times as long to empty with half of its doors")
    if result["outside"] > 0.0:
        words.append(f"{share(result['outside'])} of people leave a hall through its walls")
    return Verdict(value, not words, "; ".join(words))


DOORS = Check(
    "rimea-9",
    "RiMEA 9",
    f"{DOOR_PEOPLE} people leave a hall of {HALL:g} x {DEPTH:g} m through four doors of {DOOR:g} m, and then through"
    f" the two doors of one side, which takes {LEAST} to {MOST} times as long in the mean; all people leave in every"
    " start, and nobody's centre enters a wall",
    run_doors,
    summarize_doors,
    judge_doors,
)

ROOM_PEOPLE = 150
SLOW = 0.3
"""People slower than this [m/s] within 2 m before an opening are in a queue."""
QUEUE = 5.0
"""Minimum number of people in a jam."""


def run_rooms(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Simulate a crowd that walks from a room through a corridor into a second room and leaves it."""
    people, limit = (30, 25.0) if quick else (ROOM_PEOPLE, LIMIT)
    solids = two_rooms(5.0, DOOR, leave=True)
    place, speed = crowds("rimea-12", people, numbers, (0.3, 0.3), (8.5, 9.7))
    crowd = Scene.of(place, radius=RADIUS, preferred_speed=speed, walls=rings(solids))

    def goals(now: Floats) -> Floats:
        x = now[..., 0]
        door = opening(now, 10.3, 5.0, DOOR)
        within = np.stack([x + 3.0, np.clip(now[..., 1], 4.75, 5.25)], axis=-1)
        way = np.where((x > 10.0)[..., None], within, door)
        way = np.where((x > 15.2)[..., None], opening(now, 25.3, 5.0, DOOR), way)
        return np.where((x > 25.0)[..., None], within, way)

    def left(now: Floats) -> NDArray[np.bool_]:
        return np.asarray(now[..., 0] > 27.0)

    rng = stream_of("rimea-12", "model", numbers[0])
    walk = simulate_open(model, crowd, goals, left, limit, rng, report)
    rows: list[Row] = []
    for own in each_start(walk):
        rows.append(
            {
                "out": int(np.any((own.position[..., 0] > 25.3) & own.present, axis=0).sum()),
                "people": people,
                "seconds": float(own.times[-1]),
                "queues": [_queue(own, 10.0), _queue(own, 25.0)],
                **safety_of(own, solids),
            }
        )
    return rows


def summarize_rooms(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the mean queues with their intervals."""
    queues = summarize_starts(np.asarray([row["queues"] for row in rows]).T)
    return {
        "out": min(row["out"] for row in rows),
        "people": rows[0]["people"],
        "stuck": sum(row["out"] < row["people"] for row in rows),
        "starts": len(rows),
        "queues": queues["mean"],
        "interval": ends_of(queues),
        **worst_of(rows),
    }


def judge_rooms(result: dict[str, Any]) -> Verdict:
    """Check for a queue in front of the corridor, and none in front of the exit."""
    first, second = result["queues"]
    words = []
    if result["stuck"]:
        words.append(f"{stuck_start(result)} not all of {result['people']} people get through two rooms in time")
    if first < QUEUE:
        words.append("no queue forms in front of a corridor 1 m wide")
    if second >= QUEUE:
        words.append(f"a queue of {second:.0f} forms at an exit, although the corridor before it has the same width")
    if result["outside"] > 0.0:
        words.append(f"{share(result['outside'])} of people walk through the walls between two rooms")
    return Verdict(f"{first:.0f} | {second:.0f}{stuck_part(result)}", not words, "; ".join(words))


TWO_ROOMS = Check(
    "rimea-12",
    "RiMEA 12",
    f"{ROOM_PEOPLE} people walk from a room of 10 x 10 m through a corridor of 5 x 1 m into a second room, and leave it"
    f" through an exit of 1 m. The queue has at least {QUEUE:g} people in front of the corridor and fewer at the exit;"
    f" it is the 95th percentile over time of the number of people within 2 m who are slower than {SLOW} m/s. All"
    " people leave in every start, and nobody's centre enters a wall",
    run_rooms,
    summarize_rooms,
    judge_rooms,
)

CORNER_CROWD = 125
LONG, SHORT = 40.5, 25.0
WAYS = {"short": SHORT, "corner": None, "long": LONG}
"""Length of each corridor [m], None for the one with the corner."""


def run_long_corner(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Simulate a crowd in a wide corridor with a corner, and in straight ones as long as its outer and inner walls."""
    people, limit = (30, 50.0) if quick else (CORNER_CROWD, 120.0)
    rows: list[Row] = [{"seconds": [], "out": [], "people": people, "outside": 0.0} for _ in numbers]
    for k, name in enumerate(WAYS):
        walk, arrived = corner_walks(model, name, people, numbers, limit, portion(report, k, len(WAYS)))
        for own, row in zip(each_start(walk), rows, strict=True):
            row["seconds"].append(float(own.times[-1]))
            row["out"].append(int(np.any(arrived(own.position) & own.present, axis=0).sum()))
            row["outside"] = max(row["outside"], inside_solids(own, long_corner_solids(WAYS[name])))
    return rows


def summarize_long_corner(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the mean times with their intervals, and in how many starts people do not arrive."""
    found = summarize_starts(np.asarray([row["seconds"] for row in rows]).T)
    return {
        "seconds": found["mean"],
        "interval": ends_of(found),
        "people": rows[0]["people"],
        "stuck": sum(min(row["out"]) < row["people"] for row in rows),
        "starts": len(rows),
        **worst_of(rows, overlap=False),
    }


def judge_long_corner(result: dict[str, Any]) -> Verdict:
    """Check that the time of the corner is between those of the short and the long corridor."""
    short, corner, long = result["seconds"]
    words = []
    if result["stuck"]:
        words.append(f"{stuck_start(result)} not everyone gets through a wide corridor with a corner in time")
    elif not short <= corner <= long:
        words.append(
            f"a crowd needs {corner:.0f} s around a wide corner, but {short:.0f} s and {long:.0f} s in straight"
            " corridors as long as its inner and outer walls"
        )
    if result["outside"] > 0.0:
        words.append(f"{share(result['outside'])} of people walk through the walls of a wide corner")
    return Verdict(f"{short:.0f} < {corner:.0f} < {long:.0f} s{stuck_part(result)}", not words, "; ".join(words))


LONG_CORNER = Check(
    "rimea-15",
    "RiMEA 15",
    f"{CORNER_CROWD} people in a corridor 10 m wide with a corner need more time than in a straight corridor of"
    f" {SHORT:g} m, the length of its inner wall, and less than in one of {LONG:g} m, the length of its outer wall; the"
    " guideline has twice the lengths and four times the people",
    run_long_corner,
    summarize_long_corner,
    judge_long_corner,
)


def hall_walks(
    model: CrowdModel, people: int, sides: tuple[float, ...], numbers: Sequence[int], limit: float, report: Report
) -> CrowdTracks:
    """Return the tracks of a crowd that leaves a hall by its doors.

    Args:
        model: crowd model.
        people: their number.
        sides: -1 for the two doors at y = 0, 1 for those at the other side.
        numbers: of the starts, which are environments.
        limit: time limit [s].
        report: called with the completed share.
    """
    place, speed = crowds("rimea-9", people, numbers, (0.3, 0.3), (HALL - 0.3, DEPTH - 0.3))
    crowd = Scene.of(place, radius=RADIUS, preferred_speed=speed, walls=rings(hall_solids(HALL, DEPTH, DOOR)))

    def goals(now: Floats) -> Floats:
        x, y = now[..., 0], now[..., 1]
        middle = np.where(x < 0.5 * HALL, 0.25 * HALL, 0.75 * HALL)
        side = np.where(y < 0.5 * DEPTH, -1.0, 1.0) if len(sides) == 2 else np.full(y.shape, sides[0])
        wall = np.where(side < 0.0, 0.0, DEPTH)
        free = 0.5 * DOOR - RADIUS - 0.05
        through = side * (y - wall) > -0.1
        return np.stack(
            [np.clip(x, middle - free, middle + free), np.where(through, y + 3.0 * side, wall + 0.3 * side)], axis=-1
        )

    def left(now: Floats) -> NDArray[np.bool_]:
        return np.asarray((now[..., 1] < -1.5) | (now[..., 1] > DEPTH + 1.5))

    rng = stream_of("rimea-9", "model", len(sides), numbers[0])
    return simulate_open(model, crowd, goals, left, limit, rng, report)


def _queue(walk: CrowdTracks, x: float) -> float:
    """Return the 95th percentile over time of slow people within 2 m before the opening at ``x``, y = 5 m."""
    second = round(1.0 / STEP)
    place, present = walk.position[::second, 0], walk.present[::second, 0]
    speed = np.hypot(*np.moveaxis(place[1:] - place[:-1], -1, 0))
    away = place[1:] - np.array([x, 5.0])
    near = (np.hypot(away[..., 0], away[..., 1]) < 2.0) & (away[..., 0] < 0.0) & present[1:] & present[:-1]
    waiting = np.sum(near & (speed < SLOW), axis=1)
    busy = np.any(near, axis=1)
    return float(np.percentile(waiting[busy], 95.0)) if np.any(busy) else 0.0


def corner_walks(
    model: CrowdModel, name: str, people: int, numbers: Sequence[int], limit: float, report: Report
) -> tuple[CrowdTracks, Callable[[Floats], NDArray[np.bool_]]]:
    """Return the tracks in the corridor ``short``, ``corner`` or ``long``, and who has arrived by position.

    The other arguments are those of :func:`hall_walks`.
    """
    top = WAYS[name] or 30.0
    # same people at the same positions in all three
    place, speed = crowds("rimea-15", people, numbers, (0.3, -3.0), (9.7, -0.3))
    place = place + np.array([0.0, top])
    crowd = Scene.of(place, radius=RADIUS, preferred_speed=speed, walls=rings(long_corner_solids(WAYS[name])))
    arrived: Callable[[Floats], NDArray[np.bool_]]

    if name == "corner":

        def goals(now: Floats) -> Floats:
            there, passed = gate(now, (10.0, 10.0), (0.0, 0.0))
            out = np.stack([now[..., 0] + 3.0, np.clip(now[..., 1], 0.3, 9.7)], axis=-1)
            return np.where(passed[..., None], out, there)

        def arrived(now: Floats) -> NDArray[np.bool_]:
            return np.asarray(now[..., 0] > 15.0)

    else:

        def goals(now: Floats) -> Floats:
            return np.asarray(now + np.array([0.0, -3.0]))

        def arrived(now: Floats) -> NDArray[np.bool_]:
            return np.asarray(now[..., 1] < 0.0)

    rng = stream_of("rimea-15", "model", name, numbers[0])
    return simulate_open(model, crowd, goals, arrived, limit, rng, report), arrived
