"""Streams of the Lab Streaming Layer that stay on this machine and in this process.

The configuration of liblsl counts for the whole process and is read once, so the tests share this one. Each process has
its own session, and does not see the streams of another worker.
"""

from __future__ import annotations

import os

import pylsl

pylsl.set_config_content(
    "[multicast]\nResolveScope = machine\n[ports]\nIPv6 = disable\n[log]\nlevel = -3\n"
    f"[lab]\nSessionID = crowdbot-tests-{os.getpid()}\n"
)
