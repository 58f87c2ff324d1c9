"""The trial that a new session shows: the one that the address of the page names, or the first trial of the app."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple, TypeVar

from crowdbot.core import InputError

Number = TypeVar("Number", int, float)
FIRST: tuple[str, dict[str, str], int] = (
    "two-way",
    {"robot/type": "pepper", "end/collision": "false"},
    1,
)
"""Trial, values and seed that a new session shows: a robot among walking people."""


class RunAddress(NamedTuple):
    """What the address of a page names.

    Fields:
        name: trial or episode.
        values: values of the trial, as for ``--set``.
        seed: seed of the trial; None for that of its file.
        episode: whether it is an episode.
        variant: number of the variant of the trial.
        time: instant [s] that is shown first; None for the beginning.
        paused: whether it waits there.
    """

    name: str
    values: Mapping[str, str] = MappingProxyType({})
    seed: int | None = None
    episode: bool = False
    variant: int = 1
    time: float | None = None
    paused: bool = False


def read_link(address: Mapping[str, str]) -> RunAddress | None:
    """Return the trial or episode that the values of an address name; None if they name none.

    Raises:
        InputError: a value is not one that the page writes.

    >>> read_link({"tab": "jobs", "trial": "frontal", "seed": "3", "time": "2.5"})
    RunAddress(name='frontal', values={}, seed=3, episode=False, variant=1, time=2.5, paused=False)
    """
    episode = "episode" in address
    name = address.get("episode" if episode else "trial", "")
    if not name:
        return None
    paused = "paused" in address
    time = _link_value(address, "time", float, r"\d{1,9}(\.\d{1,9})?", "seconds from 0 on")
    if episode:
        return RunAddress(name, episode=True, time=time, paused=paused)
    seed = _link_value(address, "seed", int, r"-?\d{1,18}", "a whole number")
    variant = _link_value(address, "variant", int, r"\d{1,9}", "a whole number from 1 on")
    text = address.get("values", "{}")
    try:
        values = json.loads(text)
    except (ValueError, RecursionError):
        values = None
    if not isinstance(values, dict) or not all(isinstance(value, str) for value in values.values()):
        raise InputError(f"the address of the page has values={text!r:.80}: expected a JSON object of texts")
    return RunAddress(name, values, seed, False, 1 if variant is None else variant, time, paused)


def _link_value(
    address: Mapping[str, str], name: str, kind: Callable[[str], Number], pattern: str, allowed: str
) -> Number | None:
    text = address.get(name)
    if text is not None and not re.fullmatch(pattern, text, re.ASCII):
        raise InputError(f"the address of the page has {name}={text!r:.80}: expected {allowed}")
    return None if text is None else kind(text)
