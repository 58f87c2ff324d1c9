"""Simple shapes of people, robots and props for range sensors, in any world."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import STAGE, Bodies, Element, InputError, Scene, Skins
from crowdbot.typing import Floats, Ints
from crowdbot.world.ground.ground import Ground
from crowdbot.world.ground.surfaces import ground_boxes
from crowdbot.world.rendering.carried_objects import carried_solids, has_things
from crowdbot.world.robots.robot import Robot
from crowdbot.world.urdf import Box, Capsule, Cylinder, Mesh, Sphere
from crowdbot.world.urdf.transforms import axis_rotation, frame, quaternion

from .people_motion import PeopleMotion
from .rider import RIDER
from .stage import PhysicsStage, PropBody

Frames = Mapping[str, Floats]
UPRIGHT = math.cos(math.radians(5.0))
"""Cylinders tilted by less than this are upright."""
SLICES = 12
"""Number of discs that approximate an ellipsoid."""


class _Rows(NamedTuple):
    """Shapes of one kind in the frame of a link: frames ``[N, 4, 4]`` and sizes ``[N, 3]``."""

    links: list[str]
    place: Floats
    size: Floats


def scene_bodies(
    scene: Scene,
    motion: PeopleMotion | None = None,
    robots: Mapping[int, Robot] | None = None,
    stage: PhysicsStage | None = None,
    *,
    joints: Mapping[int, Mapping[str, ArrayLike]] | None = None,
    frames: Mapping[int, Frames] | None = None,
    props: Mapping[int, Floats] | None = None,
    doors: Sequence[float] | Floats | None = None,
    skins: int | None = None,
    only: Ints | None = None,
) -> Bodies:
    """Return the bodies of all people, robots and props in a scene, E = 1, for range sensors.

    People consist of 17 capsules and what they hold, sit on and push, without bags, robots of their colliders, and
    props of their visual shapes. Boxes, spheres, capsules
    and upright cylinders are exact. A tilted cylinder becomes a box of equal width, or a capsule if it is longer than
    wide. A mesh becomes the bounding boxes of its convex pieces, an ellipsoid a stack of discs. An agent that is
    neither in ``motion`` nor in ``robots`` has no body and is a cylinder with its radius. :meth:`Scene.without` removes
    the robot that carries the sensor.

    Args:
        scene: positions and headings of robots, and which agents are active.
        motion: current poses of people.
        robots: robots by agent index.
        stage: stage with props.
        joints: joint positions of robots [rad, m] by agent and name (default: the posture).
        frames: frames ``[4, 4]`` of robot links in the world, by agent and link; they replace ``joints``.
        props: frames ``[4, 4]`` in the world of moved props, by number.
        doors: how far each door of the stage is open, 0 to 1 (default: closed).
        skins: level of detail of people's skins, 0 (finest) to 2, for rays that hit the mesh; None: no skins.
        only: agents that have a skin (default: all people).

    Raises:
        InputError: the scene has several environments.

    >>> scene = Scene.of([[0.0, 0.0], [3.0, 0.0]], external=[True, False])
    >>> found = scene_bodies(scene, PeopleMotion(scene, np.array([1])), {0: Robot.load("turtlebot2")})
    >>> found.start.shape, sorted(set(found.post_owner.tolist()))  # a castor is a sphere, stored as a short capsule
    ((1, 19, 3), [0])
    """
    if scene.shape[0] != 1:
        raise InputError(f"bodies: the scene has {scene.shape[0]} environments; give one: scene.environments([0])")
    found = _Found()
    parts: tuple[str, ...] = ()
    if motion is not None:
        limbs = motion.limbs(scene.active[0])
        parts = limbs.parts
        found.capsules.append((limbs.start[0], limbs.end[0], limbs.radius[0], limbs.owner, limbs.part))
        for agent, kind, place, size in _held_things(scene, motion):
            found.add(kind, place[None], size[None], agent)
    for agent, robot in (robots or {}).items():
        places = (frames or {}).get(agent) or _standing(scene, agent, robot, (joints or {}).get(agent, {}))
        for kind, rows in _rows_of(robot).items():
            if rows.links:
                found.add(kind, np.stack([places[link] for link in rows.links]) @ rows.place, rows.size, agent)
    for number, prop in enumerate(stage.props if stage is not None else ()):
        for kind, place, size in _of_prop(prop, (props or {}).get(number)):
            found.add(kind, place[None], size[None], STAGE)
    if stage is not None and stage.ground is not None:
        found.add("box", *_ground_boxes(stage.ground), STAGE)
    for k, leaf in enumerate(stage.doors if stage is not None else ()):
        middle, half, yaw = leaf.box(0.0 if doors is None else doors[k])
        found.add("box", frame(middle, axis_rotation((0.0, 0.0, 1.0), yaw))[None], half[None], STAGE)
    skin = None if skins is None or motion is None else _skins(scene, motion, skins, only)
    return found.bodies(parts, skin)


class _Found:
    """Collects shapes."""

    def __init__(self) -> None:
        self.capsules: list[tuple[NDArray[Any], ...]] = []
        self.boxes: list[tuple[NDArray[Any], ...]] = []
        self.posts: list[tuple[NDArray[Any], ...]] = []

    def add(self, kind: str, place: Floats, size: Floats, owner: int) -> None:
        """Add shapes of a kind with frames ``[N, 4, 4]`` and sizes ``[N, 3]`` for an agent or the stage."""
        middle, axis = place[:, :3, 3], place[:, :3, 2]
        if kind == "box":
            turn = np.array([quaternion(item[:3, :3]) for item in place])
            self.boxes.append((middle, size, turn, np.full(len(size), owner)))
        elif kind == "capsule":
            reach = axis * size[:, 1:2]
            names = np.full(len(size), owner), np.full(len(size), -1)
            self.capsules.append((middle - reach, middle + reach, size[:, 0], *names))
        elif kind == "cylinder":
            self._cylinders(place, size, owner)
        else:
            self._ellipsoids(middle, size, owner)

    def _cylinders(self, place: Floats, size: Floats, owner: int) -> None:
        radius, half = size[:, 0], size[:, 1]
        upright = np.abs(place[:, 2, 2]) >= UPRIGHT
        flat = ~upright & (half <= radius)
        long = ~upright & ~flat
        if upright.any():
            foot = place[upright, :3, 3] - half[upright, None] * (0.0, 0.0, 1.0)
            names = np.full(int(upright.sum()), owner)
            self.posts.append((foot, radius[upright], 2.0 * half[upright], names))
        if flat.any():
            self.add("box", place[flat], np.stack([radius, radius, half], axis=1)[flat], owner)
        if long.any():
            self.add("capsule", place[long], np.stack([radius, half - radius, half], axis=1)[long], owner)

    def _ellipsoids(self, middle: Floats, size: Floats, owner: int) -> None:
        """Add discs with the mean radius of an upright ellipsoid at their heights."""
        edge = np.linspace(-1.0, 1.0, SLICES + 1)
        low, high = edge[:-1], edge[1:]
        across = np.sqrt(1.0 - (low**2 + low * high + high**2) / 3.0)
        for (x, y, z), (wide, _, tall) in zip(middle.tolist(), size.tolist(), strict=True):
            foot = np.column_stack([np.full(SLICES, x), np.full(SLICES, y), z + tall * low])
            self.posts.append((foot, wide * across, tall * (high - low), np.full(SLICES, owner)))

    def bodies(self, parts: tuple[str, ...], skins: Skins | None) -> Bodies:
        """Return all shapes."""
        named = (
            (self.capsules, ("start", "end", "radius", "owner", "part")),
            (self.boxes, ("box_centre", "box_half", "box_turn", "box_owner")),
            (self.posts, ("post_foot", "post_radius", "post_height", "post_owner")),
        )
        arrays: dict[str, Any] = {}
        for rows, names in named:
            if rows:
                arrays |= {
                    name: np.concatenate(column) for name, column in zip(names, zip(*rows, strict=True), strict=True)
                }
        return Bodies.of(parts=parts, skins=skins, **arrays)


def _standing(scene: Scene, agent: int, robot: Robot, joints: Mapping[str, ArrayLike]) -> Frames:
    """Return the frames of the links of a robot on the floor."""
    x, y = scene.position[0, agent].tolist()
    base = frame((x, y, robot.lift), axis_rotation((0.0, 0.0, 1.0), float(scene.heading[0, agent])))
    poses = robot.posture_poses if not joints else robot.model.poses({**robot.posture, **joints})
    return {link: base @ pose for link, pose in poses.items()}


def _held_things(scene: Scene, motion: PeopleMotion) -> list[tuple[int, str, Floats, Floats]]:
    """Return owner, kind, frame ``[4, 4]`` and sizes of what people hold and push."""
    busy = [k for k, agent in enumerate(motion.agents) if scene.active[0, agent] and has_things(motion.state.blend, k)]
    if not busy:
        return []
    posture, found = motion.posture(), []
    for k in busy:
        solids = carried_solids(motion.people, posture, motion.state.yaw, motion.state.blend, k, k < len(motion.afoot))
        found += [(int(motion.agents[k]), kind, frame(place, turn), size) for kind, turn, place, size in solids]
    return found


@functools.lru_cache(maxsize=16)
def _ground_boxes(ground: Ground) -> tuple[Floats, Floats]:
    return ground_boxes(ground)


@functools.lru_cache(maxsize=64)
def _rows_of(robot: Robot) -> dict[str, _Rows]:
    """Return the colliders of a robot by kind, in the frames of their links."""
    found: dict[str, list[tuple[str, Floats, tuple[float, float, float]]]] = {"box": [], "capsule": [], "cylinder": []}
    for name, link in robot.model.links.items():
        for part in link.collisions if not name.startswith(RIDER) else ():  # riders are among the people
            shape = part.shape
            if isinstance(shape, Box):
                found["box"].append((name, part.origin, tuple(0.5 * side for side in shape.size)))  # type: ignore[arg-type]
            elif isinstance(shape, Sphere):
                found["capsule"].append((name, part.origin, (shape.radius, 0.0, 0.0)))
            elif isinstance(shape, Mesh):
                for points in [piece.vertices for piece in shape.pieces] or [shape.vertices]:
                    low, high = points.min(axis=0), points.max(axis=0)
                    x, y, z = (0.5 * (high - low)).tolist()
                    found["box"].append((name, part.origin @ frame(0.5 * (low + high)), (x, y, z)))
            else:
                kind = "capsule" if isinstance(shape, Capsule) else "cylinder"
                assert isinstance(shape, Capsule | Cylinder)
                found[kind].append((name, part.origin, (shape.radius, 0.5 * shape.length, 0.0)))
    return {
        kind: _Rows([row[0] for row in rows], np.array([row[1] for row in rows]), np.array([row[2] for row in rows]))
        for kind, rows in found.items()
    }


def _of_prop(prop: PropBody, moved: Floats | None) -> list[tuple[str, Floats, Floats]]:
    """Return kind, frame and size of the shapes of a prop, from its MJCF body."""
    body = prop.body("prop")
    place = moved
    if place is None:
        place = frame(_numbers(body, "pos"), axis_rotation((0.0, 0.0, 1.0), prop.heading))
    result = []
    for geom in body.each("geom"):
        size = _numbers(geom, "size")
        size = np.concatenate([size, np.zeros(3 - len(size))])
        kind = geom.attributes.get("type", "sphere")
        kind = "capsule" if kind == "sphere" else kind
        if kind not in ("box", "capsule", "cylinder", "ellipsoid"):
            raise InputError(
                f"bodies: {type(prop).__name__} has a shape of type {kind!r}, which ray casting does not support"
            )
        result.append((kind, place @ frame(_numbers(geom, "pos")), size))
    return result


def _numbers(element: Element, key: str) -> Floats:
    return np.array([float(word) for word in element.attributes.get(key, "0 0 0").split()])


def _skins(scene: Scene, motion: PeopleMotion, level: int, only: Ints | None) -> Skins:
    """Return the skins of all people present, or of some agents, without hidden parts."""
    numbers = np.arange(len(motion.agents)) if only is None else np.flatnonzero(np.isin(motion.agents, only))
    agents = motion.agents[numbers]
    points = motion.skin(level, numbers)
    points[~scene.active[0, agents]] = np.nan
    worn, faces = motion.people.clothing_mask(level)[numbers], motion.people.faces(level)
    count = points.shape[1]
    rows = [faces[own] + k * count for k, own in enumerate(worn)]
    owner = np.repeat(agents, worn.sum(axis=1))
    return Skins.of(points.reshape(1, -1, 3), np.concatenate(rows) if rows else np.zeros((0, 3)), owner)
