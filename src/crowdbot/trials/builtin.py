"""The trials that come with crowdbot, and the one way to load a trial."""

from __future__ import annotations

import importlib.resources
from pathlib import Path

from crowdbot.core import TrialError
from crowdbot.core.errors import did_you_mean

from .markup import read_bytes
from .trial import Trial

__all__ = ["builtin_trials", "load_trial"]


def builtin_trials() -> tuple[str, ...]:
    """Return the names of the built-in trials.

    >>> "crossing-flows" in builtin_trials()
    True
    """
    folder = importlib.resources.files("crowdbot").joinpath("assets", "trials")
    return tuple(sorted(entry.name.removesuffix(".xml") for entry in folder.iterdir() if entry.name.endswith(".xml")))


def load_trial(source: str | Path, *, trust: bool = False) -> Trial:
    """Read and check a trial.

    Args:
        source: a trial file or a built-in name; a file of that name in the working folder comes first.
        trust: whether the trial may load code from outside its own folder.

    Raises:
        TrialError: there is no such trial, or with everything that is wrong with it, a sentence each.

    >>> load_trial("crossing-flows").people
    40
    """
    path = Path(source)
    known = builtin_trials()
    if str(source) in known and not path.is_file():
        inside = importlib.resources.files("crowdbot").joinpath("assets", "trials", f"{source}.xml")
        return Trial.parse(inside.read_bytes(), place=f"{source}.xml", trust=trust)
    if not path.exists() and not path.suffix and len(path.parts) == 1:
        raise TrialError(
            f"there is no trial {str(source)!r}{did_you_mean(str(source), known)}: no file has this name,"
            f" and built in are {', '.join(known)}"
        )
    return Trial.parse(read_bytes(path), place=str(path), folder=path.parent, trust=trust)
