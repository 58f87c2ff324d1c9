"""The rosbridge server with the real roslib of npm in a process of Node."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest
from bridge_runs import serve

from crowdbot.trials import load_trial

FOLDER = Path(__file__).with_name("roslib")


@pytest.mark.sweep
def test_roslib_reads_every_compression_and_uses_services_and_actions(tmp_path):
    shutil.copytree(FOLDER, tmp_path, dirs_exist_ok=True)
    subprocess.run(["npm", "ci", "--silent", "--no-audit"], cwd=tmp_path, check=True, timeout=300)
    running, server = serve(load_trial("frontal", duration=300.0))
    with running:
        command = ["node", "client.mjs", str(server.port)]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert "/robot/scan" in document["topics"]
    assert document["details"] == ["geometry_msgs/msg/Twist", "geometry_msgs/msg/Vector3"]
    assert document["scans"] == {
        "none": ["Array", 360],
        "png": ["Array", 360],
        "cbor": ["Float32Array", 360],
        "cbor-raw": ["secs", "nsecs", "bytes"],
    }
    assert document["x"] > -4.4
    assert document["sum"] == 5
    assert document["feedback"] == 20
    assert document["result"]["result"]["result"] == 1
