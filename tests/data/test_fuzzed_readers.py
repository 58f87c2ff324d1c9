"""What tools/fuzz_readers.py found, and a sample of its mutated files; `make sweeps` reads 200 of every kind."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from synthetic_recordings import SYNTHETIC, rows, sdd_annotations, social_ways

from crowdbot.core import DataError
from crowdbot.data import load

ROOT = Path(__file__).parents[2]
KINDS = (
    "text", "peers", "hdf5", "sqlite", "parquet", "npz", "mcap", "weights", "trials", "originals", "robots", "xacro",
    "meshes", "maps", "episodes", "experiments", "sessions", "scenes", "imports", "labels",
)  # fmt: skip


@pytest.mark.parametrize("label", ["inf", "-inf", "nan", "1.5", "2", "-1"])
def test_a_label_without_quotes_is_named_with_its_line(tmp_path, label):
    path = tmp_path / "annotations.txt"
    sdd_annotations(path)
    lines = path.read_text().splitlines()
    lines[70] = lines[70].rsplit(" ", 1)[0] + f" {label}"
    path.write_text("\n".join(lines))
    with pytest.raises(DataError, match=rf"annotations.txt line 71: the label is {label}, it must be a quoted word"):
        load(path)


@pytest.mark.parametrize("value", ["0.5", "nan", "x", "", "1e300"])
def test_a_road_user_of_ind_without_a_number_is_named(tmp_path, value):
    SYNTHETIC["07_tracks.csv"].write(tmp_path / "07_tracks.csv")
    classes = tmp_path / "07_tracksMeta.csv"
    lines = classes.read_text().splitlines()
    lines[2] = lines[2].replace(",2,", f",{value},", 1)
    classes.write_text("\n".join(lines))
    with pytest.raises(
        DataError, match=r"07_tracks\.csv: _tracksMeta\.csv row 2: trackId is '?[a-z0-9.+]+'?, it must be"
    ):
        load(tmp_path / "07_tracks.csv")


LONG = "1" * 140_000


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("07_tracks.csv", "\n", f"\n{LONG}"),
        ("THOR-Magni_120522_SC1A_R1.csv", "BODY_ROLES", LONG),
        ("wildtrack/00000030.json", '"personID": ', '"personID": 1e999, "was": '),
        ("cubberly.json", '"cx": ', f'"cx": {"1" * 400}, "was": '),
        ("cubberly.json", '"cx": ', '"cx": [], "was": '),
    ],
)
def test_values_beyond_every_limit_are_a_sentence(tmp_path, name, old, new):
    path = tmp_path / name
    path.parent.mkdir(exist_ok=True)
    SYNTHETIC[name].write(path)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(DataError, match=rf"{path.name}.* is damaged: "):
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


@pytest.mark.parametrize("name", ["obsvs", "preds", "times"])
@pytest.mark.parametrize("dtype", ["datetime64[s]", "U8", "complex128"])
def test_arrays_that_hold_no_numbers_are_named(tmp_path, name, dtype):
    path = tmp_path / "data_8_12.npz"
    social_ways(path)
    with np.load(path) as file:
        arrays = dict(file)
    np.savez(path, **{**arrays, name: arrays[name].astype(dtype)})
    with pytest.raises(DataError, match=rf"{path.name}: the array {name} must hold numbers, it holds "):
        load(path)


linux = pytest.mark.skipif(sys.platform != "linux", reason="the fuzzer reads /proc and limits memory")


def fuzz(count, seed, *kinds):
    tool = [sys.executable, ROOT / "tools" / "fuzz_readers.py", "--count", str(count), "--seed", str(seed)]
    return subprocess.run([*tool, "--only", *kinds], capture_output=True, text=True, check=False)


@pytest.mark.program
@linux
def test_a_sample_of_mutated_files_is_read_or_rejected():
    kinds = ("npz", "mcap", "maps", "sessions")
    done = fuzz(15, 7, *kinds)
    assert done.returncode == 0, done.stdout + done.stderr
    last = done.stdout.splitlines()[-1].split()
    assert (last[0], int(last[1]), int(last[4])) == ("all", 15 * len(kinds), 0)
    assert int(last[3]) > 0


@linux
@pytest.mark.sweep
@pytest.mark.parametrize("kind", KINDS)
def test_mutated_files_are_read_or_rejected(kind):
    done = fuzz(200, int(np.random.default_rng(8).integers(1 << 30)), kind)
    assert done.returncode == 0, done.stdout + done.stderr
    assert int(done.stdout.splitlines()[-1].split()[3]) > 0


@pytest.mark.program
@linux
def test_a_run_continues_from_its_state_and_a_file_is_repeated(tmp_path):
    state = tmp_path / "state.json"
    tool = [sys.executable, ROOT / "tools" / "fuzz_readers.py", "--only", "npz", "--state", state, "--count"]
    for count in ("3", "6"):
        done = subprocess.run([*tool, count], capture_output=True, text=True, check=True)
    known = json.loads(state.read_text())
    counts = known["counts"]["npz"]
    assert (counts["next"], counts.get("read", 0) + counts["rejected"]) == (6, 6)
    assert "npz: 6 of 6" in done.stderr


@pytest.mark.parametrize("before", ["  \n", "\u2028\n", " \x85"])
def test_names_of_columns_that_are_not_in_the_first_row_are_missed(tmp_path, before):
    path = tmp_path / "07_tracks.csv"
    path.write_text(before + "trackId,frame,xCenter,yCenter\n1,2,3,4\n", encoding="utf-8")
    with pytest.raises(DataError, match=r"07_tracks\.csv (has no column trackId|line 2)"):
        load(path)
