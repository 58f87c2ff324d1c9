"""Trees of arrays: count, check, select, join and replace their environments.

A tree is a nest of dataclasses, tuples, lists and dicts. Its leaves are arrays, whose first axis is the environments,
and numbers, texts and None, which belong to all environments. The class variable ``shared_fields`` of a dataclass names
its fields without environments. Functions return new trees and leave their arguments as they are.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
import itertools
import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError

__all__ = ["check", "count", "environment_index", "join", "put", "resize", "take"]

Ints = NDArray[np.int64]
Tree = TypeVar("Tree")
NUMBERS = (bool, int, float, np.bool_, np.number)
LEAVES = (type(None), str, bytes, complex, enum.Enum, *NUMBERS)


def environment_index(chosen: ArrayLike, count: int | None, name: str) -> Ints:
    """Indices of environments as an array.

    Raises:
        InputError: an index is not a whole number from 0 to ``count - 1``.

    >>> environment_index([2, 0], 3, "state").tolist()
    [2, 0]
    """
    index = np.asarray(chosen)
    if index.ndim != 1 or (index.size and index.dtype.kind not in "iu"):
        raise InputError(f"{name}: the environments must be a list of whole numbers, but they are {chosen!r}")
    index = index.astype(np.int64, copy=False)
    if index.size and (index.min() < 0 or (count is not None and index.max() >= count)):
        allowed = "at least 0" if count is None else f"from 0 to {count - 1}"
        raise InputError(f"{name}: the environments are {index.tolist()}, each must be {allowed}")
    return index


def count(tree: Any, name: str = "tree") -> int | None:
    """Count the environments; None for a tree without arrays.

    Raises:
        InputError: the first axes of the arrays differ, or an object is not a tree.

    >>> count((0.5, np.zeros((3, 2)))), count(None)
    (3, None)
    """
    arrays = _arrays(tree, (name,))
    for path, array in arrays[1:]:
        if len(array) != len(arrays[0][1]):
            raise InputError(
                f"{_text(path)} has shape {list(array.shape)} but {_text(arrays[0][0])} has {len(arrays[0][1])}"
                " environments; the first axis must be the environments, or the class must list the field in"
                " shared_fields"
            )
    return len(arrays[0][1]) if arrays else None


def check(tree: Any, environments: int, name: str) -> None:
    """Raise :class:`InputError` unless every array has this number of environments."""
    for path, array in _arrays(tree, (name,)):
        if len(array) != environments:
            raise InputError(
                f"{_text(path)} has shape {list(array.shape)} in {environments} environments; the first axis must be"
                " the environments, or the class must list the field in shared_fields"
            )


def take(tree: Tree, index: Ints | slice) -> Tree:
    """Copy the environments ``index``, in this order; an environment may be repeated.

    >>> take({"time": 0.5, "speed": np.array([1.0, 2.0, 3.0])}, np.array([2, 0]))["speed"].tolist()
    [3.0, 1.0]
    """
    if isinstance(index, slice):
        return cast(Tree, _map(lambda array, _: array[index].copy(), tree))
    return cast(Tree, _map(lambda array, _: array[index], tree))


def join(trees: Sequence[Tree], places: Sequence[Ints | slice] | None = None, environments: int | None = None) -> Tree:
    """Join trees of some environments to one of all.

    Numbers that differ become an array over the environments. A tree without arrays has its numbers everywhere.

    Args:
        trees: trees of one structure.
        places: environments of each tree; a later tree wins (default: one after the other).
        environments: number of environments of the result, given with ``places``.

    Raises:
        TypeError: the structures differ, such as None and an array.

    >>> join([np.array([5.0]), np.array([7.0, 6.0])], [np.array([1]), np.array([2, 0])], 3).tolist()
    [6.0, 5.0, 7.0]
    """
    if places is None or environments is None:
        if len(trees) == 1:
            return trees[0]
        counts = map(count, trees)
        ends = [0, *itertools.accumulate(1 if rows is None else rows for rows in counts)]
        places, environments = [slice(*ends[k : k + 2]) for k in range(len(trees))], ends[-1]
    return cast(Tree, _join(trees, places, environments))


def put(tree: Tree, index: Ints, rows: Tree, environments: int | None = None) -> Tree:
    """Replace the environments ``index`` by those of ``rows``, a tree of the same structure.

    Args:
        tree: tree of E environments.
        index: environments to replace.
        rows: their new values.
        environments: E; needed only for a tree without arrays.

    Raises:
        TypeError: the structures differ.

    >>> put({"speed": np.array([1.0, 2.0, 3.0])}, np.array([2, 0]), {"speed": np.array([8.0, 9.0])})["speed"].tolist()
    [9.0, 2.0, 8.0]
    """
    if environments is None:
        environments = count(tree)
    return join([tree, rows], [slice(None), index], 1 if environments is None else environments)


def resize(tree: Tree, agents: int, fills: Mapping[str, Any]) -> Tree:
    """Change the length of the second axis of every array to a number of agents.

    Args:
        tree: arrays ``[E, A, ...]``; arrays with one axis stay as they are.
        agents: new length.
        fills: value of new agents by field (default: 0).

    >>> resize({"group": np.array([[3]]), "time": 0.5}, 3, {"group": -1})
    {'group': array([[ 3, -1, -1]]), 'time': 0.5}
    """

    def change(array: NDArray[Any], name: str) -> NDArray[Any]:
        if array.ndim < 2 or array.shape[1] == agents:
            return array
        more = max(0, agents - array.shape[1])
        block = np.full((len(array), more, *array.shape[2:]), fills.get(name, 0), dtype=array.dtype)
        return np.concatenate([array[:, :agents], block], axis=1)

    return cast(Tree, _map(change, tree))


class _Fields(NamedTuple):
    """Fields of a dataclass: those with environments, all that a copy needs, and whether a copy needs no checks."""

    names: tuple[str, ...]
    every: tuple[str, ...]
    plain: bool


def _fields(tree: Any) -> _Fields | None:
    """Fields of a dataclass; None for another class."""
    kind: Any = type(tree)
    return _fields_of(kind)


@functools.cache
def _fields_of(kind: Any) -> _Fields | None:
    slots = any(vars(base).get("__slots__") for base in kind.__mro__)
    if not dataclasses.is_dataclass(kind):
        return None
    shared = getattr(kind, "shared_fields", ())
    fields = dataclasses.fields(kind)
    names = tuple(field.name for field in fields if field.init and field.name not in shared)
    plain = all(field.init for field in fields) and not hasattr(kind, "__post_init__") and not slots
    return _Fields(names, tuple(field.name for field in fields), plain)


def _keys(tree: Any, path: tuple[Any, ...] = ("a tree",)) -> Sequence[Any]:
    """Names or indices of the parts with environments.

    Raises:
        InputError: the object has no parts.
    """
    fields = _fields(tree)
    if fields is not None:
        return fields.names
    if isinstance(tree, tuple | list):
        return range(len(tree))
    if isinstance(tree, Mapping):
        return list(tree)
    raise InputError(
        f"{_text(path)} is a {type(tree).__name__}, which has no environments; use None, numbers, texts, arrays"
        " [E, ...], or dataclasses, tuples, lists and dicts of these, or list the field in shared_fields"
    )


def _parts(tree: Any, keys: Sequence[Any]) -> list[Any]:
    if _fields(tree) is None:
        return [tree[key] for key in keys]
    return [getattr(tree, key) for key in keys]


def _rebuild(tree: Any, keys: Sequence[Any], parts: list[Any]) -> Any:
    """Copy a container with other parts; a container whose parts are the same objects stays itself."""
    if all(map(operator.is_, parts, _parts(tree, keys))):
        return tree
    changes = dict(zip(keys, parts, strict=True))
    fields = _fields(tree)
    if fields is None:
        make: Callable[..., Any] = getattr(type(tree), "_make", type(tree))
        return changes if isinstance(tree, Mapping) else make(parts)
    if not fields.plain:
        return dataclasses.replace(tree, **changes)
    made = object.__new__(type(tree))  # ten times faster than dataclasses.replace of a frozen class with many fields
    values = vars(tree)
    vars(made).update({name: values[name] for name in fields.every} | changes)
    return made


def _map(change: Callable[[NDArray[Any], str], Any], tree: Any, name: str = "") -> Any:
    """Change all arrays with environments; ``change`` gets an array and the field or key that holds it."""
    if isinstance(tree, np.ndarray):
        return change(tree, name) if tree.ndim else tree
    if isinstance(tree, LEAVES):
        return tree
    keys = _keys(tree)
    return _rebuild(tree, keys, [_map(change, part, key) for key, part in zip(keys, _parts(tree, keys), strict=True)])


def _arrays(tree: Any, path: tuple[Any, ...]) -> list[tuple[tuple[Any, ...], NDArray[Any]]]:
    """All arrays with environments, with their paths."""
    if isinstance(tree, np.ndarray):
        return [(path, tree)] if tree.ndim else []
    if isinstance(tree, LEAVES):
        return []
    keys = _keys(tree, path)
    steps = keys if _fields(tree) is not None else [[key] for key in keys]
    return [row for step, part in zip(steps, _parts(tree, keys), strict=True) for row in _arrays(part, (*path, step))]


def _text(path: tuple[Any, ...]) -> str:
    """Path of an array in an error message, such as ``Scan.ranges`` or ``state[0]``."""
    return "".join(f".{step}" if isinstance(step, str) else f"{step}" for step in path).removeprefix(".")


def _join(trees: Sequence[Any], places: Sequence[Ints | slice], environments: int) -> Any:
    first = trees[0]
    if all(isinstance(tree, NUMBERS) or (isinstance(tree, np.ndarray) and tree.ndim > 0) for tree in trees):
        return _join_arrays(trees, places, environments)
    if any(type(tree) is not type(first) for tree in trees):
        raise TypeError(f"{type(first).__name__} and another class")
    if isinstance(first, LEAVES) or (isinstance(first, np.ndarray) and first.ndim == 0):
        if any(tree != first for tree in trees):
            raise TypeError(f"different values of {type(first).__name__}")
        return first
    keys = _keys(first)
    if any(_keys(tree) != keys for tree in trees):
        raise TypeError(f"different parts of {type(first).__name__}")
    columns = zip(*(_parts(tree, keys) for tree in trees), strict=True)
    return _rebuild(first, keys, [_join(column, places, environments) for column in columns])


def _join_arrays(trees: Sequence[Any], places: Sequence[Ints | slice], environments: int) -> Any:
    first = trees[0]
    if all(isinstance(tree, NUMBERS) for tree in trees) and all(
        np.array_equal(tree, first, equal_nan=True) for tree in trees
    ):
        return first
    tails = {tree.shape[1:] if isinstance(tree, np.ndarray) else () for tree in trees}
    if len(tails) > 1:
        raise TypeError(f"arrays [E, ...] with the shapes {sorted(tails)} after E")
    joined = np.empty((environments, *tails.pop()), dtype=np.result_type(*trees))
    for tree, place in zip(trees, places, strict=True):
        joined[place] = tree
    return joined
