"""Kernels: functions compiled by numba, with a cache that is never stale.

numba does not detect changes of a compiled function in another file: the caller keeps its cached machine code. The
cache folder is therefore keyed by a hash of all source files with kernels, in addition to numba's own key (version and
processor), and each entry by the constants that its kernel has from other files. Nothing in the names depends on the
folder of the package, so another installation of the same sources finds the kernels compiled. All kernels use float64,
no fast-math, and NumPy's rules for division.
"""

from __future__ import annotations

import contextlib
import functools
import gc
import hashlib
import importlib
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, TypeVar, cast, overload

import numpy as np
from numpy.typing import NDArray

from .systems import user_cache_folder

PACKAGE = Path(__file__).parents[1]
STALE_DAYS = 30
OBJECTS = 50_000
"""New objects until garbage is collected while a kernel is compiled."""
Function = TypeVar("Function", bound=Callable[..., Any])

prange = range
"""Range of a parallel loop in a kernel; the compiler replaces it by the ``prange`` of numba."""


@overload
def kernel(function: Function) -> Function: ...
@overload
def kernel(*, parallel: bool = False, inline: bool = False) -> Callable[[Function], Function]: ...
def kernel(function: Function | None = None, *, parallel: bool = False, inline: bool = False) -> Any:
    """Compile a function of arrays and numbers with numba at its first call, cached on disk.

    Works with and without arguments: ``@kernel``, ``@kernel(parallel=True)``, or ``@kernel(inline=True)`` for functions
    with many arrays in innermost loops, because each array argument passes about seven values.
    """
    if function is None:
        return functools.partial(Kernel, parallel=parallel, inline=inline)
    return Kernel(function, parallel=parallel, inline=inline)


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return a C-contiguous view that nobody can write through.

    A kernel is compiled anew for an array of another layout, and for one that cannot be written: an argument that is
    read-only in one call is read-only in all.

    >>> read_only(np.zeros((2, 3)).T).flags["WRITEABLE"]
    False
    """
    view = np.ascontiguousarray(array).view()
    view.flags.writeable = False
    return view


class Kernel:
    """A function that numba compiles at the first call; the import of numba takes longer than most commands.

    Other kernels can call it; the compiler uses the compiled function.
    """

    def __init__(self, function: Callable[..., Any], parallel: bool = False, inline: bool = False) -> None:
        functools.update_wrapper(self, function)
        self.py_func, self._parallel, self._inline = function, parallel, inline

    def __call__(self, *arguments: Any) -> Any:
        """Run the compiled function."""
        return self._run(*arguments)

    @functools.cached_property
    def _run(self) -> Callable[..., Any]:
        """Compiled function, wrapped by the guard of the threading layer if it starts threads."""
        from .threading_layer import guard

        return guard(self.dispatcher) if self.starts_threads else cast(Callable[..., Any], self.dispatcher)

    @functools.cached_property
    def dispatcher(self) -> Any:
        """Dispatcher of numba for calls from Python, or the plain function with ``NUMBA_DISABLE_JIT``."""
        return self._dispatcher(self.py_func)

    @functools.cached_property
    def _part(self) -> Any:
        """Dispatcher for calls in other kernels, without the wrapper for Python: it costs as much as a small kernel.

        The function has another name, since numba names the files of its cache by it.
        """
        whole: Any = self.py_func
        part = FunctionType(whole.__code__, whole.__globals__, whole.__name__, whole.__defaults__, whole.__closure__)
        part.__kwdefaults__, part.__qualname__ = whole.__kwdefaults__, f"{whole.__qualname__}.part"
        return self._dispatcher(part, no_cpython_wrapper=True)

    def _dispatcher(self, function: Callable[..., Any], no_cpython_wrapper: bool = False) -> Any:
        numba, settings = _load_numba()
        names = self.py_func.__globals__
        if names.get("prange") is prange:
            names["prange"] = numba.prange
        caches: Any = importlib.import_module("numba.core.caching").FunctionCache._impl_class
        before, locators = settings.CACHE_DIR, caches._locator_classes
        settings.CACHE_DIR, caches._locator_classes = str(cache_folder()), [_PackageLocator, *locators]
        try:
            options = {"error_model": "numpy", "fastmath": False, "parallel": self._parallel}
            wrappers = {"no_cpython_wrapper": no_cpython_wrapper, "no_cfunc_wrapper": True}  # nobody calls it from C
            dispatcher = numba.njit(cache=True, forceinline=self._inline, **options, **wrappers)(function)
        finally:
            settings.CACHE_DIR, caches._locator_classes = before, locators
        if not settings.DISABLE_JIT:
            dispatcher.get_call_template = functools.partial(
                self._call_template, numba.types, dispatcher.get_call_template
            )
        return dispatcher

    def _call_template(
        self, types: Any, resolve: Callable[..., Any], args: tuple[Any, ...], kws: dict[str, Any]
    ) -> Any:
        """Return what numba compiles for a call in another kernel.

        By itself it compiles a function anew for each constant number in a call, and for the index of a parallel loop,
        which is unsigned.
        """
        hints, names = self.py_func.__annotations__, self.py_func.__code__.co_varnames
        plain = [types.unliteral(argument) for argument in args]
        for k, argument in enumerate(plain):
            if argument == types.uint64 and hints.get(names[k]) in ("int", int):
                plain[k] = types.int64
        return resolve(tuple(plain), {name: types.unliteral(argument) for name, argument in kws.items()})

    @property
    def signatures(self) -> list[tuple[Any, ...]]:
        """Types of arguments for which the function is compiled or loaded, in calls from Python and from kernels."""
        return [*self.dispatcher.signatures, *self._part.signatures]

    @functools.cached_property
    def starts_threads(self) -> bool:
        """Whether the function or a kernel that it calls is parallel."""
        used = (self.py_func.__globals__.get(name) for name in self.py_func.__code__.co_names)
        others = (other for other in used if isinstance(other, Kernel) and other is not self)
        return self._parallel or any(other.starts_threads for other in others)

    @property
    def _numba_type_(self) -> Any:
        return self._part._numba_type_


class _PackageLocator:
    """Where numba keeps a compiled kernel of this package; those of users stay with numba's own locators.

    The methods are those of ``numba.core.caching._CacheLocator``.
    """

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        self.function, self.folder = function, folder

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> _PackageLocator | None:
        """Return the locator of a function, or None for another package or a folder that cannot be written."""
        path = Path(file)
        if not path.is_relative_to(PACKAGE):
            return None
        locator = cls(function, cache_folder() / path.parent.relative_to(PACKAGE))
        try:
            locator.ensure_cache_path()
        except OSError:
            return None
        return locator

    def ensure_cache_path(self) -> None:
        """Make the folder; raises OSError if nothing can be written there."""
        self.folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=self.folder).close()

    def get_cache_path(self) -> str:
        """Return the folder of the function."""
        return str(self.folder)

    def get_source_stamp(self) -> str:
        """Return a digest of the constants that are compiled into the function; its folder is keyed by its source."""
        digest = hashlib.blake2b(digest_size=16)
        for name, value in sorted(_constants(self.function, set()).items()):
            digest.update(f"{name}={value!r};".encode())
        return digest.hexdigest()

    def get_disambiguator(self) -> str:
        """Return the first line of the function, which tells apart functions of one name in a file."""
        return str(self.function.__code__.co_firstlineno)


def _constants(function: Callable[..., Any], seen: set[Callable[..., Any]]) -> dict[str, Any]:
    """Return the global numbers and arrays that a function and the kernels that it calls read."""
    found: dict[str, Any] = {}
    seen.add(function)
    for name in function.__code__.co_names:
        value = function.__globals__.get(name)
        if isinstance(value, Kernel):
            found |= _constants(value.py_func, seen) if value.py_func not in seen else {}
        elif not (value is None or callable(value) or isinstance(value, ModuleType)):
            array = isinstance(value, np.ndarray)  # its text leaves out the middle of a long array
            found[f"{function.__module__}.{name}"] = (value.dtype.str, value.shape, value.tobytes()) if array else value
    return found


@functools.cache
def _load_numba() -> tuple[Any, Any]:
    """Return numba and its settings."""
    # For GNU OpenMP, whose idle threads spin: with another busy process, a step of 1 ms takes 50 ms (measured). The
    # variable is read when the first parallel kernel starts; a value set by the user is kept.
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    with _without_lock_events():
        import numba
        from numba.core import config

    event: Any = importlib.import_module("numba.core.event")
    event.Listener.register(_RareCollection)
    event.register("numba:compile", _RareCollection())
    _import_array_functions()

    from .threading_layer import prefer_safe_layers

    prefer_safe_layers()
    return numba, config


@contextlib.contextmanager
def _without_lock_events() -> Iterator[None]:
    """Let numba not count the time in each of 300 000 calls of LLVM, a twentieth of the time of a compilation.

    Nothing here reads it; a program that has imported numba before keeps it.
    """
    ffi: Any = importlib.import_module("llvmlite.binding.ffi")
    register = ffi.register_lock_callback
    ffi.register_lock_callback = lambda *_: None
    try:
        yield
    finally:
        ffi.register_lock_callback = register


class _RareCollection:
    """Collects garbage seldom while kernels are compiled: a compiler makes many objects that live until its end.

    The methods are those of ``numba.core.event.Listener``, which cannot be imported before numba.
    """

    def __init__(self) -> None:
        self._depth, self._usual = 0, gc.get_threshold()

    def notify(self, event: Any) -> None:
        """Change how often garbage is collected when the first kernel begins, and back when it is compiled."""
        if event.is_start:
            if self._depth == 0:
                self._usual = gc.get_threshold()
                gc.set_threshold(max(self._usual[0], OBJECTS), *self._usual[1:])
            self._depth += 1
        elif event.is_end and self._depth > 0:
            self._depth -= 1
            if self._depth == 0:
                gc.set_threshold(*self._usual)


def _import_array_functions() -> None:
    """Import the array functions of numba without the linear algebra of SciPy, which takes longer than numba itself.

    numba imports it only to know that it exists. It is required by this package, and a kernel that multiplies matrices
    loads it when it is compiled.
    """
    name = "scipy.linalg.cython_blas"
    if name in sys.modules:
        return
    sys.modules[name] = ModuleType(name)
    try:
        importlib.import_module("numba.np.arraymath")
    finally:
        del sys.modules[name]


@functools.cache
def cache_folder() -> Path:
    """Return the folder of compiled kernels of the current sources; it is created if missing."""
    folder = cache_root() / f"kernels-{_source_key()}"
    folder.mkdir(parents=True, exist_ok=True)
    os.utime(folder)
    _remove_stale(folder)
    return folder


def cache_root() -> Path:
    """Return the folder of the user for what can be computed anew: ``CROWDBOT_CACHE``, otherwise that of the system.

    >>> cache_root().is_absolute()
    True
    """
    chosen = os.environ.get("CROWDBOT_CACHE")
    if chosen:
        return Path(chosen).absolute()
    return user_cache_folder()


def is_cold() -> bool:
    """Return whether no kernel has been compiled yet for these sources."""
    return not any(cache_folder().rglob("*.nbc"))


def _source_key() -> str:
    sum_ = hashlib.blake2b(digest_size=8)
    package = Path(__file__).parents[1]
    for path in sorted(package.rglob("*.py")):
        source = path.read_bytes()
        if b"@kernel" in source or path.name == "kernels.py":
            sum_.update(path.relative_to(package).as_posix().encode() + b"\0" + source)
    return sum_.hexdigest()


def _remove_stale(keep: Path) -> None:
    for folder in keep.parent.glob("kernels-*"):
        try:
            if folder != keep and time.time() - folder.stat().st_mtime > STALE_DAYS * 86400:
                shutil.rmtree(folder)
        except OSError:
            continue  # another process is using or removing it
