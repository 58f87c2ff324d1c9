"""Digest of the code that a result depends on, so that stored results survive changes of other code.

The digest follows the imports of a module inside some rooms, and reads names from a room through its face. Comments,
docstrings and formatting do not count, and neither does what happens to stored rows: the functions ``summarize...`` and
``judge...`` and the texts of a :class:`~crowdbot.validation.Check`.
"""

from __future__ import annotations

import ast
import functools
import hashlib
from collections.abc import Iterable, Iterator
from pathlib import Path

PACKAGE = Path(__file__).parents[1]
FOLLOWED = ("core", "measurement", "models", "validation")
"""Rooms whose code is followed; names from other rooms do not affect the results of a check."""
EXCLUDED = ("validation.page", "validation.plots", "validation.run", "validation.store", "validation.code_digest")


def code_digest(modules: Iterable[str]) -> str:
    """Return a hash of the code that modules depend on.

    Args:
        modules: full names, such as ``crowdbot.models.forces.boids``; modules outside crowdbot are not hashed.

    >>> own = code_digest(["crowdbot.models.forces.boids"])
    >>> own == code_digest(["crowdbot.models.forces.boids"]), own == code_digest(["crowdbot.models.vision.vbm"])
    (True, False)
    """
    sum_ = hashlib.blake2b(digest_size=8)
    for file in code_files(modules):
        sum_.update(file.relative_to(PACKAGE).as_posix().encode() + b"\0" + _code(file))
    return sum_.hexdigest()


def code_files(modules: Iterable[str]) -> list[Path]:
    """Return the sorted source files that modules depend on, themselves included.

    >>> names = [file.stem for file in code_files(["crowdbot.models.forces.boids"])]
    >>> "scene" in names, "vbm" in names
    (True, False)
    """
    todo, seen = [name for name in modules if name.startswith("crowdbot.")], set[str]()
    while todo:
        name = todo.pop()
        if name not in seen and _followed(name):
            seen.add(name)
            todo += _imports(name)
    files = (_file(name) for name in seen)
    return sorted(file for file in files if file is not None)


def _followed(name: str) -> bool:
    parts = name.split(".")
    return len(parts) > 2 and parts[1] in FOLLOWED and ".".join(parts[1:]) not in EXCLUDED


def _file(name: str) -> Path | None:
    path = PACKAGE.joinpath(*name.split(".")[1:])
    return next((item for item in (path.with_suffix(".py"), path / "__init__.py") if item.is_file()), None)


@functools.cache
def _tree(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


@functools.cache
def _code(file: Path) -> bytes:
    """Return the syntax tree of a file without docstrings and without what happens to stored rows, as text."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    if file.parent == Path(__file__).parent:
        tree.body = [item for item in tree.body if not _is_evaluation(item)]
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            node.body = [item for item in node.body if not _is_text(item)]
    return ast.dump(tree).encode()


def _is_evaluation(node: ast.stmt) -> bool:
    if isinstance(node, ast.FunctionDef):
        return node.name.startswith(("summarize", "judge"))
    value = node.value if isinstance(node, ast.Assign) else None
    return isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id == "Check"


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


@functools.cache
def _imports(name: str) -> tuple[str, ...]:
    """Return the full names of the modules of crowdbot that a module imports."""
    file = _file(name)
    return () if file is None else tuple(dict.fromkeys(_names(name, file)))


def _names(name: str, file: Path) -> Iterator[str]:
    here = name if file.name == "__init__.py" else name.rpartition(".")[0]
    for node in ast.walk(_tree(file)):
        if isinstance(node, ast.ImportFrom):
            base = _base(here, node)
            if base.startswith("crowdbot."):
                for item in node.names:
                    yield from _owner(base, item.name)


def _base(here: str, node: ast.ImportFrom) -> str:
    if not node.level:
        return node.module or ""
    parts = here.split(".")
    return ".".join([*parts[: len(parts) - node.level + 1], *([node.module] if node.module else [])])


def _owner(base: str, wanted: str) -> Iterator[str]:
    """Yield the module that a name imported from ``base`` comes from."""
    whole = f"{base}.{wanted}"
    if _file(whole) is not None:
        yield whole
        return
    file = _file(base)
    if file is None:
        return
    if file.name != "__init__.py":
        yield base
        return
    found = list(_exports(base, file).get(wanted, ()))
    for owner in found or [f"{base}.{item.stem}" for item in file.parent.glob("*.py") if item.stem != "__init__"]:
        if found and owner != base:
            yield from _owner(owner, wanted)
        else:
            yield owner  # the face does not say where the name comes from


@functools.cache
def _exports(base: str, file: Path) -> dict[str, tuple[str, ...]]:
    """Return the modules that define the names of a face, by name."""
    exports: dict[str, tuple[str, ...]] = {}
    for node in ast.walk(_tree(file)):
        if isinstance(node, ast.ImportFrom):
            owner = _base(base, node)
            for name in node.names:
                exports[name.asname or name.name] = (owner,)
    return exports
