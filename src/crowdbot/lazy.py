"""Names of a package that are imported at their first use, so that the package itself loads fast."""

from __future__ import annotations

import ast
import importlib
import sys
from collections.abc import Callable
from typing import Any


def lazy_exports(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """``__getattr__``, ``__dir__`` and ``__all__`` of a package for the names of its ``if TYPE_CHECKING`` block.

    The imports that type checkers read are the only declaration of the names. A package may set a shorter ``__all__``.

    Args:
        package: ``__name__`` of the package that calls.

    >>> find, _, names = lazy_exports("crowdbot.data")
    >>> find("Forecast").__name__
    'Forecast'
    >>> "Forecast" in names
    True
    >>> find("Forecasts")
    Traceback (most recent call last):
    AttributeError: module 'crowdbot.data' has no attribute 'Forecasts'
    """
    loader: Any = sys.modules[package].__loader__
    blocks = [node for node in ast.parse(loader.get_source(package)).body if isinstance(node, ast.If)]
    homes = {
        alias.name: "." * node.level + (node.module or "")
        for block in blocks
        if isinstance(block.test, ast.Name) and block.test.id == "TYPE_CHECKING"
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }

    def find(name: str) -> Any:
        if name in homes:
            return getattr(importlib.import_module(homes[name], package), name)
        raise AttributeError(f"module {package!r} has no attribute {name!r}")

    def list_names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *homes})

    return find, list_names, sorted(homes)
