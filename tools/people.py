"""Draw people for the gallery: ``python tools/people.py docs/gallery/people``."""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import trimesh
from matplotlib.image import imsave
from raster import corner_normals, drawn

from crowdbot.humans import ACTIVITIES, CHAIR, WHEELCHAIR, Gait, People, Seat

WALKERS = (
    "man-20", "woman-20", "man-32", "woman-36", "man-55", "woman-60", "man-44", "woman-28", "man-66", "woman-41",
)  # fmt: skip
YOUNG = ("boy-08", "girl-09", "boy-12", "girl-13", "mannequin", "mannequin")
BUSY = ("woman-36", "man-44", "woman-20", "man-27", "woman-60", "man-66")
CLOSE = ("woman-24", "man-38")
RIDERS = ("woman-38", "man-60")
APART, SPEED, DT = 0.8, 1.3, 0.02
CHAIR_FILE = Path(__file__).parents[1] / "src" / "crowdbot" / "assets" / "robots" / "wheelchair" / "wheelchair.urdf"
Parts = tuple[np.ndarray, np.ndarray, np.ndarray]


def main() -> None:
    """Write the pictures."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    _write(folder / "walking.png", _people(WALKERS, speed=SPEED), scale=135)
    _write(folder / "young.png", _people(YOUNG, speed=1.1, variation=(0, 1, 2, 3, 0, 4)), scale=150)
    _write(folder / "busy.png", _people(BUSY, activities=ACTIVITIES, apart=1.0), scale=150)
    for level in range(3):
        _write(folder / f"level-{level}.png", _people(CLOSE, speed=SPEED, level=level), scale=230)
    chairs = [_chair(np.array([0.0, 1.1 * k, 0.0])) for k in range(2)]
    riders = _people(RIDERS, activities=("sit", "sit"), apart=1.1, seat=WHEELCHAIR, variation=(4, 2))
    _write(folder / "wheelchair.png", _together([riders, *chairs]), scale=230, azimuth=0.75)
    _write(folder / "wheelchair-side.png", _together([riders, *chairs]), scale=230, azimuth=1.57, elevation=0.02)
    same = _people(("woman-36",) * 10, variation=tuple(range(10)), apart=0.65)
    _write(folder / "variations.png", same, scale=135)


def _write(path: Path, parts: Parts, scale: float, azimuth: float = 0.5, elevation: float = 0.12) -> None:
    imsave(path, drawn(*parts, azimuth, elevation, scale))


def _together(parts: list[Parts]) -> Parts:
    triangles, colors, normals = zip(*parts, strict=True)
    return np.concatenate(triangles), np.concatenate(colors), np.concatenate(normals)


def _people(
    names: tuple[str, ...], speed: float = 0.0, activities: tuple[str, ...] | None = None, level: int = 0,
    apart: float = APART, seat: Seat = CHAIR, variation: tuple[int, ...] | None = None,
) -> Parts:  # fmt: skip
    """People beside each other after a second of what they do."""
    count = len(names)
    people = People.of(list(names), np.arange(count) if variation is None else variation)
    gait = Gait(people, seed=3, seat=seat)
    place = np.stack([np.zeros(count), apart * np.arange(count)], axis=1)
    velocity = np.tile([speed, 0.0], (count, 1))
    state = gait.start(place, np.zeros(count), velocity, "walk" if activities is None else list(activities))
    for _ in range(50):
        place = place + velocity * DT
        state = gait.step(state, place, velocity, np.zeros(count), DT)
    skin, faces, worn, colors = (
        gait.skin(state, level),
        people.faces(level),
        people.clothing_mask(level),
        people.face_colors(level),
    )
    each = [
        (skin[i][faces[worn[i]]], colors[i][worn[i]], corner_normals(skin[i], faces[worn[i]])) for i in range(count)
    ]
    return _together(each)


def _chair(at: np.ndarray) -> Parts:
    """The shipped wheelchair of its primitives."""
    root = ET.parse(CHAIR_FILE).getroot()  # noqa: S314
    material = {m.get("name"): m.find("color").get("rgba") for m in root.findall("material")}
    place = {"base_link": np.eye(4)}
    for joint in root.findall("joint"):
        place[joint.find("child").get("link")] = _pose(joint.find("origin"))
    each = []
    for link in root.findall("link"):
        for visual in link.findall("visual"):
            shape = _primitive(visual.find("geometry")[0])
            shape.apply_transform(place[link.get("name")] @ _pose(visual.find("origin")))
            color = [float(c) for c in material[visual.find("material").get("name")].split()[:3]]
            flat = np.repeat(shape.face_normals[:, None], 3, axis=1)
            each.append((shape.triangles + at, np.tile(color, (len(flat), 1)), flat))
    return _together(each)


def _primitive(geometry: ET.Element) -> trimesh.Trimesh:
    if geometry.tag == "box":
        return trimesh.creation.box([float(v) for v in geometry.get("size").split()])
    if geometry.tag == "sphere":
        return trimesh.creation.icosphere(radius=float(geometry.get("radius")))
    return trimesh.creation.cylinder(float(geometry.get("radius")), float(geometry.get("length")))


def _pose(origin: ET.Element | None) -> np.ndarray:
    if origin is None:
        return np.eye(4)
    turn = [float(v) for v in origin.get("rpy", "0 0 0").split()]
    out = trimesh.transformations.euler_matrix(*turn, axes="sxyz")
    out[:3, 3] = [float(v) for v in origin.get("xyz", "0 0 0").split()]
    return out


if __name__ == "__main__":
    main()
