"""PredictionSetup: what is on the screen: a recording, predictors and a degradation, as text and as objects."""

from __future__ import annotations

import dataclasses
import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from crowdbot.core import InputError, did_you_mean, from_attributes
from crowdbot.data import FILE_OPTIONS, Degradation, Recording
from crowdbot.web.recording_rows import check_options, option_words, recording_fields
from crowdbot.web.workspace import shown_path

from .form_rows import builtin_kinds, written_values
from .predictor_choice import PredictorChoice

WINDOW_OPTIONS = (
    "step",
    "observe",
    "predict",
    "protocol",
    "near",
    "late",
    "learn",
    "every",
)
"""Options of the windows of a recording, in the order of the form; those of its file come before."""
WHOLE = ("observe", "predict", "every")


@dataclass(frozen=True)
class DegradationChoice:
    """A degradation of the observed rows.

    Fields:
        name: name of the degradation.
        values: parameters that differ from their defaults, as words; the level is always among them.

    >>> DegradationChoice.of("late-start", {"rows": 2}).words()
    ['--by', 'late-start', '--levels', '2']
    """

    name: str
    values: tuple[tuple[str, str], ...]

    @classmethod
    def of(cls, name: str, values: Mapping[str, Any]) -> DegradationChoice:
        """Return the choice of the form, checked.

        Raises:
            InputError: a name is unknown or a value is not allowed.
        """
        known = builtin_kinds("degradations")
        if name not in known:
            raise InputError(
                f"unknown degradation {name!r:.60}{did_you_mean(name, known)}; known are {', '.join(known)}"
            )
        found = written_values(known[name], values, name)
        made: Degradation = from_attributes(known[name], found)
        return cls(name, tuple((found | {made.level: str(getattr(made, made.level))}).items()))

    @property
    def degradation(self) -> Degradation:
        """The degradation."""
        return from_attributes(builtin_kinds("degradations")[self.name], dict(self.values))  # type: ignore[no-any-return]

    def words(self) -> list[str]:
        """Return the options of `crowdbot degrade`."""
        level = self.degradation.level
        rest = [f"{name}={value}" for name, value in self.values if name != level]
        return ["--by", self.name, "--levels", dict(self.values)[level], *(["--set", *rest] if rest else [])]


@dataclass(frozen=True)
class PredictionSetup:
    """Recording, seed and mode of a run, with the text of its command line.

    Fields:
        recording: the recording and its windows.
        seed: seed of all random draws.
        best_of: rule that selects the best future.
        live: whether each calibration starts from the fit of the frame before.
        file_options: options of the file that are given, as in the form; a homography by its path.
    """

    recording: Recording
    seed: int = 0
    best_of: str = "person"
    live: bool = False
    file_options: Mapping[str, Any] = field(default_factory=dict)

    def command(self, choice: PredictorChoice, degradation: DegradationChoice | None = None) -> str:
        """Return the command line that gives the same numbers for a predictor."""
        own = choice.words()
        if degradation is not None:  # there --set is for the degradation
            own = ["--set-predictor" if word == "--set" else word for word in own]
        words = ["crowdbot", "predict" if degradation is None else "degrade", *self._words(), *own]
        if degradation is not None:
            words += [*degradation.words(), "--draws", "1"]
        elif self.live:
            words.append("--live")
        return shlex.join(words)

    def calibrate_command(self, choice: PredictorChoice) -> str:
        """Return the command line that calibrates the crowd of a predictor.

        Raises:
            InputError: nothing is calibrated.
        """
        if not choice.calibrated or choice.learnt:
            raise InputError("only a crowd with a cost or a search, and without learnt parameters, can be calibrated")
        words = choice.words()[2:]
        if choice.samples > 1:
            words = words[: words.index("--samples")]
        return shlex.join(["crowdbot", "calibrate", *self._words(), *words])

    def python(self, choices: list[PredictorChoice], degradation: DegradationChoice | None = None) -> str:
        """Return a Python program that gives the same numbers."""
        given = {f.name: getattr(self.recording, f.name) for f in dataclasses.fields(Recording) if f.name != "path"}
        own = {key: value for key, value in given.items() if value != Recording.__dataclass_fields__[key].default}
        words = "".join(f", {key}={value!r}" for key, value in own.items())
        lines = [f"recording = Recording({shown_path(self.recording.path)!r}{words})"]
        parts = [self._part(choice, degradation) for choice in choices]
        body = "\n".join([*lines, *parts])
        return f"{_imports(body)}\n\n{body}\n"

    def _part(self, choice: PredictorChoice, degradation: DegradationChoice | None) -> str:
        made = choice.python()
        if degradation is None:
            more = f"samples={choice.samples}, best_of={self.best_of!r}, seed={self.seed}, live={self.live}"
            return (
                f"evaluation = PredictorEvaluation((recording,), ({made},), {more})\n"
                "for result in evaluation.results(list(evaluation.run())):\n"
                "    print(result.score)"
            )
        own = degradation.degradation
        names = (f"{f.name}={getattr(own, f.name)!r}" for f in dataclasses.fields(own))
        r = self.recording
        task = (
            f"DegradedTask({r.observe}, {r.predict}, {r.protocol!r}, {r.near!r}, {choice.samples}, {self.best_of!r}, "
            f"{self.seed}, every={r.every})"
        )
        return (
            f"degradation = crowdbot.data.degrade.{type(own).__name__}({', '.join(names)})\n"
            f"predictor = {made}.build(recording)\n"
            f"level = degradation.{own.level}\n"
            f"task = {task}\n"
            "for scores in sweep_degradations([recording.rest], [degradation], [predictor], [level], task):\n"
            "    print(scores[0].score)"
        )

    def _words(self) -> list[str]:
        given = dict(self.file_options)
        if "homography" in given:
            given["homography"] = shown_path(given["homography"])
        found = ["--data", shown_path(self.recording.path), *option_words(given)]
        for name in WINDOW_OPTIONS:
            value = getattr(self.recording, name)
            if value != Recording.__dataclass_fields__[name].default:
                found += [f"--{name.replace('_', '-')}", str(value)]
        found += ["--seed", str(self.seed)] if self.seed else []
        return found + (["--best-of", self.best_of] if self.best_of != "person" else [])


def open_setup(path: Path, options: Mapping[str, Any], find: Callable[[str], Path] = Path) -> PredictionSetup:
    """Return a recording with the options of the form; None and an empty word take the default.

    Args:
        path: the file.
        options: options of the file and of its windows by name.
        find: returns the path of a file of the session by its name.

    Raises:
        InputError: an option is unknown or not of its kind, or the homography cannot be read.
    """
    known = (*FILE_OPTIONS, *WINDOW_OPTIONS)
    wrong = next((key for key in options if key not in known), None)
    if wrong is not None:
        raise InputError(f"a recording has no option {wrong!r}{did_you_mean(wrong, known)}")
    of_file = check_options(options)
    homography = find(of_file["homography"]) if "homography" in of_file else None
    if homography is not None:
        of_file["homography"] = str(homography)
    given: dict[str, Any] = {}
    for key in WINDOW_OPTIONS:
        value = options.get(key)
        if value is None or value == "":
            continue
        number = key in ("step", "near", "learn") and isinstance(value, int | float)
        kind = float if key in ("step", "near", "learn") else int if key in WHOLE else str
        given[key] = float(value) if number else value
        if isinstance(value, bool) or not isinstance(given[key], kind):
            words = {float: "a number", int: "a whole number", str: "a word"}
            raise InputError(f"{key} = {value!r:.60} must be {words[kind]}")
    if max(given.get("observe", 8), given.get("predict", 12)) > 500:
        raise InputError("observe and predict must be at most 500 rows")
    recording = Recording(str(path), **recording_fields(of_file, homography), **given)
    return PredictionSetup(recording, file_options=of_file)


def _imports(body: str) -> str:
    rooms = {"crowdbot." + part.split(".")[0] for part in body.split("crowdbot.")[1:] if part[:1].isalpha()}
    names = "DegradedTask, sweep_degradations" if "DegradedTask" in body else "PredictorEvaluation"
    if ".data.degrade" in body:
        rooms = {room for room in rooms if room != "crowdbot.data"} | {"crowdbot.data.degrade"}
    lines = [f"import {room}" for room in sorted(rooms)]
    lines += [f"from crowdbot.evaluation import {names}", "from crowdbot.data import Recording"]
    return "\n".join([*lines, "from crowdbot.prediction import PredictorSpec"])
