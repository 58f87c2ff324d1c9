"""Tables of one's own: names of columns, decimal commas, feet, pixels, and clocks that are not regular."""

from __future__ import annotations

import dataclasses
import gzip
import importlib
import inspect

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot import cli
from crowdbot.cli.parser import CommandParser
from crowdbot.core import DataError, InputError
from crowdbot.data import FILE_OPTIONS, Recording, load, read_homography, save
from crowdbot.trials import RecordedPeople


def walker(times, speed=1.3, id=1):
    return [(id, float(time), speed * float(time), 2.0) for time in times]


def write(path, rows, header="id,time,x,y"):
    path.write_text("\n".join([header, *(",".join(map(str, row)) for row in rows)]) + "\n")
    return path


def test_columns_by_name(tmp_path):
    path = write(tmp_path / "t.csv", [(*row, 0) for row in walker([0, 0.5, 1.0])], "who,clock,east,north,frame")
    with pytest.raises(DataError, match=r"no column for id, x, y; it has who, clock, .* \(--columns id=NAME"):
        load(path)
    tracks = load(path, columns={"id": "who", "time": "clock", "x": "east", "y": "north"})
    assert tracks.dt == 0.5
    assert tracks.x.tolist() == [0.0, 0.65, 1.3]


def test_a_column_that_is_named_is_not_taken_for_another(tmp_path):
    path = write(tmp_path / "t.csv", [(1, 0.0, 5.0, 7.0, 2.0), (1, 1.0, 6.0, 8.0, 2.0)], "id,time,x,x_est,y")
    assert load(path).x.tolist() == [5.0, 6.0]
    assert load(path, columns={"x": "x_est"}).x.tolist() == [7.0, 8.0]


def test_wrong_columns(tmp_path):
    path = write(tmp_path / "t.csv", walker([0, 1]))
    with pytest.raises(InputError, match="columns: unknown 'idd', did you mean 'id'"):
        load(path, columns={"idd": "id"})
    with pytest.raises(DataError, match="t.csv has no column 'tme' for time, did you mean 'time'"):
        load(path, columns={"time": "tme"})
    (tmp_path / "plain.txt").write_text("0 1 0.0 0.0\n10 1 0.5 0.0\n")
    with pytest.raises(InputError, match="the format sgan has none"):
        load(tmp_path / "plain.txt", format="sgan", columns={"id": "id"})


def test_decimal_commas(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("id;time;x;y\n1;0;0,5;-1,25\n1;0,4;1;-1,5e0\n")
    tracks = load(path)
    assert tracks.x.tolist() == [0.5, 1.0]
    assert tracks.y.tolist() == [-1.25, -1.5]
    path.write_text("id;time;x;y\n1;0;0,5;1\n1;0,4;1.000,5;1\n")
    with pytest.raises(DataError, match="line 2: x is '0,5', it must be a number"):
        load(path)


def test_feet(tmp_path):
    path = write(tmp_path / "t.csv", [(1, 0, 0, 10), (1, 1, 4, 10)], "id,time,x [ft],y [ft]")
    np.testing.assert_allclose(load(path).x, [0.0, 1.2192])
    np.testing.assert_allclose(load(write(path, [(1, 0, 0, 10), (1, 1, 4, 10)]), units="ft").y, 3.048)


def test_pixels_by_scale_and_homography(tmp_path):
    path = write(tmp_path / "t.csv", [(1, 0, 100, 50), (1, 1, 160, 50)])
    np.testing.assert_allclose(load(path, transform=0.02).x, [2.0, 3.2])
    matrix = [[0.0, 0.02, 1.0], [0.02, 0.0, 0.0], [0.0, 0.0, 2.0]]
    (tmp_path / "H.txt").write_text("# of the camera\n" + "\n".join(" ".join(map(str, row)) for row in matrix))
    tracks = load(path, transform=read_homography(tmp_path / "H.txt"))
    np.testing.assert_allclose(tracks.position, [[1.0, 1.0], [1.0, 1.6]])
    with pytest.raises(InputError, match="units 'cm' and a transform"):
        load(path, units="cm", transform=0.02)


@pytest.mark.parametrize("text", ["1 2 3\n4 5 6\n", "1 0 0\n0 1 0\n0 0 0\n", "1 0 0\n0 nan 0\n0 0 1\n"])
def test_wrong_homographies(tmp_path, text):
    (tmp_path / "H.txt").write_text(text)
    with pytest.raises(DataError, match=r"H.txt is not a homography: three lines of three finite numbers"):
        read_homography(tmp_path / "H.txt")


def test_speeds_that_are_not_those_of_walkers(tmp_path):
    fast = load(write(tmp_path / "t.csv", walker(np.arange(10), speed=3.0)))
    assert (
        "people who move have a median speed of 3 m/s, people who walk 0.3 to 2.5 m/s, check fps and units" in fast.note
    )
    assert load(write(tmp_path / "t.csv", walker(np.arange(10)))).note == ""


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.04, 0.1, 0.4]), st.floats(0.0, 0.2), st.floats(0.0, 5.0))
def test_a_clock_with_jitter_is_found(tmp_path_factory, seed, dt, share, begin):
    generator = np.random.default_rng(seed)
    rows = []
    for id in range(1, 31):
        first = int(generator.integers(0, 3000))
        number = np.setdiff1d(np.arange(first, first + 60), first + generator.integers(1, 59, 5))
        times = begin + dt * (number + share * generator.uniform(-1.0, 1.0, len(number)))
        rows += [(id, time, 1.3 * time, n) for time, n in zip(times, number, strict=True)]
    tracks = load(write(tmp_path_factory.mktemp("jitter") / "t.csv", rows))
    assert tracks.dt == pytest.approx(dt, rel=1e-3)
    told = {(int(id), int(y)): frame for id, y, frame in zip(tracks.id, tracks.y, tracks.frame, strict=True)}
    first = min(n for _, n in told)
    assert all(frame == n - first for (_, n), frame in told.items())
    assert ("off a regular step" in tracks.note) == (share * dt > 1e-4) or share * dt < 1e-3


def test_times_that_are_not_regular_are_interpolated(tmp_path):
    rows = walker([0.0, 0.4, 0.8, 1.2]) + walker([0.17, 0.57, 0.97, 1.37], id=2)
    rows += walker([0.0, 0.4, 0.8, 4.0, 4.4], id=3)
    tracks = load(write(tmp_path / "t.csv", rows))
    assert "times are irregular, up to 0.1" in tracks.note
    assert "positions are interpolated at this step" in tracks.note
    np.testing.assert_allclose(tracks.x, 1.3 * tracks.time, atol=1e-9)
    assert not np.any((tracks.id == 3) & (tracks.time > 0.81) & (tracks.time < 3.9))


def test_two_positions_at_one_time_are_refused(tmp_path):
    path = write(tmp_path / "t.csv", [(1, 0, 1, 3), (1, 0.4, 1, 3), (1, 0.4, 2, 3)])
    with pytest.raises(DataError, match="line 4: time 0.4, id 1 is a duplicate"):
        load(path)


def test_predict_says_what_it_understood(tmp_path, capsys):
    rows = [(who, k, 65 * k + who, 100 * who) for who in (1, 2) for k in range(25)]
    path = write(tmp_path / "t.csv", rows, "ped,k,px,py")
    words = ["predict", "--data", str(path), "--columns", "id=ped", "frame=k", "x=px", "y=py", "--scale", "0.01"]
    assert cli.main([*words, "--fps", "2"]) == 0
    lines = capsys.readouterr().err.splitlines()
    begin = lines.index("t.csv: 50 rows of 2 people, 12 s with a step of 0.5 s")
    assert lines[begin + 1] == "t.csv: 15.6 x 1 m; speed 1.3 m/s (5 to 95 %: 1.3 to 1.3 m/s)"
    assert cli.main(["predict", "--data", str(path), "--columns", "ped"]) == 2
    assert "columns ped: write NAME=COLUMN, such as id=pedestrian" in capsys.readouterr().err
    (tmp_path / "H.txt").write_text("1 0 0\n0 1 0\n0 0 1\n")
    assert cli.main([*words, "--homography", str(tmp_path / "H.txt")]) == 2
    assert "--scale and --homography are given" in capsys.readouterr().err


def test_a_recording_keeps_its_columns_and_its_scale(tmp_path):
    path = write(tmp_path / "t.csv", [(1, k, 65 * k, 0) for k in range(25)], "ped,time,px,py")
    named = (("id", "ped"), ("x", "px"), ("y", "py"))
    one = Recording(str(path), columns=named, transform=((0.02, 0.0, 0.0), (0.0, 0.02, 0.0), (0.0, 0.0, 1.0)))
    np.testing.assert_allclose(one.tracks.x[:3], [0.0, 1.3, 2.6])
    save(one.tracks, tmp_path / "metres.csv")
    np.testing.assert_allclose(load(tmp_path / "metres.csv").x, one.tracks.x)


def test_columns_by_number(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("# no names\n0.0,7,1.0,2.0,9,9\n0.5,7,1.5,2.0,9,9\n")
    with pytest.raises(DataError, match=r"unknown format.*--columns time=1 id=2 x=3 y=4"):
        load(path)
    tracks = load(path, columns={"time": "1", "id": "2", "x": "3", "y": "4"})
    assert (tracks.ids.tolist(), tracks.dt, tracks.x.tolist()) == ([7], 0.5, [1.0, 1.5])
    with pytest.raises(DataError, match="has no column '8' for y; it has 1, 2, 3, 4, 5, 6"):
        load(path, columns={"time": "1", "id": "2", "x": "3", "y": "8"})
    named = write(tmp_path / "n.csv", [(1, 0, 5, 7), (1, 1, 6, 8)], "who,time,east,north")
    assert load(named, columns={"id": "1", "x": "3", "y": "north"}).x.tolist() == [5.0, 6.0]
    path.write_text("0.0,7,1.0,2.0\n0.5,7,1.5\n")
    with pytest.raises(DataError, match="line 2 has 3 columns, the first line has 4"):
        load(path, columns={"time": "1", "id": "2", "x": "3", "y": "4"})


def test_a_table_without_ids_is_one_person_if_its_times_ascend(tmp_path):
    rows = [(k, 0.1 * k, 0.13 * k, 2.0) for k in range(3)]
    tracks = load(write(tmp_path / "t.csv", rows, ",timestamp,x,y"))
    assert tracks.ids.tolist() == [1]
    assert "all rows are of one person" in tracks.note
    with pytest.raises(DataError, match="has no column for id"):
        load(write(tmp_path / "t.csv", rows + rows, ",timestamp,x,y"))


def test_a_folder_of_one_file_a_person(tmp_path, capsys):
    folder = tmp_path / "people"
    folder.mkdir()
    (folder / ".hidden").write_text("no table")
    for who in (3, 20):
        rows = [(0.1 * k, 0.13 * k, who) for k in range(who, who + 30)]
        write(folder / f"person_{who}.csv", rows, "time,x,y")
    tracks = load(folder)
    assert (tracks.ids.tolist(), tracks.dt, len(tracks)) == ([3, 20], 0.1, 60)
    assert tracks.track(20).frame[0] == 17
    assert "2 files of one person each" in tracks.note
    assert load(folder, units="cm").x.max() == pytest.approx(tracks.x.max() / 100)
    assert cli.main(["predict", "--data", str(folder), "--step", "0.1"]) == 0
    assert "people: 60 rows of 2 people" in capsys.readouterr().err
    assert cli.main(["measure", str(folder), "--methods", "individual"]) == 0
    with pytest.raises(InputError, match="is a folder of files, which has no format"):
        load(folder, format="csv")
    write(folder / "odd.csv", [(0, 1, 2)], "time,x,z")
    with pytest.raises(DataError, match=r"person_3.csv has the columns time, x, y, .*odd.csv has time, x, z"):
        load(folder)
    write(folder / "odd.csv", [(0, 1, 2)], "id,x,y")
    with pytest.raises(DataError, match="odd.csv has id, x, y; move files of another kind out of the folder"):
        load(folder)
    (tmp_path / "none").mkdir()
    with pytest.raises(DataError, match="none has no files"):
        load(tmp_path / "none")


def test_gzip_of_a_text_and_of_something_else(tmp_path):
    plain = write(tmp_path / "t.csv", walker([0, 0.5, 1.0]))
    path = tmp_path / "t.csv.gz"
    path.write_bytes(gzip.compress(plain.read_bytes(), mtime=0))
    assert load(path).x.tolist() == load(plain).x.tolist()
    path.write_bytes(gzip.compress(plain.read_bytes(), mtime=0)[:-12])
    with pytest.raises(DataError, match="cannot be read as gzip, it is truncated or damaged"):
        load(path)
    path.write_bytes(gzip.compress(b"PAR1" + bytes(100), mtime=0))
    with pytest.raises(DataError, match="is gzip of parquet; only texts are read from gzip, unpack it first"):
        load(path)


def test_boxes_with_a_homography_and_without(tmp_path):
    path = tmp_path / "gt.txt"
    path.write_text("".join(f"{k},1,{100 + 2 * k},50,10,40,1,-1,-1,-1\n" for k in range(1, 4)))
    with pytest.raises(DataError, match="has no frame rate"):
        load(path)
    tracks = load(path, fps=10.0, transform=0.02)
    np.testing.assert_allclose(tracks.position, [[2.14, 1.8], [2.18, 1.8], [2.22, 1.8]])
    path.write_text("".join(f"{k},1,100,50,10,40,1,{0.1 * k},7,0\n" for k in range(1, 4)))
    assert load(path, fps=10.0).position.tolist() == [[0.1, 7.0], [0.2, 7.0], [pytest.approx(0.3), 7.0]]
    path.write_text("1,-1,100,50,10,40,0.9,-1,-1,-1\n")
    with pytest.raises(DataError, match="the id of all rows is -1, these are detections without tracks"):
        load(path, fps=10.0)
    box = "{} 4 Pedestrian 0 0 -1.5 100 50 120 90 1.7 0.6 0.6 -2.0 1.6 {} 0.1\n"
    (tmp_path / "0001.txt").write_text("".join(box.format(k, 8 + 0.1 * k) for k in range(4)))
    relative = load(tmp_path / "0001.txt")
    assert relative.position[0].tolist() == [8.0, 2.0]
    assert "positions are relative to the camera, which moves with the car" in relative.warnings[0]
    assert load(tmp_path / "0001.txt", transform=0.1).position[0].tolist() == [11.0, 9.0]


def test_commands_and_trials_have_all_options_of_files():
    names = set(FILE_OPTIONS)
    for command in ("predict", "measure", "calibrate", "train", "degrade", "new"):
        parser = CommandParser()
        importlib.import_module(f"crowdbot.cli.{command}").arguments(parser)
        text = parser.format_full_help()
        assert [name for name in names if f"--{name.replace('_', '-')} " not in text] == [], command
    fields = {field.name for field in dataclasses.fields(RecordedPeople)}
    assert names <= fields
    given = inspect.signature(load).parameters
    assert names - {"scale", "homography", "agents"} <= set(given)


def test_predict_leaves_out_recordings_without_windows(tmp_path, capsys):
    long = write(tmp_path / "long.csv", walker(0.4 * np.arange(30)))
    short = write(tmp_path / "short.csv", walker(0.4 * np.arange(5)))
    assert cli.main(["predict", "--data", str(long), str(short)]) == 0
    out = capsys.readouterr()
    assert "short.csv is left out: it has no window" in out.err
    assert "long.csv" in out.out
    assert cli.main(["predict", "--data", str(short), str(short)]) == 2
    assert "short.csv: no window of 8 observed and 12 predicted rows was found" in capsys.readouterr().err
