"""Decision threads: the code of a navigator runs with a limit of real time, so that a decision that hangs ends."""

from __future__ import annotations

import contextlib
import contextvars
import ctypes
import os
import queue
import sys
import threading
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any, TypeVar

T = TypeVar("T")
Answers = queue.SimpleQueue[tuple[bool, Any]]


class HungNavigatorError(Exception):
    """A decision did not return within its limit of real time.

    Attributes:
        seconds: the limit [s].
        place: file and line of the call that did not return, when it is known from a recording.
    """

    def __init__(self, what: str, seconds: float, place: str = "") -> None:
        super().__init__(f"{what} did not return within {seconds:g} s")
        self.seconds, self.place = seconds, place


class _Abandoned(BaseException):
    """Ends the code of a thread whose answer nobody awaits."""


class _DecisionThread:
    """A thread that makes one call after the other; it ends when this object is dropped or abandoned."""

    def __init__(self) -> None:
        self.process = os.getpid()
        self._calls: queue.SimpleQueue[tuple[Callable[[], Any], Answers] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=_work, args=(self._calls,), name="crowdbot-decisions", daemon=True)
        self._thread.start()

    def call(self, function: Callable[[], T], seconds: float, what: str) -> T:
        """Return the result of a call in this thread; see :func:`call_within`."""
        answers: Answers = queue.SimpleQueue()  # one for each call, so that a late answer reaches nobody
        self._calls.put((function, answers))
        try:
            success, answer = answers.get(timeout=seconds)
        except BaseException as error:
            trace = self._trace()
            self.abandon()
            if isinstance(error, queue.Empty):
                raise HungNavigatorError(what, seconds).with_traceback(trace) from None
            raise
        if success:
            return answer  # type: ignore[no-any-return]
        raise answer

    def abandon(self) -> None:
        """End the thread after its present call, and end that call between two of its instructions, if possible."""
        _LOCAL.thread = None
        self._calls.put(None)
        identity = self._thread.ident or 0
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(identity), ctypes.py_object(_Abandoned))

    def _trace(self) -> TracebackType | None:
        """Return the traceback of the present call."""
        frame: FrameType | None = sys._current_frames().get(self._thread.ident or 0)
        trace: TracebackType | None = None
        while frame is not None and frame.f_code.co_filename != __file__:
            trace = TracebackType(trace, frame, max(frame.f_lasti, 0), frame.f_lineno or 1)
            frame = frame.f_back
        return trace

    def __del__(self) -> None:
        self._calls.put(None)


def _work(calls: queue.SimpleQueue[tuple[Callable[[], Any], Answers] | None]) -> None:
    with contextlib.suppress(_Abandoned):
        while (call := calls.get()) is not None:
            function, answers = call
            try:
                answer: tuple[bool, Any] = (True, function())
            except _Abandoned:
                return
            except BaseException as error:
                answer = (False, error)
            del call, function
            answers.put(answer)
            del answers, answer


_LOCAL = threading.local()
"""The decision thread of each thread that makes decisions."""


def call_within(seconds: float | None, function: Callable[[], T], what: str) -> T:
    """Return the result of a call that may take some real time, and raise if it takes longer.

    The call runs in a thread of its own with the context variables of the caller, one call at a time. If it takes
    longer than allowed, the thread is abandoned: Python code in it ends, a call of compiled code goes on until it
    returns, without effect.

    Args:
        seconds: limit [s]; None: no limit, and no other thread.
        function: function without arguments.
        what: what is called, for the message.

    Raises:
        HungNavigatorError: the call takes longer; the trace is that of the call.
        Exception: what the function raises.

    >>> call_within(5.0, lambda: 6 * 7, "an example")
    42
    >>> import time
    >>> call_within(0.05, lambda: time.sleep(60), "a long sleep")
    Traceback (most recent call last):
    crowdbot.navigation.decision_thread.HungNavigatorError: a long sleep did not return within 0.05 s
    """
    if seconds is None:
        return function()
    thread: _DecisionThread | None = getattr(_LOCAL, "thread", None)
    if thread is None or thread.process != os.getpid():  # a fork has no threads but the one that forked
        thread = _LOCAL.thread = _DecisionThread()
    context = contextvars.copy_context()
    return thread.call(lambda: context.run(function), seconds, what)
