"""Further cases of RiMEA and ISO 20414: premovement times, assigned exits, counter-flow between rooms, slow groups."""

from __future__ import annotations

from collections.abc import Sequence
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
    cabin_solids,
    crowds,
    free_speeds,
    inside_solids,
    opening,
    portion,
    rings,
    share,
    stream_of,
    stuck_part,
    stuck_start,
    two_rooms,
    waiting_room,
)
from .statistics import ends_of, mean_of, summarize_starts, worst_of

WAITING = 10
EARLIEST, LATEST = 10.0, 100.0
"""Premovement times of RiMEA test 5 [s], uniform."""
DRIFT, DELAY = 0.5, 2.0
"""Largest way of people before their premovement time [m], and largest time until they walk 0.5 m after it [s]."""


def run_premovement(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Simulate ten people in a room of 8 x 5 m with different premovement times."""
    scale = 0.1 if quick else 1.0
    place, speed = crowds("premovement", WAITING, numbers, (0.5, 0.5), (6.5, 4.5))
    begin = scale * np.stack([stream_of("premovement times", n).uniform(EARLIEST, LATEST, WAITING) for n in numbers])
    crowd = Scene.of(place, radius=RADIUS, preferred_speed=speed, walls=rings(waiting_room()))

    def goals(now: Floats) -> Floats:
        door = opening(now, 8.3, 2.5, 1.0)
        return np.where((now[..., 0] > 8.0)[..., None], now + np.array([3.0, 0.0]), door)

    def left(now: Floats) -> NDArray[np.bool_]:
        return np.asarray(now[..., 0] > 10.0)

    rng = stream_of("premovement", "model", numbers[0])
    walk = simulate_open(model, crowd, goals, left, scale * LATEST + 30.0, rng, report, begin=begin)
    return [_waits(own, own_begin) for own, own_begin in zip(each_start(walk), begin, strict=True)]


def _waits(walk: CrowdTracks, begin: Floats) -> Row:
    """Return the largest way before the premovement time and the largest delay after it."""
    way = np.hypot(*np.moveaxis(walk.position[:, 0] - walk.position[:1, 0], -1, 0))
    drift, delay = 0.0, 0.0
    for a, wait in enumerate(begin):
        before = walk.times <= wait + 1e-9
        drift = max(drift, float(way[before, a].max()))
        step = walk.position[:, 0, a] - walk.position[before, 0, a][-1]
        moved = np.flatnonzero((np.hypot(step[:, 0], step[:, 1]) >= 0.5) & ~before & walk.present[:, 0, a])
        delay = max(delay, float(walk.times[moved[0]] - wait) if len(moved) else 1e3)
    return {"drift": drift, "delay": delay, "overlap": deepest_overlap(walk)}


def summarize_premovement(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the largest way and delay of all starts."""
    return {name: max(row[name] for row in rows) for name in ("drift", "delay", "overlap")}


def judge_premovement(result: dict[str, Any]) -> Verdict:
    """Check that people stand until their premovement time and then walk."""
    words = []
    if result["drift"] > DRIFT:
        words.append(f"people with a premovement time are pushed up to {result['drift']:.1f} m before it")
    if result["delay"] > DELAY:
        late = "never" if result["delay"] > 900.0 else f"only {result['delay']:.0f} s"
        words.append(f"people start {late} after their premovement time")
    delay = "never" if result["delay"] > 900.0 else f"{result['delay']:.1f} s"
    return Verdict(f"{result['drift']:.2f} m, {delay}", not words, "; ".join(words))


PREMOVEMENT = Check(
    "premovement",
    "premovement times",
    f"{WAITING} people in a room of 8 x 5 m have premovement times of {EARLIEST:g} to {LATEST:g} s (their preferred"
    f" velocity is 0 before): nobody is more than {DRIFT} m away at that time, and everybody has walked 0.5 m"
    f" {DELAY:g} s after it",
    run_premovement,
    summarize_premovement,
    judge_premovement,
)

CABINS, CABIN = 6, 3.0
"""Cabins on each side of the corridor, and their width [m]."""
DEEP, WAY = 3.0, 2.0
"""Depth of the cabins and width of the corridor [m]."""
SECOND_EXIT = (4, 5)
"""Columns of cabins whose people are assigned to the exit on the right; all others use the main exit on the left."""


def run_exits(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Simulate 23 people in twelve cabins who leave by the exits that they are assigned to."""
    rngs = [stream_of("exits", number) for number in numbers]
    cabin = np.repeat(np.arange(2 * CABINS), 2)[:-1]
    column, upper = cabin % CABINS, cabin // CABINS == 1
    inner = np.where(upper, 0.5 * WAY, -0.5 * WAY - DEEP)[:, None]
    corner = np.stack([column * CABIN, inner[:, 0]], axis=-1)
    seat = np.where((np.arange(len(cabin)) % 2 == 0)[:, None], (0.8, 1.5), (2.2, 1.5))
    place = np.stack([corner + seat + rng.uniform(-0.3, 0.3, seat.shape) for rng in rngs])
    speed = np.stack([free_speeds((len(cabin),), rng) for rng in rngs])
    right = np.isin(column, SECOND_EXIT)
    solids = cabin_solids(CABINS, CABIN, DEEP, WAY)
    crowd = Scene.of(place, radius=RADIUS, preferred_speed=speed, walls=rings(solids))
    end = CABINS * CABIN
    door = np.stack([(column + 0.5) * CABIN, np.zeros(len(cabin))], axis=-1)
    mouth = np.stack([door[:, 0], np.where(upper, 0.5 * WAY + 0.3, -0.5 * WAY - 0.3)], axis=-1)

    def goals(now: Floats) -> Floats:
        x, y = now[..., 0], now[..., 1]
        out = np.stack([np.where(right, x + 3.0, x - 3.0), np.clip(y, -0.5, 0.5)], axis=-1)
        free = np.abs(x - door[:, 0]) < 0.25
        inside = np.abs(y) > 0.5 * WAY - 0.3
        return np.where(inside[..., None], np.where(free[..., None], door, mouth), out)

    def left(now: Floats) -> NDArray[np.bool_]:
        return np.asarray((now[..., 0] < -2.0) | (now[..., 0] > end + 2.0))

    rng = stream_of("exits", "model", numbers[0])
    walk = simulate_open(model, crowd, goals, left, 20.0 if quick else 90.0, rng, report)
    rows: list[Row] = []
    for own in each_start(walk):
        x = own.position[:, 0, :, 0]
        here = own.present[:, 0]
        by_left, by_right = np.any((x < -1.0) & here, axis=0), np.any((x > end + 1.0) & here, axis=0)
        rows.append(
            {
                "people": len(cabin),
                "right": int(np.sum(np.where(right, by_right & ~by_left, by_left & ~by_right))),
                "wrong": int(np.sum(np.where(right, by_left, by_right))),
                "seconds": float(own.times[-1]),
                **safety_of(own, solids),
            }
        )
    return rows


def summarize_exits(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the smallest number of people at the right exit, and the mean time with its interval."""
    seconds, ends = mean_of([row["seconds"] for row in rows])
    return {
        "people": rows[0]["people"],
        "right": min(row["right"] for row in rows),
        "wrong": max(row["wrong"] for row in rows),
        "seconds": seconds,
        "interval": ends,
        **worst_of(rows),
    }


def judge_exits(result: dict[str, Any]) -> Verdict:
    """Check that everybody leaves by the assigned exit."""
    words = []
    if result["wrong"]:
        words.append(f"{result['wrong']} of {result['people']} people leave twelve cabins by the wrong exit")
    if result["right"] + result["wrong"] < result["people"]:
        words.append(
            f"{result['people'] - result['right']} of {result['people']} people do not get out of twelve cabins"
        )
    if result["outside"] > 0.0:
        words.append(f"{share(result['outside'])} of people walk through the walls of cabins")
    return Verdict(f"{result['right']} of {result['people']}", not words, "; ".join(words))


ASSIGNED_EXITS = Check(
    "exits",
    "assigned exits",
    f"23 people in twelve cabins of {CABIN:g} x {DEEP:g} m along a corridor {WAY:g} m wide leave by the exits at its"
    " two ends that they are assigned to, in every start within 90 s, and nobody's centre enters a wall",
    run_exits,
    summarize_exits,
    judge_exits,
)

AGAINST = (0, 10, 50)
"""People in the second room."""
FIRST_ROOM = 50
COUNTER_SECONDS = 180.0


def run_counter(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Simulate two crowds that change rooms through a corridor of 10 x 2 m; starts are environments."""
    against, first = ((0, 10), 10) if quick else (AGAINST, FIRST_ROOM)
    limit = 40.0 if quick else COUNTER_SECONDS
    rows: list[Row] = [{"seconds": [], "out": [], "people": first, "against": list(against), "outside": 0.0}
                       for _ in numbers]  # fmt: skip
    solids = two_rooms(10.0, 2.0, leave=False)
    for k, count in enumerate(against):
        walk = _exchange(model, first, count, numbers, limit, portion(report, k, len(against)))
        for own, row in zip(each_start(walk), rows, strict=True):
            entered = (own.position[:, 0, :first, 0] > 20.0) & own.present[:, 0, :first]
            out = np.any(entered, axis=0)
            last = float(own.times[np.argmax(entered, axis=0)].max()) if np.all(out) else limit
            row["seconds"].append(last)
            row["out"].append(int(out.sum()))
            row["outside"] = max(row["outside"], inside_solids(own, solids))
    return rows


def summarize_counter(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the mean times with their intervals, and in how many starts people do not arrive."""
    found = summarize_starts(np.asarray([row["seconds"] for row in rows]).T)
    return {
        "against": rows[0]["against"],
        "people": rows[0]["people"],
        "seconds": found["mean"],
        "interval": ends_of(found),
        "stuck": sum(min(row["out"]) < row["people"] for row in rows),
        "starts": len(rows),
        **worst_of(rows, overlap=False),
    }


def judge_counter(result: dict[str, Any]) -> Verdict:
    """Check that more people against take more time, and that all arrive."""
    words, seconds = [], result["seconds"]
    if result["stuck"]:
        words.append(f"{stuck_start(result)} two crowds block each other in a corridor 2 m wide")
    if np.any(np.diff(seconds) < -STEP):
        words.append("a crowd gets through a corridor faster if more people come against it")
    if result["outside"] > 0.0:
        words.append(f"{share(result['outside'])} of two crowds in a corridor are pushed through its walls")
    text = " < ".join(f"{second:.0f}" for second in seconds)
    return Verdict(f"{text} s{stuck_part(result)}", not words, "; ".join(words))


COUNTER_FLOW = Check(
    "counter-flow",
    "counter-flow",
    f"{FIRST_ROOM} people walk from a room of 10 x 10 m through a corridor of 10 x 2 m into a second room, from which"
    f" {', '.join(map(str, AGAINST))} people come against them: the mean time rises with their number, all arrive"
    f" within {COUNTER_SECONDS:g} s in every start, and nobody's centre enters a wall (half of the guideline's people)",
    run_counter,
    summarize_counter,
    judge_counter,
)

GROUP_WAY = 20.0
FAST, SLOW = 1.25, 0.5
"""Free speeds of three members and of the fourth [m/s]."""
TOGETHER = 10.0
"""Largest time between the first and the last member at the end of the way [s]."""


def run_group(model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[Row]:
    """Simulate a group of four, one of them slow, that walks 20 m; starts are environments."""
    way = 6.0 if quick else GROUP_WAY
    place = np.stack([
        np.array([[0.0, 0.0], [0.0, 0.7], [-0.7, 0.0], [-0.7, 0.7]]) + stream_of("group", n).uniform(-0.1, 0.1, (4, 2))
        for n in numbers
    ])  # fmt: skip
    crowd = Scene.of(place, radius=RADIUS, preferred_speed=np.array([FAST, FAST, FAST, SLOW]), group=np.zeros(4, int))

    def left(now: Floats) -> NDArray[np.bool_]:
        return np.broadcast_to(np.all(now[..., 0] > way, axis=1)[:, None], now.shape[:2])

    rng = stream_of("group", "model", numbers[0])
    walk = simulate_open(model, crowd, lambda now: now + np.array([50.0, 0.0]), left, 4.0 * way, rng, report)
    rows: list[Row] = []
    for own in each_start(walk):
        past = (own.position[:, 0, :, 0] > way) & own.present[:, 0]
        there = np.any(past, axis=0)
        times = own.times[np.argmax(past, axis=0)]
        rows.append({"gap": float(np.ptp(times)) if np.all(there) else None})
    return rows


def summarize_group(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the mean time between the first and the last member with its interval."""
    gaps = [row["gap"] for row in rows]
    if None in gaps:
        return {"gap": None, "interval": None}
    gap, ends = mean_of(gaps)
    return {"gap": gap, "interval": ends}


def judge_group(result: dict[str, Any]) -> Verdict:
    """Check that the group arrives together."""
    gap = result["gap"]
    if gap is None:
        return Verdict("not all arrive", False, "a group with a slow member does not arrive")
    words = (
        ""
        if gap <= TOGETHER
        else f"a group with a slow member arrives {gap:.0f} s apart: groups have no effect on speed"
    )
    return Verdict(f"{gap:.0f} s", gap <= TOGETHER, words)


SLOW_MEMBER = Check(
    "group",
    "group",
    f"a group of four, three with a free speed of {FAST} m/s and one of {SLOW} m/s, arrives after {GROUP_WAY:g} m"
    f" within {TOGETHER:g} s of each other",
    run_group,
    summarize_group,
    judge_group,
)


def _exchange(
    model: CrowdModel, first: int, against: int, numbers: Sequence[int], limit: float, report: Report
) -> CrowdTracks:
    """Simulate the exchange; people vanish 3 m inside the other room, so that they do not fill its door."""
    place, speed = crowds("counter-flow", first, numbers, (0.3, 0.3), (8.5, 9.7))
    if against:
        other, other_speed = crowds("counter-flow against", against, numbers, (0.3, 0.3), (8.5, 9.7))
        other = np.stack([30.0 - other[..., 0], other[..., 1]], axis=-1)
        place, speed = np.concatenate([place, other], axis=1), np.concatenate([speed, other_speed], axis=1)
    crowd = Scene.of(place, radius=RADIUS, preferred_speed=speed, walls=rings(two_rooms(10.0, 2.0, leave=False)))
    side = np.where(np.arange(place.shape[1]) < first, 1.0, -1.0)

    def goals(now: Floats) -> Floats:
        entry = opening(now, 0.0, 5.0, 2.0)
        entry[..., 0] = np.where(side > 0.0, 10.3, 19.7)
        ahead = np.stack([now[..., 0] + 3.0 * side, np.clip(now[..., 1], 4.25, 5.75)], axis=-1)
        reached = np.where(side > 0.0, now[..., 0] > 10.0, now[..., 0] < 20.0)
        return np.where(reached[..., None], ahead, entry)

    def left(now: Floats) -> NDArray[np.bool_]:
        return np.asarray(np.where(side > 0.0, now[..., 0] > 23.0, now[..., 0] < 7.0))

    rng = stream_of("counter-flow", "model", against, numbers[0])
    return simulate_open(model, crowd, goals, left, limit, rng, report)
