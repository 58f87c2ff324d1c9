"""Questions of screens, and questionnaires with their scores.

The wording is our own; the concepts are those of the sources. Use the original questionnaires if scores are to be
compared with other studies.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from crowdbot.core import InputError, did_you_mean, parse_number
from crowdbot.trials import UNWRITABLE, attribute, check, children, plain, quote_value

SHORT = "[A-Za-z][A-Za-z0-9_]{0,39}"
"""Pattern of names of screens, questions, blocks and trials, which become columns and folders."""

Answer = str | int | float | tuple[str, ...] | None
"""Type of answers; None for an optional question without an answer."""


@dataclass(frozen=True, kw_only=True)
class Question(ABC):
    """Contract of questions."""

    name: str = attribute(about="name of its column in the answers", pattern=SHORT)
    text: str = attribute(about="text of the question")
    required: bool = attribute(True, about="whether an answer is required")

    def __post_init__(self) -> None:
        check(self)

    def read(self, text: str) -> Answer:
        """Return the answer given as text.

        Raises:
            InputError: the answer is not allowed.
        """
        return self.take(self._typed(text.strip()) if text.strip() else None)

    def take(self, value: Any) -> Answer:
        """Return an answer given as a value, for example from a form.

        Raises:
            InputError: the answer is not allowed.
        """
        if value is None or (isinstance(value, str | list | tuple) and not len(value)):
            if self.required:
                raise InputError(f"{self.name!r} requires an answer: {self.hint}")
            return None
        return self._taken(value)

    @property
    @abstractmethod
    def hint(self) -> str:
        """Description of the allowed answers."""

    def problem(self) -> str:
        """Return a problem that involves several values of the question."""
        return "" if self.text.strip() else "has an empty text; give the text of the question"

    def _typed(self, text: str) -> Any:
        return text

    @abstractmethod
    def _taken(self, value: Any) -> Answer: ...

    def _refuse(self, value: Any) -> InputError:
        return InputError(f"{quote_value(value)} is not an answer to {self.name!r}, it must be {self.hint}")


@dataclass(frozen=True, kw_only=True)
class ChoiceOption:
    """An option of a choice."""

    value: str = attribute(about="recorded value", pattern=SHORT)
    text: str = attribute("", about="text to show (default: the value)")
    ends: bool = attribute(False, about="whether the session ends with this answer, for consent and exclusion criteria")

    def __post_init__(self) -> None:
        check(self)

    @property
    def label(self) -> str:
        """Text to show."""
        return self.text or self.value


@dataclass(frozen=True, kw_only=True)
class Choice(Question):
    """A choice of one or several options.

    >>> options = [ChoiceOption(value="left"), ChoiceOption(value="right")]
    >>> hand = Choice(name="hand", text="Which hand?", options=options)
    >>> hand.read("2"), hand.read("left")
    ('right', 'left')
    >>> hand.read("lefd")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: "lefd" is not an answer to 'hand', did you mean 'left'?; it must be left or right
    """

    multiple: bool = attribute(False, about="whether several options may be chosen")
    options: tuple[ChoiceOption, ...] = children("option", about="the answers", min=1, max=100)

    @property
    def hint(self) -> str:
        values = [option.value for option in self.options]
        return f"some of {', '.join(values)}" if self.multiple else " or ".join(values)

    def ends(self, answer: Answer) -> bool:
        """Return whether the session ends with an answer."""
        given = answer if isinstance(answer, tuple) else (answer,)
        return any(option.ends for option in self.options if option.value in given)

    def problem(self) -> str:
        values = [option.value for option in self.options]
        twice = [value for k, value in enumerate(values) if value in values[:k]]
        return Question.problem(self) or (f"has the option {twice[0]!r} twice; values must differ" if twice else "")

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
        for item in given:
            if not isinstance(item, str) or item not in known:
                meant = did_you_mean(str(item), known)
                raise InputError(
                    f"{quote_value(item)} is not an answer to {self.name!r}{f'{meant};' if meant else ','} it must "
                    f"be"
                    f" {self.hint}"
                )
        if not self.multiple:
            return known[known.index(given[0])]
        return tuple(name for name in known if name in given)


@dataclass(frozen=True, kw_only=True)
class Scale(Question):
    """A rating on an integer scale, such as a Likert scale from 1 to 7.

    >>> Scale(name="ease", text="How easy was it?").read("8")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: "8" is not an answer to 'ease', it must be a whole number from 1 to 7
    """

    low: int = attribute(1, about="lowest step", min=-1000, max=1000)
    high: int = attribute(7, about="highest step", min=-1000, max=1000)
    low_text: str = attribute("", about="label of the lowest step")
    high_text: str = attribute("", about="label of the highest step")

    @property
    def hint(self) -> str:
        ends = [f"{self.low} {self.low_text}".rstrip(), f"{self.high} {self.high_text}".rstrip()]
        return f"a whole number from {ends[0]} to {ends[1]}"

    def problem(self) -> str:
        return Question.problem(self) or (
            "" if self.low < self.high else f"has low={self.low}, which must be below high={self.high}"
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

    unit: str = attribute("", about="unit of the answer, for display")
    min: float | None = attribute(None, about="lowest answer")
    max: float | None = attribute(None, about="highest answer")
    integer: bool = attribute(False, about="whether the answer must be a whole number")

    @property
    def hint(self) -> str:
        words = ["a whole number" if self.integer else "a number"]
        words += [f"in {self.unit}"] if self.unit else []
        words += [f"at least {plain(self.min)}"] if self.min is not None else []
        words += [f"at most {plain(self.max)}"] if self.max is not None else []
        return ", ".join(words)

    def problem(self) -> str:
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
    """A free text.

    >>> FreeText(name="remarks", text="Anything else?", required=False).read("  no ")
    'no'
    """

    max_length: int = attribute(2000, about="most characters", min=1, max=10_000)

    @property
    def hint(self) -> str:
        return f"a text of at most {self.max_length} characters"

    def _taken(self, value: Any) -> Answer:
        if not isinstance(value, str) or len(value) > self.max_length:
            raise self._refuse(value)
        if UNWRITABLE.search(value):
            raise InputError(f"the answer to {self.name!r} contains a control character, which is not allowed")
        return value


QUESTIONS: dict[str, type[Question]] = {"choice": Choice, "scale": Scale, "number": Number, "free-text": FreeText}
"""Question classes by XML element."""


class Symptom(NamedTuple):
    """A question: the letters of the scales that it belongs to, and its text in our own words."""

    scales: str
    text: str


SYMPTOMS: dict[str, Symptom] = {
    "discomfort": Symptom("NO", "General discomfort"),
    "fatigue": Symptom("O", "Fatigue"),
    "headache": Symptom("O", "Headache"),
    "eye_strain": Symptom("O", "Eye strain"),
    "focusing": Symptom("OD", "Difficulty in seeing sharply"),
    "salivation": Symptom("N", "More saliva than usual"),
    "sweating": Symptom("N", "Sweating"),
    "nausea": Symptom("ND", "Nausea"),
    "concentrating": Symptom("NO", "Difficulty in concentrating"),
    "full_head": Symptom("D", "A feeling of fullness in the head"),
    "blurred_vision": Symptom("OD", "Blurred vision"),
    "dizzy_open": Symptom("D", "Dizziness with open eyes"),
    "dizzy_closed": Symptom("D", "Dizziness with closed eyes"),
    "vertigo": Symptom("D", "A feeling that you or the room turn"),
    "stomach": Symptom("N", "Awareness of the stomach, short of nausea"),
    "burping": Symptom("N", "Burping"),
}
"""Questions, and the scales to which each belongs: nausea, oculomotor, disorientation."""

WEIGHTS = {"nausea": ("N", 9.54), "oculomotor": ("O", 7.58), "disorientation": ("D", 13.92)}
TOTAL = 3.74


def sickness_scores(answers: Mapping[str, Any]) -> dict[str, float]:
    """Return the scores ``nausea``, ``oculomotor``, ``disorientation`` and ``total`` of a screen.

    Empty if an answer is missing. A screen with ``questionnaire="sickness"`` has the questions, in our own words.

    Source: Kennedy, Lane, Berbaum, Lilienthal (1993), Simulator sickness questionnaire, doi
    10.1207/s15327108ijap0303_3: weighted sums of the answers 0 (none) to 3 (severe).

    Args:
        answers: answers 0 to 3 by the names in :data:`SYMPTOMS`.

    >>> sickness_scores(dict.fromkeys(SYMPTOMS, 1))["total"]
    78.54
    """
    if not all(isinstance(answers.get(name), int | float) for name in SYMPTOMS):
        return {}
    sums = {
        name: sum(answers[item] for item, symptom in SYMPTOMS.items() if letter in symptom.scales)
        for name, (letter, _) in WEIGHTS.items()
    }
    scores = {name: round(sums[name] * weight, 2) for name, (_, weight) in WEIGHTS.items()}
    return {**scores, "total": round(sum(sums.values()) * TOTAL, 2)}


NONE, FULL = "not at all", "fully"
HIGHEST = 7


class Item(NamedTuple):
    """A statement that is rated from 1 to 7.

    Fields:
        concept: score that it belongs to.
        text: the statement.
        reverse: whether 7 means the opposite of the concept; it then counts as 8 minus the answer.
        ends: labels of 1 and 7.
    """

    concept: str
    text: str
    reverse: bool = False
    ends: tuple[str, str] = (NONE, FULL)


PRESENCE: Mapping[str, Item] = {
    "there": Item("place", "I had the feeling of being in the virtual room."),
    "real": Item(
        "place", "At times the virtual room was more real to me than the laboratory.", ends=("never", "almost always")
    ),
    "visited": Item(
        "place", "I remember the virtual room as a place where I have been rather than as pictures.",
        ends=("as pictures", "as a place"),
    ),
    "laboratory": Item("involvement", "I was aware of what happened in the laboratory around me.", True),
    "captured": Item("involvement", "What happened in the virtual room had my whole attention."),
    "plausible": Item("plausibility", "The robot and the people behaved as they would in reality."),
    "response": Item("plausibility", "I behaved as I would have in a real room."),
}  # fmt: skip
"""Presence, after Slater, Usoh, Steed (1994), doi 10.1162/pres.1994.3.2.130 (place), Schubert, Friedmann, Regenbrecht
(2001), The experience of presence, doi 10.1162/105474601300343603 (involvement), and Slater (2009), Place illusion and
plausibility, doi 10.1098/rstb.2009.0138 (plausibility)."""

EMBODIMENT: Mapping[str, Item] = {
    "own_body": Item("ownership", "It felt as if the virtual body was mine."),
    "other_body": Item("ownership", "It felt as if the virtual body belonged to somebody else.", True),
    "control": Item("agency", "It felt as if I moved the virtual body."),
    "moves_alone": Item("agency", "The virtual body seemed to move by itself.", True),
    "place": Item("location", "My body felt to be where I saw the virtual body."),
    "outside": Item("location", "I felt to be beside or outside of the virtual body.", True),
    "likeness": Item("appearance", "The virtual body began to look like my own body."),
    "danger": Item("response", "When something came close to the virtual body, I felt that it could hit me."),
}
"""Embodiment, after the concepts of Gonzalez-Franco, Peck (2018), Avatar embodiment, doi 10.3389/frobt.2018.00074."""

ITEMS: Mapping[str, Mapping[str, Item]] = {"presence": PRESENCE, "embodiment": EMBODIMENT}
QUESTIONNAIRES = ("sickness", *ITEMS)
"""Names of the questionnaires."""


def questionnaire_questions(name: str) -> tuple[Question, ...]:
    """Return the questions of a questionnaire.

    Args:
        name: one of :data:`QUESTIONNAIRES`.

    >>> [question.name for question in questionnaire_questions("presence")][:3]
    ['there', 'real', 'visited']
    """
    if name == "sickness":
        return tuple(
            Scale(name=item, text=symptom.text, low=0, high=3, low_text="none", high_text="severe")
            for item, symptom in SYMPTOMS.items()
        )
    return tuple(
        Scale(name=one, text=item.text, low=1, high=HIGHEST, low_text=item.ends[0], high_text=item.ends[1])
        for one, item in ITEMS[name].items()
    )


def questionnaire_scores(answers: Mapping[str, Any]) -> dict[str, float]:
    """Return the scores of the questionnaires that a screen asks completely, from the answers by question.

    The scores of simulator sickness are those of :func:`sickness_scores`. Those of presence and embodiment are the
    means of the items of each concept, and of all concepts (``presence``, ``embodiment``), from 1 to 7.

    >>> answers = dict.fromkeys(EMBODIMENT, 7)
    >>> questionnaire_scores(answers)["embodiment_ownership"]  # the second item of ownership is reverse
    4.0
    """
    scores = {f"sickness_{name}": score for name, score in sickness_scores(answers).items()}
    for name, items in ITEMS.items():
        if not all(isinstance(answers.get(item), int | float) for item in items):
            continue
        found: dict[str, list[float]] = {}
        for one, item in items.items():
            value = float(answers[one])
            found.setdefault(item.concept, []).append(HIGHEST + 1 - value if item.reverse else value)
        means = {concept: sum(values) / len(values) for concept, values in found.items()}
        scores |= {f"{name}_{concept}": round(mean, 4) for concept, mean in means.items()}
        scores[name] = round(sum(means.values()) / len(means), 4)
    return scores
