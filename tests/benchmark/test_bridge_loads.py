"""Processor time of bridges."""

import pytest

from crowdbot.benchmark import measure
from crowdbot.benchmark.speed.bridge_loads import LOADED_BRIDGES, bridge_load
from crowdbot.core import InputError


@pytest.mark.parametrize("connection", [pytest.param(item, marks=pytest.mark.sweep) for item in LOADED_BRIDGES[1:]])
def test_a_bridge_sends_scan_image_odometry_and_transforms_on_a_quarter_of_a_core(connection):
    check(connection, bridge_load(connection, 5.0), 5.0)


@pytest.mark.live
def test_the_rows_of_the_benchmark_are_those_of_one_run(monkeypatch):
    loads = []

    def load(name):
        loads.append(bridge_load(name, 2.0))
        return loads[-1]

    monkeypatch.setattr("crowdbot.benchmark.speed.bridge_loads.LOADED_BRIDGES", ("rosbridge",))
    monkeypatch.setattr("crowdbot.benchmark.speed.bridge_loads.bridge_load", load)
    rows = measure(["bridges"], 1)
    (seen,) = loads
    endings = ("", "-p50", "-p99", "-age")
    assert [row.name for row in rows] == [f"bridge-rosbridge{ending}" for ending in endings]
    assert [row.median for row in rows] == [seen.share, seen.p50, seen.p99, seen.age]
    assert [row.unit for row in rows] == ["CPU s/s", "ms", "ms", "s"]
    assert rows[0].ratio == seen.share / 0.25
    check("rosbridge", seen, 2.0)


def check(connection, load, seconds):
    print(f"{connection}: {100 * load.share:.1f} % of a core, {load.bytes / load.seconds / 1e6:.1f} MB/s")
    print(f"{connection}: {load.p50:.2f} ms, {load.p99:.2f} ms (99 %), age {load.age:.3f} s")
    assert load.share < 0.25
    assert load.age < 0.6
    assert 0.0 < load.p50 <= load.p99  # other programs use the processor as well
    steps = 20 * (seconds + 1.0)
    assert (
        steps < load.messages <= 3.0 * steps + 6
    )  # scan and image at 10 Hz, others at 20 Hz; a slow viewer loses some


def test_only_some_connections_are_measured():
    with pytest.raises(InputError, match="load of 'qi' is not measured; measured are rosbridge"):
        bridge_load("qi")
