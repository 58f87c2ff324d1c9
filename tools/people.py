"""Draw people: ``python tools/people.py FILE.png``, ten in mid-stride above and every activity below."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from crowdbot.humans import ACTIVITIES, Gait, People

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WALKERS = (
    "man-20", "woman-20", "man-32", "woman-36", "man-55", "woman-60", "boy-08", "girl-13", "mannequin", "woman-28",
)  # fmt: skip
BUSY = ("woman-36", "man-44", "woman-20", "man-27", "girl-09", "man-66")
APART, SPEED, DT = 0.9, 1.3, 0.02
AZIMUTH, ELEVATION = 0.5, 0.12


def draw(path: str) -> None:
    """Write the picture."""
    figure = Figure(figsize=(16, 11), layout="constrained")
    above, below = figure.subplots(2, 1)
    _crowd(above, WALKERS, SPEED, ["walk"] * len(WALKERS))
    _crowd(below, BUSY, 0.0, list(ACTIVITIES))
    figure.savefig(path, dpi=100)


def _crowd(axes: Axes, names: tuple[str, ...], speed: float, activities: list[str]) -> None:
    people = People.of(list(names), variation=np.where(np.array(names) == "mannequin", 0, np.arange(len(names))))
    gait = Gait(people, seed=3)
    place = np.stack([np.zeros(len(names)), APART * np.arange(len(names))], axis=1)
    velocity = np.tile([speed, 0.0], (len(names), 1))
    state = gait.start(place, np.zeros(len(names)), velocity, activities)
    for _ in range(50):
        place = place + velocity * DT
        state = gait.step(state, place, velocity, np.zeros(len(names)), DT)
    skin, faces, worn, colors = gait.skin(state, 0), people.faces(0), people.worn(0), people.face_colors(0)
    rows = range(len(names))
    _mesh(
        axes,
        np.concatenate([skin[i][faces[worn[i]]] for i in rows]),
        np.concatenate([colors[i][worn[i]] for i in rows]),
    )


def _mesh(axes: Axes, triangles: np.ndarray, colors: np.ndarray) -> None:
    """Triangles ``[M, 3, 3]`` from behind to the front, shaded by one light."""
    to_eye = np.array([np.cos(AZIMUTH) * np.cos(ELEVATION), np.sin(AZIMUTH) * np.cos(ELEVATION), np.sin(ELEVATION)])
    right = np.array([-np.sin(AZIMUTH), np.cos(AZIMUTH), 0.0])
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    light = to_eye + 0.5 * np.cross(to_eye, right) - 0.4 * right
    shade = 0.45 + 0.5 * np.clip(normal @ (light / np.linalg.norm(light)), 0.0, 1.0)
    order = np.argsort(triangles.mean(axis=1) @ to_eye)
    order = order[(normal @ to_eye)[order] > 0.0]
    flat = np.stack([triangles @ right, triangles @ np.cross(to_eye, right)], axis=-1)[order]
    painted = np.clip(colors * shade[:, None], 0.0, 1.0)[order]
    axes.add_collection(PolyCollection(flat, facecolors=painted, edgecolors=painted, linewidths=0.4))
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.axis("off")


if __name__ == "__main__":
    draw(sys.argv[1])
