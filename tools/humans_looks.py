"""Bake texture coordinates and detail maps of the bodies: ``python tools/humans_looks.py FILE.npz``.

Everything is computed from the mesh of the mean adult and from noise; there is no photograph. The file that ships is
``src/crowdbot/assets/humans/looks_cc0.npz``, CC0 as the bodies.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from humans_charts import HEAD_AXIS, HEAD_LOW, HEAD_TALL, SIDE, corner_uv
from scipy.interpolate import griddata
from scipy.ndimage import gaussian_filter

from crowdbot.humans.asset import shapes
from crowdbot.world.rendering.software_visuals import periodic_noise

MOUTH, NOSE, EYE, BROW, HAIRLINE = 1.5215, 1.548, 1.590, 1.6125, 1.668
"""Heights [m] on the mean adult."""


def main() -> None:
    """Write the file."""
    arrays = {f"uv{k}": np.round(corner_uv(k) * 65535.0).astype(np.uint16) for k in range(3)}
    np.savez_compressed(Path(sys.argv[1]), **arrays, **head_maps(), **cloth_maps())


def grid() -> tuple[np.ndarray, np.ndarray]:
    """Angle [rad] and height [m] of the pixels of the head chart, ``[SIDE / 2, SIDE]``."""
    column, row = np.meshgrid(np.arange(SIDE) + 0.5, np.arange(SIDE // 2) + 0.5)
    return (column / SIDE - 0.5) * 2.0 * np.pi, HEAD_LOW + HEAD_TALL * (1.0 - row / (SIDE // 2))


def head_maps() -> dict[str, np.ndarray]:
    """Detail maps of the head: shade (128 is 1), and shares (255 is 1) of features."""
    a, z = grid()
    side = np.abs(a)
    fine, coarse = (periodic_noise(name, n, 3, SIDE)[: SIDE // 2] for name, n in (("pores", 128), ("mottle", 12)))
    shade = 1.0 + 0.05 * (fine - 0.5) + 0.06 * (coarse - 0.5) + curvature_map()
    bow = 0.0055 - 0.0022 * np.exp(-((side / 0.035) ** 2)) + 0.0012 * np.exp(-(((side - 0.06) / 0.03) ** 2))
    taper = np.clip(1.0 - (side / 0.245) ** 2, 0.0, 1.0)
    up = soft(MOUTH + bow * taper - z, 0.0012) * soft(z - MOUTH + 0.0005, 0.0012)
    low = soft(z - (MOUTH - 0.0095 * np.sqrt(taper)), 0.0012) * soft(MOUTH - z, 0.0012)
    lips = np.maximum(up, 0.85 * low) * (side < 0.245)
    line = np.exp(-(((z - MOUTH) / 0.0012) ** 2)) * (side < 0.25)
    nostril = np.exp(-(((side - 0.075) / 0.028) ** 2) - ((z - 0.5435 - 1.0) / 0.0022) ** 2)
    arch = BROW + 0.0045 * np.clip((side - 0.12) / 0.22, 0, 1) - 0.010 * np.clip((side - 0.34) / 0.2, 0, 1)
    thick = 0.0042 * np.clip(1.25 - (side - 0.10) / 0.42, 0.15, 1.0)
    hairs = periodic_noise("brow", 128, 1, SIDE)[: SIDE // 2]
    brows = soft(thick - np.abs(z - arch), 0.0015) * soft(side - 0.11, 0.02) * soft(0.54 - side, 0.03)
    brows *= 0.55 + 0.6 * hairs
    cheek = np.exp(-(((side - 0.42) / 0.16) ** 2) - ((z - 1.556) / 0.018) ** 2)
    tip = np.exp(-((side / 0.10) ** 2) - ((z - NOSE - 0.002) / 0.012) ** 2)
    jaw = soft(1.532 - z, 0.010) * soft(1.15 - side, 0.12) * soft(z - 1.462, 0.01)
    lip_gap = soft(np.maximum(np.abs(z - MOUTH) - 0.010, side - 0.27), 0.003)
    mustache = np.exp(-(((z - 1.534) / 0.006) ** 2)) * soft(0.30 - side, 0.04)
    beard = np.maximum(jaw, mustache) * lip_gap * (0.7 + 0.5 * hairs)
    sideburn = soft(1.0 - np.abs(side - 1.25) / 0.12, 0.3) * soft(z - 1.54, 0.02) * soft(1.66 - z, 0.02)
    wrinkle = np.exp(-(((z - HAIRLINE + 0.012 + 0.009 * np.round((z - HAIRLINE) / 0.009)) / 0.0012) ** 2))
    wrinkles = 0.0 * z
    for height in (1.630, 1.639, 1.648):
        wrinkles += np.exp(-(((z - height - 0.002 * np.cos(4 * side)) / 0.0010) ** 2)) * soft(0.5 - side, 0.1)
    fold = 0.16 + 2.6 * (1.552 - z)
    wrinkles += 0.9 * np.exp(-(((side - fold) / 0.018) ** 2)) * soft(1.555 - z, 0.003) * soft(z - 1.515, 0.004)
    bag = np.exp(-(((z - 1.5755 + 0.010 * (side - 0.3) ** 2 * 9) / 0.0016) ** 2)) * soft(
        0.19 - np.abs(side - 0.3), 0.04
    )
    lashes = lash_map()
    return {
        "shade": packed(0.5 * (shade - 0.30 * line - 0.55 * nostril)),
        "lips": packed(lips),
        "brows": packed(brows),
        "blush": packed(np.maximum(cheek, 0.8 * tip)),
        "beard": packed(np.maximum(beard, 0.6 * sideburn) * (wrinkle >= 0.0)),
        "wrinkles": packed(wrinkles + 0.7 * bag),
        "lashes": packed(lashes),
    }


def soft(value: np.ndarray, width: float) -> np.ndarray:
    """0 below ``-width``, 1 above ``width``, smooth between."""
    share = np.clip(0.5 + 0.5 * value / width, 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


def packed(share: np.ndarray) -> np.ndarray:
    """Shares from 0 to 1 as bytes."""
    return np.round(255.0 * np.clip(share, 0.0, 1.0)).astype(np.uint8)


def curvature_map() -> np.ndarray:
    """How much lighter or darker hollows and edges of the head are, from the mesh."""
    level = shapes().levels[0]
    mean, faces = level.rest[-1], level.faces[(level.face_part == 0) & (level.face_region != 5)]
    total, count = np.zeros_like(mean), np.zeros(len(mean))
    for i, j in ((0, 1), (1, 2), (2, 0)):
        for p, q in ((faces[:, i], faces[:, j]), (faces[:, j], faces[:, i])):
            np.add.at(total, p, mean[q] - mean[p])
            np.add.at(count, p, 1)
    flat = np.cross(mean[faces[:, 1]] - mean[faces[:, 0]], mean[faces[:, 2]] - mean[faces[:, 0]])
    normal = np.zeros_like(mean)
    for k in range(3):
        np.add.at(normal, faces[:, k], flat)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    step = total / np.maximum(count, 1)[:, None]
    bend = np.sum(step * normal, axis=1)  # positive in hollows
    used = np.unique(faces)
    used = used[mean[used, 2] > HEAD_LOW]
    away = mean[used] - (HEAD_AXIS, 0.0, mean[used, 2].mean())
    outward = np.sum(normal[used, :2] * away[:, :2], axis=1) > -0.01
    used = used[outward]
    a, z = grid()
    place = np.column_stack([np.arctan2(mean[used, 1], mean[used, 0] - HEAD_AXIS), mean[used, 2] * 9.0])
    place = np.concatenate([place + (turn, 0.0) for turn in (-2 * np.pi, 0.0, 2 * np.pi)])
    value = griddata(place, np.tile(bend[used], 3), (a, 9.0 * z), method="linear", fill_value=0.0)
    return gaussian_filter(np.clip(-20.0 * value, -0.22, 0.05), 2.0)


def lash_map() -> np.ndarray:
    """The dark line of lashes: the open edge of the skin around the eyes."""
    level = shapes().levels[0]
    mean = level.rest[-1]
    faces = level.faces[(level.face_part == 0) & (level.face_region != 5)]
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    pairs, count = np.unique(edges, axis=0, return_counts=True)
    rim = pairs[count == 1]
    middle = mean[rim].mean(axis=1)
    rim = rim[
        (np.abs(np.abs(middle[:, 1]) - 0.03) < 0.03) & (np.abs(middle[:, 2] - EYE) < 0.02) & (middle[:, 0] > 0.08)
    ]
    a, z = grid()
    result = np.zeros_like(a)
    for i, j in rim:
        for share in np.linspace(0.0, 1.0, 9):
            p = mean[i] + share * (mean[j] - mean[i])
            angle = np.arctan2(p[1], p[0] - HEAD_AXIS)
            upper = p[2] > EYE - 0.001
            spot = np.exp(-((0.1 * (a - angle)) ** 2 + (z - p[2]) ** 2) / (0.0016 if upper else 0.0010) ** 2)
            result = np.maximum(result, spot * (0.95 if upper else 0.5))
    return result


def cloth_maps() -> dict[str, np.ndarray]:
    """Fine structure of hair, cloth and bare skin, 128 is 1."""
    streak = periodic_noise("strand", 4, 1, 256)
    wave = np.interp(np.arange(256), np.arange(256), streak.mean(axis=1))
    strands = np.random.Generator(np.random.Philox(7)).uniform(0.0, 1.0, 128)
    strands = 0.6 * strands + 0.4 * np.roll(strands, 1)
    hair = 0.55 + 0.65 * strands[None, :] + 0.25 * (streak[:128, :128] - 0.5) + 0.1 * (wave[:128, None] - 0.5)
    fold = periodic_noise("fold", 6, 4, 256)
    skin = 1.0 + 0.10 * (periodic_noise("skin", 24, 4, 128) - 0.5)
    return {"hair": packed(0.5 * hair), "folds": packed(fold), "bare": packed(0.5 * skin)}


if __name__ == "__main__":
    main()
