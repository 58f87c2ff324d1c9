"""The page of the robot interface is made from the code, and holds for what a run of its trial sends."""

import importlib.util
from pathlib import Path

from bridge_runs import MemoryTransport

from crowdbot.bridges import BridgeClock, run_bridge

ROOT = Path(__file__).parents[2]


def load_tool():
    spec = importlib.util.spec_from_file_location("robot_interface", ROOT / "tools" / "robot_interface.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_is_up_to_date():
    page = (ROOT / "docs" / "reference" / "robot-interface.md").read_text(encoding="utf-8")
    assert page == load_tool().page(), "run make fix"


def test_every_kind_of_sensor_keeps_the_announced_types_and_frames():
    trial = load_tool().example_trial()
    transport = MemoryTransport()
    run_bridge(trial, [transport], 0, None, BridgeClock("free"))
    known = {output.name: output for output in transport.interfaces[0].outputs}
    sent = {}
    for item in transport.sent:
        sent.setdefault(item.topic, []).append(item)
    assert {*sent} <= {*known}
    sensors = [item for item in known.values() if item.quality.name == "sensor" and not item.name.endswith("/labels")]
    assert [sensor.name for sensor in sensors if sensor.name not in sent] == []
    for name, found in sent.items():
        assert {one.kind for one in found} == {known[name].kind}, name
        frames = {one.message.header.frame_id for one in found if hasattr(one.message, "header")}
        assert frames <= {known[name].frame}, name
