"""ExperimentDesk: the session of a participant in the browser."""

from __future__ import annotations

import contextlib
import dataclasses
import re
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from crowdbot.core import CrowdbotError, InputError, PacedClock
from crowdbot.experiments import (
    Abort,
    Answered,
    BackgroundRun,
    Choice,
    Event,
    Experiment,
    FreeText,
    Next,
    Number,
    Pause,
    Repeat,
    Resume,
    Scale,
    Session,
    SessionRunner,
    Start,
    StreamOutlets,
    StreamRecorder,
    builtin_experiments,
    is_experiment,
    load_experiment,
    summary,
)
from crowdbot.simulation import Episode, OrderSource, StepRecord
from crowdbot.trials import Trial
from crowdbot.web.app_session import AppSession
from crowdbot.web.command import command
from crowdbot.web.desk import Desk, DeskWindows, Resource
from crowdbot.web.scene import scene_resource
from crowdbot.web.simulator import StageView


@dataclass(frozen=True)
class StreamChoice:
    """What a session exchanges over the Lab Streaming Layer.

    Fields:
        send: whether events, poses of heads and poses of robots are sent.
        record: names of streams, or ``PROPERTY=VALUE`` such as ``type=EEG``, that are recorded.
    """

    send: bool = False
    record: tuple[str, ...] = ()


class SessionStreams:
    """Streams of a session, from its start to its end.

    Args:
        choice: which streams.
        source: name of the sender, that of the experiment.

    Raises:
        MissingExtra: streams are wanted, and the package ``pylsl`` is not installed.
    """

    def __init__(self, choice: StreamChoice, source: str) -> None:
        self.choice = choice
        self.outlets = StreamOutlets(source) if choice.send else None
        """Sink of step records and events, or None."""
        self._recorder: StreamRecorder | None = None

    def record(self, folder: Path) -> None:
        """Begin to record in the folder of a participant.

        Raises:
            InputError: a stream does not exist, or carries texts.
        """
        if self.choice.record:
            self._recorder = StreamRecorder(folder, self.choice.record)

    @property
    def counts(self) -> dict[str, int]:
        """Number of recorded samples by the name of the file."""
        return {} if self._recorder is None else self._recorder.counts

    def stop_recording(self) -> None:
        """Close the recorded files.

        Raises:
            EpisodeError: a file could not be written.
        """
        recorder, self._recorder = self._recorder, None
        if recorder is not None:
            recorder.close()

    def close(self) -> None:
        """End all streams; raises as :meth:`stop_recording` does."""
        with contextlib.ExitStack() as stack:
            if self.outlets is not None:
                stack.callback(self.outlets.close)
            self.outlets = None
            self.stop_recording()


def chosen_streams(send: bool, record: Sequence[str]) -> StreamChoice:
    """Return a choice; empty names are left out."""
    return StreamChoice(bool(send), tuple(item.strip() for item in map(str, record) if item.strip()))


class ExperimentDesk(Desk):
    """The experiments tab: one session of a participant, which the operator and the participant see.

    The session is that of ``crowdbot experiment run``: the same folder, log, answers and episodes. Trials run at a
    chosen rate, so that the participant watches them.
    """

    name: ClassVar[str] = "experiments"
    streams: ClassVar[StreamChoice] = StreamChoice()
    """Streams of the Lab Streaming Layer that the page proposes."""

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self._runner: SessionRunner | None = None
        self._run: BackgroundRun | None = None
        self._clocks = dict[int, PacedClock]()  # of the trials, by the indices of their steps
        self._streams: SessionStreams | None = None
        self._rate = 1.0
        self._view: TrialView | None = None
        self._shown = ""
        self._draft: tuple[int, dict[str, Any]] = (-1, {})
        self._joined = list[Desk]()
        self._lock = threading.RLock()

    def greet(self) -> dict[str, Any]:
        with self._lock:
            return self._state()

    @command
    def sources(self) -> list[dict[str, str]]:
        """Return the built-in experiments and those in the folder of the session."""
        rows = [{"name": name, "about": load_experiment(name).about} for name in builtin_experiments()]
        for file in self.session.workspace.files("*.xml"):
            with contextlib.suppress(CrowdbotError):
                if is_experiment(self.session.workspace.readable(file)):
                    rows.append({"name": file, "about": "file in the folder of the app"})
        return rows

    @command
    def open(
        self,
        experiment: str,
        participant: int,
        resume: bool = False,
        rate: float = 1.0,
        send_streams: bool | None = None,
        record_streams: list[str] | None = None,
    ) -> dict[str, Any]:
        """Begin or continue the session of a participant; trials run at ``rate`` times real time.

        ``send_streams`` sends events and poses over the Lab Streaming Layer, and ``record_streams`` names the streams
        of other programs that are recorded; None takes those of the command line.
        """
        if not 0.1 <= rate <= 100.0:
            raise InputError(f"rate = {rate:g}: expected 0.1 to 100")
        with self._lock:
            if self._runner is not None and not self._runner.session.over:
                raise InputError(f"participant {self._runner.participant} has not finished; close that session first")
            self._close()
            builtin = experiment in builtin_experiments()
            found = load_experiment(experiment if builtin else self.session.workspace.readable(experiment))
            out = self.session.workspace.folder / "experiments" / re.sub(r"\W+", "-", found.name)
            choice = chosen_streams(
                self.streams.send if send_streams is None else send_streams,
                self.streams.record if record_streams is None else record_streams,
            )
            self._begin_session(found, participant, out, resume, choice)
            self._rate = rate
            return self._do(Start()) if self._opened().session.phase == "ready" else self._moved()

    @command
    def answer(self, answers: dict) -> dict[str, Any]:  # type: ignore[type-arg]
        """Answer questions of the screen: values by the names of the questions."""
        with self._lock:
            runner = self._opened()
            for name, value in answers.items():
                runner.do(Answered(str(name), value))
                if runner.session.over:  # an answer that ends the session, such as no consent
                    return self._moved()
            return self._tell()

    @command
    def next(self) -> dict[str, Any]:
        """Go on to the next screen or trial."""
        return self._do(Next())

    @command
    def draft(self, index: int, answers: dict) -> None:  # type: ignore[type-arg]
        """Show choices that are not final in all windows; ``index`` is the step to which they belong.

        Nothing is logged before :meth:`finish_screen` or :meth:`answer`.
        """
        with self._lock:
            screen = self._screen(index).step.screen
            known = [question.name for question in screen.questions] if screen else []
            self._draft = (index, {str(name): value for name, value in answers.items() if name in known})
            self._tell()

    @command
    def finish_screen(self, index: int, answers: dict) -> dict[str, Any]:  # type: ignore[type-arg]
        """Answer the questions of the screen of a step and go on; a step that is over is refused."""
        with self._lock:
            self._screen(index)
            state = self.answer(answers)
            return state if self._opened().session.over else self.next()

    @command
    def pause(self, reason: str = "operator") -> dict[str, Any]:
        """Pause the session, also inside a trial."""
        with self._lock:
            if self._run is not None:
                self._run.hold()
            return self._do(Pause(reason))

    @command
    def resume(self) -> dict[str, Any]:
        """Continue after a pause."""
        with self._lock:
            state = self._do(Resume())
            if self._run is not None:
                self._run.go()
            return state

    @command
    def repeat(self) -> dict[str, Any]:
        """Repeat the trial from its start; the answers after it are asked again."""
        with self._lock:
            self._give_up()
            return self._do(Repeat())

    @command
    def abort(self, reason: str) -> dict[str, Any]:
        """End the session permanently."""
        with self._lock:
            self._give_up()
            return self._do(Abort(reason))

    @command
    def leave(self) -> dict[str, Any]:
        """Close the session; it can be continued later."""
        with self._lock:
            self._close()
            return self._tell()

    @command
    def description(self) -> dict[str, Any]:
        """Return what stands still in the trial that runs."""
        return {} if self._view is None else self._view.description

    @command
    def show_frame(self) -> None:
        """Show the next step of the trial in all windows."""
        if self._view is not None:
            self._view.refresh()

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        if self._view is None:
            raise KeyError(path)
        return self._view.resource(path, query)

    @command
    def answers(self) -> list[dict[str, Any]]:
        """Return the answers of all participants of the experiment, as ``crowdbot experiment summary`` has them."""
        with self._lock:
            return summary(self._opened().folder.parent)

    @property
    def session_open(self) -> bool:
        """Whether a session of a participant is open and not over."""
        return self._runner is not None and not self._runner.session.over

    @property
    def paused(self) -> bool:
        """Whether the session that is open waits in a pause."""
        return self._runner is not None and self._runner.session.phase == "pause"

    @property
    def trials(self) -> tuple[Trial, ...]:
        """The trials of the session that is open."""
        runner = self._runner
        return () if runner is None else tuple(runner.trials.values())

    def close(self) -> None:
        with self._lock:
            self._close()

    def _begin_session(
        self, found: Experiment, participant: int, out: Path, resume: bool, choice: StreamChoice
    ) -> None:
        """Open the streams and the log; streams that are missing leave no session open."""
        streams = SessionStreams(choice, found.name)
        try:
            runner = SessionRunner(found, participant, out, time.time, resume=resume, outlets=streams.outlets)
        except BaseException:
            streams.close()
            raise
        try:
            streams.record(runner.folder)
        except BaseException:
            runner.close()
            streams.close()
            raise
        self._runner, self._streams = runner, streams
        self._clocks.clear()

    def _close(self) -> None:
        self._give_up()
        runner, streams, self._runner, self._streams = self._runner, self._streams, None, None
        if runner is not None:
            runner.close()
        if streams is not None:
            streams.close()

    def _opened(self) -> SessionRunner:
        if self._runner is None:
            raise InputError("no session is open; choose an experiment and a participant")
        return self._runner

    def _do(self, event: Event) -> dict[str, Any]:
        with self._lock:
            self._opened().do(event)
            return self._moved()

    def _screen(self, index: int) -> Session:
        """Return the session if it is at the screen of a step."""
        session = self._opened().session
        if session.phase != "screen" or session.index != index:
            raise InputError(f"the session is not at the screen of step {index} any more")
        return session

    def _moved(self) -> dict[str, Any]:
        """Begin the trial or log the screen that the session has come to."""
        runner = self._opened()
        if runner.session.phase not in ("screen", "pause"):
            self._draft = (-1, {})
        if runner.session.phase == "trial":
            self._begin(runner)
        elif runner.session.phase == "screen" and runner.page is not None and runner.page.text != self._shown:
            self._shown = runner.page.text
            if self._shown:
                runner.log_screen(self._shown)
        if runner.session.over and self._streams is not None:
            self._streams.stop_recording()
        return self._tell()

    def _begin(self, runner: SessionRunner) -> None:
        trial, seed, folder = runner.begin()
        self._shown, self._view = "", TrialView(self.session)
        try:
            trial, sources = self._join(trial, folder)
        except InputError as error:
            runner.end(_failure(error), folder)
            return
        clock = PacedClock(trial.step, rate=1.0 if sources else self._rate)  # people move in real time
        self._clocks[runner.session.index] = clock
        watchers = [self._view, *runner.sinks]
        self._run = self._view.run = BackgroundRun(trial, seed, folder / "episode.mcap", clock, watchers, sources)
        threading.Thread(target=self._watch, args=(self._run, clock, folder), daemon=True).start()

    def _join(self, trial: Trial, folder: Path) -> tuple[Trial, list[OrderSource]]:
        """Let the other desks of the session take part in a trial."""
        sources: list[OrderSource] = []
        self._joined = list(self.session.desks.values()) if isinstance(self.session, AppSession) else []
        for desk in self._joined:
            trial, own = desk.join_trial(trial, folder)
            sources += own
        return trial, sources

    def _leave_trial(self) -> None:
        joined, self._joined = self._joined, []
        for desk in joined:
            desk.leave_trial()

    def _watch(self, run: BackgroundRun, clock: PacedClock, folder: Path) -> None:
        """Tell the progress of a trial and that it is late, and end it in the session."""
        told = False
        while not run.wait(0.5):
            self.session.tell("experiments.progress", run.share)
            if clock.late and not told:
                told = True
                with self._lock:
                    self._tell()
        with self._lock:
            if self._run is run and self._runner is not None:
                if self._runner.session.phase == "pause":
                    self._runner.do(Resume())
                self._run = None
                self._leave_trial()
                self._runner.end(run.result, folder)
                self._moved()

    def _give_up(self) -> None:
        run, self._run = self._run, None
        if run is not None:
            run.give_up()
            run.wait(30.0)
        self._leave_trial()

    def _tell(self) -> dict[str, Any]:
        state = self._state()
        self.session.tell("experiments.state", state)
        return state

    def _state(self) -> dict[str, Any]:
        runner = self._runner
        if runner is None:
            return {"open": False, "streams": {"send": self.streams.send, "record": list(self.streams.record)}}
        now = runner.session
        page = runner.page if now.phase == "screen" else None
        screen = now.step.screen if page else None
        return {
            "open": True,
            "experiment": runner.experiment.name,
            "participant": runner.participant,
            "folder": runner.folder.relative_to(self.session.workspace.folder).as_posix(),
            "phase": now.phase,
            "waiting": now.waiting,
            "reason": now.reason,
            "index": now.index,
            "steps": [{"name": step.name, "role": step.role, "number": step.number} for step in now.steps],
            "possible": list(now.possible_events),
            "html": page.html if page else "",
            "text": page.text if page else "",
            "questions": [question_form(question) for question in screen.questions] if screen else [],  # type: ignore[arg-type]
            "answers": {**now.answers.get(now.index, {}), **(self._draft[1] if self._draft[0] == now.index else {})},
            "outcomes": {str(index): result.outcome for index, result in now.results.items()},
            "late": {str(index): text for index, one in self._clocks.items() if (text := one.late_remark("speed"))},
            "rate": self._rate,
            "streams": {} if self._streams is None else dataclasses.asdict(self._streams.choice),
        }


def _failure(error: InputError) -> Callable[[], Episode]:
    """Return a result of a trial that could not begin."""

    def result() -> Episode:
        raise error

    return result


class TrialView:
    """A sink of step records that shows the simulation to the windows of a session, on the channel ``trial``.

    Frames and description are made in the thread of the run.

    Args:
        session: the windows.

    Attributes:
        run: the run that is shown; set after its start.
        description: what stands still; empty before the first step.
    """

    def __init__(self, session: DeskWindows) -> None:
        self._view = StageView(session, channel="trial")
        self._always = True
        self._shown: Any = None
        self.run: BackgroundRun | None = None
        self.description: dict[str, Any] = {}

    def take(self, frame: StepRecord) -> None:
        """Show a step."""
        simulation = self.run.simulation if self.run is not None else None
        if simulation is None:
            return
        if simulation is not self._shown:
            self._shown = simulation
            self._view.open(simulation)
        if not self.description or self._always:
            self.description = self._view.description()
        self._view.show(self._always)
        self._always = False

    def refresh(self) -> None:
        """Show the next step and describe it anew, for a window that has just been opened."""
        self._always = True

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        """Return meshes of bodies and robots.

        Raises:
            KeyError: there is no such file, or nothing is shown.
        """
        if self._shown is None:
            raise KeyError(path)
        return scene_resource(self._shown, path, query)


def question_form(question: Choice | Scale | Number | FreeText) -> dict[str, Any]:
    """Return a question as JSON: name, text, required, hint, kind and what the kind needs.

    >>> question_form(Scale(name="comfort", text="How comfortable?", low=1, high=5))["steps"]
    [1, 2, 3, 4, 5]
    """
    row: dict[str, Any] = {"name": question.name, "text": question.text, "required": question.required}
    row["hint"] = question.hint
    match question:
        case Choice():
            row |= {"kind": "choice", "multiple": question.multiple}
            row["options"] = [{"value": option.value, "text": option.label} for option in question.options]
        case Scale():
            row |= {"kind": "scale", "steps": list(range(question.low, question.high + 1))}
            row |= {"low": question.low_text, "high": question.high_text}
        case Number():
            row |= {"kind": "number", "unit": question.unit, "min": question.min, "max": question.max}
            row["step"] = 1 if question.integer else None
        case FreeText():
            row |= {"kind": "text", "most": question.max_length}
    return row
