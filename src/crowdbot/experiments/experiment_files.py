"""Built-in experiments, and loading of experiments and their trials."""

from __future__ import annotations

import contextlib
import importlib.resources
from pathlib import Path
from xml.parsers import expat

from crowdbot.core import TrialError, did_you_mean
from crowdbot.trials import read_trial_bytes

from .experiment import Experiment
from .parser import parse_experiment

FILE = "experiment.xml"


def _shipped() -> Path:
    return Path(str(importlib.resources.files("crowdbot").joinpath("assets", "experiments")))


def builtin_experiments() -> dict[str, Path]:
    """Return the folders of the built-in experiments by name.

    >>> "robot-speed" in builtin_experiments()
    True
    """
    return {folder.name: folder for folder in sorted(_shipped().iterdir()) if (folder / FILE).is_file()}


def load_experiment(source: str | Path, *, trust: bool = False) -> Experiment:
    """Read and check an experiment with its screens and trials.

    Args:
        source: an experiment file, a folder with an ``experiment.xml``, or a built-in name; a file or folder in the
            working directory takes precedence over a built-in name.
        trust: whether trials outside the folder of the experiment may be used, and trials may load code from outside
            their folders.

    Raises:
        TrialError: the experiment does not exist or has errors; the exception lists all of them.

    >>> load_experiment("robot-speed").blocks[-1].order
    'latin-square'
    """
    path, known = _file(source), builtin_experiments()
    if path is None:
        raise TrialError(
            f"there is no experiment {str(source)!r}{did_you_mean(str(source), known)}: it is neither a file"
            f" nor a built-in experiment ({', '.join(known)})"
        )
    data = read_trial_bytes(path)
    if not data.strip():
        raise TrialError(f"{path} is empty; an experiment is an XML file with the root element <experiment>")
    return parse_experiment(data, place=str(path), folder=path.parent, trust=trust)


def is_experiment(source: str | Path) -> bool:
    """Return whether a name or file is an experiment instead of a trial.

    >>> is_experiment("robot-speed"), is_experiment("frontal")
    (True, False)
    """
    path = _file(source)
    if path is None:
        return False
    return _root(read_trial_bytes(path)) == "experiment"


def _root(data: bytes) -> str:
    """Return the name of the root element; empty if there is none near the start of the file."""
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
