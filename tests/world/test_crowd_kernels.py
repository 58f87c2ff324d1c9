"""Kernels of the crowd and of drives give the bits of the formulas in NumPy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from crowdbot.core import Pose, Scene, stream
from crowdbot.core.neighbors import nearest
from crowdbot.world import (
    CrowdLimits,
    Direction,
    JourneyAssignment,
    Omnidirectional,
    Point,
    Router,
    Twists,
    VelocityServo,
    WaypointSequence,
    Zone,
)
from crowdbot.world.crowd.contact import find_close_bodies
from crowdbot.world.crowd.waypoint import PersonRandom
from crowdbot.world.planar_phases import leave_at_goals, leave_in_zone


def _inside(ring: Any, place: Any) -> Any:
    x, y = place[:, 0], place[:, 1]
    inside = np.zeros(len(place), dtype=np.bool_)
    for (ax, ay), (bx, by) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        if ay != by:
            inside ^= ((ay > y) != (by > y)) & (x < ax + (bx - ax) * ((y - ay) / (by - ay)))
    return inside


def _on_border(ring: Any, place: Any) -> Any:
    x, y = place[:, 0], place[:, 1]
    best, found = np.full(len(place), np.inf), place.copy()
    for (ax, ay), (bx, by) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        ex, ey = bx - ax, by - ay
        along = np.clip(((x - ax) * ex + (y - ay) * ey) / max(ex * ex + ey * ey, 1e-300), 0.0, 1.0)
        point = np.stack([ax + along * ex, ay + along * ey], axis=-1)
        away = (x - point[:, 0]) ** 2 + (y - point[:, 1]) ** 2
        nearer = away < best
        best, found = np.where(nearer, away, best), np.where(nearer[:, None], point, found)
    return found


@pytest.mark.parametrize("corners", [3, 4, 7])
def test_zones_contain_what_the_even_odd_rule_says(corners: int) -> None:
    rng = stream(corners, "zones")
    for _ in range(10):
        ring = rng.uniform(-5.0, 5.0, (corners, 2))
        zone = Zone(tuple(map(tuple, ring.tolist())))
        share, k = rng.uniform(0.0, 1.0, (500, 1)), rng.integers(0, corners, 500)
        border = ring[k] * (1.0 - share) + ring[(k + 1) % corners] * share
        place = np.vstack([rng.uniform(-6.0, 6.0, (2000, 2)), border, ring])
        inside = _inside(ring, place)
        assert np.array_equal(zone.contains(place), inside)
        luck = PersonRandom(np.zeros(len(place), dtype=np.int64), np.arange(len(place)))
        assert np.array_equal(zone.goal(place, luck), np.where(inside[:, None], place, _on_border(ring, place)))


def _crowd(seed: int, environments: int = 6, agents: int = 30) -> Scene:
    rng = stream(seed, "crowd")
    shape = (environments, agents)
    return Scene.of(
        rng.uniform(-4.0, 4.0, (*shape, 2)),
        rng.normal(size=(*shape, 2)),
        goal=rng.uniform(-4.0, 4.0, (*shape, 2)),
        active=rng.random(shape) < 0.8,
        external=rng.random(shape) < 0.1,
    )


def test_people_leave_at_goals_and_in_zones() -> None:
    scene = _crowd(1)
    zone = Zone(((-1.0, -4.0), (3.0, -2.0), (1.0, 2.0)))
    away = scene.goal - scene.position
    person = scene.active & ~scene.external
    at_goal = person & (away[..., 0] ** 2 + away[..., 1] ** 2 < 4.0)
    inside = person & _inside(zone.ring, scene.position.reshape(-1, 2)).reshape(scene.shape)
    assert at_goal.any()
    assert np.array_equal(leave_at_goals(scene, 2.0).active, scene.active & ~at_goal)
    assert np.array_equal(leave_in_zone(scene, zone).active, scene.active & ~inside)
    assert leave_at_goals(scene, 1e-9) is scene


def test_limits_equal_the_formula() -> None:
    before, dt = _crowd(2), 0.1
    after = before.advance(3.0 * stream(3, "new").normal(size=before.velocity.shape), dt)
    found = CrowdLimits(max_speed=1.5, max_acceleration=8.0).apply(before, after, dt)
    walking = after.active & ~after.external
    velocity = after.velocity
    for start, most in ((np.where(walking[..., None], before.velocity, 0.0), 8.0 * dt), (0.0, 1.5)):
        change = velocity - start
        length = np.sqrt(change[..., 0] ** 2 + change[..., 1] ** 2)
        short = start + change * (most / np.maximum(length, 1e-300))[..., None]
        velocity = np.where((length > most)[..., None], short, velocity)
    cut = (walking & np.any(velocity != after.velocity, axis=-1))[..., None]
    assert cut.any()
    assert np.array_equal(found.velocity, np.where(cut, velocity, after.velocity))
    assert np.array_equal(found.position, np.where(cut, before.position + velocity * dt, after.position))
    assert CrowdLimits(max_speed=1e6).apply(before, after, dt) is after


def test_drives_equal_the_formulas() -> None:
    rng, dt, count = stream(4, "drives"), 0.05, 200
    now, wanted = (Twists(*rng.normal(size=(3, count)) * 1.5) for _ in range(2))
    pose = Pose(rng.normal(size=(count, 2)), rng.uniform(-3.0, 3.0, count))
    _, twist = Omnidirectional().step(pose, now, wanted, dt)
    share = np.minimum(1.0, 1.0 / np.maximum(np.sqrt(wanted.forward**2 + wanted.left**2), 1e-300))
    x, y = wanted.forward * share - now.forward, wanted.left * share - now.left
    share = np.minimum(1.0, dt / np.maximum(np.sqrt(x * x + y * y), 1e-300))
    assert np.array_equal(twist.forward, now.forward + x * share)
    assert np.array_equal(twist.left, now.left + y * share)
    turn = np.clip(np.clip(wanted.turn, -1.5, 1.5), now.turn - 3.0 * dt, now.turn + 3.0 * dt)
    assert np.array_equal(twist.turn, turn)
    _, twist = VelocityServo(sideways=True).step(pose, now, wanted, dt)
    share = np.minimum(1.0, 1.0 / np.maximum(np.hypot(wanted.forward, wanted.left), 1e-300))
    gain = -math.expm1(-dt / 0.1)
    x, y = (wanted.forward * share - now.forward) * gain, (wanted.left * share - now.left) * gain
    share = np.minimum(1.0, dt / np.maximum(np.hypot(x, y), 1e-300))
    assert np.array_equal(twist.forward, now.forward + x * share)
    assert np.array_equal(twist.left, now.left + y * share)


class _Own(Point):
    """A waypoint that no kernel knows."""


def test_journeys_in_kernels_equal_journeys_group_by_group() -> None:
    zone = Zone(((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)))
    hall = Zone(((-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)), aim="random")
    paths = (
        WaypointSequence((zone, hall, Point(2.0, 2.0, 1.0))),
        WaypointSequence((Point(-1.0, 0.0, 2.0), Direction(0.4)), then="stay"),
        WaypointSequence((Point(1.0, 1.0, 1.5), zone), then="again"),
    )
    scene = _crowd(5)
    seeds, ids = np.arange(6), np.tile(np.arange(30), (6, 1))
    which = stream(6, "which").integers(-1, 3, (6, 30))
    journeys = JourneyAssignment(paths, which)
    other = JourneyAssignment((*paths, WaypointSequence((_Own(0.0, 0.0),))), which)
    one = two = journeys.start(scene, seeds, ids)
    for k in range(12):
        place = stream(k, "steps").uniform(-4.0, 4.0, scene.position.shape)
        one = journeys.advance(one.replace(position=place), seeds, ids)
        two = other.advance(two.replace(position=place), seeds, ids)
        for name in ("active", "goal"):
            assert np.array_equal(getattr(one, name), getattr(two, name)), (k, name)
        assert np.array_equal(one.memory["stop"], two.memory["stop"])
        assert np.array_equal(journeys.uses_routing(one), other.uses_routing(two))
    assert np.max(one.memory["stop"]) > 2.0


def test_paths_have_the_length_of_their_legs() -> None:
    router = Router.of([[(2.0, -3.0), (2.0, 1.0)]], radius=0.25)
    place = stream(7, "paths").uniform(-3.0, 1.0, (40, 30, 2))
    goal = np.array([4.0, 0.0]) + np.zeros_like(place)
    ways = router.follow(place, goal)
    alone = [router.follow(place[e : e + 1], goal[e : e + 1]) for e in range(40)]
    assert np.array_equal(ways.length, np.concatenate([item.length for item in alone]))
    assert np.array_equal(ways.subgoal, np.concatenate([item.subgoal for item in alone]))
    straight = np.all(ways.subgoal == goal, axis=-1)
    away = np.hypot(*np.moveaxis(goal - place, -1, 0))
    assert np.array_equal(ways.length[straight], away[straight])
    assert np.all(ways.length[~straight] > away[~straight])


@pytest.mark.parametrize(("agents", "reach"), [(40, 0.6), (40, 30.0), (200, 0.8), (1, 1.0)])
def test_close_bodies_are_the_nearest_neighbors(agents: int, reach: float) -> None:
    rng = stream(agents, "close")
    place = rng.uniform(-4.0, 4.0, (12, agents, 2)).round(1)
    place[:, ::7] = np.nan
    reaches = rng.uniform(0.5 * reach, reach, (12, agents))
    seen, asking = rng.random((12, agents)) < 0.8, rng.random((12, agents)) < 0.8
    close_bodies = find_close_bodies(place, reaches, 24, seen, asking)
    right = nearest(place, reaches, 24, seen, asking)
    assert np.array_equal(close_bodies.number, right.number)
    for e, a in np.ndindex(12, agents):
        count = int(right.number[e, a])
        assert np.array_equal(close_bodies.agent[e, a, :count], right.agent[e, a, :count])
