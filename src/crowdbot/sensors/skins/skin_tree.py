"""SkinTree: the triangles of each person, sorted once into the leaves of a balanced tree of boxes."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Skins, kernel, prange
from crowdbot.typing import Floats, Ints

MOST = 6
"""Largest number of triangles of a leaf."""


class SkinTree(NamedTuple):
    """Trees over F triangles of M people; they depend on the topology only, and their boxes follow the vertices.

    The tree of a person is complete: node 1 is the root, nodes 2 i and 2 i + 1 are below node i, and the leaves are the
    last nodes. Each leaf holds an equal share of the triangles.

    Fields:
        faces, owner: of the skins, ``[F, 3]`` and ``[F]``.
        order: ``[F]`` index of the triangle in each slot; the slots of a person are consecutive.
        corner: ``[F, 3]`` vertices of the triangle in each slot.
        person: ``[M]`` owner of each tree.
        begin: ``[M + 1]`` first slot.
        leaves: ``[M]`` number of leaves, a power of two.
        node: ``[M + 1]`` first node.
        low, high: ``[M]`` range of vertices, both included.
        ready: ``[M]`` whether the triangles are sorted.
    """

    faces: Ints
    owner: Ints
    order: Ints
    corner: NDArray[np.int32]
    person: Ints
    begin: Ints
    leaves: Ints
    node: Ints
    low: Ints
    high: Ints
    ready: NDArray[np.bool_]


def plant_tree(skins: Skins) -> SkinTree:
    """Return the trees of all owners of ``skins`` with unsorted triangles.

    >>> skins = Skins.of(np.eye(3), [[0, 1, 2], [2, 1, 0], [0, 1, 2]], owner=[4, -1, 4])
    >>> tree = plant_tree(skins)
    >>> tree.person.tolist(), tree.order.tolist(), tree.begin.tolist()
    ([-1, 4], [1, 0, 2], [0, 1, 3])
    """
    order = np.argsort(skins.owner, kind="stable")
    person, first = np.unique(skins.owner[order], return_index=True)
    begin = np.append(first, len(order)).astype(np.int64)
    size = np.diff(begin)
    leaves = np.array([1 << max(0, int(-(-n // MOST) - 1).bit_length()) for n in size.tolist()], dtype=np.int64)
    corner = skins.faces[order].astype(np.int32)
    low = np.array([corner[a:b].min() for a, b in itertools.pairwise(begin)], dtype=np.int64)
    high = np.array([corner[a:b].max() for a, b in itertools.pairwise(begin)], dtype=np.int64)
    node = np.concatenate([[0], np.cumsum(2 * leaves)]).astype(np.int64)
    ready = np.zeros(len(person), dtype=np.bool_)
    return SkinTree(skins.faces, skins.owner, order, corner, person, begin, leaves, node, low, high, ready)


@kernel
def _longest_axis(centre: Floats, chosen: Ints) -> int:
    """Return the axis along which the chosen points extend most."""
    best, axis = -1.0, 0
    for c in range(3):
        low, high = np.inf, -np.inf
        for i in chosen:
            low, high = min(low, centre[i, c]), max(high, centre[i, c])
        if high - low > best:
            best, axis = high - low, c
    return axis


@kernel
def _sort_person(p: int, points: Floats, tree: SkinTree) -> None:
    """Halve the triangles of a person along the longest axis, again and again; absent ones are left as they are."""
    begin, size, leaves = tree.begin[p], tree.begin[p + 1] - tree.begin[p], tree.leaves[p]
    centre = np.empty((size, 3))
    for i in range(size):
        for c in range(3):
            corner = tree.corner[begin + i]
            centre[i, c] = points[corner[0], c] + points[corner[1], c] + points[corner[2], c]
            if not abs(centre[i, c]) < np.inf:
                return
    place, width = np.arange(size), leaves
    while width > 1:
        for part in range(leaves // width):
            a, b = part * width * size // leaves, (part + 1) * width * size // leaves
            chosen = place[a:b].copy()
            place[a:b] = chosen[np.argsort(centre[chosen, _longest_axis(centre, chosen)], kind="mergesort")]
        width //= 2
    order, corner = tree.order[begin : begin + size].copy(), tree.corner[begin : begin + size].copy()
    for i in range(size):
        tree.order[begin + i] = order[place[i]]
        tree.corner[begin + i] = corner[place[i]]
    tree.ready[p] = True


@kernel(parallel=True)
def sort_triangles(points: Floats, tree: SkinTree) -> None:
    """Sort the triangles of people whose vertices ``[V, 3]`` are all known and that are not sorted yet."""
    for p in prange(len(tree.person)):
        if not tree.ready[p]:
            _sort_person(p, points, tree)
