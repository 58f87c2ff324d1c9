"""Recordings that ship with crowdbot, for the app."""

from __future__ import annotations

import shutil
from importlib import resources

from crowdbot.core import InputError, did_you_mean
from crowdbot.web.workspace import Workspace

EXAMPLES = {
    "bottleneck": "people leave a hall through a door, with walls and a robot (simulated)",
    "crossing-flows": "a robot crosses a corridor with a two-way flow of 40 people (simulated)",
}
"""Recordings that ship, made by the built-in trials of the same names with seed 3."""


def copy_example(workspace: Workspace, name: str) -> str:
    """Copy a recording that ships into the folder of a session and return its name there.

    Raises:
        InputError: there is no such recording.
    """
    if name not in EXAMPLES:
        raise InputError(f"example {name!r:.40} does not exist{did_you_mean(name, EXAMPLES)}")
    path = workspace.writable(f"examples/{name}.parquet")
    with resources.as_file(resources.files("crowdbot").joinpath("assets", "recordings", path.name)) as source:
        shutil.copyfile(source, path)
    return f"examples/{path.name}"
