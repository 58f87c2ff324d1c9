"""ChildProcess: a process that answers requests on its standard streams, with a limit of time for each."""

from __future__ import annotations

import atexit
import json
import os
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import IO, Any

from crowdbot.core import InputError, check_programs, refuse_system

from .messages import LONGEST_LINE

START = 60.0
"""Longest time until a process is ready: it imports its libraries [s]."""
KEPT = ("PATH", "LANG", "LC_ALL", "LD_LIBRARY_PATH", "PYTHONPATH", "SYSTEMROOT", "VIRTUAL_ENV")
"""Variables of the environment that a process inherits."""
LAST = 500
"""Characters of the error output in a message."""


class ChildProcess:
    """A process that answers requests in order: a line of JSON in, a line of JSON out.

    Args:
        words: program and arguments; ``{scratch}`` is replaced by a folder of its own for files.
        name: name of the navigator, for error messages.

    Raises:
        InputError: it cannot be started, or the system is Windows.
    """

    def __init__(self, words: Sequence[str], name: str) -> None:
        check_programs(f"navigator {name}")
        check_pipes(f"navigator {name}: a process of its own")
        self.name, self._lock, self._buffer = name, threading.Lock(), b""
        self.scratch = Path(tempfile.mkdtemp(prefix="crowdbot-process-"))
        self._log = (self.scratch / "stderr").open("w+b")
        kept = {key: os.environ[key] for key in KEPT if key in os.environ}
        place = str(self.scratch)
        kept |= {"CROWDBOT_CACHE": place, "HOME": place, "TMPDIR": place, "PYTHONDONTWRITEBYTECODE": "1"}
        try:
            self._process = subprocess.Popen(  # noqa: S603 (the trial names the program)
                [word.replace("{scratch}", place) for word in words],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._log,
                env=kept,
                start_new_session=True,
            )
        except OSError as error:
            self.close()
            raise InputError(f"navigator {name}: {words[0]} cannot be started: {error.strerror}") from None
        assert self._process.stdout is not None
        _stop_blocking(self._process.stdout)

    def wait_until_ready(self) -> None:
        """Wait for the first line, which says that the process is ready."""
        with self._lock:
            first = self._receive(time.monotonic() + START, START)
            if "error" in first:
                self.close()
                raise InputError(f"navigator {self.name}: {first['error']}")

    def ask(self, request: Mapping[str, Any], seconds: float) -> dict[str, Any]:
        """Return the answer to a request; a process that ends, is late or writes something else is closed.

        Raises:
            InputError: there is no answer within ``seconds``, or it is not valid.
        """
        with self._lock:
            data = json.dumps(request, separators=(",", ":"), allow_nan=False).encode() + b"\n"
            end = time.monotonic() + seconds
            self._send(data, end, seconds)
            return self._receive(end, seconds)

    def _send(self, data: bytes, end: float, seconds: float) -> None:
        stream = self._process.stdin
        assert stream is not None
        _stop_blocking(stream)
        view = memoryview(data)
        while view:
            _, ready, _ = select.select([], [stream], [], max(0.0, end - time.monotonic()))
            if not ready:
                raise self._failure(f"did not read its request within {seconds:g} s")
            try:
                view = view[os.write(stream.fileno(), view) :]
            except BlockingIOError:
                continue
            except OSError:
                raise self._failure("has ended") from None

    def _receive(self, end: float, seconds: float) -> dict[str, Any]:
        stream = self._process.stdout
        assert stream is not None
        while b"\n" not in self._buffer:
            ready, _, _ = select.select([stream], [], [], max(0.0, end - time.monotonic()))
            if not ready:
                raise self._failure(f"did not answer within {seconds:g} s")
            part = os.read(stream.fileno(), 1 << 16)
            if not part:
                raise self._failure("has ended")
            self._buffer += part
            if len(self._buffer) > LONGEST_LINE:
                raise self._failure(f"answers with more than {LONGEST_LINE} bytes")
        line, _, self._buffer = self._buffer.partition(b"\n")
        try:
            document = json.loads(line)
        except (ValueError, RecursionError):
            raise self._failure("answers with a line that is not JSON") from None
        if not isinstance(document, dict):
            raise self._failure("answers with JSON that is not an object")
        return document

    def _failure(self, what: str) -> InputError:
        """Close the process and return the exception that says why."""
        said = self._last_words()
        self.close()
        return InputError(f"navigator {self.name}: its process {what}{said}")

    def _last_words(self) -> str:
        if self._process.poll() is None:
            time.sleep(0.02)  # the kernel reports the end of a stream before that of its process
        code = self._process.poll()
        self._log.flush()
        text = (self.scratch / "stderr").read_bytes()[-LAST:].decode("utf-8", "replace")
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        ending = "" if code is None else f" ({_status(code)})"
        return ending + (f": {lines[-1]}" if lines else "")

    @property
    def is_open(self) -> bool:
        """Whether requests can be made."""
        return self._process.poll() is None and self.scratch.is_dir()

    def close(self) -> None:
        """End the process, and remove its folder."""
        process = getattr(self, "_process", None)
        if process is not None:
            if process.poll() is None:
                process.kill()
            process.wait()
            for stream in (process.stdin, process.stdout):
                try:
                    stream.close()
                except OSError:  # data for a process that has ended
                    continue
        self._log.close()
        shutil.rmtree(self.scratch, ignore_errors=True)


def check_pipes(what: str) -> None:
    """Raise InputError on Windows, whose pipes have no limit of time.

    Args:
        what: who needs the pipes, for the message.

    >>> check_pipes("navigator mine: a process of its own")
    """
    if sys.platform == "win32":
        refuse_system(what, "Linux or macOS", "let the navigator run in this process, as mine.py:Mine")


def _stop_blocking(stream: IO[bytes]) -> None:
    if sys.platform != "win32":
        os.set_blocking(stream.fileno(), False)


def _status(code: int) -> str:
    if code < 0:
        try:
            return f"killed by {signal.Signals(-code).name}"
        except ValueError:
            return f"killed by signal {-code}"
    return f"exit status {code}"


_OPEN: dict[tuple[Any, ...], ChildProcess] = {}
_OPENING = threading.Lock()


def child_process(words: Sequence[str], name: str) -> ChildProcess:
    """Return the running process of some words; it is started if there is none in this process."""
    key = (os.getpid(), *words)
    with _OPENING:
        process = _OPEN.get(key)
        if process is None or not process.is_open:
            process = ChildProcess(words, name)
            try:
                process.wait_until_ready()
            except BaseException:
                process.close()
                raise
            _OPEN[key] = process
        return process


def close_all() -> None:
    """End all processes that this process has started."""
    for key in [key for key in _OPEN if key[0] == os.getpid()]:
        _OPEN.pop(key).close()


atexit.register(close_all)
