"""Worlds: trials that other programs can load."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from crowdbot.core import InputError
from crowdbot.trials import Trial, builtin_trials, check_trial, load_trial, parse_trial, trial_xml

from .results import FAILED, OK, UNSUPPORTED, result

NO_RESOURCE, PARSE_ERROR = 102, 103
MOST_TEXT = 1_000_000


def current_world(trial: Trial) -> dict[str, Any]:
    """Return the response of ``GetCurrentWorld``: the trial as XML."""
    return result(world=_world(trial.name, trial.about, {"uri": "", "resource_string": trial_xml(trial)}))


def available_worlds(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return the response of ``GetAvailableWorlds``: the built-in trials."""
    if (request.get("filter") or {}).get("tags"):
        return result(UNSUPPORTED, "worlds have no tags", worlds=[])
    return result(worlds=[_world(name, "", {"uri": name, "resource_string": ""}) for name in builtin_trials()])


def load_world(request: Mapping[str, Any], folder: Path | None) -> tuple[Trial | None, dict[str, Any]]:
    """Return the trial of a ``LoadWorld`` request, None with an error, and the response.

    The URI is the name of a built-in trial, or of a trial file in the folder of the current trial; the text is a trial
    as XML, which cannot load files or code.

    Args:
        request: fields of the request; ``world_resource``, or ``uri`` and ``resource_string`` of older versions.
        folder: folder of the current trial; None: it has none.
    """
    resource = request.get("world_resource") or request
    uri, text = str(resource.get("uri") or ""), str(resource.get("resource_string") or "")
    try:
        if uri:
            trial = _load(uri, folder)
        elif text:
            if len(text) > MOST_TEXT:
                raise InputError(f"a trial has at most {MOST_TEXT} characters")
            trial = parse_trial(text.encode(), place="load_world", folder=None, trust=False)
        else:
            return None, result(NO_RESOURCE, "give a uri or a resource_string", world=_world("", "", {}))
        check_trial(trial, trial.seed)
    except InputError as error:
        return None, result(PARSE_ERROR if text else FAILED, str(error), world=_world("", "", {}))
    return trial, result(OK, world=_world(trial.name, trial.about, {"uri": uri, "resource_string": ""}))


def _load(uri: str, folder: Path | None) -> Trial:
    if uri in builtin_trials():
        return load_trial(uri)
    name = uri.removeprefix("file:")
    if folder is None or Path(name).name != name or not (folder / name).is_file():
        raise InputError(f"{uri[:80]!r} is neither a built-in trial nor a file in the folder of the current trial")
    return load_trial(folder / name)


def _world(name: str, about: str, resource: Mapping[str, Any]) -> dict[str, Any]:
    return {"name": name, "world_resource": dict(resource), "description": about, "tags": []}
