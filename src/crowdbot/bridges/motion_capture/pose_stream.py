"""Live streams of poses: address, receiving thread, and clock."""

from __future__ import annotations

import math
import socket
import threading
import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from types import TracebackType
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .retargeting import SourceSkeleton, normalize


@dataclass(frozen=True, eq=False)
class MotionSample:
    """The pose of one subject at one instant; x forward, y left, z up, the floor at 0.

    Fields:
        number: number of the sample in the source; it increases.
        time: time stamp by the clock of the source [s].
        position: positions of the joints ``[J, 3]`` [m]; one for a rigid body.
        rotation: rotations ``[J, 3, 3]`` relative to the rest pose.
        skeleton: the joints; None: a rigid body.
    """

    number: int
    time: float
    position: Floats
    rotation: Floats
    skeleton: SourceSkeleton | None = None


@dataclass(frozen=True)
class StreamStatistics:
    """What a stream has received.

    Fields:
        samples: number of valid samples.
        lost: number of samples that were sent and did not arrive, by the numbers of the source.
        refused: number of datagrams that are not valid.
        reason: why the last one was refused, empty if none was.
        rate: samples per second of the source clock, 0 with fewer than two samples.
    """

    samples: int = 0
    lost: int = 0
    refused: int = 0
    reason: str = ""
    rate: float = 0.0


class PoseStream(ABC):
    """A motion capture system or a recording of one. Use it as a context: it holds sockets and threads.

    Attributes:
        live: whether samples come in real time; the simulation must then run in real time.
    """

    live = False

    def __enter__(self) -> PoseStream:
        """Start to receive."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop; a stream without sockets has nothing to do."""
        return

    @abstractmethod
    def subjects(self) -> tuple[str, ...]:
        """Return the names of the subjects that are known by now."""

    @abstractmethod
    def read(self, subject: str, now: float, ahead: float) -> list[tuple[float, MotionSample]]:
        """Return samples of a subject with their simulated times [s], in ascending order.

        A recording returns the samples around ``ahead``, at most two; a live stream the newest sample, if it is new.

        Args:
            subject: name of the subject; empty: the first one.
            now: current simulated time [s].
            ahead: simulated time of the next step [s].
        """

    def statistics(self, subject: str = "") -> StreamStatistics:
        """Return what has been received of a subject; empty: of the first one."""
        return StreamStatistics()

    def latency(self) -> tuple[float, float] | None:
        """Return median and 99th percentile of the age of samples when they are used [s]; None for a recording."""
        return None


RESET = 2.0
"""A jump [s] between two clocks above which the estimate starts anew, for instance if the sender restarts."""


class ClockOffset:
    """Estimates the offset of the local clock to that of a sender.

    A datagram that is sent at ``sent`` arrives at ``sent + offset + delay`` with a delay of at least 0. The estimate is
    the smallest difference in a window that slides with the sender's clock: it follows drift and ignores queues. It
    contains the smallest delay of the path, which cannot be observed in one direction.

    Source: minimum filter of one-way delays, as in RFC 5905 section 10.

    Args:
        window: length of the window [s].

    >>> offset = ClockOffset()
    >>> for sent, delay in ((0.0, 0.03), (0.1, 0.01), (0.2, 0.05)):
    ...     offset.add(sent, sent + 7.0 + delay)
    >>> round(offset.value, 6)
    7.01
    """

    def __init__(self, window: float = 10.0) -> None:
        self.window = window
        self._lowest: deque[tuple[float, float]] = deque()

    @property
    def value(self) -> float:
        """The offset [s]; NaN before the first pair."""
        return self._lowest[0][1] if self._lowest else math.nan

    def add(self, sent: float, arrived: float) -> None:
        """Add the time stamps of a datagram [s]."""
        difference = arrived - sent
        if self._lowest and abs(difference - self._lowest[0][1]) > RESET:
            self._lowest.clear()
        while self._lowest and self._lowest[-1][1] >= difference:
            self._lowest.pop()
        self._lowest.append((sent, difference))
        while self._lowest[0][0] < sent - self.window:
            self._lowest.popleft()


class DelaySamples:
    """The latest 10 000 delays and their quantiles.

    >>> delays = DelaySamples()
    >>> for k in range(101):
    ...     delays.add(k / 1000)
    >>> delays.quantile(0.5), delays.quantile(0.99)
    (0.05, 0.099)
    """

    def __init__(self, most: int = 10_000) -> None:
        self._values: deque[float] = deque(maxlen=most)

    def __len__(self) -> int:
        """Return the number of delays."""
        return len(self._values)

    def add(self, delay: float) -> None:
        """Add a delay [s]."""
        self._values.append(delay)

    def quantile(self, share: float) -> float:
        """Return a quantile [s]; NaN without delays."""
        ordered = sorted(self._values)
        return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else math.nan


MOST_SUBJECTS = 32
SILENCE = 2.0
"""Time [s] without a datagram of a sender after which another one is accepted."""
WAIT = 0.05
"""Longest time [s] that the thread waits for a datagram before it looks whether it has to end."""
PACE = 0.25
"""Simulated time [s] over which the offset of simulated time to the local clock is estimated: a run that cannot keep up
changes it."""


class BadDatagram(Exception):
    """A datagram does not keep to the protocol."""


class _Subject:
    """The newest sample of a subject, and counts."""

    def __init__(self) -> None:
        self.offset = ClockOffset()
        self.newest: MotionSample | None = None
        self.given = -1
        self.first = 0.0
        self.samples = self.lost = 0

    def add(self, sample: MotionSample, arrived: float) -> None:
        """Take a sample. One that is out of order is dropped; after a restart of the sender, counts begin anew."""
        newest = self.newest
        behind = -1 if newest is None else newest.number - sample.number
        if newest is not None and 0 <= behind < 1000 and newest.time - sample.time < 1.0:
            return
        if newest is None or not 0 < sample.number - newest.number < 1000:
            self.first, self.samples, self.lost, self.given = sample.time, 0, 0, -1
        else:
            self.lost += sample.number - newest.number - 1
        self.samples += 1
        self.newest = sample
        self.offset.add(sample.time, arrived)

    @property
    def rate(self) -> float:
        """Samples per second, lost ones included."""
        span = 0.0 if self.newest is None else self.newest.time - self.first
        return (self.samples + self.lost - 1) / span if span > 0.0 else 0.0


class PoseReceiver(PoseStream):
    """Receives datagrams in a thread and keeps the newest sample of each subject.

    Whatever a datagram contains, the thread goes on: what breaks the protocol is counted and dropped. Only one sender
    is heard at a time; another one is accepted after 2 s of silence.

    The time stamps of the sender are mapped to simulated time with two estimates: its offset to the local clock, and
    that of simulated time to the local clock.

    Args:
        monotonic: local clock [s].
    """

    live = True

    def __init__(self, monotonic: Callable[[], float] = time.monotonic) -> None:
        self.monotonic = monotonic
        self.refused, self.reason = 0, ""
        self._subjects: dict[str, _Subject] = {}
        self._lock = threading.Lock()
        self._pace = ClockOffset(PACE)
        self._start: float | None = None
        self._ages = DelaySamples()
        self._sender: tuple[str, float] = ("", -1e9)
        self._end = threading.Event()
        self._thread: threading.Thread | None = None

    @abstractmethod
    def open_socket(self) -> socket.socket:
        """Return the socket on which datagrams arrive.

        Raises:
            InputError: the address cannot be used.
        """

    @abstractmethod
    def decode(self, data: bytes) -> Iterable[tuple[str, MotionSample]]:
        """Return the samples in a datagram with the names of their subjects.

        Raises:
            BadDatagram: the datagram breaks the protocol.
        """

    def begin(self, connection: socket.socket) -> socket.socket:
        """Do what the protocol needs at the start, and return the socket on which samples arrive."""
        return connection

    def name_sender(self, address: tuple[str, int]) -> str:
        """Return the name of a sender; datagrams of others are refused while it sends."""
        return f"{address[0]}:{address[1]}"

    def keep_alive(self, connection: socket.socket) -> None:
        """Do what the protocol needs from time to time; called at least every 50 ms while nothing arrives."""

    def __enter__(self) -> PoseReceiver:
        connection = self.open_socket()
        try:
            connection = self.begin(connection)
        except BaseException:
            connection.close()
            raise
        connection.settimeout(WAIT)
        self._end.clear()
        self._thread = threading.Thread(target=self._receive, args=(connection,), daemon=True, name="motion-capture")
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end.set()
        if self._thread is not None:
            self._thread.join()

    def _receive(self, connection: socket.socket) -> None:
        with connection:
            while not self._end.is_set():
                try:
                    data, address = connection.recvfrom(65536)
                except TimeoutError:
                    self.keep_alive(connection)
                    continue
                except OSError as error:  # for instance ICMP "port unreachable" after a request
                    self._refuse(str(error))
                    self._end.wait(WAIT)
                    self.keep_alive(connection)
                    continue
                self.take(data, self.name_sender(address), self.monotonic())
                self.keep_alive(connection)

    def take(self, data: bytes, sender: str, arrived: float) -> None:
        """Take a datagram that arrived at a time of the local clock [s]; never raises."""
        if sender != self._sender[0] and arrived - self._sender[1] < SILENCE:
            self._refuse(f"{sender} is not the first sender, {self._sender[0]}")
            return
        try:
            with np.errstate(all="ignore"):
                found = list(self.decode(data))
        except BadDatagram as error:
            self._refuse(str(error))
            return
        self._sender = (sender, arrived)
        with self._lock:
            for name, sample in found:
                if name not in self._subjects and len(self._subjects) >= MOST_SUBJECTS:
                    self._refuse(f"more than {MOST_SUBJECTS} subjects")
                    return
                self._subjects.setdefault(name, _Subject()).add(sample, arrived)

    def _refuse(self, reason: str) -> None:
        self.refused += 1
        self.reason = reason[:200]

    def subjects(self) -> tuple[str, ...]:
        with self._lock:
            return tuple(self._subjects)

    def read(self, subject: str, now: float, ahead: float) -> list[tuple[float, MotionSample]]:
        clock = self.monotonic()
        if self._start is None:
            self._start = now
        if now != self._start:  # the first step prepares the run, before the pace begins
            self._pace.add(now, clock)
        pace = clock - now if now == self._start else self._pace.value
        with self._lock:
            found = self._find(subject)
            if found is None or found.newest is None or found.newest.number == found.given:
                return []
            sample, offset = found.newest, found.offset.value
            found.given = sample.number
        self._ages.add(clock - offset - sample.time)
        return [(sample.time + offset - pace, sample)]

    def _find(self, subject: str) -> _Subject | None:
        return self._subjects.get(subject) if subject else next(iter(self._subjects.values()), None)

    def statistics(self, subject: str = "") -> StreamStatistics:
        with self._lock:
            found = self._find(subject) or _Subject()
            return StreamStatistics(found.samples, found.lost, self.refused, self.reason, found.rate)

    def latency(self) -> tuple[float, float] | None:
        """Return median and 99th percentile of the age of samples when they are used [s].

        The age counts from the sending of a sample, up to the smallest delay of the network.
        """
        return (self._ages.quantile(0.5), self._ages.quantile(0.99)) if len(self._ages) else None


def bind_socket(host: str, port: int) -> socket.socket:
    """Return a UDP socket that is bound to an address.

    Raises:
        InputError: the address cannot be used.
    """
    connection = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        connection.bind((host, port))
    except OSError as error:
        connection.close()
        raise InputError(f"cannot receive on {host}:{port}: {error.strerror or error}") from None
    return connection


AGAIN = 0.5
"""Time [s] between two requests, attempts to connect, or signs of life."""
FARTHEST = 1e4
"""Largest coordinate [m] of a pose."""


class ServerStream(PoseReceiver):
    """Receives the poses that a server sends.

    Args:
        server: address of the server.
        port: its port; None: the default port of the protocol.
        monotonic: local clock [s].
        timeout: longest time [s] to wait for the server.
    """

    default_port: ClassVar[int]

    def __init__(
        self,
        server: str = "127.0.0.1",
        port: int | None = None,
        monotonic: Callable[[], float] = time.monotonic,
        timeout: float = 5.0,
    ) -> None:
        super().__init__(monotonic)
        self.server, self.timeout = server, timeout
        self.port = self.default_port if port is None else port
        self.prepare()

    @abstractmethod
    def prepare(self) -> None:
        """Set what is known before a server has answered."""


def checked_pose(position: ArrayLike, quaternion: ArrayLike) -> tuple[Floats, Floats]:
    """Return positions ``[N, 3]`` [m] and unit quaternions ``[N, 4]`` (w, x, y, z).

    Raises:
        BadDatagram: a value is not finite, a position is farther than 10 km, or a quaternion is 0.
    """
    place = np.asarray(position, dtype=np.float64)
    unit = normalize(np.asarray(quaternion, dtype=np.float64))
    if unit is None or not np.all(np.abs(place) <= FARTHEST):
        raise BadDatagram("a pose has values that are not finite or out of range")
    return place, unit
