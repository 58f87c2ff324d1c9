"""Processor time of bridges."""

import pytest

from crowdbot.benchmark import measure
from crowdbot.benchmark.speed.bridge_loads import LOADED_BRIDGES, bridge_load
from crowdbot.core import InputError


@pytest.mark.parametrize("connection", [pytest.param(item, marks=pytest.mark.sweep) for item in LOADED_BRIDGES[1:]])
def test_a_bridge_sends_scan_image_odometry_and_transforms_on_a_quarter_of_a_core(connection):
    check(connection, bridge_load(connection, 5.0), 5.0)


@pytest.mark.live
def test_the_row_of_the_benchmark_is_the_share_of_a_core(monkeypatch):
    found = []

    def load(name):
        found.append(bridge_load(name, 2.0))
        return found[-1]

    monkeypatch.setattr("crowdbot.benchmark.speed.bridge_loads.bridge_load", load)
    (row,) = measure(["bridge-rosbridge"], 1)
    assert (row.median, row.ratio) == (found[0].share, found[0].share / 0.25)
    assert row.unit == "CPU s/s"
    check("rosbridge", found[0], 2.0)


def check(connection, load, seconds):
    print(f"{connection}: {100 * load.share:.1f} % of a core, {load.bytes / load.seconds / 1e6:.1f} MB/s")
    assert load.share < 0.25
    steps = 20 * (seconds + 1.0)
    assert (
        steps < load.messages <= 3.0 * steps + 6
    )  # scan and image at 10 Hz, others at 20 Hz; a slow viewer loses some


def test_only_some_connections_are_measured():
    with pytest.raises(InputError, match="load of 'qi' is not measured; measured are rosbridge"):
        bridge_load("qi")
