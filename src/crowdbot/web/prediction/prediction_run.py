"""PredictionRun: a run as a job, and the results that are kept."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any

from crowdbot.web.jobs.job import Job, JobWork
from crowdbot.web.jobs.job_board import JobBoard

from .prediction_results import PredictorResults
from .prediction_worker import PredictionTask, run_calibration, run_task


class PredictionRun:
    """Predictors that run as a job of the session; its thread collects their results.

    Args:
        jobs: the jobs of the session.
        task: what runs.
        results: where the results go, by the keys of the members; those of the members are emptied first.
        tell: called with an event and JSON data, from the thread.
        title, command: for the list of jobs.
        calibrates: calibrate the crowds instead of predicting.

    Raises:
        InputError: a limit of the session is reached.
    """

    def __init__(
        self,
        jobs: JobBoard,
        task: PredictionTask,
        results: dict[str, PredictorResults],
        tell: Callable[[str, Any], None],
        title: str,
        command: str = "",
        calibrates: bool = False,
    ) -> None:
        self.task, self._results, self._tell = task, results, tell
        self._total = len(task.members)
        self._done = 0
        self._ended = False
        kind, target = ("Calibration", run_calibration) if calibrates else ("Prediction", run_task)
        self._job = jobs.submit(JobWork(kind, title, target, (task,), command), self._take, self._finish)

    @property
    def alive(self) -> bool:
        """Whether the run goes on."""
        return not self._ended

    def cancel(self) -> None:
        """End the run; the results so far are kept."""
        self._job.cancel()

    def join(self, timeout: float | None = 20.0) -> bool:
        """Wait for the end of the run; returns whether it has ended."""
        return self._job.join(timeout)

    def _finish(self, job: Job) -> None:
        for member in self.task.members:
            with contextlib.suppress(KeyError):
                self._results[member.key].stop(job.cancelled)
        self._ended = True
        self._tell("ended", {"problem": job.record.problem, "cancelled": job.cancelled})

    def _take(self, kind: str, key: str, content: Any) -> float | None:
        if kind in ("share", "fit", "problem"):
            self._tell({"share": "progress"}.get(kind, kind), {"key": key, kind: content})
            return content if kind == "share" else None
        found = self._results.get(key)
        if found is None:  # the predictor was removed while it ran
            return None
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
        return share
