"""Measurements against PedPy 1.5.1 on a made crowd in a hall that is not convex; see pedpy_reference.py."""

from pathlib import Path

import numpy as np
import pytest
from pedpy_reference import AREA, CORNERS, CUT_OFF, FPS, GRID, LINE, PILLAR, STEP, WIDTH

from crowdbot import measurement as measure
from crowdbot.data import Trajectories

FILE = Path(__file__).parents[1] / "reference" / "pedpy" / "two_way.npz"


@pytest.fixture(scope="module")
def pedpy():
    with np.load(FILE) as arrays:
        return dict(arrays)


@pytest.fixture(scope="module")
def tracks(pedpy):
    id, frame, x, y = pedpy["rows"].T
    return Trajectories(id, frame, x, y, row_rate=FPS, name="crowd")


@pytest.fixture(scope="module")
def hall():
    return measure.WalkableArea(CORNERS, [PILLAR])


@pytest.fixture(scope="module")
def cells(tracks, hall):
    return measure.compute_individual_voronoi_polygons(tracks, hall)


@pytest.fixture(scope="module")
def speed(tracks):
    return measure.compute_individual_speed(tracks, STEP, border="single-sided")


AREA_ = measure.MeasurementArea(AREA)
LINE_ = measure.MeasurementLine(*LINE)


def assert_same(table, expected, columns, keys=("id", "frame")):
    """Compare a table with the rows of PedPy after sorting both by the key columns, which stand first."""
    found = table[list(columns)].to_numpy(dtype=float)
    rows = expected[:, : len(columns)]
    count = sum(name in keys for name in columns)
    order = [np.lexsort(part[:, :count].T[::-1]) for part in (found, rows)]
    np.testing.assert_allclose(found[order[0]], rows[order[1]], rtol=1e-9, atol=1e-9)


def test_voronoi_cells_and_cut_off(tracks, hall, cells, pedpy):
    assert_same(cells, pedpy["cells"], ["id", "frame", "density"])
    cut = measure.compute_individual_voronoi_polygons(tracks, hall, measure.CutOff(*CUT_OFF))
    assert_same(cut, pedpy["cut"], ["id", "frame", "density"])


def test_classic_and_voronoi_density(tracks, cells, pedpy):
    assert_same(measure.compute_classic_density(tracks, AREA_), pedpy["classic"], ["frame", "density"])
    assert_same(measure.compute_voronoi_density(tracks, cells, AREA_), pedpy["voronoi"], ["frame", "density"])


@pytest.mark.parametrize(
    ("border", "name"), [("exclude", "exclude"), ("adaptive", "adaptive"), ("single-sided", "single")]
)
def test_individual_speed(tracks, pedpy, border, name):
    found = measure.compute_individual_speed(tracks, STEP, border=border)
    assert_same(found, pedpy[f"speed_{name}"], ["id", "frame", "speed", "v_x", "v_y"])


def test_speed_along_a_direction_and_acceleration(tracks, pedpy):
    along = measure.compute_individual_speed(tracks, STEP, direction=(2.0, 0.0))
    assert_same(along, pedpy["speed_along"], ["id", "frame", "speed", "v_x", "v_y"])
    found = measure.compute_individual_acceleration(tracks, STEP)
    assert_same(found, pedpy["acceleration"], ["id", "frame", "acceleration", "a_x", "a_y"])


def test_mean_and_voronoi_speed(tracks, cells, speed, pedpy):
    mean = measure.compute_mean_speed_per_frame(tracks, speed, AREA_).fillna(0.0)
    assert_same(mean, pedpy["mean_speed"], ["frame", "speed"])
    voronoi = measure.compute_voronoi_speed(tracks, speed, cells, AREA_)
    assert_same(voronoi, pedpy["voronoi_speed"], ["frame", "speed"])


def test_n_t_and_flow(tracks, speed, pedpy):
    n_t, crossings = measure.compute_n_t(tracks, LINE_)
    assert_same(n_t, pedpy["n_t"], ["frame", "cumulative_pedestrians", "time"])
    assert_same(crossings, pedpy["crossing"], ["id", "frame"])
    flow = measure.compute_flow(tracks, n_t, crossings, speed, 10)
    np.testing.assert_allclose(flow[["flow", "mean_speed"]].to_numpy(), pedpy["flow"], rtol=1e-9)


def test_line_flow(tracks, cells, speed, pedpy):
    species = measure.compute_species(tracks, cells, LINE_, STEP)
    assert_same(species, pedpy["species"], ["id", "species"])
    found = measure.compute_line_flow(tracks, cells, LINE_, speed, species)
    for name in ("density", "speed", "flow"):
        expected = np.nan_to_num(pedpy[f"line_{name}"])
        mine = found[found.frame.isin(expected[:, 0])]
        assert_same(mine, expected, ["frame", f"{name}_sp+1", f"{name}_sp-1", name])


def test_passages(tracks, pedpy):
    passages, between = measure.compute_frame_range_in_area(tracks, LINE_, WIDTH)
    assert len(passages) > 5
    assert_same(passages, pedpy["passages"], ["id", "entering_frame", "leaving_frame"])
    density = measure.compute_passing_density(measure.compute_classic_density(tracks, between), passages)
    assert_same(density, pedpy["passing_density"], ["id", "density"])
    assert_same(measure.compute_passing_speed(tracks, passages, WIDTH), pedpy["passing_speed"], ["id", "speed"])


def test_neighbors(tracks, cells, pedpy):
    found = measure.compute_neighbors(cells)
    keys = ("id", "frame", "neighbor_id")
    assert_same(found, pedpy["neighbors"], keys, keys)
    distance = measure.compute_neighbor_distance(tracks, found)
    assert_same(distance, pedpy["neighbor_distance"], [*keys, "distance"], keys)


def test_profiles(tracks, hall, cells, speed, pedpy):
    grid = measure.Grid.over(hall, GRID)
    voronoi = measure.compute_density_profile(tracks, grid, cells)
    np.testing.assert_allclose(voronoi, pedpy["profile_voronoi"], rtol=1e-9, atol=1e-12)
    classic = measure.compute_density_profile(tracks, grid, method="classic")
    np.testing.assert_allclose(classic, pedpy["profile_classic"], rtol=1e-9, atol=1e-12)
