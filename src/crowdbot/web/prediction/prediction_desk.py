"""PredictionDesk: the prediction tab: recordings, predictors, runs and their results."""

from __future__ import annotations

import contextlib
import io
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

from crowdbot.core import InputError
from crowdbot.web.command import command
from crowdbot.web.desk import Desk, DeskWindows, Resource
from crowdbot.web.draft_file import DraftFile
from crowdbot.web.jobs.job import Job, JobWork
from crowdbot.web.jobs.job_board import JobBoard
from crowdbot.web.recording_rows import recording_rows
from crowdbot.web.workspace import shown_path

from .background_picture import BackgroundPicture, parse_homography
from .example_recordings import EXAMPLES, copy_example
from .form_rows import scheme_tables
from .prediction_board import CLEAN, DEGRADED, BoardMember, PredictionBoard
from .prediction_results import PredictorResults
from .prediction_setup import DegradationChoice, PredictionSetup
from .prediction_worker import PredictionTask, run_calibration, run_task
from .result_tables import frame_table, horizon_rows, person_table, score_table, variable_names, variable_rows
from .scene_frame import window_frame
from .stored_results import StoredResults

ANIMATIONS = {"animation.gif": "image/gif", "animation.mp4": "video/mp4", "animation.webp": "image/webp"}
TABLES = ("frames.csv", "frames.parquet", "people.csv", "people.parquet")
RECENT = 30


class PredictionDesk(Desk):
    """The prediction tab of one session.

    Args:
        session: the windows and the folder of the session.
    """

    name: ClassVar[str] = "prediction"
    first: ClassVar[str | None] = None
    """Recording that a new session opens."""

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self.board = PredictionBoard()
        self._run: PredictionRun | None = None
        self._queue: list[Any] = []
        self._share = 0.0
        self._tables: dict[str, Any] | None = None
        self._draft = DraftFile(session.workspace.folder, self.name)
        self._stored = self._draft.load()
        if self.first is not None and self._stored.get("file") != self.first:
            self._stored = {"file": self.first, "options": {}, "predictors": []}
        self._results = StoredResults(session.workspace)

    def greet(self) -> dict[str, Any]:
        return {**self.board.facts(), "run": self._run_facts(), "stored": bool(self._stored)}

    @command
    def restore(self) -> dict[str, Any]:
        """Open the recording and add the predictors that were there when the server ended, with their results."""
        found, self._stored = self._stored, {}
        if self.board.setup is None and not self.board.members:
            chosen = found.get("file") == self.first  # with --open; its errors are shown
            lenient = () if chosen else (InputError, TypeError, KeyError, OSError)  # the recording may be gone
            with contextlib.suppress(*lenient):
                for settings in found["predictors"]:
                    self.board.add({name: value for name, value in settings.items() if value is not None})
                space = self.session.workspace
                self.board.open(space.readable(found["file"]), found["options"], found["file"], space.readable)
                self.board.resume(int(found.get("seed", 0)), bool(found.get("live")), found.get("degradation"))
                self._results.load(self.board)
        return self._changed()

    @command
    def tables(self) -> dict[str, Any]:
        """Return all lists of the dialogs."""
        if self._tables is None:
            self._tables = scheme_tables()
        return self._tables

    @command
    def files(self) -> dict[str, Any]:
        """Return the files of the session, newest first, and the examples."""
        space = self.session.workspace
        names = [file for file in space.files() if not file.startswith(("sessions/", "examples/"))]
        facts = [(space.folder / name).stat() for name in names]
        newest = sorted(zip(names, facts, strict=True), key=lambda pair: -pair[1].st_mtime)
        rows = [{"name": name, "bytes": item.st_size, "changed": item.st_mtime} for name, item in newest]
        return {"files": rows[:RECENT], "examples": [{"name": n, "about": a} for n, a in EXAMPLES.items()]}

    @command
    def file_options(self) -> list[dict[str, Any]]:
        """Return the fields of the options of a file; a homography is a file of the session."""
        return recording_rows(self.session.workspace)

    @command
    def weights(self) -> list[str]:
        """Return the weights that were trained in the folder of the session."""
        return self.session.workspace.files("trainings/*/best.npz")

    @command
    def open(self, file: str, options: dict | None = None) -> dict[str, Any]:  # type: ignore[type-arg]
        """Open a recording of the folder of the session."""
        self._must_rest()
        path = self.session.workspace.readable(file)
        try:
            self.board.open(path, options or {}, file, self.session.workspace.readable)
        except InputError as error:
            raise InputError(str(error).replace(str(path), file)) from None
        return self._changed()

    @command
    def example(self, name: str) -> dict[str, Any]:
        """Copy a recording that ships into the folder of the session and open it."""
        self._must_rest()
        file = copy_example(self.session.workspace, name)
        self.board.open(self.session.workspace.readable(file), {}, file)
        return self._changed()

    @command
    def background(self, file: str, homography: str = "") -> dict[str, Any]:
        """Put a picture behind the scene; without a homography, that of the recording, else pixels are coordinates."""
        path = self.session.workspace.readable(file)
        tracks = self.board.recording.tracks
        matrix = parse_homography(homography) if homography.strip() else tracks.homography
        if matrix is None and tracks.units == "m":
            raise InputError("give nine numbers of a homography, or metres per pixel: the recording is in metres")
        self.board.background = BackgroundPicture(path, matrix)
        return self._changed()

    @command
    def add(self, settings: dict) -> str:  # type: ignore[type-arg]
        """Add a predictor and return its key."""
        self._must_rest()
        if settings.get("weights"):
            settings = {**settings, "weights": shown_path(self.session.workspace.readable(str(settings["weights"])))}
        key = self.board.add(settings).key
        self._changed()
        return key

    @command
    def remove(self, key: str) -> None:
        """Remove a predictor and its results."""
        self._must_rest()
        self.board.members.remove(self.board.member(key))
        self._changed()

    @command
    def degrade(self, name: str, values: dict) -> dict[str, Any]:  # type: ignore[type-arg]
        """Degrade the observed rows; an empty name ends it."""
        self._must_rest()
        self.board.degrade(DegradationChoice.of(name, values) if name else None)
        return self._changed()

    @command
    def run(self, seed: int = 0, live: bool = False) -> None:
        """Run all predictors in a worker process, on the recording and on its degraded rows."""
        self._must_rest()
        self._queue = self.board.prepare(seed, live)
        self._changed()
        self._start()

    @command
    def calibrate(self, key: str) -> None:
        """Calibrate the crowd of a predictor on all windows, as `crowdbot calibrate`."""
        self._must_rest()
        self._share = 0.0
        member = self.board.member(key)
        task, title = self.board.task([member]), f"{self.board.recording.name}: {member.label}"
        line = self.calibrate_line(key)
        self._run = PredictionRun(self.session.jobs, task, {}, self._note, title, line, calibrates=True)
        self.session.tell("prediction.progress", {"share": 0.0, "active": True})

    @command
    def cancel(self) -> None:
        """End the run; results so far are kept."""
        self._queue = []
        if self._run is not None and self._run.alive:
            self._run.cancel()

    @command
    def log(self) -> list[Any]:
        """Return the lines of the log of all predictors."""
        pairs = [(m, name, result) for m in self.board.members for name, result in m.results.items()]
        return [{"key": m.key, "input": name, "lines": item.log()} for m, name, item in pairs]

    @command
    def variables(self) -> list[Any]:
        """Return the variables that can be plotted."""
        return variable_names(self.board)

    @command
    def series(self, variable: str, person: int | None = None) -> dict[str, Any]:
        """Return a variable by frame, for everybody or one person."""
        return variable_rows(self.board, variable, person)

    @command
    def results(self) -> dict[str, Any]:
        """Return the table of metrics and the error by horizon."""
        return {"table": score_table(self.board), "horizon": horizon_rows(self.board)}

    @command
    def person(self, index: int, id: int) -> dict[str, Any]:
        """Return what is known of a person in a window."""
        past, future = self.board.windows()
        slots = (past.id[self.board.index(index)] == id).nonzero()[0]
        if not len(slots):
            raise InputError(f"person {id} is not in this frame")
        slot, dt = slots[0], self.board.tracks.dt
        place = past.position[index, :, slot][past.present[index, :, slot]]
        speed = float(((place[-1] - place[-2]) ** 2).sum() ** 0.5 / dt) if len(place) > 1 else None
        found = [
            {"key": m.key, "slot": m.slot, "label": m.label, "input": name, **result.person(index, id)}
            for m in self.board.members
            for name, result in m.results.items()
        ]
        own = {"id": id, "robot": bool(past.robot[index, slot]), "scored": bool(future.scored[index, slot])}
        return {**own, "place": place[-1].tolist(), "speed": speed, "rows": len(place), "results": found}

    @command
    def command_line(self, degraded: bool = False) -> str:
        """Return the commands that give the numbers on the screen, one for each predictor."""
        choice = self.board.degradation if degraded else None
        return "\n".join(self._setup.command(member.choice, choice) for member in self._members())

    @command
    def python(self, degraded: bool = False) -> str:
        """Return a Python program that gives the numbers on the screen."""
        choice = self.board.degradation if degraded else None
        return self._setup.python([member.choice for member in self._members()], choice)

    @command
    def calibrate_line(self, key: str) -> str:
        """Return the command that calibrates the crowd of a predictor."""
        return self._setup.calibrate_command(self.board.member(key).choice)

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        if path == "window":
            return Resource(self._window(query).encode())
        if path == "background.png" and self.board.background is not None:
            return Resource(self.board.background.data, "image/png")
        if path in TABLES:
            table = frame_table(self.board) if path.startswith("frames") else person_table(self.board)
            if path.endswith(".csv"):
                return Resource(table.to_csv(index=False).encode(), "text/csv", path)
            buffer = io.BytesIO()
            table.to_parquet(buffer, index=False)
            return Resource(buffer.getvalue(), name=path)
        if path in ANIMATIONS:
            return self._animation(path, query)
        raise KeyError(path)

    def close(self) -> None:
        self.cancel()

    def _window(self, query: dict[str, str]) -> Any:
        index = self.board.index(_whole(query, "index"))
        name = DEGRADED if query.get("input") == DEGRADED and self.board.degradation is not None else CLEAN
        hidden = set(query.get("hide", "").split(","))
        shown = [(m.slot, m.results[name]) for m in self.board.members if name in m.results and m.key not in hidden]
        near = self.board.windows(DEGRADED)[0] if name == DEGRADED else None
        return window_frame(index, self.board.windows(), 1.0 / self.board.tracks.fps, shown, near)

    def _animation(self, path: str, query: dict[str, str]) -> Resource:
        from crowdbot.evaluation import PredictorEvaluation, animate_window

        setup, members = self._setup, self._members()
        frame = int(self.board.windows()[0].frame[self.board.index(_whole(query, "index")), -1])
        samples = max(member.choice.samples for member in members)
        evaluation = PredictorEvaluation(
            (setup.recording,), tuple(member.spec for member in members), samples, setup.best_of, setup.seed
        )
        with tempfile.TemporaryDirectory() as folder:
            data = animate_window(evaluation, frame, Path(folder) / path).read_bytes()
        return Resource(data, ANIMATIONS[path], f"frame-{frame}{Path(path).suffix}")

    @property
    def _setup(self) -> PredictionSetup:
        _ = self.board.recording
        assert self.board.setup is not None
        return self.board.setup

    def _members(self) -> list[BoardMember]:
        if not self.board.members:
            raise InputError("there is no predictor; add one first")
        return self.board.members

    def _must_rest(self) -> None:
        if self._run is not None and self._run.alive:
            raise InputError("a run is going on; cancel it or wait for its end")

    def _start(self) -> None:
        task, results = self._queue.pop(0)
        self._share = 0.0
        names = ", ".join(member.label for member in self.board.members)
        degraded = f" after {task.degradation}" if task.degradation is not None else ""
        title = f"{self.board.recording.name}{degraded}: {names}"
        self._run = PredictionRun(self.session.jobs, task, results, self._note, title)
        self.session.tell("prediction.progress", {"share": 0.0, "active": True})

    def _note(self, event: str, data: Any) -> None:
        """Pass an event of the run on to the windows; called from the thread of the run."""
        if event == "fit":
            self.board.member(data["key"]).fit = data["fit"]
            self._changed()
        elif event == "ended":
            if self._queue and not data["problem"] and not data["cancelled"]:
                try:
                    self._start()
                    return
                except InputError as error:  # a limit of the session
                    data = {**data, "problem": str(error)}
            self._share = 1.0
            self._results.save(self.board)
            self.session.tell("prediction.board", {**self.board.facts(), "run": self._run_facts(ended=True)})
            self.session.tell("prediction.ended", data)
        else:
            if event == "progress":
                self._share = data["share"]
                data = {**data, "active": True}
            self.session.tell(f"prediction.{event}", data)

    def _changed(self) -> dict[str, Any]:
        facts = {**self.board.facts(), "run": self._run_facts()}
        if (recording := facts["recording"]) is not None:
            own = {"file": recording["path"], "options": recording["options"]}
            own |= {"seed": recording["seed"], "live": recording["live"], "degradation": facts["degradation"]}
            self._draft.save({**own, "predictors": [member.choice.settings for member in self.board.members]})
        self.session.tell("prediction.board", facts)
        return facts

    def _run_facts(self, ended: bool = False) -> dict[str, Any]:
        active = self._run is not None and self._run.alive and not ended
        return {"active": active, "share": self._share}


def _whole(query: dict[str, str], name: str) -> int:
    try:
        return int(query.get(name, ""))
    except ValueError:
        raise InputError(f"{name} = {query.get(name, '')!r:.40} is not a whole number") from None


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
