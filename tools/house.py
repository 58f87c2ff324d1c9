"""Measure the structure and the names of the package: ``python tools/house.py [SOURCE] [--list] [--tighten]``.

Prints one figure per rule and fails if a figure is above its limit in ``tools/house.toml``. ``--list`` prints every
breach, ``--tighten`` lowers the limits to today's figures. Imports inside functions and type-only imports count.
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
RULES = HERE / "house.toml"
LARGEST_FOLDER = 25
LONGEST_FILE = 900
LONGEST_FUNCTION = 60
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
        return self.name if self.path.name == "__init__.py" else self.name.rpartition(".")[0]

    @property
    def room(self) -> str:
        """First name below the package, empty for the package itself."""
        return (self.name.split(".") + [""])[1]


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
    for one, others in edges.items():
        for other in others:
            reverse[other].add(one)
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
            if not (modules[target].path.name == "__init__.py" and name.startswith(f"{target}."))
        }
        for name, module in modules.items()
    }
    return [f"{name} (circle of {len(group)})" for group in find_circles(edges) for name in group]


def deep_imports(modules: dict[str, Module], kernels: set[str]) -> tuple[list[str], list[str]]:
    """Return the imports past the face of another room: all, and those of modules other than the kernels."""
    every, other = [], []
    for module in modules.values():
        for target, line in imports(module, modules):
            room = modules[target].room
            if module.room and room != module.room and target.count(".") > 1:
                every.append(f"{module.path}:{line} {target}")
                if target not in kernels:
                    other.append(every[-1])
    return every, other


def function_length(node: Function) -> int:
    """Return the number of lines of a function without its docstring."""
    doc = ast.get_docstring(node, clean=False)
    return (node.end_lineno or node.lineno) - node.lineno + 1 - (doc.count("\n") + 1 if doc else 0)


def long_functions(modules: dict[str, Module]) -> list[str]:
    """Return the functions above the limit."""
    return [
        f"{module.path}:{node.lineno} {node.name} has {function_length(node)} lines"
        for module in modules.values()
        for node in module.nodes
        if isinstance(node, Function) and function_length(node) > LONGEST_FUNCTION
    ]


def class_places(modules: dict[str, Module]) -> dict[str, list[str]]:
    """Return where each public class is defined."""
    places: dict[str, list[str]] = defaultdict(list)
    for module in modules.values():
        for node in module.nodes:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(f"{module.path}:{node.lineno}")
    return places


def public_functions(modules: dict[str, Module]) -> Iterator[tuple[str, str]]:
    """Yield place and name of public functions and methods; properties that answer yes or no are left out."""
    for module in modules.values():
        for owner in [module.tree, *(node for node in module.tree.body if isinstance(node, ast.ClassDef))]:
            if isinstance(owner, ast.ClassDef) and owner.name.startswith("_"):
                continue
            for node in owner.body:
                if isinstance(node, Function) and not node.name.startswith("_") and not _is_flag(node):
                    yield f"{module.path}:{node.lineno}", node.name


def _is_flag(node: Function) -> bool:
    decorators = [ast.unparse(decorator) for decorator in node.decorator_list]
    answer = ast.unparse(node.returns) if node.returns else ""
    return any(name in ("property", "functools.cached_property", "cached_property") for name in decorators) and (
        answer == "bool" or "NDArray[np.bool" in answer or "BoolArray" in answer
    )


def is_participle(name: str, words: set[str], particles: set[str]) -> bool:
    """Return whether a participle heads a name: ``told``, ``rows_kept``, ``gone_on``, but not ``desired_velocity``."""
    parts = name.split("_")
    if parts[0] in ("is", "has", "are", "was"):
        return False
    return parts[-1] in words or (parts[0] in words and len(parts) > 1 and parts[1] in particles)


def words_of(name: str) -> list[str]:
    """Return the words of a name in lower case, from CamelCase or snake_case."""
    return [word.lower() for word in re.findall(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])", name)]


def measure(source: Path, rules: dict[str, dict[str, list[str]]]) -> dict[str, list[str]]:
    """Return the breaches of every rule."""
    modules = read_package(source)
    places = class_places(modules)
    every, other = deep_imports(modules, {f"{source.name}.{name}" for name in rules["deep"]["kernels"]})
    participles, particles = set(rules["participles"]["words"]), set(rules["participles"]["particles"])
    contact = set(rules["contact"]["words"])
    functions = list(public_functions(modules))
    folders = Counter(str(module.path.parent) for module in modules.values())
    names = [*functions, *((place, name) for name, found in places.items() for place in found)]
    return {
        "modules in import circles": circles(modules),
        f"folders above {LARGEST_FOLDER} files": [f"{d}: {k}" for d, k in folders.items() if k > LARGEST_FOLDER],
        f"files above {LONGEST_FILE} lines": [
            f"{module.path}: {module.lines}" for module in modules.values() if module.lines > LONGEST_FILE
        ],
        f"functions above {LONGEST_FUNCTION} lines": long_functions(modules),
        "deep imports": every,
        "deep imports beyond the kernels of core": other,
        "class names used twice": [f"{name}: {', '.join(p)}" for name, p in sorted(places.items()) if len(p) > 1],
        "participles among public functions": [
            f"{place} {name}"
            for place, name in functions
            if is_participle(name, participles, particles) and name not in rules["participles"]["allowed"]
        ],
        "other words for contact": [
            f"{place} {name}"
            for place, name in names
            if contact.intersection(words_of(name)) and name not in rules["contact"]["allowed"]
        ],
    }


def main(words: list[str] | None = None) -> int:
    """Print the figures; return 1 if one is above its limit."""
    parser = argparse.ArgumentParser(description="structure and names of the package against tools/house.toml")
    parser.add_argument("source", nargs="?", type=Path, default=HERE.parent / "src" / "crowdbot", help="package folder")
    parser.add_argument("--list", action="store_true", help="print every breach")
    parser.add_argument("--tighten", action="store_true", help="lower the limits to today's figures")
    options = parser.parse_args(words)
    rules = tomllib.loads(RULES.read_text(encoding="utf-8"))
    found = measure(options.source.resolve(), rules)
    over = 0
    for rule, breaches in found.items():
        limit = rules["limits"][rule]
        above = len(breaches) > limit
        over += above
        print(f"{len(breaches):5d}  {rule} (limit {limit})" + ("  <- above the limit" if above else ""))
        if breaches and (options.list or above):
            print("".join(f"         {breach}\n" for breach in sorted(breaches)), end="")
    if options.tighten:
        tighten({rule: len(breaches) for rule, breaches in found.items()})
    return int(over > 0)


def tighten(figures: dict[str, int]) -> None:
    """Lower the limits in ``tools/house.toml`` to these figures; none is raised."""
    text = RULES.read_text(encoding="utf-8")
    for rule, figure in figures.items():
        text = re.sub(
            rf'^"{re.escape(rule)}" = (\d+)$',
            lambda match, rule=rule, figure=figure: f'"{rule}" = {min(figure, int(match[1]))}',
            text,
            flags=re.M,
        )
    RULES.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
