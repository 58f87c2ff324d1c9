"""Measurements in made crowds whose values are known, slow twins, and wrong input."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from crowdbot import measurement as measure
from crowdbot.core import DataError, InputError, stream
from crowdbot.data import Trajectories

HALL = measure.WalkableArea([(0, 0), (20, 0), (20, 4), (0, 4)])
MIDDLE = measure.MeasurementArea([(8, 0), (12, 0), (12, 4), (8, 4)])
LINE = measure.MeasurementLine((10.05, 4), (10.05, 0))


def lattice(speed=1.0, gap=0.5, seconds=6.0, rate=10.0):
    """Return rows of people a gap apart in x and y who enter on the left and leave on the right at a speed."""
    frames = np.arange(round(seconds * rate) + 1)
    y = np.arange(0.5 * gap, 4.0, gap)
    count = int((20.0 + speed * seconds) / gap) + 1
    column = np.arange(count)
    x = 20.0 - 0.5 * gap - column[None, :] * gap + speed * frames[:, None] / rate
    frame, who, lane = (a.ravel() for a in np.meshgrid(frames, column, np.arange(len(y)), indexing="ij"))
    place = x[frame, who]
    kept = (place > 0.0) & (place < 20.0)
    return Trajectories(
        (who * len(y) + lane)[kept], frame[kept], place[kept], y[lane[kept]], row_rate=rate, name="lattice"
    )


def made(rows, rate=1.0):
    id, frame, x, y = np.asarray(rows, dtype=float).T
    return Trajectories(id, frame, x, y, row_rate=rate, name="made")


def test_uniform_flow_has_density_times_speed():
    tracks = lattice(speed=1.0, gap=0.5)
    found = measure.measure(
        tracks, measure.MeasurementPlan(("area", "line"), HALL, MIDDLE, LINE, every=0.5, window=0.2)
    )
    area = found.tables["area"]
    assert area.voronoi_density.to_numpy() == pytest.approx(4.0)
    assert area.voronoi_speed.to_numpy() == pytest.approx(1.0)
    assert area.specific_flow.to_numpy() == pytest.approx(4.0)
    assert found.figures["classic_density"] == pytest.approx(4.0, rel=0.15)  # the border counts columns by chance
    assert found.tables["line"].flow.to_numpy() == pytest.approx(4.0)
    n_t = found.tables["n-t"]
    slope = np.polyfit(n_t.time, n_t.cumulative_pedestrians, 1)[0]
    assert slope / LINE.length == pytest.approx(4.0, rel=0.02)


def test_a_lattice_has_square_cells():
    tracks = lattice(seconds=0.0)
    cells = measure.compute_individual_voronoi_polygons(tracks, HALL)
    assert cells.density.to_numpy() == pytest.approx(4.0)
    walk = cells[["id", "frame"]].assign(speed=0.7)
    profiles = measure.compute_profiles(measure.Grid.over(HALL, 1.0), cells, walk)
    assert profiles.density.to_numpy() == pytest.approx(np.full(80, 4.0))
    assert profiles.flow.to_numpy() == pytest.approx(np.full(80, 2.8))


def test_a_cut_off_cell_is_the_polygon_in_the_circle():
    alone = made([(1, 0, 10.0, 2.0)])
    cells = measure.compute_individual_voronoi_polygons(alone, HALL, 1.0)
    assert 1.0 / cells.density[0] == pytest.approx(6.0 * np.sin(np.pi / 6.0))
    assert measure.compute_individual_voronoi_polygons(alone, HALL).density[0] == pytest.approx(1.0 / 80.0)


def test_profiles_of_speed_have_no_value_where_nobody_is():
    tracks = made([(1, 0, 1.5, 1.5), (1, 1, 2.5, 1.5)])
    speed = measure.compute_individual_speed(tracks, 1, border="single-sided")
    cells = measure.compute_individual_voronoi_polygons(tracks, HALL, 0.4)
    mean = measure.compute_profiles(measure.Grid.over(HALL, 1.0), cells, speed).speed.to_numpy()
    assert np.sum(~np.isnan(mean)) == 2
    assert np.nanmax(mean) == pytest.approx(1.0)


def test_gaps_in_tracks_have_no_speed_across():
    tracks = made([(1, 0, 0.0, 1.0), (1, 1, 1.0, 1.0), (1, 5, 9.0, 1.0), (1, 6, 9.5, 1.0)])
    speed = measure.compute_individual_speed(tracks, 1, border="single-sided")
    assert speed.speed.tolist() == [1.0, 1.0, 0.5, 0.5]
    assert len(measure.compute_crossing_frames(tracks, measure.MeasurementLine((5, 0), (5, 4)))) == 0


def test_headways_of_a_ring_close():
    tracks = made([(1, 0, 0.5, 0.0), (2, 0, 3.0, 0.0), (3, 0, 11.0, 0.0)])
    gaps = measure.compute_headways(tracks, length=10.0)
    assert gaps.ahead.tolist() == [0.5, 7.5, 2.0]
    assert gaps.ahead.sum() == 10.0
    assert gaps.density.tolist() == [0.25, 2.0 / 9.5, 0.8]


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 10**6))
def test_time_to_collision_is_that_of_small_steps(seed):
    rng = stream(seed, "ttc")
    start, velocity = rng.uniform(-3.0, 3.0, (2, 2)), rng.uniform(-1.0, 1.0, (2, 2))
    rows = [(k, f, *(start[k] + f * velocity[k])) for f in (0, 1) for k in (0, 1)]
    tracks = made(rows)
    speed = measure.compute_individual_speed(tracks, 1, border="single-sided")
    pair = measure.compute_encounters(tracks, speed, 0.3, reach=50.0).iloc[0]
    times = np.arange(0.0, 40.0, 0.002)
    away = (start[1] - start[0]) + times[:, None] * (velocity[1] - velocity[0])
    met = np.hypot(*away.T) <= 0.6
    slow = times[np.argmax(met)] if np.any(met) else np.inf
    if np.isinf(slow):
        assert pair.ttc > 39.9 or np.hypot(*away.T).min() < 0.6 + 1e-4
    else:
        assert pair.ttc == pytest.approx(slow, abs=0.01)


def test_people_who_do_not_interact_have_g_of_one():
    rng = stream(5, "free")
    rows = [(k, f, *rng.uniform(0.0, 10.0, 2)) for f in range(300) for k in range(8)]
    tracks = made(rows)
    g = measure.compute_pair_distribution_function(tracks, 0.5, farthest=8.0, shuffles=3)
    assert g.g.to_numpy()[1:] == pytest.approx(1.0, abs=0.12)
    rows = []
    for pair in range(400):
        for k, (x, y, vx, vy) in enumerate(stream(pair, "walk").uniform(-1.0, 1.0, (6, 4)) * [6, 6, 1, 1]):
            rows += [(k + 6 * pair, 2 * pair, x, y), (k + 6 * pair, 2 * pair + 1, x + vx, y + vy)]
    tracks = made(rows)
    speed = measure.compute_individual_speed(tracks, 1, border="single-sided")
    time_to_collision_distribution = measure.compute_time_to_collision_distribution(
        tracks, speed, 0.3, bin_size=1.0, longest=6.0
    )
    assert time_to_collision_distribution[
        "count"
    ].sum() / time_to_collision_distribution.expected.sum() == pytest.approx(1.0, abs=0.2)


def test_hard_discs_have_a_hole_in_the_pair_distribution():
    g = measure.compute_pair_distribution_function(lattice(speed=0.7), 0.1, farthest=2.0)
    assert g.g[g.radius < 0.45].tolist() == [0.0] * 4 or np.all(np.nan_to_num(g.g[g.radius < 0.45]) == 0.0)


def wave(c, rate=5.0):
    """Return a file of people at 1 m/s but 0 in a wave that travels at c."""
    rows = []
    for k in range(60):
        x = -0.7 * k + 10.0
        for f in range(300):
            rows.append((k, f, x, 0.0))
            phase = (x - c * f / rate) % 8.0
            x += (0.02 if phase < 2.0 else 1.0) / rate
    return made(rows, rate)


@pytest.mark.parametrize("c", [-0.6, 0.0, -1.2])
def test_a_wave_of_stops_has_its_speed(c):
    tracks = wave(c)
    speed = measure.compute_individual_speed(tracks, 1, border="single-sided")
    assert measure.wave_speed(tracks, speed) == pytest.approx(c, abs=0.1)
    found = measure.compute_stop_and_go(tracks, speed)
    if c < 0.0:
        assert found.stops_per_minute > 2.0
        assert found.duration == pytest.approx(2.0 / -c, rel=0.25)


def test_a_two_way_flow_has_no_wave():
    one = wave(-0.6)
    both = np.concatenate([one.id, one.id + 100]), np.tile(one.frame, 2), np.concatenate([one.x, -one.x])
    tracks = Trajectories(*both, np.repeat([0.0, 1.0], len(one)), row_rate=5.0)
    speed = measure.compute_individual_speed(tracks, 1, border="single-sided")
    assert np.isnan(measure.compute_stop_and_go(tracks, speed).wave)


def test_steady_walking_has_no_wave_and_no_stop():
    tracks = lattice(speed=1.0)
    speed = measure.compute_individual_speed(tracks, 2, border="single-sided")
    found = measure.compute_stop_and_go(tracks, speed)
    assert (found.share, found.stops_per_minute) == (0.0, 0.0)
    assert np.isnan(found.wave)


@pytest.mark.parametrize("c", [0.0, 0.5, 0.9, 0.97])
def test_the_threshold_of_a_steady_state_is_that_of_many_runs(c):
    rng = np.random.default_rng(3)
    q, many = stats.norm.ppf(0.99), 3000
    y, s, counts = rng.normal(size=many), np.zeros(many), np.zeros(101)
    for k in range(2500):
        y = c * y + np.sqrt(1.0 - c * c) * rng.normal(size=many)
        s = np.clip(s + np.where(np.abs(y) > q, 1.0, -1.0), 0.0, 100.0)
        counts += np.bincount(s.astype(int), minlength=101) * (k > 500)
    share = np.cumsum(counts) / counts.sum()
    threshold = measure.steady_threshold(c)
    assert share[threshold] > 0.99 - 0.001
    assert share[threshold - 1] < 0.99 + 0.001


def test_a_steady_state_is_found_between_beginning_and_end():
    rng = np.random.default_rng(2)
    time = np.arange(0.0, 100.0, 0.1)
    shape = np.interp(time, [0.0, 25.0, 75.0, 100.0], [0.0, 2.0, 2.0, 0.0])
    found = measure.detect_steady_state(time, shape + 0.05 * rng.normal(size=1000), (40.0, 60.0))
    assert len(found.intervals) == 1
    assert found.intervals[0] == pytest.approx([25.0, 75.0], abs=2.5)
    other = measure.detect_steady_state(time, shape + 0.05 * rng.normal(size=1000), (30.0, 50.0))
    both = measure.combine_steady_states([found, other])
    assert both[0, 0] == max(found.intervals[0, 0], other.intervals[0, 0])


def test_a_mean_over_starts_covers_the_truth():
    hits = 0
    for k in range(60):
        values = 2.0 + 0.3 * stream(k, "starts").standard_normal(20)
        mean = measure.mean_over_starts(values, resamples=300)
        hits += mean.low <= 2.0 <= mean.high
    assert hits >= 50
    assert np.isnan(measure.mean_over_starts([1.0]).low)


def test_robots_and_people_outside_are_named():
    rows = [(k, f, 2.0 + k + 0.1 * f, 1.0) for f in range(20) for k in range(3)] + [
        (9, f, 30.0, 1.0) for f in range(20)
    ]
    id, frame, x, y = np.asarray(rows, dtype=float).T
    tracks = Trajectories(id, frame, x, y, row_rate=10.0, robots={2})
    found = measure.measure(tracks, measure.MeasurementPlan(("individual",), HALL))
    assert found.notes == (
        "1 robots are not measured",
        "20 of 60 rows are outside the walkable area and are not measured",
    )
    assert found.figures["people"] == 2.0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: measure.MeasurementArea([(0, 0), (1, 1)]), "at least 3 points"),
        (lambda: measure.MeasurementArea([(0, 0), (1, 1), (1, 0), (0, 1)]), "edges of a measurement area intersect"),
        (lambda: measure.MeasurementLine((1, 1), (1, 1)), "two ends of a measurement line are equal"),
        (lambda: measure.MeasurementLine((1, 1), (1, np.nan)), "finite x and y"),
        (
            lambda: measure.WalkableArea([(0, 0), (1, 0), (1, 1)], [[(-1, -1), (3, -1), (3, 3), (-1, 3)]]),
            "nothing is left",
        ),
        (lambda: measure.compute_individual_voronoi_polygons(lattice(), HALL, 0.0), "radius must be above 0"),
        (lambda: measure.MeasurementPlan(cut_off=-1.0), "radius must be above 0"),
        (lambda: measure.Grid.over(HALL, 0.0), "larger than 0.0 m"),
        (lambda: measure.Grid.over(HALL, 1e-3), "more than the limit"),
        (lambda: measure.MeasurementPlan(("voronoi",)), "unknown method 'voronoi'"),
        (lambda: measure.MeasurementPlan(("line",)), "need a measurement line"),
        (lambda: measure.MeasurementPlan(("passing",), line=LINE), "distance of the second line"),
        (lambda: measure.MeasurementPlan(every=0.0), "every is 0.0"),
        (lambda: measure.MeasurementPlan(axis="z"), "axis is x or y"),
        (lambda: measure.compute_individual_speed(lattice(), 0), "frame step 0"),
        (lambda: measure.compute_individual_speed(lattice(), 1, border="exclud"), "did you mean 'exclude'"),
        (lambda: measure.compute_individual_speed(lattice(), 1, direction=(0, 0)), "not both 0"),
        (lambda: measure.compute_fundamental_diagram([1.0], [1.0, 2.0], 0.5), "columns of equal length"),
        (lambda: measure.compute_headways(lattice(), "z"), "axis of a single file"),
        (lambda: measure.detect_steady_state([0, 1, 2], [1, 1, 1], (0, 2)), "at least three that vary"),
        (lambda: measure.detect_steady_state([0, 1, 3], [1, 2, 1], (0, 2)), "equal steps"),
        (lambda: measure.mean_over_starts([]), "one finite value"),
        (lambda: measure.steady_threshold(0.5, alpha=1.0), "between 0.5 and 1"),
        (lambda: measure.MeasurementPlan(line=LINE, passage=0.0), "apart from the first"),
    ],
)
def test_wrong_settings_are_refused(call, message):
    with pytest.raises(InputError, match=message):
        call()


def test_wrong_recordings_are_refused():
    outside = made([(1, 0, 30.0, 2.0)])
    with pytest.raises(DataError, match=r"1 rows are outside the walkable area, the first is id 1 in frame 0"):
        measure.compute_individual_voronoi_polygons(outside, HALL)
    with pytest.raises(DataError, match="nobody is inside"):
        measure.measure(outside, measure.MeasurementPlan(walkable=HALL))
    with pytest.raises(DataError, match="two people are at the same position in frame 0"):
        measure.compute_individual_voronoi_polygons(made([(1, 0, 3.0, 2.0), (2, 0, 3.0, 2.0)]), HALL)
    pixels = Trajectories([1], [0], [3.0], [2.0], row_rate=1.0, units="px")
    with pytest.raises(DataError, match="in pixels"):
        measure.measure(pixels)


def test_walls_of_a_recording_are_its_walkable_area():
    border, wall = [(0, 0), (0, 4), (8, 4), (8, 0)], [(4, 0), (4, 3)]
    pillar = [(1, 1), (2, 1), (2, 2), (1, 2)]
    walls = tuple(np.asarray(ring, dtype=float) for ring in (border, wall, pillar))
    tracks = Trajectories([1, 2], [0, 0], [3.9, 4.5], [0.5, 0.5], row_rate=1.0, walls=walls)
    hall = measure.WalkableArea.of(tracks)
    assert hall.area == pytest.approx(32.0 - 1.0 - 0.02 * 3.0)
    cells = measure.compute_individual_voronoi_polygons(tracks, hall)
    assert cells.polygon[0].bounds[2] < 4.21  # the cell does not reach through the wall
    assert not cells.polygon[1].contains(cells.polygon[0].centroid)


def test_people_who_are_seen_once_or_never_come_near_are_measured_without_a_warning():
    seen_once = made([(1, 0, 0.0, 0.0), (2, 0, 1.0, 0.0)])
    for border in measure.BORDERS:
        speed = measure.compute_individual_speed(seen_once, 1, border=border)
        assert (len(speed), list(speed.columns)) == (0, ["id", "frame", "speed", "v_x", "v_y"])
    assert len(measure.compute_individual_acceleration(seen_once, 1)) == 0
    tracks = made([(1, 0, 0.0, 0.0), (1, 1, 1.0, 0.0), (1, 2, 2.0, 0.0), (2, 2, 5.0, 0.0)], rate=2.0)
    far = measure.MeasurementArea([(40, 0), (41, 0), (41, 1)])
    line = measure.MeasurementLine((50, 0), (50, 1))
    found = measure.measure(
        tracks, measure.MeasurementPlan(("area", "line", "passing"), area=far, line=line, passage=1)
    )
    assert found.notes == ("1 rows without a second row of the same person have no speed and are not measured",)
    assert found.figures["passages"] == found.figures["crossings"] == found.figures["voronoi_density"] == 0.0
    assert found.tables["area"].mean_speed.isna().all()
