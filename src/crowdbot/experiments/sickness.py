"""Scores of the simulator sickness questionnaire."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple


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
        name: sum(answers[one] for one, symptom in SYMPTOMS.items() if letter in symptom.scales)
        for name, (letter, _) in WEIGHTS.items()
    }
    scores = {name: round(sums[name] * weight, 2) for name, (_, weight) in WEIGHTS.items()}
    return {**scores, "total": round(sum(sums.values()) * TOTAL, 2)}
