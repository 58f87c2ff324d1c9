"""SessionRunner: a session with its folder, log and clock, driven by a front end."""

from __future__ import annotations

import hashlib
import json
import os
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from crowdbot.core import CrowdbotError, EpisodeError, InputError
from crowdbot.recording import as_json, versions
from crowdbot.simulation import Episode, Sink
from crowdbot.trials import Trial, trial_xml

from .experiment import Experiment, Screen
from .log import Answered, Begin, Event, Fail, Finish, Repeat, Resume, SessionLog, event_of, record_of
from .page import Page, page_of
from .parser import check_experiment, experiment_xml, trial_of
from .session import Session
from .session_folder import ANSWERS, COPY, LOG, folder_of, withdrawn
from .session_plan import seed_of
from .streams import StreamOutlets, TrialClockLog

Clock = Callable[[], float]


class SessionRunner:
    """Runs the session of one participant.

    Each event is written to disk before it takes effect; a crash loses only the running trial. The folder of the
    participant contains the log, a copy of the experiment, the answers, and a folder for each trial.

    Args:
        experiment: the experiment.
        participant: number, from 1.
        out: folder of all participants.
        clock: returns the time [s] of each record.
        resume: continue an existing session.
        trust: whether trials outside the folder, and their code, may be loaded.
        outlets: sends the events and trials of the session to other programs; the caller closes it.
        monotonic: monotonic clock of the computer [s], logged beside ``clock`` at the start and at each trial.

    Raises:
        InputError: there is no such participant.
        EpisodeError: a session already exists, there is none to resume, or the experiment has changed since its start.
        TrialError: the experiment has errors; the exception lists all of them.
    """

    def __init__(
        self,
        experiment: Experiment,
        participant: int,
        out: Path,
        clock: Clock,
        *,
        resume: bool = False,
        trust: bool = False,
        outlets: StreamOutlets | None = None,
        monotonic: Clock = time.monotonic,
    ) -> None:
        check_experiment(experiment, trust=trust)
        self.experiment, self.participant, self.clock = experiment, participant, clock
        self._outlets, self._monotonic = outlets, monotonic
        self._clocks: TrialClockLog | None = None
        self.session = Session.of(experiment, participant)
        self.folder = folder_of(out, participant)
        entries = {step.entry.source: step.entry for step in self.session.steps if step.entry}
        self.trials: dict[str, Trial] = {s: trial_of(e.source, experiment.folder, trust) for s, e in entries.items()}
        self.pages: dict[Screen, Page] = {
            step.screen: page_of(step.screen, experiment.folder) for step in self.session.steps if step.screen
        }
        self._times: dict[tuple[int, str], float] = {}
        head = {
            "experiment": experiment.name,
            "participant": participant,
            "digest": self._digest(),
            **self._clock_values(),
            **versions(),
        }
        self.log: SessionLog
        if resume:
            self._resumed(head)
        else:
            self._begun(head)

    @property
    def sinks(self) -> tuple[Sink, ...]:
        """Consumers of the step records of the trial that has begun: its clocks, and the streams to other programs."""
        found = (self._clocks, self._outlets)
        return tuple(one for one in found if one is not None)

    def do(self, event: Event) -> Session:
        """Apply an event, log it and return the new session.

        Raises:
            InputError: the event is not possible now; nothing is logged.
        """
        after, at, index = self.session.after(event), self.clock(), self.session.index
        if isinstance(event, Answered):
            event = Answered(event.question, after.answers[index][event.question])
        self.log.append({"at": at, **record_of(event)})
        self.session = after
        if self._outlets is not None:
            self._outlets.tell(record_of(event))
        if isinstance(event, Answered):
            self._times[index, event.question] = at
            self._write_answers(self.session.steps[index].number)
        return after

    def log_screen(self, text: str) -> None:
        """Log the text of a screen as the participant saw it."""
        step = self.session.step
        source = self.pages[step.screen].digest if step.screen else ""
        self.log.append({"at": self.clock(), "shown": step.name, "role": step.role, "source": source, "text": text})

    @property
    def page(self) -> Page | None:
        """Content of the current screen; None at a trial."""
        screen = self.session.step.screen
        return self.pages[screen] if screen else None

    def begin(self) -> tuple[Trial, int, Path]:
        """Begin the trial; return it, its seed and the folder of its episode."""
        step, index = self.session.step, self.session.index
        if step.entry is None:
            raise InputError(f"{step.role} {step.name!r} is a screen, not a trial")
        trial = self.trials[step.entry.source]
        base = trial.seed if step.entry.seed is None else step.entry.seed
        seed = seed_of(base, step.seeds, self.participant, step.repetition)
        attempt = self.session.attempts.get(index, 0) + 1
        name = f"{step.number:03d}-{step.name}" + (f"-attempt-{attempt}" if attempt > 1 else "")
        self.do(Begin(seed, name))
        folder = self.folder / name
        try:
            folder.mkdir(exist_ok=True)
        except OSError as error:
            raise EpisodeError(f"cannot create {folder}: {error.strerror}") from None
        self._write_answers(step.number)
        self._close_clocks()
        self._clocks = TrialClockLog(folder, self._monotonic)
        self.log.append(self._clock_values())
        if self._outlets is not None:
            self._outlets.begin(trial)
        return trial, seed, folder

    def finish(self, episode: Episode) -> None:
        """End the trial with its episode."""
        self.do(Finish(episode.outcome, episode.digest, json.loads(as_json(episode.metrics))))

    def end(self, result: Callable[[], Episode], folder: Path) -> None:
        """End the trial with its episode or its failure; the traceback of a failure is written to ``error.txt``.

        Args:
            result: returns the episode, or raises the error of the trial.
            folder: folder of the trial.
        """
        report = folder / "error.txt"
        try:
            episode = self._result(result)
        except CrowdbotError as error:
            self.do(Fail(str(error)))
        except Exception as error:  # the code of a trial may raise anything; the session must continue
            trace = "".join(traceback.format_exception(error))
            try:
                report.write_text(trace, encoding="utf-8", errors="backslashreplace")
                where = f"the traceback is in {report.name}"
            except OSError as failure:
                where = f"cannot write {report.name}: {failure.strerror}"
            frame = traceback.extract_tb(error.__traceback__)[-1]
            place = f"{Path(frame.filename).name}, line {frame.lineno}"
            self.do(Fail(f"{type(error).__name__}: {error} ({place}); {where}"))
        else:
            if episode.failure is None:
                self.finish(episode)
                return
            report.write_text(episode.failure.trace, encoding="utf-8")
            self.do(Fail(f"{episode.failure.message}; more in {report.name}"))

    def close(self) -> None:
        """Close the log."""
        self._close_clocks()
        self.log.close()

    def _result(self, result: Callable[[], Episode]) -> Episode:
        """Return the episode of a trial, and close the file of its clocks."""
        try:
            return result()
        finally:
            self._close_clocks()

    def _close_clocks(self) -> None:
        if self._clocks is not None:
            self._clocks.close()
            self._clocks = None

    def _clock_values(self) -> dict[str, float]:
        """Return the time of day, the monotonic clock, and the offset between them [s]."""
        at, own = self.clock(), self._monotonic()
        return {"at": at, "monotonic": own, "offset": at - own}

    def _begun(self, head: dict[str, Any]) -> None:
        path = self.folder / LOG
        if self.participant in withdrawn(self.folder.parent):
            raise EpisodeError(f"participant {self.participant} has withdrawn; give this participant another number")
        if path.exists():
            raise EpisodeError(
                f"participant {self.participant} already has a session in {self.folder}; continue it with --resume, or"
                " use another participant or folder"
            )
        self.log = SessionLog.create(path, head)
        try:
            self._copy()
        except BaseException:
            self.close()
            raise

    def _resumed(self, head: dict[str, Any]) -> None:
        path = self.folder / LOG
        if not path.exists():
            raise EpisodeError(f"participant {self.participant} has no session in {self.folder.parent} to resume")
        self.log, records = SessionLog.open(path)
        try:
            if any(records[0].get(key) != head[key] for key in ("experiment", "digest")):
                raise EpisodeError(
                    f"{path} belongs to another version of the experiment or of its screens and trials;"
                    " restore that version, or begin another session"
                )
            for number, record in enumerate(records[1:], 2):
                self._again(path, number, record)
            clocks = {name: head[name] for name in ("at", "monotonic", "offset")}
            self.log.append({"resumed": True, **clocks, **versions()})
            self._copy()
            for number in {step.number for step in self.session.steps}:
                self._write_answers(number)
            self._lost()
        except BaseException:
            self.close()
            raise

    def _copy(self) -> None:
        if not (self.folder / COPY).exists():
            _write(self.folder / COPY, experiment_xml(self.experiment))

    def _again(self, path: Path, number: int, record: dict[str, Any]) -> None:
        if "event" not in record:
            return
        try:
            event, index = event_of(record), self.session.index
            self.session = self.session.after(event)
        except InputError as error:
            raise EpisodeError(f"{path}:{number}: {error}") from None
        if isinstance(event, Answered):
            self._times[index, event.question] = float(record.get("at") or 0.0)

    def _lost(self) -> None:
        """Continue after a pause, and restart a trial that was running when the program ended.

        Each event leads to a state from which this can be repeated if the program ends in between.
        """
        if self.session.phase == "pause" and self.session.waiting != "failed":
            self.do(Resume())
        if self.session.phase == "running":
            self.do(Repeat())

    def _digest(self) -> str:
        """Hash of the experiment, its screens and its trials."""
        trials = [trial_xml(trial) for trial in self.trials.values()]
        whole = json.dumps([experiment_xml(self.experiment), [page.digest for page in self.pages.values()], trials])
        return hashlib.blake2b(whole.encode(), digest_size=16).hexdigest()

    def _write_answers(self, number: int) -> None:
        """Write the answers of a trial to its folder, and answers without a trial beside the log."""
        folder = self.folder
        if number:
            trial = next(
                k for k, step in enumerate(self.session.steps) if step.number == number and step.screen is None
            )
            if trial not in self.session.results:
                return
            folder /= self.session.results[trial].folder
        rows = [
            {"at": self._times.get((index, name)), "screen": step.name, "question": name, "answer": value}
            for index, step in enumerate(self.session.steps)
            if step.number == number
            for name, value in self.session.answers.get(index, {}).items()
        ]
        if rows or (folder / ANSWERS).exists():
            _write(folder / ANSWERS, "".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows))


def _write(path: Path, text: str) -> None:
    """Write a file atomically."""
    draft = path.with_name(f".{path.name}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        draft.write_text(text, encoding="utf-8")
        os.replace(draft, path)
    except OSError as error:
        raise EpisodeError(f"cannot write {path}: {error.strerror}") from None
