"""Fields of forms for the options of recordings, from the table that also declares those of the command line."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from crowdbot.core import InputError
from crowdbot.data import (
    AGENTS,
    FILE_OPTIONS,
    FORMATS,
    TIME_BASES,
    UNITS,
    check_quantities,
    parse_columns,
    read_homography,
    split_columns,
)

from .workspace import Workspace

Row = dict[str, Any]

LONGEST = 500
"""Largest number of characters of a text."""
MATRICES = (".txt", ".csv", ".dat", ".tsv")
"""Endings of files that may be homographies."""


def recording_rows(space: Workspace, agents: str = "pedestrians") -> list[Row]:
    """Return a field for each option of :data:`crowdbot.data.FILE_OPTIONS`.

    Args:
        space: folder of the session; a homography is one of its files.
        agents: default of ``agents``.

    >>> import tempfile
    >>> rows = recording_rows(Workspace(Path(tempfile.mkdtemp())))
    >>> [row["name"] for row in rows] == list(FILE_OPTIONS)
    True
    """
    choices: dict[str, list[tuple[str, str]]] = {
        "format": [
            ("", FILE_OPTIONS["format"].default),
            *((name, f"{name}: {about}") for name, about in FORMATS.items()),
        ],
        "units": [("", FILE_OPTIONS["units"].default), *((unit, unit) for unit in UNITS)],
        "homography": [("", "none"), *((file, file) for file in space.files() if file.endswith(MATRICES))],
        "time_base": [(name, f"{name}: {about}") for name, about in TIME_BASES.items()],
        "agents": [(name, name) for name in AGENTS],
    }
    defaults = {"time_base": FILE_OPTIONS["time_base"].default, "agents": agents}
    rows = []
    for name, option in FILE_OPTIONS.items():
        about = option.about.partition(", see `")[0]  # the form has the list that the command names
        row: Row = {"name": name, "label": about[:1].upper() + about[1:]}
        if name in choices:
            row |= {"kind": "choice", "value": defaults.get(name, ""), "choices": choices[name]}
        elif option.number:
            row |= {"kind": "number", "value": None, "low": 0, "note": f"empty: {option.default}"}
        else:
            row |= {"kind": "text", "value": "", "note": f"empty: {option.default}", "names_files": False}
        rows.append(row)
    return rows


def check_options(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options of a form that are given, checked: numbers as float, everything else as text.

    Raises:
        InputError: a value is not of its kind, a column has no known quantity, or there are two scales.
    """
    given = {name: values[name] for name in FILE_OPTIONS if values.get(name) not in (None, "")}
    for name, value in given.items():
        if FILE_OPTIONS[name].number:
            if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
                raise InputError(f"{name} = {value!r:.60} must be a number")
            given[name] = float(value)
        elif not isinstance(value, str):
            raise InputError(f"{name} = {value!r:.60} must be a word")
        elif len(value) > LONGEST or any(ord(mark) < 32 for mark in value):
            raise InputError(f"{name} = {value!r:.60}: expected at most {LONGEST} characters in one line")
    if "scale" in given and "homography" in given:
        raise InputError("scale and homography are given; coordinates have one scale")
    check_quantities(dict(parse_columns(split_columns(given.get("columns", "")))))
    return given


def recording_fields(given: Mapping[str, Any], homography: Path | None) -> dict[str, Any]:
    """Return checked options as fields of :class:`crowdbot.data.Recording`.

    Args:
        given: options of :func:`check_options`.
        homography: file of the option ``homography``.

    Raises:
        DataError: the file is not a homography.
    """
    fields = {name: value for name, value in given.items() if name not in ("columns", "scale", "homography")}
    fields["columns"] = parse_columns(split_columns(given.get("columns", "")))
    fields["transform"] = given.get("scale")
    if homography is not None:
        fields["transform"] = tuple(map(tuple, read_homography(homography).tolist()))
    return fields


def option_words(given: Mapping[str, Any], agents: str = "pedestrians") -> list[str]:
    """Return checked options as words of the command line, without those that have their default.

    >>> option_words({"columns": "id=who x=x [cm]", "scale": 0.02, "agents": "all"})
    ['--columns', 'id=who', 'x=x [cm]', '--scale=0.02', '--agents=all']
    """
    defaults = {"time_base": FILE_OPTIONS["time_base"].default, "agents": agents}
    words = []
    for name in FILE_OPTIONS:
        value = given.get(name, defaults.get(name))
        if name == "columns" and value:
            words += ["--columns", *split_columns(value)]
        elif name in given and value != defaults.get(name):
            words.append(f"--{name.replace('_', '-')}={value}")
    return words
