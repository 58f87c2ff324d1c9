"""Time a colour camera of 640 x 480 that sees 30 people: ``python studies/camera_speed.py``.

The renderer ``software`` with shadows and 4 samples per pixel, level of detail 1, 30 walking people and a robot within
10 m, without depth and labels; the same without antialiasing and without shadows. Wall time needs a machine without
other work; the processor time counts all threads.
"""

from __future__ import annotations

import argparse
import dataclasses
import time

import numba
import numpy as np

from crowdbot.core import Scene
from crowdbot.world import PeopleMotion, Renderer, Robot, SceneCamera

PEOPLE, IMAGES, ROUNDS = 30, 10, 4


def main() -> None:
    """Print the times of an image, on one thread and on all."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    rng = np.random.default_rng(0)
    place = [[0.0, 0.0], *([2.0 + rng.uniform(0.0, 10.0), rng.uniform(-4.0, 4.0)] for _ in range(PEOPLE))]
    scene = Scene.of(
        place, heading=rng.uniform(-3.0, 3.0, PEOPLE + 1), velocity=rng.uniform(-1.0, 1.0, (PEOPLE + 1, 2)),
        external=[True] + [False] * PEOPLE, walls=[[(-2.0, -5.0), (14.0, -5.0)], [(14.0, -5.0), (14.0, 6.0)]],
    )  # fmt: skip
    motion = PeopleMotion(scene, np.arange(1, PEOPLE + 1), seed=1)
    renderer = Renderer(scene, {0: Robot.load("pepper")}, None, motion)
    camera = SceneCamera((0.3, 0.0, 1.2), (5.0, 0.0, 1.0), shadows=True, renderer="software", antialiasing=4)
    most = numba.get_num_threads()
    print("| image | threads | ms, wall | ms of processor time | images/s |\n|---|---:|---:|---:|---:|")
    for words, options in (("as asked", {}), ("1 sample", {"antialiasing": 1}), ("no shadows", {"shadows": False})):
        for threads in sorted({1, most}):
            numba.set_num_threads(threads)
            wall, used = timed(renderer, dataclasses.replace(camera, **options))
            print(f"| {words} | {threads} | {1000.0 * wall:.0f} | {1000.0 * used:.0f} | {1.0 / wall:.1f} |")


def timed(renderer: Renderer, camera: SceneCamera) -> tuple[float, float]:
    """Mean wall time and processor time [s] of an image, the best of some rounds."""
    renderer.images(camera)
    found = []
    for _ in range(ROUNDS):
        begin, spent = time.perf_counter(), time.process_time()
        for _ in range(IMAGES):
            renderer.images(camera)
        found.append(((time.perf_counter() - begin) / IMAGES, (time.process_time() - spent) / IMAGES))
    wall, used = zip(*found, strict=True)
    return min(wall), min(used)


if __name__ == "__main__":
    main()
