"""Every family of real recordings loads, with the rows, people, frames and units that its table tells."""

import numpy as np
import pytest

from crowdbot.core import DataError
from crowdbot.data import UCY_TO_METRES, load

# path: rows, ids, first frame, last frame, frame step, dt [s], units
TABLE = {
    "eth_biwi/seq_eth/obsmat.txt": (8908, 360, 780, 12381, 6, 0.4, "m"),
    "eth_biwi/seq_eth/biwi_eth_10fps.txt": (5492, 360, 780, 12380, 10, 2 / 3, "m"),
    "eth_biwi/seq_hotel/obsmat.txt": (6544, 390, 1, 18061, 10, 0.4, "m"),
    "ucy/zara01/obsmat.txt": (5024, 148, 1, 9011, 10, 0.4, "m"),
    "ucy/zara02/obsmat.txt": (9537, 204, 7, 10517, 10, 0.4, "m"),
    "ucy/zara03/crowds_zara03.txt": (3600, 180, 0, 7480, 10, 0.4, "m"),
    "ucy/students03/obsmat.txt": (21846, 428, 1, 5391, 10, 0.4, "m"),
    "ucy/students03/obsmat_px.txt": (21859, 428, 1, 5391, 10, 0.4, "px"),
    "ucy/students01/students001.txt": (21813, 415, 0, 4430, 10, 0.4, "m"),
    "ucy/students01/students001-trajnet.txt": (17820, 891, 0, 4430, 10, 0.4, "m"),
    "ucy/zara01/annotation.vsp": (50172, 148, 0, 9014, 1, 0.04, "px"),
    "ucy/zara02/annotation.vsp": (95342, 204, 6, 10518, 1, 0.04, "px"),
    "ucy/zara03/annotation.vsp": (48804, 137, 0, 7526, 1, 0.04, "px"),
    "ucy/students01/annotation.vsp": (214463, 415, 0, 4433, 1, 0.04, "px"),
    "ucy/students03/annotation.vsp": (175687, 434, 0, 5404, 1, 0.04, "px"),
    "ucy/uni_examples/annotation.vsp": (26381, 118, 0, 7413, 1, 0.04, "px"),
    "eth_ucy_splits/all_data/biwi_eth.txt": (5492, 360, 780, 12380, 10, 2 / 3, "m"),
    "eth_ucy_splits/all_data/biwi_hotel.txt": (6543, 389, 0, 18060, 10, 0.4, "m"),
    "eth_ucy_splits/all_data/uni_examples.txt": (2747, 118, 0, 7410, 10, 0.4, "m"),
    "sdd/gates/video2/annotations.txt": (56709, 125, 0, 9005, 1, 1 / 30, "px"),
    "sdd_trajnet/Train/stanford/hyang_6.txt": (6540, 327, 0, 9780, 12, 0.4, "m"),
    "sdd_trajnet/Test/stanford/gates_2.txt": (155 * 8, 155, 0, 8844, 12, 0.4, "m"),
    "hermes/Corridor-1D/uo-050-180-180.txt": (9712, 61, 43, 1017, 1, 1 / 16, "m"),
    "hermes/Corridor-1D/uo-180-180-070.txt": (75336, 148, 218, 1817, 1, 1 / 16, "m"),
    "hermes/Corridor-1D/uo-180-180-120.txt": (54981, 170, 60, 1371, 1, 1 / 16, "m"),
    "hermes/Corridor-1D/uo-080-240-240.txt": (18780, 118, 538, 1672, 1, 1 / 16, "m"),
    "hermes/Corridor-2D/bo-360-090-090.txt": (38689, 214, 102, 1160, 1, 1 / 16, "m"),
    "hermes/Corridor-2D/bot-360-075-075.txt": (21811, 127, 47, 921, 1, 1 / 16, "m"),
    "juelich/bottleneck/040_c_56_h-.txt": (63110, 75, 0, 1656, 1, 0.04, "m"),
    "juelich/bidirectional/bi_corr_400_b_03.txt": (120790, 480, 94, 3340, 1, 0.04, "m"),
    "juelich/single_file/00_01a.h5": (30701, 46, 0, 942, 1, 0.04, "m"),
    "juelich/single_file/n56_cam1.csv": (2391, 53, 1010, 4990, 10, 0.4, "m"),
    "juelich/jupedsim_simulated/trajectories.sqlite": (8083, 30, 0, 490, 1, 0.04, "m"),
    "trajnetpp/biwi_hotel.ndjson": (4621, 263, 500, 17970, 10, 0.4, "m"),
    "trajnetpp/crowds_zara01.ndjson": (4965, 148, 10, 9000, 10, 0.4, "m"),
    "trajnetpp/crowds_zara03.ndjson": (4825, 137, 10, 7510, 10, 0.4, "m"),
    "trajnetpp/crowds_students001.ndjson": (21335, 415, 10, 4430, 10, 0.4, "m"),
}


@pytest.mark.parametrize("path", TABLE)
def test_a_recording_loads_as_its_table_tells(recordings, path):
    tracks = load(recordings / path)
    found = (len(tracks), len(tracks.ids), tracks.frame[0], tracks.frame[-1], tracks.frame_step, tracks.dt)
    rows, people, first, last, step, dt, units = TABLE[path]
    assert found == (rows, people, first, last, step, pytest.approx(dt, rel=1e-12))
    assert tracks.units == units
    assert tracks.name == path.rpartition("/")[2]


@pytest.mark.parametrize("folder", ["all_data", "train", "val"])
def test_every_leave_one_out_file_loads(recordings, folder):
    paths = sorted((recordings / "eth_ucy_splits" / folder).glob("*.txt"))
    dts = {path.name.split(".")[0].removesuffix(f"_{folder}"): load(path).dt for path in paths}
    assert len(dts) == 8
    assert dts.pop("biwi_eth") == pytest.approx(2 / 3)
    assert set(dts.values()) == {0.4}


def test_every_raw_drone_annotation_loads_with_labels(recordings):
    paths = sorted((recordings / "sdd").rglob("annotations.txt"))
    assert len(paths) >= 11
    for path in paths:
        tracks = load(path)
        assert set(tracks.labels) == set(tracks.ids.tolist())
        assert set(tracks.labels.values()) <= {"Pedestrian", "Biker", "Skater", "Cart", "Car", "Bus"}


def test_every_trajnet_cut_has_twenty_rows_a_track(recordings):
    paths = sorted((recordings / "sdd_trajnet" / "Train").rglob("*.txt"))
    assert len(paths) == 9
    for path in paths:
        assert set(np.unique(load(path).id, return_counts=True)[1]) == {20}


def test_lost_rows_are_dropped_and_labels_filter(recordings):
    tracks = load(recordings / "sdd/gates/video2/annotations.txt")
    kinds = {label: sum(other == label for other in tracks.labels.values()) for label in set(tracks.labels.values())}
    assert kinds == {"Pedestrian": 56, "Biker": 67, "Skater": 2}
    walkers = tracks.only("Pedestrian")
    assert len(walkers.ids) == 56
    assert set(walkers.labels.values()) == {"Pedestrian"}
    assert "42557 rows marked lost are excluded" in tracks.note
    with pytest.raises(DataError, match="no track labelled 'Pedestrians', did you mean 'Pedestrian'"):
        tracks.only("Pedestrians")


def test_the_ground_plane_of_obsmat_agrees_with_its_velocity_columns(recordings):
    path = recordings / "eth_biwi/seq_eth/obsmat.txt"
    columns = np.loadtxt(path)
    told = np.hypot(columns[:, 5], columns[:, 7]).mean()
    assert load(path).summary()["mean_speed"] == pytest.approx(told, abs=0.01)


def test_the_eth_text_has_two_time_bases(recordings):
    path = recordings / "eth_ucy_splits/all_data/biwi_eth.txt"
    true, published, given = load(path), load(path, time_base="published"), load(path, fps=30.0)
    assert (true.dt, published.dt, given.dt) == pytest.approx((2 / 3, 0.4, 1 / 3))
    assert "time base true" in true.note
    assert "time base published" in published.note
    assert true.summary()["mean_speed"] == pytest.approx(1.38, abs=0.01)
    assert published.summary()["mean_speed"] == pytest.approx(2.29, abs=0.01)
    assert np.array_equal(true.x, published.x)
    hotel = recordings / "eth_ucy_splits/all_data/biwi_hotel.txt"
    assert load(hotel).dt == load(hotel, time_base="published").dt == 0.4


def test_ucy_splines_become_the_published_tracks(recordings):
    for scene, text, known in (("zara01", "crowds_zara01", True), ("students03", "students003", True)):
        splines = load(recordings / f"ucy/{scene}/annotation.vsp").metres().resample(0.4)
        published = load(recordings / f"eth_ucy_splits/all_data/{text}.txt")
        ours = {(f, i): (x, y) for f, i, x, y in zip(splines.frame, splines.id, splines.x, splines.y, strict=True)}
        rows = zip(published.frame, published.id, published.x, published.y, strict=True)
        away = [np.hypot(ours[f, i][0] - x, ours[f, i][1] - y) for f, i, x, y in rows if (f, i) in ours]
        assert known
        assert len(away) > 0.9 * len(published)
        assert np.median(away) < 0.01


def test_an_unfitted_vsp_says_that_it_has_no_map(recordings):
    tracks = load(recordings / "ucy/students01/annotation.vsp")
    with pytest.raises(DataError, match="in pixels and has no homography"):
        tracks.metres()
    metres = tracks.metres(UCY_TO_METRES)
    assert metres.units == "m"
    assert np.all((metres.x > -1.0) & (metres.x < 16.0))


def test_trajnetpp_keeps_its_scenes(recordings):
    counts = {"biwi_hotel": 229, "crowds_zara01": 1017, "crowds_zara03": 955, "crowds_students001": 5265}
    for name, count in counts.items():
        tracks = load(recordings / f"trajnetpp/{name}.ndjson")
        assert len(tracks.scenes) == count
    scene = load(recordings / "trajnetpp/biwi_hotel.ndjson").scenes[0]
    assert tuple(scene) == (0, 24, 500, 700, (3, 2))


def test_juelich_units_rates_and_walls(recordings):
    assert abs(load(recordings / "juelich/bidirectional/bi_corr_400_b_03.txt").position).max() < 10.0
    hermes = load(recordings / "hermes/Corridor-1D/uo-080-240-240.txt")
    assert "interpreted as cm" in hermes.note
    assert "16 Hz is assumed" in hermes.note
    assert hermes.time[-1] == pytest.approx(70.9, abs=0.05)
    given = load(recordings / "hermes/Corridor-1D/uo-080-240-240.txt", fps=25.0, units="m")
    assert given.dt == 0.04
    assert "m/s is impossible for people: check the frame rate (fps) and the units" in given.note
    assert given.x[0] == pytest.approx(100.0 * hermes.x[0])
    assert [len(ring) for ring in load(recordings / "juelich/single_file/00_01a.h5").walls] == [4, 4, 4]
    simulated = load(recordings / "juelich/jupedsim_simulated/trajectories.sqlite").walls[0]
    turn = np.sum(simulated[:, 0] * np.roll(simulated[:, 1], -1) - simulated[:, 1] * np.roll(simulated[:, 0], -1))
    assert turn < 0.0  # clockwise: a room that people are in


def test_hidden_futures_are_left_out_and_counted(recordings):
    tracks = load(recordings / "sdd_trajnet/Test/stanford/gates_2.txt")
    assert "1860 rows with '?' are excluded" in tracks.note
    with pytest.raises(DataError, match="the longest of 155 tracks has 8 rows and 20 are needed"):
        tracks.windows()


def test_tables_of_other_projects(recordings):
    people = load(recordings / "citr/vci_front/front_interaction_01_traj_ped_filtered.csv", fps=29.97)
    cart = load(recordings / "citr/vci_front/front_interaction_01_traj_veh_filtered.csv", fps=29.97)
    assert len(people.ids) in range(8, 11)
    assert set(cart.labels.values()) == {"veh"}
    assert people.dt == pytest.approx(1 / 29.97)
    arrays = load(recordings / "sdd/gates/video2/data_2_8.npz", fps=2.5, units="px")
    assert (len(arrays.ids), len(arrays), arrays.units) == (8, 8 * 10, "px")
    assert (arrays.x[0], arrays.y[0]) == (127.0, 1080.5)
    assert len(load(recordings / "sdd/gates/video1/data_2_7.npz", fps=2.5).ids) == 23


@pytest.mark.parametrize("path", ["eth_biwi/seq_eth/H.txt", "ucy/zara01/destinations.txt", "sdd/estimated_scales.yaml"])
def test_files_beside_the_recordings_are_no_recordings(recordings, path):
    with pytest.raises(DataError, match="of an unknown format"):
        load(recordings / path)
