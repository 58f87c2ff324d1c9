"""Program that reads an HDF5 file in a process of its own: ``python hdf5_program.py FILE SECONDS MOST [NAME ...]``.

Without names it reads the table ``trajectory``, otherwise the arrays of numbers with these names at the root.

The HDF5 library can loop without end in a damaged file. A loop in C cannot be interrupted from Python, so the process
has a limit of its CPU time. It imports only h5py and numpy, and writes an ``.npz`` to standard output.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np

COLUMNS = ("id", "frame", "x", "y")


def limit_cpu_time(seconds: int) -> None:
    """End this process after ``seconds`` of CPU time, where the system can do that; the caller has a limit too."""
    if sys.platform != "win32":
        import resource

        hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
        soft = seconds if hard == resource.RLIM_INFINITY else min(seconds, hard)
        resource.setrlimit(resource.RLIMIT_CPU, (soft, hard))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def read_table(path: str, max_rows: int) -> tuple[dict[str, Any], dict[str, np.ndarray[Any, Any]]]:
    """Return what the file holds, and the columns of its table ``trajectory`` if they are complete."""
    import h5py

    with h5py.File(path, "r") as file:
        if not isinstance(file.get("trajectory"), h5py.Dataset):
            return {"held": sorted(file)}, {}
        table = file["trajectory"]
        names = list(table.dtype.names or ())
        about = {"names": names, "rows": int(table.size)}
        if table.size > max_rows or not {*COLUMNS} <= {*names}:
            return about, {}
        fps, area = table.attrs.get("fps", file.attrs.get("fps")), file.attrs.get("wkt_geometry")
        about["fps"] = None if fps is None else str(fps.item() if isinstance(fps, np.generic) else fps)
        about["unit"] = str(table.attrs.get("x", ""))
        about["area"] = None if area is None else str(area)
        return about, {name: np.asarray(table[name]) for name in COLUMNS}


def read_arrays(path: str, max_values: int, names: list[str]) -> tuple[dict[str, Any], dict[str, np.ndarray[Any, Any]]]:
    """Return what the file holds, and its arrays of numbers with some names if all are there and not too large."""
    import h5py

    with h5py.File(path, "r") as file:
        known = {name: file.get(name) for name in names}
        found = {k: item for k, item in known.items() if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu"}
        sizes = {name: int(one.size) for name, one in found.items()}
        about = {"held": sorted(file)[:20], "values": sizes}
        if len(found) < len(names) or sum(sizes.values()) > max_values:
            return about, {}
        return about, {name: np.asarray(one[()]) for name, one in found.items()}


def main() -> None:
    """Read the file of the command line; an exception is part of the answer."""
    path, seconds, most, names = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4:]
    limit_cpu_time(seconds)
    columns: dict[str, Any] = {}
    try:
        about, columns = read_arrays(path, most, names) if names else read_table(path, most)
    except Exception as error:  # h5py raises many kinds for damaged files
        about = {"error": " ".join(str(error).split()) or type(error).__name__}
    np.savez(sys.stdout.buffer, about=np.array(json.dumps(about)), **columns)


if __name__ == "__main__":
    main()
