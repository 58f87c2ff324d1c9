"""Contents of HDF5 files, read in a process of its own with a limit of its time; see :mod:`.hdf5_program`."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError

from . import hdf5_program

PROGRAM = hdf5_program.__file__
SECONDS = 8
"""CPU time for reading an HDF5 file [s], and more for a large one:"""
BYTES_PER_SECOND = 20_000_000


def run_hdf5_program(path: Path, max_values: int, names: Sequence[str] = ()) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what the program says about a file, and its arrays.

    Args:
        path: the file.
        max_values: largest number of rows of a table, or of values of all arrays.
        names: arrays to read; default: the columns of the table ``trajectory``.

    Raises:
        DataError: the library does not finish, or the program fails.
        OSError: the library cannot read the file.
    """
    seconds = SECONDS + path.stat().st_size // BYTES_PER_SECOND
    command = [sys.executable, "-P", PROGRAM, os.path.abspath(path), str(seconds), str(max_values), *names]
    try:
        done = subprocess.run(command, capture_output=True, check=False, timeout=10.0 * seconds)  # noqa: S603
    except subprocess.TimeoutExpired:
        done = None
    if done is None or done.returncode < 0:
        raise DataError(f"{path.name} is damaged: the HDF5 library does not finish reading it")
    if done.returncode:
        raise DataError(f"{path.name}: {done.stderr.decode(errors='replace').strip().splitlines()[-1]}")
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as arrays:
        about = json.loads(str(arrays["about"]))
        if "error" in about:
            raise OSError(about["error"])
        return about, {name: arrays[name] for name in arrays.files if name != "about"}


def read_hdf5_arrays(path: Path | str, names: Sequence[str], max_values: int) -> dict[str, NDArray[Any]]:
    """Return arrays of numbers at the root of an HDF5 file by their names.

    Args:
        path: the file.
        names: the arrays.
        max_values: largest number of values of all arrays.

    Raises:
        DataError: the file is missing or damaged, lacks an array of numbers, or is too large.
    """
    file = Path(path)
    try:
        about, arrays = run_hdf5_program(file, max_values, names)
    except OSError as error:
        raise DataError(f"{file} cannot be read as HDF5: {error}") from None
    if lacking := [name for name in names if name not in about["values"]]:
        held = ", ".join(about["held"]) or "nothing"
        raise DataError(f"{file.name} lacks the arrays of numbers {', '.join(lacking)}; it holds {held}")
    total = sum(about["values"].values())
    if total > max_values:
        raise DataError(f"{file.name} has {total} values, more than the limit of {max_values}")
    return arrays
