"""The run that is shown, as a command line and as Python."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from typing import Any

__all__ = ["run_command", "run_python"]


def run_command(source: Mapping[str, Any], place: str, steered: str = "") -> str:
    """Return the command that gives the same run, or that replays the episode.

    Args:
        source: what is open: ``kind``, ``name``, and for a run ``settings``, ``variant`` and ``seed``.
        place: path of the file, or name of the built-in trial.
        steered: what the user did to the run, which only its recording has; empty for nothing.

    >>> source = {"kind": "run", "name": "frontal", "settings": {"duration": "5"}, "variant": 1, "seed": 3}
    >>> run_command(source, "frontal")
    'crowdbot run frontal --seed 3 --set duration=5'
    """
    if source["kind"] == "episode":
        return f"crowdbot replay {shlex.quote(place)}"
    words = ["crowdbot run", shlex.quote(place), f"--seed {source['seed']}"]
    words += [f"--set {shlex.quote(f'{name}={value}')}" for name, value in source["settings"].items()]
    words += [f"--variant {source['variant']}"] if source["variant"] != 1 else []
    lines = [f"# without {steered}: save the run and use crowdbot replay for the same run"] if steered else []
    return "\n".join([*lines, " ".join(words)])


def run_python(source: Mapping[str, Any], place: str, steered: str = "") -> str:
    """Return a program that gives the same run, or that reads the episode; arguments as of :func:`run_command`."""
    if source["kind"] == "episode":
        return f"""from crowdbot.recording import replay

found = replay({place!r})
print(found.outcomes[1], found.replayed, found.replayed == found.recorded)
"""
    values = f", **{dict(source['settings'])!r}" if source["settings"] else ""
    note = f"# without {steered}: save the run and replay it for the same run\n" if steered else ""
    variant = f"trial = expand_sweeps(trial)[{source['variant'] - 1}]\n" if source["variant"] != 1 else ""
    names = "expand_sweeps, load_trial" if variant else "load_trial"
    return f"""{note}from crowdbot.recording import record
from crowdbot.trials import {names}

trial = load_trial({place!r}{values})
{variant}run = record(trial, {source["seed"]}, "episode.mcap")
print(run.outcome, run.digest)
"""
