"""Properties of a xacro file, with scopes and lazy evaluation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from crowdbot.core import Element, InputError

Evaluate = Callable[[str, "Scope"], Any]


class Scope:
    """Properties by name; a macro call opens an inner scope.

    A text is evaluated when its property is first used, in the scope that defines it.

    Args:
        evaluate: returns the value of a text in a scope.
        parent: the outer scope, or None.

    >>> outer = Scope(lambda text, scope: text.upper())
    >>> outer.set("side", "left")
    >>> Scope(outer.evaluate, outer).get("side")
    'LEFT'
    """

    def __init__(self, evaluate: Evaluate, parent: Scope | None = None) -> None:
        self.evaluate, self.parent = evaluate, parent
        self._values: dict[str, Any] = {}
        self._lazy: set[str] = set()
        self._active: list[str] = []
        self._blocks: dict[str, Element] = {}

    @property
    def top(self) -> Scope:
        """The outermost scope."""
        scope = self
        while scope.parent is not None:
            scope = scope.parent
        return scope

    def set(self, name: str, value: Any, lazy: bool = True) -> None:
        """Set a property; with ``lazy``, a text that is not a literal is evaluated on first use."""
        value = literal(value)
        self._values[name] = value
        self._lazy.discard(name)
        if lazy and isinstance(value, str):
            self._lazy.add(name)

    def has(self, name: str) -> bool:
        """Return whether a property is defined here or in an outer scope."""
        return name in self._values or (self.parent is not None and self.parent.has(name))

    def remove(self, name: str) -> None:
        """Remove a property from this scope and all outer ones."""
        self._values.pop(name, None)
        self._lazy.discard(name)
        if self.parent is not None:
            self.parent.remove(name)

    def get(self, name: str) -> Any:
        """Return the value of a property.

        Raises:
            KeyError: it is not defined.
            InputError: its value contains itself.
        """
        if name not in self._values:
            if self.parent is None:
                raise KeyError(name)
            return self.parent.get(name)
        if name in self._lazy:
            if name in self._active:
                raise InputError(
                    f"the property {name[:60]!r} contains itself: {' -> '.join([*self._active, name][-8:])};"
                    ' use lazy_eval="false" to take its earlier value'
                )
            self._active.append(name)
            try:
                self._values[name] = literal(self.evaluate(self._values[name], self))
            finally:
                self._active.remove(name)
            self._lazy.discard(name)
        return self._values[name]

    namespace = get
    """Properties of a name space are attributes in expressions."""

    def set_block(self, name: str, block: Element) -> None:
        """Set a block of elements; the name begins with ``*`` for one element and ``**`` for its content."""
        self._blocks[name] = block

    def block(self, name: str) -> Element | None:
        """Return a block, or None."""
        if name in self._blocks or self.parent is None:
            return self._blocks.get(name)
        return self.parent.block(name)


def literal(value: Any) -> Any:
    """Return a text as the number or boolean that it names; other values are unchanged.

    >>> literal("1"), literal("0.5"), literal("true"), literal("'1'"), literal("a")
    (1, 0.5, True, '1', 'a')
    """
    if not isinstance(value, str):
        return value
    if len(value) >= 2 and value[0] == value[-1] == "'":
        return value[1:-1]
    if "_" in value or len(value) > 100:
        return value
    for kind in (int, float):
        try:
            return kind(value)
        except ValueError:
            continue
    return {"true": True, "True": True, "false": False, "False": False}.get(value, value)


def boolean(value: Any) -> bool:
    """Return the truth of a condition: true, false, or a number.

    Raises:
        InputError: it is another text.

    >>> boolean("true"), boolean("0"), boolean(2.0)
    (True, False, True)
    """
    found = literal(value.strip()) if isinstance(value, str) else value
    if isinstance(found, str):
        raise InputError(f"the condition {found[:60]!r} is not true or false")
    return bool(found)
