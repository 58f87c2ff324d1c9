"""Files that crowdbot 0.1.0 wrote, what it read in them, and how the tests compare."""

from __future__ import annotations

import hashlib
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.typing import ArrayLike

from builtin_digests import differences, level
from crowdbot.cli import main

FILES = Path(__file__).parent / "files"
EXPECTED: dict[str, Any] = json.loads((FILES / "expected.json").read_text(encoding="utf-8"))
SAME_MACHINE = level() == "x86-64-v3" and not differences(EXPECTED["machine"])
"""Whether processor and libraries are those of 0.1.0 then; only in that case runs are equal to the last bit."""


def array_hash(*arrays: ArrayLike) -> str:
    """Return the hash of arrays: shapes, and their numbers as little-endian doubles."""
    content = hashlib.blake2b(digest_size=16)
    for array in arrays:
        whole = np.ascontiguousarray(array, dtype="<f8")
        content.update(repr(whole.shape).encode() + whole.tobytes())
    return content.hexdigest()


def describe(table: pd.DataFrame) -> dict[str, Any]:
    """Return columns, number of rows and hash of the numbers of a table."""
    numbers = table.select_dtypes("number").to_numpy(dtype=float)
    return {"columns": list(table.columns), "rows": len(table), "numbers": array_hash(numbers)}


def copy(name: str, folder: Path) -> Path:
    """Return a copy of files that a command may change."""
    place = folder / Path(name).name
    if (FILES / name).is_dir():
        shutil.copytree(FILES / name, place)
    else:
        shutil.copy(FILES / name, place)
    return place


def command_json(capsys: pytest.CaptureFixture[str], *words: object) -> Any:
    """Run a command and return the JSON that it prints."""
    capsys.readouterr()
    assert main([*map(str, words), "--json"]) == 0, capsys.readouterr().err
    return json.loads(capsys.readouterr().out)


def assert_same(found: Any, expected: Any, *ignore: str) -> None:
    """Compare JSON: every key of the earlier version exists and has the same value, except durations."""
    if isinstance(expected, dict):
        kept = {key: value for key, value in expected.items() if "seconds" not in key and key not in ignore}
        assert set(kept) <= set(found)
        for key, value in kept.items():
            assert_same(found[key], value, *ignore)
    elif isinstance(expected, list):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            assert_same(one, other, *ignore)
    elif isinstance(expected, float):
        assert found == pytest.approx(expected, rel=1e-6, abs=1e-9, nan_ok=True)
    else:
        assert found == expected
