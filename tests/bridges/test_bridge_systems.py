"""Robot interfaces on other operating systems: refused in one sentence, or served in another way."""

import importlib.util
import os
import socket
import sys
from types import SimpleNamespace

import pytest

from crowdbot.bridges import stack_link
from crowdbot.bridges.motion_capture import natnet
from crowdbot.bridges.naoqi import NaoqiBridge
from crowdbot.bridges.stack_link import StackProgram
from crowdbot.cli.join.stop_key import StopKey
from crowdbot.core import InputError


def test_windows_starts_no_robot_software(monkeypatch):
    monkeypatch.setattr(sys, "platform", "win32")
    with pytest.raises(InputError) as caught:
        StackProgram("ros2 launch nav2", {}, {})
    assert str(caught.value) == (
        "the start of 'ros2 launch nav2' by a run needs Linux or macOS, this is Windows;"
        " start it yourself, and leave out command"
    )


@pytest.mark.parametrize(("system", "name"), [("darwin", "macOS"), ("win32", "Windows")])
def test_naoqi_needs_a_package_of_linux(monkeypatch, system, name):
    monkeypatch.setattr(importlib.util, "find_spec", lambda module: None)
    monkeypatch.setattr(sys, "platform", system)
    with pytest.raises(InputError) as caught:
        NaoqiBridge("tcp://robot:9559")
    assert str(caught.value) == (
        f"the bridge naoqi needs Linux on x86-64, for the package qi, this is {name}; run crowdbot on such a computer"
    )


def test_the_lock_of_a_domain_needs_no_user_number_on_windows(monkeypatch):
    monkeypatch.delattr(os, "getuid")
    monkeypatch.setattr(sys, "platform", "win32")
    assert stack_link._lock_path(101).name == "crowdbot-domain-101.lock"


@pytest.mark.parametrize(("system", "bound"), [("win32", "192.168.0.7"), ("darwin", "239.255.42.99")])
def test_the_address_of_a_multicast_socket(monkeypatch, system, bound):
    seen = []
    fake = SimpleNamespace(bind=seen.append, setsockopt=lambda *words: None)
    monkeypatch.setattr(socket, "socket", lambda *words: fake)
    monkeypatch.setattr(sys, "platform", system)
    assert natnet._join("239.255.42.99", 1511, "192.168.0.7") is fake
    assert seen == [(bound, 1511)]


@pytest.mark.parametrize("system", ["linux", "win32"])
def test_the_stop_key_reads_lines(monkeypatch, system):
    seen = []
    out, into = os.pipe()
    with os.fdopen(out) as stream:
        monkeypatch.setattr(sys, "stdin", stream)
        monkeypatch.setattr(sys, "platform", system)
        with StopKey(lambda stop, reason: seen.append(stop) or "") as key:
            os.write(into, b"\r\ngo\r\n")
            os.close(into)
            key._thread.join()
    assert seen == [True, False]


def test_a_line_after_the_end_of_a_run_stops_nothing_on_windows(monkeypatch):
    seen = []
    out, into = os.pipe()
    with os.fdopen(out) as stream:
        monkeypatch.setattr(sys, "stdin", stream)
        monkeypatch.setattr(sys, "platform", "win32")
        with StopKey(lambda stop, reason: seen.append(stop) or "") as key:
            pass
        os.write(into, b"\n")
        key._thread.join()
        os.close(into)
    assert seen == []
