"""Partial elements: the readable fields of an element with a problem, for the checks of the other elements."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any, NamedTuple, TypeGuard, TypeVar

from crowdbot.core import InputError, UnreadableValue

__all__ = [
    "PartialElement",
    "UnreadableValue",
    "fill_defaults",
    "has_kind",
    "is_partial",
    "kind_of",
    "original_element",
    "plugin_with_defaults",
    "post_init_problem",
    "readable",
    "skip_unreadable",
]

T = TypeVar("T")


class _Description(NamedTuple):
    kind: type
    unreadable: frozenset[str] | None
    origin: Any
    default: Any


class PartialElement:
    """The readable fields of an element with a problem.

    Fields are read as attributes, like those of the element. A field that could not be read raises
    :class:`UnreadableValue`, which ends the check that needs it (:func:`skip_unreadable`): the reader has reported the
    problem already. Methods and properties of the class of the element are computed from the readable fields.

    Args:
        kind: class of the element.
        values: the readable fields.
        unreadable: names of the other fields; None if no attribute can be read, since the class itself is unknown.
        origin: the element that this is a copy of, if any.
        default: the element with defaults for the unreadable fields, if there is one.

    >>> from crowdbot.trials import Spawner
    >>> spawner = PartialElement(Spawner, {"name": "hall"}, {"zone", "count"})
    >>> spawner.name, has_kind(spawner, Spawner)
    ('hall', True)
    >>> list(skip_unreadable(iter([1]), (spawner.count for _ in [0]), iter([2])))
    [1, 2]
    """

    def __init__(
        self,
        kind: type,
        values: Mapping[str, Any],
        unreadable: Collection[str] | None = (),
        *,
        origin: Any = None,
        default: Any = None,
    ) -> None:
        names = None if unreadable is None else frozenset(unreadable)
        self._partial = _Description(kind, names, origin, default)
        vars(self).update({name: value for name, value in values.items() if name not in (names or ())})

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of the class of the element; raise for an unreadable field."""
        if name.startswith("__"):
            raise AttributeError(name)
        kind, unreadable, *_ = self._partial
        if unreadable is None or name in unreadable:
            raise UnreadableValue(name)
        member = inspect.getattr_static(kind, name)
        return member.__get__(self, kind) if hasattr(member, "__get__") else member

    def mark_unreadable(self, names: Collection[str]) -> None:
        """Make further fields unreadable."""
        if self._partial.unreadable is not None:
            self._partial = self._partial._replace(unreadable=self._partial.unreadable.union(names))
        for name in names:
            vars(self).pop(name, None)


def post_init_problem(element: PartialElement) -> str:
    """Return the problem that ``__post_init__`` finds in the readable fields, empty if there is none."""
    kind: Any = kind_of(element)
    try:
        kind.__post_init__(element)
    except UnreadableValue:
        return ""
    except InputError as error:
        return str(error)
    return ""


def is_partial(element: Any) -> bool:
    """Return whether a field of an element could not be read."""
    return isinstance(element, PartialElement)


def kind_of(element: Any) -> type:
    """Return the class of an element, partial or not."""
    return element._partial.kind if isinstance(element, PartialElement) else type(element)


def has_kind(element: Any, kind: type[T]) -> TypeGuard[T]:
    """Return whether the class of an element, partial or not, is ``kind`` or extends it."""
    return issubclass(kind_of(element), kind)


def original_element(element: Any) -> Any:
    """Return the element that a partial copy was made of; the element itself if it is no copy."""
    while isinstance(element, PartialElement) and element._partial.origin is not None:
        element = element._partial.origin
    return element


def plugin_with_defaults(plugin: Any) -> Any:
    """Return a plugin with defaults for the parameters that could not be read.

    Raises:
        UnreadableValue: there is no such plugin, for example because its class is unknown.
    """
    if not isinstance(plugin, PartialElement):
        return plugin
    if plugin._partial.default is None:
        raise UnreadableValue
    return plugin._partial.default


def fill_defaults(element: Any, *required: str, **replacements: Any) -> Any:
    """Return an element with defaults for the fields that could not be read.

    Args:
        element: the element, partial or not.
        required: fields that must be readable.
        replacements: values of fields that hold an unreadable element.

    Raises:
        UnreadableValue: a field that is required, or has no default, could not be read.
    """
    if not isinstance(element, PartialElement):
        return element
    kind: Any = kind_of(element)
    values = {}
    for field in dataclasses.fields(kind):
        try:
            value = getattr(element, field.name)
        except UnreadableValue:
            missing = field.default is None and "None" not in str(field.type)
            if field.name in required or field.default is dataclasses.MISSING or missing:
                raise
            value = field.default
        values[field.name] = value
    values |= {name: other for name, other in replacements.items() if any(is_partial(one) for one in values[name])}
    return PartialElement(kind, values, origin=element)


def readable(elements: Iterable[Any], name: str) -> list[tuple[int, Any]]:
    """Return the readable values of a field of elements, each with the index of its element."""
    found = []
    for k, element in enumerate(elements):
        try:
            found.append((k, getattr(element, name)))
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
