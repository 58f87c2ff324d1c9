"""Commands: methods of a desk that the browser may call, with checked arguments."""

from __future__ import annotations

import inspect
import sys
import types
import typing
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from crowdbot.core import InputError, did_you_mean

Method = TypeVar("Method", bound=Callable[..., Any])
WORDS = {
    str: "text",
    int: "a whole number",
    float: "a finite number",
    bool: "true or false",
    dict: "an object",
    list: "a list",
}


def command(method: Method) -> Method:
    """Mark a method as a command.

    Its parameters have names and type annotations among text, numbers, bool, list, dict and unions with None; numbers
    are finite. The result is JSON.
    """
    method.__command__ = True  # type: ignore[attr-defined]
    return method


def command_names(desk: object) -> list[str]:
    """Return the names of the commands of a desk."""
    return sorted(name for name, _ in inspect.getmembers(type(desk), lambda one: getattr(one, "__command__", False)))


def call_command(desk: object, name: str, arguments: Mapping[str, Any]) -> Any:
    """Call a command of a desk.

    Args:
        desk: object with methods marked by :func:`command`.
        name: name of the command.
        arguments: JSON values by the names of the parameters.

    Raises:
        InputError: there is no such command, or an argument is unknown, missing or of another type.

    >>> class Counter:
    ...     @command
    ...     def add(self, step: int = 1) -> int:
    ...         return step + 1
    >>> call_command(Counter(), "add", {"step": 2})
    3
    >>> call_command(Counter(), "add", {"step": "2"})
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: add: step = '2': expected a whole number
    """
    method = getattr(type(desk), name, None)
    if not getattr(method, "__command__", False):
        names = command_names(desk)
        raise InputError(f"command {name!r} does not exist{did_you_mean(name, names)}; commands: {', '.join(names)}")
    assert method is not None
    parameters = {key: parameter for key, parameter in inspect.signature(method).parameters.items() if key != "self"}
    hints = typing.get_type_hints(method)
    if unknown := sorted(set(arguments) - set(parameters)):
        raise InputError(f"{name}: argument {unknown[0]!r} is unknown; arguments: {', '.join(parameters) or 'none'}")
    for key, parameter in parameters.items():
        if key not in arguments:
            if parameter.default is inspect.Parameter.empty:
                raise InputError(f"{name}: argument {key!r} is missing")
        elif not _fits(arguments[key], hints[key]):
            raise InputError(f"{name}: {key} = {arguments[key]!r:.80}: expected {_word(hints[key])}")
    return method(desk, **arguments)


def _fits(value: Any, hint: Any) -> bool:
    if hint is Any:
        return True
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        return any(_fits(value, argument) for argument in typing.get_args(hint))
    if hint is types.NoneType:
        return value is None
    if isinstance(value, bool):
        return hint is bool
    if hint is float:
        return isinstance(value, int | float) and abs(value) <= sys.float_info.max  # also not for NaN
    if not isinstance(value, typing.get_origin(hint) or hint):
        return False
    parts = typing.get_args(hint) if isinstance(value, list) else ()
    return all(_fits(item, part) for part in parts for item in value)


def _word(hint: Any) -> str:
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        return " or ".join(_word(argument) for argument in typing.get_args(hint))
    if typing.get_origin(hint) is list and Any not in typing.get_args(hint):
        return f"a list, each {_word(typing.get_args(hint)[0])}"
    return "nothing" if hint is types.NoneType else WORDS.get(typing.get_origin(hint) or hint, "a value")
