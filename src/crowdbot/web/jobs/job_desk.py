"""JobDesk: the jobs tab: starts long work, lists it, and gives its results."""

from __future__ import annotations

import io
import mimetypes
import zipfile
from pathlib import Path
from typing import Any, ClassVar

from crowdbot.core import InputError, did_you_mean
from crowdbot.prediction import LAST
from crowdbot.web.command import command
from crowdbot.web.desk import Desk, Resource

from .job import JobWork, command_work
from .job_forms import FORMS, read_values, results_name

MOST_FILES = 200
MOST_ZIP = 200e6
"""Largest results that are packed into one file [B]."""


class JobDesk(Desk):
    """The jobs tab of one session.

    A job that starts here is a command of the command line, run in the folder of the session. Runs of the other tabs
    that take long are in the same list.
    """

    name: ClassVar[str] = "jobs"

    def greet(self) -> dict[str, Any]:
        return self.session.jobs.facts()

    @command
    def forms(self) -> list[dict[str, Any]]:
        """Return the kinds of jobs with their forms."""
        space = self.session.workspace
        return [
            {"kind": kind, "title": item.title, "about": item.about, "rows": item.rows(space)}
            for kind, item in FORMS.items()
        ]

    @command
    def words(self, kind: str, values: dict) -> str:  # type: ignore[type-arg]
        """Return the command line of a job."""
        return self._work(kind, values).command

    @command
    def begin(self, kind: str, values: dict) -> int:  # type: ignore[type-arg]
        """Start a job and return its number."""
        return self.session.jobs.submit(self._work(kind, values)).record.number

    @command
    def again(self, number: int) -> int:
        """Run the command of a job that has ended again; commands continue from what is stored."""
        record = self.session.jobs.record(number)
        if record.active:
            raise InputError(f"job {number} is {record.state}")
        if not record.words:
            raise InputError(f"job {number} cannot be run again from here; run it in its tab")
        words = tuple(record.words)
        space = self.session.workspace
        if words[0] == "train" and "--resume" not in words and (space.folder / record.results / LAST).is_file():
            words = (*words, "--resume")
        work = command_work(record.kind, record.title, words, space.folder, record.results)
        return self.session.jobs.submit(work).record.number

    @command
    def cancel(self, number: int) -> None:
        """End a job; what it has stored is kept."""
        self.session.jobs.cancel(number)

    @command
    def remove(self, number: int, results: bool = False) -> None:
        """Remove a job from the list, by choice with its results."""
        self.session.jobs.remove(number, results)

    @command
    def log(self, number: int) -> str:
        """Return the log of a job."""
        return self.session.jobs.log(number)

    @command
    def files(self, number: int) -> list[dict[str, Any]]:
        """Return the files of the results of a job."""
        folder = self._results(number)
        found = [item for item in sorted(folder.rglob("*")) if item.is_file() and "parts" not in item.parts][
            :MOST_FILES
        ]
        return [{"name": one.relative_to(folder).as_posix(), "bytes": one.stat().st_size} for one in found]

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        # NUMBER/all.zip, or a file of the results of a job, NUMBER/files/PATH
        number, _, rest = path.partition("/")
        if not number.isdecimal() or len(number) > 9:
            raise KeyError(path)
        folder = self._results(int(number))
        if rest == "all.zip":
            return Resource(_packed(folder), "application/zip", f"{folder.name}.zip")
        file = (folder / rest.removeprefix("files/")).resolve()
        if not rest.startswith("files/") or not file.is_relative_to(folder) or not file.is_file():
            raise KeyError(path)
        page = file.suffix == ".html"
        kind = mimetypes.guess_type(file.name)[0] or "application/octet-stream"
        return Resource(file.read_bytes(), kind, None if page else file.name, sandbox=page)

    def _work(self, kind: str, values: dict[str, Any]) -> JobWork:
        if kind not in FORMS:
            raise InputError(f"kind of job {kind!r:.40} does not exist{did_you_mean(kind, FORMS)}")
        form, space = FORMS[kind], self.session.workspace
        found = read_values(form, space, values)
        name = results_name(found["name"])
        results = f"{form.folder}/{name}" if form.folder else ""
        out = ("--out", results) if results else ()
        return command_work(form.title, name, (*form.words(space, found), *out), space.folder, results)

    def _results(self, number: int) -> Path:
        record = self.session.jobs.record(number)
        folder = (self.session.workspace.folder / record.results).resolve()
        if not record.results or not folder.is_dir():
            raise InputError(f"job {number} has no results yet")
        return folder


def _packed(folder: Path) -> bytes:
    files = [item for item in sorted(folder.rglob("*")) if item.is_file()]
    if sum(file.stat().st_size for file in files) > MOST_ZIP:
        raise InputError(f"the results are larger than {MOST_ZIP / 1e6:.0f} MB; take the files one by one")
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            archive.write(file, file.relative_to(folder))
    return buffer.getvalue()
