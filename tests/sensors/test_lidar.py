"""Lidar2D against its brute-force twin, and in cases that can be worked out by hand."""

import gc
import math
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Pose, Scene, Walls, stream
from crowdbot.core.geometry import ray_to_disc, ray_to_segment
from crowdbot.sensors import NOTHING, Gaussian, Lidar2D, Noise, Offset, Peak, Scan, ray_shapes
from crowdbot.sensors import WALLS as WALL
from crowdbot.sensors.lidar import PARALLEL
from crowdbot.sensors.ray_shapes import extend_segments as _lengthened
from crowdbot.sensors.ray_shapes import wall_segments

ROOM = [(-4.0, -3.0), (-4.0, 3.0), (4.0, 3.0), (4.0, -3.0)]
"""A room 8 m x 6 m, listed clockwise: people are inside."""
few = settings(max_examples=40, deadline=None)


def crowd(seed, people=12, environments=1, walls=(ROOM, [(1.0, -2.0), (2.5, 1.0)]), spread=4.0):
    rng = stream(seed, "crowd")
    place = rng.uniform(-spread, spread, (environments, people, 2))
    radius = rng.uniform(0.1, 0.5, (environments, people))
    return Scene.of(place, radius=radius, walls=walls, active=rng.random((environments, people)) < 0.8)


def brute_force(lidar, scene, pose):
    """Every beam against every disc and wall; then the same rules as in the documentation."""
    walls = _lengthened(scene.walls.segments())
    ranges = np.full((scene.shape[0], lidar.rays), np.inf)
    hit = np.full(ranges.shape, NOTHING)
    for e, k in np.ndindex(ranges.shape):
        x, y = pose.position[e]
        angle = pose.heading[e] + lidar.angles[k]
        ux, uy = math.cos(angle), math.sin(angle)
        best, cosine = math.inf, 1.0
        for a in range(scene.shape[1]):
            cx, cy, r = *scene.position[e, a], scene.radius[e, a]
            distance = ray_to_disc(x, y, ux, uy, cx, cy, r) if scene.active[e, a] else math.inf
            if distance < best:
                best, hit[e, k], cosine = distance, a, 1.0
                if distance > 0.0:
                    cosine = ((cx - x - distance * ux) * ux + (cy - y - distance * uy) * uy) / r
        for ax, ay, bx, by in walls:
            distance = ray_to_segment(x, y, ux, uy, ax, ay, bx, by)
            if distance < best:
                best, hit[e, k] = distance, WALL
                cosine = abs(ux * (by - ay) - uy * (bx - ax)) / math.hypot(bx - ax, by - ay)
        if best > lidar.range_max or cosine < math.cos(lidar.max_incidence) - 1e-12:
            hit[e, k] = NOTHING
        else:
            ranges[e, k] = best if best >= lidar.range_min else -math.inf
    return ranges, hit


@few
@given(
    st.integers(0, 10_000),
    st.integers(1, 130),
    st.floats(0.05, 2 * math.pi),
    st.floats(-10.0, 10.0),
    st.floats(0.2, math.pi / 2),
    st.floats(0.3, 12.0),
)
def test_equals_brute_force(seed, rays, field_of_view, heading, incidence, reach):
    scene = crowd(seed, environments=2)
    place = stream(seed, "sensor").uniform(-5.0, 5.0, (2, 2))
    lidar = Lidar2D(rays=rays, field_of_view=field_of_view, range_max=reach, max_incidence=incidence)
    pose = Pose.of(place, [heading, -heading])
    scan = lidar.read(scene, pose)
    ranges, hit = brute_force(lidar, scene, pose)
    np.testing.assert_allclose(scan.ranges, ranges, rtol=0, atol=1e-12)
    if sys.platform == "linux":  # elsewhere Python and the compiler may use different cosines
        np.testing.assert_array_equal(scan.ranges, ranges)
    np.testing.assert_array_equal(scan.hit, hit)


@few
@given(st.integers(0, 10_000), st.floats(-3.0, 3.0), st.floats(-8.0, 8.0), st.floats(-8.0, 8.0))
def test_turning_and_shifting_everything_changes_nothing(seed, angle, dx, dy):
    cos, sin = math.cos(angle), math.sin(angle)

    def carried(points):
        return np.asarray(points, dtype=float) @ np.array([[cos, sin], [-sin, cos]]) + np.array([dx, dy])

    scene = crowd(seed, walls=())
    walls = [ROOM, [(1.0, -2.0), (2.5, 1.0)]]
    here = Scene.of(scene.position, radius=scene.radius, active=scene.active, walls=walls)
    there = Scene.of(
        carried(scene.position), radius=scene.radius, active=scene.active, walls=[carried(w) for w in walls]
    )
    place = stream(seed, "sensor").uniform(-3.0, 3.0, 2)
    one = Lidar2D(rays=97).read(here, Pose.of(place, 0.4))
    two = Lidar2D(rays=97).read(there, Pose.of(carried(place), 0.4 + angle))
    same = np.isclose(one.ranges, two.ranges, rtol=0, atol=1e-7) | (one.ranges == two.ranges)
    assert np.mean(same) > 0.97  # a beam that grazes an edge may fall to either side
    assert np.mean(one.hit == two.hit) > 0.97


def test_turning_the_sensor_by_whole_beams_rolls_the_scan():
    scene = crowd(5)
    lidar = Lidar2D(rays=72)
    straight = lidar.read(scene, Pose.of((0.5, 0.2), 0.0)).ranges[0]
    turned = lidar.read(scene, Pose.of((0.5, 0.2), 7 * lidar.step)).ranges[0]
    np.testing.assert_allclose(np.roll(turned, 7), straight, rtol=0, atol=1e-9)


def test_a_batch_gives_the_bytes_of_each_alone():
    lidar = Lidar2D(rays=128, noise=(Gaussian(0.02), Peak(0.05, 1.0)), resolution=0.01)
    scene = crowd(6, environments=5)
    place = stream(6, "sensor").uniform(-3.0, 3.0, (5, 2))
    together = lidar.read(scene, Pose.of(place, np.arange(5.0)), [stream(6, "scan", e) for e in range(5)])
    for e in range(5):
        alone = Scene.of(scene.position[e], radius=scene.radius[e], active=scene.active[e], walls=scene.walls)
        scan = lidar.read(alone, Pose.of(place[e], float(e)), stream(6, "scan", e))
        assert scan.ranges.tobytes() == together.ranges[e].tobytes()
        assert scan.hit.tobytes() == together.hit[e].tobytes()


def test_many_environments_on_several_threads_give_the_bytes_of_each_alone():
    lidar, count = Lidar2D(rays=600, range_max=6.0), 37
    scene = crowd(8, environments=count)
    pose = Pose.of(stream(8, "sensor").uniform(-5.0, 5.0, (count, 2)), np.linspace(-9.0, 9.0, count))
    assert count * lidar.rays > PARALLEL
    together = lidar.read(scene, pose)
    assert np.count_nonzero(together.hit >= 0) > 1000
    for e in range(count):
        alone = lidar.read(scene.environments([e]), Pose(pose.position[e : e + 1], pose.heading[e : e + 1]))
        for name in ("ranges", "hit", "cos_incidence", "part"):
            assert getattr(alone, name)[0].tobytes() == getattr(together, name)[e].tobytes(), name


def test_a_scan_shares_no_memory_with_the_next():
    lidar, pose = Lidar2D(rays=40), Pose.of((0.5, 0.0), 0.3)
    first = lidar.read(crowd(1), pose)
    before = first.ranges.tobytes(), first.hit.tobytes()
    second = lidar.read(crowd(2), pose)
    assert (first.ranges.tobytes(), first.hit.tobytes()) == before
    assert second.ranges.tobytes() != before[0]
    for name in ("ranges", "hit", "part", "cos_incidence"):
        value = getattr(first, name)
        assert value.flags.c_contiguous
        assert value.flags.writeable
        assert not np.shares_memory(value, getattr(second, name))
    assert not first.angles.flags.writeable
    assert lidar.angles.flags.writeable


def test_segments_of_walls_are_kept_as_long_as_the_walls():
    for _ in range(20):
        walls = Walls.of([ROOM])
        assert wall_segments(walls) is wall_segments(walls)
        np.testing.assert_array_equal(wall_segments(walls), _lengthened(walls.segments()))
        key = id(walls)
        del walls
        gc.collect()
        assert key not in ray_shapes._segments


def test_same_input_gives_the_same_bytes():
    lidar = Lidar2D(noise=Gaussian(0.02))
    scans = [lidar.read(crowd(7), Pose.of((0.0, 0.0), 0.0), stream(7, "scan")) for _ in range(2)]
    assert scans[0].ranges.tobytes() == scans[1].ranges.tobytes()


def test_angles():
    full = Lidar2D(rays=8).angles
    np.testing.assert_allclose(full, -math.pi + np.arange(8) * math.pi / 4)
    part = Lidar2D(rays=5, field_of_view=math.pi).angles
    np.testing.assert_allclose(part, [-math.pi / 2, -math.pi / 4, 0.0, math.pi / 4, math.pi / 2], atol=1e-15)
    assert Lidar2D(rays=1, field_of_view=1.0).angles.tolist() == [0.0]


def test_too_near_is_minus_and_too_far_plus_infinite():
    scene = Scene.of([[0.54, 0.0], [0.0, 6.0], [-2.0, 0.0]], radius=0.5)
    scan = Lidar2D(rays=4, range_min=0.1, range_max=5.0).read(scene, Pose.of((0.0, 0.0), 0.0))
    assert scan.ranges[0].tolist() == [1.5, np.inf, -np.inf, np.inf]
    assert scan.hit[0].tolist() == [2, NOTHING, 0, NOTHING]


def test_the_limits_themselves_are_measured():
    scene = Scene.of([[2.5, 0.0], [-4.5, 0.0]], radius=0.5)
    scan = Lidar2D(rays=2, range_min=2.0, range_max=4.0).read(scene, Pose.of((0.0, 0.0), 0.0))
    assert scan.ranges[0].tolist() == [4.0, 2.0]


def test_from_inside_a_disc_every_beam_is_too_near():
    scene = Scene.of([[0.1, 0.0], [3.0, 0.0]], radius=0.5)
    scan = Lidar2D(rays=16, range_min=0.0).read(scene, Pose.of((0.0, 0.0), 0.0))
    assert np.all(scan.ranges == 0.0)
    assert np.all(scan.hit == 0)
    assert np.all(Lidar2D(rays=16).read(scene, Pose.of((0.0, 0.0), 0.0)).ranges == -np.inf)


def test_on_a_wall_the_beams_that_cross_it_are_too_near():
    scene = Scene.of([[50.0, 50.0]], walls=[[(-5.0, 0.0), (5.0, 0.0)]])
    scan = Lidar2D(rays=8).read(scene, Pose.of((0.0, 0.0), 0.1))
    assert np.all(scan.ranges == -np.inf)
    assert np.all(scan.hit == WALL)


@pytest.mark.parametrize("rays", [4, 8, 360, 1440])
@pytest.mark.parametrize("place", [(0.0, 0.0), (0.5, -0.25), (-3.0, 2.0)])
def test_no_beam_slips_through_a_corner(rays, place):
    square = Scene.of([[50.0, 50.0]], walls=[[(-4.0, -4.0), (-4.0, 4.0), (4.0, 4.0), (4.0, -4.0)]])
    scan = Lidar2D(rays=rays, range_max=20.0).read(square, Pose.of(place, 0.0))
    assert np.all(np.isfinite(scan.ranges))


def test_a_room_has_its_shape():
    scene = Scene.of([[50.0, 50.0]], walls=[ROOM])
    scan = Lidar2D(rays=720).read(scene, Pose.of((1.0, 0.5), 2.0))
    x, y = scan.points()[0].T
    on_side = np.minimum(np.abs(np.abs(x) - 4.0), np.abs(np.abs(y) - 3.0))
    assert np.max(on_side) < 1e-9
    assert np.all(scan.hit == WALL)


def test_beyond_the_incidence_limit_nothing_returns_and_nothing_shines_through():
    scene = Scene.of([[0.0, 8.0]], radius=0.5, walls=[[(-6.0, 1.0), (6.0, 1.0)]])
    lidar = Lidar2D(rays=181, field_of_view=math.pi, max_incidence=math.radians(50.5))
    scan = lidar.read(scene, Pose.of((0.0, 0.0), math.pi / 2))
    heard = np.isfinite(scan.ranges[0])
    np.testing.assert_array_equal(heard, np.abs(lidar.angles) <= math.radians(50.5))
    assert set(scan.hit[0][~heard].tolist()) == {NOTHING}
    assert set(scan.hit[0][heard].tolist()) == {WALL}


def test_incidence_on_a_disc():
    scene = Scene.of([[3.0, 0.0]], radius=1.0)
    lidar = Lidar2D(rays=2001, field_of_view=1.0, max_incidence=math.radians(30.0))
    heard = np.abs(lidar.angles[np.isfinite(lidar.read(scene, Pose.of((0.0, 0.0), 0.0)).ranges[0])])
    # sine rule: sin(incidence) = distance of centre * sin(beam angle) / radius
    assert heard.max() == pytest.approx(math.asin(math.sin(math.radians(30.0)) / 3.0), abs=1e-3)


def test_resolution_rounds_and_stays_within_the_limits():
    scene = crowd(8)
    fine = Lidar2D(rays=200).read(scene, Pose.of((0.0, 0.0), 0.0)).ranges
    coarse = Lidar2D(rays=200, resolution=0.25).read(scene, Pose.of((0.0, 0.0), 0.0)).ranges
    both = np.isfinite(fine)
    np.testing.assert_array_equal(both, np.isfinite(coarse))
    np.testing.assert_array_equal(coarse[both] % 0.25, 0.0)
    assert np.max(np.abs(coarse[both] - fine[both])) <= 0.125 + 0.2  # 0.05 m, the smallest distance, becomes 0.25 m
    assert coarse[both].min() >= 0.05


def test_noise_acts_on_what_was_hit_and_never_leaves_the_limits():
    scene = Scene.of([[50.0, 0.0]], walls=[ROOM])
    lidar = Lidar2D(rays=4000, range_max=4.5, noise=(Gaussian(0.05), Offset(0.1)))
    clean = Lidar2D(rays=4000, range_max=4.5).read(scene, Pose.of((0.0, 0.0), 0.0)).ranges
    noisy = lidar.read(scene, Pose.of((0.0, 0.0), 0.0), stream(1, "scan")).ranges
    inside = clean < 4.0
    error = noisy[inside] - clean[inside]
    assert error.mean() == pytest.approx(0.1, abs=0.005)
    assert error.std() == pytest.approx(0.05, abs=0.003)
    assert np.all(noisy[np.isinf(clean)] == np.inf)
    assert np.all((noisy[np.isfinite(noisy)] >= 0.05) & (noisy[np.isfinite(noisy)] <= 4.5))
    assert np.any(np.isinf(noisy) & np.isfinite(clean))  # pushed beyond the limit


def test_noise_towards_the_sensor_can_read_too_near():
    scene = Scene.of([[1.0, 0.0]], radius=0.5)
    scan = Lidar2D(rays=1, noise=Offset(-0.48)).read(scene, Pose.of((0.0, 0.0), 0.0), stream(0))
    assert scan.ranges.tolist() == [[-np.inf]]
    assert scan.hit.tolist() == [[0]]


def test_absent_agents_and_the_carrier_are_not_seen_but_invisible_ones_are():
    scene = Scene.of([[0.0, 0.0], [2.0, 0.0], [4.0, 0.0]], radius=0.3, visible=[True, False, True])
    ahead = Lidar2D(rays=1)
    assert ahead.read(scene.without(0), Pose.of((0.0, 0.0), 0.0)).hit.tolist() == [[1]]
    assert ahead.read(scene.without(0).without(1), Pose.of((0.0, 0.0), 0.0)).hit.tolist() == [[2]]


def test_seen_counts_who_returned_a_beam():
    scene = Scene.of([[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [0.0, 3.0]], radius=0.3)
    scan = Lidar2D().read(scene.without(0), Pose.of((0.0, 0.0), 0.0))
    assert isinstance(scan, Scan)
    assert scan.visible_agents(4).tolist() == [[False, True, False, True]]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"rays": 10**9}, "rays = 1000000000 must be a whole number of at least 1 and at most 1000000"),
        ({"rays": 0}, "rays = 0 must be a whole number of at least 1"),
        ({"rays": -5}, "rays = -5"),
        ({"rays": 2.5}, "rays = 2.5"),
        ({"range_min": -0.1}, "range_min = -0.1 m"),
        ({"range_max": -1.0}, "range_max = -1.0 m"),
        ({"range_min": 3.0, "range_max": 2.0}, "range_min the smaller one"),
        ({"range_max": math.inf}, "must be finite"),
        ({"field_of_view": 0.0}, "field_of_view = 0.0 rad must be above 0"),
        ({"field_of_view": 7.0}, "at most 2 pi"),
        ({"field_of_view": math.nan}, "field_of_view = nan"),
        ({"max_incidence": 2.0}, "max_incidence = 2.0 rad"),
        ({"resolution": -0.01}, "resolution = -0.01 m"),
        ({"rate": 0.0}, "rate = 0.0 Hz must be finite and at least 1e-06"),
        ({"rate": math.nan}, "rate = nan"),
        ({"noise": (0.01,)}, "noise = 0.01 is not a Noise"),
    ],
)
def test_wrong_values_are_explained(values, message):
    with pytest.raises(InputError, match=message):
        Lidar2D(**values)


def test_a_pose_for_other_environments_is_refused():
    with pytest.raises(InputError, match="the pose has 1 rows for 3 environments"):
        Lidar2D().read(crowd(0, environments=3), Pose.of((0.0, 0.0), 0.0))


def test_noise_without_randomness_is_refused():
    lidar = Lidar2D(noise=Noise.parse("gaussian(0.1)"))
    with pytest.raises(InputError, match="needs a random generator"):
        lidar.read(crowd(0), Pose.of((0.0, 0.0), 0.0))
