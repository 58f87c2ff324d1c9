"""Subscription: what one client receives of one topic, with throttle, queue, fragments and compression."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any

from crowdbot.core import InputError

from .encoding import COMPRESSIONS, OutgoingMessage
from .frames import field

LONGEST_QUEUE = 1000
SMALLEST_FRAGMENT = 16


class Subscription:
    """Messages of a topic that wait for one client; the oldest are dropped when the queue is full.

    A client can subscribe several times with different ids: the smallest throttle rate and fragment size count, as in
    rosbridge_suite.

    Args:
        topic: name of the topic.
        depth: number of messages that wait if the client asks for no queue.

    >>> newest = Subscription("/chat", 1)
    >>> newest.add("a", {"op": "subscribe", "throttle_rate": 100})
    >>> for word in ("one", "two"):
    ...     newest.offer(OutgoingMessage("/chat", "", 0, lambda word=word: {"data": word}))
    >>> newest.take(now=5.0), newest.due
    (['{"op":"publish","topic":"/chat","msg":{"data":"two"}}'], 5.1)
    """

    def __init__(self, topic: str, depth: int = 1) -> None:
        self.topic, self.depth, self.kind = topic, depth, ""
        self.due = 0.0
        """Real time [s] before which nothing is sent."""
        self.dropped = 0
        self._asked: dict[str, dict[str, Any]] = {}
        self._waiting: deque[OutgoingMessage] = deque(maxlen=depth)
        self._interval, self._fragment, self._compression = 0.0, None, "none"
        self._number = 0

    def add(self, name: str, frame: Mapping[str, Any]) -> None:
        """Add a request of the client with its id.

        Raises:
            InputError: a value is not allowed.
        """
        throttle = field(frame, "throttle_rate", (int, float), 0)
        queue = field(frame, "queue_length", int, 0)
        fragment = field(frame, "fragment_size", int, None)
        compression = field(frame, "compression", str, "none")
        if compression not in COMPRESSIONS:
            raise InputError(f"compression {compression[:40]!r} is unknown; known are {', '.join(COMPRESSIONS)}")
        if not 0 <= throttle <= 1e9 or not 0 <= queue <= LONGEST_QUEUE:
            raise InputError(f"throttle_rate must be from 0, queue_length from 0 to {LONGEST_QUEUE}")
        if fragment is not None and fragment < SMALLEST_FRAGMENT:
            raise InputError(f"fragment_size must be at least {SMALLEST_FRAGMENT}")
        if len(self._asked) >= LONGEST_QUEUE and name not in self._asked:
            raise InputError(f"{LONGEST_QUEUE} subscriptions of one topic are too many")
        self._asked[name] = {
            "throttle": throttle / 1000.0,
            "queue": queue,
            "fragment": fragment,
            "compression": compression,
        }
        self._settle()

    def remove(self, name: str | None) -> bool:
        """Remove the request of an id, or all; return whether none is left."""
        if name is None:
            self._asked.clear()
        else:
            self._asked.pop(name, None)
        if self._asked:
            self._settle()
        return not self._asked

    def offer(self, message: OutgoingMessage) -> None:
        """Let a message wait; the oldest one is dropped if too many do."""
        self.dropped += len(self._waiting) == self._waiting.maxlen
        self._waiting.append(message)

    def wait_time(self, now: float) -> float | None:
        """Return the time [s] until something can be sent, None if nothing waits."""
        return max(0.0, self.due - now) if self._waiting else None

    def take(self, now: float) -> list[str | bytes]:
        """Return the frames of the next message; call it if :meth:`wait_time` is 0."""
        message = self._waiting.popleft()
        self.due = now + self._interval
        self._number += 1
        return message.frames(self._compression, self._fragment, f"{self.topic}:{self._number}")

    def _settle(self) -> None:
        asked = self._asked.values()
        self._interval = min(one["throttle"] for one in asked)
        sizes = [one["fragment"] for one in asked if one["fragment"] is not None]
        self._fragment = min(sizes) if sizes else None
        wanted = {one["compression"] for one in asked}
        self._compression = next(name for name in ("none", "png", "cbor", "cbor-raw") if name in wanted)
        depth = max(self.depth, *(one["queue"] for one in asked)) if asked else self.depth
        if depth != self._waiting.maxlen:
            self._waiting = deque(self._waiting, maxlen=depth)
