"""Names of a package that are imported at their first use, so that the package itself loads fast."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterable, Mapping
from typing import Any

__all__ = ["lazy_exports"]


def lazy_exports(
    package: str, modules: Mapping[str, Iterable[str]]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return ``__getattr__`` and ``__dir__`` of a package that imports names from its modules at their first use.

    Type checkers do not see these names: import them a second time in an ``if TYPE_CHECKING`` block.

    Args:
        package: ``__name__`` of the package.
        modules: names by the module of the package that defines them.

    >>> find, _ = lazy_exports("crowdbot.core", {"pose": ["Pose"]})
    >>> find("Pose").__name__
    'Pose'
    >>> find("Posse")
    Traceback (most recent call last):
    AttributeError: module 'crowdbot.core' has no attribute 'Posse'
    """
    homes = {name: module for module, names in modules.items() for name in names}

    def find(name: str) -> Any:
        if name in homes:
            return getattr(importlib.import_module(f"{package}.{homes[name]}"), name)
        raise AttributeError(f"module {package!r} has no attribute {name!r}")

    def list_names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *homes})

    return find, list_names
