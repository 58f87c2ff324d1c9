"""A generation of data that is killed at random moments ends with the same files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from killed_runs import FEW, MANY, run_killed

pytestmark = pytest.mark.live

WORDS = ["generate", "crossing-flows", "--set", "duration=2", "--sensors", "sick-tim571@10", "--shard-size", "1"]


@pytest.mark.parametrize(
    "kills", [FEW, pytest.param(8, marks=pytest.mark.sweep), pytest.param(MANY, marks=pytest.mark.soak)]
)
@pytest.mark.parametrize("kind", ["npz", pytest.param("mcap", marks=pytest.mark.sweep)])
def test_a_killed_generation_ends_with_the_same_files(tmp_path: Path, kills: int, kind: str) -> None:
    seeds = "0:40" if kind == "npz" else "0:12"
    run_killed(tmp_path, [*WORDS, "--seeds", seeds, "--format", kind], kills, seed=kills)
    found = []
    for name in ("whole", "killed"):
        files = (item for item in (tmp_path / name).rglob("*") if item.is_file())
        found.append({file.relative_to(tmp_path / name).as_posix(): file.read_bytes() for file in files})
    assert sorted(found[0]) == sorted(found[1])
    assert [name for name in found[0] if found[0][name] != found[1][name]] == []
    assert json.loads(found[0]["card.json"])["files"]
