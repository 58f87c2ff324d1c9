"""The function that loads a trial, from a file or a built-in one."""

from __future__ import annotations

import dataclasses
import importlib.resources
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from crowdbot.core import TrialError, did_you_mean
from crowdbot.core.fields import outline

from .builtin_names import builtin_trials
from .crowd import crowd_names
from .parser import parse_trial
from .scenarios import PRESETS
from .trial import Trial
from .variants import apply_values
from .xml.trial_text import read_trial_bytes

MODEL = "crowd/type"
"""Path of the crowd model in trial files: ``model`` is a parameter of every built-in trial with one crowd."""


def load_trial(
    source: str | Path, given: Mapping[str, Any] | None = None, /, *, trust: bool = False, **values: Any
) -> Trial:
    """Load and check a trial.

    Args:
        source: a trial file or a built-in name; a file of this name in the working folder takes precedence.
        given: parameters of a built-in trial, or values by path as in :class:`crowdbot.trials.Sweep`. Names that come
            from outside belong here, so that none of them becomes an argument.
        trust: whether the trial may load code from outside its own folder, or read files there.
        values: more of ``given``, such as ``world="physics"``.

    Raises:
        TrialError: the trial does not exist or has errors; one sentence per error.

    >>> load_trial("crossing-flows").people
    40
    >>> load_trial("intersection", density=0.5).people
    10
    >>> type(load_trial("intersection").crowd).__name__, type(load_trial("intersection", model="orca").crowd).__name__
    ('People', 'ORCA')
    >>> load_trial("crossing-flows", {"spawner[1]/count": 5}).people
    25
    >>> load_trial("frontal", world="physics", gap=5).world
    'physics'
    """
    values = {**(given or {}), **values}
    path = Path(source)
    if not path.is_file() and (str(source) in builtin_trials() or _is_plain_name(path)):
        return load_builtin_trial(str(source), values, trust=trust)
    trial = parse_trial(read_trial_bytes(path), place=str(path), folder=path.parent, trust=trust)
    return apply_values(trial, values, place=trial.name, trust=trust)


def _is_plain_name(path: Path) -> bool:
    return not path.exists() and not path.suffix and len(path.parts) == 1


def load_builtin_trial(
    name: str,
    given: Mapping[str, Any] | None = None,
    /,
    *,
    trust: bool = False,
    folder: Path | None = None,
    **values: Any,
) -> Trial:
    """Load a built-in trial, and never a file of this name.

    Args:
        name: name of the trial.
        given, values: as for :func:`load_trial`.
        trust: whether the values may name files and code outside the folder.
        folder: folder of files and code that the values name (default: the working folder).

    Raises:
        TrialError: there is no such trial, or a value is wrong.

    >>> load_builtin_trial("frontal").name
    'frontal'
    """
    values = {**(given or {}), **values}
    known = builtin_trials()
    if name not in known:
        raise TrialError(
            f"there is no trial {name!r:.200}{did_you_mean(name, known)}; it is neither a file nor a built-in name;"
            " crowdbot list trials lists the built-in trials"
        )
    preset = PRESETS.get(name)
    if preset is None:
        inside = importlib.resources.files("crowdbot").joinpath("assets", "trials", f"{name}.xml")
        trial = parse_trial(inside.read_bytes(), place=f"{name}.xml", folder=folder, trust=trust)
        if not crowd_names(trial.crowd):
            values = {MODEL if key == "model" else key: value for key, value in values.items()}
        return apply_values(trial, values, place=trial.name, trust=trust)
    plain = {part.word for part in outline(Trial) if part.role == "attribute"} - {*preset.options}
    paths = {key: value for key, value in values.items() if set("/.[") & set(key) or key.replace("_", "-") in plain}
    own = {key: value for key, value in values.items() if key not in paths}
    trial = dataclasses.replace(preset.trial(folder, **own), folder=folder)
    return apply_values(trial, paths, place=trial.name, trust=trust)
