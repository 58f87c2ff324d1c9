"""Writer: from a trial to XML; parsing the text gives an equal trial."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from crowdbot.core import (
    Element,
    InputError,
    builtin_classes,
    builtin_name,
    format_xml,
    kebab_case,
    plugin_address,
    required_fields,
)
from crowdbot.core.fields import FieldSpec, outline, plain
from crowdbot.models import HeadwayLayer
from crowdbot.trials.randomized_model import RandomizedModel


def trial_xml(trial: Any) -> str:
    """Return the XML text of a trial.

    Raises:
        InputError: a part of the trial cannot be written, such as a model with a different value for each agent.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.trials import Trial
    >>> print(trial_xml(Trial(name="alone", duration=2.0, crowd=ORCA(time_horizon=3))), end="")
    <?xml version="1.0" encoding="UTF-8"?>
    <trial name="alone" duration="2">
      <crowd type="orca" time-horizon="3"/>
    </trial>
    """
    return format_xml(element_of(trial))


def element_of(trial: Any) -> Element:
    """Return the XML tree of a trial."""
    return element_from("trial", trial, trial.folder)


def element_from(tag: str, thing: Any, folder: Path | None) -> Element:
    """Return the XML tree of an object; addresses of code are relative to ``folder``."""
    element = Element(tag)
    cls: type = type(thing)
    usual = getattr(thing, "usual", {})
    for part in outline(cls):
        value = getattr(thing, part.name)
        if part.role == "children" and part.name in usual:
            value = tuple(item for item in value if item not in usual[part.name])
        if not part.required and value == usual.get(part.name, part.default):
            continue
        _add(element, part, value, folder)
    return element


def _add(element: Element, part: FieldSpec, value: Any, folder: Path | None) -> None:
    if part.role == "attribute":
        element.attributes[part.word] = _text(value, part.word)
    elif part.role in ("child", "children"):
        ones = part.into.spread(value) if part.into else (value if part.role == "children" else (value,))
        element.children += [element_from(_word(part, item), item, folder) for item in ones]
    elif part.role == "plugged":
        element.children.append(Element(part.word, _plug(part, value, folder)))
    else:
        element.attributes |= _plug(part, value, folder)


def _word(part: FieldSpec, value: Any) -> str:
    return next(word for word, kind in part.elements.items() if isinstance(value, kind))


def _plug(part: FieldSpec, value: Any, folder: Path | None) -> dict[str, str]:
    if isinstance(value, RandomizedModel):
        draws = {name.replace("_", "-"): str(drawn) for name, drawn in value.draws}
        return _plug(part, value.model, folder) | draws
    words = {"type": _type(part, value, folder)}
    for field in dataclasses.fields(value):
        inner = getattr(value, field.name)
        if field.init and not _is_default(field, inner):
            word = field.name.replace("_", "-")
            words[word] = _text(inner, f"{type(value).__name__} {word}")
    return words


def _type(part: FieldSpec, value: Any, folder: Path | None) -> str:
    """Return the built-in name of a part, or the address of its class relative to the folder of the trial."""
    assert part.plug is not None
    return _class_name(type(value), *part.plug.places(), folder)


def _class_name(cls: type, room: Any, contract: type, folder: Path | None) -> str:
    if builtin_classes(room, contract).get(builtin_name(cls, contract)) is cls:
        return builtin_name(cls, contract)
    if issubclass(cls, HeadwayLayer):
        return _class_name(cls.base, room, contract, folder) + cls.suffix  # type: ignore[arg-type]
    if address := plugin_address(cls, folder):
        return address
    if "<locals>" in cls.__qualname__ or cls.__module__ == "__main__":
        raise InputError(f"{cls.__name__} cannot be named in a trial file: move it to a module or a file of its own")
    return f"{cls.__module__}:{cls.__qualname__}"


def _is_default(field: dataclasses.Field[Any], value: Any) -> bool:
    default = field.default
    if field.default_factory is not dataclasses.MISSING:
        default = field.default_factory()
    try:
        return bool(value == default)
    except ValueError:
        return False


def _is_default_part(value: Any) -> bool:
    """Return whether a value is a built-in part with its defaults, such as the crowd model of a predictor."""
    cls = type(value)
    if not dataclasses.is_dataclass(value) or not cls.__module__.startswith("crowdbot."):
        return False
    return not required_fields(cls) and all(
        _is_default(part, getattr(value, part.name)) for part in dataclasses.fields(cls)
    )


def _text(value: Any, what: str) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | str):
        return str(value)
    if isinstance(value, float):
        return plain(value)
    if hasattr(type(value), "parse"):
        return str(value)
    if isinstance(value, tuple) and not any(map(_is_default_part, value)):
        return " ".join(_text(item, what) for item in value)
    if _is_default_part(value):
        return kebab_case(type(value).__name__)
    raise InputError(f"{what} = {str(value)[:60]!r} cannot be written as an attribute of a trial file")
