"""Format the schema of trial files as a page of the reference (used by reference_pages.py)."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator

XS = "{http://www.w3.org/2001/XMLSchema}"
HEAD = """# Trial elements

Every element and attribute of a trial file, from the schema that `crowdbot new schema trial.xsd` writes.
[Trial file](trial-file.md) is the overview. Required attributes are bold. An element with a `type` also accepts the
parameters of that type as attributes. They are fields of its class: [Python](api/index.md) has their meanings, units
and defaults, with `_` instead of `-`."""


def elements_page(schema: str) -> str:
    """Return the page: one section for each element, in the order of the schema."""
    root = ET.fromstring(schema)  # noqa: S314
    kinds = {kind.get("name", ""): kind for kind in root.findall(f"{XS}complexType")}
    names, parents = {"Trial": "trial"}, {"trial": list[str]()}
    sections = {"trial": kinds["Trial"]}
    for kind in kinds.values():
        for child in kind.iter(f"{XS}element"):
            name = names[child.get("type", "")] = child.get("name", "")
            sections[name] = kinds[child.get("type", "")] if "type" in child.attrib else child[-1]
    for key, kind in kinds.items():
        for child in kind.iter(f"{XS}element"):
            parents.setdefault(child.get("name", ""), []).append(names[key])
    lines = [HEAD]
    for name, kind in sections.items():
        lines += ["", f"## {name} {{ #{name} }}", "", *_section(kind, parents[name])]
    return "\n".join(lines) + "\n"


def _section(kind: ET.Element, parents: list[str]) -> Iterator[str]:
    if about := _words(kind):
        yield from (about, "")
    if parents:
        yield from ("In " + ", ".join(f"[`<{name}>`](#{name})" for name in parents) + ".", "")
    attributes = kind.findall(f"{XS}attribute")
    general = [attribute for attribute in attributes if not _words(attribute).startswith("of ")]
    if general:
        yield from ("| attribute | meaning |", "|---|---|")
        yield from (f"| {_name(item)} | {_meaning(item)} |" for item in general)
        yield ""
    inner = sorted({child.get("name", "") for child in kind.iter(f"{XS}element")})
    if inner:
        yield from ("Elements inside: " + ", ".join(f"[`<{name}>`](#{name})" for name in inner) + ".", "")
    of_type: dict[str, list[str]] = {}
    for attribute in attributes:
        if attribute not in general:
            for name in _words(attribute).removeprefix("of ").split(", "):
                of_type.setdefault(name, []).append(f"`{attribute.get('name')}`")
    if of_type:
        yield from ("| type | parameters |", "|---|---|")
        yield from (f"| `{name}` | {', '.join(of_type[name])} |" for name in sorted(of_type))
        yield ""


def _words(thing: ET.Element) -> str:
    text = thing.findtext(f"{XS}annotation/{XS}documentation") or ""
    return " ".join(text.split()).replace("|", "\\|").replace("``", "`")


def _name(attribute: ET.Element) -> str:
    name = f"`{attribute.get('name')}`"
    return f"**{name}**" if attribute.get("use") == "required" else name


def _meaning(attribute: ET.Element) -> str:
    values = [item.get("value", "") for item in attribute.iter(f"{XS}enumeration")]
    allowed = "one of " + ", ".join(f"`{value}`" for value in values) if values else ""
    return "; ".join(part for part in (_words(attribute), allowed) if part)
