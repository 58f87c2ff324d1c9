"""Expansion of xacro files without ROS: includes, arguments, properties, macros and conditions."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import Element, InputError, RobotError, did_you_mean, parse_xml, read_bytes

from .evaluation import Budget
from .scope import Scope, boolean
from .texts import FileSource, Texts

MOST_ELEMENTS = 50_000
MOST_CALLS = 30
MOST_INCLUDES = 20
MOST_FILES = 300
PREFIX = "xacro:"
NAME = re.compile(r"[A-Za-z_]\w*")
DEFAULT = r"""\$\{.*?\}|\$\(.*?\)|'''|(?:'[^']*'|"[^"]*"|[^\s'"]+)+|"""
PARAMETER = re.compile(rf"\s*([^\s:=]+?)\s*:?=\s*(\^\|?)?({DEFAULT})(?:\s+|$)", re.DOTALL)
BARE = re.compile(r"\s*(\S+)(?:\s+|$)")
MOST_PARAMETERS = 200
OLD_TAGS = {
    "macro": "name",
    "property": "name",
    "include": "filename",
    "if": "value",
    "unless": "value",
    "insert_block": "name",
}
"""Elements that xacro read without its prefix until 2020, each with an attribute that it needs."""


class Expansion(NamedTuple):
    """An expanded file.

    Fields:
        root: the root element.
        ignored: sentences about includes and macros that were left out.
        arguments: names and values of all arguments.
        macros: names of all macros.
    """

    root: Element
    ignored: tuple[str, ...]
    arguments: Mapping[str, str]
    macros: tuple[str, ...] = ()


def is_xacro(root: Element) -> bool:
    """Return whether an element tree has xacro elements or expressions.

    >>> is_xacro(Element("robot", {"name": "${a}"})), is_xacro(Element("robot", {"name": "a"}))
    (True, False)
    """
    waiting = [root]
    while waiting:
        element = waiting.pop()
        if element.tag.startswith(PREFIX) or any("${" in text or "$(" in text for text in element.attributes.values()):
            return True
        waiting.extend(element.children)
    return False


def expand_xacro(
    root: Element,
    place: str,
    files: FileSource,
    *,
    path: Path | None = None,
    arguments: Mapping[str, str] | None = None,
    environment: Mapping[str, str] | None = None,
) -> Expansion:
    """Return the expansion of a xacro file.

    Expressions are parsed, never evaluated as Python. An include of a file that does not exist is left out and listed
    in ``ignored``, as are calls of macros that it may define.

    Args:
        root: root element of the file.
        place: file name for messages.
        files: files that may be included.
        path: the file, for relative names.
        arguments: values of ``<xacro:arg>`` by name.
        environment: values of ``$(env)`` and ``$(optenv)``; the environment of the process is not read.

    Raises:
        RobotError: the file has an error, or exceeds a limit; the sentence begins with file and line.

    >>> text = b'<r><xacro:property name="a" value="2"/><b c="${a * 3}"/></r>'
    >>> expand_xacro(parse_xml(text, "r.xacro"), "r.xacro", None).root.children[0].attributes
    {'c': '6'}
    """
    texts = Texts(files, arguments or {}, environment or {}, Budget())
    texts.file = path
    expander = _Expander(texts)
    whole = with_place(root, place)
    made = expander.top(whole)
    unused = [name for name in (arguments or {}) if name not in expander.declared]
    if unused:
        meant = did_you_mean(unused[0], expander.declared)
        listed = ", ".join(sorted(expander.declared)[:20]) or "none"
        raise RobotError(f"{place}: there is no argument {unused[0][:60]!r}{meant}; the file has {listed}")
    values = {key: str(text) for key, text in texts.arguments.items()}
    return Expansion(made, tuple(expander.ignored), values, tuple(expander.macros))


class _Expander:
    """Expands elements in the order of the file."""

    def __init__(self, texts: Texts) -> None:
        self.texts = texts
        self.macros: dict[str, Macro] = {}
        self.declared: set[str] = set()
        self.ignored: list[str] = []
        self.missing = ""
        self.prefix = ""
        self.calls = self.includes = self.files = self.made = 0
        self.now: Element | None = None
        self.old = False

    def top(self, root: Element) -> Element:
        """Return the expanded root element; errors name file and line."""
        self.now = root
        try:
            return self.copy(root, Scope(self.texts.value))
        except RobotError:
            raise
        except (InputError, RecursionError, OSError) as error:
            at = self.now or root
            what = "the elements are nested too deep" if isinstance(error, RecursionError) else str(error)
            if self.missing and "is not defined" in what:
                what += f"; the included file {self.missing} is missing{self.advice(self.missing)}"
            raise RobotError(f"{at.place}:{at.line}: <{at.tag[:60]}>: {what}") from None

    def copy(self, source: Element, scope: Scope) -> Element:
        """Return an element with its texts evaluated and its children expanded."""
        self.made += 1
        if self.made > MOST_ELEMENTS:
            raise InputError(f"the expansion has more than {MOST_ELEMENTS} elements, the maximum")
        attributes = {
            key: self.texts.text(text, scope)
            for key, text in source.attributes.items()
            if not key.startswith((PREFIX, "xmlns"))
        }
        stray = self.texts.text(source.stray, scope)
        source_element = Element(source.tag, attributes, [], line=source.line, stray=stray, place=source.place)
        self.fill(source, scope, source_element)
        return source_element

    def fill(self, source: Element, scope: Scope, into: Element) -> None:
        """Expand the children of an element into another one."""
        for child in source.children:
            before, self.now = self.now, child
            self.texts.budget.spend()
            self.expand(child, scope, into)
            self.now = before

    def expand(self, element: Element, scope: Scope, into: Element) -> None:
        """Expand one element into another one."""
        if not element.tag.startswith(PREFIX):
            if not self.is_old(element):
                into.children.append(self.copy(element, scope))
                return
            if not self.old:
                self.ignored.append(
                    f"{element.place}:{element.line}: <{element.tag[:60]}> has no 'xacro:' before its name, which xacro"
                    " no longer accepts; this one and all others like it are read as if they had"
                )
            self.old = True
            element = _renamed(element, PREFIX + element.tag)
        kind = element.tag[len(PREFIX) :]
        if kind in ("if", "unless"):
            if boolean(self.texts.value(self.required(element, "value"), scope)) == (kind == "if"):
                self.fill(element, scope, into)
        elif kind == "property":
            self.property(element, scope)
        elif kind == "macro":
            name = self.required(element, "name").removeprefix(PREFIX)
            parameters = parse_parameters(element.attributes.get("params", ""))
            self.macros[self.prefix + name] = Macro(element, parameters, self.prefix)
        elif kind == "arg":
            name = self.required(element, "name")
            self.declared.add(name)
            if name not in self.texts.arguments and "default" in element.attributes:
                self.texts.arguments[name] = self.texts.value(element.attributes["default"], scope)
        elif kind == "include":
            self.include(element, scope, into)
        elif kind == "insert_block":
            self.insert(element, scope, into)
        elif kind == "attribute":
            name = self.texts.text(self.required(element, "name"), scope)
            into.attributes[name] = self.texts.text(self.required(element, "value"), scope)
        elif kind == "element":
            tag = self.texts.text(self.required(element, "xacro:name"), scope)
            self.expand(_renamed(element, tag), scope, into)
        elif kind == "call":
            name = self.texts.text(self.required(element, "macro"), scope)
            rest = {key: text for key, text in element.attributes.items() if key != "macro"}
            self.call(_renamed(element, PREFIX + name, rest), scope, into)
        else:
            self.call(element, scope, into)

    def is_old(self, element: Element) -> bool:
        """Return whether an element without prefix is one of xacro, or calls a macro with the parameters it needs."""
        if element.tag in OLD_TAGS:
            return OLD_TAGS[element.tag] in element.attributes
        macro = self.macros.get(self.prefix + element.tag) or self.macros.get(element.tag)
        if macro is None or not macro.parameters or not self.old:  # <box size> may have a macro beside it
            return False
        names = {parameter.name for parameter in macro.parameters}
        needed = {row.name for row in macro.parameters if row.default is None and not row.name.startswith("*")}
        return needed <= element.attributes.keys() <= names

    def required(self, element: Element, key: str) -> str:
        if key not in element.attributes:
            raise InputError(f"needs the attribute {key!r}")
        return element.attributes[key]

    def property(self, element: Element, scope: Scope) -> None:
        """Set or remove a property."""
        row = element.attributes
        name = self.texts.text(self.required(element, "name"), scope)
        if not NAME.fullmatch(name) or name.startswith("__"):
            raise InputError(f"the property name {name[:60]!r} must be letters, digits and _, not beginning with '__'")
        if boolean(self.texts.value(row.get("remove", "false"), scope)):
            scope.remove(name)
            return
        value = row.get("value")
        if value is None and "default" in row:
            if scope.has(name):
                return
            value = row["default"]
        if value is None:
            scope.set_block(f"**{name}", element)
            return
        where = row.get("scope", "")
        if where not in ("", "global", "parent"):
            raise InputError(
                f"scope={where[:40]!r} must be global or parent{did_you_mean(where, ('global', 'parent'))}"
            )
        lazy = not where and boolean(self.texts.value(row.get("lazy_eval", "true"), scope))
        target = {"": scope, "global": scope.top, "parent": scope.parent or scope}[where]
        target.set(name, value if lazy else self.texts.value(value, scope), lazy=lazy)

    def insert(self, element: Element, scope: Scope, into: Element) -> None:
        """Insert a block of a macro call or a property."""
        name = self.texts.text(self.required(element, "name"), scope)
        many, one = scope.block(f"**{name}"), scope.block(f"*{name}")
        if many is not None:
            self.fill(many, scope, into)
        elif one is not None:
            self.expand(one, scope, into)
        else:
            raise InputError(f"there is no block {name[:60]!r}")

    def include(self, element: Element, scope: Scope, into: Element) -> None:
        """Expand another file in place."""
        name = self.texts.text(self.required(element, "filename"), scope)
        path = self.texts.find(name)
        if path is None:
            if not boolean(element.attributes.get("optional", "false")):
                self.missing = self.missing or name[:200]
                self.ignored.append(
                    f"{element.place}:{element.line}: the included file {name[:200]} is missing; it is left out"
                    f"{self.advice(name)}"
                )
            return
        self.includes, self.files = self.includes + 1, self.files + 1
        if self.includes > MOST_INCLUDES or self.files > MOST_FILES:
            raise InputError(
                f"more than {MOST_INCLUDES} files include each other, or more than {MOST_FILES} files are read"
            )
        data = read_bytes(path, "xacro", RobotError)
        root = with_place(parse_xml(data, str(path), what="xacro file", root="robot", refusal=RobotError), str(path))
        space = element.attributes.get("ns", "")
        before, file = self.prefix, self.texts.file
        self.texts.file = path
        if space:
            inner = Scope(self.texts.value)
            scope.set(self.texts.text(space, scope), inner)
            self.prefix, scope = f"{before}{space}.", inner
        self.fill(root, scope, into)
        self.prefix, self.texts.file, self.includes = before, file, self.includes - 1

    def advice(self, name: str) -> str:
        """Return why an included file is missing and what to do, in brackets."""
        why = self.texts.files.lack(name)
        return f" ({why})" if why else ""

    def call(self, element: Element, scope: Scope, into: Element) -> None:
        """Expand a macro."""
        name = element.tag[len(PREFIX) :]
        macro = self.macros.get(self.prefix + name) or self.macros.get(name)
        if macro is None:
            if not self.missing:
                raise InputError(f"the macro {name[:60]!r} is not defined{did_you_mean(name, self.macros)}")
            self.ignored.append(
                f"{element.place}:{element.line}: the macro {name[:60]!r} is not defined, since an included file is"
                " missing; it is left out"
            )
            return
        self.calls += 1
        if self.calls > MOST_CALLS:
            raise InputError(f"macros call each other more than {MOST_CALLS} levels deep")
        inner = self.parameters(element, macro, scope)
        before, self.prefix = self.prefix, macro.prefix
        self.fill(macro.body, inner, into)
        self.prefix, self.calls = before, self.calls - 1

    def parameters(self, element: Element, macro: Macro, scope: Scope) -> Scope:
        """Return the scope of a macro call."""
        inner = Scope(self.texts.value, scope)
        names = [parameter.name for parameter in macro.parameters]
        for name, text in element.attributes.items():
            if name.startswith("xmlns"):
                continue
            if name not in names:
                raise InputError(f"the macro has no parameter {name[:60]!r}{did_you_mean(name, names)}")
            inner.set(name, self.texts.value(text, scope), lazy=False)
        content = Element("", line=element.line, place=element.place)
        self.fill(element, scope, content)
        blocks = [name for name in names if name.startswith("*")]
        if len(blocks) != len(content.children):
            raise InputError(f"the macro needs {len(blocks)} blocks, it is given {len(content.children)}")
        for name, block in zip(blocks, content.children, strict=True):
            inner.set_block(name, block)
        for parameter in macro.parameters:
            if parameter.name in element.attributes or parameter.name.startswith("*"):
                continue
            if parameter.forward and scope.has(parameter.name):
                inner.set(parameter.name, scope.get(parameter.name), lazy=False)
            elif parameter.default is not None:
                inner.set(parameter.name, self.texts.value(parameter.default, scope), lazy=False)
            else:
                raise InputError(f"the macro needs the parameter {parameter.name[:60]!r}")
        return inner


def _renamed(element: Element, tag: str, attributes: dict[str, str] | None = None) -> Element:
    row = dict(element.attributes) if attributes is None else attributes
    return Element(tag, row, element.children, line=element.line, stray=element.stray, place=element.place)


class MacroParameter(NamedTuple):
    """A parameter: name, whether the value of the caller is taken (``^``), and the default text or None."""

    name: str
    forward: bool = False
    default: str | None = None


class Macro(NamedTuple):
    """A macro: its element, parameters, the prefix of its name space and the folder of its file."""

    body: Element
    parameters: tuple[MacroParameter, ...]
    prefix: str


def parse_parameters(text: str) -> tuple[MacroParameter, ...]:
    """Return the parameters of a macro.

    Raises:
        InputError: there are too many.

    >>> parse_parameters("side radius:=0.1 *origin")[1]
    MacroParameter(name='radius', forward=False, default='0.1')
    """
    macro_parameters: list[MacroParameter] = []
    place, text = 0, text.strip()
    while place < len(text):
        match = PARAMETER.match(text, place)
        if match is not None:
            name, forward, default = match.groups()
            macro_parameters.append(MacroParameter(name, bool(forward), default or ("" if not forward else None)))
        else:
            match = BARE.match(text, place)
            assert match is not None
            macro_parameters.append(MacroParameter(match.group(1)))
        place = match.end()
        if len(macro_parameters) > MOST_PARAMETERS:
            raise InputError(f"a macro has more than {MOST_PARAMETERS} parameters")
    return tuple(macro_parameters)


def with_place(element: Element, place: str) -> Element:
    """Return a copy of an element and its children with the name of their file."""
    children = [with_place(child, place) for child in element.children]
    return dataclasses.replace(element, attributes=dict(element.attributes), children=children, place=place)
