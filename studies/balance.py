"""Print how people recover and fall: ``python studies/balance.py leans|pulls|hits|falls|row|films FOLDER [KIND ...]``.

``leans``: largest lean from which a person recovers without a step, with one, and with several, against published
means, and the same for impulses. ``pulls``: the same for forces at the waist for a time [N]. ``hits``: speeds at which
regions hit the floor, against published means. ``falls``: the same after a beam of 60 kg has struck, by direction.
``row``: a push through a row of five standing people. ``films``: pictures of kinds of falls.
"""

from __future__ import annotations

import argparse
import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from crowdbot.core import Scene, Twist
from crowdbot.humans import Gait, People
from crowdbot.models import ORCA
from crowdbot.world import Balance, PhysicsWorld, SceneCamera, balance_ability, push_person
from crowdbot.world.physics.balance.fall import FallMotion, impact_speeds
from impacts import ram

STEP, FALLING = 0.005, 2
WAYS = {"forward": 0.0, "backward": math.pi, "sideways": 0.5 * math.pi}
PUBLISHED = {("man-24", "forward"): 32.5, ("woman-24", "forward"): 30.7, ("man-72", "forward"): 23.9}
"""Mean largest leans [degrees] of Thelen et al. 1997 and Wojcik et al. 1999."""
STANCE = {"forward": 8.3, "backward": 4.3, "sideways": 8.0}


def outcome(name: str, way: float, lean: float = 0.0, speed: float = 0.0) -> int:
    """Return the number of recovery steps, 99 for a fall."""
    balance, heading = Balance(People.of([name]), np.zeros(1, dtype=np.int64), 1), np.zeros(1)
    toward = np.array([math.cos(way), math.sin(way)])
    balance.shift[0] = balance.center[0] * math.sin(lean) * toward
    balance.speed[0] = speed * toward
    for _ in range(800):
        balance.advance(np.zeros(1, dtype=np.int64), heading, STEP)
        if balance.phase[0] == FALLING:
            return 99
    return int(balance.steps[0])


def largest(most: int, values: np.ndarray, count: Callable[[float], int]) -> float:
    """Return the largest value up to which at most ``most`` steps suffice."""
    result = 0.0
    for value in values.tolist():
        if count(value) > most:
            break
        result = value
    return result


def leans() -> None:
    """Print largest leans and impulses."""
    print("person     direction  no step  one step  any      published | impulse per mass: no step, one, any")
    for name, (word, way) in itertools.product(("man-24", "woman-24", "man-50", "man-72"), WAYS.items()):
        angles, speeds = np.arange(0.5, 50.0, 0.25), np.arange(0.02, 3.0, 0.02)
        found = [largest(k, angles, lambda a: outcome(name, way, math.radians(a))) for k in (0, 1, 98)]  # noqa: B023
        pulls = [largest(k, speeds, lambda v: outcome(name, way, 0.0, v)) for k in (0, 1, 98)]  # noqa: B023
        known = PUBLISHED.get((name, word))
        print(
            f"{name:10} {word:9} {found[0]:6.2f}   {found[1]:6.2f}   {found[2]:6.2f}   "
            f"{'-' if known is None else format(known, '6.1f'):>9} | "
            + " ".join(f"{value:5.2f} m/s" for value in pulls),
            flush=True,
        )


def after_pull(name: str, way: float, force: float, duration: float, rise: float = 0.0) -> int:
    """Return the number of recovery steps after a pull at the waist, 99 for a fall.

    The force [N] rises within ``rise`` [s], and acts for ``duration`` [s] in all.
    """
    people = People.of([name])
    balance, heading = Balance(people, np.zeros(1, dtype=np.int64), 1), np.zeros(1)
    toward = np.array([math.cos(way), math.sin(way)]) / float(people.mass[0])
    for k in range(round((duration + 3.0) / STEP)):
        time = k * STEP
        if time < duration - 1e-9:
            share = min(1.0, (time + STEP) / rise) if rise else 1.0
            balance.push(0, share * force * STEP * toward, float(balance.center[0]), None)
        balance.advance(np.zeros(1, dtype=np.int64), heading, STEP)
        if balance.phase[0] == FALLING:
            return 99
    return int(balance.steps[0])


def threshold(most: int, count: Callable[[float], int]) -> float:
    """Return the largest force [N] with at most ``most`` steps, to 1 N."""
    low, high = 0.0, 2048.0
    while high - low > 1.0:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if count(middle) <= most else (low, middle)
    return low


PULLS = {"0.1 s": (0.1, 0.0), "0.25 s": (0.25, 0.0), "0.5 s": (0.5, 0.0), "2 s": (2.0, 0.0), "rise 2 s": (4.0, 2.0)}
"""Protocols of pulls: duration of the force [s], of which it rises [s]."""


def pulls() -> None:
    """Print largest forces at the waist."""
    print("person    weight  direction  pull       no step          one step         no fall")
    for name in ("man-24", "woman-24", "man-72", "woman-72"):
        weight = 9.81 * float(People.of([name]).mass[0])
        for (word, way), (pull, (duration, rise)) in itertools.product(WAYS.items(), PULLS.items()):
            found = [threshold(k, lambda f: after_pull(name, way, f, duration, rise)) for k in (0, 1, 98)]  # noqa: B023
            print(
                f"{name:9} {weight:5.0f} N  {word:9}  {pull:8}  "
                + "  ".join(f"{force:5.0f} N ({100.0 * force / weight:5.1f} %)" for force in found),
                flush=True,
            )


def hits() -> None:
    """Print the speeds at which regions hit the floor in falls that begin at 25 degrees and 1 rad/s, heads striking."""
    names = [f"{kind}-{years}" for kind in ("man", "woman") for years in (55, 60, 66, 72, 79)]
    rows: dict[str, list[tuple[float, ...]]] = {way: [] for way in WAYS}
    lasts = []
    for name in names:
        people = People.of([name])
        gait = Gait(people)
        upright = gait.posture(gait.start([[0.0, 0.0]], [0.0]))
        motion = FallMotion(math.radians(25.0), 1.0, float(balance_ability(people).rate[0]))
        lasts.append(motion.duration)
        for word, way in WAYS.items():
            speeds, _ = impact_speeds(upright, people, 0.0, way, True, motion)
            rows[word].append((speeds["hand"], speeds["pelvis"], speeds["head"]))
    everyone = np.array([row for some in rows.values() for row in some])
    print("hands, hips, heads [m/s]", everyone.mean(axis=0).round(2), "SD", everyone.std(axis=0, ddof=1).round(2))
    for word, some in rows.items():
        print(f"{word:9}", np.mean(some, axis=0).round(2))
    print(f"duration {np.mean(lasts):.2f} s")


def struck(name: str, heading: float, speed: float, mass: float = 100.0, row: int = 1) -> PhysicsWorld:
    """Return a world in which a beam at 1.15 m moves along x towards one or several standing people."""
    place = [[0.0, 0.0], *([0.9 + 0.45 * k, 0.0] for k in range(row))]
    count = len(place)
    scene = Scene.of(
        place, goal=place, heading=[0.0] + [heading] * row, external=[True] + [False] * row,
        radius=[0.3] + [0.2] * row, max_speed=[speed] + [0.0] * row, preferred_speed=[speed] + [0.0] * row,
    )  # fmt: skip
    assert count == row + 1
    return PhysicsWorld(scene, ORCA(), {0: ram(mass, 1.15)}, 0.02, people=People.of([name] * row), balance=True)


def push(world: PhysicsWorld, speed: float, time: float = 2.5) -> Iterator[float]:
    """Yield the times of steps; the beam is withdrawn after its first contact."""
    touched = False
    for k in range(round(time / world.dt)):
        touched = touched or bool(world.contact_events)
        world.step({0: Twist(-1.0 if touched else speed)})
        yield (k + 1) * world.dt


def falls() -> None:
    """Print the falls of people whom a beam strikes."""
    print("direction  speed  person    steps  duration  hand  pelvis  head [m/s]  HIC15")
    for (word, way), name, speed in itertools.product(WAYS.items(), ("man-24", "woman-72"), (1.0, 2.0, 3.0)):
        world = struck(name, -way, speed)
        for _ in push(world, speed):
            pass
        steps = int(world.falling.balance.steps[1]) if world.falling else 0
        for fall in world.falls or [None]:
            if fall is None:
                print(f"{word:10} {speed:4.1f}   {name:9} {steps:3}    no fall", flush=True)
            else:
                print(
                    f"{fall.direction:10} {speed:4.1f}   {name:9} {fall.steps:3}    {fall.end - fall.begin:6.2f}   "
                    f"{fall.hand:5.2f}  {fall.pelvis:5.2f}  {fall.head:5.2f}       {fall.hic15:5.0f}  {fall.cause}",
                    flush=True,
                )


def row() -> None:
    """Print how a push goes through a row of five people."""
    for speed in (0.7, 1.4, 2.5):
        world = struck("man-36", 0.0, speed, row=5)
        start, first, farthest = world.scene.position[0].copy(), np.full(6, np.nan), np.zeros(6)
        for time in push(world, speed, 3.0):
            away = world.scene.position[0, :, 0] - start[:, 0]
            first = np.where(np.isnan(first) & (away > 0.02), time, first)
            farthest = np.maximum(farthest, away)
        moved = np.flatnonzero(~np.isnan(first[1:]))
        rate = 0.45 * (len(moved) - 1) / (first[1 + moved[-1]] - first[1]) if len(moved) > 1 else math.nan
        print(f"beam at {speed} m/s: farthest {farthest[1:].round(2).tolist()} m, speed of the push {rate:.2f} m/s, "
              f"falls {[(fall.person, fall.direction, fall.cause) for fall in world.falls]}", flush=True)  # fmt: skip


FILMS = {
    "stumble": (0.0, 330.0), "forward": (0.0, 620.0), "backward": (math.pi, 620.0),
    "left": (0.5 * math.pi, 620.0), "right": (-0.5 * math.pi, 620.0), "oblique": (0.75 * math.pi, 620.0),
}  # fmt: skip
"""Direction of a pull of 0.25 s relative to the heading, and its force [N]."""
SIDE, ABOVE = (0.8, -3.0, 1.0), (0.0, -0.3, 4.0)
"""Places of the cameras relative to the person [m]."""


def films(folder: Path, kinds: Sequence[str] = (), name: str = "woman-72") -> None:
    """Write a strip of pictures of each kind of fall (default: all), from the side and from above."""
    from PIL import Image

    folder.mkdir(parents=True, exist_ok=True)
    times = [0.0, 0.3, 0.5, 0.6, 0.7, 0.8, 1.0, 1.4, 2.6, 3.4, 4.2, 5.0]
    for kind in kinds or FILMS:
        way, force = FILMS[kind]
        scene = Scene.of([[0.0, 0.0]], goal=[[0.0, 0.0]], heading=[-way], max_speed=[0.0], preferred_speed=[0.0])
        world = PhysicsWorld(scene, ORCA(), {}, 0.02, people=People.of([name]), balance=True, get_up=1.0)
        body = world.people.people
        push_person(world, 0, (force, 0.0), 0.25, float(body.mass[0]), float(body.height[0]))
        sheet, size = Image.new("RGB", (len(times) * 260, 2 * 260)), 260
        for k, time in enumerate(times):
            while world.times[0] < time - 1e-9:
                world.step({})
            x = float(world.scene.position[0, 0, 0])
            for row, (dx, y, z) in enumerate((SIDE, ABOVE)):
                camera = SceneCamera((x + dx, y, z), (x, 0.0, 0.5), width=size, height=size)
                picture = world.render(camera).rgb
                assert picture is not None
                sheet.paste(Image.fromarray(picture), (k * size, row * size))
        half = sheet.width // 2
        stacked = Image.new("RGB", (half, 2 * sheet.height))
        stacked.paste(sheet.crop((0, 0, half, sheet.height)), (0, 0))
        stacked.paste(sheet.crop((half, 0, 2 * half, sheet.height)), (0, sheet.height))
        stacked.save(folder / f"{kind}.png")
        steps = int(world.falling.balance.steps[0]) if world.falling else 0
        print(
            kind,
            steps,
            [(fall.direction, round(fall.pelvis, 2), round(fall.head, 2)) for fall in world.falls],
            flush=True,
        )


if __name__ == "__main__":
    TABLES = {"leans": leans, "pulls": pulls, "hits": hits, "falls": falls, "row": row}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="?", default="leans", choices=(*TABLES, "films"), help="default: leans")
    parser.add_argument("folder", nargs="?", type=Path, metavar="FOLDER", help="folder of the films")
    parser.add_argument("kinds", nargs="*", metavar="KIND", help="kinds of falls (default: all)")
    options = parser.parse_args()
    if options.what != "films":
        TABLES[options.what]()
    elif options.folder is None:
        parser.error("films needs a FOLDER")
    else:
        films(options.folder, options.kinds)
