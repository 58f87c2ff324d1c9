"""A real rosmaster for tests, and the tools of ROS 1 that Debian has."""

import contextlib
import os
import socket
import subprocess
import time
import xmlrpc.client
from pathlib import Path

import pytest

HERE = Path(__file__).parent
PYTHON = "/usr/bin/python3"
"""The interpreter for which Debian builds rospy."""


class RosMaster(contextlib.AbstractContextManager):
    """A rosmaster on a free port of the loopback interface."""

    def __init__(self, folder):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}"
        own = {"ROS_MASTER_URI": self.url, "ROS_IP": "127.0.0.1", "ROS_HOME": str(folder), "ROS_LOG_DIR": str(folder)}
        others = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
        self.environment = others | own
        self.process = None

    def __enter__(self):
        self.begin()
        return self

    def begin(self):
        """Start it, and wait until it answers."""
        words = [PYTHON, "/usr/bin/rosmaster", "--core", "-p", str(self.port)]
        self.process = subprocess.Popen(
            words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=self.environment
        )
        end = time.monotonic() + 60.0
        while not self.state():
            if time.monotonic() > end:
                pytest.fail("rosmaster does not answer")
            time.sleep(0.05)

    def end(self):
        """Kill it."""
        self.process.kill()
        self.process.wait()

    def __exit__(self, *error):
        self.end()

    def call(self, method, *values):
        """Return the value of a call of the master API."""
        with xmlrpc.client.ServerProxy(self.url) as proxy:
            code, text, value = getattr(proxy, method)("/test", *values)
        assert code == 1, text
        return value

    def state(self):
        """Return publishers, subscribers and services by name; None if it does not answer."""
        try:
            return [dict(rows) for rows in self.call("getSystemState")]
        except OSError:
            return None

    def tool(self, *words, seconds=60.0):
        """Run a tool such as ``rostopic list`` and return what it prints."""
        command = [PYTHON, f"/usr/bin/{words[0]}", *words[1:]]
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=seconds)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def open(self, *words):
        """Start a tool, or a Python file of this folder, in a process."""
        path = HERE / words[0]
        command = [PYTHON, str(path) if path.exists() else f"/usr/bin/{words[0]}", *words[1:]]
        return subprocess.Popen(
            command, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
