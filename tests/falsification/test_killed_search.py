"""A search for failures that is killed at random moments ends with the same table and the same trials."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from killed_runs import FEW, MANY, run_killed

pytestmark = pytest.mark.live

WORDS = [
    "falsify", "frontal", "--over", "spawner/speed=uniform(0.8,1.6)", "--over", "robot/y=normal(0,0.3)",
    "--set", "duration=4", "--failure", "min-clearance>0.5", "--keep", "3",
]  # fmt: skip


@pytest.mark.parametrize(
    "kills", [FEW, pytest.param(8, marks=pytest.mark.sweep), pytest.param(MANY, marks=pytest.mark.soak)]
)
@pytest.mark.parametrize("search", ["cross-entropy", pytest.param("cma-es", marks=pytest.mark.sweep)])
def test_a_killed_search_ends_with_the_same_table(tmp_path: Path, kills: int, search: str) -> None:
    runs = "200" if kills == FEW else "400"
    run_killed(tmp_path, [*WORDS, "--runs", runs, "--search", search], kills, seed=kills)
    whole, killed = (json.loads((tmp_path / name / "result.json").read_text()) for name in ("whole", "killed"))
    assert killed == whole
    assert whole["failures"] > 0
    names = sorted(one.name for one in (tmp_path / "whole" / "found").iterdir())
    assert sorted(one.name for one in (tmp_path / "killed" / "found").iterdir()) == names
    for name in names:
        assert (tmp_path / "killed" / "found" / name).read_bytes() == (tmp_path / "whole" / "found" / name).read_bytes()
