"""The process that overwrites the memory of a NAOqi robot, in step with the cycle in which the robot rewrites it.

A process of its own, since it must answer within a millisecond while the simulation computes. It needs ``qi`` and the
standard library only. Lines of JSON come in, and go out:

    in   {"values": {KEY: VALUE}}          virtual values, which replace those of the same keys
    out  {"connected": true}               the memory can be written
    out  {"lost": TEXT}                    the robot does not answer; it tries again each second
    out  {"velocity": [X, Y, TURN], "pose": [X, Y, HEADING]}   of the robot: forward, left [m/s], turn [rad/s]; its
                                           odometry [m], [rad]; at each change, and 20 times a second
    out  {"unread": [BEGIN, END]}          times [s] of two reads of the velocity that are further apart than 20 ms;
                                           a velocity that the robot had in between only is in its odometry alone
    out  {"reads": N, "virtual": N, "cycle": SECONDS}   reads at random moments, those with virtual values; the cycle

The process ends when its input ends. The robot then rewrites all values within a cycle.
"""

from __future__ import annotations

import contextlib
import json
import os
import random
import statistics
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any

EARLY, IDLE, AGAIN = 0.0015, 0.1, 1.0
"""Time [s] before the expected rewrite at which reading begins, without a rewrite, and between two connections."""
WAKEFUL = 4
"""After so many writes it reads without a pause: a cycle that was believed too long would never be seen to be."""
SHORTEST, LONGEST = 0.004, 0.05
"""Shortest and longest cycle of the robot [s] that is believed."""
TOLERANCE = 1e-5
"""Difference of a value that the robot has stored with 32 bits."""
POLL, TOLD = 0.05, 0.5
"""Mean time [s] between two reads that are counted, and time between two lines with their numbers."""
MOTION, UNREAD, REPEAT = 0.01, 0.02, 0.05
"""Time [s] between two reads of the motion, the longest that is not told, and the longest between two lines with it."""


class Output:
    """The output of the process; qi writes its log to file 1, which is not the output then."""

    def __init__(self) -> None:
        self._stream = os.fdopen(os.dup(1), "w")
        self._lock = threading.Lock()
        os.dup2(2, 1)

    def tell(self, fields: dict[str, Any]) -> None:
        """Write a line of JSON."""
        with self._lock, contextlib.suppress(BrokenPipeError):
            self._stream.write(json.dumps(fields) + "\n")
            self._stream.flush()


class RewriteCycle:
    """The cycle in which the robot rewrites its memory, from the moments at which it was seen."""

    def __init__(self) -> None:
        self.length = 0.0
        self._last = 0.0
        self._found: deque[float] = deque(maxlen=100)

    def note(self, moment: float) -> None:
        """Note a rewrite."""
        if SHORTEST < moment - self._last < LONGEST:
            self._found.append(moment - self._last)
            usual = sorted(self._found)[len(self._found) // 10]
            self.length = statistics.median_low(item for item in self._found if item < 1.6 * usual)  # none was missed
        self._last = moment

    def next_moment(self) -> float:
        """Return the moment of the next rewrite, 0 if it is unknown."""
        return self._last + self.length if self.length else 0.0


class MotionReader:
    """Reads the velocity of the robot, which NAOqi does not announce: a program polls it, and tells when it could not.

    Args:
        motion: the service ``ALMotion``.
        tell: writes a line to the output.
        monotonic: source of real time [s].
    """

    def __init__(
        self, motion: Any, tell: Callable[[dict[str, Any]], None], monotonic: Callable[[], float] = time.monotonic
    ) -> None:
        self._motion, self._tell, self._monotonic = motion, tell, monotonic
        self._velocity = list[float]()
        self._last = self._told = monotonic()

    def read(self) -> None:
        """Tell the motion if the velocity has changed or some time has passed, and a gap since the last read."""
        begin = self._monotonic()
        velocity = [float(item) for item in self._motion.getRobotVelocity()]
        end = self._monotonic()
        if end - self._last > UNREAD:
            self._tell({"unread": [self._last, end]})
        self._last = begin
        if velocity == self._velocity and end - self._told < REPEAT:
            return
        self._velocity, self._told = velocity, end
        self._tell({"velocity": velocity, "pose": [float(item) for item in self._motion.getRobotPosition(True)]})


class RobotLink:
    """Keeps the memory of a robot virtual.

    Args:
        url: address of the robot, ``tcp://HOST:9559``.
        tell: writes a line to the output.
    """

    def __init__(self, url: str, tell: Callable[[dict[str, Any]], None]) -> None:
        self.url, self._tell = url, tell
        self.ended = threading.Event()
        self._values: dict[str, float] = {}
        self._before: dict[str, float] = {}
        self._news = threading.Event()
        self._cycle, self._probe, self._writes = RewriteCycle(), 0, 0
        self._reads = self._virtual = 0

    def take(self, values: dict[str, float]) -> None:
        """Take values for the memory."""
        self._before, self._values = self._values, self._values | values
        self._news.set()

    def end(self) -> None:
        """End :meth:`run`."""
        self.ended.set()
        self._news.set()

    def run(self) -> None:
        """Connect until the input ends, again whenever the robot is lost."""
        while not self.ended.is_set():
            try:
                self._connect()
            except Exception as error:  # qi raises RuntimeError and others of its own
                self._tell({"lost": str(error).splitlines()[0][:200] if str(error) else type(error).__name__})
                self.ended.wait(AGAIN)

    def _connect(self) -> None:
        session, lost = _session(self.url), threading.Event()
        # The motion has a thread and a connection of its own: the reads of the memory would hold it up.
        threads = [
            threading.Thread(target=self._watch, args=(work, lost), daemon=True)
            for work in (self._read_memory, self._read_motion)
        ]
        try:
            memory = session.service("ALMemory")
            for thread in threads:
                thread.start()
            self._tell({"connected": True})
            while not self.ended.is_set() and not lost.is_set():
                self._write(memory)
            if lost.is_set():
                raise ConnectionError("the robot does not answer")
        finally:
            lost.set()
            for thread in threads:
                if thread.ident is not None:
                    thread.join(2.0)
            with contextlib.suppress(Exception):
                session.close()

    def _write(self, memory: Any) -> None:
        """Write the values, and wait until they must be written again: new ones have come, or the robot has its own."""
        self._news.clear()
        values = self._values
        if not values:
            self._news.wait(IDLE)
            return
        memory.insertListData([[key, value] for key, value in values.items()])
        keys = list(values)
        probe = keys[self._probe % len(keys)]
        self._writes += 1
        pause = min(self._cycle.next_moment() - EARLY - time.monotonic(), LONGEST)
        if pause > 0.0 and self._writes % WAKEFUL and self._news.wait(pause):
            return
        begin = time.monotonic()
        while not self._news.is_set() and time.monotonic() - begin < IDLE and not self.ended.is_set():
            if not _equal([memory.getData(probe)], [values[probe]]):
                self._cycle.note(time.monotonic())
                return
        if not self._news.is_set():
            self._probe += 7  # the real value of this key may equal the virtual one

    def _watch(self, work: Callable[[Any, threading.Event], None], lost: threading.Event) -> None:
        """Read from the robot over a connection of its own, until it is lost."""
        try:
            session = _session(self.url)
            work(session, lost)
            session.close()
        except Exception:  # the writer tells it
            lost.set()

    def _read_memory(self, session: Any, lost: threading.Event) -> None:
        """Count reads, as the programs of the robot read."""
        memory, told = session.service("ALMemory"), 0.0
        while not lost.wait(random.uniform(0.2, 1.8) * POLL):  # noqa: S311, times without a pattern
            if values := self._values:
                self._count(memory, values)
            if time.monotonic() - told > TOLD:
                told = time.monotonic()
                self._tell({"reads": self._reads, "virtual": self._virtual, "cycle": self._cycle.length})

    def _read_motion(self, session: Any, lost: threading.Event) -> None:
        """Tell the velocity of the robot."""
        if _has_motion(session):
            reader = MotionReader(session.service("ALMotion"), self._tell)
            reader.read()
            while not lost.wait(MOTION):
                reader.read()

    def _count(self, memory: Any, values: dict[str, float]) -> None:
        found = memory.getListData(list(values))
        latest = [self._values.get(key) for key in values]
        earlier = [self._before.get(key, value) for key, value in values.items()]
        self._reads += 1
        self._virtual += _equal(found, list(values.values())) or _equal(found, latest) or _equal(found, earlier)


def _session(url: str) -> Any:
    import qi

    session = qi.Session()
    session.connect(url)
    return session


def _has_motion(session: Any) -> bool:
    return any(service["name"] == "ALMotion" for service in session.services())


def _equal(found: Any, wanted: Any) -> bool:
    return all(
        isinstance(one, int | float) and abs(one - other) <= TOLERANCE for one, other in zip(found, wanted, strict=True)
    )


def main() -> None:
    """Serve the robot at the address that is the first argument."""
    link = RobotLink(sys.argv[1], Output().tell)
    thread = threading.Thread(target=link.run)
    thread.start()
    for line in sys.stdin:
        link.take(json.loads(line)["values"])
    link.end()
    thread.join()


if __name__ == "__main__":
    main()
