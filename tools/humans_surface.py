"""What is seen of a body: skin of head and hands, clothes with straight hems, shoes with soles, a skirt, cuts of hair.

All is made on the mean of the adults and holds for everyone, because every vertex is a mixture of base vertices.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from humans_bodies import BONES, Bodies
from humans_mesh import Mesh, cut, mesh, snapped
from humans_thick import normals

REGIONS = ("skin", "scalp", "top", "bottom", "shoes", "eyes", "hair", "skirt", "forearm", "shin", "upperarm")
SKIN, SCALP, TOP, BOTTOM, SHOES, EYES, HAIR, SKIRT, FOREARM, SHIN, UPPERARM = range(11)
LINING = 11
"""Becomes top; until then the edge of the collar is a line that the thinning keeps."""
WELT, TREAD = 0.003, 0.007
"""Shoes are so much wider than socks [m], and flat below so high; both for a stature of 1.7 m."""
COLLAR = (0.03, -0.025)
"""Height of the collar behind and in front, over the lower joint of the neck [m], on the mean body."""
UNDER = 0.03
"""Skin goes on so far under the cloth [m] and is drawn in there, so that it does not come through."""
WAIST = -0.025
"""Height of the hem of the top over the hip joints [m]."""
HEM = 0.285
"""Skirts end at this share of stature, about the knee: longer ones would not let the legs walk."""
SHORT, LONG = 0.013, 0.021
"""Thickness of short and long hair [m]."""
CURTAIN = ((19, 9), (11, 5), (7, 3))
"""Columns and rows of the hair that hangs down, by level of detail."""


@dataclass(frozen=True)
class Piece:
    """A mesh whose vertices are ``mixed base vertices + offset``, moved along their normals by ``out`` [m].

    ``weight [V, B]`` of the bones; ``care [V]`` for the thinning.
    """

    mesh: Mesh
    weight: np.ndarray
    care: np.ndarray
    out: np.ndarray
    offset: np.ndarray

    def shaped(self, vertex: np.ndarray) -> np.ndarray:
        """Places ``[P, V, 3]`` for base vertices ``[P, N, 3]`` [m]."""
        tall = vertex[:, :13380, 2].max(axis=1)[:, None, None] / 1.7
        place = self.mesh.of(vertex) + tall * self.offset
        place = place + tall * self.out[:, None] * normals(place, self.mesh.faces)
        sole = np.isin(np.arange(place.shape[1]), self.mesh.faces[self.mesh.label == SHOES])
        if sole.any():
            z = place[..., 2]
            flat = np.clip((z / tall[..., 0] - TREAD) * 0.035 / (0.035 - TREAD), 0.0, None) * tall[..., 0]
            place[..., 2] = np.where(sole & (z < 0.035 * tall[..., 0]), flat, z)
        return place


def _piece(m: Mesh, b: Bodies, care: np.ndarray | None = None, out: np.ndarray | None = None) -> Piece:
    count = len(m.rows)
    return Piece(
        m,
        m.of(b.weight),
        np.ones(count) if care is None else care,
        np.zeros(count) if out is None else out,
        np.zeros((count, 3)),
    )


def above_collar(place: np.ndarray, joint: dict[str, np.ndarray]) -> np.ndarray:
    """Height [m] over the collar, which is a slanting plane; -1 far from the neck."""
    neck = joint["neck_01"]
    share = np.clip((place[:, 0] - neck[0] + 0.06) / 0.14, 0.0, 1.0)
    line = neck[2] + COLLAR[0] + (COLLAR[1] - COLLAR[0]) * share
    line -= 0.012 * np.clip(np.abs(place[:, 1]) / 0.07, 0.0, 1.0) ** 2
    return np.where(np.abs(place[:, 1]) < 0.14, place[:, 2] - line, -1.0)


def cloth(b: Bodies, mean: np.ndarray, joint: dict[str, np.ndarray]) -> Piece:
    """Top, trousers and shoes as one closed surface, cut at every hem."""
    m = mesh(b.faces["helper-tights"], mean, TOP)
    shoulder, knee, ankle = joint["upperarm_l"], joint["calf_l"], joint["foot_l"]
    waist = joint["thigh_l"][2] + WAIST

    def line(value_of, old: tuple[int, ...], new: int) -> None:
        nonlocal m
        value = value_of(m.of(mean), m.of(b.weight))
        m = cut(m, snapped(m, value), old, new)

    def arms(w: np.ndarray) -> np.ndarray:
        bones = [f"{n}_{s}" for s in "lr" for n in ("upperarm", "lowerarm", "hand", "fingers_01")]
        return w[:, [BONES.index(name) for name in bones]].sum(axis=1)

    def body_side(p: np.ndarray, w: np.ndarray) -> np.ndarray:
        return np.where(arms(w) > 0.3, -1.0, waist - p[:, 2])

    def below(height: float):
        return lambda p, w: height - p[:, 2]

    def on_arm(share: float):
        def value(p: np.ndarray, w: np.ndarray) -> np.ndarray:
            away = []
            for side in (1.0, -1.0):
                flip = np.array([1.0, side, 1.0])
                start, end = shoulder * flip, joint["lowerarm_l"] * flip
                axis = end - start
                t = ((p - start) @ axis) / (axis @ axis) - share
                away.append(np.where(side * p[:, 1] > 0.0, t, -1.0))
            return np.where(arms(w) > 0.5, np.maximum(*away), -1.0)

        return value

    def armless(p: np.ndarray, w: np.ndarray) -> np.ndarray:
        return np.where(p[:, 2] > shoulder[2] - 0.25, np.abs(p[:, 1]) - shoulder[1] - 0.012, -1.0)

    line(body_side, (TOP,), BOTTOM)
    line(below(knee[2] + 0.055), (BOTTOM,), SHIN)
    line(below(ankle[2] + 0.012), (SHIN,), SHOES)
    line(armless, (TOP,), UPPERARM)
    line(on_arm(0.62), (TOP, UPPERARM), FOREARM)
    line(lambda p, w: above_collar(p, joint), (TOP,), -1)
    m = m.picked(m.label >= 0)
    out = np.where(np.isin(np.arange(len(m.rows)), m.faces[m.label == SHOES]), WELT, 0.0)
    return _lined(_piece(m, b, out=out), mean, joint, b)


def _lined(piece: Piece, mean: np.ndarray, joint: dict[str, np.ndarray], b: Bodies) -> Piece:
    """The same with a ring inside the collar that leads to the neck, so that nobody sees through beside it."""
    m, place = piece.mesh, piece.mesh.of(mean)
    edges = np.concatenate([m.faces[:, [0, 1]], m.faces[:, [1, 2]], m.faces[:, [2, 0]]])
    _, first, often = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    rim = edges[first[often == 1]]
    rim = rim[np.abs(place[rim, 1]).max(axis=1) < 0.2]  # the others are sleeves
    used, index = np.unique(rim, return_inverse=True)
    pair = index.reshape(-1, 2) + len(m.rows)
    ring = np.concatenate([rim[:, [1, 0]], pair[:, :1]], 1), np.stack([rim[:, 1], pair[:, 0], pair[:, 1]], 1)
    faces = np.concatenate([m.faces, *ring])
    middle = place[used].mean(axis=0)
    inward = (middle - place[used]) * [0.3, 0.3, 0.0] - [0.0, 0.0, 0.012]
    m = Mesh(
        np.concatenate([m.rows, m.rows[used]]),
        np.concatenate([m.shares, m.shares[used]]),
        faces,
        np.concatenate([m.label, np.full(2 * len(rim), LINING)]),
    )
    out = np.concatenate([piece.out, np.zeros(len(used))])
    return replace(_piece(m, b, out=out), offset=np.concatenate([piece.offset, inward]))


def skin(b: Bodies, mean: np.ndarray, joint: dict[str, np.ndarray]) -> Piece:
    """Head, neck and hands as far as the clothes do not cover them, and the eyes."""
    from scipy.spatial import cKDTree

    tights = mesh(b.faces["helper-tights"], mean, TOP)
    edges = np.sort(np.concatenate([tights.faces[:, [0, 1]], tights.faces[:, [1, 2]], tights.faces[:, [2, 0]]]), axis=1)
    single, often = np.unique(edges, axis=0, return_counts=True)
    rim = np.isin(np.arange(len(tights.rows)), single[often == 1])
    m = mesh(b.faces["body"], mean, SKIN)
    place = m.of(mean)
    distance, near = cKDTree(tights.of(mean)).query(place)
    sleeve = cKDTree(tights.of(mean)[rim]).query(place)[0]
    hand = np.where(np.abs(place[:, 1]) > 0.38, np.where(rim[near], distance, -sleeve), -1.0)
    bare = np.maximum(above_collar(place, joint), hand)
    head = place[:, 2] > joint["head"][2]
    bare[head] = np.maximum(bare[head], 0.0)
    keep = (bare > -UNDER)[m.faces].any(axis=1)
    drawn_in = -0.006 * np.clip((-bare - 0.004) / 0.02, 0.0, 1.0)
    m = Mesh(m.rows, m.shares, m.faces, np.where(keep, SKIN, -1))
    used = np.unique(m.faces[keep])
    m, drawn_in = m.picked(keep), drawn_in[used]
    hidden = np.ones(len(m.rows), dtype=bool)
    hidden[m.faces[_outside(m.of(mean), m.faces)]] = False
    value = scalp(m.of(mean))
    m = cut(m, snapped(m, value), (SKIN,), SCALP)
    for side in "lr":
        eye = mesh(b.faces[f"helper-{side}-eye"], mean, EYES)
        front = eye.of(mean)[eye.faces].mean(axis=1)[:, 0] > eye.of(mean)[:, 0].mean() + 0.004
        m = joined(m, eye.picked(front))
    place = m.of(mean)
    care = np.where(place[:, 2] > 1.3, np.where(place[:, 0] > 0.09, 4.0, 1.5), 0.7)
    care[: len(hidden)][hidden] = 0.02  # the inside of the mouth
    return _piece(m, b, care, np.concatenate([drawn_in, np.zeros(len(m.rows) - len(drawn_in))]))


def _outside(place: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Whether a face can be seen from somewhere around: the inside of the mouth cannot."""
    import trimesh

    shape = trimesh.Trimesh(place, faces, process=False)
    middle, normal = shape.triangles_center, shape.face_normals
    seen = np.zeros(len(faces), dtype=bool)
    golden = np.arange(24) + 0.5
    z, turn = 1 - 2 * golden / 24, golden * 2.399963
    for way in np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], axis=1):
        todo = np.flatnonzero(~seen & (normal @ way > 0.1))
        if len(todo):
            hit = shape.ray.intersects_any(middle[todo] + 1e-4 * normal[todo], np.tile(way, (len(todo), 1)))
            seen[todo[~hit]] = True
    return seen


def scalp(place: np.ndarray) -> np.ndarray:
    """Above 0 where hair grows, [m] from the hair line, on the mean head."""
    head = place[place[:, 2] > 1.3]
    top, front, back = head[:, 2].max(), head[:, 0].max() - 0.02, head[head[:, 2] > 1.5][:, 0].min()
    x, y, z = place.T
    share = np.clip((x - back) / (front - back), 0.0, 1.0)
    line = np.interp(share, [0.0, 0.25, 0.45, 0.62, 0.72, 1.0], [0.185, 0.165, 0.115, 0.105, 0.062, 0.048])
    ear = (((x - 0.5 * (front + back) + 0.0) / 0.032) ** 2 + ((z - top + 0.132) / 0.045) ** 2) ** 0.5 - 1.0
    value = np.minimum(z - (top - line), np.where(np.abs(y) > 0.05, 0.03 * ear, 1.0))
    return np.where(z > 1.3, value, -1.0)


def joined(one: Mesh, two: Mesh) -> Mesh:
    """Two meshes as one."""
    return Mesh(
        np.concatenate([one.rows, two.rows]),
        np.concatenate([one.shares, two.shares]),
        np.concatenate([one.faces, two.faces + len(one.rows)]),
        np.concatenate([one.label, two.label]),
    )


def hair(b: Bodies, head: Piece, mean: np.ndarray, thick: float) -> Piece:
    """Hair as a shell over the scalp, thin at its line."""
    m = head.mesh.picked(head.mesh.label == SCALP)
    m = Mesh(m.rows, m.shares, m.faces, np.full(len(m.faces), HAIR))
    grown = np.clip(scalp(m.of(mean)) / 0.035, 0.0, 1.0)
    return _piece(m, b, out=0.0015 + (thick - 0.0015) * grown * (2.0 - grown))


def skirt(b: Bodies, mean: np.ndarray, joint: dict[str, np.ndarray]) -> Piece:
    """A skirt from the hem of the top to the knee."""
    m = mesh(b.faces["helper-skirt"], mean, SKIRT)
    value = HEM * mean[:13380, 2].max() - m.of(mean)[:, 2]
    m = cut(m, snapped(m, value), (SKIRT,), -1)
    value = m.of(mean)[:, 2] - joint["thigh_l"][2] - WAIST
    m = cut(m, snapped(m, value), (SKIRT,), -1)
    return _piece(m.picked(m.label == SKIRT), b)


def curtain(b: Bodies, mean: np.ndarray, neck: float, level: int) -> Piece:
    """Long hair from ear to ear down to the shoulders: two layers that close at the hem."""
    from scipy.spatial import cKDTree

    columns, rows = CURTAIN[level]
    used = np.unique(np.concatenate([b.faces["body"].ravel(), b.faces["helper-tights"].ravel()]))
    used = used[mean[used, 2] > neck - 0.25]
    points = mean[used]
    head = points[points[:, 2] > neck + 0.06]
    axis = np.array([0.5 * (head[:, 0].max() + head[:, 0].min()) - 0.015, 0.0])
    top = points[:, 2].max()
    angle = np.pi + np.linspace(-1.72, 1.72, columns)
    side = np.abs(angle - np.pi) / 1.72
    height = np.linspace(np.full(columns, top - 0.075), neck - 0.02 + 0.05 * side**2, rows)
    flat = points[:, :2] - axis
    turn, far = np.arctan2(flat[:, 1], flat[:, 0]), np.linalg.norm(flat, axis=1)
    radius = np.zeros((rows, columns))
    for r in range(rows):
        for c, a in enumerate(angle):
            z = height[r, c]
            close = (np.abs(points[:, 2] - z) < 0.022) & (np.abs(np.angle(np.exp(1j * (turn - a)))) < 0.16)
            close &= (np.abs(flat[:, 1]) < 0.078) & (
                (points[:, 2] > neck + 0.06) | (side[c] < 0.45)
            )  # no ears, shoulders
            radius[r, c] = far[close].max(initial=0.0)
        if r:
            radius[r] = np.maximum(radius[r], radius[r - 1] * (0.99 - 0.02 * side))
    edge = np.minimum(1.0, (1.0 - side) / 0.3)
    outer = radius + 0.005 + 0.015 * edge * np.sin(np.pi * np.linspace(0.0, 0.85, rows))[:, None]
    ring = []
    for layer in (outer, outer - 0.006 - 0.008 * edge):
        x = axis[0] + layer * np.cos(angle)
        y = layer * np.sin(angle)
        ring.append(np.stack([x, y, height], axis=-1))
    place = np.stack(ring).reshape(-1, 3)
    faces = _sheet(rows, columns)
    distance, index = cKDTree(points).query(place, k=4)
    share = 1.0 / (distance + 0.01)
    share /= share.sum(axis=1, keepdims=True)
    m = Mesh(used[index], share, faces, np.full(len(faces), HAIR))
    down = np.tile(np.repeat(np.linspace(0.0, 1.0, rows), columns), 2)
    weight = np.zeros((len(place), len(BONES)))
    weight[:, BONES.index("head")] = 1.0 - 0.45 * down**2
    weight[:, BONES.index("spine_03")] = 0.45 * down**2
    count = len(place)
    offset = (place - m.of(mean)) * 1.7 / mean[:13380, 2].max()
    return Piece(m, weight, np.ones(count), np.zeros(count), offset)


def _sheet(rows: int, columns: int) -> np.ndarray:
    """Triangles of an outer and an inner grid, closed along the border."""
    size, faces = rows * columns, []
    for r in range(rows - 1):
        for c in range(columns - 1):
            a = r * columns + c
            quad = [a, a + columns, a + columns + 1, a + 1]
            faces += [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]
            faces += [
                [size + quad[0], size + quad[2], size + quad[1]],
                [size + quad[0], size + quad[3], size + quad[2]],
            ]
    border = [(r * columns, (r + 1) * columns) for r in range(rows - 1)]
    border += [((rows - 1) * columns + c, (rows - 1) * columns + c + 1) for c in range(columns - 1)]
    border += [((r + 1) * columns + columns - 1, r * columns + columns - 1) for r in range(rows - 2, -1, -1)]
    for a, b in border:
        faces += [[b, a, size + a], [b, size + a, size + b]]
    return np.array(faces)
