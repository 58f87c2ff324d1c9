"""Sandbox of a process on Linux: no network, no other processes, and files outside some folders are closed.

It uses what the kernel gives to every user: Landlock for files (https://docs.kernel.org/userspace-api/landlock.html),
a seccomp filter for system calls (https://docs.kernel.org/userspace-api/seccomp_filter.html) and resource limits. It
cannot be taken off again. On other systems there is none.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

from crowdbot.core import InputError, system_name


def sandbox_problem() -> str | None:
    """Return why there is no sandbox on this system, None if there is one."""
    if sys.platform == "linux":
        from .linux_sandbox import kernel_problem

        return kernel_problem()
    else:
        return f"the sandbox needs Linux, this is {system_name()}"


def enter_sandbox(
    readable: Iterable[Path],
    writable: Iterable[Path] = (),
    *,
    memory: int | None = None,
    cpu: int | None = None,
    programs: bool = False,
) -> None:
    """Put this process into a sandbox for good.

    Afterwards it can read files in ``readable`` and ``writable`` only, write in ``writable`` only, open no socket,
    start no process, and signal none. The superuser loses its rights.

    Args:
        readable: files and folders to read and to load code from; missing ones are left out.
        writable: folders to write in, such as an empty temporary folder.
        memory: largest address space [bytes].
        cpu: largest CPU time [s]; the process is then killed.
        programs: whether this process may become another program, in the same sandbox.

    Raises:
        InputError: this system has no sandbox, see :func:`sandbox_problem`.
    """
    problem = sandbox_problem()
    if problem is not None:
        raise InputError(problem)
    if sys.platform == "linux":
        from .linux_sandbox import restrict_process

        restrict_process(readable, writable, memory, cpu, programs)
