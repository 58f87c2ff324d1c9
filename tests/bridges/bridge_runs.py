"""Helpers of the tests of bridges: a run in a thread, and a transport in memory."""

import contextlib
import threading
import time

import pytest

from crowdbot.bridges import BridgeClock, BridgeRun
from crowdbot.bridges.rosbridge.server import RosbridgeServer
from crowdbot.trials import parse_trial


def wait(reached, seconds=60.0, look=0.01):
    """Wait until something is reached, with some real time [s] between two looks; the test fails after a limit [s]."""
    end = time.monotonic() + seconds
    while not reached():
        if time.monotonic() > end:
            pytest.fail("it is not reached in time")
        time.sleep(look)


def endless_trial(seconds):
    """Return a trial in which nothing ends the run before its time: a robot on an empty floor, its goal far away."""
    text = f"""<trial name="endless" duration="{seconds}">
  <crowd type="orca"/>
  <robot name="robot" x="0" y="0">
    <drive type="differential-drive" max-speed="1.0"/><goal x="2000" y="0"/><navigator type="external"/>
    <sensor name="scan" type="lidar2d" rays="360" rate="10"/>
  </robot>
</trial>"""
    return parse_trial(text, place="endless")


class MemoryTransport:
    """A transport that keeps everything in lists."""

    name = "memory"

    def __init__(self, topics=None):
        self.topics, self.sent, self.reports, self.interfaces = topics, [], [], []
        self.inbox = None
        self.stopped = 0

    def start(self, interface, inbox):
        self.interfaces.append(interface)
        self.inbox = inbox

    def publish(self, messages):
        self.sent += messages

    def poll(self):
        """Nothing arrives by itself."""

    def report(self, level, text):
        self.reports.append((level, text))

    def wants(self, topic):
        return self.topics is None or topic in self.topics

    def stop(self):
        self.stopped += 1

    def call(self, service, request=None):
        """Call a service from another thread and return its response."""
        done, found = threading.Event(), []

        def answer(response):
            found.append(response)
            done.set()

        self.inbox.call(f"/crowdbot/{service}", request or {}, answer, self.name)
        assert done.wait(180.0), service  # kernels may be compiled
        return found[0]


class Running(contextlib.AbstractContextManager):
    """A bridge run in a thread; leaving the context ends it."""

    def __init__(self, trial, transports, mode="paced", rate=1.0, out=None, seed=0):
        self.notes = []
        self.run = BridgeRun(trial, transports, seed, out, BridgeClock(mode, rate), note=self.notes.append)
        self.summary = self.error = None
        self._started = threading.Event()
        begin = self.run.port.begin

        def note_begin(simulation):
            begin(simulation)
            self._started.set()

        self.run.port.begin = note_begin
        self.thread = threading.Thread(target=self._work, daemon=True)

    def _work(self):
        try:
            self.summary = self.run.run()
        except BaseException as error:
            self.error = error
        finally:
            self._started.set()

    def __enter__(self):
        self.thread.start()
        assert self._started.wait(300.0)  # kernels may be compiled on a busy computer
        return self

    def end(self, seconds=60.0):
        """Wait for the end of the run and return its summary."""
        self.thread.join(seconds)
        assert not self.thread.is_alive()
        if self.error is not None:
            raise self.error
        return self.summary

    def __exit__(self, *error):
        self.run.stop.asked = True
        self.run.port.inbox.wake()
        self.end()


def serve(trial, mode="paced", rate=1.0, out=None, **options):
    """Return a run with a rosbridge server on a free port, and the server."""
    server = RosbridgeServer(port=0, **options)
    return Running(trial, [server], mode, rate, out), server
