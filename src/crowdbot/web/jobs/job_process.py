"""The worker process of a job, and its memory."""

from __future__ import annotations

import contextlib
import io
import json
import math
import multiprocessing
import multiprocessing.connection
import os
import runpy
import signal
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from crowdbot.core import CrowdbotError, InputError, peak_memory

SHARE, LINE, CPU, END = "job.share", "job.line", "job.cpu", "job.end"
"""Kinds of messages that every job sends: completed share, line of the log, processor time [s], end with a problem."""
BEAT, LOOK = 1.0, 0.2
"""Time between two reports of the processor time, and between two looks at the memory [s]."""
PROC = Path("/proc")
LONGEST = 2000
"""Largest number of characters of a line of the log."""


class JobPipe:
    """The end of the pipe in the worker process; may be used from several threads."""

    def __init__(self, pipe: multiprocessing.connection.Connection) -> None:
        self._pipe, self._lock = pipe, threading.Lock()

    def send(self, message: tuple[Any, ...]) -> None:
        """Send a message, a tuple that begins with its kind."""
        with self._lock:
            self._pipe.send(message)

    def share(self, share: float) -> None:
        """Report the completed share, 0 to 1."""
        self.send((SHARE, float(share)))


def run_work(
    target: Callable[..., None],
    arguments: tuple[Any, ...],
    pipe: multiprocessing.connection.Connection,
    cpu: float,
    memory: float = math.inf,
) -> None:  # pragma: no cover - in another process
    """Call ``target(pipe, *arguments)`` and report how it ended.

    Args:
        target: the work; raises an error of crowdbot with a sentence for the user.
        arguments: its arguments.
        pipe: where messages go.
        cpu: processor time after which the system ends the process [s].
        memory: memory of this process and of those that it starts, above which it ends itself [B].
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C ends the server, which ends this process
    _limit_cpu(cpu)
    own = JobPipe(pipe)
    threading.Thread(target=_watch, args=(own, memory), daemon=True).start()
    try:
        target(own, *arguments)
        problem = ""
    except (BrokenPipeError, ConnectionError):  # the server is gone
        return
    except CrowdbotError as error:
        problem = str(error)
    except MemoryError:
        problem = f"{_used(process_memory(), memory)}, and the system gave no more"
    except Exception as error:
        problem = f"{type(error).__name__}: {error}; this is a bug in crowdbot or in your code"
    own.send((CPU, time.process_time()))
    own.send((END, problem))


def run_command(pipe: JobPipe, words: tuple[str, ...], folder: str) -> None:  # pragma: no cover - in another process
    """Run a command in this process, with its lines and its progress sent through a pipe.

    Raises:
        InputError: the command has failed, with its last sentence.
    """
    os.chdir(folder)
    os.environ["CROWDBOT_PROGRESS"] = "json"
    out = CommandOutput(pipe)
    sys.argv = ["crowdbot", *words]
    status: object = 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        try:
            runpy.run_module("crowdbot", run_name="__main__")
        except SystemExit as end:
            status = end.code
        out.flush_line()
    if status not in (0, None):
        raise InputError(out.problem or f"the command has ended with status {status}")


class CommandOutput(io.TextIOBase):
    """Standard output and standard error of a command: lines of the log, and progress as JSON.

    Args:
        pipe: where the messages go.

    Attributes:
        problem: newest sentence of the command about an error.
    """

    def __init__(self, pipe: JobPipe) -> None:
        super().__init__()
        self._pipe, self._rest, self.problem = pipe, "", ""

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """Name of the encoding."""
        return "utf-8"

    def writable(self) -> bool:
        """Return True."""
        return True

    def write(self, text: str) -> int:
        """Send the complete lines of a text."""
        *lines, self._rest = (self._rest + text).split("\n")
        for line in lines:
            self._send(line.rstrip())
        return len(text)

    def flush_line(self) -> None:
        """Send a last line without an end."""
        if self._rest:
            self.write("\n")

    def _send(self, line: str) -> None:
        if line.startswith('{"task"'):
            with contextlib.suppress(ValueError, KeyError, TypeError):
                self._pipe.share(json.loads(line)["share"])
                return
        if line.startswith(("crowdbot: ", "crowdbot error: ")) and "warning: " not in line:
            self.problem = line.partition(": ")[2]
        if line:
            self._pipe.send((LINE, line[:LONGEST]))


def _limit_cpu(seconds: float) -> None:
    """Let the system end this process after its processor time; on Windows the server watches it alone."""
    if sys.platform != "win32" and seconds < 1e9:
        import resource

        resource.setrlimit(resource.RLIMIT_CPU, (max(1, int(seconds + 0.5)), max(2, int(seconds + 2.5))))


def _watch(pipe: JobPipe, memory: float) -> None:
    """Report the processor time; end this process above its memory, or when the server is gone, also when killed."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    told = 0.0
    while True:
        parent.join(LOOK)
        if not parent.is_alive():
            os._exit(1)
        try:
            used = process_memory()
            if used > memory:
                pipe.send((CPU, time.process_time()))
                pipe.send((END, f"{_used(used, memory)}; it has ended"))
                end_descendants()
                os._exit(1)
            if time.monotonic() - told < BEAT:
                continue
            told = time.monotonic()
            pipe.send((CPU, time.process_time()))
        except OSError:
            os._exit(1)


def _used(memory: float, limit: float) -> str:
    limited = "" if math.isinf(limit) else f"; the limit of a job is {limit / 1e6:.0f} MB (--memory)"
    return f"the job uses {memory / 1e6:.0f} MB of memory{limited}"


def process_memory() -> float:
    """Return the resident memory of this process and of those that it has started [B].

    On macOS and Windows, it is the peak of this process alone.

    >>> process_memory() > 1e6
    True
    """
    if sys.platform == "linux" and PROC.joinpath("self", "statm").exists():
        page = os.sysconf("SC_PAGE_SIZE")
        return float(page * sum(_pages(pid) for pid in (os.getpid(), *_descendants(os.getpid()))))
    return peak_memory()


def end_descendants() -> None:
    """End the processes that this process has started, on Linux; elsewhere they end by themselves, or go on."""
    for pid in _descendants(os.getpid()):
        with contextlib.suppress(OSError):
            os.kill(pid, signal.SIGTERM)


def _pages(pid: int) -> int:
    try:
        return int(PROC.joinpath(str(pid), "statm").read_text(encoding="ascii").split()[1])
    except (OSError, ValueError, IndexError):  # it has ended
        return 0


def _descendants(pid: int) -> list[int]:
    """Return the processes that a process has started, and theirs."""
    found, front = list[int](), [pid]
    while front:
        with contextlib.suppress(OSError):
            for task in PROC.joinpath(str(front.pop()), "task").iterdir():
                with contextlib.suppress(OSError):
                    children = [int(item) for item in task.joinpath("children").read_text(encoding="ascii").split()]
                    found += children
                    front += children
    return found
