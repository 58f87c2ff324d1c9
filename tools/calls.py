"""Functions in sources, and the tests that call them by the records of ``call_recorder.py``.

A call is ``path:name`` with the qualified name of Python, such as ``core/clock.py:Clock.advance``. The records lack the
calls of compiled kernels, and of functions that keep their results (``functools.cache``) all calls but the first. Who
mentions such a function counts as its caller.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HIDING = re.compile(r"\b(kernel|njit|vectorize|cache|lru_cache)\b")
Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


@dataclass(frozen=True)
class Place:
    """A function or class in a source file.

    Attributes:
        name: qualified name.
        first: first line, decorators included.
        body: first line of the body.
        last: last line.
        is_class: whether it is a class.
        hidden: whether the records lack its calls.
    """

    name: str
    first: int
    body: int
    last: int
    is_class: bool
    hidden: bool


def places(text: str) -> list[Place]:
    """Return all functions and classes of a source, outer before inner."""
    return list(_places(ast.parse(text).body, ""))


def _places(nodes: Iterable[ast.AST], prefix: str) -> Iterator[Place]:
    for node in nodes:
        if not isinstance(node, Definition):
            yield from _places(ast.iter_child_nodes(node), prefix)
            continue
        is_class = isinstance(node, ast.ClassDef)
        first = min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
        hidden = not is_class and any(HIDING.search(ast.unparse(item)) for item in node.decorator_list)
        yield Place(prefix + node.name, first, node.body[0].lineno, node.end_lineno or first, is_class, hidden)
        yield from _places(node.body, f"{prefix}{node.name}." if is_class else f"{prefix}{node.name}.<locals>.")


def place_at(text: str, line: int) -> Place | None:
    """Return the innermost function or class around a line, or None at the level of the module."""
    around = [place for place in places(text) if place.first <= line <= place.last]
    return around[-1] if around else None


def function_body_at(text: str, line: int) -> str:
    """Return the name of the innermost function whose body has a line, empty outside of all."""
    around = [place for place in places(text) if not place.is_class and place.body <= line <= place.last]
    return around[-1].name if around else ""


def idle_lines(text: str) -> set[int]:
    """Return the lines whose change changes no result: empty, comments, docstrings, imports."""
    found = {k for k, line in enumerate(text.splitlines(), 1) if not line.strip() or line.lstrip().startswith("#")}
    for node in ast.walk(ast.parse(text)):
        value = node.value if isinstance(node, ast.Expr) else None
        is_text = isinstance(value, ast.Constant) and isinstance(value.value, str)
        if is_text or isinstance(node, ast.Import | ast.ImportFrom):
            found |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return found


def callers(records: Mapping[str, Mapping[str, Any]], path: str, name: str) -> list[str]:
    """Return the tests that call a function, or any function of the module ``path`` for an empty name."""
    call = f"{path}:{name}"
    if name:
        return [test for test, record in records.items() if call in record["calls"]]
    return [test for test, record in records.items() if any(item.startswith(call) for item in record["calls"])]


def mentions(sources: Path, path: str, place: Place) -> set[tuple[str, str]]:
    """Return path and name of the functions that mention a hidden function, directly or through other hidden ones.

    An empty name stands for the level of a module.
    """
    texts = {file.relative_to(sources).as_posix(): file.read_text(encoding="utf-8") for file in sources.rglob("*.py")}
    result: set[tuple[str, str]] = set()
    waiting, known = [(path, place.name)], {(path, place.name)}
    while waiting:
        home, name = waiting.pop()
        word = re.compile(rf"\b{re.escape(name.rsplit('.', 1)[-1])}\b")
        for file, text in texts.items():
            if not word.search(text) or not (file == home or _imports(text, word)):
                continue
            for other in _places_of(word, text):
                if other is None or not other.hidden:
                    result.add((file, other.name if other else ""))
                elif (file, other.name) not in known:
                    known.add((file, other.name))
                    waiting.append((file, other.name))
    return result


def _imports(text: str, word: re.Pattern[str]) -> bool:
    """Return whether a source imports a name from a module."""
    nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]
    return any(word.fullmatch(alias.name) for node in nodes for alias in node.names)


def _places_of(word: re.Pattern[str], text: str) -> set[Place | None]:
    """Return the innermost functions around the lines with a word; None is the level of the module or a class."""
    skipped, functions = idle_lines(text), [place for place in places(text) if not place.is_class]
    lines = [k for k, line in enumerate(text.splitlines(), 1) if k not in skipped and word.search(line)]
    around = [[place for place in functions if place.first <= line <= place.last] for line in lines]
    return {item[-1] if item else None for item in around}


def within(tests: Iterable[str], seconds: Mapping[str, float], limit: float) -> list[str]:
    """Return the tests that fit into a time one after the other, at least the first."""
    chosen: list[str] = []
    total = 0.0
    for test in tests:
        total += seconds[test]
        if not chosen or total <= limit:
            chosen.append(test)
    return chosen
