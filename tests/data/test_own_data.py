"""Tables of one's own: names of columns, decimal commas, feet, pixels, and clocks that are not regular."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot import cli
from crowdbot.core import DataError, InputError
from crowdbot.data import Recording, load, read_homography, save


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
    assert "--columns ped: write NAME=COLUMN, such as id=pedestrian" in capsys.readouterr().err
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
