"""Posing and skinning people, and rays at their skins, timed."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import Bodies, Scene, Skins, SpatialPose, stream

from .measurement import Measurement

PEOPLE, OFTEN, ALLOWED = 100, 100, 0.01
"""Number of people, repeats per work, and reference time of one repeat [s]."""


def posing_and_skinning() -> Measurement:
    """Return the work of posing 100 walkers and deforming their skins at the lowest level of detail.

    >>> posing_and_skinning().reference
    10000.0
    """
    from crowdbot import humans

    work = humans.posing_and_skinning(PEOPLE, level=2)
    words = f"{PEOPLE} people in {1000 * ALLOWED:.0f} ms"
    return Measurement("people/s", PEOPLE * OFTEN, lambda: [work() for _ in range(OFTEN)], words, PEOPLE / ALLOWED)


def rays_of_skins(level: int) -> Measurement:
    """Compare scans of 16 x 1800 beams at the skins of 50 people with tests of their triangles one by one.

    A scan takes the vertices of another instant each time, so that the boxes of the tree have to follow.

    >>> rays_of_skins(2).unit
    'scans/s'
    """
    from crowdbot.sensors import Lidar3D, triangles_one_by_one

    lidar, pose, scenes = Lidar3D(columns=1800, skins=True), SpatialPose.of((5.0, 5.0, 1.0), yaw=0.3), _dressed(level)
    words = f"their triangles one by one in one thread, 50 people at level of detail {level}"
    return Measurement(
        "scans/s", 4 * len(scenes), lambda: [lidar.read(scene, pose) for scene in 4 * scenes], words,
        other=triangles_one_by_one(lidar, scenes[0], pose), other_amount=1.0,
    )  # fmt: skip


def _dressed(level: int, people: int = 50) -> list[Scene]:
    """Return five instants of walking people at 0.5 per square metre in a room, as skins."""
    from crowdbot.humans import Gait, People

    random = stream(0, "skins")
    side = math.sqrt(people / 0.5)
    place, heading = random.uniform(0.0, side, (people, 2)), random.uniform(-math.pi, math.pi, people)
    who = People.sample(people, random)
    gait, worn = Gait(who, 0), who.clothing_mask(level)
    velocity = 1.3 * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    state, scenes, owner = gait.start(place, heading, velocity), [], np.repeat(np.arange(people), worn.sum(axis=1))
    room, first = [[(-2, -2), (-2, side + 2), (side + 2, side + 2), (side + 2, -2)]], None
    for _ in range(5):
        points = gait.skin(state, level=level)
        if first is None:
            faces = np.concatenate([who.faces(level)[own] + k * points.shape[1] for k, own in enumerate(worn)])
            first = Skins.of(points.reshape(1, -1, 3), faces, owner)
        skins = Skins(points.reshape(1, -1, 3), first.faces, first.owner, first.part)
        scenes.append(Scene.of(place, walls=room, bodies=Bodies.of(skins=skins)))
        place = place + 0.1 * velocity
        state = gait.step(state, place, velocity, heading, 0.1)
    return scenes
