"""Files for JuPedSim, PedPy and PeTrack are read back exactly."""

import sqlite3

import numpy as np
import pytest
import shapely

from crowdbot.core import DataError
from crowdbot.data import Trajectories, load, save

WALLS = (
    np.array([(-1.0, -1.0), (-1.0, 6.0), (9.0, 6.0), (9.0, -1.0)]),
    np.array([(3.0, 1.0), (4.0, 1.0), (4.0, 2.0), (3.0, 2.0)]),
)


def crowd(step=1, **values):
    rng = np.random.default_rng(4)
    id, frame = np.tile([3, 5, 8], 6), step * np.repeat(np.arange(2, 8), 3)
    x, y = rng.uniform(0.0, 8.0, (2, 18))
    return Trajectories(id, frame, x, y, row_rate=2.5, frame_step=step, walls=WALLS, **values)


@pytest.mark.parametrize(("file", "format"), [("a.sqlite", None), ("a.txt", "petrack")])
@pytest.mark.parametrize("step", [1, 10])
def test_rows_and_times_come_back_exactly(tmp_path, file, format, step):
    tracks = crowd(step)
    save(tracks, tmp_path / file, format)
    back = load(tmp_path / file)
    assert (back.frame_step, back.row_rate) == (1, 2.5)
    np.testing.assert_array_equal(back.frame, tracks.frame // step)
    for name in ("id", "x", "y", "time"):
        np.testing.assert_array_equal(getattr(back, name), getattr(tracks, name))
    if format is None:
        areas = [shapely.Polygon(WALLS[0], [WALLS[1]]), shapely.Polygon(back.walls[0], [back.walls[1]])]
        assert areas[0].equals(areas[1])


def test_frames_off_the_step_are_kept(tmp_path):
    tracks = Trajectories([1, 1, 1, 2], [0, 10, 20, 13], [0.0, 1.0, 2.0, 5.0], [0.0] * 4, row_rate=2.5)
    save(tracks, tmp_path / "a.sqlite")
    back = load(tmp_path / "a.sqlite")
    assert back.frame.tolist() == [0, 10, 13, 20]
    assert back.fps == 25.0


def test_people_look_where_they_walk(tmp_path):
    tracks = Trajectories(
        [1] * 4 + [2], [0, 1, 2, 3, 0], [0.0, 0.0, 0.0, 2.0, 4.0], [0.0, 3.0, 3.0, 3.0, 4.0], row_rate=1
    )
    save(tracks, tmp_path / "a.sqlite")
    base = sqlite3.connect(tmp_path / "a.sqlite")
    rows = base.execute("SELECT ori_x, ori_y FROM trajectory_data ORDER BY id, frame").fetchall()
    metadata = dict(base.execute("SELECT key, value FROM metadata"))
    base.close()
    assert rows == [(0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (1.0, 0.0), (1.0, 0.0)]
    assert (metadata["version"], metadata["fps"], metadata["xmax"]) == ("2", "1.0", "5.0")


@pytest.mark.parametrize(("file", "format"), [("a.sqlite", None), ("a.txt", "petrack")])
def test_pixels_are_refused_and_nothing_is_written(tmp_path, file, format):
    with pytest.raises(DataError, match="in pixels; .* files are in metres"):
        save(crowd(units="px"), tmp_path / file, format)
    assert list(tmp_path.iterdir()) == []
