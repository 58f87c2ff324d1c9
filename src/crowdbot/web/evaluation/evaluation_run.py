"""EvaluationRun: an evaluation in a worker process, which continues what an earlier one has done."""

from __future__ import annotations

import contextlib
import multiprocessing
import multiprocessing.connection
import signal
import threading
from collections.abc import Callable
from pathlib import Path

from crowdbot.core import CrowdbotError
from crowdbot.evaluation import evaluate, parse_statistic, worst_runs, write_report

from .evaluation_request import EvaluationRequest

__all__ = ["EvaluationRun"]

WORST = 1
"""Runs of each row that the report plays."""


class EvaluationRun:
    """An evaluation in a worker process; a thread collects its progress.

    Args:
        request: what to run.
        folder: folder of the trial files.
        out: folder of the results; parts that are there are used.
        progress: called with the completed share, 0 to 1, from a thread.
        ended: called with the error, empty if there is none, from a thread.
    """

    def __init__(
        self,
        request: EvaluationRequest,
        folder: Path,
        out: Path,
        progress: Callable[[float], None],
        ended: Callable[[str], None],
    ) -> None:
        self.share, self.out, self._cancelled = 0.0, out, False
        self._progress, self._ended = progress, ended
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe(duplex=False)
        self._process = context.Process(target=_work, args=(request, folder, out, theirs), daemon=True)
        self._process.start()
        theirs.close()
        self._thread = threading.Thread(target=self._collect, name="crowdbot-evaluation", daemon=True)
        self._thread.start()

    def cancel(self) -> None:
        """End the run; what is done is kept, and the same evaluation continues from there."""
        self._cancelled = True
        with contextlib.suppress(ValueError):  # it has ended and is closed
            self._process.terminate()
        self.join()

    def join(self) -> None:
        """Wait for the end of the run."""
        if threading.current_thread() is not self._thread:
            self._thread.join(30.0)

    def _collect(self) -> None:
        problem = ""
        try:
            while True:
                kind, content = self._pipe.recv()
                if kind == "end":
                    problem = content
                    break
                self.share = content
                self._progress(content)
        except (EOFError, OSError):
            problem = "" if self._cancelled else "the worker process has died (out of memory?)"
        self._process.join()
        self._process.close()
        self._pipe.close()
        self._ended("cancelled; run it again to continue" if self._cancelled else problem)


def _work(
    request: EvaluationRequest, folder: Path, out: Path, pipe: multiprocessing.connection.Connection
) -> None:  # pragma: no cover - in another process
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C ends the server, which ends this process
    try:
        plan = request.plan(folder)
        result = evaluate(plan, out / "parts", progress=lambda share: pipe.send(("share", share)))
        result.save(out / "result.json")
        statistics = [parse_statistic(name, result.metrics) for name in request.metrics]
        worst = worst_runs(plan, result, WORST)
        write_report(result, out / "report.html", statistics, worst=worst, comparisons=result.compare())
        pipe.send(("end", ""))
    except CrowdbotError as error:
        pipe.send(("end", str(error)))
    except Exception as error:
        pipe.send(("end", f"{type(error).__name__}: {error}; this is a bug in crowdbot or in your code"))
