"""Session: the progress of a participant through an experiment, as an immutable state machine.

States and transitions::

    ready    start -> screen or trial
    screen   answered -> screen, or aborted by an answer that ends the session;
             next -> the following screen or trial, or done
    trial    begin -> running
    running  finish -> the following screen or trial, or done; fail -> pause
    pause    resume -> the interrupted state; after a failed trial: next -> the following screen or trial
    done, aborted

``pause`` and ``abort`` are possible before the end, ``repeat`` once a trial has begun. A session is a value: an event
returns a new one. Consoles, browsers, headsets and log readers share this class.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from crowdbot.core import InputError, kebab_case

from .experiment import Experiment
from .log import Abort, Answered, Begin, Event, Fail, Finish, Next, Pause, Repeat, Resume, Start
from .question import Answer, Choice, Question
from .session_plan import SessionStep, plan


@dataclass(frozen=True)
class Result:
    """Result of a trial; the last attempt counts.

    ``outcome`` is that of its episode, or ``failed`` with a reason.
    """

    seed: int
    folder: str
    attempt: int
    outcome: str = ""
    digest: str = ""
    metrics: Mapping[str, Any] = field(default_factory=dict)
    reason: str = ""


@dataclass(frozen=True)
class Session:
    """Progress of a participant.

    Fields:
        steps: plan of the participant.
        phase: ``ready``, ``screen``, ``trial`` (about to begin), ``running``, ``pause``, ``done`` or ``aborted``.
        index: index of the current step.
        waiting: the phase interrupted by a pause; ``failed`` after a failed trial.
        reason: reason of the pause or abort.
        answers: answers by step index and name of the question.
        attempts: number of starts of each trial, by step index.
        results: results of finished trials, by step index.

    >>> from crowdbot.experiments import load_experiment
    >>> session = Session.of(load_experiment("robot-speed"), participant=1).after(Start())
    >>> session.phase, session.step.name, [question.name for question in session.open]
    ('screen', 'welcome', ['age', 'robots'])
    >>> session.after(Next())
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: the screen 'welcome' has unanswered questions: 'age', 'robots'
    """

    steps: tuple[SessionStep, ...]
    phase: str = "ready"
    index: int = 0
    waiting: str = ""
    reason: str = ""
    answers: Mapping[int, Mapping[str, Answer]] = field(default_factory=dict)
    attempts: Mapping[int, int] = field(default_factory=dict)
    results: Mapping[int, Result] = field(default_factory=dict)

    @classmethod
    def of(cls, experiment: Experiment, participant: int) -> Session:
        """Return the session of a participant before its start."""
        return cls(plan(experiment, participant))

    @property
    def step(self) -> SessionStep:
        """The current screen or trial; at the end, the last one."""
        return self.steps[min(self.index, len(self.steps) - 1)]

    @property
    def open(self) -> tuple[Question, ...]:
        """The unanswered questions of the current screen."""
        known = self.answers.get(self.index, {})
        screen = self.step.screen if self.phase == "screen" else None
        return tuple(question for question in screen.questions if question.name not in known) if screen else ()

    @property
    def over(self) -> bool:
        """Whether the session has ended."""
        return self.phase in ("done", "aborted")

    @property
    def possible_events(self) -> tuple[str, ...]:
        """Names of the events that are possible now."""
        again = ("repeat",) if self._latest() is not None else ()
        return {
            "ready": ("start", "abort"),
            "screen": ("answered", "next", "pause", *again, "abort"),
            "trial": ("begin", "pause", *again, "abort"),
            "running": ("finish", "fail", "pause", "repeat", "abort"),
            "pause": ("next" if self.waiting == "failed" else "resume", *again, "abort"),
        }.get(self.phase, ())

    def after(self, event: Event) -> Session:
        """Return the session after an event.

        Raises:
            InputError: the event is not possible now, or the answer is not allowed.
        """
        word = kebab_case(type(event).__name__)
        if word not in self.possible_events:
            known = ", ".join(self.possible_events) or "nothing"
            raise InputError(f"{word!r} is not possible {self._where()}; possible events: {known}")
        match event:
            case Start():
                return self._at(0)
            case Next():
                return self._next()
            case Answered(name, value):
                return self._answered(name, value)
            case Begin(seed, folder):
                attempt = self.attempts.get(self.index, 0) + 1
                return self._running(Result(seed, folder, attempt), phase="running")
            case Finish(outcome, digest, metrics):
                ended = self._ended(outcome=outcome, digest=digest, metrics=metrics)
                return self._running(ended)._at(self.index + 1)
            case Fail(reason):
                ended = self._ended(outcome="failed", reason=reason)
                return self._running(ended, phase="pause", waiting="failed", reason=reason)
            case Pause(reason):
                return dataclasses.replace(self, phase="pause", waiting=self.phase, reason=reason)
            case Resume():
                return dataclasses.replace(self, phase=self.waiting, waiting="", reason="")
            case Repeat():
                return self._again()
            case Abort(reason):
                return dataclasses.replace(self, phase="aborted", waiting="", reason=reason)

    def through(self, events: Iterable[Event]) -> Session:
        """Return the session after several events."""
        session = self
        for event in events:
            session = session.after(event)
        return session

    def _where(self) -> str:
        place = f" at {self.step.role} {self.step.name!r}" if self.phase in ("screen", "trial", "running") else ""
        return f"while the session is {self.phase!r}{place}"

    def _at(self, index: int) -> Session:
        phase = "done" if index >= len(self.steps) else "screen" if self.steps[index].screen else "trial"
        return dataclasses.replace(self, phase=phase, index=index, waiting="", reason="")

    def _next(self) -> Session:
        left = [question.name for question in self.open if question.required]
        if left:
            names = ", ".join(map(repr, left))
            raise InputError(f"the screen {self.step.name!r} has unanswered questions: {names}")
        return self._at(self.index + 1)

    def _answered(self, name: str, value: Any) -> Session:
        assert self.step.screen is not None
        questions = {question.name: question for question in self.step.screen.questions}
        if name not in questions:
            known = ", ".join(questions) or "nothing"
            raise InputError(f"the screen {self.step.name!r} has no question {name[:40]!r}; it has {known}")
        question = questions[name]
        here = {**self.answers.get(self.index, {}), name: question.take(value)}
        session = dataclasses.replace(self, answers={**self.answers, self.index: here})
        if isinstance(question, Choice) and question.ends(here[name]):
            return session.after(Abort(f"answer to {name!r}"))
        return session

    def _running(self, result: Result, **changes: Any) -> Session:
        attempts = {**self.attempts, self.index: result.attempt}
        results = {**self.results, self.index: result}
        return dataclasses.replace(self, attempts=attempts, results=results, **changes)

    def _ended(self, **changes: Any) -> Result:
        return dataclasses.replace(self.results[self.index], **changes)

    def _latest(self) -> int | None:
        """Return the step of the last trial that was begun."""
        return max((index for index in self.attempts if index <= self.index), default=None)

    def _again(self) -> Session:
        latest = self._latest()
        assert latest is not None
        answers = {index: kept for index, kept in self.answers.items() if index < latest}
        results = {index: kept for index, kept in self.results.items() if index < latest}
        return dataclasses.replace(self, answers=answers, results=results)._at(latest)
