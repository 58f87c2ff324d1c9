"""SessionLimits: what a session of the app may use."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field

from crowdbot.core import InputError, machine_memory

MEMORY = 0.8
"""Share of the memory of the machine that a job may use by default: a machine without memory answers nobody."""


@dataclass(frozen=True)
class SessionLimits:
    """Limits of each session; infinity means no limit.

    Fields:
        jobs: jobs that run at the same time; others wait.
        waiting: jobs that may wait.
        cpu: processor time of all jobs of a session [s].
        memory: memory of a job with the processes that it starts [B] (default: 80 % of this machine).
        upload: largest file that a window may send [B].
        disk: size of the folder of a session [B].
        windows: windows of a session at the same time.
        idle: time without a window and without a job after which a session ends; its files stay [s].

    Raises:
        InputError: a limit is not positive.

    >>> SessionLimits(jobs=1).jobs
    1
    """

    jobs: int = 2
    waiting: int = 20
    cpu: float = math.inf
    memory: float = field(default_factory=lambda: MEMORY * machine_memory())
    upload: float = 512e6
    disk: float = math.inf
    windows: int = 20
    idle: float = math.inf

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if not value > 0:
                raise InputError(f"limit {name} = {value:g} must be positive")


CLASSROOM = SessionLimits(jobs=1, waiting=5, cpu=7200.0, memory=2e9, upload=128e6, disk=1e9, windows=6, idle=7200.0)
"""Limits of a server for other machines, such as for a class of thirty."""
