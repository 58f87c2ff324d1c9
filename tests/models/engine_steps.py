"""One-step answers of other engines as scenes, how near a model comes to them, and a circle of people."""

from __future__ import annotations

import json

import numpy as np

from crowdbot.core import Scene, Walls


def umans(reference, name):
    """Return the scenes of a UMANS run and its next velocities; people there walk straight to their goals."""
    data = np.load(reference / "umans" / f"crossing_{name}.npz")
    now, after, goal = (data[key].astype(float) for key in ("now", "next", "goal"))
    shape = now.shape[:2]
    scene = Scene.of(
        now[..., :2],
        now[..., 2:4],
        radius=0.25,
        goal=np.broadcast_to(goal, (*shape, 2)),
        preferred_speed=np.broadcast_to(data["pref_speed"].astype(float), shape),
        max_speed=1.8,
    )
    return scene, after[..., 2:4]


def arrived(scene):
    """Return who stands for good in UMANS: the goal lies under the body."""
    return np.linalg.norm(scene.goal - scene.position, axis=-1) <= scene.radius


def jupedsim(reference, name):
    """Return the scenes of a JuPedSim run, one for each place people may be on their way to, and the next states.

    The engine lets people overshoot their goals, so that the scenes have preferred velocities.
    """
    data = np.load(reference / "jupedsim" / f"{name}.npz")
    about = json.loads((reference / "jupedsim" / f"{name}.json").read_text())
    now, after, goal = (data[key].astype(float) for key in ("now", "next", "goal"))
    speed = data["pref_speed"].astype(float)[:, None]
    places = [goal, *DOOR] if name.startswith("bottleneck") else [goal]
    scenes = []
    for place in places:
        away = place - now[..., :2]
        scenes.append(
            Scene.of(
                now[..., :2],
                heading=np.arctan2(now[..., 3], now[..., 2]),
                radius=0.2,
                preferred_velocity=away / np.linalg.norm(away, axis=-1, keepdims=True) * speed,
                max_speed=9.0,
                walls=Walls.around(about["geometry"]),
            )
        )
    return scenes, now, after


def _inset(corner, towards):
    """Return the point 0.2 m from a corner along an edge: there the engine routes people around it."""
    along = np.subtract(towards, corner, dtype=float)
    return corner + 0.2 * along / np.linalg.norm(along)


DOOR = [
    _inset((0.0, 0.6), (0.0, -0.6)),
    _inset((0.0, -0.6), (0.0, 0.6)),
    _inset((0.0, 0.6), (-8.0, -3.0)),
    _inset((0.0, -0.6), (-8.0, -3.0)),
    _inset((0.0, 0.6), (-8.0, 3.0)),
]
"""Way points of the engine in the bottleneck, on the edges of its mesh."""


def report(what, error, near, unit):
    """Print how near the answers are, and return the share within ``near``, the median and the worst."""
    share, median, worst = float(np.mean(error < near)), float(np.median(error)), float(np.max(error))
    print(f"{what}: {share:.2%} within {near:g} {unit}, median {median:.1e}, worst {worst:.1e}, {error.size} steps")
    return share, median, worst


def circle(count, radius, seed):
    """Return places of people on a circle [m], 5 cm off at random, so that not all meet in the middle at once."""
    angle = 2.0 * np.pi * np.arange(count) / count
    place = radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return place + np.random.default_rng(seed).uniform(-0.05, 0.05, (count, 2))
