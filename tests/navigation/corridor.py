"""A robot among 40 people who walk both ways in a corridor: closed-loop runs of a navigator, many seeds at once.

``python tests/navigation/corridor.py`` prints the rates over 50 seeds for every navigator.
"""

import math

import numpy as np

from crowdbot import models
from crowdbot.core import Scene, stream
from crowdbot.metrics import navigation_metrics
from crowdbot.navigation import DriveLimits, Observation, ORCANavigator, Straight
from crowdbot.world import DifferentialDrive, PlanarWorld, Twists

WAYS = {"across": ((0.0, 0.6), (0.0, 0.6)), "diagonal": ((-4.0, 0.6), (4.0, 0.6)), "along": ((-8.0, 3.5), (8.0, 3.5))}
"""Start and goal of the robot: x [m], and its distance [m] from the right wall (start) or the left one (goal)."""
DRIVE = DifferentialDrive(max_speed=1.0, max_turn_rate=1.5, max_acceleration=1.0, max_turn_acceleration=3.0)
LIMITS = DriveLimits(1.0, 1.5, 1.0, 3.0)
CONTROL = 2
"""Time steps for each decision."""
DT = 0.05
TOLERANCE = 0.3


def robot_way(way, width):
    (x, right), (to, left) = WAYS[way]
    return np.array([(x, right - width / 2), (to, width / 2 - left)])


def people(seed, way, width, length, count):
    """Return start, goal, radius and speed of the robot (first) and of people who keep clear of each other."""
    rng = stream(seed, "corridor")
    start, goal = robot_way(way, width)
    place, radius, goals, speed = [start], [0.3], [goal], [1.0]
    while len(place) <= count:
        here = np.array([rng.uniform(-length / 2, length / 2), rng.uniform(0.4 - width / 2, width / 2 - 0.4)])
        size = rng.uniform(0.2, 0.3)
        gap = np.hypot(*(np.array(place) - here).T) - np.array(radius) - size
        if gap[0] > 0.8 and np.min(gap) > 0.1:
            place.append(here)
            radius.append(size)
            goals.append(np.array([1000.0 * (-1) ** len(place), here[1]]))
            speed.append(float(np.clip(rng.normal(1.34, 0.26), 0.56, 2.12)))
    return np.array(place), np.array(goals), np.array(radius), np.array(speed)


def start_scene(seeds, way, width, length, count, visible):
    place, goal, radius, speed = map(np.stack, zip(*(people(s, way, width, length, count) for s in seeds), strict=True))
    velocity = np.zeros_like(place)
    velocity[:, 1:, 0] = np.sign(goal[:, 1:, 0]) * speed[:, 1:]
    heading = np.arctan2(velocity[..., 1], velocity[..., 0])
    heading[:, 0] = np.arctan2(*(goal[:, 0] - place[:, 0])[:, ::-1].T)
    walls = [[(-1000.0, side), (1000.0, side)] for side in (-width / 2, width / 2)]
    robot = np.arange(count + 1) == 0
    return Scene.of(
        place,
        velocity,
        heading=heading,
        radius=radius,
        goal=goal,
        preferred_speed=speed,
        external=robot,
        visible=~robot | visible,
        walls=walls,
    )


def round_again(scene, length):
    """Let people who walked out at one end in at the other, where there is room."""
    place = scene.position.copy()
    outside = np.abs(place[..., 0]) > length / 2
    outside[:, 0] = False
    for e, a in np.argwhere(outside):
        entry = np.array([-math.copysign(length / 2, place[e, a, 0]), place[e, a, 1]])
        gap = np.hypot(*(place[e] - entry).T)
        gap[a] = np.inf
        if gap[0] > 2.5 and np.min(gap) > 0.7:
            place[e, a] = entry
    return scene.replace(position=place) if np.any(outside) else scene


def run(navigator, seeds, way="across", *, crowd=None, width=7.0, length=20.0, count=40, visible=True, limit=40.0):
    """Return the navigation metrics of each seed."""
    scene = start_scene(seeds, way, width, length, count, visible)
    world = PlanarWorld(scene, crowd or models.ORCA(), {0: DRIVE}, DT)
    goal, radius, walls = scene.goal[:, 0], scene.radius, scene.walls.segments()
    steps, E = round(limit / DT), len(seeds)
    logs, last, held = [scene], np.full(E, steps), np.zeros((2, E))
    for step in range(steps):
        going = np.flatnonzero(last == steps)
        if len(going) == 0:
            break
        if step % CONTROL == 0:
            for e in going:
                twist = world.twists[0].at(e)
                seen = Observation.of(world.scene, 0, LIMITS, dt=CONTROL * DT, twist=twist, environment=int(e))
                held[:, e] = navigator.decide(seen, None)[0].twist[:2]
        after = world.step({0: Twists(held[0].copy(), held[1].copy(), np.zeros(E))})
        logs.append(after)
        done = np.hypot(*(after.position[:, 0] - goal).T) < TOLERANCE
        done[[contact.environment for contact in world.contacts]] = True
        last[done & (last == steps)] = step + 1
        world.scene = round_again(after, length)
    rows = []
    for e in range(E):
        position, velocity, heading = (
            np.stack([getattr(log, name)[e] for log in logs[: last[e] + 1]])
            for name in ("position", "velocity", "heading")
        )
        times, active = DT * np.arange(len(position)), np.ones(position.shape[:2], dtype=bool)
        rows.append(
            navigation_metrics(
                times, position, velocity, radius[e], active, 0, goal[e], TOLERANCE, heading=heading[:, 0], walls=walls
            )
        )
    return rows


def share(rows, name):
    return float(np.mean([row[name] for row in rows]))


def table(seeds=range(50)):
    settings = [(way, 7.0, 20.0 if way == "across" else 30.0) for way in WAYS] + [("diagonal", 10.0, 40.0)]
    print("crowd, robot is, way, corridor, navigator: success collision timeout | time [s] efficiency compliance")
    for crowd, visible in ((models.ORCA(), True), (models.ORCA(), False), (models.SocialForce(), True)):
        for way, width, length in settings:
            for navigator in (Straight(), ORCANavigator()):
                rows = run(navigator, seeds, way, crowd=crowd, width=width, length=length, visible=visible)
                rates = " ".join(f"{share(rows, name):.2f}" for name in ("success", "collision", "timeout"))
                times = [row["time_to_goal"] for row in rows if row["success"]]
                spent = f"{np.mean(times):.1f}" if times else "-"
                quality = f"{share(rows, 'path_efficiency'):.2f} {share(rows, 'personal_space_compliance'):.2f}"
                words = (type(crowd).__name__, "seen" if visible else "unseen", way, f"{length:.0f} x {width:.0f} m")
                print(", ".join(words), f"{type(navigator).__name__}: {rates} | {spent} {quality}", flush=True)


if __name__ == "__main__":
    table()
