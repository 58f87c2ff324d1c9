"""People with limbs, props and walls at random, and the slow, obvious ways to meet them with rays."""

import math
from dataclasses import replace

import numpy as np

from crowdbot.core import Bodies, Scene, SpatialPose, product, stream

ROOM = [(-6.0, -5.0), (-6.0, 5.0), (6.0, 5.0), (6.0, -5.0)]
PARTS = ("head", "torso", "arm", "leg")


def limbs(place, rng, count=8):
    """Capsules ``[E, A * count]`` around the places ``[E, A, 2]`` of people."""
    E, A = place.shape[:2]
    low = np.concatenate(
        [place[:, :, None] + rng.uniform(-0.2, 0.2, (E, A, count, 2)), rng.uniform(0.1, 1.5, (E, A, count, 1))], axis=-1
    )
    way = rng.normal(size=low.shape)
    end = low + way / np.linalg.norm(way, axis=-1, keepdims=True) * rng.uniform(0.0, 0.5, (E, A, count, 1))
    radius = rng.uniform(0.03, 0.15, (E, A, count))
    return low.reshape(E, -1, 3), end.reshape(E, -1, 3), radius.reshape(E, -1)


def crowd(seed, people=10, environments=1, spread=5.0, props=True, embodied=None):
    """People, the last of them without limbs, in a room with a low box and a post."""
    rng = stream(seed, "crowd")
    place = rng.uniform(-spread, spread, (environments, people, 2))
    embodied = people - 2 if embodied is None else embodied
    start, end, radius = limbs(place[:, :embodied], rng)
    owner = np.repeat(np.arange(embodied), start.shape[1] // max(1, embodied))
    shapes = {"start": start, "end": end, "radius": radius, "owner": owner, "part": np.arange(len(owner)) % 4}
    if props:
        turn = rng.normal(size=(environments, 2, 4))
        shapes |= {
            "box_centre": rng.uniform(-4.0, 4.0, (environments, 2, 3)),
            "box_half": rng.uniform(0.1, 0.6, (environments, 2, 3)),
            "box_turn": turn / np.linalg.norm(turn, axis=-1, keepdims=True),
            "post_foot": np.concatenate([rng.uniform(-4, 4, (environments, 2, 2)), np.zeros((environments, 2, 1))], -1),
            "post_radius": rng.uniform(0.05, 0.3, (environments, 2)),
            "post_height": rng.uniform(0.5, 2.5, (environments, 2)),
        }
    return Scene.of(
        place,
        radius=rng.uniform(0.15, 0.4, (environments, people)),
        height=rng.uniform(0.5, 1.9, (environments, people)),
        walls=[ROOM, [(1.0, -3.0), (2.5, 1.0)]],
        wall_height=2.0,
        active=rng.random((environments, people)) < 0.85,
        bodies=Bodies.of(parts=PARTS, **shapes),
    )


def somewhere(seed, environments=1, height=(0.2, 1.5)):
    rng = stream(seed, "pose")
    place = np.column_stack([rng.uniform(-3.0, 3.0, (environments, 2)), rng.uniform(*height, environments)])
    return SpatialPose.of(place, *(rng.uniform(-math.pi, math.pi, (3, environments))))


def carried_away(scene, pose, angle, shift):
    """The whole world, walls and sensor too, turned about the origin and then shifted."""
    cos, sin = math.cos(angle), math.sin(angle)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])

    def carried(points):
        size = points.shape[-1]
        return points @ turn.T[:size, :size] + np.append(shift, 0.0)[:size]

    def turned(rotation):
        return product(np.broadcast_to(SpatialPose.of((0, 0, 0), yaw=angle).rotation, rotation.shape), rotation)

    b = scene.bodies
    bodies = replace(
        b,
        start=carried(b.start),
        end=carried(b.end),
        box_centre=carried(b.box_centre),
        box_turn=turned(b.box_turn),
        post_foot=carried(b.post_foot),
    )
    moved = Scene.of(
        carried(scene.position),
        scene.velocity @ turn.T[:2, :2],
        heading=scene.heading + angle,
        radius=scene.radius,
        height=scene.height,
        active=scene.active,
        walls=[carried(wall.reshape(2, 2)) for wall in scene.walls.segments()],
        wall_height=scene.wall_height,
        bodies=bodies,
        time=scene.time,
    )
    return moved, SpatialPose(carried(pose.position), turned(pose.rotation))


def _smallest(*times):
    return min((t for t in times if t >= 0.0), default=math.inf)


def _roots(a, b, c):
    if a == 0.0 or b * b - 4 * a * c < 0.0:
        return ()
    root = math.sqrt(b * b - 4 * a * c)
    return (-b - root) / (2 * a), (-b + root) / (2 * a)


def meet_capsule(o, d, a, b, r):
    """Quadratics against the side and both ends; 0 from inside."""
    axis = b - a
    length = np.linalg.norm(axis)
    u = axis / length if length > 0 else np.array([0.0, 0.0, 1.0])
    near = a + np.clip((o - a) @ u, 0.0, length) * u
    if np.linalg.norm(o - near) <= r:
        return 0.0
    w = o - a
    n, m = d - (d @ u) * u, w - (w @ u) * u
    side = [t for t in _roots(n @ n, 2 * n @ m, m @ m - r * r) if 0 <= (w + t * d) @ u <= length]
    balls = [t for c in (a, b) for t in _roots(1.0, 2 * d @ (o - c), (o - c) @ (o - c) - r * r)]
    return _smallest(*side, *balls)


def meet_post(o, d, foot, r, h):
    w = o - foot
    if math.hypot(w[0], w[1]) <= r and 0 <= w[2] <= h:
        return 0.0
    side = [
        t
        for t in _roots(d[0] ** 2 + d[1] ** 2, 2 * (d[0] * w[0] + d[1] * w[1]), w[0] ** 2 + w[1] ** 2 - r * r)
        if 0 <= w[2] + t * d[2] <= h
    ]
    lids = [(z - w[2]) / d[2] for z in (0.0, h) if d[2] != 0.0]
    lids = [t for t in lids if math.hypot(w[0] + t * d[0], w[1] + t * d[1]) <= r]
    return _smallest(*side, *lids)


def meet_box(o, d, centre, half, turn):
    q = SpatialPose(centre[None], turn[None]).matrix[0]
    p, v = q.T @ (o - centre), q.T @ d
    if np.all(np.abs(p) <= half):
        return 0.0
    times = []
    for k in range(3):
        for side in (-1.0, 1.0):
            if v[k] != 0.0:
                t = (side * half[k] - p[k]) / v[k]
                x = p + t * v
                if t >= 0 and all(abs(x[j]) <= half[j] for j in range(3) if j != k):
                    times.append(t)
    return _smallest(*times)


def meet_wall(o, d, wall, height):
    a, e = wall[:2], wall[2:] - wall[:2]
    cross = d[0] * e[1] - d[1] * e[0]
    if cross == 0.0:
        return math.inf
    r = a - o[:2]
    t, s = (r[0] * e[1] - r[1] * e[0]) / cross, (r[0] * d[1] - r[1] * d[0]) / cross
    return t if t >= 0 and 0 <= s <= 1 and 0 <= o[2] + t * d[2] <= height else math.inf


def meet_triangles(o, d, corners):
    """Return how far along the beam each triangle ``[F, 3, 3]`` is met, infinite where it is not."""
    a, b, c = np.moveaxis(corners - o, 1, 0)
    n = np.cross(b - a, c - a)
    signs = np.array([np.cross(p, q) @ d for p, q in ((b, c), (c, a), (a, b))])
    inside = np.all(signs >= 0, axis=0) | np.all(signs <= 0, axis=0)
    way = n @ d
    t = np.divide(np.sum(a * n, axis=1), way, out=np.full(len(corners), math.inf), where=way != 0.0)
    return np.where(inside & (t >= 0), t, math.inf)


def brute_force(scene, pose, directions, skins=False):
    """Return distance ``[E, R]`` and who was hit: every beam against everything."""
    E, A = scene.shape
    distance, hit = np.full((E, len(directions)), math.inf), np.full((E, len(directions)), -1)
    bodies = scene.bodies or Bodies.of()
    skin = set(bodies.skins.owner.tolist()) if skins else set()
    own = {*bodies.owner.tolist(), *bodies.box_owner.tolist(), *bodies.post_owner.tolist(), *skin}
    for e in range(E):
        o = pose.position[e]
        there = [*scene.active[e].tolist()]

        def here(owner, there=there):
            return owner < 0 or there[owner]

        for k, d in enumerate(directions @ pose.matrix[e].T):
            met = [(-o[2] / d[2] if d[2] < 0 < o[2] else math.inf, -3)]
            for b, owner in enumerate(bodies.owner):
                if here(owner) and owner not in skin:
                    met.append((meet_capsule(o, d, bodies.start[e, b], bodies.end[e, b], bodies.radius[e, b]), owner))
            for b, owner in enumerate(bodies.box_owner):
                if here(owner):
                    found = meet_box(o, d, bodies.box_centre[e, b], bodies.box_half[e, b], bodies.box_turn[e, b])
                    met.append((found, owner))
            for b, owner in enumerate(bodies.post_owner):
                if here(owner):
                    found = meet_post(o, d, bodies.post_foot[e, b], bodies.post_radius[e, b], bodies.post_height[e, b])
                    met.append((found, owner))
            for a in range(A):
                if there[a] and a not in own:
                    tall = 1.7 if scene.height is None else scene.height[e, a]
                    met.append((meet_post(o, d, np.append(scene.position[e, a], 0.0), scene.radius[e, a], tall), a))
            met += [(meet_wall(o, d, wall, scene.wall_height), -2) for wall in scene.walls.segments()]
            if skins:
                times = meet_triangles(o, d, bodies.skins.vertices[e, bodies.skins.faces])
                met += [(t, owner) for t, owner in zip(times, bodies.skins.owner, strict=True) if here(owner)]
            best = min(met, key=lambda pair: pair[0])
            if best[0] < math.inf:
                distance[e, k], hit[e, k] = best[0], -4 if best[1] == -1 else best[1]
    return distance, hit
