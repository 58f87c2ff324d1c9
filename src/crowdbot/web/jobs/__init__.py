"""Jobs: long work in worker processes, with progress, a log, cancel, limits and a list that survives the server."""

from .command_job import command_work
from .job import Job, JobWork
from .job_board import JobBoard
from .job_record import JobRecord

__all__ = ["Job", "JobBoard", "JobRecord", "JobWork", "command_work"]
