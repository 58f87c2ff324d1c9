"""Metrics of users in an evaluation: a class in a file, ``mine.py:TimeNear``, becomes the metric ``time_near``."""

from __future__ import annotations

import re
from pathlib import Path

import crowdbot.metrics
from crowdbot.core import InputError, find_class, kebab_case
from crowdbot.metrics import LogMetric, metric_table

ADDRESS = re.compile(r"[^:]*(?:\.py|/):[A-Za-z_]\w*")


def is_own_metric(name: str) -> bool:
    """Return whether a name is the address of a class, such as ``mine.py:TimeNear``.

    >>> is_own_metric("mine.py:TimeNear"), is_own_metric("p95:time-to-goal")
    (True, False)
    """
    return bool(ADDRESS.fullmatch(name))


def metric_name(address: str) -> str:
    """Return the name of the metric with an address.

    >>> metric_name("mine.py:TimeNear")
    'time_near'
    """
    return kebab_case(address.rpartition(":")[2]).replace("-", "_")


def load_metric(address: str) -> LogMetric:
    """Return the metric with an address, relative to the working folder, with its default parameters.

    Raises:
        InputError: there is no such class, it needs parameters, or a built-in metric has its name.
    """
    if metric_name(address) in metric_table():
        raise InputError(f"metric {address!r}: {metric_name(address)} is a built-in metric; use another name")
    kind = find_class(address, crowdbot.metrics, LogMetric, folder=Path.cwd())
    try:
        made: LogMetric = kind()
    except TypeError as error:
        raise InputError(f"metric {address!r} needs defaults for its parameters: {error}") from None
    return made


def metric_source(address: str) -> str:
    """Return the text of the file of a metric, which results depend on; empty for a folder."""
    file = Path(address.rpartition(":")[0])
    return file.read_text(encoding="utf-8") if file.is_file() else ""
