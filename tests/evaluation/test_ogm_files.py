"""Folders of the layout of OGM-Turtlebot2: made from simulated scans, their scores, the command, and damaged files."""

import io
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.cli import main
from crowdbot.core import DataError, InputError, Walls
from crowdbot.evaluation import SCAN_SCORES, SOGMP, find_ogm_split, log_readings, read_ogm, score_scans
from crowdbot.evaluation.recorded_scans.ogm_files import read_npy_row
from crowdbot.perception import LastScan, LidarClusters, MovedScan, TrackedScene
from crowdbot.trials import parse_trial

HALL = """<trial name="hall" duration="8" step="0.1"><stage><wall points="-6,-6 6,-6 6,6 -6,6 -6,-6"/></stage>
<crowd type="orca"/><agent x="2" y="-4" goal="2,5"/><agent x="3" y="4" goal="3,-5"/><agent x="4" y="0" goal="-4,1"/>
<robot name="robot" x="-4" y="0" radius="0.3"><goal x="5" y="0"/><drive type="differential-drive" max-speed="0.6"/>
<navigator type="straight"/>
<sensor name="scan" type="lidar2d" rate="10" rays="270" field-of-view="4.71238898038469" range-max="30"/>
</robot></trial>"""


def write_split(folder: Path, ranges, poses) -> Path:
    """Write scans and poses as the files of a split."""
    for part, rows in (("scans", ranges), ("positions", poses)):
        (folder / part).mkdir(parents=True)
        names = [f"{k:07d}.npy" for k in range(len(rows))]
        for name, row in zip(names, rows, strict=True):
            np.save(folder / part / name, np.asarray(row))
        (folder / part / f"{folder.name}.txt").write_text("\n".join(names) + "\n")
    return folder


@pytest.fixture(scope="module")
def log():
    """Return the log of a simulated hall."""
    return log_readings(parse_trial(HALL), 3, LidarClusters())


@pytest.fixture
def hall(tmp_path, log):
    """Write the log as the test split of a data set."""
    scans = [row.reading for row in log.rows]
    poses = [[*scan.pose.position[0], scan.pose.heading[0]] for scan in scans]
    return write_split(tmp_path / "ogm" / "test", [scan.ranges[0] for scan in scans], poses)


@pytest.fixture
def small(tmp_path):
    """Write 30 scans of a wall 3 m ahead."""
    poses = [[0.05 * k, 0.0, 0.0] for k in range(30)]
    return write_split(tmp_path / "test", np.full((30, 9), 3.0), poses)


@pytest.mark.parametrize("predictor", [LastScan(), MovedScan(), TrackedScene()], ids=lambda one: type(one).__name__)
def test_the_scores_of_a_folder_are_those_of_its_simulated_source(hall, log, predictor):
    unmapped = replace(log, walls=Walls.of())
    expected = score_scans([unmapped], predictor, SOGMP).values
    found = score_scans(read_ogm(hall.parent, min_duration=SOGMP.min_duration(0.1)), predictor, SOGMP).values
    assert found.shape == (len(SCAN_SCORES), 1, 5)
    assert np.isfinite(expected).all()
    assert found == pytest.approx(expected, abs=1e-9)


def test_a_scan_has_its_pose_its_time_and_no_return_where_none_is(small):
    np.save(small / "scans" / "0000003.npy", np.array([[1, 2, 30, 31, np.nan, np.inf, -np.inf, 0, 4]], np.float32))
    (piece,) = read_ogm(small)
    scan = piece.rows[3].reading
    assert scan.ranges[0].tolist()[:6] == [1.0, 2.0, *[math.inf] * 4]
    assert np.isnan(scan.ranges[0, 6:8]).all()
    assert scan.angles[[0, 4, 8]].tolist() == pytest.approx([-0.75 * math.pi, 0.0, 0.75 * math.pi])
    assert (scan.time, scan.pose.position.tolist()) == (pytest.approx(0.3), [[pytest.approx(0.15), 0.0]])
    assert (piece.name, piece.walls.start.shape, piece.rows[3].people) == ("test", (0, 2), {})


def test_a_forecast_sees_ten_scans(log):
    """The forecasts from scans 9, 39 and 69 neither see nor meet scans 20 to 29."""
    rows = list(log.rows)
    for k in range(20, 30):
        rows[k] = replace(rows[k], reading=replace(rows[k].reading, ranges=0.5 * rows[k].reading.ranges))
    logs = [log, replace(log, rows=tuple(rows))]
    first, second = (score_scans([item], TrackedScene(), replace(SOGMP, every=3.0)).values for item in logs)
    assert np.isfinite(first).all()
    assert (first == second).all()
    near, far = (score_scans([item], TrackedScene(), replace(SOGMP, every=3.0, past=15)).values for item in logs)
    assert (near != far).any()


def test_a_piece_ends_where_the_robot_jumps_or_a_pose_is_missing(small):
    np.save(small / "positions" / "0000012.npy", np.array([np.nan, 0.0, 0.0]))
    for k in range(20, 30):
        np.save(small / "positions" / f"{k:07d}.npy", np.array([9.0, 9.0, 0.0]))
    np.save(small / "positions" / "0000029.npy", np.array([9.0, 9.0, 2.0 * math.pi + 1.0]))
    starts = [(round(item.rows[0].time, 6), len(item.rows)) for item in read_ogm(small)]
    assert starts == [(0.0, 12), (1.3, 7), (2.0, 9), (2.9, 1)]
    assert [len(item.rows) for item in read_ogm(small, min_duration=0.8)] == [12, 9]
    assert [len(item.rows) for item in read_ogm(small, duration=1.5)] == [12, 2]


def test_a_long_recording_is_cut_into_minutes(tmp_path):
    folder = write_split(tmp_path / "val", np.full((601, 3), 2.0), np.zeros((601, 3)))
    assert [len(item.rows) for item in read_ogm(folder)] == [301, 300]


def test_the_folder_of_a_split_or_of_the_data_set_is_found(hall, tmp_path):
    assert find_ogm_split(hall) == find_ogm_split(hall.parent) == hall
    assert find_ogm_split(tmp_path) is None


def test_the_command_scores_a_folder(hall, tmp_path, capsys):
    plot = tmp_path / "scans.png"
    assert main(["predict", "--perception", str(hall.parent), "--json", "--plot", str(plot)]) == 0
    document = json.loads(capsys.readouterr().out)
    assert list(document["scores"]) == ["last-scan", "moved-scan", "tracked-scene", "learned-scene"]
    assert (document["source"], document["ego"], document["past"], document["dilation"]) == ("test", "predicted", 10, 0)
    assert document["horizons"] == [0.1, 0.3, 0.5, 0.7, 1.0]
    late = {name: one["range_error"][4]["value"] for name, one in document["scores"].items()}
    assert late["tracked-scene"] < late["last-scan"]
    assert plot.stat().st_size > 20_000
    words = ["predict", "--perception", str(hall), "--scan-predictor", "last-scan", "--horizons", "0.2", "0.4"]
    assert main([*words, "--ego", "known", "--duration", "4"]) == 0
    shown = capsys.readouterr().out
    assert "test, scans, 1 piece\n" in shown
    assert "40 recorded scans, of which a forecast sees 10; no map; motion of the robot known" in shown
    assert "0.4 s" in shown
    assert "true-people" not in shown


def write_header(shape: str, kind: str = "<f4") -> bytes:
    """Return an NPY file without values."""
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text


def write_pickle() -> bytes:
    """Return an NPY file with a pickled object."""
    stream = io.BytesIO()
    np.save(stream, np.array([{}], dtype=object), allow_pickle=True)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"", "is not an NPY file of version 1.0 or 2.0"),
        (b"\x93NUMPY\x01\x00\x05\x00(((((", "is not an NPY file of version 1.0 or 2.0"),
        (b"\x93NUMPY\x07\x00\x05\x00{}   ", "is not an NPY file of version 1.0 or 2.0"),
        (write_pickle(), "has values of type object, it must have numbers"),
        (write_header("(100000000000,)"), "has 0 bytes of shape (100000000000,), it must have one row of float32"),
        (write_header("(3, 3)") + bytes(36), "it must have one row of float32"),
        (write_header("(8,)") + bytes(32), "has 8 ranges, a scan must have 9 as the scans before"),
        (bytes(200_000), "must be a file of at most 128 KiB"),
    ],
)
def test_a_damaged_scan_is_named(small, content, text):
    (small / "scans" / "0000004.npy").write_bytes(content)
    with pytest.raises(DataError) as error:
        read_ogm(small)
    assert "0000004.npy" in str(error.value)
    assert text in str(error.value)


@given(place=st.integers(0, 163), value=st.integers(0, 255), end=st.integers(0, 164))
def test_a_changed_byte_or_a_cut_file_gives_numbers_or_an_error(tmp_path_factory, place, value, end):
    stream = io.BytesIO()
    np.save(stream, np.arange(9, dtype=np.float32))
    content = bytearray(stream.getvalue())
    assert len(content) == 164
    content[place] = value
    file = tmp_path_factory.mktemp("npy") / "a.npy"
    file.write_bytes(content[: end or None])
    try:
        npy_row = read_npy_row(file)
    except DataError as error:
        assert "a.npy" in str(error)  # noqa: PT017
    else:
        assert npy_row.ndim == 1
        assert npy_row.size <= 36


@pytest.mark.parametrize("name", ["../positions/0000001.npy", "/etc/a.npy", "a\\b.npy", "C:a.npy", "..", "a.txt"])
def test_a_name_outside_the_folder_is_refused(small, name):
    (small / "scans" / "test.txt").write_text(f"0000000.npy\n{name}\n")
    with pytest.raises(DataError, match=r"test.txt line 2 is .*, it must be the name of a file \*.npy in"):
        read_ogm(small)


def test_a_link_out_of_the_folder_is_refused(small, tmp_path):
    np.save(tmp_path / "secret.npy", np.ones(9))
    (small / "scans" / "0000005.npy").unlink()
    (small / "scans" / "0000005.npy").symlink_to(tmp_path / "secret.npy")
    with pytest.raises(DataError, match=r"0000005.npy is a link out of"):
        read_ogm(small)
    (small / "scans" / "0000005.npy").unlink()
    (small / "scans" / "0000005.npy").symlink_to(small / "scans" / "0000005.npy")
    with pytest.raises(DataError, match=r"0000005.npy (cannot be read|must be a file)"):
        read_ogm(small)


def test_lists_and_positions_must_fit(small):
    np.save(small / "positions" / "0000002.npy", np.zeros(7))
    with pytest.raises(DataError, match="0000002.npy has 7 numbers, a position has 3: x, y and heading"):
        read_ogm(small)
    names = (small / "positions" / "test.txt").read_text().splitlines()
    (small / "positions" / "test.txt").write_text("\n".join(names[:20]))
    with pytest.raises(DataError, match="30 scans and 20 positions are listed, one each is needed"):
        read_ogm(small)
    (small / "positions" / "test.txt").write_text("")
    with pytest.raises(DataError, match="has 0 names, 1 to 200000 are read"):
        read_ogm(small)
    (small / "positions" / "test.txt").unlink()
    with pytest.raises(DataError, match=r"has 0 lists \*.txt, it must have one or test.txt"):
        read_ogm(small)
    with pytest.raises(DataError, match="must have the folders scans and positions, or a folder test that has them"):
        read_ogm(small / "scans")
    with pytest.raises(InputError, match="duration = -1 s must be above 0"):
        read_ogm(small, duration=-1.0)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--starts", "2"], "--starts, --seed and --trial are for trials; a folder has recorded scans"),
        (["--sensor", "robot/scan"], "--sensor robot/scan is for trials and episodes; a folder has one scanner"),
        (["--duration", "1"], "10 scans have no more than 1.9 s in which the position is finite and does not jump"),
        (["--horizons", "-1"], "horizons"),
        (["--duration", "nan"], "duration = nan s must be above 0"),
    ],
)
def test_wrong_options_are_one_sentence(small, words, text, capsys):
    assert main(["predict", "--perception", str(small), *words]) == 2
    assert text in capsys.readouterr().err


def test_a_folder_of_another_layout_is_refused(tmp_path, capsys):
    assert main(["predict", "--perception", str(tmp_path)]) == 2
    assert "must have the folders scans and positions" in capsys.readouterr().err
