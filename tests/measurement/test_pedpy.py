"""Measurements against PedPy on a made crowd in a hall that is not convex."""

import dataclasses

import numpy as np
import pedpy
import pytest

from crowdbot import measurement as measure
from crowdbot.data import Trajectories

FPS = 10.0
CORNERS = [(0, 0), (12, 0), (12, 3), (9, 3), (9, 5), (7, 5), (7, 3), (0, 3)]
PILLAR = [(3.4, 1.3), (3.8, 1.3), (3.8, 1.7), (3.4, 1.7)]
AREA = measure.MeasurementArea([(5.0, 0.2), (8.0, 0.2), (8.0, 2.8), (5.0, 2.8)])
LINE = measure.MeasurementLine((6.0, 0.0), (6.0, 3.0))
PEDPY_LINE = pedpy.MeasurementLine([LINE.start, LINE.end])
HALL = measure.WalkableArea(CORNERS, [PILLAR])
WIDTH = -2.0
STEP = 4
GRID = 0.5


@pytest.fixture(scope="module")
def tracks():
    """People who walk both ways in a corridor with a niche and a pillar."""
    rng = np.random.default_rng(16)
    rows = []
    for k in range(22):
        side = 1.0 if k % 3 else -1.0
        speed, start = rng.uniform(0.7, 1.6), rng.integers(0, 30)
        lane = rng.uniform(0.2, 1.1) if k % 2 else rng.uniform(1.9, 2.8)
        x0 = rng.uniform(0.3, 5.0) if side > 0 else rng.uniform(7.0, 11.7)
        for frame in range(int(start), 80):
            t = (frame - start) / FPS
            x = x0 + side * (speed * t + 0.2 * np.sin(1.3 * t + k))
            y = lane + 0.08 * np.sin(5.0 * t + k)
            if not 0.05 < x < 11.95:
                break
            rows.append((k + 1, frame, x, y))
    rows += [(40, frame, 8.0 + 0.3 * np.sin(0.1 * frame), 4.2) for frame in range(80)]
    id, frame, x, y = np.asarray(rows, dtype=float).T
    return Trajectories(id, frame, x, y, row_rate=FPS, name="crowd")


@pytest.fixture(scope="module")
def cells(tracks):
    return measure.compute_individual_voronoi_polygons(tracks, HALL)


@pytest.fixture(scope="module")
def speed(tracks):
    return measure.compute_individual_speed(tracks, STEP, border="single-sided")


@pytest.fixture(scope="module")
def species(tracks, cells):
    return pedpy.compute_species(
        individual_voronoi_polygons=cells,
        measurement_line=PEDPY_LINE,
        trajectory_data=measure.pedpy_tracks(tracks),
        frame_step=STEP,
    )


def same(found, expected, columns, keys=("id", "frame")):
    """Compare the columns of two tables after sorting both by the key columns."""
    by = [name for name in columns if name in keys]
    a, b = (table.sort_values(by)[list(columns)].to_numpy(dtype=float) for table in (found, expected))
    np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9)


def test_n_t_and_flow(tracks, speed):
    n_t, crossings = measure.compute_n_t(tracks, LINE)
    expected, expected_crossings = pedpy.compute_n_t(
        traj_data=measure.pedpy_tracks(tracks), measurement_line=PEDPY_LINE
    )
    assert len(crossings) > 5
    same(n_t, expected.reset_index(), ["frame", "cumulative_pedestrians", "time"])
    same(crossings, expected_crossings, ["id", "frame"])
    flow = measure.compute_flow(tracks, n_t, crossings, speed, 10)
    at_line = pedpy.compute_flow(
        nt=n_t, crossing_frames=crossings, individual_speed=speed, delta_frame=10, frame_rate=FPS
    )
    np.testing.assert_allclose(flow[["flow", "mean_speed"]], at_line[["flow", "mean_speed"]], rtol=1e-9)


@pytest.mark.filterwarnings("ignore:The copy keyword is deprecated")  # PedPy 1.5 with pandas 3
def test_line_flow(tracks, cells, speed, species):
    line_flow = measure.compute_line_flow(tracks, cells, LINE, speed, species)
    at_line = {"individual_voronoi_polygons": cells, "measurement_line": PEDPY_LINE, "species": species}
    tables = {
        "density": pedpy.compute_line_density(**at_line),
        "speed": pedpy.compute_line_speed(**at_line, individual_speed=speed),
        "flow": pedpy.compute_line_flow(**at_line, individual_speed=speed),
    }
    for name, table in tables.items():
        columns = ["frame", *table.columns[1:]]
        assert len(columns) == 4
        mine = line_flow[line_flow.frame.isin(table.frame)][["frame", f"{name}_sp+1", f"{name}_sp-1", name]]
        same(mine.set_axis(columns, axis=1), table.fillna(0.0), columns)


def test_density_profile(tracks, cells, speed):
    profiles = measure.compute_profiles(measure.Grid.over(HALL, GRID), cells, speed)
    frames = pedpy.compute_density_profile(
        data=cells,
        walkable_area=pedpy.WalkableArea(CORNERS, obstacles=[PILLAR]),
        grid_size=GRID,
        density_method=pedpy.DensityMethod.VORONOI,
    )
    np.testing.assert_allclose(profiles.density, np.mean(frames, axis=0).ravel(), rtol=1e-9, atol=1e-12)


def test_area_and_passages_are_those_of_pedpy(tracks):
    plan = measure.MeasurementPlan(
        ("area", "passing"), HALL, AREA, LINE, passage=WIDTH, window=STEP / FPS, every=1.0 / FPS
    )
    found = measure.measure(tracks, plan)
    data, area = measure.pedpy_tracks(tracks), pedpy.MeasurementArea(AREA.corners)
    hall = pedpy.WalkableArea(CORNERS, obstacles=[PILLAR])
    cells = pedpy.compute_individual_voronoi_polygons(traj_data=data, walkable_area=hall)
    density, _ = pedpy.compute_voronoi_density(individual_voronoi_data=cells, measurement_area=area)
    same(found.tables["area"], density.rename(columns={"density": "voronoi_density"}), ["frame", "voronoi_density"])
    passages, between = pedpy.compute_frame_range_in_area(traj_data=data, measurement_line=PEDPY_LINE, width=WIDTH)
    assert len(passages) > 5
    same(found.tables["passages"], passages, ["id", "entering_frame", "leaving_frame"])
    inside = pedpy.compute_classic_density(traj_data=data, measurement_area=between)
    expected = pedpy.compute_passing_density(density_per_frame=inside, frames=passages)
    same(found.tables["passages"], expected, ["id", "density"])


def test_frame_numbers_of_a_recording_are_kept(tracks):
    """A recording with a row every 6 frames, from frame 780 on, has the same measurements as one with a row a frame."""
    numbered = dataclasses.replace(tracks, frame=780 + 6 * tracks.frame, frame_step=6)
    plan = measure.MeasurementPlan(("individual", "area", "line", "passing"), HALL, AREA, LINE, passage=WIDTH)
    one, other = measure.measure(tracks, plan), measure.measure(numbered, plan)
    assert other.figures == pytest.approx(one.figures)
    for name in one.tables:
        frames = [column for column in one.tables[name] if column.endswith("frame")]
        values = one.tables[name].drop(columns=frames)
        np.testing.assert_allclose(other.tables[name].drop(columns=frames), values, rtol=1e-9, atol=1e-9)
        if name != "flow":
            np.testing.assert_array_equal(other.tables[name][frames], 780 + 6 * one.tables[name][frames])


@pytest.mark.parametrize("border", ["exclude", "adaptive", "single-sided"])
def test_a_track_ends_at_a_gap(tracks, border):
    """A person who is not seen for a second is two people to the measurement of speeds."""
    seen = measure.select_rows(tracks, ~np.isin(tracks.frame, range(30, 40)))
    late = seen.frame >= 40
    both = dataclasses.replace(seen, id=np.where(late, seen.id + 100, seen.id))
    found = measure.compute_individual_speed(seen, STEP, border=border)
    expected = measure.compute_individual_speed(both, STEP, border=border)
    same(found, expected.assign(id=expected.id % 100), ["id", "frame", "speed", "v_x", "v_y"])
    assert len(found) > 500


def test_only_the_direction_counts_not_its_length(tracks):
    one, two = (measure.compute_individual_speed(tracks, STEP, direction=(size, 0.0)) for size in (1.0, 2.0))
    same(one, two, ["id", "frame", "speed", "v_x", "v_y"])
    assert np.all(one.v_y == 0.0)
    assert one.speed.min() < -0.5
    moved = measure.compute_individual_acceleration(tracks, STEP, direction=(0.0, 3.0))
    assert moved.acceleration.abs().to_numpy() == pytest.approx(moved.a_y.abs().to_numpy())
