"""Streams of the Lab Streaming Layer that stay on this machine and in this process.

The configuration of liblsl counts for the whole process and is read once, so the tests share this one. Each process has
its own session, and does not see the streams of another worker.
"""

from __future__ import annotations

import os
from typing import Any

import pylsl

pylsl.set_config_content(
    "[multicast]\nResolveScope = machine\n[ports]\nIPv6 = disable\n[log]\nlevel = -3\n"
    f"[lab]\nSessionID = crowdbot-tests-{os.getpid()}\n"
)


def inlet_of(name: str) -> pylsl.StreamInlet:
    """Return an open inlet of a stream."""
    inlet = pylsl.StreamInlet(pylsl.resolve_byprop("name", name, 1, 10.0)[0])
    inlet.open_stream(10.0)
    return inlet


def arrived(inlet: pylsl.StreamInlet) -> list[tuple[float, list[Any]]]:
    """Return time stamp and values of all samples that arrive until there is a pause of 0.5 s."""
    samples: list[tuple[float, list[Any]]] = []
    while True:
        values, stamps = inlet.pull_chunk(timeout=0.5)
        if not stamps:
            return samples
        samples += zip(stamps, values, strict=True)
