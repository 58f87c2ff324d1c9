"""Forms of jobs: what is asked, and the words of the command line that it gives."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from crowdbot import calibration
from crowdbot.core import InputError, builtin_classes, did_you_mean
from crowdbot.falsification import CrossEntropy, PlainSampling, Splitting
from crowdbot.generation import FORMATS, RECIPES
from crowdbot.prediction import WEIGHTS_FIELDS
from crowdbot.trials import builtin_trials
from crowdbot.web.prediction.example_recordings import EXAMPLES, copy_example
from crowdbot.web.workspace import Workspace

Row = dict[str, Any]

RECORDINGS = (".txt", ".csv", ".tsv", ".parquet", ".mcap", ".json", ".ndjson", ".h5", ".hdf5", ".bag", ".vsp")
"""Endings of files that may be recordings of people."""
MOST_RUNS = 1_000_000


@dataclass(frozen=True)
class JobForm:
    """A kind of job.

    Fields:
        title, about: for the page.
        folder: where the results go, a folder each.
        rows: function that returns the fields of the form for a session.
        words: function that returns the words of the command from the values, without ``--out``.
    """

    title: str
    about: str
    folder: str
    rows: Callable[[Workspace], list[Row]]
    words: Callable[[Workspace, Mapping[str, Any]], list[str]]


def check_text(text: str, what: str) -> str:
    """Return a text of a form that may name built-in parts and files of the session only.

    Raises:
        InputError: it names a file elsewhere, or is too long.
    """
    if len(text) > 1000 or any(ord(one) < 32 for one in text):
        raise InputError(f"{what} = {text!r:.60}: expected at most 1000 characters in one line")
    for piece in re.split(r"[\s,;=:]+", text):
        if piece.startswith(("/", "~", "\\")) or ".." in piece.replace("\\", "/").split("/"):
            raise InputError(f"{what}: file {piece!r:.80} is outside the folder of the app")
    return text


def results_name(name: str) -> str:
    """Return a name for a folder of results, checked.

    Raises:
        InputError: it holds other characters.
    """
    if not re.fullmatch(r"[\w-][\w. -]{0,60}", name):
        raise InputError(f"name of the results = {name!r:.60}: expected 1 to 60 letters, digits, - and _")
    return name


def read_values(form: JobForm, workspace: Workspace, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a form, checked against its rows; missing ones have their defaults.

    Raises:
        InputError: a name is unknown, or a value is not of its kind.
    """
    rows = {row["name"]: row for row in form.rows(workspace)}
    wrong = next((name for name in values if name not in rows), None)
    if wrong is not None:
        raise InputError(f"{form.title} has no setting {wrong!r:.40}{did_you_mean(wrong, rows)}")
    return {name: _read(row, values.get(name, row.get("value"))) for name, row in rows.items()}


def _read(row: Row, value: Any) -> Any:
    name, kind = row["label"], row["kind"]
    if kind == "switch" and isinstance(value, bool):
        return value
    if kind == "whole" and isinstance(value, int) and not isinstance(value, bool):
        if not row.get("low", 0) <= value <= row.get("high", MOST_RUNS):
            raise InputError(f"{name} = {value}: expected {row.get('low', 0)} to {row.get('high', MOST_RUNS)}")
        return value
    if kind == "text" and isinstance(value, str):
        return check_text(value.strip(), name)
    choices = [one[0] if isinstance(one, list | tuple) else one for one in row.get("choices", ())]
    if kind == "choice" and value in choices:
        return value
    if kind == "several" and isinstance(value, list) and all(one in choices for one in value):
        if not value:
            raise InputError(f"{name}: choose at least one")
        return value
    raise InputError(f"{name} = {value!r:.60} is not a value of this setting")


def _trials(space: Workspace) -> list[str]:
    files = [one for one in space.trials() if not one.startswith(("sessions/", "evaluations/"))]
    return [*files, *builtin_trials()]


def _recordings(space: Workspace) -> list[tuple[str, str]]:
    skipped = ("sessions/", "examples/", "trainings/", "evaluations/", "generated/")
    names = [one for one in space.files() if one.endswith(RECORDINGS) and not one.startswith(skipped)]
    return [*((one, one) for one in names), *((f"example:{one}", f"{one} (example)") for one in EXAMPLES)]


def _train_rows(space: Workspace) -> list[Row]:
    return [
        _choice("predictor", "Predictor", list(WEIGHTS_FIELDS)),
        {"name": "data", "label": "Recordings", "kind": "several", "value": [], "choices": _recordings(space)},
        _whole("epochs", "Epochs", 100, 1, 100_000),
        _whole("seed", "Seed", 0, 0, 2**31),
        _text("name", "Name of the results", "first"),
    ]


def _train_words(space: Workspace, values: Mapping[str, Any]) -> list[str]:
    data = [copy_example(space, one[8:]) if one.startswith("example:") else one for one in values["data"]]
    return ["train", values["predictor"], "--data", *data, *_numbers(values, "epochs", "seed")]


def _generate_rows(space: Workspace) -> list[Row]:
    sources = [*((name, f"{name} (recipe)") for name in RECIPES), *((name, name) for name in _trials(space))]
    note = "presets on the first robot, separated by commas: sick-tim571, front=realsense-d435"
    return [
        {"name": "sources", "label": "Trials or a recipe", "kind": "several", "value": [], "choices": sources},
        _text("seeds", "Seeds", "0:10"),
        {**_text("sensors", "Sensors", ""), "note": note},
        _switch("noise", "Noise of the products"),
        _choice("format", "File format", list(FORMATS)),
        _switch("coco", "Colour images with boxes and masks (COCO)"),
        _text("name", "Name of the results", "first"),
    ]


def _generate_words(space: Workspace, values: Mapping[str, Any]) -> list[str]:
    sensors = [f"--sensors={values['sensors']}"] if values["sensors"] else []
    switches = [f"--{name}" for name in ("noise", "coco") if values[name]]
    return ["generate", *values["sources"], f"--seeds={values['seeds']}", *sensors, *switches,
            f"--format={values['format']}"]  # fmt: skip


def _falsify_rows(space: Workspace) -> list[Row]:
    own = [kind.name for kind in (CrossEntropy, Splitting, PlainSampling)]
    searches = [*own, *builtin_classes(calibration, calibration.Search)]
    over = "value that varies, such as agent[1]/speed=uniform(0.8,1.6); several: separated by ;"
    failure = "collision, timeout, severity, any, or a requirement such as min-clearance>0.2"
    return [
        _choice("trial", "Trial", _trials(space), "frontal"),
        {**_text("navigator", "Navigator", "own"), "note": 'own, or with parameters: "orca safety=0.15"'},
        {**_text("robots", "Robot", ""), "note": "robot type or robot folder (default: that of the trial)"},
        {**_text("over", "Values that vary", ""), "note": over},
        {**_text("failure", "Failure", "collision"), "note": failure},
        _choice("search", "Search", searches),
        _whole("runs", "Runs", 1000, 1, MOST_RUNS),
        _whole("seed", "Seed", 0, 0, 2**31),
        _text("name", "Name of the results", "first"),
    ]


def _falsify_words(space: Workspace, values: Mapping[str, Any]) -> list[str]:
    over = [f"--over={one.strip()}" for one in values["over"].split(";") if one.strip()]
    plain = [f"--{name}={values[name]}" for name in ("navigator", "robots", "failure", "search") if values[name]]
    return ["falsify", values["trial"], *plain, *over, *_numbers(values, "runs", "seed")]


def _numbers(values: Mapping[str, Any], *names: str) -> list[str]:
    return [f"--{name}={values[name]}" for name in names]


def _choice(name: str, label: str, choices: list[str], value: str | None = None) -> Row:
    return {"name": name, "label": label, "kind": "choice", "value": value or choices[0], "choices": choices}


def _whole(name: str, label: str, value: int, low: int, high: int) -> Row:
    return {"name": name, "label": label, "kind": "whole", "value": value, "low": low, "high": high}


def _text(name: str, label: str, value: str) -> Row:
    return {"name": name, "label": label, "kind": "text", "value": value}


def _switch(name: str, label: str) -> Row:
    return {"name": name, "label": label, "kind": "switch", "value": False}


FORMS = {
    "train": JobForm(
        "Train a predictor", "AnchorNet or Social Ways on recordings of people.", "trainings", _train_rows, _train_words
    ),
    "generate": JobForm(
        "Generate data", "Sensor readings with the true people, from trials and many seeds.",
        "generated", _generate_rows, _generate_words,
    ),
    "falsify": JobForm(
        "Search for failures", "Values of a trial with which its navigator fails, and how likely they are.",
        "falsifications", _falsify_rows, _falsify_words,
    ),
}  # fmt: skip
"""Kinds of jobs that the tab of jobs starts."""
