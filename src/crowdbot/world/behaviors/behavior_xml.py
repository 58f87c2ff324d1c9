"""Behaviour trees from the XML of BehaviorTree.CPP, versions 3 and 4 (https://www.behaviortree.dev)."""

from __future__ import annotations

import math
import posixpath
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NoReturn

from crowdbot.core import Element, InputError, did_you_mean, parse_number, parse_xml
from crowdbot.world.reactions.reaction import RobotReaction

from .behavior_tree import PERSON, STEP, UNWRITTEN, BehaviorTree, Entry, Node
from .node_kinds import (
    CONTROL_PORTS,
    CONTROLS,
    DECORATORS,
    KINDS,
    LEAVES,
    OTHER_NAMES,
    OTHER_PORTS,
    TIMED,
    Port,
)

MOST_FILES, MOST_NODES, MOST_DEPTH = 20, 1000, 100
KEY = re.compile(r"[A-Za-z_]\w{0,63}", re.ASCII)
EXPLICIT = ("Action", "Condition", "Control", "Decorator")
"""Elements that name the kind of their node in the attribute ``ID``."""
WORDS = {"true": 1.0, "false": 0.0}
_CONSTANT = -1

Load = Callable[[str], bytes]


def parse_behavior_tree(
    data: bytes, place: str, load: Load | None = None, *, tree: str = "", regular: str = "regular"
) -> BehaviorTree:
    """Read a behaviour tree.

    Control nodes, decorators, ``<SubTree>`` with its ports, ``<include path="...">`` and the blackboard are read as
    BehaviorTree.CPP reads them. Entries of the blackboard are numbers, true or false; ``{id}`` is the person and
    ``{dt}`` the time step.

    Args:
        data: bytes of the file.
        place: path of the file, for messages and as the start of the paths of includes.
        load: returns the bytes of an included file by its path (default: includes are refused).
        tree: name of the tree (default: ``main_tree_to_execute``, or the only one in the file).
        regular: how robots are seen while people walk: ``regular``, ``ignore`` or ``impassive``.

    Raises:
        InputError: the text is not XML or has entities, or a node, port or tree is unknown or not allowed.

    >>> text = b'<root><BehaviorTree ID="a"><RegularNav agent_id="{id}"/></BehaviorTree></root>'
    >>> parse_behavior_tree(text, "a.xml").root.kind
    'RegularNav'
    """
    if regular not in ("regular", "ignore", "impassive"):
        raise InputError(f"regular = {regular!r} must be regular, ignore or impassive")
    reader = _Reader(load)
    root = reader.read(data, place)
    name = tree or root.attributes.get("main_tree_to_execute", "")
    if not name:
        own = [one.attributes.get("ID", "") for one in root.each("BehaviorTree")]
        if len(own) != 1:
            names = ", ".join(own) or "none"
            raise InputError(f"{place}: main_tree_to_execute must name one of the trees; the file has {names}")
        name = own[0]
    if name not in reader.trees:
        known = ", ".join(sorted(reader.trees)) or "none"
        raise InputError(
            f"{place}: there is no tree {name[:40]!r}{did_you_mean(name, tuple(reader.trees))}; known are {known}"
        )
    scope = _Scope(reader.entries, outer={"id": PERSON, "dt": STEP})
    found = reader.tree(name, scope, ())
    reader.check_reads()
    return BehaviorTree(found, tuple(reader.entries.values), tuple(reader.entries.names), name, regular)


@dataclass
class _Entries:
    """Entries of the blackboards of all scopes: names, initial values, and what writes them."""

    names: list[str] = field(default_factory=lambda: ["id", "dt"])
    values: list[float] = field(default_factory=lambda: [0.0, 0.0])
    sources: list[set[int | None]] = field(default_factory=lambda: [{PERSON}, {STEP}])
    """Entries that are copied to each entry; None for a constant."""

    def add(self, name: str) -> int:
        self.names.append(name)
        self.values.append(UNWRITTEN)
        self.sources.append(set())
        return len(self.names) - 1

    def origins(self, number: int) -> set[int | None]:
        """Return what an entry can hold: ``PERSON``, ``STEP``, or None for another number."""
        found: set[int | None] = set()
        seen, ahead = {number}, [number]
        while ahead:
            for source in self.sources[ahead.pop()]:
                if source is None or source in (PERSON, STEP):
                    found.add(source)
                elif source not in seen:
                    seen.add(source)
                    ahead.append(source)
        return found


@dataclass
class _Scope:
    """Names of entries in one tree: its own ones, and those of the tree around it that it shares."""

    entries: _Entries
    outer: dict[str, int] = field(default_factory=dict)
    shared: _Scope | None = None

    def entry(self, key: str) -> int:
        if key not in self.outer:
            self.outer[key] = self.entries.add(key) if self.shared is None else self.shared.entry(key)
        return self.outer[key]


@dataclass
class _Reader:
    """Reads files, and makes the nodes of a tree."""

    load: Load | None
    trees: dict[str, tuple[Element, str, bool]] = field(default_factory=dict)
    files: set[str] = field(default_factory=set)
    entries: _Entries = field(default_factory=_Entries)
    reads: list[tuple[Element, str, str, int]] = field(default_factory=list)
    """Element, file and name of each port with the entry that it reads; ``_CONSTANT`` for a constant."""
    count: int = 0

    def read(self, data: bytes, place: str) -> Element:
        """Read a file with its includes, and return its root element."""
        self.files.add(place)
        if len(self.files) > MOST_FILES:
            raise InputError(f"{place}: more than {MOST_FILES} files are included, which no behaviour tree needs")
        root = parse_xml(data, place, what="behaviour tree", root="root")
        if root.tag != "root":
            raise InputError(f"{place}:{root.line}: the root element must be <root>, not <{root.tag[:40]}>")
        version = root.attributes.get("BTCPP_format", "3")
        if version not in ("3", "4"):
            raise InputError(f'{place}:{root.line}: BTCPP_format="{version[:40]}" must be 3 or 4')
        for inner in root.children:
            if inner.tag == "include":
                self._include(inner, place)
            elif inner.tag == "BehaviorTree":
                self._add(inner, place, version == "4")
            elif inner.tag != "TreeNodesModel":
                self._refuse(inner, place, "is not allowed here; <root> has BehaviorTree, include and TreeNodesModel")
        return root

    def _include(self, element: Element, place: str) -> None:
        path = element.attributes.get("path", "")
        if not path or "ros_pkg" in element.attributes:
            self._refuse(element, place, "needs a path beside this file; packages of ROS (ros_pkg) are not searched")
        if self.load is None:
            self._refuse(element, place, "cannot be read from a text alone; put the tree into one file")
        name = posixpath.normpath(posixpath.join(posixpath.dirname(place), path))
        if name in self.files:
            return
        try:
            data = self.load(name)
        except InputError as error:
            raise InputError(f"{place}:{element.line}: <include>: {error}") from None
        self.read(data, name)

    def _add(self, element: Element, place: str, new: bool) -> None:
        name = element.attributes.get("ID", "")
        if not name:
            self._refuse(element, place, "needs the attribute ID")
        if name in self.trees:
            self._refuse(element, place, f"ID={name[:40]!r} exists already, in {self.trees[name][1]}")
        if len(element.children) != 1:
            self._refuse(element, place, f"has {len(element.children)} nodes, it must have one")
        self.trees[name] = (element, place, new)

    def tree(self, name: str, scope: _Scope, path: tuple[str, ...]) -> Node:
        """Return the root node of a tree."""
        element, place, new = self.trees[name]
        return self._node(element.children[0], place, new, scope, (*path, name), 0)

    def _node(self, element: Element, place: str, new: bool, scope: _Scope, path: tuple[str, ...], depth: int) -> Node:
        slot, self.count = self.count, self.count + 1
        if slot >= MOST_NODES or depth > MOST_DEPTH:
            self._refuse(
                element, place, f"is one too many: a tree has at most {MOST_NODES} nodes on {MOST_DEPTH} levels"
            )
        attributes = dict(element.attributes)
        kind = attributes.pop("ID", "") if element.tag in EXPLICIT else element.tag
        kind = OTHER_NAMES.get(kind, kind)
        if kind not in KINDS:
            self._refuse(element, place, f"is no known node{did_you_mean(kind, KINDS)}; known are {', '.join(KINDS)}")
        attributes.pop("name", None)
        where = f"{place}:{element.line}"
        if kind == "SubTree":
            return self._subtree(element, place, new, scope, path, slot, depth, attributes)
        self._check_children(element, place, kind)
        inner = tuple(self._node(one, place, new, scope, path, depth + 1) for one in element.children)
        if kind == "SetBlackboard":
            return self._set(element, place, scope, slot, attributes)
        known = dict(CONTROL_PORTS.get(kind) or (LEAVES[kind].ports if kind in LEAVES else {}))
        attributes = {OTHER_PORTS.get(word, word): text for word, text in attributes.items()}
        attributes = self._without_person(element, place, kind, scope, attributes)
        reaction = self._reaction(element, place, kind, attributes) if kind in LEAVES else None
        ports: dict[str, float | Entry] = {}
        for word, text in attributes.items():
            if word not in known:
                takes = [*known, *(LEAVES[kind].parameters if kind in LEAVES else ())]
                self._refuse(
                    element, place,
                    f"has no port {word[:40]!r}{did_you_mean(word, tuple(takes))}; it takes"
                    f" {', '.join(takes) or 'none'}",
                )  # fmt: skip
            ports[word] = self._port(element, place, scope, word, text, known[word])
        for word, port in known.items():
            if word in ports:
                continue
            if kind == "TimeExpiredCondition" and word == "ts":
                ports[word] = Entry(STEP)
            elif port.default is None:
                self._refuse(element, place, f"needs the port {word!r}")
            else:
                ports[word] = port.default
        if kind == "Parallel":
            self._check_parallel(element, place, ports)
        return Node(kind, slot, inner, ports, None, reaction, 4 if new else 3, where)

    def _subtree(
        self, element: Element, place: str, new: bool, scope: _Scope, path: tuple[str, ...], slot: int, depth: int,
        attributes: dict[str, str],
    ) -> Node:  # fmt: skip
        name = attributes.pop("ID", "")
        if element.children:
            self._refuse(element, place, "must be empty: the nodes stand in its BehaviorTree")
        if name not in self.trees:
            known = ", ".join(sorted(self.trees))
            self._refuse(element, place, f"ID={name[:40]!r}{did_you_mean(name, tuple(self.trees))} is none of {known}")
        if name in path:
            self._refuse(element, place, f"ID={name[:40]!r} contains itself: {' > '.join((*path, name))[:200]}")
        inner = _Scope(self.entries)
        for word in ("_autoremap", "__autoremap", "__shared_blackboard"):
            if word in attributes and self._constant(element, place, word, attributes.pop(word)):
                inner.shared = scope
        plain = not new and element.tag == "SubTree"  # there, a port is the name of an entry, without braces
        for word, text in attributes.items():
            self._check_key(element, place, word)
            key = text[1:-1] if text.startswith("{") and text.endswith("}") else text if plain else ""
            if key:
                inner.outer[word] = scope.entry(self._check_key(element, place, key))
            else:
                number = inner.outer[word] = self.entries.add(word)
                self.entries.values[number] = self._constant(element, place, word, text)
                self.entries.sources[number].add(None)
        other, its_place, its_new = self.trees[name]
        below = self._node(other.children[0], its_place, its_new, inner, (*path, name), depth + 1)
        return Node("SubTree", slot, (below,), place=f"{place}:{element.line}")

    def _set(self, element: Element, place: str, scope: _Scope, slot: int, attributes: dict[str, str]) -> Node:
        if set(attributes) != {"value", "output_key"}:
            self._refuse(element, place, "takes value and output_key, both")
        key = attributes["output_key"]
        key = key[1:-1] if key.startswith("{") and key.endswith("}") else key
        output = Entry(scope.entry(self._check_key(element, place, key)))
        if output.number in (PERSON, STEP):
            self._refuse(element, place, "cannot write id and dt of the person")
        value = self._port(element, place, scope, "value", attributes["value"], Port(None, -1e9, 1e9))
        self.entries.sources[output.number].add(value.number if isinstance(value, Entry) else None)
        return Node("SetBlackboard", slot, (), {"value": value}, output, place=f"{place}:{element.line}")

    def _without_person(
        self, element: Element, place: str, kind: str, scope: _Scope, attributes: dict[str, str]
    ) -> dict[str, str]:
        """Return the attributes without those that name the person and the time step, which are to be checked."""
        rest = dict(attributes)
        for word, kinds in (("agent_id", tuple(LEAVES)), ("time_step", TIMED)):
            if word not in rest or kind not in kinds:
                continue
            value = self._port(element, place, scope, word, rest.pop(word), Port(None, -1e9, 1e9))
            number = value.number if isinstance(value, Entry) else _CONSTANT
            self.reads.append((element, place, word, number))
        return rest

    def check_reads(self) -> None:
        """Refuse ports that read entries which nothing writes, or which name another person or time step."""
        for element, place, word, number in self.reads:
            origins = {None} if number == _CONSTANT else self.entries.origins(number)
            if not origins:
                known = ", ".join(sorted({f"{{{name}}}" for name in self.entries.names}))
                self._refuse(
                    element, place,
                    f"{word} reads {{{self.entries.names[number]}}}, which nothing writes; entries are {known}",
                )  # fmt: skip
            if word == "agent_id" and origins != {PERSON}:
                self._refuse(element, place, "agent_id must be the person of the tree, {id}: nobody moves another one")
            if word == "time_step" and origins != {STEP}:
                self._refuse(element, place, "time_step must be the time step of the world, {dt}")

    def _reaction(self, element: Element, place: str, kind: str, attributes: dict[str, str]) -> RobotReaction | None:
        """Return the reaction of an action; its parameters are taken out of the attributes."""
        row = LEAVES[kind]
        if not row.reaction:
            return None
        values: dict[str, Any] = {} if row.speed is None else {"speed": row.speed}
        for word in row.parameters:
            if word in attributes:
                text = attributes.pop(word)
                values[word] = text.strip() if word == "gesture" else self._constant(element, place, word, text)
        try:
            return RobotReaction(row.reaction, **values)
        except InputError as error:
            self._refuse(element, place, str(error).removeprefix("RobotReaction: "))

    def _port(self, element: Element, place: str, scope: _Scope, word: str, text: str, port: Port) -> float | Entry:
        text = text.strip()
        if text.startswith("{") and text.endswith("}"):
            number = scope.entry(self._check_key(element, place, text[1:-1]))
            self.reads.append((element, place, f"port {word}", number))
            return Entry(number)
        value = self._constant(element, place, word, text)
        if not port.least <= value <= port.most or (port.whole and value != math.floor(value)):
            whole = "a whole number " if port.whole else ""
            self._refuse(element, place, f'{word}="{text[:40]}" must be {whole}from {port.least:g} to {port.most:g}')
        return value

    def _constant(self, element: Element, place: str, word: str, text: str) -> float:
        if text.strip().lower() in WORDS:
            return WORDS[text.strip().lower()]
        try:
            return parse_number(text)
        except InputError as error:
            self._refuse(element, place, f'{word}="{text[:40]}" {error}; entries are numbers, true or false')

    def _check_key(self, element: Element, place: str, key: str) -> str:
        if key.startswith("_") or not KEY.fullmatch(key):
            self._refuse(
                element, place,
                f"{key[:40]!r} is no name of an entry or port: a letter, then letters, digits or underscores;"
                " conditions such as _skipIf and scripts are not read",
            )  # fmt: skip
        return key

    def _check_children(self, element: Element, place: str, kind: str) -> None:
        count = len(element.children)
        if kind in CONTROLS and not count:
            self._refuse(element, place, "has no nodes, it must have at least one")
        if kind in DECORATORS and count != 1:
            self._refuse(element, place, f"has {count} nodes, it must have one")
        if kind in LEAVES and count:
            self._refuse(element, place, "is a condition or an action, which has no nodes below it")

    def _check_parallel(self, element: Element, place: str, ports: dict[str, float | Entry]) -> None:
        for word, value in ports.items():
            if not isinstance(value, Entry) and value > len(element.children):
                self._refuse(element, place, f"{word} = {value:g} is more than its {len(element.children)} nodes")

    def _refuse(self, element: Element, place: str, problem: str) -> NoReturn:
        tag = element.attributes.get("ID", "") if element.tag in EXPLICIT else ""
        raise InputError(f"{place}:{element.line}: <{(tag or element.tag)[:40]}> {problem}")
