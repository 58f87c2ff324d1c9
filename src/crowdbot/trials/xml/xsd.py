"""Schema: the XSD of trial files for editors, made from the same outline as the reader.

It contains every element, attribute, unit and range. Elements may be in any order, as in the reader. Checks of the
whole file (references to names, room for people) need ``crowdbot check``.
"""

from __future__ import annotations

import dataclasses
import re
from typing import Any

from crowdbot.core import Element, builtin_classes, format_xml
from crowdbot.core.fields import LARGEST, Constraint, FieldSpec, PluginSpec, Points, outline
from crowdbot.trials.distribution import Distribution
from crowdbot.trials.trial import Trial

NUMBER = r"[+\-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+\-]?[0-9]{1,4})?"
POINT = rf"{NUMBER}\s*,\s*{NUMBER}"
KINDS = {
    "points": rf"\s*({POINT}(\s+{POINT})*)?\s*",
    "distribution": rf"\s*({NUMBER}|[A-Za-z][A-Za-z\-]*\s*\([^()]*\))\s*",
    "address": r"[^\s].*",
}


def schema() -> str:
    """Return the XML schema (XSD 1.0) of trial files.

    >>> text = schema()
    >>> text.splitlines()[1][:11], 'name="spawner"' in text
    ('<xs:schema ', True)
    """
    root = Element("xs:schema", {"xmlns:xs": "http://www.w3.org/2001/XMLSchema"})
    root.children.append(_about("Trial files of crowdbot. Written by 'crowdbot new schema'; do not edit."))
    for name, pattern in KINDS.items():
        root.children.append(_simple({"name": name}, "xs:string", [("pattern", pattern)]))
    root.children.append(_simple({"name": "truth"}, "xs:string", [("enumeration", "true"), ("enumeration", "false")]))
    root.children.append(Element("xs:element", {"name": "trial", "type": "Trial"}))
    known: dict[str, Element] = {}
    _add_type(Trial, known)
    root.children += known.values()
    return re.sub(r'<xs:documentation source="(.*)"/>', r"<xs:documentation>\1</xs:documentation>", format_xml(root))


def _add_type(cls: type, known: dict[str, Element]) -> str:
    """Add the type of an element and the types of its child elements, and return its name."""
    name = cls.__name__
    if name in known:
        return name
    whole = known[name] = Element("xs:complexType", {"name": name})
    whole.children.append(_about((cls.__doc__ or "").strip().splitlines()[0]))
    parts = outline(cls)
    inside = [element for part in parts for element in _elements(part, known)]
    if inside:
        often = {"minOccurs": "0", "maxOccurs": "unbounded"}
        whole.children.append(Element("xs:choice", often, inside))
    taken = {part.word for part in parts if part.role == "attribute"}
    whole.children += [_attribute(part) for part in parts if part.role == "attribute"]
    for part in parts:
        if part.role == "mounted" and part.plug is not None:
            whole.children += _plug_attributes(part.plug, taken)
    return name


def _elements(part: FieldSpec, known: dict[str, Element]) -> list[Element]:
    if part.role in ("child", "children"):
        return [
            Element("xs:element", {"name": word, "type": _add_type(kind, known)}, [_about(part.about)])
            for word, kind in part.elements.items()
        ]
    if part.role != "plugged" or part.plug is None:
        return []
    kind = Element("xs:complexType", children=_plug_attributes(part.plug, set()))
    return [Element("xs:element", {"name": part.word}, [_about(part.about), kind])]


def _plug_attributes(what: PluginSpec, taken: set[str]) -> list[Element]:
    """Return the attributes of all built-in plugins; plugins of users may have any attributes."""
    room, contract = what.places()
    classes = builtin_classes(room, contract)
    words = [("enumeration", name) for name in classes]
    kinds = [_simple({}, "xs:string", words), _simple({}, "address", [])]
    union = Element("xs:simpleType", children=[Element("xs:union", children=kinds)])
    found = [Element("xs:attribute", {"name": "type", "use": "required"}, [union])]
    users: dict[str, list[str]] = {}
    for name, cls in classes.items():
        for field in dataclasses.fields(cls):
            word = field.name.replace("_", "-")
            if field.init and word not in taken and word != "type":
                users.setdefault(word, []).append(name)
    for word, names in sorted(users.items()):
        about = _about(f"of {', '.join(names)}")
        found.append(Element("xs:attribute", {"name": word, "type": "xs:string"}, [about]))
    return [*found, Element("xs:anyAttribute", {"namespace": "##local", "processContents": "skip"})]


def _attribute(part: FieldSpec) -> Element:
    rule = part.rule or Constraint(part.about)
    unit = f" [{rule.unit}]" if rule.unit else ""
    default = "" if part.required or part.default in (None, "", ()) else f"; default {_plain(part.default)}"
    row = {"name": part.word} | ({"use": "required"} if part.required else {})
    return Element("xs:attribute", row, [_about(f"{part.about}{unit}{default}"), _values(part.kind, rule)])


def _values(kind: Any, rule: Constraint) -> Element:
    if kind is Points:
        return _simple({}, "points", [])
    if kind is Distribution:
        return _simple({}, "distribution", [])
    if kind is bool:
        return _simple({}, "truth", [])
    if kind is str:
        rows = [("enumeration", choice) for choice in rule.choices]
        return _simple({}, "xs:string", rows or ([("pattern", _translate(rule.pattern))] if rule.pattern else []))
    rows = [("pattern", NUMBER)]
    if rule.exclusive_min is not None:
        rows.append(("minExclusive", f"{rule.exclusive_min:g}"))
    else:
        rows.append(("minInclusive", repr(-LARGEST if rule.min is None else rule.min)))
    rows.append(("maxInclusive", repr(LARGEST if rule.max is None else rule.max)))
    return _simple({}, "xs:double", rows)


def _translate(pattern: str) -> str:
    """Return a pattern without the syntax that XSD does not support."""
    return pattern.replace(r"[^\x00]", ".").replace("\\S", "[^\\s]")


def _simple(row: dict[str, str], base: str, rows: list[tuple[str, str]]) -> Element:
    facets = [Element(f"xs:{facet}", {"value": value}) for facet, value in rows]
    return Element("xs:simpleType", dict(row), [Element("xs:restriction", {"base": base}, facets)])


def _about(words: str) -> Element:
    return Element("xs:annotation", children=[Element("xs:documentation", {"source": words})])


def _plain(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
