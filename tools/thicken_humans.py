"""Make assets/humans/offsets.npz: how far coarse bodies move outward to be as thick as the finest.

Decimation makes limbs thin. The vertices of a coarse level are moved along their normals until the signed distance of
the finest vertices to it is 0 on average around every vertex; this is done on the mean body and serves all bodies.
``python tools/thicken_humans.py`` writes the file and prints what it gained.
"""

from pathlib import Path

import numpy as np

from crowdbot.humans.asset import OFFSET_UNIT, SOLID_PARTS, Shapes, outward, shapes

FILE = Path(__file__).parents[1] / "src" / "crowdbot" / "assets" / "humans" / "offsets.npz"
ROUNDS, SHARE, MOST = 4, 0.8, 0.02


def main() -> None:
    """Write the file."""
    every = shapes(thick=False)
    offsets = {}
    for k in (1, 2):
        found = _offsets(every, k)
        offsets[f"lod{k}"] = np.round(found / OFFSET_UNIT).astype(np.int8)
    np.savez_compressed(FILE, **offsets)
    shapes.cache_clear()
    for label, bodies in (("before", shapes(thick=False)), ("after", shapes())):
        for k in (1, 2):
            gaps = [_gaps(bodies, k, person) for person in (0, 10, 25, 35, 40)]
            print(_line(label, k, np.concatenate(gaps)))


def _line(label: str, k: int, gaps: np.ndarray) -> str:
    size = np.abs(gaps)
    return (
        f"level {k} {label}: mean {1000 * gaps.mean():.1f} mm,"
        f" mean size {1000 * size.mean():.1f} mm, 95 % below {1000 * np.quantile(size, 0.95):.1f} mm"
    )


def _solid(every: Shapes, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Faces of a level and vertices of the finest that are skin or cloth, without hair and skirt."""
    return (
        every.levels[k].faces[np.isin(every.levels[k].face_part, SOLID_PARTS)],
        np.isin(every.levels[0].vertex_part, SOLID_PARTS),
    )


def _gaps(every: Shapes, k: int, person: int) -> np.ndarray:
    faces, fine = _solid(every, k)
    return _nearest(every.levels[0].rest[person, fine], every.levels[k].rest[person], faces)[1]


def _offsets(every: Shapes, k: int) -> np.ndarray:
    faces, fine = _solid(every, k)
    points, rest = every.levels[0].rest[-1, fine], every.levels[k].rest[-1]
    found = np.zeros(len(rest))
    for _ in range(ROUNDS):
        face, gap = _nearest(points, rest + found[:, None] * outward(rest[None], faces)[0], faces)
        total, count = np.zeros(len(rest)), np.full(len(rest), 1e-9)
        for corner in range(3):
            np.add.at(total, faces[face, corner], gap)
            np.add.at(count, faces[face, corner], 1.0)
        found += SHARE * np.clip(total / count, -MOST, MOST)
    return found


def _nearest(points: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The nearest face of every point, and the distance to it, above 0 outside."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    face, gap = np.zeros(len(points), dtype=np.int64), np.zeros(len(points))
    for first in range(0, len(points), 256):
        part = points[first : first + 256, None]
        away = np.min(
            [_to_plane(part, a, b, c), _to_edge(part, a, b), _to_edge(part, b, c), _to_edge(part, c, a)], axis=0
        )
        best = away.argmin(axis=1)
        rows = np.arange(len(best))
        side = np.sign(((part[:, 0] - a[best]) * normal[best]).sum(-1))
        face[first : first + 256], gap[first : first + 256] = best, side * away[rows, best]
    return face, gap


def _to_plane(p: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Distance to the inside of every triangle, infinite where the foot point lies outside."""
    ab, ac, ap = b - a, c - a, p - a
    d00, d01, d11 = (ab * ab).sum(-1), (ab * ac).sum(-1), (ac * ac).sum(-1)
    d1, d2 = (ap * ab).sum(-1), (ap * ac).sum(-1)
    whole = d00 * d11 - d01**2 + 1e-18
    v, w = (d11 * d1 - d01 * d2) / whole, (d00 * d2 - d01 * d1) / whole
    away = np.linalg.norm(ap - v[..., None] * ab - w[..., None] * ac, axis=-1)
    return np.where((v >= 0) & (w >= 0) & (v + w <= 1), away, np.inf)


def _to_edge(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    edge = b - a
    t = np.clip(((p - a) * edge).sum(-1) / ((edge**2).sum(-1) + 1e-18), 0.0, 1.0)
    return np.linalg.norm(p - a - t[..., None] * edge, axis=-1)


if __name__ == "__main__":
    main()
