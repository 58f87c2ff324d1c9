"""StackProgram: a robot software that a run starts and ends."""

from __future__ import annotations

import contextlib
import os
import shlex
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from typing import IO

from crowdbot.core import InputError, check_programs, refuse_system

PATIENCE = 3.0
"""Real time [s] between the request to end and the end by force."""
LAST = 500
"""Characters of the error output in a message."""


def _check_process_groups(what: str) -> None:
    """Raise InputError on Windows, where a program would end without the programs that it has started."""
    if sys.platform == "win32":
        refuse_system(f"the start of {what} by a run", "Linux or macOS", "start it yourself, and leave out command")


class StackProgram:
    """A program with its children, in a process group of its own.

    Args:
        command: program and arguments, as in a shell without its special characters.
        places: values of ``{port}`` and ``{domain}`` in the command.
        environment: variables in addition to those of this process.

    Raises:
        InputError: the program cannot be started, or the system is Windows, which has no process groups to end.

    >>> program = StackProgram("sh -c 'echo no map >&2; exit 3'", {}, {})
    >>> _ = program.wait(10.0)
    >>> program.ending
    '(exit status 3): no map'
    >>> program.close()
    """

    def __init__(self, command: str, places: Mapping[str, object], environment: Mapping[str, str]) -> None:
        check_programs(f"{command[:80]!r}")
        _check_process_groups(f"{command[:80]!r}")
        words = shlex.split(command)
        for name, value in places.items():
            words = [word.replace(f"{{{name}}}", str(value)) for word in words]
        self.name = words[0] if words else ""
        self._log: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 (closed by close())
        try:
            self._process = subprocess.Popen(  # noqa: S603 (the trial names the program)
                words,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=self._log,
                env=os.environ | dict(environment),
                start_new_session=True,
            )
        except (OSError, IndexError, ValueError) as error:
            self._log.close()
            reason = error.strerror if isinstance(error, OSError) else str(error)
            raise InputError(f"the program {command[:80]!r} cannot be started: {reason}") from None

    @property
    def is_alive(self) -> bool:
        """Whether the program runs."""
        return self._process.poll() is None

    def wait(self, seconds: float) -> int | None:
        """Wait for the end and return the exit status, None if it still runs."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            return self._process.wait(seconds)
        return None

    @property
    def ending(self) -> str:
        """Exit status and last line of the error output, for messages."""
        code = self._process.poll()
        end = self._log.seek(0, os.SEEK_END)
        self._log.seek(max(0, end - LAST))
        lines = [line.strip() for line in self._log.read().decode("utf-8", "replace").splitlines() if line.strip()]
        status = "" if code is None else (f"killed by signal {-code}" if code < 0 else f"exit status {code}")
        return f"({status})" * bool(status) + (f": {lines[-1]}" if lines else "")

    def close(self) -> None:
        """End the program and its children."""
        if self._log.closed:
            return
        self._end_group()
        if self.wait(PATIENCE) is None:
            self._end_group(by_force=True)
            self._process.wait()
        self._end_group(by_force=True)  # children that have ignored the request
        self._log.close()

    def _end_group(self, by_force: bool = False) -> None:
        if sys.platform != "win32":
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL if by_force else signal.SIGTERM)
