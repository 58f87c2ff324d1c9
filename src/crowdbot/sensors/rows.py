"""Rows of environments in readings and states of sensors: select them, join them, replace them.

The first axis of every array is the environments, in dataclasses, tuples, lists and dicts too. The class variable
``shared_fields`` of a dataclass names its exceptions. Numbers, texts and None belong to all environments.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError

__all__ = ["check_rows", "count_rows", "environment_index", "join_rows", "take_rows"]

Ints = NDArray[np.int64]
Rows = TypeVar("Rows")
NUMBERS = (bool, int, float, np.bool_, np.number)
LEAVES = (type(None), str, bytes, complex, enum.Enum, *NUMBERS)


def environment_index(chosen: ArrayLike, count: int | None, name: str) -> Ints:
    """Return indices of environments as an array.

    Raises:
        InputError: an index is not a whole number from 0 to ``count - 1``.
    """
    index = np.asarray(chosen)
    if index.ndim != 1 or (index.size and index.dtype.kind not in "iu"):
        raise InputError(f"{name}: the environments must be a list of whole numbers, but they are {chosen!r}")
    index = index.astype(np.int64, copy=False)
    if index.size and (index.min() < 0 or (count is not None and index.max() >= count)):
        allowed = "at least 0" if count is None else f"from 0 to {count - 1}"
        raise InputError(f"{name}: the environments are {index.tolist()}, each must be {allowed}")
    return index


def count_rows(value: Any, name: str) -> int | None:
    """Return the number of environments of ``value``, or None without arrays.

    Raises:
        InputError: the first axes of the arrays differ, or there is an object without environments.

    >>> count_rows((0.5, np.zeros((3, 2))), "state"), count_rows(None, "state")
    (3, None)
    """
    lengths: list[int] = []
    _collect_lengths(value, lengths, name)
    if not lengths or lengths.count(lengths[0]) == len(lengths):
        return lengths[0] if lengths else None
    found: tuple[str, int] | None = None
    for place, array in _arrays(value, name):
        if found is not None and len(array) != found[1]:
            raise InputError(
                f"{place} has shape {list(array.shape)} but {found[0]} has {found[1]} environments; the first axis must"
                " be the environments, or the class must list the field in shared_fields"
            )
        found = found or (place, len(array))
    return None if found is None else found[1]


def check_rows(value: Any, count: int, name: str) -> None:
    """Raise :class:`InputError` unless ``value`` has arrays for ``count`` environments, or none."""
    lengths: list[int] = []
    _collect_lengths(value, lengths, name)
    if lengths.count(count) == len(lengths):
        return
    for place, array in _arrays(value, name):
        if len(array) != count:
            raise InputError(
                f"{place} has shape {list(array.shape)} in {count} environments; the first axis must be the"
                " environments, or the class must list the field in shared_fields"
            )


def take_rows(value: Rows, index: Ints | slice) -> Rows:
    """Return ``value`` with only the environments ``index``, in this order, as copies.

    >>> take_rows({"time": 0.5, "speed": np.array([1.0, 2.0, 3.0])}, np.array([2, 0]))["speed"].tolist()
    [3.0, 1.0]
    """
    return cast(Rows, _take(value, index))


def join_rows(values: Sequence[Any], places: Sequence[Ints | slice], count: int) -> Any:
    """Return one value of ``count`` environments from parts, whose environments are ``places``; the last part wins.

    Numbers that differ become an array over the environments. A part without arrays has the same number everywhere.

    Raises:
        TypeError: the parts have different structures, such as None and an array.

    >>> join_rows([np.array([5.0]), np.array([7.0, 6.0])], [np.array([1]), np.array([2, 0])], 3).tolist()
    [6.0, 5.0, 7.0]
    """
    first = values[0]
    if all(isinstance(value, NUMBERS) or _is_row_array(value) for value in values):
        return _join_arrays(values, places, count)
    if any(type(value) is not type(first) for value in values):
        raise TypeError
    if isinstance(first, LEAVES) or (isinstance(first, np.ndarray) and first.ndim == 0):
        if any(value != first for value in values):
            raise TypeError
        return first
    keys = _keys(first)
    if any(_keys(value) != keys for value in values):
        raise TypeError
    changes = [join_rows([_part(value, key) for value in values], places, count) for key in keys]
    return _rebuild(first, keys, changes)


def _is_row_array(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.ndim > 0


def _join_arrays(values: Sequence[Any], places: Sequence[Ints | slice], count: int) -> Any:
    first = values[0]
    numbers = all(isinstance(value, NUMBERS) for value in values)
    if numbers and all(np.array_equal(value, first, equal_nan=True) for value in values):
        return first
    tails = {value.shape[1:] if isinstance(value, np.ndarray) else () for value in values}
    if len(tails) > 1:
        raise TypeError
    joined = np.empty((count, *tails.pop()), dtype=np.result_type(*values))
    for value, place in zip(values, places, strict=True):
        joined[place] = value
    return joined


def _take(value: Any, index: Ints | slice) -> Any:
    if isinstance(value, np.ndarray):
        if not value.ndim:
            return value
        return value[index].copy() if isinstance(index, slice) else value[index]
    if isinstance(value, LEAVES):
        return value
    keys = _keys(value)
    return _rebuild(value, keys, [_take(_part(value, key), index) for key in keys])


def _collect_lengths(value: Any, lengths: list[int], name: str) -> None:
    """Append the first lengths of all arrays over environments."""
    if isinstance(value, np.ndarray):
        if value.ndim:
            lengths.append(len(value))
    elif not isinstance(value, LEAVES):
        for key in _keys(value, name):
            _collect_lengths(_part(value, key), lengths, name)


def _arrays(value: Any, name: str) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield the arrays over environments with their names."""
    if isinstance(value, np.ndarray):
        if value.ndim:
            yield name, value
    elif not isinstance(value, LEAVES):
        for key in _keys(value, name):
            yield from _arrays(_part(value, key), f"{name}.{key}" if dataclasses.is_dataclass(value) else name)


@functools.cache
def _field_names(kind: type) -> tuple[str, ...] | None:
    """Return the fields with environments of a dataclass, None for another class."""
    if not dataclasses.is_dataclass(kind):
        return None
    shared = getattr(kind, "shared_fields", ())
    return tuple(field.name for field in dataclasses.fields(kind) if field.init and field.name not in shared)


def _names_of(value: Any) -> tuple[str, ...] | None:
    kind: Any = type(value)
    return _field_names(kind)


def _keys(value: Any, name: str = "a reading or state") -> Sequence[Any]:
    """Return the names of the parts with environments.

    Raises:
        InputError: the object has no known parts.
    """
    names = _names_of(value)
    if names is not None:
        return names
    if isinstance(value, tuple | list):
        return range(len(value))
    if isinstance(value, dict):
        return list(value)
    raise InputError(
        f"{name} is a {type(value).__name__}, which has no environments; use None, numbers, texts, arrays [E, ...], or"
        " dataclasses, tuples, lists and dicts of these, or list the field in shared_fields"
    )


def _part(value: Any, key: Any) -> Any:
    return value[key] if _names_of(value) is None else getattr(value, key)


def _rebuild(value: Any, keys: Sequence[Any], parts: list[Any]) -> Any:
    """Return ``value`` with other parts, or itself if they are the same objects."""
    if all(part is _part(value, key) for key, part in zip(keys, parts, strict=True)):
        return value
    if _names_of(value) is not None:
        return dataclasses.replace(cast(Any, value), **dict(zip(keys, parts, strict=True)))
    if isinstance(value, dict):
        return dict(zip(keys, parts, strict=True))
    make: Callable[..., Any] = getattr(type(value), "_make", type(value))
    return make(parts)
