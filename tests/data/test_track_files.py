"""What is written comes back: rows to the last bit, and beside them what each format can hold."""

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import DataError, InputError
from crowdbot.data import FORMATS, PrimaryScene, Trajectories, load, save

finite = st.floats(-1e12, 1e12)


@st.composite
def recordings_of_people(draw):
    """Return small tracks at any finite place, by frames that are 10 apart."""
    keys = draw(st.lists(st.tuples(st.integers(-5, 20), st.integers(0, 9)), min_size=1, max_size=40, unique=True))
    place = draw(st.lists(st.tuples(finite, finite), min_size=len(keys), max_size=len(keys)))
    frame, id = zip(*[(10 * frame, id) for frame, id in keys], strict=True)
    x, y = zip(*place, strict=True)
    return Trajectories(id, frame, x, y, row_rate=draw(st.sampled_from([2.5, 25.0, 29.97, 100 / 3])), frame_step=10)


def same_rows(one, other):
    """Return whether every row is the same to the last bit."""
    return all(getattr(one, n).tobytes() == getattr(other, n).tobytes() for n in ("id", "frame", "x", "y"))


@pytest.mark.parametrize("suffix", ["txt", "csv", "parquet", "ndjson"])
@given(tracks=recordings_of_people())
@settings(deadline=None, max_examples=30)
def test_rows_come_back_exactly(tmp_path_factory, suffix, tracks):
    path = tmp_path_factory.mktemp("tracks") / f"tracks.{suffix}"
    save(tracks, path)
    back = load(path, fps=tracks.fps if suffix in ("txt", "csv") else None)
    assert same_rows(tracks, back)
    if suffix in ("txt", "csv"):
        assert back.fps == pytest.approx(tracks.fps, rel=1e-12)
    else:
        assert back.row_rate == tracks.row_rate
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def rich():
    """Return tracks with everything that can stand beside rows."""
    rows = 30
    return Trajectories(
        np.repeat([4, 7, 8], rows),
        np.tile(np.arange(rows) * 3, 3),
        np.linspace(0.0, 1.0, 3 * rows) / 3.0,
        np.linspace(5.0, -1.0, 3 * rows) / 7.0,
        row_rate=100 / 3,
        units="px",
        homography=np.array([[0.1, 0.0, 1.0], [0.0, 0.2, 0.0], [0.0, 0.0, 1.0]]) / 3.0,
        note="a note, with a comma",
        robots=frozenset({8}),
        walls=(np.array([[0.0, 0.0], [1.0, 1.0 / 3.0]]), np.array([[2.0, 2.0], [3.0, 2.0], [3.0, 3.0]])),
        labels={4: "Pedestrian, old", 7: 'Biker "fast"'},
        scenes=(PrimaryScene(0, 4, 0, 60, (3, 2)), PrimaryScene(1, 7, 0, 60)),
    )


def test_parquet_keeps_everything(tmp_path):
    tracks = rich()
    save(tracks, tmp_path / "all.parquet")
    back = load(tmp_path / "all.parquet")
    assert same_rows(tracks, back)
    for name in ("row_rate", "frame_step", "units", "note", "robots", "labels", "scenes"):
        assert getattr(back, name) == getattr(tracks, name)
    assert back.homography.tobytes() == tracks.homography.tobytes()
    assert [ring.tobytes() for ring in back.walls] == [ring.tobytes() for ring in tracks.walls]
    assert load(tmp_path / "all.parquet", fps=5.0, units="m").fps == pytest.approx(5.0)


def test_csv_keeps_times_labels_robots_and_pixels(tmp_path):
    tracks = rich()
    save(tracks, tmp_path / "all.csv")
    assert (tmp_path / "all.csv").read_text().startswith("id,frame,time,x_px,y_px,label\n4,0,0.0,")
    back = load(tmp_path / "all.csv")
    assert same_rows(tracks, back)
    assert back.row_rate == pytest.approx(tracks.row_rate, rel=1e-12)
    assert (back.units, back.robots, back.labels) == ("px", tracks.robots, tracks.labels)


def test_ndjson_keeps_scenes_or_makes_them(tmp_path):
    tracks = rich()
    save(tracks, tmp_path / "kept.ndjson")
    back = load(tmp_path / "kept.ndjson", units="px")
    assert same_rows(tracks, back)
    assert (back.scenes, back.row_rate) == (tracks.scenes, tracks.row_rate)
    plain = Trajectories(tracks.id, tracks.frame, tracks.x, tracks.y, row_rate=2.5, robots=frozenset({8}))
    save(plain, tmp_path / "made.ndjson")
    assert load(tmp_path / "made.ndjson").scenes == (PrimaryScene(0, 4, 0, 60), PrimaryScene(1, 7, 0, 60))


@pytest.mark.parametrize("suffix", ["txt", "csv", "parquet", "ndjson"])
def test_a_real_recording_survives_every_format(recordings, tmp_path, suffix):
    tracks = load(recordings / "eth_ucy_splits/all_data/crowds_zara01.txt")
    save(tracks, tmp_path / f"zara.{suffix}")
    back = load(tmp_path / f"zara.{suffix}")
    assert same_rows(tracks, back)
    assert (back.row_rate, back.frame_step, back.units) == (2.5, 10, "m")


def test_the_format_may_be_given(tmp_path):
    save(rich(), tmp_path / "tracks.dat", format="csv")
    assert len(load(tmp_path / "tracks.dat", format="csv")) == 90
    assert len(load(str(tmp_path / "tracks.dat"))) == 90


def test_writing_is_all_or_nothing(tmp_path, monkeypatch):
    path = tmp_path / "tracks.csv"
    path.write_text("precious")

    def broken(tracks, file):
        file.write(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setitem(save.__globals__["_WRITERS"], "csv", broken)
    with pytest.raises(DataError, match="cannot write .*: No space left on device"):
        save(rich(), path)
    assert path.read_text() == "precious"
    assert [file.name for file in tmp_path.iterdir()] == ["tracks.csv"]


def test_where_nothing_can_be_written(tmp_path):
    with pytest.raises(DataError, match="cannot write .*: No such file or directory"):
        save(rich(), tmp_path / "missing" / "tracks.csv")
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(DataError, match="cannot write"):
        save(rich(), tmp_path / "folder.csv")
    with pytest.raises(InputError, match=r"no format has the suffix '\.xls'; suffixes are \.txt, \.csv"):
        save(rich(), tmp_path / "tracks.xls")
    with pytest.raises(InputError, match="unknown format 'parket' to write, did you mean 'parquet'"):
        save(rich(), tmp_path / "tracks.xls", format="parket")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["folder.csv"]


@pytest.mark.parametrize(
    "text",
    [
        "id,frame,x,y\n1,0,2.5,3\n1,10,2.75,3\n",
        "Frame;Ped_ID;Y;X\n0;1;3;2.5\n10;1;3;2.75\n",
        "# from a tracker\nframe_id\ttrack_id\tpos_x\tpos_y\n0\t1\t2.5\t3\n\n10\t1\t2.75\t3\n",
        "person frame x/cm y/cm\n1 0 250 300\n1 10 275 300\n",
        "id,frame,x [mm],y [mm],z\n1,0,2500,3000,\n1,10,2750,3000,\n",
        '"agent_id","t","x_m","y_m"\n"bob",5.0,2.5,3\n"bob",5.4,2.75,3\n',
        "time,id,x,y\n100.0,1,2.5,3\n100.4,1,2.75,3\n",
        "0,1,2.5,3\n10,1,2.75,3\n",
        "\ufeff0 1 2.5 3\r\n10 1 2.75 3\r\n",
    ],
)
def test_the_names_and_marks_that_people_use(tmp_path, text):
    path = tmp_path / "theirs.csv"
    path.write_text(text, encoding="utf-8", newline="")
    tracks = load(path)
    assert (tracks.x.tolist(), tracks.y.tolist(), tracks.id.tolist()) == ([2.5, 2.75], [3.0, 3.0], [1, 1])
    assert tracks.dt == pytest.approx(0.4)


def test_words_as_ids_are_numbered_and_said(tmp_path):
    path = tmp_path / "words.csv"
    path.write_text("id,frame,x,y\nbob,0,0,0\nada,0,1,1\nbob,10,0,1\n")
    tracks = load(path)
    assert tracks.id.tolist() == [1, 2, 1]
    assert "ids are words; they are numbered in order of appearance, 'bob' is 1" in tracks.note


def test_exchanged_columns_are_noticed(tmp_path):
    rows = [(k, person, 0.01 * k + person, 2.0 * person) for person in range(1, 9) for k in range(0, 200, 10)]
    path = tmp_path / "tracks.txt"
    path.write_text("".join(f"{frame} {id} {x} {y}\n" for frame, id, x, y in rows))
    assert "exchanged" not in load(path).note
    path.write_text("".join(f"{id} {frame} {x} {y}\n" for frame, id, x, y in rows))
    assert "id and frame seem to be swapped" in load(path, fps=2.5).note
    right = load(path, format="petrack", fps=25, units="m")
    assert (len(right.ids), right.frame_step, right.dt) == (8, 10, 0.4)


@pytest.mark.program
def test_importing_the_room_is_light():
    program = "import sys, crowdbot.data; print([m for m in sys.modules if '.' not in m])"
    loaded = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True, text=True).stdout
    heavy = ("numba", "pandas", "pyarrow", "h5py", "mcap", "rosbags", "shapely", "matplotlib", "sqlite3")
    assert [name for name in heavy if f"'{name}'" in loaded] == []


def test_every_format_says_what_it_is():
    assert len(FORMATS) == 28
    assert all(about and not about.endswith(".") for about in FORMATS.values())


@pytest.mark.parametrize("frames", [False, True])
def test_the_clock_of_a_file_is_kept(tmp_path, frames):
    head, rows = ("id,frame,time,x,y" if frames else "id,time,x,y"), []
    for k in range(12):
        rows.append(f"1,{f'{30 + k},' * frames}{1700.5 + 0.1 * k:.1f},{0.1 * k:.1f},0")
    (tmp_path / "clock.csv").write_text("\n".join([head, *rows]) + "\n")
    tracks = load(tmp_path / "clock.csv")
    assert tracks.clock[[0, -1]].tolist() == pytest.approx([1700.5, 1701.6])
    assert tracks.time[0] == 0.0
    assert tracks.split(0.5)[1].clock[0] == pytest.approx(1701.1)
    for step in (0.2, 0.15):
        assert tracks.resample(step).clock[:2].tolist() == pytest.approx([1700.5, 1700.5 + step])
    for name in ("again.csv", "again.parquet"):
        save(tracks, tmp_path / name)
        assert load(tmp_path / name).clock.tolist() == pytest.approx(tracks.clock.tolist())
