"""Trees of arrays: count, check, select, join and replace their environments, and store them by path.

A tree is a nest of dataclasses, tuples, lists, dicts and objects with a :class:`Storage`. Its leaves are arrays, whose
first axis is the environments, and numbers, texts and None, which belong to all environments. An array of objects holds
one object for each environment. The class variable ``shared_fields`` of a dataclass names its fields without
environments. Functions return new trees and leave their arguments as they are.
"""

from __future__ import annotations

import collections
import copy
import dataclasses
import enum
import functools
import itertools
import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.typing import Ints

from .errors import InputError

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


def objects(values: Iterable[Any]) -> NDArray[Any]:
    """Array of objects, one for each environment.

    >>> take(objects([{"a": 1}, None, "text"]), np.array([2, 0])).tolist()
    ['text', {'a': 1}]
    """
    parts = list(values)
    array = np.empty(len(parts), dtype=object)
    for k, part in enumerate(parts):  # an assignment of all would make one array of equally long parts
        array[k] = part
    return array


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

    Objects in arrays are copied, too, except those of :func:`storable` classes and of constants.

    >>> take({"time": 0.5, "speed": np.array([1.0, 2.0, 3.0])}, np.array([2, 0]))["speed"].tolist()
    [3.0, 1.0]
    """

    def chosen(array: NDArray[Any], name: str, constant: bool) -> NDArray[Any]:
        rows = array[index]
        if array.dtype == object and not constant:
            return objects(part if _is_storable(type(part)) else copy.deepcopy(part) for part in rows.tolist())
        return rows.copy() if isinstance(index, slice) else rows

    return cast(Tree, _map(chosen, tree))


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

    def change(array: NDArray[Any], name: str, constant: bool) -> NDArray[Any]:
        if array.ndim < 2 or array.shape[1] == agents:
            return array
        more = max(0, agents - array.shape[1])
        block = np.full((len(array), more, *array.shape[2:]), fills.get(name, 0), dtype=array.dtype)
        return np.concatenate([array[:, :agents], block], axis=1)

    return cast(Tree, _map(change, tree))


class _Fields(NamedTuple):
    """Fields of an object: those with environments, all that a copy needs, and whether a copy needs no checks."""

    names: tuple[str, ...]
    every: tuple[str, ...]
    plain: bool
    constants: tuple[str, ...] = ()


def _fields(tree: Any) -> _Fields | None:
    """Fields of a dataclass or of an object with a :class:`Storage`; None for another class."""
    kind: Any = type(tree)
    return _fields_of(kind) if _storage(tree) is None else _fields_of_object(kind, tuple(vars(tree)))


@functools.cache
def _fields_of_object(kind: Any, names: tuple[str, ...]) -> _Fields:
    storage = _storage_of(kind) or Storage()
    alike = {*storage.constants, *storage.shared}.difference(storage.environments)
    return _Fields(tuple(sorted({*names} - alike)), names, True, storage.environments)


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
    if _storage(tree) is None and all(map(operator.is_, parts, _parts(tree, keys))):
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


def _map(
    change: Callable[[NDArray[Any], str, bool], Any], tree: Any, name: str = "", constants: Sequence[str] = ()
) -> Any:
    """Change all arrays with environments; ``change`` gets an array, its field or key, and whether it is constant."""
    if isinstance(tree, np.ndarray):
        return change(tree, name, name in constants) if tree.ndim else tree
    if isinstance(tree, LEAVES):
        return tree
    keys, fields = _keys(tree), _fields(tree)
    own = () if fields is None else fields.constants
    parts = zip(keys, _parts(tree, keys), strict=True)
    return _rebuild(tree, keys, [_map(change, part, key, own) for key, part in parts])


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


class StateError(InputError):
    """A state cannot be stored or restored."""


class StateMark(NamedTuple):
    """A container or a special value in a stored tree.

    Fields:
        kind: ``holder``, ``value``, ``list``, ``tuple``, ``dict``, ``deque``, ``objects``, ``number``, ``random`` or
            ``same``.
        content: name of the class, number of parts, state of random generators, or path of the same object.
    """

    kind: str
    content: Any = None


@dataclasses.dataclass(frozen=True)
class Storage:
    """What is stored of a class, and what has environments; its class attribute ``storage``. Base classes add theirs.

    Objects of such a class are part of the structure: :func:`unflatten` sets the fields of the objects that exist. In a
    :func:`storable` class, constants have the value of the object that is replaced.

    Fields:
        constants: fields that are not stored and have no environments.
        environments: constants that have environments all the same; their objects are shared by copies.
        shared: fields that are stored, but have no environments.
        properties: properties that are stored, too; each needs a setter.
        resized: fields with arrays whose lengths change.
        last: fields that refer to objects in other fields.
    """

    constants: tuple[str, ...] = ()
    environments: tuple[str, ...] = ()
    shared: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()
    resized: tuple[str, ...] = ()
    last: tuple[str, ...] = ()


SCALARS = (bool, int, float, str)
KINDS = "biuf"
STORABLE: dict[str, type[Any]] = {}
"""Classes of values that are stored, by name."""
Kind = TypeVar("Kind", bound=type[Any])


def storable(kind: Kind) -> Kind:
    """Let :func:`flatten` store the values of a dataclass or named tuple by the name of its class (a decorator)."""
    STORABLE[kind.__name__] = kind
    return kind


def flatten(tree: Any, name: str = "tree") -> dict[str, Any]:
    """Arrays, numbers, texts and marks of containers by path; no code and no classes other than storable ones.

    Args:
        tree: a tree that may also have deques, random generators and objects whose class has a :class:`Storage`. A
            list, dict or object in several places stays one object.
        name: begin of all paths.

    Raises:
        StateError: an object of another class.

    >>> flatten({"speed": np.zeros(2)}, "state")["state/0/value"]
    array([0., 0.])
    """
    writer = _Writer()
    writer.put(name, tree)
    return writer.leaves


def unflatten(leaves: Mapping[str, Any], tree: Any = None, name: str = "tree") -> Any:
    """Tree of :func:`flatten`; objects whose class has a :class:`Storage` are those of ``tree`` with new fields.

    Raises:
        StateError: the leaves do not fit ``tree``, or are damaged.

    >>> unflatten(flatten((1, {"speed": np.zeros(2)})))
    (1, {'speed': array([0., 0.])})
    """
    reader = _Reader(leaves)
    value = reader.get(name, tree)
    if unknown := sorted(set(leaves) - reader.used):
        raise StateError(f"the state has a value {unknown[0]!r}, which this trial does not have")
    return value


def _is_storable(kind: Any) -> bool:
    return STORABLE.get(kind.__name__) is kind


def _storage(value: Any) -> Storage | None:
    """Storage of the class of an object that is part of the structure; None for others."""
    kind: Any = type(value)
    return None if _is_storable(kind) else _storage_of(kind)


@functools.cache
def _storage_of(kind: Any) -> Storage | None:
    rows = [row for base in kind.__mro__ if isinstance(row := vars(base).get("storage"), Storage)]
    names = [field.name for field in dataclasses.fields(Storage)]
    every = {name: tuple(part for row in rows for part in getattr(row, name)) for name in names}
    return Storage(**every) if rows else None


def _stored_fields(value: Any, storage: Storage) -> list[str]:
    """Fields and properties of an object that are stored, in their order."""
    names = {*vars(value), *storage.properties}
    if dataclasses.is_dataclass(value):
        names |= {field.name for field in dataclasses.fields(value)}
    return sorted(names.difference(storage.constants), key=lambda name: (name in storage.last, name))


@functools.cache
def _value_fields(kind: Any) -> tuple[str, ...]:
    """Fields of a storable class that are stored."""
    storage = _storage_of(kind) or Storage()
    names = [field.name for field in dataclasses.fields(kind)] if dataclasses.is_dataclass(kind) else kind._fields
    return tuple(name for name in names if name not in storage.constants)


class _Writer:
    def __init__(self) -> None:
        self.leaves: dict[str, Any] = {}
        self._known: dict[int, tuple[str, Any]] = {}

    def put(self, path: str, value: Any) -> None:
        kind = type(value)
        if value is None or kind in SCALARS:
            self.leaves[path] = value
        elif isinstance(value, np.generic) and value.dtype.kind in KINDS:
            self.leaves[path] = StateMark("number", [value.dtype.str, value.item()])
        elif isinstance(value, tuple):  # equal tuples may be one object in one run and two in another
            self._parts(path, value)
        elif id(value) in self._known:
            self.leaves[path] = StateMark("same", self._known[id(value)][0])
        else:
            self._known[id(value)] = (path, value)
            self._object(path, value)

    def _object(self, path: str, value: Any) -> None:
        storage = _storage(value)
        if type(value) is np.ndarray:
            self._array(path, value)
        elif storage is not None:
            self.leaves[path] = StateMark("holder", type(value).__name__)
            for name in _stored_fields(value, storage):
                self.put(f"{path}/{name}", getattr(value, name))
        elif isinstance(value, np.random.Generator) and isinstance(value.bit_generator, np.random.PCG64):
            self.leaves[path] = StateMark("random", value.bit_generator.state)
        else:
            self._parts(path, value)

    def _array(self, path: str, value: Any) -> None:
        if value.dtype.kind in KINDS:
            self.leaves[path] = np.ascontiguousarray(value).reshape(value.shape)
        elif value.dtype == object and value.ndim == 1:
            self._numbered(path, value, StateMark("objects", len(value)))
        else:
            raise StateError(f"{path} is an array of {value.dtype}, which cannot be stored")

    def _parts(self, path: str, value: Any) -> None:
        kind: Any = type(value)
        if _is_storable(kind):
            self.leaves[path] = StateMark("value", kind.__name__)
            for field in _value_fields(kind):
                self.put(f"{path}/{field}", getattr(value, field))
        elif kind in (list, tuple):
            self._numbered(path, value, StateMark(kind.__name__, len(value)))
        elif kind is collections.deque:
            self._numbered(path, value, StateMark("deque", [len(value), value.maxlen]))
        elif kind is dict:
            self.leaves[path] = StateMark("dict", len(value))
            for k, (key, part) in enumerate(value.items()):
                self.put(f"{path}/{k}/key", key)
                self.put(f"{path}/{k}/value", part)
        else:
            raise StateError(f"{path} is a {kind.__name__}, which cannot be stored; plain values can")

    def _numbered(self, path: str, parts: Any, mark: StateMark) -> None:
        self.leaves[path] = mark
        for k, part in enumerate(parts):
            self.put(f"{path}/{k}", part)


class _Reader:
    def __init__(self, leaves: Mapping[str, Any]) -> None:
        self.leaves, self.used = leaves, set[str]()
        self._known: dict[str, Any] = {}

    def get(self, path: str, old: Any = None, fixed: bool = False) -> Any:
        """Value at a path; ``fixed``: an array must keep the shape of ``old``."""
        if path not in self.leaves:
            raise StateError(f"the state lacks {path!r}")
        leaf = self.leaves[path]
        self.used.add(path)
        if isinstance(leaf, np.ndarray):
            value = _array(path, leaf, old, fixed)
        elif not isinstance(leaf, StateMark):
            value = leaf
        elif leaf.kind == "same":
            if not isinstance(leaf.content, str) or leaf.content not in self._known:
                raise StateError(f"{path} refers to {leaf.content!r}, which is not before it")
            value = self._known[leaf.content]
        else:
            value = self._marked(path, leaf, old)
        self._known[path] = value
        _check_kind(path, value, old)
        return value

    def _marked(self, path: str, leaf: StateMark, old: Any) -> Any:
        kind, content = leaf
        if kind == "holder":
            return self._holder(path, old)
        if kind == "value":
            return self._value(path, str(content), old)
        if kind == "random":
            return _generator(path, content)
        if kind == "number":
            return np.dtype(content[0]).type(content[1])
        if kind == "dict":
            return self._dict(path, int(content), old)
        if kind in ("list", "tuple"):
            parts = self._numbered(path, int(content), old)
            return parts if kind == "list" else tuple(parts)
        if kind == "deque":
            return collections.deque(self._numbered(path, int(content[0]), None), maxlen=content[1])
        if kind == "objects":
            return objects(self._numbered(path, int(content), old.tolist() if isinstance(old, np.ndarray) else None))
        raise StateError(f"{path} is a {kind!r}, which is unknown")

    def _numbered(self, path: str, count: int, old: Any) -> list[Any]:
        known = old if isinstance(old, list | tuple) else ()
        if count != len(known) and any(_storage(part) for part in known):
            raise StateError(f"{path} has {count} parts, but the trial has {len(known)}")
        return [self.get(f"{path}/{k}", known[k] if k < len(known) else None) for k in range(count)]

    def _dict(self, path: str, count: int, old: Any) -> dict[Any, Any]:
        known, found = old if isinstance(old, dict) else {}, {}
        for k in range(count):
            key = self.get(f"{path}/{k}/key")
            found[key] = self.get(f"{path}/{k}/value", known.get(key))
        if any(_storage(part) for part in known.values()) and found.keys() != known.keys():
            raise StateError(f"{path} has the parts {sorted(found)}, but the trial has {sorted(known)}")
        return found

    def _holder(self, path: str, old: Any) -> Any:
        storage = _storage(old)
        if storage is None:
            raise StateError(f"{path} is not a part of this trial")
        self._known[path] = old
        for name in _stored_fields(old, storage):
            part = f"{path}/{name}"
            _set(part, old, name, self.get(part, getattr(old, name), name not in storage.resized))
        return old

    def _value(self, path: str, name: str, old: Any) -> Any:
        kind: Any = STORABLE.get(name)
        if kind is None:
            raise StateError(f"{path} is a {name!r}, which is unknown")
        constants = getattr(_storage_of(kind), "constants", ())
        if constants and type(old) is not kind:
            raise StateError(f"{path} is a {name}, which this trial does not have there")
        values = {constant: getattr(old, constant) for constant in constants}
        for field in _value_fields(kind):
            values[field] = self.get(f"{path}/{field}", getattr(old, field) if constants else None, bool(constants))
        fields = dataclasses.fields(kind) if dataclasses.is_dataclass(kind) else ()
        late = {field.name: values.pop(field.name) for field in fields if not field.init}
        made = kind(**values)
        for field, value in late.items():
            object.__setattr__(made, field, value)
        return made


def _set(path: str, value: Any, name: str, new: Any) -> None:
    try:
        setattr(value, name, new)
    except InputError as error:
        raise StateError(f"{path}: {error}") from None


def _array(path: str, leaf: NDArray[Any], old: Any, fixed: bool) -> NDArray[Any]:
    if isinstance(old, np.ndarray):
        if leaf.dtype != old.dtype or leaf.ndim != old.ndim:
            raise StateError(
                f"{path} has {leaf.ndim} axes of {leaf.dtype}, but the trial has {old.ndim} of {old.dtype}"
            )
        if fixed and leaf.shape != old.shape:
            raise StateError(f"{path} has the shape {list(leaf.shape)}, but the trial has {list(old.shape)}")
    return leaf.copy()


def _generator(path: str, content: Any) -> np.random.Generator:
    bits = np.random.PCG64(0)
    try:
        bits.state = content
    except (ValueError, TypeError, KeyError, OverflowError) as error:
        raise StateError(f"{path} is not the state of a random generator: {str(error)[:80]}") from None
    return np.random.Generator(bits)


def _check_kind(path: str, value: Any, old: Any) -> None:
    """Raise :class:`StateError` if a value has another kind than in the tree that is restored."""
    kind: Any = type(old)
    if old is None or value is None or (isinstance(old, SCALARS) and isinstance(value, np.ndarray | np.generic)):
        fits = _storage(old) is None
    elif isinstance(old, tuple):
        fits = isinstance(value, tuple) or type(value).__name__ in STORABLE
    elif isinstance(old, np.ndarray):
        fits = isinstance(value, np.ndarray) or (isinstance(value, float) and path.endswith("/time"))
    elif isinstance(old, (*SCALARS, list, dict, np.random.Generator)) or _storage_of(kind) is not None:
        fits = type(value) is kind
    else:
        fits = not isinstance(value, (*SCALARS, list, dict))
    if not fits:
        raise StateError(f"{path} is a {type(value).__name__}, but the trial has a {type(old).__name__}")
