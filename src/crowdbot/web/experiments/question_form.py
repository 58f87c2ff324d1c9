"""Questions of a screen as rows of a form."""

from __future__ import annotations

from typing import Any

from crowdbot.experiments import Choice, FreeText, Number, Scale


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
