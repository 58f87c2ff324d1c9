"""A learned navigator that knows only scans: its inputs, memory, limits, files of weights, and equal runs."""

import dataclasses
import math

import numpy as np
import pytest

from crowdbot.core import InputError, Pose, Scene, Twist, Walls
from crowdbot.evaluation import parse_methods
from crowdbot.navigation import (
    SCAN_SECTORS,
    DriveLimits,
    Observation,
    ObservationBatch,
    ScanPolicyNavigator,
    ScanPolicyWeights,
    VisiblePeople,
    check_navigator,
    drive_twist,
    policy_file,
    remember_scan,
    scan_inputs,
)
from crowdbot.navigation.planners.scan_policy import surface_points
from crowdbot.recording import branch, record, replay
from crowdbot.sensors import Lidar2D
from crowdbot.simulation import simulate, simulate_seeds
from crowdbot.trials import load_trial

DIFFERENTIAL = DriveLimits(1.0, 1.5, 1.0, 3.0)
SIDEWAYS = DriveLimits(1.0, 1.5, holonomic=True)
WALL = Walls.of([[(-3.0, 2.0), (5.0, 2.0)]])


def scan_of(pose, time=0.0, people=((2.0, 0.3),), lidar=None, mount=0.0):
    """Return a scan of people at rest and a wall; ``mount`` is the heading of the scanner on the robot."""
    scene = Scene.of(np.array(people, dtype=float).reshape(1, -1, 2), radius=0.3, walls=WALL)
    scan = (lidar or Lidar2D(rays=360)).read(scene, Pose.of(pose[:2], pose[2] + mount))
    return dataclasses.replace(scan, time=time)


def seen(pose=(0.0, 0.0, 0.0), time=0.0, scan=None, **changes):
    known = {"pose": pose, "goal": (6.0, 0.0), "radius": 0.3, "limits": DIFFERENTIAL, "dt": 0.1, "time": time}
    return Observation(**(known | {"scan": scan or scan_of(pose, time)} | changes))


def drive(navigator, observations):
    memory = navigator.begin(observations[0])
    for observation in observations:
        action, memory = navigator.act(observation, memory)
    return action.twist, memory


def inputs_of(memory, pose=(0.0, 0.0, 0.0), time=0.0, waypoint=(6.0, 0.0)):
    places = (np.array(value) for value in (pose, (6.0, 0.0), waypoint))
    return scan_inputs(*places, np.zeros(3), 0.3, DIFFERENTIAL, memory, time)


@pytest.mark.parametrize("horizon", [0.0, 0.5])
def test_the_contract_is_kept(horizon):
    check_navigator(ScanPolicyNavigator(horizon=horizon))


@pytest.mark.parametrize("limits", [DIFFERENTIAL, SIDEWAYS])
@pytest.mark.parametrize("horizon", [0.0, 0.5])
def test_twists_are_within_the_limits_and_people_and_walls_of_the_observation_do_not_count(limits, horizon):
    navigator = ScanPolicyNavigator(speed=0.6, horizon=horizon)
    row = [seen((0.05 * k, 0.0, 0.3), 0.1 * k, limits=limits, twist=Twist(0.5)) for k in range(5)]
    twist, _ = drive(navigator, row)
    assert math.hypot(twist.forward, twist.left) <= 0.6 + 1e-9
    assert abs(twist.turn) <= limits.max_turn_rate
    assert limits.holonomic or twist.left == 0.0
    people = VisiblePeople(np.array([[1.0, 0.1]]), np.zeros((1, 2)), np.full(1, 0.3))
    other = [dataclasses.replace(one, people=people, walls=Walls.of([[(1.0, -1.0), (1.0, 1.0)]])) for one in row]
    assert drive(navigator, other)[0] == twist


def test_the_robot_stands_before_the_first_scan():
    blind = Observation(pose=(0.0, 0.0, 0.0), goal=(6.0, 0.0), radius=0.3, limits=DIFFERENTIAL, dt=0.1)
    assert drive(ScanPolicyNavigator(), [blind]) == (Twist(), ())


@pytest.mark.parametrize("mount", [0.4, math.pi / 2, -2.0])
def test_a_rotated_mount_gives_the_same_twist(mount):
    step = 2.0 * math.pi / 720
    turned = round(mount / step) * step  # by whole beams, so that the same points are measured
    lidar = Lidar2D(rays=720)
    first = [seen(time=0.1 * k, scan=scan_of((0.0, 0.0, 0.0), 0.1 * k, lidar=lidar)) for k in range(4)]
    other = [seen(time=0.1 * k, scan=scan_of((0.0, 0.0, 0.0), 0.1 * k, lidar=lidar, mount=turned)) for k in range(4)]
    np.testing.assert_allclose(
        drive(ScanPolicyNavigator(), other)[0], drive(ScanPolicyNavigator(), first)[0], atol=1e-5
    )


def test_directions_that_the_scanner_does_not_cover_are_free():
    narrow = scan_of((0.0, 0.0, 0.0), people=((-1.0, 0.0), (2.0, 0.0)), lidar=Lidar2D(rays=180, field_of_view=math.pi))
    sectors = inputs_of(((0.0, surface_points(narrow)),)).sectors[0]
    bearing = (np.arange(SCAN_SECTORS) + 0.5) * 2.0 * math.pi / SCAN_SECTORS - math.pi
    assert not sectors[np.abs(bearing) > math.pi / 2 + 0.1].any()
    assert sectors[np.abs(bearing) < 0.05].min() > 0.2
    broken = dataclasses.replace(narrow, ranges=np.where(np.arange(180) % 2, np.nan, -np.inf)[None])
    assert not inputs_of(((0.0, surface_points(broken)),)).sectors.any()


@pytest.mark.parametrize("rays", [60, 90, 1080])
def test_scanners_with_few_and_with_many_beams_see_the_same_wall(rays):
    scan = scan_of((0.0, 0.0, 0.0), people=((9.0, 9.0),), lidar=Lidar2D(rays=rays, range_max=25.0))
    sectors = inputs_of(((0.0, surface_points(scan)),)).sectors[0]
    fine = inputs_of(((0.0, surface_points(scan_of((0.0, 0.0, 0.0), people=((9.0, 9.0),)))),)).sectors[0]
    np.testing.assert_allclose(sectors, fine, atol=0.06)
    assert sectors.max() == pytest.approx((1.0 / 2.7 - 1.0 / 7.0) * 7.0 / 6.0, abs=0.01)  # 1.7 m from the robot


def test_old_scans_are_seen_from_where_the_robot_is_now():
    memory = ()
    for k in range(7):
        pose = (0.1 * k, 0.0, 0.2 * k)
        memory = remember_scan(memory, 0.1 * k, surface_points(scan_of(pose, 0.1 * k)))
    sectors = inputs_of(memory, (0.6, 0.0, 1.2), 0.6).sectors
    assert np.abs(sectors[1:] - sectors[0]).mean() < 0.01  # surfaces at rest do not move
    walking = remember_scan(memory, 0.7, surface_points(scan_of((0.6, 0.0, 1.2), 0.7, people=((1.4, 0.0),))))
    assert inputs_of(walking, (0.6, 0.0, 1.2), 0.7).sectors[0].max() > sectors[0].max() + 0.1


def test_the_memory_is_by_time_whatever_the_rate_of_the_scanner():
    points = np.zeros((1, 3))
    fast: tuple = ()
    for k in range(400):
        fast = remember_scan(fast, 0.01 * k, points + k)
    times = [time for time, _ in fast]
    assert len(fast) < 30
    assert times[-1] == 3.99
    assert min(times) < 3.99 - 0.6
    found = [min(times, key=lambda time: abs(3.99 - time - lag)) for lag in (0.0, 0.3, 0.6)]
    assert found == pytest.approx([3.99, 3.69, 3.39], abs=0.035)  # half of the spacing and of a step


def test_decisions_of_a_batch_are_those_of_each_environment():
    poses = np.array([[0.0, 0.0, 0.1], [0.4, -0.5, 1.0], [-0.3, 0.2, -2.0]])
    people = np.array([[[2.0, 0.3]], [[1.5, -0.4]], [[0.8, 0.2]]])
    scans = Lidar2D(rays=180).read(Scene.of(people, radius=0.3, walls=WALL), Pose(poses[:, :2], poses[:, 2]))
    batch = ObservationBatch(pose=poses, goal=np.tile([6.0, 0.0], (3, 1)), radius=np.full(3, 0.3), limits=SIDEWAYS,
                             dt=0.1, readings={"scan": scans})  # fmt: skip
    navigator = ScanPolicyNavigator()
    decisions = navigator.decide_batch(batch, [navigator.begin(batch.environment(k)) for k in range(3)])
    assert not decisions.failures
    for k in range(3):
        action, memory = navigator.act(batch.environment(k), ())
        assert tuple(action.twist) == tuple(decisions.twist[k].tolist())
        np.testing.assert_array_equal(memory[0][1], decisions.memories[k][0][1])


@pytest.mark.parametrize(
    ("velocity", "limits", "twist"),
    [
        ((0.5, 0.0), DIFFERENTIAL, (0.5, 0.0, 0.0)),
        ((0.0, -0.5), DIFFERENTIAL, (0.0, -1.5, 0.0)),
        ((0.01, 0.01), DIFFERENTIAL, (0.0, 0.0, 0.0)),
        ((3.0, 0.0), SIDEWAYS, (1.0, 0.0, 0.0)),
    ],
)
def test_drives_follow_a_velocity(velocity, limits, twist):
    np.testing.assert_allclose(drive_twist(np.array(velocity), 0.0, limits, 0.1), twist, atol=1e-9)


@pytest.mark.parametrize("limits", [DIFFERENTIAL, SIDEWAYS])
def test_the_check_brakes_for_a_surface_ahead(limits, tmp_path):
    arrays = {name: np.zeros(shape, np.float32) for name, shape in ScanPolicyWeights.shapes().items()}
    arrays["action3_bias"][0] = 1.0  # straight to the goal
    file = tmp_path / "straight.npz"
    ScanPolicyWeights(**arrays).save(file, {})
    near = [seen(scan=scan_of((0.0, 0.0, 0.0), people=((0.75, 0.0),)), limits=limits, twist=Twist(0.2))]
    free, _ = drive(ScanPolicyNavigator(horizon=0.0, file=str(file)), near)
    checked, _ = drive(ScanPolicyNavigator(horizon=1.0, file=str(file)), near)
    assert free.forward == pytest.approx(1.0)
    assert checked.forward < 0.3


def test_the_shipped_weights_have_a_card():
    assert policy_file("scan-policy").stat().st_size < 300_000
    _, card = ScanPolicyWeights.read(policy_file("scan-policy"))
    assert {"origin", "plan", "score"} <= set(card)


def test_wrong_files_of_weights_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"there is no file .*; make one with examples/train_scan_navigator.py"):
        drive(ScanPolicyNavigator(file=str(tmp_path / "none.npz")), [seen()])
    with pytest.raises(InputError, match="scan1_weight must be"):
        drive(ScanPolicyNavigator(file=str(policy_file("policy"))), [seen()])
    hostile = tmp_path / "hostile.npz"
    np.savez(hostile, content=np.array([{"format": 1}], dtype=object))
    with pytest.raises(InputError, match="has no weights"):
        drive(ScanPolicyNavigator(file=str(hostile)), [seen()])


@pytest.mark.parametrize(
    ("values", "message"),
    [({"speed": 0.0}, "speed = 0"), ({"horizon": -1.0}, "horizon = -1"), ({"margin": 0.0}, "margin = 0")],
)
def test_wrong_values_are_explained(values, message):
    with pytest.raises(InputError, match=message):
        ScanPolicyNavigator(**values)


def test_runs_are_equal_in_batches_alone_replayed_and_branched(tmp_path):
    trial = parse_methods("scan-policy")[0].put_into(load_trial("frontal", duration=2.5))
    together = [seed.digest for seed in simulate_seeds(trial, range(2))]
    first = record(trial, 0, out=tmp_path / "first")
    assert together == [first.digest, simulate(trial, 1).digest]
    assert replay(tmp_path / "first" / "episode.mcap").equal
    assert branch(tmp_path / "first" / "episode.mcap", at=2.0).digest == first.digest
