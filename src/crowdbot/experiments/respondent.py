"""Who answers on a console: somebody who types, or answers that were written down before."""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TextIO

from crowdbot.core import InputError, did_you_mean

from .experiment import Experiment
from .question import Question
from .session_plan import plan

__all__ = ["ConsoleRespondent", "Respondent", "ScriptedRespondent"]


class Respondent(ABC):
    """The contract of who answers."""

    patient: bool = False
    """Whether a wrong answer can be given anew."""

    @abstractmethod
    def answer(self, screen: str, question: Question) -> str:
        """Return what is answered, as typed."""

    @abstractmethod
    def go_on(self) -> None:
        """Return when the screen was read."""

    @abstractmethod
    def choose(self, words: tuple[str, ...]) -> str:
        """Return what the experimenter chooses in a pause."""


class ConsoleRespondent(Respondent):
    """Somebody who types lines; a pipe or a file of lines, where each is right at once, does as well.

    Args:
        stream: lines.
        write: shows a text.
        patient: whether a wrong answer can be given anew; not from a pipe, whose next line answers something else.
    """

    def __init__(self, stream: TextIO, write: Callable[[str], None], patient: bool) -> None:
        self._stream, self._write, self.patient = stream, write, patient

    def answer(self, screen: str, question: Question) -> str:
        """Read a line."""
        return self._line(f"{screen}.{question.name}")

    def go_on(self) -> None:
        """Read a line, whatever it says."""
        self._line("the Enter key")

    def choose(self, words: tuple[str, ...]) -> str:
        """Read lines until one is a word, or begins one."""
        while True:
            given = self._line("a choice").strip().lower()
            fits = [word for word in words if given and word.startswith(given)]
            if len(fits) == 1:
                return fits[0]
            self._write(f"  {given[:40]!r} is none of {', '.join(words)}\n> ")

    def _line(self, what: str) -> str:
        try:
            line = self._stream.readline()
        except UnicodeDecodeError:
            raise InputError(f"the line for {what} is not in the encoding of this terminal; use UTF-8") from None
        if not line:
            raise InputError(f"the input has ended where {what} was waited for; go on later with --resume")
        return line.rstrip("\r\n")


class ScriptedRespondent(Respondent):
    """Answers by name, ``screen.question`` or ``question``; screens go on by themselves, and pauses abort.

    Raises:
        InputError: a name that nothing asks.

    >>> from crowdbot.experiments import load_experiment
    >>> person = ScriptedRespondent({"age": 30, "opinion.comfort": 5}, load_experiment("robot-speed"))
    >>> ScriptedRespondent({"aged": 30}, load_experiment("robot-speed"))
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: nothing asks 'aged', did you mean 'age'?; answers are given to welcome.age, \
welcome.robots, opinion.comfort, opinion.remarks
    """

    def __init__(self, answers: Mapping[str, Any], experiment: Experiment) -> None:
        screens = [step.screen for step in plan(experiment, 1) if step.screen]
        known = list(dict.fromkeys(f"{s.name}.{question.name}" for s in screens for question in s.questions))
        short = [name.partition(".")[2] for name in known]
        for name in answers:
            if name not in known and name not in short:
                meant = did_you_mean(name, [*short, *known])
                raise InputError(f"nothing asks {name[:60]!r}{meant}; answers are given to {', '.join(known)}")
        self._answers = answers

    @classmethod
    def load(cls, path: Path, experiment: Experiment) -> ScriptedRespondent:
        """Read the answers from a file with one JSON object.

        Raises:
            InputError: the file cannot be read or holds something else.
        """
        try:
            answers = json.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise InputError(f"{path} cannot be read: {error.strerror}") from None
        except ValueError as error:
            raise InputError(f"{path} is not JSON: {error}") from None
        if not isinstance(answers, dict):
            raise InputError(f'{path} must hold one JSON object of answers, such as {{"welcome.age": 30}}')
        return cls(answers, experiment)

    def answer(self, screen: str, question: Question) -> str:
        """Return the answer to this question of this screen, or to this question of any."""
        value = self._answers.get(f"{screen}.{question.name}", self._answers.get(question.name))
        if value is None:
            return ""
        return ", ".join(map(str, value)) if isinstance(value, list) else str(value)

    def go_on(self) -> None:
        """Go on at once."""

    def choose(self, words: tuple[str, ...]) -> str:
        """Leave: nobody is there to decide."""
        return "leave"
