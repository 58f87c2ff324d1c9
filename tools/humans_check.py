"""Compare a file of bodies with the one that ships: sizes of limbs, mass, soles, scalps, hems, thickness, size."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from humans_thick import nearest

SHIPPED = Path(__file__).parents[1] / "src" / "crowdbot" / "assets" / "humans" / "humans_cc0.npz"
LENGTHS = (
    ("thigh_l", "calf_l"), ("calf_l", "foot_l"), ("upperarm_l", "lowerarm_l"), ("lowerarm_l", "hand_l"),
    ("foot_l", "ball_l"), ("upperarm_l", "upperarm_r"), ("thigh_l", "thigh_r"), ("neck_01", "head"),
)  # fmt: skip
UNIT = 1e-4


def check(file: Path) -> None:
    """Print the measures, and leave with an error when one is out of its bounds.

    Raises:
        SystemExit: the file is not sound.
    """
    with np.load(file) as one, np.load(SHIPPED) as other:
        rows = _compared(one, other) + _sound(one, file)
    for name, value, most in rows:
        print(f"{'ok ' if value <= most else 'BAD'} {name}: {value:.4g} (at most {most:g})")
    if any(not value <= most for _, value, most in rows):
        sys.exit(1)


def _compared(npz_file: np.lib.npyio.NpzFile, other: np.lib.npyio.NpzFile) -> list[tuple[str, float, float]]:
    """Differences of the people, who must be the same."""
    bones = [str(b) for b in other["bones"]]
    same = [np.array_equal(npz_file[key], other[key]) for key in ("bones", "parents", "regions", "part_names")]
    rows = [("bones, parents, regions or parts that differ", float(same.count(False)), 0.0)]
    people = [json.loads(str(f["people"])) for f in (npz_file, other)]
    for key, most in (("years", 0.0), ("H", 1e-6), ("mass", 2.0)):
        away = max(abs(a[key] - b[key]) for a, b in zip(*people, strict=True))
        rows.append((f"largest difference of {key}", away, most))
    for a, b in LENGTHS:
        size = [np.linalg.norm(f["joint_head"][:, bones.index(a)] - f["joint_head"][:, bones.index(b)], axis=1)
                for f in (npz_file, other)]  # fmt: skip
        rows.append((f"largest difference of {a} to {b} [mm]", 1000 * float(np.abs(size[0] - size[1]).max()), 8.0))
    return rows


def _sound(npz_file: np.lib.npyio.NpzFile, file: Path) -> list[tuple[str, float, float]]:
    """Where soles, scalps and hems are, how thick the coarse levels are, and how large the file is."""
    people, regions = json.loads(str(npz_file["people"])), [str(r) for r in npz_file["regions"]]
    tall = np.array([p["H"] for p in people])
    rows = [("size of the file [MB]", file.stat().st_size / 1e6, 1.6)]
    for k in range(3):
        place, region = npz_file[f"lod{k}_verts"] * UNIT, npz_file[f"lod{k}_region"]
        faces, face_region = npz_file[f"lod{k}_faces"].astype(int), npz_file[f"lod{k}_face_region"]
        shoes = place[:, region == regions.index("shoes"), 2].min(axis=1)
        scalp = place[:, region == regions.index("scalp"), 2].max(axis=1)
        rows.append((f"level {k}: sole off the floor [mm]", 1000 * float(np.abs(shoes).max()), 2.0))
        rows.append((f"level {k}: scalp off the stature [mm]", 1000 * float(np.abs(scalp - tall).max()), 6.0))
        mean = place.mean(axis=0)
        for a, b in (("top", "bottom"), ("bottom", "shin"), ("shin", "shoes")):
            sides = [{tuple(p) for p in mean[faces[face_region == regions.index(r)]].reshape(-1, 3).round(4)}
                     for r in (a, b)]  # fmt: skip
            line = np.array(sorted(sides[0] & sides[1]))
            spread = 1000 * float(np.ptp(line[:, 2])) if len(line) > 4 else np.inf
            rows.append(
                (f"level {k}: height of the line from {a} to {b} varies by [mm]", spread, 6.0 if k == 0 else 15.0)
            )
        if k:
            rows += [(f"level {k}: {name} [mm]", value, most) for name, value, most in _thick(npz_file, k)]
    return rows


def _thick(npz_file: np.lib.npyio.NpzFile, k: int) -> list[tuple[str, float, float]]:
    """How far the finest skin and cloth lie off a coarse level."""
    gaps = []
    for person in (0, 10, 25, 35, 40):
        solid = int(npz_file[f"lod{k}_parts"][:3, 1].sum())
        points = npz_file["lod0_verts"][person, : npz_file["lod0_parts"][:3, 0].sum()] * UNIT
        faces = npz_file[f"lod{k}_faces"][:solid].astype(int)
        gaps.append(nearest(points, npz_file[f"lod{k}_verts"][person] * UNIT, faces)[1])
    gap = 1000 * np.concatenate(gaps)
    limits = (1.5, 5.0) if k == 1 else (2.5, 12.0)
    return [("mean by which the finest lies outside, either way", abs(float(gap.mean())), limits[0]),
            ("mean distance of the finest", float(np.abs(gap).mean()), limits[1])]  # fmt: skip
