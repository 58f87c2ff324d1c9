"""PredictionRun: a run in a worker process, and the results that are kept."""

from __future__ import annotations

import contextlib
import multiprocessing
import multiprocessing.connection
import threading
from collections.abc import Callable
from typing import Any

from .prediction_results import PredictorResults
from .prediction_worker import PredictionTask, run_calibration, run_task

__all__ = ["PredictionRun"]


class PredictionRun:
    """Predictors that run in a worker process; a thread collects their results.

    Args:
        task: what runs.
        results: where the results go, by the keys of the members; those of the members are emptied first.
        tell: called with an event and JSON data, from the thread.

        calibrates: calibrate the crowds instead of predicting.
    """

    def __init__(
        self,
        task: PredictionTask,
        results: dict[str, PredictorResults],
        tell: Callable[[str, Any], None],
        calibrates: bool = False,
    ) -> None:
        self.task, self._results, self._tell = task, results, tell
        self._total = len(task.members)
        self._done = 0
        self._cancelled = self._ended = False
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe(duplex=False)
        target = run_calibration if calibrates else run_task
        self._process = context.Process(target=target, args=(task, theirs), daemon=True)
        self._process.start()
        theirs.close()
        self._thread = threading.Thread(target=self._collect, name="crowdbot-prediction-run", daemon=True)
        self._thread.start()

    @property
    def alive(self) -> bool:
        """Whether the run goes on."""
        return not self._ended

    def cancel(self) -> None:
        """End the run; the results so far are kept."""
        self._cancelled = True
        with contextlib.suppress(ValueError):  # it has ended and is closed
            self._process.terminate()
        self.join()

    def join(self, timeout: float | None = 20.0) -> bool:
        """Wait for the end of the run; returns whether it has ended."""
        self._thread.join(timeout)
        return not self._thread.is_alive()

    def _collect(self) -> None:
        problem = ""
        try:
            while True:
                kind, key, content = self._pipe.recv()
                if kind == "end":
                    problem = content
                    break
                self._take(kind, key, content)
        except (EOFError, OSError):
            if not self._cancelled:
                problem = "the worker process of the run has died (out of memory?)"
        for member in self.task.members:
            with contextlib.suppress(KeyError):
                self._results[member.key].stop(self._cancelled)
        self._ended = True
        self._tell("ended", {"problem": problem, "cancelled": self._cancelled})
        self._process.join()
        self._process.close()
        self._pipe.close()

    def _take(self, kind: str, key: str, content: Any) -> None:
        if kind in ("share", "fit", "problem"):
            self._tell({"share": "progress"}.get(kind, kind), {"key": key, kind: content})
            return
        found = self._results.get(key)
        if found is None:  # the predictor was removed while it ran
            return
        if kind == "begin":
            found.begin(content)
        elif kind == "part":
            for part in content:
                found.add(part)
            name = "clean" if self.task.degradation is None else "degraded"
            self._tell(
                "lines", {"key": key, "input": name, "lines": [line for part in content for line in found.lines(part)]}
            )
        elif kind == "score":
            found.finish(content)
            self._done += 1
        elif kind == "note":
            found.note = content
            self._tell("note", {"key": key, "text": content})
        else:
            found.fail(content)
            self._done += 1
        share = (self._done + (found.share if kind in ("begin", "part") else 0.0)) / self._total
        name = "clean" if self.task.degradation is None else "degraded"
        counts = {"done": found.count, "windows": len(found.past), "state": found.state, "problem": found.problem}
        self._tell("progress", {"key": key, "share": share, "input": name, **counts})
