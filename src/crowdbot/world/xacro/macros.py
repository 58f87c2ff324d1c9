"""Macros of xacro: parameters with defaults, and blocks."""

from __future__ import annotations

import re
from typing import NamedTuple

from crowdbot.core import InputError

from .files import SourceElement

__all__ = ["Macro", "MacroParameter", "parse_parameters"]

DEFAULT = r"""\$\{.*?\}|\$\(.*?\)|(?:'[^']*'|"[^"]*"|[^\s'"]+)+|"""
PARAMETER = re.compile(rf"\s*([^\s:=]+?)\s*:?=\s*(\^\|?)?({DEFAULT})(?:\s+|$)", re.DOTALL)
BARE = re.compile(r"\s*(\S+)(?:\s+|$)")
MOST_PARAMETERS = 200


class MacroParameter(NamedTuple):
    """A parameter: name, whether the value of the caller is taken (``^``), and the default text or None."""

    name: str
    forward: bool = False
    default: str | None = None


class Macro(NamedTuple):
    """A macro: its element, parameters, the prefix of its name space and the folder of its file."""

    body: SourceElement
    parameters: tuple[MacroParameter, ...]
    prefix: str


def parse_parameters(text: str) -> tuple[MacroParameter, ...]:
    """Return the parameters of a macro.

    Raises:
        InputError: there are too many.

    >>> parse_parameters("side radius:=0.1 *origin")[1]
    MacroParameter(name='radius', forward=False, default='0.1')
    """
    found: list[MacroParameter] = []
    place, text = 0, text.strip()
    while place < len(text):
        match = PARAMETER.match(text, place)
        if match is not None:
            name, forward, default = match.groups()
            found.append(MacroParameter(name, bool(forward), default or ("" if not forward else None)))
        else:
            match = BARE.match(text, place)
            assert match is not None
            found.append(MacroParameter(match.group(1)))
        place = match.end()
        if len(found) > MOST_PARAMETERS:
            raise InputError(f"a macro has more than {MOST_PARAMETERS} parameters")
    return tuple(found)
