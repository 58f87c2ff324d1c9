"""A session of the app with a simulated headset that sends poses from a thread."""

import asyncio
import contextlib
import threading
import time

import numpy as np
from headset_messages import message

from crowdbot.vr import VR_DESKS
from crowdbot.web import AppSession, Workspace


class Headset:
    """Sends poses of a head at 1.6 m from a thread, with a clock that is 5 s ahead."""

    def __init__(self, desk):
        self.told, self.head, self.hands = [], (0.1, 0.0, 1.6), {}
        self.person = desk.arrive(self.told.append)
        self._ends, self._desk = threading.Event(), desk
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        number, exchange = 0, None
        while not self._ends.wait(0.015):
            number += 1
            more = {} if exchange is None else {"clock": np.array(exchange)}
            data = message(time.monotonic() + 5.0, head=self.head, number=number, **self.hands, **more)
            exchange = (*self.person.take(data)["clock"], time.monotonic() + 5.0)

    def stop(self, cut=False):
        self._ends.set()
        self._thread.join()
        self._desk.depart(self.person, cut)


@contextlib.contextmanager
def open_session(folder, files):
    """Yield a session of the app in a folder with some files; meet.xml is the first trial."""
    folder.mkdir()
    for name, text in files.items():
        (folder / name).write_text(text)
    desks = tuple(
        type("SimulatorDesk", (item,), {"first": "meet.xml"}) if item.name == "simulator" else item for item in VR_DESKS
    )
    loop = asyncio.new_event_loop()
    made = AppSession("main", Workspace(folder), desks, loop)
    yield made
    made.close()
    loop.close()


def until(check):
    end = time.monotonic() + 240
    while not (result := check()):
        if time.monotonic() > end:
            raise TimeoutError("nothing happens within 240 s")
        time.sleep(0.03)
    return result


def phase(desk, *wanted):
    return until(lambda: (state := desk.greet()) and state["phase"] in wanted and state)
