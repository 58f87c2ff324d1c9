"""Wrong files: each gives one sentence that says what is wrong and where, and nothing else is ever raised."""

import sqlite3

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import DataError, InputError
from crowdbot.data import FORMATS, load
from crowdbot.data.readers import hdf5_arrays

OBSMAT = "1 1 0.5 0 1.5 0 0 0\n"
VSP = "1 - the number of splines\n2 - Num of control points\n0 0 0 0 - (2D point)\n1 1 50 0 - (2D point)\n"
SDD = '0 1 1 3 3 0 0 0 0 "Biker"\n0 1 1 3 3 1 1 0 0 "Biker"\n'


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("empty.txt", "", "empty.txt is empty"),
        ("blank.txt", " \n\n", "blank.txt is empty"),
        ("prose.txt", "Dear reader,\nhello\n", r"prose.txt is text and of an unknown format \(it starts with 'Dear"),
        ("nan.txt", "0 1 2 3\n10 1 nan 3\n", "nan.txt line 2: x is nan for frame 10, id 1; coordinates must be finite"),
        ("inf.txt", "# a\n\n0 1 2 3\n10 1 2 -inf\n", "inf.txt line 4: y is -inf for frame 10, id 1"),
        ("twice.txt", "0 1 2 3\n10 1 2 3\n10 1 4 5\n10 1 6 7\n", "line 3: frame 10, id 1 is a duplicate"),
        ("half.txt", "0 1.5 2 3\n", r"half.txt line 1: id is 1\.5, it must be a whole number"),
        (
            "step.txt",
            "0 1 2 3\n1 1 2 3\n",
            "step.txt has no frame rate, and rows 1 frame apart are not a convention of the field",
        ),
        ("obsmat.txt", OBSMAT + "11 1 inf 0 1 0 0 0\n", "obsmat.txt line 2: x is inf"),
        ("cut.vsp", VSP[:-30], "cut.vsp ends inside spline 1; the file is truncated"),
        ("few.vsp", VSP.replace("1 - the", "2 - the"), "ends before the number of control points of spline 2"),
        ("bad.vsp", VSP.replace("1 1 50", "1 1 x"), "bad.vsp line 4: '1 1 x 0' is not a control point"),
        ("none.vsp", "1 - the number of splines\n0 - Num\n1 1 1 1\n", "has no control points"),
        ("lost.sdd", SDD.replace("0 0 0 0 ", "0 1 0 0 "), "all of its 2 rows are marked lost"),
        ("a.csv", "id,frame,x\n1,0,2\n", "a.csv has no column for y; it has id, frame, x; y may be called y, pos_y"),
        (
            "b.csv",
            "a,b,c\n1,2,3\n",
            "b.csv has no column for id, x, y, frame; it has a, b, c; id may be called id, agent",
        ),
        ("c.csv", "id,frame,x,y\n1,0,,3\n", "c.csv line 2: x is nan for frame 0, id 1"),
        ("d.csv", "id,frame,x,y\n1,0,1,3\n1,10,left,3\n", "d.csv line 3: x is 'left', it must be a number"),
        ("e.csv", "id,frame,x,y\n1,0,1,3\n1,0,2,3\n", "e.csv line 3: frame 0, id 1 is a duplicate"),
        ("f.csv", "id,frame,x,y\n1,0,1,3\n1,10,2\n", "f.csv line 3 has 3 columns, the line of names has 4"),
        ("g.csv", "id,frame,x,y\n", "g.csv has no rows"),
        (
            "i.csv",
            "id,time,x,y\n1,0,1,3\n1,1000000000,2,3\n",
            "the time step is 1e.09; times must be in s",
        ),
        ("j.csv", "id,time,x,y\n1,0,1,3\n2,1,2,3\n", "no track has rows at two times, so its frame rate is unknown"),
        ("k.csv", "id,frame,x,y\n,0,1,3\n", "k.csv line 2: id is empty, but every row needs a value"),
        ("l.csv", "id,time,x,y\n1,,1,3\n", "l.csv line 2: its time is missing"),
        (
            "m.ndjson",
            '{"track": {"f": 0, "p": 1, "x": 1, "y": null}}\n',
            "m.ndjson line 1: y is null, it must be a number",
        ),
        (
            "n.ndjson",
            '{"track": {"f": 0, "p": 1, "x": 1, "y": 2}}\n{"track": {"f"',
            "line 2 is not JSON: .* truncated or damaged",
        ),
        ("o.ndjson", '{"track": {"f": 0, "p": 1, "x": NaN, "y": 2}}\n', "o.ndjson line 1: x is nan"),
        ("p.ndjson", '{"scene": {"id": 0, "p": 1, "s": 0, "e": 1}}\n', "p.ndjson has 1 scenes but no row"),
        ("q.ndjson", '{"track": {"f": 0, "p": 1, "x": 1, "y": 2}}\n[1]\n', "line 2 is neither a scene nor a track"),
        ("r.ndjson", '{"track": {"f": 0, "p": 1, "x": 1, "y": 2, "prediction_number": 0}}\n', "line 1 is a prediction"),
        (
            "s.ndjson",
            '{"scene": {"id": 0, "p": 1, "s": 0, "e": 1}}\n{"track": {"f": 0, "p": 1, "x": 1, "y": 2}}\n',
            "has no frame rate",
        ),
        (
            "t.ndjson",
            '{"scene": {"id": 0, "fps": 2}}\n{"track": {"f": 0, "p": 1, "x": 1, "y": 2}}\n',
            "lacks one of the whole",
        ),
        ("u.ndjson", '{"track": {"f": 1e300, "p": 1, "x": 1, "y": 2}}\n', r"f is 1e\+300, it must be a whole number"),
        (
            "z.ndjson",
            '{"scene": {"id": 0, "p": 1, "s": 0, "e": 1, "fps": 2.5}}\n'
            '{"scene": {"id": 1, "p": 1, "s": 0, "e": 1, "fps": 25}}\n'
            '{"track": {"f": 0, "p": 1, "x": 1, "y": 2}}\n{"track": {"f": 1, "p": 1, "x": 1, "y": 2}}\n',
            r"its scenes have 2 values of fps, 2\.5 to 25\.0; give fps",
        ),
        ("v.txt", "# PeTrack\n# framerate: fast\n1 0 1 2 3\n", "has no frame rate"),
        ("w.txt", "# framerate: 2.5.1 fps\n1 0 1 2 3\n", r"w.txt: the header's frame rate '2\.5\.1' is not a number"),
        ("x.txt", "# PeTrack\n# framerate: 25 fps\n", "of an unknown format"),
        ("y.txt", "# framerate: 0 fps\n1 0 1 2 3\n1 1 1 2 3\n", r"fps 0\.0 is not allowed"),
    ],
)
def test_each_wrong_text_has_its_sentence(tmp_path, name, text, message):
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(DataError, match=message) as error:
        load(path)
    assert "\n" not in str(error.value)
    assert name in str(error.value)


def test_a_number_that_is_none_deep_in_a_long_file(tmp_path):
    path = tmp_path / "long.txt"
    rows = [f"{10 * k} 1 {k} {k}" for k in range(200)]
    path.write_text("\n".join([*rows[:150], "1500 1 oops 0", *rows[150:]]))
    with pytest.raises(DataError, match=r"long.txt line 151: 'oops' is not a number"):
        load(path)
    path.write_text("\n".join([*rows[:150], "1500 1 0", *rows[150:]]))
    with pytest.raises(DataError, match=r"long.txt line 151 has 3 columns, the others have 4"):
        load(path)


def test_missing_files_folders_and_rubbish(tmp_path):
    with pytest.raises(DataError, match="there is no file .*nowhere.txt"):
        load(tmp_path / "nowhere.txt")
    with pytest.raises(DataError, match="the folder .* has no files"):
        load(tmp_path)
    with pytest.raises(DataError, match="cannot be read|there is no file"):
        load("a\x00b.txt")
    rubbish = tmp_path / "rubbish.bin"
    rubbish.write_bytes(bytes(range(256)) * 40)
    with pytest.raises(DataError, match="is binary and of an unknown format.*; formats are episode, parquet"):
        load(rubbish)
    (tmp_path / "packed.zip").write_bytes(b"PK\x03\x04" + b"\x01" * 500)
    with pytest.raises(DataError, match="packed.zip is a damaged zip archive; fetch it again"):
        load(tmp_path / "packed.zip")


def test_binary_bytes_after_a_good_beginning(tmp_path):
    path = tmp_path / "damaged.txt"
    path.write_bytes(b"0 1 2 3\n" * 10_000 + b"\x00\x01\x02")
    with pytest.raises(DataError, match="has binary bytes after text"):
        load(path)


def test_arguments_that_are_not_allowed(tmp_path):
    path = tmp_path / "good.txt"
    path.write_text("0 1 2 3\n10 1 2 3\n")
    assert load(path, fps=50).dt == 0.2
    for fps in (0.0, -1.0, float("nan"), float("inf"), 1e6):
        with pytest.raises(DataError, match="fps .* is not allowed"):
            load(path, fps=fps)
    with pytest.raises(InputError, match="unknown format 'sgam', did you mean 'sgan'\\?; known are episode"):
        load(path, format="sgam")
    with pytest.raises(InputError, match="unknown time base 'tru', did you mean 'true'"):
        load(path, time_base="tru")
    with pytest.raises(DataError, match="unknown units 'metre'.*known are m, cm, mm, km, ft, px"):
        load(path, units="metre")


def test_too_large_is_refused_by_size(tmp_path, monkeypatch):
    path = tmp_path / "large.txt"
    path.write_text("0 1 2 3\n10 1 2 3\n")
    monkeypatch.setattr("crowdbot.data.source.MAX_BYTES", 10)
    with pytest.raises(DataError, match="has 17 bytes, more than the limit of 10; split it in time"):
        load(path)


def test_a_line_of_ndjson_has_a_limit(tmp_path, monkeypatch):
    path = tmp_path / "wide.ndjson"
    path.write_text('{"track": {"f": 0, "p": 1, "x": 1, "y": 2}}\n')
    monkeypatch.setattr("crowdbot.data.readers.trajnetpp.MAX_LINE", 20)
    with pytest.raises(DataError, match="line 1 has 43 characters, more than 20"):
        load(path)


@pytest.mark.program
def test_an_hdf5_library_that_loops_without_end_is_stopped(tmp_path, monkeypatch):
    program = tmp_path / "program.py"
    program.write_text(
        "from crowdbot.data.readers.hdf5_program import limit_cpu_time\nlimit_cpu_time(1)\nwhile True: pass\n"
    )
    monkeypatch.setattr(hdf5_arrays, "PROGRAM", str(program))
    monkeypatch.setattr(hdf5_arrays, "SECONDS", 1)
    path = tmp_path / "endless.h5"
    with h5py.File(path, "w") as file:
        file["trajectory"] = np.zeros(3)
    with pytest.raises(DataError, match=r"endless.h5 is damaged: the HDF5 library does not finish reading it"):
        load(path)


def test_wrong_hdf5(tmp_path):
    path = tmp_path / "wrong.h5"
    with h5py.File(path, "w") as file:
        file["something"] = np.zeros(3)
    with pytest.raises(DataError, match="HDF5 without a table 'trajectory'; it holds something"):
        load(path)
    with h5py.File(path, "w") as file:
        file["trajectory"] = np.zeros(3, dtype=[("id", "i8"), ("frame", "i8")])
    with pytest.raises(DataError, match="table 'trajectory' lacks x, y; it has id, frame"):
        load(path)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(DataError, match="cannot be read as HDF5, it is truncated or damaged"):
        load(path)


def test_wrong_sqlite(tmp_path):
    path = tmp_path / "wrong.sqlite"
    with sqlite3.connect(path) as base:
        base.execute("CREATE TABLE people (id INTEGER)")
    base.close()
    with pytest.raises(
        DataError, match="sqlite without the tables trajectory_data and metadata of JuPedSim; it holds people"
    ):
        load(path)
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(DataError, match="wrong.sqlite"):
        load(path)


def test_an_sqlite_with_words_for_numbers(tmp_path):
    path = tmp_path / "words.sqlite"
    with sqlite3.connect(path) as base:
        base.execute("CREATE TABLE trajectory_data (frame, id, pos_x, pos_y)")
        base.execute("CREATE TABLE metadata (key, value)")
        base.execute("INSERT INTO trajectory_data VALUES (0, 1, 'left', 2.0)")
        base.execute("INSERT INTO metadata VALUES ('fps', '25')")
    base.close()
    with pytest.raises(DataError, match="the column x must hold numbers"):
        load(path)


def test_an_odd_name_of_an_sqlite_file(recordings, tmp_path):
    odd = tmp_path / "a?b#c %41.sqlite"
    odd.write_bytes((recordings / "juelich/jupedsim_simulated/trajectories.sqlite").read_bytes())
    assert len(load(odd)) == 8083


def test_wrong_parquet(tmp_path):
    path = tmp_path / "wrong.parquet"
    pq.write_table(pa.table({"id": [1], "frame": [0], "x": [1.0]}), path)
    with pytest.raises(DataError, match="has no column for y; it has id, frame, x"):
        load(path)
    table = pa.table({"id": [1, 1], "frame": [0, 10], "x": [1.0, None], "y": [1.0, 2.0]})
    pq.write_table(table, path)
    with pytest.raises(DataError, match="wrong.parquet row 2: x is nan for frame 10, id 1"):
        load(path)
    pq.write_table(table.replace_schema_metadata({"crowdbot": "{]"}), path)
    with pytest.raises(DataError, match="the metadata written by crowdbot is damaged"):
        load(path)
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(DataError, match="cannot be read as Parquet"):
        load(path)


def test_wrong_npz(tmp_path):
    np.savez(tmp_path / "wrong.npz", a=np.zeros(3))
    with pytest.raises(DataError, match="lacks the arrays obsvs, preds, times of Social Ways; it holds a"):
        load(tmp_path / "wrong.npz")
    np.savez(tmp_path / "odd.npz", obsvs=np.zeros((2, 3, 2)), preds=np.zeros((3, 3, 2)), times=np.zeros(2))
    with pytest.raises(DataError, match=r"must be \[N, T, 2\]"):
        load(tmp_path / "odd.npz", fps=2.5)
    np.savez(tmp_path / "code.npz", obsvs=np.array([print], dtype=object))
    with pytest.raises(DataError, match="cannot be read as arrays"):
        load(tmp_path / "code.npz")


def rows_or_sentence(path, **given):
    """Return the number of rows of a file, or the sentence of its error; any other error comes through."""
    try:
        return len(load(path, **given))
    except DataError as error:
        return str(error)


@pytest.mark.parametrize("name", list(FORMATS))
@given(data=st.one_of(st.binary(min_size=1, max_size=300), st.text(max_size=200).map(str.encode)))
@settings(deadline=None, max_examples=25)
def test_no_format_raises_anything_but_a_data_error(tmp_path_factory, name, data):
    path = tmp_path_factory.mktemp("fuzz") / "rubbish"
    path.write_bytes(data)
    found = rows_or_sentence(path, format=name)
    assert (isinstance(found, int) and found > 0) or "rubbish" in found


@pytest.mark.parametrize(
    "path",
    [
        "sdd/hyang/video9/annotations.txt",
        "trajnetpp/biwi_hotel.ndjson",
        "ucy/uni_examples/annotation.vsp",
        "eth_biwi/seq_hotel/obsmat.txt",
        "juelich/single_file/n56_cam1.csv",
        "juelich/single_file/00_01a.h5",
        "juelich/jupedsim_simulated/trajectories.sqlite",
        "sdd/gates/video2/data_2_8.npz",
    ],
)
@given(share=st.floats(0.01, 0.99), spot=st.floats(0.0, 1.0), byte=st.integers(0, 255))
@settings(deadline=None, max_examples=8)
def test_cut_and_damaged_recordings_load_or_say_why(tmp_path_factory, recordings, path, share, spot, byte):
    whole = bytearray((recordings / path).read_bytes())
    whole[int(spot * (len(whole) - 1))] = byte
    damaged = tmp_path_factory.mktemp("cut") / "damaged"
    for data in (whole, whole[: max(1, int(share * len(whole)))]):
        damaged.write_bytes(bytes(data))
        found = rows_or_sentence(damaged, fps=2.5)
        assert (isinstance(found, int) and found > 0) or "damaged" in found
