"""File templates of ``crowdbot new``, with their contract tests."""

from __future__ import annotations

import importlib.resources
import keyword
import re
import string
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import InputError

__all__ = [
    "CLASSES",
    "FOLLOW_UP",
    "challenge_files",
    "class_files",
    "robot_files",
    "stage_files",
    "submission_files",
    "trial_test",
]


class ClassKind(NamedTuple):
    """A kind of user-defined class: room, folder of built-in classes, contract and contract check."""

    room: str
    plugins: str
    contract: str
    check: str


CLASSES = {
    "model": ClassKind("models", "models", "models.CrowdModel", "models.check_model"),
    "predictor": ClassKind("prediction", "prediction", "prediction.Predictor", "prediction.check_predictor"),
    "sensor": ClassKind("sensors", "sensors", "sensors.Sensor", "sensors.check_sensor"),
    "goal": ClassKind("models", "models.goals", "models.Goal", "models.check_goal"),
    "cost": ClassKind("calibration", "calibration", "calibration.Cost", "calibration.check_cost"),
    "metric": ClassKind("metrics", "metrics", "metrics.LogMetric", "metrics.check_log_metric"),
    "navigator": ClassKind("navigation", "navigation", "navigation.Navigator", "navigation.check_navigator"),
}
FOLLOW_UP = {
    "model": "crowdbot predict --data DATA --predictor simulated --model {address}",
    "predictor": "crowdbot predict --data DATA --predictor {address}",
    "sensor": '<sensor name="mine" type="{name}"/> in a <robot> of a trial in the same folder',
    "goal": "crowdbot predict --data DATA --predictor simulated --goal {address}",
    "cost": "crowdbot calibrate --data DATA --cost {address}",
    "navigator": "crowdbot run frontal --set robot/navigator/type={address}",
    "metric": "crowdbot evaluate frontal --seeds 0:2 --metrics success-rate,{address}",
    "robot": '<robot type="{name}" .../> in a trial in the same folder',
    "stage": '<stage area="{name}"/> in a trial in the same folder',
    "trial": "crowdbot run {address}",
    "challenge": "crowdbot challenge run {address} SUBMISSION --out result",
    "submission": "crowdbot challenge run CHALLENGE {address} --out result",
}
"""How each kind is used: by its path, or by its name beside a trial."""


def class_files(kind: str, file: Path) -> dict[Path, str]:
    """Return the text of a Python file with a class of a kind, and of its contract test.

    Raises:
        InputError: the file name is not a Python module name.

    >>> [path.name for path in class_files("navigator", Path("shy_robot.py"))]
    ['shy_robot.py', 'test_shy_robot.py']
    """
    stem = file.stem
    if file.suffix != ".py" or not stem.isidentifier() or keyword.iskeyword(stem) or stem.startswith("test_"):
        raise InputError(f"{file.name!r} is not a Python module name; use a name such as my_{kind}.py")
    name = "".join(word[:1].upper() + word[1:] for word in stem.split("_"))
    part = CLASSES[kind]
    test = _test_file(file)
    values = {**part._asdict(), "name": name, "file": file.name, "test": test.name, "stem": stem}
    return {file: _fill(f"{kind}.txt", name=name), test: _fill("class.test.txt", **values)}


def robot_files(folder: Path) -> dict[Path, str]:
    """Return the files of a robot: URDF, ``robot.xml`` and, beside the folder, its contract test.

    Raises:
        InputError: the folder name is not a valid robot name.
    """
    name = folder.name
    if not re.fullmatch(r"[A-Za-z][\w-]*", name):
        raise InputError(f"{name!r} is not a valid robot name; use letters, digits, - and _")
    test = folder.parent / f"test_{_identifier(name)}.py"
    return {
        folder / f"{name}.urdf": _fill("robot.urdf.txt", name=name),
        folder / "robot.xml": _fill("robot.xml.txt", name=name),
        test: _fill("robot.test.txt", name=name, stem=_identifier(name), test=test.name),
    }


def stage_files(file: Path) -> dict[Path, str]:
    """Return the text of a GeoJSON area and of its contract test."""
    if file.suffix not in (".geojson", ".json"):
        raise InputError(f"{file.name!r} must end in .geojson, since a stage is a walkable area")
    return {file: _fill("stage.txt"), **_named_test("stage.test.txt", file)}


def challenge_files(file: Path) -> dict[Path, str]:
    """Return the text of a challenge and of its contract test."""
    if file.suffix != ".toml":
        raise InputError(f"{file.name!r} must end in .toml, since a challenge is a TOML file")
    return {file: _fill("challenge.txt", title=_title(file.stem)), **_named_test("challenge.test.txt", file)}


def submission_files(folder: Path) -> dict[Path, str]:
    """Return the files of a submission: its description, a navigator and, beside the folder, its contract test."""
    stem = _identifier(folder.name)
    (file, code), _ = class_files("navigator", Path(f"{stem}.py")).items()
    cls = "".join(word[:1].upper() + word[1:] for word in stem.split("_"))
    return {
        folder / "submission.toml": _fill("submission.txt", title=_title(folder.name), stem=stem, cls=cls),
        folder / file: code,
        **_named_test("submission.test.txt", folder),
    }


def _title(name: str) -> str:
    return name.replace("-", " ").replace("_", " ").capitalize()


def trial_test(file: Path) -> dict[Path, str]:
    """Return the contract test of a trial file."""
    return _named_test("trial.test.txt", file)


def _named_test(template: str, file: Path) -> dict[Path, str]:
    test = _test_file(file)
    return {test: _fill(template, file=file.name, stem=_identifier(file.stem), test=test.name)}


def _test_file(file: Path) -> Path:
    return file.with_name(f"test_{_identifier(file.stem)}.py")


def _identifier(text: str) -> str:
    return re.sub(r"\W", "_", text)


def _fill(template: str, **values: str) -> str:
    text = importlib.resources.files("crowdbot").joinpath(f"assets/templates/{template}").read_text(encoding="utf-8")
    return string.Template(text).substitute(values)
