"""Questions to a participant: what is asked, and which answers are allowed."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError, did_you_mean, parse_number
from crowdbot.trials import UNWRITABLE, attribute, check, children, plain, quote_value

__all__ = ["QUESTIONS", "SHORT", "Answer", "Choice", "ChoiceOption", "FreeText", "Number", "Question", "Scale"]

SHORT = "[A-Za-z][A-Za-z0-9_]{0,39}"
"""Names of screens, questions, blocks and trials: they become columns and folders."""

Answer = str | int | float | tuple[str, ...] | None
"""What was answered; None is no answer, where one is not required."""


@dataclass(frozen=True, kw_only=True)
class Question(ABC):
    """The contract of questions."""

    name: str = attribute(about="name of its column in the answers", pattern=SHORT)
    text: str = attribute(about="what is asked")
    required: bool = attribute(True, about="whether it must be answered")

    def __post_init__(self) -> None:
        check(self)

    def read(self, text: str) -> Answer:
        """Return the answer that a typed text means.

        Raises:
            InputError: the text is no allowed answer.
        """
        return self.take(self._typed(text.strip()) if text.strip() else None)

    def take(self, value: Any) -> Answer:
        """Return an answer that came as a value, as from a form.

        Raises:
            InputError: it is not allowed.
        """
        if value is None or (isinstance(value, str | list | tuple) and not len(value)):
            if self.required:
                raise InputError(f"{self.name!r} needs an answer: {self.hint}")
            return None
        return self._taken(value)

    @property
    @abstractmethod
    def hint(self) -> str:
        """What may be answered, for people."""

    def problem(self) -> str:
        """Return what is wrong with the question although every value of it is allowed."""
        return "" if self.text.strip() else "has an empty text; write what is asked"

    def _typed(self, text: str) -> Any:
        return text

    @abstractmethod
    def _taken(self, value: Any) -> Answer: ...

    def _refuse(self, value: Any) -> InputError:
        return InputError(f"{quote_value(value)} is no answer to {self.name!r}, it must be {self.hint}")


@dataclass(frozen=True, kw_only=True)
class ChoiceOption:
    """One of the answers of a choice."""

    value: str = attribute(about="what is recorded", pattern=SHORT)
    text: str = attribute("", about="what is shown; the value when it is left out")

    def __post_init__(self) -> None:
        check(self)

    @property
    def label(self) -> str:
        """What is shown."""
        return self.text or self.value


@dataclass(frozen=True, kw_only=True)
class Choice(Question):
    """A choice of one option, or of several.

    >>> options = [ChoiceOption(value="left"), ChoiceOption(value="right")]
    >>> hand = Choice(name="hand", text="Which hand?", options=options)
    >>> hand.read("2"), hand.read("left")
    ('right', 'left')
    >>> hand.read("lefd")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: "lefd" is no answer to 'hand', did you mean 'left'?; it must be left or right
    """

    multiple: bool = attribute(False, about="whether more than one may be chosen")
    options: tuple[ChoiceOption, ...] = children("option", about="the answers", min=1, max=100)

    @property
    def hint(self) -> str:
        """The options."""
        values = [option.value for option in self.options]
        return f"some of {', '.join(values)}" if self.multiple else " or ".join(values)

    def problem(self) -> str:
        """Return also whether two options are recorded by the same value."""
        values = [option.value for option in self.options]
        twice = [value for k, value in enumerate(values) if value in values[:k]]
        return Question.problem(self) or (
            f"has the option {twice[0]!r} twice; give each its own value" if twice else ""
        )

    def _typed(self, text: str) -> Any:
        words = [word for word in re.split(r"[\s,;]+", text) if word]
        values = [self._by_number(word) for word in words]
        return values if self.multiple else values[0] if len(values) == 1 else text

    def _by_number(self, word: str) -> str:
        row = int(word) if re.fullmatch("[0-9]{1,3}", word) else 0
        return self.options[row - 1].value if 0 < row <= len(self.options) else word

    def _taken(self, value: Any) -> Answer:
        known = [option.value for option in self.options]
        given = list(value) if self.multiple and isinstance(value, list | tuple) else [value]
        for one in given:
            if not isinstance(one, str) or one not in known:
                meant = did_you_mean(str(one), known)
                raise InputError(
                    f"{quote_value(one)} is no answer to {self.name!r}{f'{meant};' if meant else ','} it must be"
                    f" {self.hint}"
                )
        if not self.multiple:
            return known[known.index(given[0])]
        return tuple(name for name in known if name in given)


@dataclass(frozen=True, kw_only=True)
class Scale(Question):
    """A rating in whole steps, such as a Likert scale from 1 to 7.

    >>> Scale(name="ease", text="How easy was it?").read("8")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: "8" is no answer to 'ease', it must be a whole number from 1 to 7
    """

    low: int = attribute(1, about="lowest step", min=-1000, max=1000)
    high: int = attribute(7, about="highest step", min=-1000, max=1000)
    low_text: str = attribute("", about="what the lowest step means")
    high_text: str = attribute("", about="what the highest step means")

    @property
    def hint(self) -> str:
        """The steps and what their ends mean."""
        ends = [f"{self.low} {self.low_text}".rstrip(), f"{self.high} {self.high_text}".rstrip()]
        return f"a whole number from {ends[0]} to {ends[1]}"

    def problem(self) -> str:
        """Return also whether there is more than one step."""
        return Question.problem(self) or (
            "" if self.low < self.high else f"has low={self.low} not below high={self.high}"
        )

    def _typed(self, text: str) -> Any:
        return int(text) if re.fullmatch("[+-]?[0-9]{1,6}", text) else text

    def _taken(self, value: Any) -> Answer:
        if type(value) is not int or not self.low <= value <= self.high:
            raise self._refuse(value)
        return value


@dataclass(frozen=True, kw_only=True)
class Number(Question):
    """A number within limits.

    >>> Number(name="age", text="How old are you?", min=18, integer=True).read("27")
    27
    """

    unit: str = attribute("", about="unit of the answer, for people")
    min: float | None = attribute(None, about="lowest answer")
    max: float | None = attribute(None, about="highest answer")
    integer: bool = attribute(False, about="whether it must be a whole number")

    @property
    def hint(self) -> str:
        """The limits."""
        words = ["a whole number" if self.integer else "a number"]
        words += [f"in {self.unit}"] if self.unit else []
        words += [f"at least {plain(self.min)}"] if self.min is not None else []
        words += [f"at most {plain(self.max)}"] if self.max is not None else []
        return ", ".join(words)

    def problem(self) -> str:
        """Return also whether the limits leave an answer."""
        empty = self.min is not None and self.max is not None and self.min > self.max
        return Question.problem(self) or ("has min above max" if empty else "")

    def _typed(self, text: str) -> Any:
        try:
            return parse_number(text)
        except InputError:
            return text

    def _taken(self, value: Any) -> Answer:
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= 1e15:
            raise self._refuse(value)
        low = self.min is not None and value < self.min
        high = self.max is not None and value > self.max
        if low or high or (self.integer and value != int(value)):
            raise self._refuse(plain(value))
        return int(value) if self.integer else float(value)


@dataclass(frozen=True, kw_only=True)
class FreeText(Question):
    """Words of the participant's own.

    >>> FreeText(name="remarks", text="Anything else?", required=False).read("  no ")
    'no'
    """

    max_length: int = attribute(2000, about="most characters", min=1, max=10_000)

    @property
    def hint(self) -> str:
        """How long it may be."""
        return f"a text of at most {self.max_length} characters"

    def _taken(self, value: Any) -> Answer:
        if not isinstance(value, str) or len(value) > self.max_length:
            raise self._refuse(value)
        if UNWRITABLE.search(value):
            raise InputError(f"the answer to {self.name!r} holds a control character; write it without")
        return value


QUESTIONS: dict[str, type[Question]] = {"choice": Choice, "scale": Scale, "number": Number, "free-text": FreeText}
"""The kinds of questions by their elements."""
