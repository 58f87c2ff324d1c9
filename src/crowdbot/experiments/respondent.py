"""Respondents: sources of answers in a console, typed or scripted."""

from __future__ import annotations

import json
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TextIO

from crowdbot.core import InputError, did_you_mean, stream

from .experiment import Experiment
from .question import Choice, Number, Question, Scale
from .session_plan import plan


class Respondent(ABC):
    """Contract of respondents."""

    patient: bool = False
    """Whether an invalid answer can be repeated."""

    @abstractmethod
    def answer(self, screen: str, question: Question) -> str:
        """Return the answer as text."""

    @abstractmethod
    def go_on(self) -> None:
        """Return when the screen has been read."""

    @abstractmethod
    def choose(self, words: tuple[str, ...]) -> str:
        """Return the choice of the experimenter in a pause."""


class ConsoleRespondent(Respondent):
    """Reads answers line by line from a terminal, a pipe or a file.

    Args:
        stream: stream of lines.
        write: shows a text.
        patient: whether an invalid answer can be repeated; not for a pipe, whose next line is the answer to another
            question.
    """

    def __init__(self, stream: TextIO, write: Callable[[str], None], patient: bool) -> None:
        self._stream, self._write, self.patient = stream, write, patient

    def answer(self, screen: str, question: Question) -> str:
        return self._line(f"{screen}.{question.name}")

    def go_on(self) -> None:
        self._line("the Enter key")

    def choose(self, words: tuple[str, ...]) -> str:
        # read lines until one is an option, or the start of one
        while True:
            given = self._line("a choice").strip().lower()
            fits = [word for word in words if given and word.startswith(given)]
            if len(fits) == 1:
                return fits[0]
            self._write(f"  {given[:40]!r} is not one of {', '.join(words)}\n> ")

    def _line(self, what: str) -> str:
        try:
            line = self._stream.readline()
        except UnicodeDecodeError:
            raise InputError(f"the line for {what} is not in the encoding of this terminal; use UTF-8") from None
        if not line:
            raise InputError(f"the input ended before {what}; continue later with --resume")
        return line.rstrip("\r\n")


class ScriptedRespondent(Respondent):
    """Answers from a mapping by ``screen.question`` or ``question``; does not wait at screens, and aborts at a pause.

    Raises:
        InputError: a name is not that of a question.

    >>> from crowdbot.experiments import load_experiment
    >>> person = ScriptedRespondent({"age": 30, "opinion.comfort": 5}, load_experiment("robot-speed"))
    >>> ScriptedRespondent({"aged": 30}, load_experiment("robot-speed"))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: there is no question 'aged', did you mean 'age'?; questions are ...
    """

    def __init__(self, answers: Mapping[str, Any], experiment: Experiment) -> None:
        screens = [step.screen for step in plan(experiment, 1) if step.screen]
        known = list(dict.fromkeys(f"{s.name}.{question.name}" for s in screens for question in s.questions))
        short = [name.partition(".")[2] for name in known]
        for name in answers:
            if name not in known and name not in short:
                meant = did_you_mean(name, [*short, *known])
                raise InputError(f"there is no question {name[:60]!r}{meant}; questions are {', '.join(known)}")
        self._answers = answers

    @classmethod
    def load(cls, path: Path, experiment: Experiment) -> ScriptedRespondent:
        """Read answers from a JSON file with one object.

        Raises:
            InputError: the file cannot be read or is not a JSON object.
        """
        try:
            answers = json.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise InputError(f"cannot read {path}: {error.strerror}") from None
        except ValueError as error:
            raise InputError(f"{path} is not JSON: {error}") from None
        if not isinstance(answers, dict):
            raise InputError(f'{path} must contain one JSON object of answers, such as {{"welcome.age": 30}}')
        return cls(answers, experiment)

    def answer(self, screen: str, question: Question) -> str:
        value = self._answers.get(f"{screen}.{question.name}", self._answers.get(question.name))
        if value is None:
            return ""
        return ", ".join(map(str, value)) if isinstance(value, list) else str(value)

    def go_on(self) -> None:
        """Do not wait."""

    def choose(self, words: tuple[str, ...]) -> str:
        return "leave"


class EmulatedRespondent(Respondent):
    """Draws answers at random, for rehearsals; never one that ends the session. Ends the session at a pause.

    Args:
        participant, seed: the answers of a participant are always the same.
    """

    def __init__(self, participant: int, seed: int = 0) -> None:
        self._rng = stream(seed, "emulated respondent", participant)

    def answer(self, screen: str, question: Question) -> str:
        # a random answer; a text says that it is a rehearsal
        match question:
            case Choice(options=options):
                names = [option.value for option in options if not option.ends]
                return str(self._rng.choice(names)) if names else ""
            case Scale(low=low, high=high):
                return str(int(self._rng.integers(low, high + 1)))
            case Number(min=least, max=most):
                bottom = float(math.ceil(least)) if least is not None else min(0.0, most or 0.0)
                top = most if most is not None else bottom + 100.0
                value = bottom + float(self._rng.random()) * (top - bottom)
                return str(math.floor(value) if question.integer else value)
            case _:
                return "rehearsal"

    def go_on(self) -> None:
        """Do not wait."""

    def choose(self, words: tuple[str, ...]) -> str:
        return "leave"
