"""JobBoard: the jobs of a session: queue, limits, log, and the list on disk."""

from __future__ import annotations

import contextlib
import json
import math
import shutil
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from crowdbot.core import InputError
from crowdbot.web.session_limits import SessionLimits
from crowdbot.web.workspace import Workspace

from .job import CPU_USED, Job, JobWork
from .job_record import RUNNING, WAITING, JobRecord

FOLDER = ".crowdbot-jobs"
LIST = "jobs.json"
MOST_RECORDS = 100
MOST_LOG = 200_000
"""Longest log that a window gets [characters]."""
PAUSE = 0.25
"""Time between two reports of a job [s]."""
CHECK = 2.0
"""Time between two looks at the size of the folder [s]."""


class JobBoard:
    """The jobs of a session.

    The list and the logs are stored in the folder of the session. After a restart of the server, jobs that were
    running then are listed as interrupted.

    Args:
        workspace: the folder of the session.
        limits: limits of the session.
        tell: sends an event with JSON data to the windows, from any thread.

    >>> import tempfile
    >>> JobBoard(Workspace(Path(tempfile.mkdtemp())), SessionLimits(), lambda event, data: None).records
    []
    """

    def __init__(self, workspace: Workspace, limits: SessionLimits, tell: Callable[[str, Any], None]) -> None:
        self.workspace, self.limits, self._tell = workspace, limits, tell
        self._folder = workspace.folder / FOLDER
        self._lock = threading.RLock()
        self._jobs: dict[int, Job] = {}
        self._told: dict[int, float] = {}
        self._checked = 0.0
        self._closed = False
        self._records = self._load()

    @property
    def records(self) -> list[JobRecord]:
        """All jobs, oldest first."""
        with self._lock:
            return list(self._records.values())

    @property
    def active(self) -> bool:
        """Whether a job waits or runs."""
        return any(record.active for record in self.records)

    @property
    def cpu(self) -> float:
        """Processor time of all jobs [s]."""
        return sum(record.cpu for record in self.records)

    def facts(self) -> dict[str, Any]:
        """Return the jobs, newest first, and what the session uses, as JSON."""
        own = self.limits
        return {
            "jobs": [record.values for record in reversed(self.records)],
            "cpu": self.cpu,
            "cpu_limit": None if math.isinf(own.cpu) else own.cpu,
            "disk": self.workspace.size(),
            "disk_limit": None if math.isinf(own.disk) else own.disk,
            "memory_limit": None if math.isinf(own.memory) else own.memory,
            "at_once": own.jobs,
        }

    def submit(
        self,
        work: JobWork,
        take: Callable[..., float | None] | None = None,
        ended: Callable[[Job], None] | None = None,
    ) -> Job:
        """Add a job; it starts when fewer jobs than the limit run.

        Args:
            work: what it does.
            take: called from a thread with each message of the work; may return the completed share.
            ended: called from a thread at the end.

        Raises:
            InputError: the session has used its processor time or disk space, or too many jobs wait.
        """
        with self._lock:
            self._check_limits()
            number = max(self._records, default=0) + 1
            words = list(work.words)
            record = JobRecord(number, work.kind, work.title, work.command, words, work.results, created=time.time())

            def finish(job: Job) -> None:
                try:
                    if ended is not None:
                        ended(job)
                finally:
                    self._finish(job)

            self._records[number] = record
            self._jobs[number] = job = Job(record, work, take, finish, self._note)
            self._forget()
            self._advance()
            self._save()
        self._tell("jobs.state", self.facts())
        return job

    def cancel(self, number: int) -> None:
        """End a job; what it has stored is kept.

        Raises:
            InputError: there is no such job, or it has ended.
        """
        self.record(number)
        job = self._jobs.get(number)
        if job is None:
            raise InputError(f"job {number} has ended")
        job.cancel()

    def remove(self, number: int, results: bool = False) -> None:
        """Remove a job that has ended from the list, and by choice its results.

        Raises:
            InputError: there is no such job, or it is running.
        """
        record = self.record(number)
        if record.active:
            raise InputError(f"job {number} is {record.state}; cancel it first")
        if results and record.results:
            path = self.workspace.writable(record.results)
            shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)
        with self._lock:
            self._records.pop(number, None)
            self._log(number).unlink(missing_ok=True)
            self._save()
        self._tell("jobs.state", self.facts())

    def record(self, number: int) -> JobRecord:
        """Return a job by its number.

        Raises:
            InputError: there is no such job.
        """
        if number not in self._records:
            raise InputError(f"job {number} does not exist")
        return self._records[number]

    def log(self, number: int) -> str:
        """Return the log of a job, the end of it if it is long."""
        self.record(number)
        try:
            return self._log(number).read_text(encoding="utf-8")[-MOST_LOG:]
        except OSError:
            return ""

    def close(self) -> None:
        """End all jobs; they are listed as interrupted later."""
        with self._lock:
            self._closed = True
            self._save()
            jobs = list(self._jobs.values())
        for job in jobs:
            job.cancel()

    def _check_limits(self) -> None:
        waiting = sum(record.state == WAITING for record in self._records.values())
        if waiting >= self.limits.waiting:
            raise InputError(f"{waiting} jobs are waiting, the limit of a session; wait, or cancel one of them")
        if self.cpu >= self.limits.cpu:
            raise InputError(f"{CPU_USED} ({self.limits.cpu:.0f} s); ask the person who runs the server for more")
        self.workspace.check_space()

    def _advance(self) -> None:
        """Start jobs that wait while the limit allows it; the lock is held."""
        for number, record in sorted(self._records.items()):
            running = sum(record.state == RUNNING for record in self._records.values())
            if record.state != WAITING or running >= self.limits.jobs:
                continue
            left = self.limits.cpu - self.cpu
            if left <= 0.0:
                threading.Thread(target=self._jobs[number].stop, args=(CPU_USED,), daemon=True).start()
                continue
            self._jobs[number].start(left, self.limits.memory)

    def _note(self, job: Job, line: str) -> None:
        """Keep a line of the log and tell the windows; called from the thread of the job."""
        now, number = time.monotonic(), job.record.number
        if line:
            with contextlib.suppress(OSError):
                self._folder.mkdir(exist_ok=True)
                with self._log(number).open("a", encoding="utf-8") as file:
                    file.write(line)
        if now - self._checked > CHECK:
            self._checked = now
            self._watch(job)
        if now - self._told.get(number, 0.0) > PAUSE:
            self._told[number] = now
            self._tell("jobs.progress", job.record.values)

    def _watch(self, job: Job) -> None:
        """End a job when the folder of the session is full or its processor time is used."""
        try:
            self.workspace.check_space()
        except InputError as error:
            job.stop(str(error))
        if self.cpu > self.limits.cpu + 2.0:
            job.stop(CPU_USED)

    def _finish(self, job: Job) -> None:
        with self._lock:
            self._jobs.pop(job.record.number, None)
            self._told.pop(job.record.number, None)
            if self._closed:
                return
            self._advance()
            self._save()
        self._tell("jobs.state", self.facts())

    def _forget(self) -> None:
        """Drop the oldest jobs that have ended beyond the longest list."""
        ended = [number for number, item in sorted(self._records.items()) if not item.active]
        for number in ended[: max(0, len(self._records) - MOST_RECORDS)]:
            del self._records[number]
            self._log(number).unlink(missing_ok=True)

    def _log(self, number: int) -> Path:
        return self._folder / f"{number}.log"

    def _save(self) -> None:
        if not self._records and not self._folder.exists():
            return
        with contextlib.suppress(OSError):  # a full disk must not stop the jobs
            self._folder.mkdir(exist_ok=True)
            draft = self._folder / f"{LIST}.part"
            draft.write_text(
                json.dumps([record.values for record in self._records.values()], indent=1), encoding="utf-8"
            )
            draft.replace(self._folder / LIST)

    def _load(self) -> dict[int, JobRecord]:
        try:
            rows = json.loads((self._folder / LIST).read_text(encoding="utf-8"))
            return {item.number: item for item in map(JobRecord.load, rows)}
        except (OSError, ValueError, TypeError):  # none yet, or a damaged list
            return {}
