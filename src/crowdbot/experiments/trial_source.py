"""Loading of the trial named by an entry of an experiment."""

from __future__ import annotations

from pathlib import Path

from crowdbot.core import InputError, TrialError, did_you_mean
from crowdbot.trials import Trial, builtin_trials, load_trial, parse_trial, read_trial_bytes


def trial_of(source: str, folder: Path | None, trust: bool = False) -> Trial:
    """Return the trial named by ``source``: a file in the folder of the experiment, or a built-in trial.

    Raises:
        TrialError: the trial has errors; the exception lists all of them.
        InputError: the file is outside the folder.
    """
    root = (folder or Path.cwd()).resolve()
    path = (root / source).resolve()
    if path.is_file():
        if not trust and not path.is_relative_to(root):
            raise InputError(f"the trial {source!r} is outside the folder of the experiment; use --trust to allow it")
        return parse_trial(read_trial_bytes(path), place=source, folder=path.parent, trust=trust)
    if source in builtin_trials():
        return load_trial(source)
    raise TrialError(
        f"there is no trial {source!r}{did_you_mean(source, builtin_trials())}: it is neither a file in the "
        f"folder of the"
        f" experiment nor a built-in trial ({', '.join(builtin_trials())})"
    )
