"""Partial elements: the readable fields of an element with a problem, so that the other elements can be checked.

A partial element has the class of its element and every field that could be read. Access to another field raises
:class:`UnreadableValue`, which ends the check that needs it (:func:`skip_unreadable`): the reader has reported the
problem already.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Container, Iterable, Iterator, Mapping
from typing import Any, TypeVar

from crowdbot.core import InputError, UnreadableValue

__all__ = [
    "EVERYTHING",
    "UnreadableValue",
    "begin_partial",
    "is_partial",
    "kind_of",
    "make_partial",
    "origin",
    "readable",
    "rest",
    "skip_unreadable",
    "whole",
]

T = TypeVar("T")
LOST, ORIGIN, WHOLE = "_lost_of_it", "_origin_of_it", "_whole_of_it"


class _Everything:
    """All fields of something of which not even the class is known, and which fields there are."""

    def __contains__(self, name: object) -> bool:
        return not str(name).startswith("__") or name == "__dataclass_fields__"


EVERYTHING = _Everything()


@functools.cache
def _partial_class(cls: type) -> type:
    def look(self: Any, name: str) -> Any:
        if name in object.__getattribute__(self, "__dict__").get(LOST, ()):
            raise UnreadableValue(name)
        return object.__getattribute__(self, name)

    def unknown(self: Any, *args: Any, **more: Any) -> Any:
        raise UnreadableValue

    methods = dict.fromkeys(getattr(cls, "__abstractmethods__", ()), unknown)
    return type(cls)(cls.__name__, (cls,), methods | {"__getattribute__": look, "__module__": cls.__module__})


def make_partial(
    cls: type, values: Mapping[str, Any], lost: Container[str], *, origin: Any = None, whole: Any = None
) -> Any:
    """Return an element with only the fields that could be read.

    Args:
        cls: class of the element.
        values: of the fields that could be read.
        lost: names of the others.
        origin: the element that it is a copy of, if it is one.
        whole: the element as it would be with defaults for what is lost, if that can be made.

    >>> from crowdbot.trials import Spawner
    >>> spawner = make_partial(Spawner, {"name": "hall"}, {"zone", "count"})
    >>> spawner.name, isinstance(spawner, Spawner)
    ('hall', True)
    >>> list(skip_unreadable(iter([1]), (spawner.count for _ in [0]), iter([2])))
    [1, 2]
    """
    made: Any = object.__new__(_partial_class(cls))
    own = object.__getattribute__(made, "__dict__")
    own.update(values)
    own.update({LOST: lost, ORIGIN: origin, WHOLE: whole})
    return made


def begin_partial(made: Any) -> str:
    """Run ``__post_init__`` of a partial element as far as possible, and return the problem that it reports."""
    try:
        made.__post_init__()
    except UnreadableValue:
        return ""
    except InputError as error:
        return str(error)
    return ""


def is_partial(thing: Any) -> bool:
    """Return whether a field of an element could not be read."""
    return LOST in _own(thing)


def kind_of(thing: Any) -> type:
    """Return the class of an element, partial or not."""
    return type(thing).__mro__[1] if is_partial(thing) else type(thing)


def origin(thing: Any) -> Any:
    """Return the element that a copy was made of."""
    found = _own(thing).get(ORIGIN)
    return thing if found is None else origin(found)


def whole(thing: Any) -> Any:
    """Return a part as it would be with defaults for what could not be read.

    Raises:
        UnreadableValue: nobody knows what it would be.
    """
    if not is_partial(thing):
        return thing
    if (found := _own(thing)[WHOLE]) is None:
        raise UnreadableValue
    return found


def rest(thing: T, *needs: str, **instead: Any) -> T:
    """Return an element with defaults for what could not be read of it.

    Args:
        thing: the element, partial or not.
        needs: fields without which it is of no use.
        instead: fields that are something else when anything in them could not be read.

    Raises:
        UnreadableValue: something that is needed, or has no default, could not be read.
    """
    if not is_partial(thing):
        return thing
    values = {}
    for field in dataclasses.fields(thing):  # type: ignore[arg-type]
        try:
            value = getattr(thing, field.name)
        except UnreadableValue:
            missing = field.default is None and "None" not in str(field.type)
            if field.name in needs or field.default is dataclasses.MISSING or missing:
                raise
            value = field.default
        values[field.name] = value
    values |= {name: other for name, other in instead.items() if any(is_partial(one) for one in values[name])}
    made: Any = object.__new__(kind_of(thing))
    _own(made).update(values | {ORIGIN: thing})
    return made  # type: ignore[no-any-return]


def readable(things: Iterable[Any], name: str) -> list[tuple[int, Any]]:
    """Return the values of a field of elements, with their index, where they could be read."""
    found = []
    for k, thing in enumerate(things):
        try:
            found.append((k, getattr(thing, name)))
        except UnreadableValue:
            continue
    return found


def skip_unreadable(*checks: Iterator[T]) -> Iterator[T]:
    """Yield the results of several checks; a check ends where it needs a field that could not be read."""
    for check in checks:
        try:
            yield from check
        except UnreadableValue:
            continue


def _own(thing: Any) -> dict[str, Any]:
    try:
        return object.__getattribute__(thing, "__dict__")  # type: ignore[no-any-return]
    except AttributeError:
        return {}
