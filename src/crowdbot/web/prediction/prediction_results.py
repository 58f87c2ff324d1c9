"""PredictorResults: what a run has given for one predictor and one input."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.data import Windows
from crowdbot.evaluation import FrameResults
from crowdbot.metrics import PersonErrors, Score
from crowdbot.web.plain_json import clean_json, plain_number

from .prediction_worker import WindowPart

VARIABLES = {
    "ade": ("Error (ADE)", "m"),
    "fde": ("Final error (FDE)", "m"),
    "time": ("Execution time", "ms"),
    "cost": ("Minimum cost", "m"),
    "evaluations": ("Iterations", ""),
    "people": ("People", ""),
}
"""Variables of the online plots: label and unit."""


class PredictorResults:
    """Results of one predictor on one input, window by window.

    Args:
        past, future: windows of the input.

    Attributes:
        state: ``waits``, ``runs``, ``done``, ``cancelled`` or ``failed``.
        problem: why it has failed.
        note: remark of the predictor on the input.
        score: score over all windows, once it is done.
    """

    def __init__(self, past: Windows, future: Windows) -> None:
        self.past, self.future = past, future
        self.state, self.problem, self.note = "waits", "", ""
        self.score: Score | None = None
        self._parts: list[WindowPart] = []
        self._place: dict[int, tuple[WindowPart, int]] = {}
        self._person: dict[int, dict[int, tuple[float, float]]] = {}

    @property
    def count(self) -> int:
        """Number of windows with a result."""
        return len(self._place)

    @property
    def share(self) -> float:
        """Share of the windows with a result."""
        return self.count / max(1, len(self.past))

    def begin(self, windows: int) -> None:
        """Note that the predictor runs."""
        assert windows == len(self.past)
        self.state = "runs"

    def finish(self, score: Score) -> None:
        """Keep the score of all windows."""
        self.state, self.score = "done", score

    def fail(self, problem: str) -> None:
        """Keep why the predictor has failed."""
        self.state, self.problem = "failed", problem

    def stop(self, cancelled: bool) -> None:
        """Note that the run has ended."""
        if self.state in ("waits", "runs"):
            self.state = "cancelled" if cancelled else "failed"

    def add(self, part: WindowPart) -> None:
        """Keep the results of some windows."""
        row = 0
        for w in range(len(part.ids)):
            index = part.first + w
            scored = self.future.id[index, self.future.scored[index]]
            own = slice(row, row + len(scored))
            pairs = zip(part.errors.ade[own].tolist(), part.errors.fde[own].tolist(), strict=True)
            self._person[index] = dict(zip(scored.tolist(), pairs, strict=True))
            self._place[index] = (part, w)
            row += len(scored)
        self._parts.append(part)

    def lines(self, part: WindowPart) -> list[list[float | None]]:
        """Return a line of the log for each window: frame, people, cost, iterations, time [s], ADE."""
        f = part.frames
        return [
            [plain_number(item) for item in row]
            for row in zip(f.frame, f.people, f.cost, f.evaluations, f.seconds, f.ade, strict=True)
        ]

    def log(self) -> list[list[float | None]]:
        """Return all lines of the log."""
        return [line for part in list(self._parts) for line in self.lines(part)]

    def forecast(self, index: int) -> tuple[NDArray[np.int64], NDArray[np.float32], NDArray[np.float32]] | None:
        """Return ids ``[n]``, paths ``[K, T, n, 2]`` and weights ``[K]`` of a window, or None."""
        found = self._place.get(index)
        if found is None:
            return None
        part, w = found
        return part.ids[w], part.paths[w], part.weight[w]

    def person(self, index: int, id: int) -> dict[str, Any]:
        """Return errors and fitted parameters of a person in a window, and the mean errors over all windows."""
        here = self._person.get(index, {}).get(id)
        every = [own[id] for own in list(self._person.values()) if id in own]
        mean = np.mean(every, axis=0).tolist() if every else [math.nan, math.nan]
        result: dict[str, Any] = {
            "ade": plain_number(here[0]) if here else None,
            "fde": plain_number(here[1]) if here else None,
            "mean_ade": plain_number(mean[0]),
            "mean_fde": plain_number(mean[1]),
            "windows": len(every),
            "parameters": [],
            "cost": None,
        }
        if index in self._place:
            part, w = self._place[index]
            result["cost"] = plain_number(part.frames.cost[w])
            slot = np.flatnonzero(part.ids[w] == id)
            if part.fit and len(slot):
                values, given = (array[slot[0]] for array in part.fit[w])
                result["parameters"] = [
                    {
                        "name": name,
                        "unit": "" if unit == "1" else unit,
                        "value": plain_number(v),
                        "given": plain_number(g),
                    }
                    for (name, unit), v, g in zip(part.names, values, given, strict=True)
                ]
        return result

    def parameter_names(self) -> tuple[tuple[str, str], ...]:
        """Return names and units of the fitted parameters."""
        return next((part.names for part in self._parts if part.names), ())

    def series(self, variable: str, person: int | None = None) -> list[float | None]:
        """Return a variable by window, for everybody or for one person; None where there is no value."""
        result: list[float | None] = [None] * len(self.past)
        for index, (part, w) in sorted(self._place.items()):
            result[index] = plain_number(self._value(variable, person, index, part, w))
        return result

    def _value(self, variable: str, person: int | None, index: int, part: WindowPart, w: int) -> float:
        if variable in ("ade", "fde") and person is not None:
            pair = self._person[index].get(person)
            return math.nan if pair is None else pair[variable == "fde"]
        if variable in VARIABLES:
            values = part.frames.seconds * 1e3 if variable == "time" else getattr(part.frames, variable)
            return float(values[w])
        names = [name for name, _ in part.names]
        if variable not in names or not part.fit:
            return math.nan
        column = part.fit[w][0][:, names.index(variable)]
        if person is None:
            return float(np.median(column)) if len(column) else math.nan
        slot = np.flatnonzero(part.ids[w] == person)
        return float(column[slot[0]]) if len(slot) else math.nan

    def errors(self) -> PersonErrors | None:
        """Return the errors of all people so far."""
        parts = [part.errors for part in self._parts]
        return PersonErrors.concatenate(parts) if parts and sum(len(part.ade) for part in parts) else None

    def frames(self) -> FrameResults | None:
        """Return the results by frame so far."""
        return FrameResults.concatenate([part.frames for part in self._parts]) if self._parts else None

    def whole(self) -> WindowPart | None:
        """Return all windows with a result as one part, None if there is none; windows come in order."""
        parts = [part for part in list(self._parts) if part.ids]
        if not parts:
            return None
        return WindowPart(
            parts[0].first,
            FrameResults.concatenate([part.frames for part in parts]),
            PersonErrors.concatenate([part.errors for part in parts]),
            [ids for part in parts for ids in part.ids],
            [paths for part in parts for paths in part.paths],
            [weight for part in parts for weight in part.weight],
            [fit for part in parts for fit in part.fit],
            self.parameter_names(),
        )

    def horizon(self) -> list[float | None]:
        """Return the mean error at each predicted row [m]."""
        if self.score is not None:
            return [plain_number(item) for item in self.score.horizon]
        errors = self.errors()
        return [] if errors is None else [plain_number(item) for item in errors.over_horizon()]

    def summary(self) -> dict[str, Any]:
        """Return the state as JSON."""
        score = None
        if self.score is not None:
            score = clean_json(self.score.as_dict())
        own = {"state": self.state, "problem": self.problem, "note": self.note, "done": self.count}
        return {**own, "windows": len(self.past), "score": score}
