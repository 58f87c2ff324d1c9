"""Colour images as PNG files with boxes and masks of people, in the format of COCO."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.humans import KEYPOINT_EDGES, KEYPOINTS

Table = Mapping[str, NDArray[Any]]
PERSON = 1
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
    found: list[dict[str, Any]] = []
    for column, person in enumerate(table["ids"][row].tolist()):
        box = table["boxes"][row, column].tolist()
        if person < 0 or not box[2]:
            continue
        mask = table["hit"][row] == person
        hidden = float(table["occluded"][row, column])
        found.append(
            {
                "id": before + len(found) + 1,
                "image_id": image,
                "category_id": PERSON,
                "person": person,
                "bbox": box,
                "area": int(mask.sum()),
                "segmentation": encode_mask(mask),
                "iscrowd": 0,
                "occluded": None if np.isnan(hidden) else hidden,
                **_space_labels(table, row, column),
            }
        )
    return found


def _space_labels(table: Table, row: int, column: int) -> dict[str, Any]:
    """Return keypoints, and the box in the world: centre, length, width, height [m], and heading [rad]."""
    if "keypoints" not in table:
        return {}
    points, solid = table["keypoints"][row, column].astype(float), table["solid_boxes"][row, column].astype(float)
    flat = [round(value, 2) if k % 3 < 2 else int(value) for k, value in enumerate(points.ravel().tolist())]
    found: dict[str, Any] = {"keypoints": flat, "num_keypoints": int(np.count_nonzero(points[:, 2]))}
    if not np.isnan(solid[0]):
        center, size, heading = solid[:3].tolist(), solid[3:6].tolist(), float(solid[6])
        found["box_3d"] = {"center": center, "size": size, "heading": heading}
    return found


def encode_mask(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """Return a mask ``[H, W]`` as run lengths down the columns, which begin with pixels outside.

    >>> encode_mask(np.array([[False, True], [True, True]]))
    {'counts': [1, 3], 'size': [2, 2]}
    """
    flat = np.asarray(mask, dtype=np.int8).T.ravel()
    ends = np.flatnonzero(np.diff(flat)) + 1
    counts = np.diff(np.concatenate([[0], ends, [len(flat)]])).tolist()
    return {"counts": [0, *counts] if flat[0] else counts, "size": list(mask.shape)}


def join_annotations(files: Iterable[Path], info: Mapping[str, Any], categories: Sequence[str] = ("person",)) -> Any:
    """Return the annotations of all shards with new numbers, as one COCO object.

    Args:
        files: ``annotations.json`` of the shards.
        info: description of the data.
        categories: names of the categories, numbered from 1.
    """
    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    for file in files:
        part = json.loads(file.read_text(encoding="utf-8"))
        shift = len(images)
        images += [one | {"id": one["id"] + shift} for one in part["images"]]
        before = len(annotations)
        annotations += [
            one | {"id": one["id"] + before, "image_id": one["image_id"] + shift} for one in part["annotations"]
        ]
    bones = {"keypoints": list(KEYPOINTS), "skeleton": [list(edge) for edge in KEYPOINT_EDGES]}
    names = [{"id": k + 1, "name": name, **(bones if name == "person" else {})} for k, name in enumerate(categories)]
    return {"info": dict(info), "images": images, "annotations": annotations, "categories": names}
