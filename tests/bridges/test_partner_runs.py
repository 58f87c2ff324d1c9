"""Every transport with a robot program in a process of its own: time in odd portions, control loops, and kills."""

from __future__ import annotations

from pathlib import Path

import pytest
from partner_runs import deaths, faulty, kills, load, loop, odd, server_deaths

HERE = Path(__file__).parent
HERE_ALONE = ("rosbridge", "foxglove", "tcp", "ros2")
"""Transports that need nothing but packages of Python."""
THIRTY = pytest.param(30, marks=pytest.mark.sweep)
TEN_MINUTES = pytest.param(600, marks=[pytest.mark.soak, pytest.mark.timeout(900)])
"""Seconds of the longest runs; a test is ended after ten minutes if it does not say more."""
LOOP = pytest.mark.parametrize("seconds", [3, THIRTY, TEN_MINUTES])
LONG_LOOP = pytest.mark.parametrize("seconds", [THIRTY, TEN_MINUTES])
FAULTY = pytest.mark.parametrize("count", [1, pytest.param(50, marks=pytest.mark.soak)])
KILLS = pytest.mark.parametrize(
    "count", [pytest.param(3, marks=pytest.mark.sweep), pytest.param(20, marks=pytest.mark.soak)]
)


@pytest.fixture(autouse=True)
def local(monkeypatch, tmp_path):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "log"))


def check_odd(seen):
    assert seen["steps"] == 40
    assert seen["digest"] == seen["free"]
    assert seen["sent"] > 20


def check_loop(transport, seconds, seen):
    print(f"{transport}: {seen['commands']} commands, {1e3 * seen['median']:.2f} ms, {1e3 * seen['p99']:.2f} ms (99 %)")
    assert seen["received"] == seen["sent"] >= 2 * seconds  # no command is lost; a busy computer is late
    assert 0 < seen["commands"] <= seen["sent"]  # of the commands within a step, only the first has a latency
    assert (seen["links"], seen["silences"] <= seconds // 60) == (1, True)
    assert seen["median"] < (0.05 if seconds > 60 else 0.3)  # tests share the processor


def check_kills(count, seen):
    assert len(seen["stops"]) == count
    assert max(seen["stops"]) < 4.0  # 0.5 s of simulated time, and braking, on a busy computer
    assert seen["speed"] > 0.1
    assert (seen["outcome"], seen["equal"]) == ("interrupted", True)


@pytest.mark.live
@pytest.mark.parametrize("transport", HERE_ALONE)
def test_time_in_odd_portions_gives_the_digest_of_a_free_run(transport, tmp_path):
    check_odd(odd(transport, 2, tmp_path))


def test_time_in_odd_portions_over_ros1(ros1, tmp_path):
    check_odd(odd("ros1", 2, tmp_path))


@pytest.mark.sweep
def test_time_in_odd_portions_over_a_server_of_others(tmp_path):
    check_odd(odd("rosbridge-client", 2, tmp_path))


def check_faulty(count, seen):
    print(
        f"{count} runs: {sum(digest == seen['free'] for digest in seen['digests'])} equal, {sum(seen['stale'])} stale"
    )
    assert seen["digests"] == [seen["free"]] * count
    assert min(seen["sent"]) > 60  # more than one answer to each of the 30 instants


@pytest.mark.live
@FAULTY
@pytest.mark.parametrize("transport", HERE_ALONE)
def test_copies_delays_and_old_answers_do_not_change_a_run_in_step(transport, count, tmp_path):
    seen = faulty(transport, count, tmp_path)
    check_faulty(count, seen)
    assert min(seen["stale"]) > (20 if transport != "tcp" else 0)


@FAULTY
def test_copies_delays_and_old_answers_over_ros1(ros1, count, tmp_path):
    seen = faulty("ros1", count, tmp_path)
    check_faulty(count, seen)
    assert min(seen["stale"]) > 20


@pytest.mark.sweep
@FAULTY
def test_copies_delays_and_old_answers_at_a_server_of_others(count, tmp_path):
    seen = faulty("rosbridge-client", count, tmp_path)
    check_faulty(count, seen)
    assert min(seen["stale"]) > 20


@pytest.mark.live
@LOOP
@pytest.mark.parametrize("transport", HERE_ALONE)
def test_a_control_loop_of_20_hz_loses_no_command(transport, seconds, tmp_path):
    check_loop(transport, seconds, loop(transport, seconds, tmp_path))


@LOOP
def test_a_control_loop_over_ros1_loses_no_command(ros1, seconds, tmp_path):
    check_loop("ros1", seconds, loop("ros1", seconds, tmp_path))


@LONG_LOOP
def test_a_control_loop_over_a_server_of_others_loses_no_command(seconds, tmp_path):
    check_loop("rosbridge-client", seconds, loop("rosbridge-client", seconds, tmp_path))


@pytest.mark.live
@pytest.mark.parametrize("count", [3, pytest.param(20, marks=pytest.mark.soak)])
@pytest.mark.parametrize("transport", ["rosbridge", "foxglove", "tcp", pytest.param("ros2", marks=pytest.mark.sweep)])
def test_a_killed_program_leaves_a_robot_that_stops_and_a_whole_recording(transport, count, tmp_path):
    check_kills(count, kills(transport, count, tmp_path))


@KILLS
def test_a_program_of_ros1_that_is_killed_leaves_a_robot_that_stops(ros1, count, tmp_path):
    check_kills(count, kills("ros1", count, tmp_path))


def check_deaths(count, seen):
    assert len(seen["orders"]) == count
    assert min(seen["orders"]) > 5  # the program drives each time
    assert not any(seen["complete"])
    assert max(seen["links"], seen["silences"]) >= count  # it has noticed each time


@KILLS
@pytest.mark.parametrize("transport", HERE_ALONE)
def test_a_killed_simulation_is_noticed_and_leaves_a_recording_that_can_be_read(transport, count, tmp_path):
    check_deaths(count, deaths(transport, count, tmp_path))


@KILLS
def test_a_killed_simulation_of_ros1_is_noticed(ros1, count, tmp_path):
    check_deaths(count, deaths("ros1", count, tmp_path))


@KILLS
def test_a_killed_simulation_at_a_server_of_others_is_noticed(count, tmp_path):
    check_deaths(count, deaths("rosbridge-client", count, tmp_path))


@KILLS
def test_a_killed_program_at_a_server_of_others_leaves_a_robot_that_stops(count, tmp_path):
    check_kills(count, kills("rosbridge-client", count, tmp_path))


@KILLS
def test_a_killed_server_of_others_leaves_a_robot_that_stops_and_is_joined_again(count, tmp_path):
    seen = server_deaths("rosbridge-client", count, tmp_path)
    check_kills(count, seen)
    assert seen["links"] == count + 1


def check_load(transport, seen):
    print(f"{transport}: {100 * seen['share']:.1f} % of a core, {seen['bytes'] / seen['seconds'] / 1e6:.1f} MB/s")
    assert seen["share"] < 0.25
    assert seen["messages"] > 20 * seen["seconds"]  # scan and image at 10 Hz, others at 20 Hz; a slow viewer loses some


@pytest.mark.sweep
@pytest.mark.parametrize("transport", ["rosbridge-client", "ros2"])
def test_a_bridge_sends_scan_image_odometry_and_transforms_on_a_quarter_of_a_core(transport, tmp_path):
    check_load(transport, load(transport, 5, tmp_path))


@pytest.mark.sweep
def test_the_ros1_node_sends_scan_image_odometry_and_transforms_on_a_quarter_of_a_core(ros1, tmp_path):
    check_load("ros1", load("ros1", 5, tmp_path))
