"""JobRecord: what is known of a job, also after the server has ended."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

WAITING, RUNNING, DONE, FAILED, CANCELLED, INTERRUPTED = (
    "waiting", "running", "done", "failed", "cancelled", "interrupted",
)  # fmt: skip


@dataclass
class JobRecord:
    """A job of a session as it is listed and stored.

    Fields:
        number: its number in the session, from 1.
        kind: what kind of work it is, in words of the page, such as ``Search for failures``.
        title: short description.
        command: command line that does the same, or empty.
        words: arguments of the command if the job can be run again, or empty.
        results: folder or file of the results, relative to the folder of the session, or empty.
        state: ``waiting``, ``running``, ``done``, ``failed``, ``cancelled`` or ``interrupted``.
        share: completed share, 0 to 1.
        note: newest line of the log.
        problem: why it failed or was stopped, a sentence.
        created: time of its submission, seconds since 1970.
        seconds, cpu: duration and processor time [s].

    >>> JobRecord(1, "Generate data", "first").active
    True
    """

    number: int
    kind: str
    title: str
    command: str = ""
    words: list[str] = field(default_factory=list)
    results: str = ""
    state: str = WAITING
    share: float = 0.0
    note: str = ""
    problem: str = ""
    created: float = 0.0
    seconds: float = 0.0
    cpu: float = 0.0

    @property
    def active(self) -> bool:
        """Whether the job waits or runs."""
        return self.state in (WAITING, RUNNING)

    @property
    def values(self) -> dict[str, Any]:
        """The record as JSON."""
        return dataclasses.asdict(self)

    @classmethod
    def load(cls, values: Mapping[str, Any]) -> JobRecord:
        """Return a stored record; a job that was active then has been interrupted.

        Raises:
            TypeError: the values are not those of a record.
        """
        hints = {item.name: str(item.type) for item in dataclasses.fields(cls)}
        kinds = {"int": int, "str": str, "float": int | float, "list[str]": list}
        if set(values) != set(hints) or not all(isinstance(values[name], kinds[hints[name]]) for name in hints):
            raise TypeError("not a record of a job")
        job_record = cls(**values)
        if job_record.active:
            job_record.state, job_record.problem = INTERRUPTED, "the server ended while the job was running"
        return job_record
