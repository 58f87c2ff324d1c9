"""Commands of the command line as jobs."""

from __future__ import annotations

import contextlib
import io
import json
import os
import runpy
import shlex
import sys
from pathlib import Path

from crowdbot.core import InputError

from .job import JobWork
from .job_process import LINE, JobPipe

LONGEST = 2000


def command_work(kind: str, title: str, words: tuple[str, ...], folder: Path, results: str) -> JobWork:
    """Return a job that runs ``crowdbot WORDS`` in a folder, so that its results are those of the command line.

    >>> command_work("Evaluation", "frontal", ("evaluate", "frontal"), Path("."), "").command
    'crowdbot evaluate frontal'
    """
    command = shlex.join(("crowdbot", *words))
    return JobWork(kind, title, run_command, (words, str(folder)), command, results, words)


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
