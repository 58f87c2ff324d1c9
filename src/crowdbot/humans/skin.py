"""Linear blend skinning of posed people, with up to four bones per vertex."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Floats, Ints


class SkinnedMesh(NamedTuple):
    """Rest shapes ``rest [P, V, 3]`` [m] of one topology, with ``bones [V, 4]`` and ``weights [V, 4]`` (sum 1)."""

    rest: Floats
    bones: Ints
    weights: Floats


@kernel
def _skin(
    rest: Floats, bones: Ints, weights: Floats, body: Ints, scale: Floats, rotation: Floats, shift: Floats, out: Floats
) -> None:
    """Write ``sum_k w_k (R_k x + t_k)`` for each vertex x of each person."""
    for i in range(len(out)):
        for v in range(bones.shape[0]):
            x = rest[body[i], v, 0] * scale[i]
            y = rest[body[i], v, 1] * scale[i]
            z = rest[body[i], v, 2] * scale[i]
            sx, sy, sz = 0.0, 0.0, 0.0
            for k in range(bones.shape[1]):
                w = weights[v, k]
                if w == 0.0:
                    continue
                b = bones[v, k]
                r = rotation[i, b]
                sx += w * (r[0, 0] * x + r[0, 1] * y + r[0, 2] * z + shift[i, b, 0])
                sy += w * (r[1, 0] * x + r[1, 1] * y + r[1, 2] * z + shift[i, b, 1])
                sz += w * (r[2, 0] * x + r[2, 1] * y + r[2, 2] * z + shift[i, b, 2])
            out[i, v, 0], out[i, v, 1], out[i, v, 2] = sx, sy, sz


def skin_vertices(
    mesh: SkinnedMesh, body: Ints, scale: Floats, head: Floats, rotation: Floats, position: Floats
) -> Floats:
    """Return the vertices ``[N, V, 3]`` [m] of posed people.

    Args:
        mesh: rest shapes and weights.
        body: row of the rest shape ``[N]``.
        scale: ratio of stature to that of the rest shape ``[N]``.
        head: scaled start of each bone at rest ``[N, B, 3]`` [m].
        rotation, position: current rotation ``[N, B, 3, 3]`` and position ``[N, B, 3]`` [m] of each bone.
    """
    shift = position - np.einsum("nbij,nbj->nbi", rotation, head)
    out = np.empty((len(body), len(mesh.bones), 3))
    _skin(mesh.rest, mesh.bones, mesh.weights, body, scale, rotation, shift, out)
    return out
