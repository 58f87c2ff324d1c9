"""Plugins: from a name or an address to a class, from text attributes to its fields.

Built-in names are the classes in a room's ``__all__``, written in kebab-case. Anything else is an address:
``file.py:Name``, ``folder/:Name`` or ``package.module:Name``. The same words work in Python, XML and on the command
line.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import re
import types
import typing
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core.errors import InputError, UnknownName, did_you_mean

from .class_source import describe_class, reads_only
from .plugin_module import load_plugin_module, plugin_source

SHORTENED = ("Navigator",)
"""Contracts whose names are left out at the end of a built-in name, since a crowd model may have the same name."""


def kebab_case(name: str) -> str:
    """Return the kebab-case form of a class name, as used on the command line and in XML.

    >>> kebab_case("ConstantVelocity"), kebab_case("ORCA"), kebab_case("Lidar2D"), kebab_case("PLEdestrians")
    ('constant-velocity', 'orca', 'lidar2d', 'pledestrians')
    """
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "-", name).lower()


def builtin_name(cls: type, contract: type) -> str:
    """Return the name of a built-in class in kebab-case, of a navigator without ``Navigator`` at its end.

    >>> class Navigator: pass
    >>> class ORCANavigator(Navigator): pass
    >>> builtin_name(ORCANavigator, Navigator)
    'orca'
    >>> class Drive: pass
    >>> class DifferentialDrive(Drive): pass
    >>> builtin_name(DifferentialDrive, Drive)
    'differential-drive'
    """
    short = cls.__name__.removesuffix(contract.__name__) if contract.__name__ in SHORTENED else ""
    return kebab_case(short or cls.__name__)


def builtin_classes(room: types.ModuleType, contract: type) -> dict[str, type]:
    """Return the concrete classes of ``contract`` in ``room.__all__`` by their kebab-case names, sorted."""
    classes = (getattr(room, name) for name in room.__all__)
    found = {
        builtin_name(value, contract): value
        for value in classes
        if inspect.isclass(value)
        and issubclass(value, contract)
        and not inspect.isabstract(value)
        and value is not contract
    }
    return dict(sorted(found.items()))


def find_class(
    name: str, room: types.ModuleType, contract: type, *, folder: Path | None = None, trust: bool = True
) -> type:
    """Return the class with a built-in name or an address.

    Args:
        name: ``social-force``, ``SocialForce``, ``file.py:Name``, ``folder/:Name``, ``folder.file:Name`` or
            ``package.module:Name``.
        room: package of the built-in classes.
        contract: base class of the class.
        folder: folder of relative files and folders (default: the working folder).
        trust: if False, only code inside ``folder`` is loaded.

    Raises:
        UnknownName: no built-in class has this name.
        InputError: the address cannot be loaded, is not a concrete subclass of ``contract``, or is not trusted.
    """
    known = builtin_classes(room, contract)
    plain = {value.__name__.lower(): value for value in known.values()}
    plain |= {key.replace("-", ""): value for key, value in known.items()}
    short = name.strip().replace("-", "").replace("_", "").lower()
    if short in plain:
        return plain[short]
    derive = getattr(room, "find_layered", None)  # names that a room composes, such as orca+headway
    layered = derive and derive(name, lambda part: find_class(part, room, contract, folder=folder, trust=trust))
    if layered and issubclass(layered, contract):
        return layered  # type: ignore[no-any-return]
    if ":" not in name:
        raise UnknownName(_plain_name(contract), name, known, address=True)
    place, _, attribute = name.rpartition(":")
    if reads_only():
        file, attribute = plugin_source(place, attribute, folder or Path.cwd(), trust)
        return describe_class(file, attribute, contract, name)
    module, attribute = load_plugin_module(place, attribute, folder or Path.cwd(), trust)
    value = getattr(module, attribute, None)
    if not (inspect.isclass(value) and issubclass(value, contract)) or inspect.isabstract(value):
        here = [n for n, v in vars(module).items() if inspect.isclass(v) and issubclass(v, contract)]
        raise InputError(f"{name} is not a concrete {contract.__name__}; {place} defines {', '.join(here) or 'none'}")
    return value


def from_attributes(cls: type, attributes: Mapping[str, str], where: str = "") -> Any:
    """Return an instance of a dataclass from text attributes; names may be in kebab-case.

    Raises:
        InputError: an attribute is unknown, missing or has an invalid value.
    """
    prefix = f"{where}: " if where else ""
    hints = _hints(cls)
    fields = {f.name: f for f in dataclasses.fields(cls) if f.init}
    values: dict[str, Any] = {}
    for key, text in attributes.items():
        name = key.replace("-", "_")
        if name not in fields:
            known = [f.replace("_", "-") for f in fields]
            raise InputError(
                f"{prefix}{kebab_case(cls.__name__)} has no attribute {key!r}{did_you_mean(key, known)};"
                f" it takes {', '.join(known) or 'none'}"
            )
        values[name] = _convert(text, hints[name], f"{prefix}{kebab_case(cls.__name__)} {key}")
    missing = [name for name in required_fields(cls) if name not in values]
    if missing:
        raise InputError(f"{prefix}{kebab_case(cls.__name__)} needs the attribute {missing[0].replace('_', '-')!r}")
    try:
        return cls(**values)
    except InputError as error:
        raise type(error)(f"{prefix}{error}") from None


def attribute_problems(cls: type, attributes: Mapping[str, str], also: Iterable[str] = ()) -> dict[str, str]:
    """Return a message for every attribute that is unknown, missing or invalid.

    Args:
        cls: a dataclass.
        attributes: the attributes, as for :func:`from_attributes`.
        also: further attributes of the element, for suggestions.

    >>> from crowdbot.core import Paper
    >>> attribute_problems(Paper, {"yeer": "1995", "year": "x", "authors": "a", "title": "t", "venue": "v"})["yeer"]
    "has no attribute 'yeer', did you mean 'year'?; it takes authors, year, title, venue, doi"
    """
    hints = _hints(cls)
    fields = {f.name: f for f in dataclasses.fields(cls) if f.init}
    known = [*attribute_names(cls), *also]
    found = {}
    for key, text in attributes.items():
        name = key.replace("-", "_")
        if name not in fields:
            takes = ", ".join(known) or "none"
            found[key] = f"has no attribute {key[:40]!r}{did_you_mean(key, known)}; it takes {takes}"
            continue
        try:
            _convert(text, hints[name], key)
        except InputError as error:
            found[key] = str(error)
    given = {key.replace("-", "_") for key in attributes}
    missing = [name.replace("_", "-") for name in required_fields(cls) if name not in given]
    return found | {word: f"needs the attribute {word!r}" for word in missing}


def attribute_names(cls: Any) -> list[str]:
    """Return the attribute names of a dataclass.

    >>> from crowdbot.core import Paper
    >>> attribute_names(Paper)
    ['authors', 'year', 'title', 'venue', 'doi']
    """
    return [field.name.replace("_", "-") for field in dataclasses.fields(cls) if field.init]


def required_fields(cls: Any) -> list[str]:
    """Return the fields of a dataclass that have no default."""
    return [
        field.name
        for field in dataclasses.fields(cls)
        if field.init and field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
    ]


@functools.cache
def _hints(cls: type) -> dict[str, Any]:
    return typing.get_type_hints(cls)


def _convert(text: str, kind: Any, what: str) -> Any:
    union = isinstance(kind, types.UnionType) or typing.get_origin(kind) is typing.Union
    options = typing.get_args(kind) if union else (kind,)
    for option in options:
        if option is type(None):
            continue
        if hasattr(option, "parse"):
            try:
                return option.parse(text)
            except ValueError as error:
                raise InputError(f"{what}: {error}") from None
        if option is bool and text.lower() in ("true", "false"):
            return text.lower() == "true"
        if option is int and re.fullmatch(r"[+-]?\d{1,18}", text.strip()):
            return int(text)
        if option is float:
            return _number(text, what)
        if option is str:
            return text
        if typing.get_origin(option) is tuple:
            return tuple(_number(part, what) for part in text.replace(",", " ").split())
    names = " or ".join(getattr(o, "__name__", str(o)) for o in options if o is not type(None))
    raise InputError(f"{what}: {text!r} is not a {names}")


def _number(text: str, what: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise InputError(f"{what}: {text!r} is not a number") from None
    if not np.isfinite(value):
        raise InputError(f"{what}: {text!r} is not finite")
    return value


def _plain_name(contract: type) -> str:
    return kebab_case(contract.__name__).replace("-", " ")


def reset_undeclared(kind: type, **defaults: object) -> None:
    """Give a class the default of every attribute that its own body does not assign.

    A contract calls this in ``__init_subclass__`` for attributes such as ``batched``, which promise something about
    the methods of a class: a subclass that changes a method would otherwise repeat a promise that it may not keep.

    >>> class Model:
    ...     batched = False
    ...     def __init_subclass__(cls):
    ...         reset_undeclared(cls, batched=False)
    >>> class Straight(Model):
    ...     batched = True
    >>> class Drunk(Straight): pass
    >>> Straight.batched, Drunk.batched
    (True, False)
    """
    for name, value in defaults.items():
        if name not in vars(kind):
            setattr(kind, name, value)
