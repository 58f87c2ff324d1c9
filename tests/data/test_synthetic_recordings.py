"""Every reader on synthetic files: the format is detected, and people, frames, seconds and metres come out right."""

import numpy as np
import pytest
from synthetic_recordings import PEOPLE, SHORT, SYNTHETIC, walkers, write_all

from crowdbot.core import DataError
from crowdbot.data import FORMATS, RowRateError, load
from crowdbot.data.source import Source

ON_FRAMES = [name for name, item in SYNTHETIC.items() if item.step > 1]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return write_all(tmp_path_factory.mktemp("synthetic"))


SHIFTS = {"annotations.txt": (400 / 30, -400 / 30), "mot.txt": (20.25, 22.0), "cvml.xml": (20.0, 20.0),
          "tracks.01Sep.txt": (20.0, 20.0), "grand-central/000001.txt": (20.0, 20.0)}  # fmt: skip
"""Metres between the origin of a picture and that of the walkers."""
FROM_FIRST_ROW = ("times.csv", "occupants.csv", "square.pp", "atc-20121024.csv")
"""Files of times, whose frames begin with 0 at the first row."""
NEAR = {"ucy-vsp": 0.06, "sdd": 0.06, "wildtrack": 0.04, "edinburgh": 0.025, "grand-central": 0.02}
"""Largest distance from the walkers [m], if positions are rounded."""


def loaded(files, name, **options):
    if name == "grand-central/000001.txt":
        return load(files[name].parent, **options)
    return load(files[name], **{**dict(SYNTHETIC[name].options), **options})


def test_every_format_has_a_synthetic_recording():
    assert {item.format for item in SYNTHETIC.values()} == set(FORMATS)


@pytest.mark.parametrize("name", SYNTHETIC)
def test_the_format_is_detected(files, name):
    from crowdbot.data.file_formats import _detect

    assert _detect(Source.of(files[name])).name == SYNTHETIC[name].format


@pytest.mark.parametrize("name", SYNTHETIC)
def test_people_are_where_they_walk_at_their_times(files, name):
    one, tracks = SYNTHETIC[name], loaded(files, name)
    assert (tracks.frame_step, tracks.units, tracks.robots) == (one.step, one.units, one.robots)
    assert tracks.fps == pytest.approx(one.fps, rel=1e-9)
    assert tracks.dt == pytest.approx(one.step / one.fps, rel=1e-9)
    people = [id for id in tracks.ids.tolist() if id not in tracks.robots]
    assert len(people) == PEOPLE
    whole = one.format != "social-ways" and name != "gates_2.txt"
    for id, walker in zip(people, walkers(), strict=True):
        track = tracks.track(id)
        path = track.metres(np.diag([1 / one.scale[0], 1 / one.scale[1], 1.0])) if one.units == "px" else track
        x, y = path.position[:, 0], path.position[:, 1]
        x, y = x - SHIFTS.get(name, (0, 0))[0], y - SHIFTS.get(name, (0, 0))[1]
        if one.format == "wildtrack":
            x = (x - 3.0) / 0.6
        seconds = track.frame / one.fps if name not in FROM_FIRST_ROW else track.frame / one.fps + first_time(tracks)
        expected = np.array([walker.at(time) for time in seconds])
        near = NEAR.get(one.format, 0.006)
        assert np.hypot(x - expected[:, 0], y - expected[:, 1]).max() < near
        if whole:
            assert track.time[-1] == pytest.approx(walker.end - walker.begin, abs=2.0 * tracks.dt)


def first_time(tracks):
    """Return the time [s] of the first row: frames of a table of times begin with 0 there."""
    return min(walker.begin for walker in walkers()) if len(tracks) else 0.0


def test_hidden_rows_and_lost_rows_are_dropped(files):
    hidden = load(files["gates_2.txt"])
    assert np.unique(hidden.id, return_counts=True)[1].tolist() == [SHORT] * PEOPLE
    assert "rows with '?' are excluded" in hidden.note
    boxes = load(files["annotations.txt"])
    assert f"{PEOPLE} rows marked lost are excluded" in boxes.note
    assert sorted(set(boxes.labels.values())) == ["Biker", "Pedestrian"]
    assert len(boxes.only("Biker").ids) == 3


def test_road_users_have_classes_and_boxes_are_relative_to_the_robot(files, tmp_path):
    tracks = load(files["07_tracks.csv"])
    assert len(tracks.only("pedestrian").ids) == 9
    assert tracks.note == ""
    lone = tmp_path / "07_tracks.csv"
    lone.write_bytes(files["07_tracks.csv"].read_bytes())
    assert "25 Hz is assumed" in load(lone).note
    (tmp_path / "07_recordingMeta.csv").write_text("recordingId,frameRate\n7,fast\n")
    with pytest.raises(DataError, match="the frame rate 'fast' of the recording is not a number"):
        load(lone)
    labels = load(files["cubberly.json"])
    assert set(labels.labels.values()) == {"pedestrian"}
    assert "coordinates of the robot, which moves" in labels.note
    (tmp_path / "cut.json").write_text(files["cubberly.json"].read_text()[:-40])
    with pytest.raises(DataError, match=r"cut.json is not a file of JRDB labels, or is damaged"):
        load(tmp_path / "cut.json")


def test_units_of_petrack_come_from_the_header_or_the_size(files):
    metres, centimetres = load(files["petrack_m.txt"]), load(files["petrack_cm.txt"])
    assert np.abs(metres.position - centimetres.position).max() < 1e-4
    hermes = load(files["uo-050.txt"])
    assert "interpreted as cm" in hermes.note
    assert "16 Hz is assumed" in hermes.note
    assert load(files["uo-050.txt"], units="m").x[0] == pytest.approx(100.0 * hermes.x[0])


@pytest.mark.parametrize("name", ["00_01a.h5", "trajectories.sqlite"])
def test_the_walkable_area_becomes_walls(files, name):
    assert [len(ring) for ring in load(files[name]).walls] == [4, 4]


def test_scenes_walls_and_robots(files):
    assert [(scene.person, scene.tag) for scene in load(files["hotel.ndjson"]).scenes] == [
        (id, (3, 2)) for id in range(1, PEOPLE + 1)
    ]
    recorded = load(files["episode.mcap"])
    assert [ring.tolist() for ring in recorded.walls] == [[[0.0, 6.0], [4.0, 6.0]]]
    robot = recorded.track(40)
    assert np.allclose(robot.x, -5.0 + 0.5 * robot.frame / 10.0)


@pytest.mark.parametrize("name", [name for name in SYNTHETIC if name not in (*FROM_FIRST_ROW, "square.traj")])
def test_fps_is_frames_per_second_in_every_reader(files, name):
    one = SYNTHETIC[name]
    slow = loaded(files, name, fps=one.fps * 0.8)
    assert slow.dt == pytest.approx(one.step / (one.fps * 0.8), rel=1e-9)
    assert slow.fps == pytest.approx(one.fps * 0.8, rel=1e-9)
    assert np.array_equal(slow.x, loaded(files, name).x)


@pytest.mark.parametrize("name", ON_FRAMES)
def test_fps_that_is_rows_per_second_is_refused(files, name):
    one = SYNTHETIC[name]
    rows_per_second = one.fps / one.step
    if one.step == 2:
        assert loaded(files, name, fps=rows_per_second).dt == pytest.approx(2.0 / 25.0)  # 0.6 m/s: slow, but possible
        return
    with pytest.raises(
        RowRateError, match=f"fps is frames per second, for {rows_per_second:g} rows per second give fps"
    ) as error:
        loaded(files, name, fps=rows_per_second)
    assert error.value.fps == pytest.approx(one.fps)


def test_times_without_frames_take_fps_as_frames_per_second(files):
    assert load(files["times.csv"], fps=2.5).frame_step == 1
    fine = load(files["times.csv"], fps=25)
    assert (fine.frame_step, fine.dt) == (10, 0.4)


def test_a_table_with_every_tenth_frame(tmp_path):
    path = tmp_path / "tracker.csv"
    path.write_text("id,frame,x,y\n" + "".join(f"1,{10 * k},{0.5 * k},0\n" for k in range(5)))
    tracks = load(path, fps=25)
    assert (tracks.dt, tracks.fps, tracks.frame_step, tracks.note) == (0.4, 25.0, 10, "")
    assert tracks.velocities()[1:, 0].tolist() == pytest.approx([1.25] * 4)


@pytest.mark.parametrize(("metres", "fps", "warned"), [(0.5, 2.5, False), (0.5, 25, True), (0.001, 2.5, True)])
def test_speeds_that_are_impossible_for_people_are_noted(tmp_path, metres, fps, warned):
    path = tmp_path / "rows.csv"
    path.write_text("id,frame,x,y\n" + "".join(f"1,{k},{metres * k},0\n" for k in range(5)))
    assert ("is impossible for people: check the frame rate (fps) and the units" in load(path, fps=fps).note) is warned


def test_a_row_rate_is_refused_by_speed_alone(tmp_path):
    path = tmp_path / "two.csv"
    path.write_text("id,frame,x,y\n" + "".join(f"1,{18 * k},{0.02 * k},0\n" for k in range(5)))
    with pytest.raises(RowRateError, match=r"time step 1.5 s \(18 frames per row\) and the median speed 0.013"):
        load(path, fps=12)
    assert load(path, fps=16).dt == 1.125
    assert load(path, fps=0.4).dt == 45.0


def test_a_sparse_track_at_a_video_rate_is_not_a_row_rate(tmp_path):
    path = tmp_path / "sparse.csv"
    path.write_text("id,frame,x,y\n1,0,0,0\n1,250,10,0\n")
    assert load(path, fps=25).dt == 10.0


def test_pixels_are_judged_by_the_time_step_alone(tmp_path):
    path = tmp_path / "pixels.csv"
    path.write_text("id,frame,x,y\n" + "".join(f"1,{12 * k},{30 * k},0\n" for k in range(5)))
    assert load(path, fps=30, units="px").dt == 0.4
    with pytest.raises(RowRateError, match=r"time step 4.8 s \(12 frames per row\); fps is frames"):
        load(path, fps=2.5, units="px")
