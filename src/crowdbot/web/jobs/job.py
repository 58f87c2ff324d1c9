"""Job: one piece of long work in a worker process."""

from __future__ import annotations

import contextlib
import math
import multiprocessing
import shlex
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .job_process import CPU, END, LINE, SHARE, run_command, run_work
from .job_record import CANCELLED, DONE, FAILED, RUNNING, JobRecord

DIED = "the worker process has died (out of memory?)"
CPU_USED = "the processor time of the jobs is used up"


@dataclass(frozen=True)
class JobWork:
    """What a job does.

    Fields:
        kind, title, command, results: see :class:`JobRecord`.
        target: function of a worker process, called as ``target(pipe, *arguments)``.
        arguments: its arguments; both are sent to the process.
        words: arguments of the command line if the job can be run again from them alone.
    """

    kind: str
    title: str
    target: Callable[..., None]
    arguments: tuple[Any, ...] = ()
    command: str = ""
    results: str = ""
    words: tuple[str, ...] = ()


def command_work(kind: str, title: str, words: tuple[str, ...], folder: Path, results: str) -> JobWork:
    """Return a job that runs ``crowdbot WORDS`` in a folder, so that its results are those of the command line.

    >>> command_work("Evaluation", "frontal", ("evaluate", "frontal"), Path("."), "").command
    'crowdbot evaluate frontal'
    """
    command = shlex.join(("crowdbot", *words))
    return JobWork(kind, title, run_command, (words, str(folder)), command, results, words)


class Job:
    """A piece of work; a thread collects the messages of its process.

    Args:
        record: where its state is kept.
        work: what it does.
        take: called with each message that is not one of every job; may return the completed share.
        ended: called once at the end, with the job.
        told: called with the job and the kind of each message of every job, and with a line of the log.
    """

    def __init__(
        self,
        record: JobRecord,
        work: JobWork,
        take: Callable[..., float | None] | None,
        ended: Callable[[Job], None],
        told: Callable[[Job, str], None],
    ) -> None:
        self.record, self.work = record, work
        self._take, self._ended, self._told = take, ended, told
        self._cancelled, self._stopped = False, ""
        self._thread: threading.Thread | None = None
        self._process: multiprocessing.process.BaseProcess | None = None
        self._finished = threading.Event()

    @property
    def alive(self) -> bool:
        """Whether it waits or runs."""
        return not self._finished.is_set()

    @property
    def cancelled(self) -> bool:
        """Whether a user has ended it."""
        return self._cancelled

    def start(self, cpu: float, memory: float = math.inf) -> None:
        """Start the process; it ends after the given processor time [s] or above the given memory [B]."""
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe(duplex=False)
        arguments = (self.work.target, self.work.arguments, theirs, cpu, memory)
        process = context.Process(target=run_work, args=arguments, daemon=True)
        process.start()
        self._process, self._begin, self._cpu = process, time.monotonic(), cpu
        theirs.close()
        self.record.state = RUNNING
        self._thread = threading.Thread(target=self._collect, name=f"crowdbot-job-{self.record.number}", daemon=True)
        self._thread.start()

    def cancel(self) -> None:
        """End it; what it has stored so far is kept."""
        self._cancelled = True
        self._end_process()

    def stop(self, problem: str) -> None:
        """End it because of a limit."""
        self._stopped = problem
        self._end_process()

    def join(self, timeout: float | None = 30.0) -> bool:
        """Wait for the end and what follows it; returns whether it has ended."""
        if self._thread is not None:
            self._thread.join(timeout)
        return self._finished.is_set()

    def _end_process(self) -> None:
        if self._process is None:
            self._finish("")
            return
        with contextlib.suppress(ValueError):  # it has ended and is closed
            self._process.terminate()
        if threading.current_thread() is not self._thread:
            self.join()

    def _collect(self) -> None:
        assert self._process is not None
        problem = None
        try:
            while True:
                message = self._pipe.recv()
                if message[0] == END:
                    problem = message[1]
                    break
                self._receive(message)
        except (EOFError, OSError):
            pass
        self._process.join()
        if problem is None:
            over = self._process.exitcode == -getattr(signal, "SIGXCPU", 0)
            problem = CPU_USED if over else DIED
            self.record.cpu = max(self.record.cpu, self._cpu) if over else self.record.cpu
        self._process.close()
        self._pipe.close()
        self._finish(problem)

    def _receive(self, message: tuple[Any, ...]) -> None:
        kind = message[0]
        self.record.seconds = time.monotonic() - self._begin
        if kind == SHARE:
            self.record.share = message[1]
        elif kind == LINE:
            self.record.note = message[1][:300]
        elif kind == CPU:
            self.record.cpu = message[1]
        elif self._take is not None:
            share = self._take(*message)
            if share is not None:
                self.record.share = share
            kind = SHARE
        self._told(self, message[1] + "\n" if kind == LINE else "")

    def _finish(self, problem: str) -> None:
        if self._finished.is_set():
            return
        record = self.record
        if self._cancelled:
            record.state, record.problem = CANCELLED, ""
        elif self._stopped or problem:
            record.state, record.problem = FAILED, self._stopped or problem
        else:
            record.state, record.share = DONE, 1.0
        self._finished.set()
        self._ended(self)
