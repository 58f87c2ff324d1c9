"""Jobs: long work in worker processes, with progress, a log, cancel, limits and a list that survives the server."""

from .job import Job, JobWork, command_work
from .job_board import JobBoard
from .job_record import JobRecord

__all__ = ["Job", "JobBoard", "JobRecord", "JobWork", "command_work"]
