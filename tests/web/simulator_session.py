"""A session without windows, for tests of the simulator desk."""

import contextlib
import json
import time

from crowdbot.web import Workspace
from crowdbot.web.simulator import SimulatorDesk


class Windows:
    """Collects what a desk sends."""

    name = "main"

    def __init__(self, folder):
        self.workspace = Workspace(folder)
        self.events, self.frames, self.is_open = [], [], True

    def tell(self, event, data):
        self.events.append((event, json.loads(json.dumps(data, allow_nan=False))))

    def show(self, frame):
        self.frames = [*self.frames[-50:], frame]

    def discard(self, channel):
        self.frames = [frame for frame in self.frames if frame.channel != channel]

    def is_ready(self, channel=None):
        return self.is_open

    def latest(self, event):
        return next(data for name, data in reversed(self.events) if name == event)


def wait_until(condition, looks=30_000):
    """Wait for a condition, without a clock: on a busy machine a look takes longer."""
    for _ in range(looks):
        if condition():
            return
        time.sleep(0.01)
    raise TimeoutError


@contextlib.contextmanager
def simulator(folder):
    """A desk in a folder, closed at the end."""
    desk = SimulatorDesk(Windows(folder))
    try:
        yield desk
    finally:
        desk.close()


def ready(desk):
    wait_until(lambda: desk._status()["state"] not in ("preparing", "none"))
    return desk._status()


def ended(desk):
    wait_until(lambda: desk._status()["state"] in ("ended", "failed"))
    return desk._status()
