"""Shards as Parquet files: one for each table, with a row for each sample and lists for its arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray


def write_parquet(
    tables: Mapping[str, Mapping[str, NDArray[Any]]], path: Path, compressed: bool, seeds: Sequence[int]
) -> list[Path]:
    """Write the tables of a shard as ``PATH.TABLE.parquet`` and return the files.

    An array is a list of fixed length in each row; its shape is in the metadata of the column, as are the arrays that
    all rows share. The column ``seed`` has the seed of the run.
    """
    import pyarrow as pa
    from pyarrow import parquet

    files = []
    for name, table in tables.items():
        columns, fields = [], []
        shared = {key[len("shared.") :]: array for key, array in table.items() if key.startswith("shared.")}
        own = {key: array for key, array in table.items() if not key.startswith("shared.")}
        for key, array in {"seed": np.asarray(seeds, dtype=np.int64)[table["episode"]], **own}.items():
            values, shape = pa.array(np.ascontiguousarray(array).reshape(-1)), array.shape[1:]
            column = pa.FixedSizeListArray.from_arrays(values, int(np.prod(shape))) if shape else values
            columns.append(column)
            fields.append(pa.field(key, column.type, metadata={"shape": ",".join(map(str, shape))}))
        notes = {key: ",".join(map(repr, array.astype(float).ravel().tolist())) for key, array in shared.items()}
        file = path.with_name(f"{path.name}.{name.replace('/', '.')}.parquet")
        content = pa.table(columns, schema=pa.schema(fields, metadata=notes))
        parquet.write_table(content, file, compression="zstd" if compressed else "none", use_dictionary=False)
        files.append(file)
    return files
