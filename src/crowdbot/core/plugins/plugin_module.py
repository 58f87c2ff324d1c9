"""Modules of plugin addresses: a Python file, a folder of Python files, or an installed package."""

from __future__ import annotations

import importlib
import importlib.machinery
import importlib.util
import logging
import os
import re
import sys
import types
from pathlib import Path
from typing import Any

from crowdbot.core.errors import InputError

from .class_source import class_file

PREFIX = "crowdbot_plug_"
logger = logging.getLogger("crowdbot")


def load_plugin_module(place: str, attribute: str, folder: Path, trust: bool) -> tuple[types.ModuleType, str]:
    """Return the module of the address ``place:attribute`` and the name of the attribute in it.

    ``place`` is a Python file (``shy.py``), a folder of Python files (``mylab/``), a module in such a folder
    (``mylab.shy``) or an installed module. Files and folders are looked up in ``folder`` first.

    Args:
        place: part of the address before the colon.
        attribute: part after the colon; in a folder, ``module.Name`` selects the file.
        folder: folder of relative paths.
        trust: if False, only code inside ``folder`` is loaded.

    Raises:
        InputError: the code cannot be loaded or is not trusted.
    """
    path, inner, name = _locate(place, attribute, folder, trust)
    if path is None:
        return _import(place, trust), attribute
    if path.is_file():
        return _load_file(path, place), name
    package = _load_package(path, place)
    return (_submodule(package, inner, path) if inner else package), name


def plugin_source(place: str, attribute: str, folder: Path, trust: bool) -> tuple[Path, str]:
    """Return the file of an address and the name of the class in it, without running any code.

    Args:
        place, attribute, folder, trust: arguments of :func:`load_plugin_module`.

    Raises:
        InputError: there is no such file, or it is not trusted.
    """
    path, inner, name = _locate(place, attribute, folder, trust)
    if path is None:
        return _module_file(place, trust), attribute
    if path.is_dir():
        file = path.joinpath(*inner.split(".")) if inner else path
        path = file / "__init__.py" if file.is_dir() else file.with_name(f"{file.name}.py")
        if not path.is_file():
            raise InputError(f"there is no file {path}")
    return path, name


def plugin_sources(place: str, folder: Path) -> tuple[str, ...]:
    """Return the Python files that an address would load, relative to ``folder``, without loading any.

    >>> plugin_sources("shy.py", Path("nowhere")), plugin_sources("numpy", Path("nowhere"))
    (('shy.py',), ())
    """
    if place.endswith(".py"):
        return (place,)
    local = _local(place, folder)
    if local is None:
        return ()
    files = [local[0]] if local[0].is_file() else _python_files(local[0])
    return tuple(Path(os.path.relpath(path, folder)).as_posix() for path in files)


def sources_of(cls: type) -> tuple[Path, ...]:
    """Return the Python files of a class that was loaded from a file or a folder; empty for other classes."""
    described, package = class_file(cls), _package_of(cls)
    if described is not None:
        return (described,)
    if package is not None:
        return tuple(_python_files(Path(package.__path__[0])))
    module = sys.modules.get(cls.__module__)
    if not cls.__module__.startswith(PREFIX) or module is None or not module.__file__:
        return ()
    return (Path(module.__file__),)


def plugin_address(cls: type, folder: Path | None) -> str:
    """Return the address of a class that was loaded from a file or a folder, as seen from ``folder``.

    It is empty for other classes. Without a folder, the name is as in :func:`relative_name`.
    """
    package, name = _package_of(cls), cls.__qualname__
    if package is not None:
        path = Path(package.__path__[0])
        name = f"{cls.__module__}.{name}".removeprefix(f"{package.__name__}.")
    elif files := sources_of(cls):
        path = files[0]
    else:
        return ""
    return f"{relative_name(path, folder)}{'' if package is None else '/'}:{name}"


def relative_name(path: Path, folder: Path | None) -> str:
    """Return the name of a file relative to a folder.

    It is the absolute path for a file on another drive of Windows. Without a folder, it is relative to the working
    folder, or the file name alone for a file outside of it.

    >>> relative_name(Path("/data/maps/hall.png"), Path("/data/trials"))
    '../maps/hall.png'
    """
    if folder is None:
        here = Path.cwd()
        return path.relative_to(here).as_posix() if path.is_relative_to(here) else path.name
    try:
        return Path(os.path.relpath(path, folder.resolve())).as_posix()
    except ValueError:  # another drive
        return path.as_posix()


def _package_of(cls: type) -> types.ModuleType | None:
    """Return the package of a class that was loaded from a folder."""
    package = sys.modules.get(cls.__module__.partition(".")[0])
    return package if package is not None and package.__name__.startswith(PREFIX) and _is_package(package) else None


def _is_package(module: types.ModuleType) -> bool:
    return hasattr(module, "__path__")


def _local(place: str, folder: Path) -> tuple[Path, str] | None:
    """Return the file or folder of an address without ``.py`` in ``folder``, and the dotted rest; None if not there."""
    if place.endswith(("/", "\\")) or "/" in place:
        return (folder / place, "") if (folder / place).is_dir() else None
    top, _, inner = place.partition(".")
    if not top:
        return None
    if inner == "" and (folder / f"{top}.py").is_file():
        return folder / f"{top}.py", ""
    path = folder / top
    deep = path.joinpath(*inner.split(".")) if inner else path
    there = deep.is_dir() or (inner != "" and deep.with_name(f"{deep.name}.py").is_file())
    return (path, inner) if path.is_dir() and there and _python_files(path) else None


def _locate(place: str, attribute: str, folder: Path, trust: bool) -> tuple[Path | None, str, str]:
    """Return the file or folder of an address, the dotted module in the folder and the name of the class.

    The path is None for an installed module.
    """
    if place.endswith(".py"):
        return _inside(folder, place, trust), "", attribute
    local = _local(place, folder)
    if local is None:
        if "/" in place or "\\" in place:
            raise InputError(f"there is no folder {folder / place}")
        return None, "", attribute
    root, inner = local
    path = _inside(folder, str(root), trust)
    if path.is_file():
        return path, "", attribute
    if _is_imported(path):
        return None, "", attribute
    *modules, name = attribute.split(".")
    inner = ".".join([inner, *modules]).strip(".") or _defining_file(path, name)
    return path, "" if inner == "__init__" else inner, name


def _is_imported(path: Path) -> bool:
    """Return whether a folder is a package that has been imported under its own name."""
    own = getattr(sys.modules.get(path.name), "__path__", ())
    return str(path) in [str(Path(item).resolve()) for item in own]


def _module_file(place: str, trust: bool) -> Path:
    """Return the file of an installed module, found without importing it."""
    _check_module(place, trust)
    search: Any = None
    spec = None
    parts = place.split(".")
    for k in range(len(parts)):
        spec = importlib.machinery.PathFinder.find_spec(".".join(parts[: k + 1]), search)
        if spec is None:
            break
        search = spec.submodule_search_locations or []
    if spec is None or not (spec.origin or "").endswith(".py"):
        raise InputError(f"the module {place!r} is not found as a Python file")
    return Path(str(spec.origin))


def _check_module(place: str, trust: bool) -> None:
    if not trust:
        raise InputError(f"the module {place!r} is not loaded from here; pass --trust to allow it")


def _python_files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*.py") if "__pycache__" not in path.parts)


def _defining_file(folder: Path, name: str) -> str:
    """Return the module in a folder that defines a class, found without running any code."""
    pattern = re.compile(r"^class\s+(\w+)", flags=re.MULTILINE)
    files = [path for path in sorted(folder.glob("*.py")) if not path.stem.startswith("test_")]
    names = {path.stem: pattern.findall(path.read_text(encoding="utf-8", errors="replace")) for path in files}
    found = [stem for stem, classes in names.items() if name in classes]
    if len(found) == 1:
        return found[0]
    if found:
        choices = " or ".join(f"{folder.name}/:{stem}.{name}" for stem in found)
        raise InputError(f"{folder} has several classes {name}; write {choices}")
    every = sorted({class_ for classes in names.values() for class_ in classes})
    raise InputError(f"no Python file in {folder} defines the class {name!r}; they define {', '.join(every) or 'none'}")


def _inside(folder: Path, place: str, trust: bool) -> Path:
    path = (folder / place).resolve()
    if not trust and not path.is_relative_to(folder.resolve()):
        what = "file" if place.endswith(".py") else "folder"
        raise InputError(f"the {what} {place!r} lies outside {folder}; pass --trust to allow it")
    if not path.exists():
        raise InputError(f"there is no file {path}")
    return path


def _import(place: str, trust: bool) -> types.ModuleType:
    _check_module(place, trust)
    try:
        return importlib.import_module(place)
    except ImportError as error:
        raise InputError(f"the module {place!r} cannot be imported: {error}") from None


def _plugin_name(path: Path) -> str:
    stem = re.sub(r"\W", "_", path.stem)
    return f"{PREFIX}{stem}_{abs(hash(str(path)))}"


def _load_file(path: Path, place: str, search: list[str] | None = None) -> types.ModuleType:
    """Run a Python file as a module, or return the module if it has run."""
    if not path.is_file():
        raise InputError(f"there is no file {path}")
    name = _plugin_name(path.parent if search else path)
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path, submodule_search_locations=search)
    assert spec is not None
    assert spec.loader is not None
    logger.info("loads code from %s", place)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        raise InputError(f"{path} cannot be loaded: {type(error).__name__}: {error}") from error
    return module


def _load_package(path: Path, place: str) -> types.ModuleType:
    """Return a folder as a package; ``__init__.py`` is optional."""
    if (path / "__init__.py").is_file():
        return _load_file(path / "__init__.py", place, [str(path)])
    name = _plugin_name(path)
    if name not in sys.modules:
        logger.info("loads code from %s", place)
        package = types.ModuleType(name)
        package.__path__ = [str(path)]
        sys.modules[name] = package
    return sys.modules[name]


def _submodule(package: types.ModuleType, inner: str, path: Path) -> types.ModuleType:
    name = f"{package.__name__}.{inner}"
    if name in sys.modules:
        return sys.modules[name]
    try:
        importlib.invalidate_caches()
        return importlib.import_module(name)
    except Exception as error:
        raise InputError(f"{inner} in {path} cannot be loaded: {type(error).__name__}: {error}") from error
