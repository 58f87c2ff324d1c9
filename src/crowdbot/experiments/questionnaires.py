"""Questionnaires that a screen names instead of its questions: simulator sickness, presence, embodiment.

The wording is our own; the concepts are those of the sources. Use the original questionnaires if scores are to be
compared with other studies.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from .question import Question, Scale
from .sickness import SYMPTOMS, sickness_scores

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
            Scale(name=one, text=symptom.text, low=0, high=3, low_text="none", high_text="severe")
            for one, symptom in SYMPTOMS.items()
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
        if not all(isinstance(answers.get(one), int | float) for one in items):
            continue
        found: dict[str, list[float]] = {}
        for one, item in items.items():
            value = float(answers[one])
            found.setdefault(item.concept, []).append(HIGHEST + 1 - value if item.reverse else value)
        means = {concept: sum(values) / len(values) for concept, values in found.items()}
        scores |= {f"{name}_{concept}": round(mean, 4) for concept, mean in means.items()}
        scores[name] = round(sum(means.values()) / len(means), 4)
    return scores
