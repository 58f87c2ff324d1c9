"""What tools/fuzz_readers.py found, and a sample of its mutated files; `make sweeps` reads 3000."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from synthetic_recordings import rows, sdd_annotations

from crowdbot.core import DataError
from crowdbot.data import load

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("label", ["inf", "-inf", "nan", "1.5", "2", "-1"])
def test_a_label_without_quotes_is_named_with_its_line(tmp_path, label):
    path = tmp_path / "annotations.txt"
    sdd_annotations(path)
    lines = path.read_text().splitlines()
    lines[70] = lines[70].rsplit(" ", 1)[0] + f" {label}"
    path.write_text("\n".join(lines))
    with pytest.raises(DataError, match=rf"annotations.txt line 71: the label is {label}, it must be a quoted word"):
        load(path)


@pytest.mark.parametrize("column", range(9))
@pytest.mark.parametrize("value", ["inf", "nan"])
def test_a_box_that_is_not_finite_is_a_sentence(tmp_path, column, value):
    path = tmp_path / "annotations.txt"
    sdd_annotations(path)
    lines = path.read_text().splitlines()
    words = lines[70].split(" ")
    words[column] = value
    lines[70] = " ".join(words)
    path.write_text("\n".join(lines))
    if column in (6, 7, 8):  # lost, occluded, generated: such a row is lost or the flag is not used
        assert len(load(path)) == len(rows(30.0)) - 12 - (column == 6)
    else:
        with pytest.raises(DataError, match=r"annotations\.txt line 71"):
            load(path)


def test_a_spline_cannot_span_any_time(tmp_path):
    path = tmp_path / "annotation.vsp"
    path.write_text("1 - the number of splines\n2 - Num\n0 0 0 0 - (2D)\n1 1 9000000 0 - (2D)\n")
    with pytest.raises(DataError, match="its splines span 9000000 frames, at most 2000000 are read"):
        load(path)
    path.write_text(path.read_text().replace("9000000", "2000"))
    assert len(load(path)) == 2001


def fuzz(count, seed):
    tool = [sys.executable, ROOT / "tools" / "fuzz_readers.py", "--count", str(count), "--seed", str(seed)]
    return subprocess.run(tool, capture_output=True, text=True, check=False)


def test_a_sample_of_mutated_files_is_read_or_rejected():
    done = fuzz(60, 7)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "'rejected':" in done.stdout


@pytest.mark.sweep
def test_mutated_files_are_read_or_rejected():
    done = fuzz(3000, int(np.random.default_rng(8).integers(1 << 30)))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "'rejected':" in done.stdout
