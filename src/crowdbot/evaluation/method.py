"""Method: a navigator, and optionally a robot, put into a trial in place of its own."""

from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from crowdbot.core import Element, InputError, TrialError, format_xml
from crowdbot.trials import Trial, element_from, parse_trial, remarks_at_end, replace_robot

OWN = "own"
"""Name of the method that leaves the navigator of a trial as it is."""
SAFETY = "+safety"
"""End of the name of a method whose robot has a safety layer."""
SETTING = re.compile(r"([A-Za-z][\w-]*)=(\S+)")


@dataclass(frozen=True)
class Method:
    """A navigator with its parameters.

    Fields:
        name: text of the method, such as ``orca time-horizon=3``; ``own`` is the navigator of the trial.
        type: name of a navigator, or a class in a file: ``mine.py:Mine``.
        parameters: texts by name of the parameter.
        safety: whether the robot has a safety layer; None as in the trial.

    >>> parse_methods("orca, orca time-horizon=3, own")[1]
    Method(name='orca time-horizon=3', type='orca', parameters=(('time-horizon', '3'),), safety=None)
    >>> parse_methods("orca+safety")[0].safety
    True
    """

    name: str
    type: str = ""
    parameters: tuple[tuple[str, str], ...] = ()
    safety: bool | None = None

    @remarks_at_end()
    def put_into(self, trial: Trial, robot_type: str = "", trust: bool = True, folder: Path | None = None) -> Trial:
        """Return the trial with this navigator for its first robot.

        Args:
            trial: the trial; it needs a robot.
            robot_type: another type for the robot, such as ``pepper`` or a robot folder; empty: as in the trial.
                Its body, drive and sensors replace those of the trial, see
                :func:`crowdbot.trials.replace_robot`.
            trust: whether code from outside the folder of the trial may be loaded.
            folder: folder that names of robot folders and of code start from (default: the working folder). What lies
                in a folder that is given may be loaded, also if it is outside the folder of the trial.

        Raises:
            InputError: the trial has no robot.
            TrialError: there is no such navigator, parameter or robot, or the trial is impossible with it.
        """
        if not trial.robots:
            raise InputError(f"trial {trial.name!r} has no robot to evaluate")
        if not self.type and not robot_type and self.safety is None:
            return trial
        root = element_from("trial", trial, trial.folder)
        robot = next(child for child in root.children if child.tag == "robot")
        if self.type:
            robot.children = [child for child in robot.children if child.tag != "navigator"]
            robot.children.append(self._element(trial.folder, folder))
        if self.safety is not None:
            had = [child for child in robot.children if child.tag == "safety"]
            robot.children = [child for child in robot.children if child.tag != "safety"]
            robot.children += (had or [Element("safety")]) if self.safety else []
        if robot_type:
            replace_robot(robot, _relative(robot_type, trial.folder, folder))
        files = [value for _, value in self.parameters if _is_file_name(value)]
        trust = trust or _all_inside((self.type, robot_type, *files), trial.folder, folder)
        place = f"trial {trial.name!r} with {self.name!r}" + (f" on {robot_type!r}" if robot_type else "")
        try:
            new = parse_trial(format_xml(root), place=place, folder=trial.folder, trust=trust)
        except TrialError as error:
            raise TrialError(*(re.sub(r":\d+:", ":", str(line), count=1) for line in error.args)) from None
        return dataclasses.replace(new, name=trial.name)

    def _element(self, folder: Path | None, base: Path | None) -> Element:
        element = Element("navigator")
        element.attributes["type"] = _relative(self.type, folder, base)
        for name, value in self.parameters:
            element.attributes[name] = _relative(value, folder, base) if _is_file_name(value) else value
        return element


def parse_methods(text: str) -> tuple[Method, ...]:
    """Return the methods of a list, separated by commas; parameters follow the name, separated by blanks.

    ``orca+safety`` puts a safety layer around ``orca``.

    Raises:
        InputError: the list is empty, has a method twice, or a parameter is not ``name=value``.

    >>> [method.name for method in parse_methods("orca, orca safety=0.2, mpc+safety")]
    ['orca', 'orca safety=0.2', 'mpc+safety']
    """
    methods = tuple(_parse_method(part) for part in text.split(",") if part.strip())
    if not methods:
        raise InputError(f"navigators = {text!r} is empty; an example is 'orca, mine.py:Mine speed=0.8'")
    names = [method.name for method in methods]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"navigators: {name!r} is there twice")
    return methods


def with_safety(methods: Sequence[Method]) -> tuple[Method, ...]:
    """Return each method without a safety layer, then with it; those that end with ``+safety`` only with it.

    >>> [method.name for method in with_safety(parse_methods("orca, mpc+safety"))]
    ['orca', 'orca+safety', 'mpc+safety']
    """
    found = []
    for method in methods:
        if method.safety:
            found.append(method)
            continue
        kind, *settings = method.name.split()
        guarded = dataclasses.replace(method, name=" ".join([kind + SAFETY, *settings]), safety=True)
        found += [dataclasses.replace(method, safety=False), guarded]
    return tuple({method.name: method for method in found}.values())


def own_method() -> Method:
    """Return the method that leaves the navigator of a trial as it is."""
    return Method(OWN)


def _parse_method(text: str) -> Method:
    kind, *settings = text.split()
    bare = kind.removesuffix(SAFETY)
    safety = True if bare != kind else None
    if bare == OWN and not settings:
        return Method(kind, safety=safety)
    parameters = []
    for setting in settings:
        match = SETTING.fullmatch(setting)
        if match is None:
            raise InputError(f"navigator {text.strip()!r}: {setting!r} must be name=value, such as time-horizon=3")
        parameters.append((match[1], match[2]))
    return Method(" ".join([kind, *settings]), bare, tuple(parameters), safety)


def _is_file_name(value: str) -> bool:
    """Return whether the value of a parameter looks like a file: it has an ending and is no number."""
    try:
        float(value)
    except ValueError:
        return bool(Path(value).suffix)
    return False


def _relative(name: str, folder: Path | None, base: Path | None) -> str:
    """Return the address of a file in the base, by default the working folder, as seen from the folder of the trial."""
    file, colon, rest = name.partition(":")
    place = (base or Path()) / file
    if folder is None or not (os.path.isfile(place) or (not colon and os.path.isdir(place))):
        return name
    return f"{Path(os.path.relpath(place.resolve(), folder.resolve())).as_posix()}{colon}{rest}"


def _all_inside(names: Sequence[str], folder: Path | None, base: Path | None) -> bool:
    """Return whether some names are outside the folder of the trial, and all of those inside the base."""
    if folder is None or base is None:
        return False
    files = [_relative(name, folder, base).partition(":")[0] for name in names if name]
    outside = [place for file in files if not (place := (folder / file).resolve()).is_relative_to(folder.resolve())]
    return bool(outside) and all(place.is_relative_to(base.resolve()) for place in outside)
