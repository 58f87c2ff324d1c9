"""Measure the structure of the package: ``python tools/house.py [SOURCE] [--list]``.

Circular imports and imports past the face of another room fail. The other rules are reported with a count, and
``--list`` prints each place. Imports inside functions and type-only imports count.
"""

from __future__ import annotations

import argparse
import ast
import gc
import sys
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

HERE = Path(__file__).parent
RULES = HERE / "house.toml"
PROJECT = HERE.parent / "pyproject.toml"
SMALL_MODULE = 120
CIRCLES, DEEP = "modules in import circles", "imports past the face of a room"
FAILING = (CIRCLES, DEEP)
PUBLIC = {"_replace", "_asdict", "_make", "_fields", "_field_defaults"}  # methods of named tuples
PUBLIC |= {"_exit", "_current_frames"}  # functions of os and sys
Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Module:
    """A source file: its dotted name, path below the package folder, number of lines, syntax tree and all its nodes."""

    name: str
    path: Path
    lines: int
    tree: ast.Module
    nodes: list[ast.AST]

    @property
    def package(self) -> str:
        """Dotted name of the package that relative imports start from."""
        return self.name if self.is_face else self.name.rpartition(".")[0]

    @property
    def room(self) -> str:
        """First name below the package, empty for the package itself."""
        return (self.name.split(".") + [""])[1]

    @property
    def is_face(self) -> bool:
        """Whether the file is the ``__init__.py`` of a package."""
        return self.path.name == "__init__.py"

    @cached_property
    def exports(self) -> set[str]:
        """Names in ``__all__``, as far as it is written as text; ``*`` of other lists is left out."""
        values = [
            node.value
            for node in self.tree.body
            if isinstance(node, ast.Assign) and [ast.unparse(target) for target in node.targets] == ["__all__"]
        ]
        texts = [leaf for value in values for leaf in ast.walk(value) if isinstance(leaf, ast.Constant)]
        return {leaf.value for leaf in texts if isinstance(leaf.value, str)}

    @cached_property
    def classes(self) -> list[ast.ClassDef]:
        """All class definitions of the file."""
        return [node for node in self.nodes if isinstance(node, ast.ClassDef)]


def read_package(source: Path) -> dict[str, Module]:
    """Return the modules of a package folder by dotted name."""
    modules = {}
    for path in sorted(source.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        relative = path.relative_to(source)
        parts = relative.parts[:-1] if path.name == "__init__.py" else (*relative.parts[:-1], path.stem)
        name = ".".join((source.name, *parts))
        tree = ast.parse(text, str(path))
        modules[name] = Module(name, relative, text.count("\n"), tree, list(ast.walk(tree)))
    return modules


def imports(module: Module, modules: dict[str, Module]) -> Iterator[tuple[str, int]]:
    """Yield the modules of the package that a module imports anywhere, with the line; one for each imported name."""
    for node in module.nodes:
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = module.package.split(".")[: len(module.package.split(".")) - node.level + 1] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            names = [f"{base}.{alias.name}" for alias in node.names]
        for name in names:
            target = name
            while target and target not in modules:
                target = target.rpartition(".")[0]
            if target and target != module.name:
                yield target, node.lineno


def find_circles(edges: dict[str, set[str]]) -> list[list[str]]:
    """Return the groups of modules that reach each other, largest first (Kosaraju's algorithm)."""
    reverse: dict[str, set[str]] = defaultdict(set)
    for source, targets in edges.items():
        for target in targets:
            reverse[target].add(source)
    finished: dict[str, None] = {}
    for start in edges:
        _visit(start, edges, finished)
    placed: dict[str, None] = {}
    groups = []
    for start in reversed(list(finished)):
        before = len(placed)
        _visit(start, reverse, placed)
        groups.append(sorted(list(placed)[before:]))
    return sorted((group for group in groups if len(group) > 1), key=len, reverse=True)


def _visit(start: str, edges: dict[str, set[str]], finished: dict[str, None]) -> None:
    """Add what is reachable from a module to ``finished``, each module after those that it leads to."""
    path, seen = [(start, iter(sorted(edges.get(start, ()))))], {start}
    while path and start not in finished:
        following = next((other for other in path[-1][1] if other not in seen and other not in finished), None)
        if following is None:
            finished[path.pop()[0]] = None
        else:
            seen.add(following)
            path.append((following, iter(sorted(edges.get(following, ())))))


def circles(modules: dict[str, Module]) -> list[str]:
    """Return one entry for each module that takes part in an import circle."""
    edges = {
        name: {
            target
            for target, _ in imports(module, modules)
            if not (modules[target].is_face and name.startswith(f"{target}."))
        }
        for name, module in modules.items()
    }
    return [f"{name} (circle of {len(group)})" for group in find_circles(edges) for name in group]


def deep_imports(modules: dict[str, Module], open_modules: set[str]) -> list[str]:
    """Return imports of another room's modules, except open modules and submodules that the room's face lists."""
    breaches = []
    for module in modules.values():
        for target, line in imports(module, modules):
            room = modules[target].room
            if not module.room or room == module.room or target.count(".") < 2 or target in open_modules:
                continue
            above, _, last = target.rpartition(".")
            if not (above.count(".") == 1 and last in modules[above].exports):
                breaches.append(f"{module.path}:{line} {target}")
    return breaches


def repeated_class_names(modules: dict[str, Module]) -> list[str]:
    """Return the public class names that stand for more than one class."""
    places: dict[str, list[str]] = defaultdict(list)
    for module in modules.values():
        for node in module.classes:
            if not node.name.startswith("_"):
                places[node.name].append(f"{module.path}:{node.lineno}")
    return [f"{name}: {', '.join(found)}" for name, found in sorted(places.items()) if len(found) > 1]


def single_importer_modules(modules: dict[str, Module]) -> list[str]:
    """Return small modules that one module imports and no face exports.

    A module whose classes have a base in common with another module of its folder is one of several implementations
    of a contract, and is left out.
    """
    importers: dict[str, set[str]] = defaultdict(set)
    for name, module in modules.items():
        for target, _ in imports(module, modules):
            importers[target].add(name)
    users: dict[tuple[Path, str], set[str]] = defaultdict(set)
    for name, module in modules.items():
        for base in _base_names(module):
            users[module.path.parent, base].add(name)
    return [
        f"{module.path}: {module.lines} lines, used by {modules[user].path}"
        for name, module in modules.items()
        if not module.is_face and module.lines < SMALL_MODULE and len(importers[name]) == 1
        for user in importers[name]
        if not modules[user].is_face and all(len(users[module.path.parent, base]) < 2 for base in _base_names(module))
    ]


def _base_names(module: Module) -> set[str]:
    names = {_last_name(base) for node in module.classes for base in node.bases}
    return names - {"", "NamedTuple", "Protocol", "Generic", "Exception", "ValueError", "Enum", "StrEnum"}


def _last_name(node: ast.expr) -> str:
    if isinstance(node, ast.Subscript):
        node = node.value
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def single_subclass_bases(modules: dict[str, Module]) -> list[str]:
    """Return the classes with one subclass, except abstract classes that a face exports (a public contract)."""
    subclasses: dict[tuple[str, str], list[str]] = defaultdict(list)
    for module in modules.values():
        libraries = {*_libraries(module)} - {module.name.partition(".")[0]}
        for node in module.classes:
            own = [base for base in node.bases if ast.unparse(base).partition(".")[0] not in libraries]
            for base in map(_last_name, own):
                subclasses[module.name if base.startswith("_") else "", base].append(f"{node.name} in {module.path}")
    exported = set().union(*(module.exports for module in modules.values() if module.is_face))
    breaches = []
    for module in modules.values():
        for node in module.classes:
            found = subclasses[module.name if node.name.startswith("_") else "", node.name]
            if len(found) == 1 and not (node.name in exported and _is_abstract(node)):
                breaches.append(f"{module.path}:{node.lineno} {node.name}: {found[0]}")
    return breaches


def _is_abstract(node: ast.ClassDef) -> bool:
    return any(
        (isinstance(inner, ast.Name | ast.Attribute) and _last_name(inner) in ("ABC", "Protocol", "abstractmethod"))
        or (isinstance(inner, ast.Raise) and inner.exc is not None and "NotImplementedError" in ast.unparse(inner.exc))
        for inner in ast.walk(node)
    )


def private_accesses(modules: dict[str, Module]) -> list[str]:
    """Return the uses of a private name of another object or module.

    A class may use the private names that it defines itself, also those of its other instances.
    """
    breaches = []
    for module in modules.values():
        own = {id(node): names for owner in module.classes for names in [_own_names(owner)] for node in ast.walk(owner)}
        for node in module.nodes:
            if isinstance(node, ast.ImportFrom):
                names = [alias.name for alias in node.names if _is_private(alias.name)]
                breaches += [f"{module.path}:{node.lineno} import {name}" for name in names]
            elif isinstance(node, ast.Attribute) and _is_private(node.attr) and node.attr not in PUBLIC:
                mine = ast.unparse(node.value) in ("self", "cls", "super()")
                if not mine and node.attr not in own.get(id(node), ()):
                    breaches.append(f"{module.path}:{node.lineno} {ast.unparse(node)}")
    return breaches


def _is_private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__")


def _own_names(owner: ast.ClassDef) -> set[str]:
    """Return the methods and fields that a class defines in its body or assigns to ``self``."""
    names = {node.name for node in owner.body if isinstance(node, Function)}
    names |= {ast.unparse(node.target) for node in owner.body if isinstance(node, ast.AnnAssign)}
    names |= {ast.unparse(target) for node in owner.body if isinstance(node, ast.Assign) for target in node.targets}
    return names | {
        node.attr
        for node in ast.walk(owner)
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store) and ast.unparse(node.value) == "self"
    }


def any_types(modules: dict[str, Module], untyped: set[str]) -> list[str]:
    """Return the lines with ``Any`` in modules that import no library without types."""
    breaches = []
    for module in modules.values():
        if not untyped.intersection(_libraries(module)):
            lines = {
                n.lineno for n in module.nodes if isinstance(n, ast.Name | ast.Attribute) and _last_name(n) == "Any"
            }
            breaches += [f"{module.path}:{line}" for line in sorted(lines)]
    return breaches


def _libraries(module: Module) -> Iterator[str]:
    """Yield the top names of the absolute imports of a module."""
    for node in module.nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module.partition(".")[0]


def untyped_libraries() -> set[str]:
    """Return the libraries whose missing types mypy ignores, from ``pyproject.toml``."""
    overrides = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["tool"]["mypy"]["overrides"]
    return {
        name.partition(".")[0] for entry in overrides if entry.get("ignore_missing_imports") for name in entry["module"]
    }


def measure(source: Path, open_modules: set[str], untyped: set[str]) -> dict[str, list[str]]:
    """Return the breaches of every rule.

    Args:
        source: folder of the package.
        open_modules: dotted names below the package that other rooms may import directly.
        untyped: libraries without types; modules that import one may use ``Any``.
    """
    modules = read_package(source)
    return {
        CIRCLES: circles(modules),
        DEEP: deep_imports(modules, {f"{source.name}.{name}" for name in open_modules}),
        "class names used twice": repeated_class_names(modules),
        f"modules below {SMALL_MODULE} lines with one importer": single_importer_modules(modules),
        "bases with one subclass": single_subclass_bases(modules),
        "uses of private names of other objects": private_accesses(modules),
        "lines with Any away from untyped libraries": any_types(modules, untyped),
    }


def main(words: list[str] | None = None) -> int:
    """Print the figures; return 1 if there are circular or deep imports."""
    parser = argparse.ArgumentParser(description="structure of the package; circular and deep imports fail")
    parser.add_argument("source", nargs="?", type=Path, default=HERE.parent / "src" / "crowdbot", help="package folder")
    parser.add_argument("--list", action="store_true", help="print every breach")
    options = parser.parse_args(words)
    rules = tomllib.loads(RULES.read_text(encoding="utf-8"))
    failed = False
    for rule, breaches in measure(options.source.resolve(), set(rules["open"]), untyped_libraries()).items():
        fails = bool(breaches) and rule in FAILING
        failed |= fails
        print(f"{len(breaches):5d}  {rule}" + ("  <- must be 0" if fails else ""))
        if fails or (breaches and options.list):
            print("".join(f"         {breach}\n" for breach in sorted(breaches)), end="")
    return int(failed)


if __name__ == "__main__":
    gc.disable()  # all syntax trees stay to the end; looking through them for garbage takes a third of the time
    sys.exit(main())
