"""The one way to compile a kernel, with a cache that cannot be stale.

numba does not notice that a jitted function in another file has changed: the caller keeps its cached machine code.
So the cache folder is keyed by a hash of every source file that holds kernels, next to numba's own key (its version,
the processor). All kernels use float64, no fast-math, and numpy's rules for division.
"""

from __future__ import annotations

import functools
import hashlib
import os
import shutil
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast, overload

import numba
from numba.core import config

from .threading_layer import ParallelKernel, prefer_safe_layers

__all__ = ["cache_folder", "is_cold", "kernel"]

# For users who choose GNU OpenMP, whose idle threads spin: beside another busy process a step of 1 ms then takes 50 ms
# (measured). It reads this when the first parallel kernel starts; a value set by the user stays.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
prefer_safe_layers()

STALE_DAYS = 30
Function = TypeVar("Function", bound=Callable[..., Any])


@overload
def kernel(function: Function) -> Function: ...
@overload
def kernel(*, parallel: bool = False, inline: bool = False) -> Callable[[Function], Function]: ...
def kernel(function: Function | None = None, *, parallel: bool = False, inline: bool = False) -> Any:
    """Compile a function of arrays and numbers with numba, cached on disk.

    Works with and without arguments: ``@kernel``, ``@kernel(parallel=True)`` or, for what is called in the innermost
    loop with many arrays, ``@kernel(inline=True)``: every array is some seven numbers to hand over.
    """
    if function is None:
        return functools.partial(_compiled, parallel=parallel, inline=inline)
    return _compiled(function, parallel=parallel, inline=inline)


def _compiled(function: Function, parallel: bool, inline: bool) -> Function:
    settings: Any = config
    before = settings.CACHE_DIR
    settings.CACHE_DIR = str(cache_folder())
    try:
        jit = numba.njit(cache=True, error_model="numpy", fastmath=False, parallel=parallel, forceinline=inline)
        compiled = jit(function)
    finally:
        settings.CACHE_DIR = before
    starts_threads = parallel or any(isinstance(value, ParallelKernel) for value in _global_values(function))
    return cast(Function, ParallelKernel(compiled) if starts_threads and not settings.DISABLE_JIT else compiled)


def _global_values(function: Callable[..., Any]) -> list[Any]:
    """Return the values of the module that a function refers to, other kernels among them."""
    return [function.__globals__.get(name) for name in function.__code__.co_names]


@functools.cache
def cache_folder() -> Path:
    """Return the folder of compiled kernels that belongs to the sources as they are now, made when missing."""
    folder = _cache_root() / f"kernels-{_source_key()}"
    folder.mkdir(parents=True, exist_ok=True)
    os.utime(folder)
    _remove_stale(folder)
    return folder


def is_cold() -> bool:
    """Return whether no kernel has been compiled yet for these sources."""
    return not any(cache_folder().rglob("*.nbc"))


def _source_key() -> str:
    sum_ = hashlib.blake2b(digest_size=8)
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        source = path.read_bytes()
        if b"@kernel" in source or path.name == "kernels.py":
            sum_.update(path.name.encode() + b"\0" + source)
    return sum_.hexdigest()


def _cache_root() -> Path:
    chosen = os.environ.get("CROWDBOT_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local")) / "crowdbot"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "crowdbot"
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "crowdbot"


def _remove_stale(keep: Path) -> None:
    for folder in keep.parent.glob("kernels-*"):
        try:
            if folder != keep and time.time() - folder.stat().st_mtime > STALE_DAYS * 86400:
                shutil.rmtree(folder)
        except OSError:
            continue  # another process is using or removing it
