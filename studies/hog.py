"""Count the people that the HOG detector of OpenCV finds in rendered images: ``python studies/hog.py [--seed N]``.

Each of the 45 bodies is drawn alone by the renderer ``software``, upright, at heights of 128 to 320 pixels, from five
sides, under each sky, on changing floors and before changing walls. The seed changes outfits, bags, gaits, and which
person has which height, sky, floor and walls; looks were mended with seed 0.

The detector is that of Dalal and Triggs 2005 (doi:10.1109/CVPR.2005.177) with the weights of OpenCV, window stride 8,
scale 1.05, threshold 0. Boxes are matched as by Dollar et al. 2012 (doi:10.1109/TPAMI.2011.155): widths are set to 0.41
of the height, and a person is found if the intersection over union of a window with the box of the pixels of the person
is at least 0.5; below 0.2 it is false.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.humans import People, names
from crowdbot.world import (
    FLOORS,
    SKIES,
    WALL_SURFACES,
    Appearance,
    PeopleMotion,
    PhysicsStage,
    Renderer,
    SceneCamera,
)

TALL = (128, 160, 200, 260, 320)
"""Heights of people [pixels]."""
WIDTH, HEIGHT, FOCAL = 640, 480, 500.0
SIDES = (0.0, 0.6, 1.57, 2.6, 3.14)
"""Directions from which people are seen [rad], 0 is the front."""
OVERLAP, ASPECT, MARGIN = 0.5, 0.41, 0.75
"""Smallest overlap, width of a box as a share of its height, and the share of a window that a person fills."""
ROOM = 6.0
Pixels = NDArray[np.uint8]


def main() -> None:
    """Print how many people are found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="folder for pictures of people who are not found")
    parser.add_argument("--seed", type=int, default=0, help="seed of outfits, gaits and surroundings (default: 0)")
    given = parser.parse_args()
    detector = cv2.HOGDescriptor()
    detector.setSVMDetector(np.asarray(cv2.HOGDescriptor.getDefaultPeopleDetector()))
    found: dict[str, list[bool]] = {}
    false = images = 0
    for k, name in enumerate(names()):
        for view, (image, box, words) in enumerate(pictures(name, k, given.seed)):
            windows, _ = detector.detectMultiScale(
                image[..., ::-1].copy(), winStride=(8, 8), padding=(8, 8), scale=1.05
            )
            overlaps = [overlap(window, box) for window in windows]
            hit = max(overlaps, default=0.0) >= OVERLAP
            false += sum(item < 0.2 for item in overlaps)
            images += 1
            for word in ("all", *words):
                found.setdefault(word, []).append(hit)
            if not hit and given.out is not None:
                given.out.mkdir(parents=True, exist_ok=True)
                cv2.imwrite(str(given.out / f"{name}-{view}.png"), image[..., ::-1])
    print("| people | found | share |\n|---|---:|---:|")
    for word, hits in sorted(found.items(), key=lambda item: (item[0] != "all", item[0])):
        print(f"| {word} | {sum(hits)} of {len(hits)} | {100.0 * sum(hits) / len(hits):.1f} % |")
    print(f"\n{false} false windows in {images} images")


def pictures(name: str, k: int, seed: int = 0) -> list[tuple[Pixels, Sequence[int], tuple[str, ...]]]:
    """The pictures of a person: image, box of its pixels, and words that describe it."""
    people = People.of([name], variation=k + 50 * seed)
    made: list[tuple[Pixels, Sequence[int], tuple[str, ...]]] = []
    still, k = k % 2 == 0, k + 3 * seed
    for n, side in enumerate(SIDES):
        tall = TALL[(n + k) % len(TALL)]
        looks = Appearance(
            FLOORS[(k + n) % len(FLOORS)], WALL_SURFACES[(k + 2 * n) % len(WALL_SURFACES)], SKIES[(k + n) % len(SKIES)],
            sun_heading=2.0 + 0.7 * n,
        )  # fmt: skip
        scene = Scene.of([[0.0, 0.0]], heading=[side], velocity=[[1.2 * math.cos(side), 1.2 * math.sin(side)]])
        scene = scene.replace(velocity=np.zeros((1, 1, 2))) if still else scene
        walls = Scene.of([[0.0, 0.0]], walls=[[(-ROOM, -9.0), (-ROOM, 9.0)]]).walls
        scene = scene.replace(walls=walls)
        motion = PeopleMotion(scene, np.array([0]), people, seed=k + 100 * seed)
        away = FOCAL * float(people.height[0]) / tall
        camera = SceneCamera(
            (away, 0.15 * away, 1.3), (0.0, 0.0, 0.9), WIDTH, HEIGHT, 2.0 * math.atan(0.5 * HEIGHT / FOCAL),
            shadows=True, detail=0, renderer="software", antialiasing=4,
        )  # fmt: skip
        seen = Renderer(scene, {}, PhysicsStage(appearance=looks), motion).images(camera, segmentation=True)
        assert seen.rgb is not None
        assert seen.segmentation is not None
        rows, columns = np.nonzero(seen.segmentation == 0)
        box = [int(n) for n in (columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1)]
        made.append((seen.rgb, box, (f"{tall} pixels", f"sky {looks.sky}", name.split("-", maxsplit=1)[0])))
    return made


def overlap(window: Sequence[int], box: Sequence[int]) -> float:
    """Intersection over union of a window without its margin and a box, both with a width of 0.41 of their height."""
    a, b = standard(window, MARGIN), standard(box, 1.0)
    left, top, right, low = max(a[0], b[0]), max(a[1], b[1]), min(a[2], b[2]), min(a[3], b[3])
    both = max(0.0, right - left) * max(0.0, low - top)
    sizes = [(item[2] - item[0]) * (item[3] - item[1]) for item in (a, b)]
    return both / (sum(sizes) - both)


def standard(box: Sequence[int], share: float) -> tuple[float, float, float, float]:
    """Left, top, right and lower edge of a box with the same centre, and the standard width."""
    x, y, wide, high = (float(value) for value in box)
    tall = share * high
    middle, centre = x + 0.5 * wide, y + 0.5 * high
    return middle - 0.5 * ASPECT * tall, centre - 0.5 * tall, middle + 0.5 * ASPECT * tall, centre + 0.5 * tall


if __name__ == "__main__":
    main()
