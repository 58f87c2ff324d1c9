"""Forms of jobs: what is asked, and the words of the command line that it gives."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

from crowdbot import calibration, perception
from crowdbot.core import InputError, builtin_classes, did_you_mean
from crowdbot.evaluation import STRATA
from crowdbot.falsification import CrossEntropy, PlainSampling, Splitting
from crowdbot.generation import FORMATS, RECIPES
from crowdbot.measurement import METHODS
from crowdbot.prediction import WEIGHTS_FIELDS
from crowdbot.trials import builtin_trials
from crowdbot.web.prediction.example_recordings import EXAMPLES, copy_example
from crowdbot.web.recording_rows import check_options, option_words, recording_rows
from crowdbot.web.workspace import Workspace

Row = dict[str, Any]

RECORDINGS = (
    ".txt", ".csv", ".tsv", ".parquet", ".mcap", ".json", ".ndjson", ".h5", ".hdf5", ".bag", ".vsp", ".db3", ".sqlite",
    ".traj", ".pp", ".fzp", ".gz",
)  # fmt: skip
"""Endings of files that may be recordings of people."""
SCANS = (".mcap", ".h5", ".hdf5", ".bag", ".db3")
"""Endings of files that may be episodes or recorded scans."""
TRACKS = "tracks/"
"""Folder of the tracks of people that jobs have found."""
MOST_RUNS = 1_000_000


@dataclass(frozen=True)
class JobForm:
    """A kind of job.

    Fields:
        title, about: for the page.
        folder: where the results go, a folder each; empty if the command names its files itself.
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
    if len(text) > 1000 or any(ord(item) < 32 for item in text):
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
    if kind == "number" and (value is None or (isinstance(value, int | float) and not isinstance(value, bool))):
        if value is not None and not (math.isfinite(value) and value >= row.get("low", -math.inf)):
            raise InputError(f"{name} = {value}: expected a number from {row.get('low', 0)}")
        return value
    if kind == "text" and isinstance(value, str):
        return check_text(value.strip(), name) if row.get("names_files", True) else value.strip()
    choices = [item[0] if isinstance(item, list | tuple) else item for item in row.get("choices", ())]
    if kind == "choice" and value in choices:
        return value
    if kind == "several" and isinstance(value, list) and all(item in choices for item in value):
        if not value:
            raise InputError(f"{name}: choose at least one")
        return value
    raise InputError(f"{name} = {value!r:.60} is not a value of this setting")


def _trials(space: Workspace) -> list[str]:
    files = [trial for trial in space.trials() if not trial.startswith(("sessions/", "evaluations/"))]
    return [*files, *builtin_trials()]


def _recordings(space: Workspace) -> list[tuple[str, str]]:
    skipped = ("sessions/", "examples/", "trainings/", "measurements/", "evaluations/", "generated/", "falsifications/")
    files = [file for file in space.files() if not file.startswith(skipped)]
    tracks = [file for file in files if file.startswith(TRACKS) and file.endswith(".csv")]
    names = [file for file in files if file.endswith(RECORDINGS) and not file.startswith(TRACKS)]
    held = Counter(PurePosixPath(name).parent.as_posix() for name in names)
    folders = [
        (item, f"{item}/ ({count} files as one recording)") for item, count in held.items() if item != "." and count > 1
    ]
    examples = [(f"example:{item}", f"{item} (example)") for item in EXAMPLES]
    return [*((name, name) for name in (*names, *tracks)), *folders, *examples]


def _paths(space: Workspace, names: list[str]) -> list[str]:
    """Return recordings of a form as paths; an example is copied."""
    return [copy_example(space, name[8:]) if name.startswith("example:") else name for name in names]


def _several_recordings(space: Workspace) -> Row:
    choices = _recordings(space)
    return {"name": "data", "label": "Recordings", "kind": "several", "value": [], "choices": choices}


def _one_recording(space: Workspace) -> Row:
    choices = _recordings(space)
    return {"name": "data", "label": "Recording", "kind": "choice", "value": choices[0][0], "choices": choices}


def _train_rows(space: Workspace) -> list[Row]:
    return [
        _choice("predictor", "Predictor", list(WEIGHTS_FIELDS)),
        _several_recordings(space),
        _whole("epochs", "Epochs", 100, 1, 100_000),
        _whole("seed", "Seed", 0, 0, 2**31),
        _text("name", "Name of the results", "first"),
        *recording_rows(space),
    ]


def _train_words(space: Workspace, values: Mapping[str, Any]) -> list[str]:
    return [
        "train", values["predictor"], "--data", *_paths(space, values["data"]), *_numbers(values, "epochs", "seed"),
        *option_words(check_options(values)),
    ]  # fmt: skip


def _recorded_rows(space: Workspace) -> list[Row]:
    return [
        _one_recording(space),
        _choice("mode", "People", ["scripted", "reactive"]),
        {"name": "replace", "label": "Id of the person that a robot replaces", "kind": "number", "value": None,
         "step": 1, "note": "empty: there is no robot"},
        _text("name", "Name of the trial", "recorded"),
        *recording_rows(space, "all"),
    ]  # fmt: skip


def _recorded_words(space: Workspace, values: Mapping[str, Any]) -> list[str]:
    (path,) = _paths(space, [values["data"]])
    reactive = ["--reactive"] if values["mode"] == "reactive" else []
    if values["replace"] is not None and values["replace"] != int(values["replace"]):
        raise InputError(f"Id of the person = {values['replace']}: expected a whole number")
    replace = [] if values["replace"] is None else [f"--replace={int(values['replace'])}"]
    options = option_words(check_options(values), "all")
    return ["new", "trial", f"{values['name']}.xml", f"--recorded={path}", *reactive, *replace, *options]


def _robot_rows(space: Workspace) -> list[Row]:
    return [
        {"name": "robot_id", "label": "Id of the robot", "kind": "text", "value": "", "note": "empty: the only robot"},
        {"name": "robot_file", "label": "Recording of the robot", "kind": "choice", "value": "",
         "choices": [("", "in the recording of people"), *_recordings(space)]},
        {"name": "robot_radius", "label": "Radius of the robot", "kind": "number", "value": 0.3, "low": 0, "unit": "m"},
        {**_text("goal", "Goal of the robot", ""), "note": "x and y, such as 8 -1.5; empty: its last position"},
    ]  # fmt: skip


def _robot_words(space: Workspace, values: Mapping[str, Any]) -> list[str]:
    """Return the options of the robot and of the recordings."""
    words = [f"--robot-id={values['robot_id']}"] if values["robot_id"] else []
    if values["robot_file"]:
        words += ["--robot-file", *_paths(space, [values["robot_file"]])]
    words += [] if values["robot_radius"] is None else [f"--robot-radius={values['robot_radius']}"]
    goal = _metres(values, "goal", "Goal of the robot", "two numbers, x and y", lambda count: count == 2)
    return [*words, *goal, *option_words(check_options(values), "all")]


def _metres(
    values: Mapping[str, Any], name: str, label: str, expected: str, allowed: Callable[[int], bool]
) -> list[str]:
    """Return the option of coordinates [m] that are separated by spaces or commas; nothing for an empty text."""
    words = values[name].replace(",", " ").split()
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    if words and not (allowed(len(numbers)) and all(map(math.isfinite, numbers))):
        raise InputError(f"{label} = {values[name]!r:.60}: expected {expected}")
    return [f"--{name}", *map(str, numbers)] if words else []


def _measure_rows(space: Workspace) -> list[Row]:
    methods = [("", "all possible"), *((name, f"{name}: {about}") for name, about in METHODS.items())]
    return [
        _several_recordings(space),
        {"name": "methods", "label": "Methods", "kind": "choice", "value": "", "choices": methods},
        {**_text("area", "Measurement area [m]", ""), "note": "corners x y x y ...; empty: the walkable area"},
        {**_text("line", "Line for the flow [m]", ""), "note": "x1 y1 x2 y2; empty: none"},
        {**_text("walkable", "Walkable area [m]", ""),
         "note": "corners x y x y ...; empty: walls of the recording, or the box of all positions and 1 m"},
        _choice("axis", "Coordinate along the corridor", ["x", "y"]),
        _text("name", "Name of the results", "first"),
        *recording_rows(space, "all"),
    ]  # fmt: skip


def _measure_words(space: Workspace, values: Mapping[str, Any]) -> list[str]:
    words = ["measure", *_paths(space, values["data"]), f"--axis={values['axis']}"]
    words += ["--methods", values["methods"]] if values["methods"] else []
    corners = "corners, an x and a y for each of at least three"
    for name, label in (("area", "Measurement area"), ("walkable", "Walkable area")):
        words += _metres(values, name, label, corners, lambda count: count >= 6 and count % 2 == 0)
    words += _metres(values, "line", "Line for the flow", "four numbers, x1 y1 x2 y2", lambda count: count == 4)
    return [*words, *option_words(check_options(values), "all")]


def _scans(space: Workspace) -> list[str]:
    """Return files and folders that may be episodes or recorded scans: also tables of DROW and folders of L-CAS."""
    files = [file for file in space.files() if not file.startswith(("sessions/", "examples/"))]
    tables = [file for file in files if file.endswith(".csv") and f"{file[:-3]}wp" in files]
    clouds = dict.fromkeys(PurePosixPath(file).parent.as_posix() for file in files if file.endswith(".pcd"))
    return [*(file for file in files if file.endswith(SCANS)), *tables, *clouds]


def _track_rows(space: Workspace) -> list[Row]:
    detectors, trackers = (
        {"kind": "several", "choices": list(builtin_classes(perception, kind))}
        for kind in (perception.Detector, perception.Tracker)
    )
    return [
        _choice("source", "Trial, episode or recorded scans", [*_scans(space), *_trials(space)], "crossing-flows"),
        {"name": "detector", "label": "Detectors", "value": ["lidar-clusters"], **detectors},
        {**_text("set", "Values of the detector", ""), "note": "such as max_range=8; empty: as they are"},
        {"name": "tracker", "label": "Trackers", "value": ["global-nearest-neighbor"], **trackers},
        {**_text("sensor", "Sensor", ""), "note": "ROBOT/SENSOR, or the topic of a bag; empty: the first",
         "names_files": False},
        _whole("starts", "Runs of a trial", 1, 1, 1000),
        {"name": "duration", "label": "Duration", "kind": "number", "value": None, "low": 0, "unit": "s",
         "note": "empty: all"},
        {"name": "by", "label": "Scores by", "kind": "choice", "value": "",
         "choices": [("", "all people together"), *((name, name) for name in STRATA)]},
        _switch("no_map", "The detector does not know the walls"),
        _switch("match_scans", "Recorded scans: estimate the motion of the scanner"),
        _switch("nobody", "Recorded scans: nobody is there"),
        _text("name", "Name of the results", "first"),
    ]  # fmt: skip


def _track_words(space: Workspace, values: Mapping[str, Any]) -> list[str]:
    words = ["track", values["source"], "--detector", *values["detector"], "--tracker", *values["tracker"]]
    words += [f"--set={item}" for item in values["set"].split()]
    words += [f"--{name}={values[name]}" for name in ("sensor", "duration", "by") if values[name] not in ("", None)]
    words += [f"--starts={values['starts']}"] if values["starts"] > 1 else []
    return [*words, *(f"--{name.replace('_', '-')}" for name in ("no_map", "match_scans", "nobody") if values[name])]


def _logs_rows(space: Workspace) -> list[Row]:
    name = _text("name", "Name of the results", "first")
    return [_several_recordings(space), *_robot_rows(space), name, *recording_rows(space, "all")]


def _logs_words(space: Workspace, values: Mapping[str, Any]) -> list[str]:
    return ["evaluate", "--logs", *_paths(space, values["data"]), *_robot_words(space, values)]


def _real_rows(space: Workspace) -> list[Row]:
    return [
        _one_recording(space),
        {**_text("navigator", "Navigators", "own"), "note": "own: the recorded path; or such as orca,stop"},
        _text("seeds", "Seeds", "0:100"),
        *_robot_rows(space),
        _text("name", "Name of the results", "first"),
        *recording_rows(space, "all"),
    ]


def _real_words(space: Workspace, values: Mapping[str, Any]) -> list[str]:
    own = [f"--navigators={values['navigator']}", f"--seeds={values['seeds']}"]
    return ["evaluate", "--real", *_paths(space, [values["data"]]), *own, *_robot_words(space, values)]


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
    over = [f"--over={item.strip()}" for item in values["over"].split(";") if item.strip()]
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
    "recorded": JobForm(
        "Trial from a recording", "A trial whose people are those of a recording, as a file of the folder.",
        "", _recorded_rows, _recorded_words,
    ),
    "measure": JobForm(
        "Measure people", "Density, speed, flow and encounters of people in recordings, as tables and plots.",
        "measurements", _measure_rows, _measure_words,
    ),
    "track": JobForm(
        "Track people", "People in the scans of a trial, an episode or a scanner: tracks as a recording, and scores.",
        TRACKS.rstrip("/"), _track_rows, _track_words,
    ),
    "logs": JobForm(
        "Measure recordings of robots", "Metrics of recordings of robots among people.",
        "evaluations", _logs_rows, _logs_words,
    ),
    "real": JobForm(
        "Recording and simulations", "Where a recording of a robot lies among simulations of the same place.",
        "evaluations", _real_rows, _real_words,
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
