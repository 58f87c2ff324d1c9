"""Cameras of a trial, for images and videos."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from crowdbot import world
from crowdbot.core import InputError
from crowdbot.core.fields import NAME, attribute, check
from crowdbot.sensors import RENDERERS, SAMPLE_COUNTS

if TYPE_CHECKING:
    from crowdbot.trials.stage import Stage


OVERVIEW = "overview"
"""Name of the automatic camera that shows the whole stage; a camera of the trial with this name replaces it."""
VIEWS, PITCHES = (60, 40, 25), range(60, 90, 4)
"""Horizontal fields of view and pitch angles [degrees] of that camera, in order of preference."""
FARTHEST = 150.0
"""Largest height [m] of that camera with a narrow field of view."""
ENOUGH = 0.04
"""Share of the floor that walls may hide in addition to the minimum."""


@dataclass(frozen=True, kw_only=True)
class Camera:
    """A camera in the world, on a robot, or on a link of a robot. It looks along the x axis of its frame.

    >>> Camera(name="door", x=1, y=2, heading=1.57).z
    1.6
    """

    name: str = attribute(about="name of the camera", pattern=NAME)
    x: float = attribute(0.0, about="x in the world, or forward of the robot's centre", unit="m")
    y: float = attribute(0.0, about="y in the world, or left of the robot's centre", unit="m")
    z: float = attribute(1.6, about="height above the floor, or above the link", unit="m")
    heading: float = attribute(0.0, about="viewing direction, counter-clockwise", unit="rad")
    pitch: float = attribute(0.0, about="pitch, positive downwards", unit="rad", min=-math.pi / 2, max=math.pi / 2)
    width: int = attribute(640, about="image width in pixels", min=16, max=1920)
    height: int = attribute(480, about="image height in pixels", min=16, max=1200)
    field_of_view: float = attribute(
        math.radians(70.0), about="horizontal field of view", unit="rad", min=0.01, max=math.radians(170.0)
    )
    detail: int = attribute(1, about="level of detail of people, 0 is the finest", min=0, max=2)
    shadows: bool = attribute(True, about="whether lights cast shadows")
    renderer: str = attribute("software", about="textures and smooth edges, or plain colours", choices=RENDERERS)
    antialiasing: int = attribute(4, about="samples per pixel of the renderer software: 1, 2, 4 or 8", min=1, max=8)
    robot: str = attribute("", about="name of the robot that the camera is mounted on")
    link: str = attribute("", about="link of that robot (default: the robot frame)")

    def __post_init__(self) -> None:
        check(self)
        if self.antialiasing not in SAMPLE_COUNTS:
            raise InputError(f"antialiasing={self.antialiasing} must be one of {', '.join(map(str, SAMPLE_COUNTS))}")

    def view(self, agent: int | None) -> world.SceneCamera:
        """Return the camera of a renderer; ``agent`` is the index of the robot that carries it."""
        flat = math.cos(self.pitch)
        ahead = (flat * math.cos(self.heading), flat * math.sin(self.heading), -math.sin(self.pitch))
        place = (self.x, self.y, self.z)
        return world.SceneCamera(
            place,
            (place[0] + ahead[0], place[1] + ahead[1], place[2] + ahead[2]),
            width=self.width,
            height=self.height,
            view=2.0 * math.atan(math.tan(0.5 * self.field_of_view) * self.height / self.width),
            robot=agent,
            link=self.link,
            detail=self.detail,
            shadows=self.shadows,
            renderer=self.renderer,
            antialiasing=self.antialiasing if self.renderer == "software" else 1,
        )


def overview(stage: Stage, places: np.ndarray) -> Camera:
    """Return a camera that shows a whole stage and all ``places`` ``[N, 2]`` [m], seen from the south and above.

    The default pitch is 60 degrees. If walls hide too much of the floor, the pitch is steeper and the camera is farther
    away with a narrower field of view.

    >>> from crowdbot.trials import load_trial
    >>> stage = load_trial("frontal").stage
    >>> round(math.degrees(overview(stage, np.zeros((0, 2))).pitch))
    88
    """
    points = (
        np.concatenate([*stage.rings, places.reshape(-1, 2)]) if len(stage.rings) or len(places) else np.zeros((1, 2))
    )
    low, high = points.min(axis=0), points.max(axis=0)
    low, high = np.minimum(low, 0.5 * (low + high) - 2.0), np.maximum(high, 0.5 * (low + high) + 2.0)
    every = [
        _overview_camera(low, high, stage.wall_height, *np.radians(way)) for way in itertools.product(VIEWS, PITCHES)
    ]
    found = [item for k, item in enumerate(every) if k < len(PITCHES) or item.z < FARTHEST]
    floor, eyes = floor_points(stage, low, high), np.array([(one.x, one.y, one.z) for one in found])
    hidden = hidden_floor(stage, floor, eyes).sum(axis=1) / max(1, len(floor))
    return found[int(np.argmax(hidden <= hidden.min() + ENOUGH))]


def _overview_camera(low: np.ndarray, high: np.ndarray, height: float, view: float, pitch: float) -> Camera:
    """Return the nearest camera with this field of view and pitch that shows the whole box ``low`` to ``high`` [m]."""
    wide, tall = 960, 600
    forward, up = (0.0, math.cos(pitch), -math.sin(pitch)), (0.0, math.sin(pitch), math.cos(pitch))
    edges = math.tan(0.5 * view), math.tan(0.5 * view) * tall / wide
    corners = np.array(list(itertools.product((low[0], high[0]), (low[1], high[1]), (0.0, height))))
    ground = np.linspace(low[1], high[1], 41)[:, None]  # candidate points where the axis meets the floor
    off = corners - np.stack([np.broadcast_to(0.5 * (low[0] + high[0]), ground.shape), ground, 0.0 * ground], axis=-1)
    tallest = (np.abs(off @ up) / edges[1] - off @ forward).max(axis=-1)
    k = int(tallest.argmin())  # centres the box between the upper and the lower edge of the image
    away = 1.05 * max(tallest[k], (np.abs(off[k, :, 0]) / edges[0] - off[k] @ forward).max())
    place = corners[0] - off[k, 0] - away * np.array(forward)
    return Camera(
        name=OVERVIEW, x=float(place[0]), y=float(place[1]), z=float(place[2]), heading=math.pi / 2, pitch=float(pitch),
        width=wide, height=tall, field_of_view=float(view),
    )  # fmt: skip


GRID = 24
"""Number of rows and columns of floor points over a stage."""
NEAREST_WALL = 0.25
"""Least distance [m] of a floor point to a wall."""


def floor_points(stage: Stage, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points ``[N, 2]`` [m] of a grid from ``low`` to ``high`` ``[2]`` where people can walk.

    >>> from crowdbot.trials import load_trial
    >>> stage = load_trial("bottleneck").stage
    >>> len(floor_points(stage, np.array([-1.0, -1.0]), np.array([1.0, 1.0])))
    504
    """
    sides = [low[k] + (np.arange(GRID) + 0.5) / GRID * (high[k] - low[k]) for k in (0, 1)]
    floor = np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 2)
    return np.asarray(floor[stage.clearance(floor) > NEAREST_WALL])


def hidden_floor(stage: Stage, floor: NDArray[np.float64], eyes: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return ``[E, N]`` whether walls hide floor points ``[N, 2]`` from ``eyes`` ``[E, 3]`` [m].

    >>> from crowdbot.trials import load_trial
    >>> stage = load_trial("bottleneck").stage
    >>> hidden_floor(stage, np.array([[2.0, 0.0], [2.0, 3.0]]), np.array([[-2.0, 0.0, 1.6]]))
    array([[False,  True]])
    """
    import shapely

    result = np.zeros((len(eyes), len(floor)), dtype=np.bool_)
    walls = stage.as_walls(props=False).segments()
    if not len(floor) or not len(walls):
        return result
    tree = shapely.STRtree(shapely.linestrings(walls.reshape(-1, 2, 2)))
    for row, eye in zip(result, eyes, strict=True):  # only the last part of a ray to the floor is below the tops
        share = 1.0 if eye[2] <= 0.0 else min(1.0, stage.wall_height / eye[2])
        below = floor + (eye[:2] - floor) * share
        rays = shapely.linestrings(np.stack([floor, below], axis=1))
        row[np.unique(tree.query(rays, predicate="intersects")[0])] = True
    return result
