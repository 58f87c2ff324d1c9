"""The experiments that come with crowdbot, and the one way to load an experiment and its trials."""

from __future__ import annotations

import contextlib
import importlib.resources
from pathlib import Path
from xml.parsers import expat

from crowdbot.core import TrialError, did_you_mean
from crowdbot.trials import read_trial_bytes

from .experiment import Experiment
from .parser import parse_experiment

__all__ = ["FILE", "builtin_experiments", "is_experiment", "load_experiment"]

FILE = "experiment.xml"


def _shipped() -> Path:
    return Path(str(importlib.resources.files("crowdbot").joinpath("assets", "experiments")))


def builtin_experiments() -> dict[str, Path]:
    """Return the folders of the built-in experiments by their names.

    >>> "robot-speed" in builtin_experiments()
    True
    """
    return {folder.name: folder for folder in sorted(_shipped().iterdir()) if (folder / FILE).is_file()}


def load_experiment(source: str | Path, *, trust: bool = False) -> Experiment:
    """Read and check an experiment with its screens and trials.

    Args:
        source: an experiment file, a folder that holds ``experiment.xml``, or a built-in name; a file or folder of
            that name in the working folder comes first.
        trust: whether trials from outside its folder may be used, and may load code from outside their own folders.

    Raises:
        TrialError: there is no such experiment, or with everything that is wrong with it, a sentence each.

    >>> load_experiment("robot-speed").blocks[-1].order
    'latin-square'
    """
    path, known = _file(source), builtin_experiments()
    if path is None:
        raise TrialError(
            f"there is no experiment {str(source)!r}{did_you_mean(str(source), known)}: no file has this name,"
            f" and built in are {', '.join(known)}"
        )
    data = read_trial_bytes(path)
    if not data.strip():
        raise TrialError(f"{path} is empty; an experiment is an XML file with the root element <experiment>")
    return parse_experiment(data, place=str(path), folder=path.parent, trust=trust)


def is_experiment(source: str | Path) -> bool:
    """Return whether a name or a file means an experiment, not a trial.

    >>> is_experiment("robot-speed"), is_experiment("frontal")
    (True, False)
    """
    path = _file(source)
    if path is None:
        return False
    return _root(read_trial_bytes(path)) == "experiment"


def _root(data: bytes) -> str:
    """Return the name of the root element; empty when none begins before anything that no trial may have."""
    found: list[str] = []
    parser = expat.ParserCreate()

    def stop(tag: str, *_: object) -> None:
        found.append(tag)
        raise StopIteration

    parser.StartElementHandler = stop
    parser.StartDoctypeDeclHandler = lambda *_: stop("")
    with contextlib.suppress(StopIteration, expat.ExpatError, LookupError, ValueError):
        parser.Parse(data, True)
    return found[0] if found else ""


def _file(source: str | Path) -> Path | None:
    path = Path(source)
    for file in (path, path / FILE, builtin_experiments().get(str(source), path) / FILE):
        if file.is_file():
            return file
    return None
