"""Labelled images in the formats of COCO and KITTI."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import SpatialPose
from crowdbot.humans import KEYPOINT_EDGES, KEYPOINTS
from crowdbot.typing import Floats

Table = Mapping[str, NDArray[Any]]
PERSON_CATEGORY = 1
"""Category of people, as in COCO."""


def write_images(tables: Mapping[str, Table], folder: Path) -> list[Path]:
    """Write the images of all colour cameras and ``annotations.json`` to a folder, and return the files."""
    from PIL import Image

    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    files: list[Path] = []
    for name, table in tables.items():
        if "rgb" not in table:
            continue
        folder.mkdir(parents=True, exist_ok=True)
        for row, picture in enumerate(table["rgb"]):
            episode, when = int(table["episode"][row]), int(table["nanoseconds"][row])
            file = folder / f"{name.replace('/', '-')}-{episode:03d}-{when:013d}.png"
            Image.fromarray(picture).save(file, format="PNG")
            files.append(file)
            number = len(images) + 1
            height, width = picture.shape[:2]
            images.append({"id": number, "file_name": f"{folder.name}/{file.name}", "width": width, "height": height})
            annotations += _annotations(table, row, number, len(annotations))
    if files:
        files.append(folder / "annotations.json")
        files[-1].write_text(json.dumps({"images": images, "annotations": annotations}), encoding="utf-8")
    return files


def _annotations(table: Table, row: int, image: int, before: int) -> list[dict[str, Any]]:
    result: list[dict[str, Any]] = []
    for column, person in enumerate(table["ids"][row].tolist()):
        box = table["boxes"][row, column].tolist()
        if person < 0 or not box[2]:
            continue
        mask = table["hit"][row] == person
        hidden = float(table["occluded"][row, column])
        result.append(
            {
                "id": before + len(result) + 1,
                "image_id": image,
                "category_id": PERSON_CATEGORY,
                "person": person,
                "bbox": box,
                "area": int(mask.sum()),
                "segmentation": encode_mask(mask),
                "iscrowd": 0,
                "occluded": None if np.isnan(hidden) else hidden,
                **_space_labels(table, row, column),
            }
        )
    return result


def _space_labels(table: Table, row: int, column: int) -> dict[str, Any]:
    """Return keypoints, and the box in the world: centre, length, width, height [m], and heading [rad]."""
    if "keypoints" not in table:
        return {}
    points, solid = table["keypoints"][row, column].astype(float), table["solid_boxes"][row, column].astype(float)
    flat = [round(value, 2) if k % 3 < 2 else int(value) for k, value in enumerate(points.ravel().tolist())]
    space_labels: dict[str, Any] = {"keypoints": flat, "num_keypoints": int(np.count_nonzero(points[:, 2]))}
    if not np.isnan(solid[0]):
        center, size, heading = solid[:3].tolist(), solid[3:6].tolist(), float(solid[6])
        space_labels["box_3d"] = {"center": center, "size": size, "heading": heading}
    return space_labels


def encode_mask(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """Return a mask ``[H, W]`` as run lengths down the columns, which begin with pixels outside.

    >>> encode_mask(np.array([[False, True], [True, True]]))
    {'counts': [1, 3], 'size': [2, 2]}
    """
    flat = np.asarray(mask, dtype=np.int8).T.ravel()
    ends = np.flatnonzero(np.diff(flat)) + 1
    counts = np.diff(np.concatenate([[0], ends, [len(flat)]])).tolist()
    return {"counts": [0, *counts] if flat[0] else counts, "size": list(mask.shape)}


def join_annotations(files: Iterable[Path], info: Mapping[str, Any]) -> Any:
    """Return the annotations of all shards with new numbers, as one COCO object.

    Args:
        files: ``annotations.json`` of the shards.
        info: description of the data.
    """
    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    for file in files:
        part = json.loads(file.read_text(encoding="utf-8"))
        shift = len(images)
        images += [item | {"id": item["id"] + shift} for item in part["images"]]
        before = len(annotations)
        annotations += [
            item | {"id": item["id"] + before, "image_id": item["image_id"] + shift} for item in part["annotations"]
        ]
    bones = {"keypoints": list(KEYPOINTS), "skeleton": [list(edge) for edge in KEYPOINT_EDGES]}
    person = {"id": 1, "name": "person", **bones}
    return {"info": dict(info), "images": images, "annotations": annotations, "categories": [person]}


CAMERA = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
"""Rotation from x forward, y left, z up to the axes of KITTI: x right, y down, z forward."""
PERSON, STRUCTURE, FLOOR, OTHER = 30, 50, 40, 99
"""Classes of SemanticKITTI: person, building, road, other object."""


def write_kitti(tables: Mapping[str, Table], folder: Path) -> list[Path]:
    """Write images, labels and calibrations of colour cameras, and point clouds with instances of 3-D scanners.

    ``image_2``, ``label_2`` and ``calib`` have a file for each image; ``velodyne`` (x, y, z, 1 in single precision) and
    ``labels`` (class, and id of the person times 65536) one for each scan. Returns the files.

    Source: Geiger et al. 2012, doi:10.1109/CVPR.2012.6248074; Behley et al. 2019, doi:10.1109/ICCV.2019.00939.
    """
    files: list[Path] = []
    for name, table in tables.items():
        place = folder / name.replace("/", "-")
        if "rgb" in table:
            files += _write_images(table, place)
        elif "elevation" in {key.removeprefix("shared.") for key in table} and "hit" in table:
            files += _write_clouds(table, place)
    return files


def _write_images(table: Table, place: Path) -> list[Path]:
    from PIL import Image

    files = []
    for kind in ("image_2", "label_2", "calib"):
        (place / kind).mkdir(parents=True, exist_ok=True)
    for row, picture in enumerate(table["rgb"]):
        pose = SpatialPose(table["pose_position"][row : row + 1].astype(float), table["pose_rotation"][row : row + 1])
        image, label, calib = (place / f"{kind}/{row:06d}" for kind in ("image_2", "label_2", "calib"))
        Image.fromarray(picture).save(image.with_suffix(".png"), format="PNG")
        label.with_suffix(".txt").write_text("".join(_lines(table, row, pose)), encoding="ascii", newline="\n")
        calib.with_suffix(".txt").write_text(_calibration(table["intrinsics"][row]), encoding="ascii", newline="\n")
        files += [image.with_suffix(".png"), label.with_suffix(".txt"), calib.with_suffix(".txt")]
    return files


def _lines(table: Table, row: int, pose: SpatialPose) -> list[str]:
    lines = []
    high, wide = table["rgb"].shape[1:3]
    for column, person in enumerate(table["ids"][row].tolist()):
        pixels, solid = table["boxes"][row, column], table["solid_boxes"][row, column].astype(float)
        if person >= 0 and pixels[2] and not np.isnan(solid[0]):
            hidden = float(table["occluded"][row, column])
            lines.append(kitti_line(pixels, solid, pose, table["intrinsics"][row], (int(wide), int(high)), hidden))
    return lines


def kitti_line(
    pixels: NDArray[Any], solid: Floats, pose: SpatialPose, intrinsics: NDArray[Any], size: tuple[int, int],
    hidden: float,
) -> str:  # fmt: skip
    """Return the line of a person in a label file.

    Args:
        pixels: left, top, width and height of the visible pixels.
        solid: centre, length, width, height [m] and heading [rad] in the world.
        pose: pose of the camera, E = 1.
        intrinsics: fx, fy, cx, cy [pixels].
        size: width and height of the image [pixels].
        hidden: share of the person that is hidden, NaN if unknown.

    >>> camera = SpatialPose.of((0.0, 0.0, 1.5))
    >>> solid = np.array([10.0, 0.0, 0.9, 0.5, 0.6, 1.8, 0.0])
    >>> kitti_line(np.array([10, 20, 30, 60]), solid, camera, np.array([300.0, 300, 160, 120]), (320, 240), 0.0)
    'Pedestrian 0.00 0 -1.57 10.00 20.00 39.00 79.00 1.80 0.60 0.50 0.00 1.50 10.00 -1.57\\n'
    """
    turn = CAMERA @ pose.matrix[0].T
    bottom = turn @ (solid[:3] - (0.0, 0.0, 0.5 * solid[5]) - pose.position[0])
    ahead = turn @ np.array([math.cos(solid[6]), math.sin(solid[6]), 0.0])
    rotation = math.atan2(-ahead[2], ahead[0])
    alpha = _wrapped(rotation - math.atan2(bottom[0], bottom[2]))
    cut = _truncated(solid, turn, pose, intrinsics, size)
    level = 3 if math.isnan(hidden) else 0 if hidden < 0.1 else 1 if hidden < 0.5 else 2
    left, top, wide, high = (float(value) for value in pixels)
    numbers = (left, top, left + wide - 1.0, top + high - 1.0, solid[5], solid[4], solid[3], *bottom, rotation)
    return f"Pedestrian {cut:.2f} {level} {alpha:.2f} " + " ".join(f"{value + 0.0:.2f}" for value in numbers) + "\n"


def _truncated(
    solid: Floats, turn: Floats, pose: SpatialPose, intrinsics: NDArray[Any], size: tuple[int, int]
) -> float:
    """Return the share of the projected box that lies outside the image."""
    cos, sin = math.cos(solid[6]), math.sin(solid[6])
    signs = np.array([(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]) * 0.5 * solid[3:6]
    corners = signs @ np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]) + solid[:3] - pose.position[0]
    x, y, z = turn @ corners.T
    z = np.maximum(z, 0.05)
    fx, fy, cx, cy = (float(value) for value in intrinsics)
    column, row = x / z * fx + cx, y / z * fy + cy
    whole = (column.max() - column.min()) * (row.max() - row.min())
    inside = (
        np.clip([column.min(), column.max()], -0.5, size[0] - 0.5),
        np.clip([row.min(), row.max()], -0.5, size[1] - 0.5),
    )
    return float(1.0 - (inside[0][1] - inside[0][0]) * (inside[1][1] - inside[1][0]) / max(whole, 1e-9))


def _calibration(intrinsics: NDArray[Any]) -> str:
    """Return the calibration of an image: all cameras and the scanner have the frame of this camera."""
    fx, fy, cx, cy = (float(value) for value in intrinsics)
    project = f"{fx:.6e} 0 {cx:.6e} 0 0 {fy:.6e} {cy:.6e} 0 0 0 1 0"
    shift = " ".join(f"{a:g} {b:g} {c:g} 0" for a, b, c in CAMERA + 0.0)
    rows = [f"P{k}: {project}" for k in range(4)] + ["R0_rect: 1 0 0 0 1 0 0 0 1"]
    return "\n".join([*rows, f"Tr_velo_to_cam: {shift}", f"Tr_imu_to_velo: {shift}"]) + "\n"


def _write_clouds(table: Table, place: Path) -> list[Path]:
    files = []
    for kind in ("velodyne", "labels"):
        (place / kind).mkdir(parents=True, exist_ok=True)
    up, around = (np.asarray(table[f"shared.{name}"], dtype=float) for name in ("elevation", "azimuth"))
    flat = np.cos(up)[:, None]
    x, y, z = np.broadcast_arrays(flat * np.cos(around), flat * np.sin(around), np.sin(up)[:, None])
    way = np.stack([x, y, z], axis=-1)
    for row, ranges in enumerate(table["ranges"]):
        back = np.isfinite(ranges)
        points = np.column_stack([way[back] * ranges[back][:, None], np.ones(int(back.sum()))]).astype("<f4")
        hit = table["hit"][row][back].astype(np.int64)
        kinds = np.select([hit >= 0, hit == -2, hit == -3], [PERSON, STRUCTURE, FLOOR], OTHER)
        labels = (np.where(hit >= 0, (hit + 1) << 16, 0) | kinds).astype("<u4")
        for name, array in (("velodyne", points), ("labels", labels)):
            file = place / name / f"{row:06d}.{'bin' if name == 'velodyne' else 'label'}"
            file.write_bytes(array.tobytes())
            files.append(file)
    return files


def _wrapped(angle: float) -> float:
    return (angle + math.pi) % (2.0 * math.pi) - math.pi
