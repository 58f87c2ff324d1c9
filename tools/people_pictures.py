"""Draw people for the gallery: ``python tools/people_pictures.py docs/gallery/people [NAME...]``."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
from PIL import Image

from crowdbot.core import Scene
from crowdbot.humans import ACTIVITIES, People
from crowdbot.world import Appearance, PeopleMotion, PhysicsStage, Renderer, Robot, SceneCamera

WALKERS = (
    "man-20", "woman-20", "man-32", "woman-36", "man-55", "woman-60", "man-44", "woman-28", "man-66", "woman-41",
)  # fmt: skip
YOUNG = ("boy-08", "girl-09", "boy-12", "girl-13", "mannequin", "mannequin")
BUSY = (
    "man-32", "woman-36", "man-44", "woman-20", "man-60", "woman-66", "man-27", "woman-41", "man-38", "woman-60",
    "woman-28", "man-55", "man-20", "woman-24", "woman-32", "man-50",
)  # fmt: skip
FACES = ("man-20", "woman-20", "man-38", "woman-36", "man-66", "woman-60", "boy-08", "girl-13")
SPEEDS = {"walk": 1.2, "stick": 0.8, "pram": 1.1, "wheelchair": 1.0, "run": 3.0}
PLACES = (("wood", "panels", "clear"), ("grass", "brick", "cloudy"), ("asphalt", "concrete", "overcast"),
          ("paving", "plaster", "dusk"))  # fmt: skip
DT, STEPS = 0.02, 50
Image3 = np.ndarray


def main() -> None:
    """Write the pictures, or those with the names given."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    pictures = {
        "walking": lambda: row(WALKERS, ["walk"] * 10, 1.3, size=(1280, 400)),
        "young": lambda: row(YOUNG, ["walk"] * 6, 1.1, (0, 1, 2, 3, 0, 4), size=(960, 400)),
        "busy": busy,
        "faces": faces,
        "places": places,
        "variations": lambda: row(("woman-36",) * 10, ["walk"] * 10, 0.0, size=(1280, 400)),
        "wheelchair": wheelchairs,
        **{f"level-{k}": (lambda k=k: row(("woman-24", "man-38"), ["walk"] * 2, 1.2, detail=k)) for k in range(3)},
    }
    for name in sys.argv[2:] or pictures:
        Image.fromarray(pictures[name]()).save(folder / f"{name}.png")


def moved(names: tuple[str, ...], doing: list[str], speeds: list[float], variation: object, apart: float) -> tuple:
    """Scene and motion of people beside each other after a second of what they do."""
    count = len(names)
    place = np.stack([np.zeros(count), apart * (np.arange(count) - 0.5 * (count - 1))], axis=1)[None]
    velocity = np.stack([np.array(speeds), np.zeros(count)], axis=1)[None]
    scene = Scene.of(place[0], heading=np.zeros(count), velocity=velocity[0])
    motion = PeopleMotion(scene, np.arange(count), People.of(list(names), variation), seed=3)
    motion.begin(scene.replace(position=place - velocity * DT * STEPS), doing)
    for k in range(STEPS):
        motion.walk(scene.replace(position=place - velocity * DT * (STEPS - 1 - k)), DT)
    return scene, motion


def row(
    names: tuple[str, ...], doing: list[str], speed: float, variation: object = None, detail: int = 0,
    apart: float = 0.85, size: tuple[int, int] = (480, 400), look: Appearance = Appearance(),  # noqa: B008
) -> Image3:  # fmt: skip
    """People beside each other, who come towards the camera."""
    count = len(names)
    speeds = [SPEEDS.get(item, 0.0) if item != "walk" else speed for item in doing]
    scene, motion = moved(names, doing, speeds, np.arange(count) if variation is None else variation, apart)
    wide = apart * (count + 0.4)
    view = math.radians(22.0)
    away = max(0.5 * wide * size[1] / size[0], 1.15) / math.tan(0.5 * view)
    camera = SceneCamera(
        (away, 0.35 * away, 1.5), (0.0, 0.0, 0.86), *size, view, detail=detail, shadows=True, renderer="software",
        antialiasing=8,
    )  # fmt: skip
    return Renderer(scene, {}, PhysicsStage(appearance=look), motion).images(camera).rgb


def busy() -> Image3:
    """All activities, in two rows."""
    half = len(ACTIVITIES) // 2
    parts = [
        row(BUSY[rows], list(ACTIVITIES[rows]), 1.2, np.arange(len(BUSY))[rows], apart=1.25, size=(1280, 380))
        for rows in (slice(0, half), slice(half, 2 * half))
    ]
    return np.vstack(parts)


def faces() -> Image3:
    """Heads at a distance of 0.8 m."""
    scene, motion = moved(FACES, ["walk"] * 8, [0.0] * 8, np.arange(8), 3.0)
    renderer, parts = Renderer(scene, {}, None, motion), []
    for k in range(8):
        x, y = scene.position[0, k]
        eyes = 0.93 * float(motion.people.height[k])
        camera = SceneCamera(
            (x + 0.75, y + 0.25, eyes + 0.03), (x + 0.05, y, eyes - 0.01), 320, 320, math.radians(34.0), detail=0,
            shadows=True, renderer="software", antialiasing=8,
        )  # fmt: skip
        parts.append(renderer.images(camera).rgb)
    return np.vstack([np.hstack(parts[:4]), np.hstack(parts[4:])])


def places() -> Image3:
    """The same people on other floors, before other walls, under other skies."""
    parts = []
    for floor, walls, sky in PLACES:
        scene, motion = moved(WALKERS[:5], ["walk"] * 5, [1.2] * 5, np.arange(5), 1.2)
        scene = scene.replace(walls=Scene.of([[0.0, 0.0]], walls=[[(-5.0, -30.0), (-5.0, 30.0)]]).walls)
        stage = PhysicsStage(appearance=Appearance(floor, walls, sky))
        camera = SceneCamera(
            (6.5, 2.0, 1.6), (0.0, 0.0, 0.9), 640, 400, math.radians(34.0), detail=0, shadows=True,
            renderer="software", antialiasing=8,
        )  # fmt: skip
        parts.append(Renderer(scene, {}, stage, motion).images(camera).rgb)
    return np.vstack([np.hstack(parts[:2]), np.hstack(parts[2:])])


def wheelchairs() -> Image3:
    """Two people in wheelchairs."""
    scene = Scene.of([[0.0, -0.7], [0.0, 0.7]], heading=[0.0, 0.6], external=[True, True])
    people = People.of(["woman-38", "man-60"], [4, 2])
    motion = PeopleMotion(scene, np.zeros(0, dtype=np.int64), people, riders=[0, 1])
    motion.begin(scene, [])
    chairs = {k: Robot.load("wheelchair") for k in range(2)}
    camera = SceneCamera(
        (3.6, 1.4, 1.5), (0.0, 0.0, 0.7), 640, 420, math.radians(32.0), detail=0, shadows=True, renderer="software",
        antialiasing=8,
    )  # fmt: skip
    return Renderer(scene, chairs, None, motion).images(camera).rgb


if __name__ == "__main__":
    main()
