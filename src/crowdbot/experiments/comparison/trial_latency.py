"""TrialLatency: measured latencies of the headset of a participant in one trial, in a file of its folder."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import InputError, explain_write_errors
from crowdbot.trials import Avatar

LATENCY_FILE = "latency.json"


class TrialLatency(NamedTuple):
    """Latencies of a trial [s] with all added delays; None: unknown.

    Fields:
        motion, motion_p95: age of the pose of the participant when a step of the simulation uses it: median, and 95th
            percentile.
        picture, picture_p95: age of a state of the simulation when the headset begins to draw it.
        dropped: pictures that were not drawn in time.
        lost: messages of the headset that did not arrive.
    """

    motion: float | None = None
    motion_p95: float | None = None
    picture: float | None = None
    picture_p95: float | None = None
    dropped: int = 0
    lost: int = 0


def write_trial_latency(folder: Path, latencies: Mapping[str, TrialLatency]) -> None:
    """Write latencies by the names of the avatars to the folder of a trial.

    Raises:
        InputError: the file cannot be written.
    """
    text = json.dumps({name: one._asdict() for name, one in latencies.items()}, indent=1, allow_nan=False)
    with explain_write_errors(folder / LATENCY_FILE):
        (folder / LATENCY_FILE).write_text(text + "\n", encoding="utf-8")


def read_trial_latency(folder: Path, avatar: Avatar) -> TrialLatency:
    """Return the latencies of the participant who moved an avatar in a trial.

    Without a headset, the motion is as late as the ``delay`` of the avatar, and the picture is reality.

    Raises:
        InputError: the file is damaged.

    >>> read_trial_latency(Path("nowhere"), Avatar(name="guest", source="external", x=0, y=0, delay=0.08)).motion
    0.08
    """
    path = folder / LATENCY_FILE
    if not path.is_file():
        return TrialLatency(avatar.delay, avatar.delay, 0.0, 0.0)
    try:
        given = json.loads(path.read_text(encoding="utf-8")).get(avatar.name)
        if given is None:
            return TrialLatency(avatar.delay, avatar.delay, 0.0, 0.0)
        numbers = [given[name] for name in TrialLatency._fields]
    except (OSError, ValueError, AttributeError, KeyError, TypeError) as error:
        raise InputError(f"{path} is damaged: {error!r}; delete it to analyse the trial without latencies") from None
    if not all(one is None or (isinstance(one, int | float) and math.isfinite(one)) for one in numbers):
        raise InputError(f"{path} is damaged: a latency is not a finite number")
    return TrialLatency(*numbers)
