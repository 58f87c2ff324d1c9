"""ClientSession: the state and subscriptions of one client of a rosbridge server, without any connection."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping
from typing import Any

from crowdbot.bridges.socket_server import Backlog, MessageQueue
from crowdbot.core import InputError

from .frames import COMPRESSIONS, FrameReader, OutgoingMessage, dump_json, field, fragments, png_frame
from .graph import CallRelay, Frame, RosGraph, ros2_type

LONGEST_QUEUE = 1000
SMALLEST_FRAGMENT = 16


class Subscription:
    """Messages of a topic that wait for one client; the oldest are dropped when the queue is full.

    A client can subscribe several times with different ids: the smallest throttle rate and fragment size count, as in
    rosbridge_suite.

    Args:
        topic: name of the topic.
        depth: number of messages that wait if the client asks for no queue.
        backlog: what waits for the client in all its queues.

    >>> newest = Subscription("/chat", 1)
    >>> newest.add("a", {"op": "subscribe", "throttle_rate": 100})
    >>> for word in ("one", "two"):
    ...     newest.offer(OutgoingMessage("/chat", "", 0, lambda word=word: {"data": word}))
    >>> newest.take(now=5.0), newest.due
    (['{"op":"publish","topic":"/chat","msg":{"data":"two"}}'], 5.1)
    """

    def __init__(self, topic: str, depth: int = 1, backlog: Backlog | None = None) -> None:
        self.topic, self.depth, self.kind = topic, depth, ""
        self.due = 0.0
        """Real time [s] before which nothing is sent."""
        self.dropped = 0
        self._asked: dict[str, dict[str, Any]] = {}
        self._waiting = MessageQueue[OutgoingMessage](backlog or Backlog(), depth)
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
        else:
            self._waiting.clear()
        return not self._asked

    def offer(self, message: OutgoingMessage) -> None:
        """Let a message wait; the oldest ones are dropped if too many do, or too large ones."""
        self.dropped += self._waiting.append(message, message.memory)

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
        self._interval = min(item["throttle"] for item in asked)
        sizes = [item["fragment"] for item in asked if item["fragment"] is not None]
        self._fragment = min(sizes) if sizes else None
        wanted = {item["compression"] for item in asked}
        self._compression = next(name for name in ("none", "png", "cbor", "cbor-raw") if name in wanted)
        self._waiting.depth = max(self.depth, *(item["queue"] for item in asked))


LEVELS = ("info", "warning", "error", "none")
MOST_REPLIES, MOST_SUBSCRIPTIONS = 500, 500


class ClientSession:
    """Takes the frames of a client and holds the frames for it.

    Every error is answered with a status message; nothing that a client sends raises an exception.

    Args:
        graph: topics and services.
        wake: called when frames wait.
        clock: source of real time [s].
    """

    def __init__(self, graph: RosGraph, wake: Callable[[], None], clock: Callable[[], float] = time.monotonic) -> None:
        self.graph, self.wake, self.clock = graph, wake, clock
        self.subscriptions: dict[str, Subscription] = {}
        self.level = "error"
        self.calls = CallRelay(self, graph)
        self.errors = 0
        self._backlog = Backlog()
        self._replies = MessageQueue[str](self._backlog, MOST_REPLIES)
        self._reader = FrameReader()
        self._advertised: dict[str, set[str]] = {}
        self._turn: dict[str, None] = {}
        """Topics with messages that wait, in the order in which the first ones came: the clock before an image."""
        graph.sessions.append(self)

    def handle(self, data: str | bytes) -> None:
        """Do what a frame of the client asks."""
        if isinstance(data, bytes):
            self.refuse("a frame from a client must be text")
            return
        frame: Frame | None = None
        try:
            frame = self._reader.read(data)
            if frame is not None:
                self._operate(frame)
        except InputError as error:
            self.refuse(str(error), frame)
        except (RecursionError, ValueError, TypeError, AttributeError, KeyError, OverflowError) as error:
            self.refuse(f"the frame has a wrong form: {str(error)[:100]}", frame)

    def refuse(self, text: str, frame: Frame | None = None) -> None:
        """Answer an error."""
        self.errors += 1
        name = frame.get("id") if frame is not None else None
        self.status("error", text, name if isinstance(name, str) else None)

    def status(self, level: str, text: str, name: str | None = None) -> None:
        """Send a status message, if the client wants messages of this level."""
        if LEVELS.index(level) >= LEVELS.index(self.level) and self.level != "none":
            self.reply({"op": "status", "level": level, "msg": text, **({} if name is None else {"id": name})})

    def reply(self, frame: Frame, fragment_size: int | None = None, compression: str = "none") -> None:
        """Send a frame; the oldest replies are dropped if the client does not read them."""
        text = dump_json(frame)
        text = png_frame(text) if compression == "png" else text
        for part in fragments(text, fragment_size, f"reply:{id(frame)}"):
            self._replies.append(part, sys.getsizeof(part))
        self.wake()

    def offer(self, message: OutgoingMessage) -> None:
        """Let a message wait if the client subscribes its topic."""
        found = self.subscriptions.get(message.topic)
        if found is not None:
            found.offer(message)
            self._turn[message.topic] = None
            self.wake()

    def take(self) -> tuple[list[str | bytes], float | None]:
        """Return the next frames, or the time [s] until there are some (None: nothing waits); topics take turns."""
        if self._replies:
            return [self._replies.popleft()], 0.0
        now, first = self.clock(), None
        for topic in list(self._turn):
            subscription = self.subscriptions[topic]
            wait = subscription.wait_time(now)
            if not wait:
                del self._turn[topic]
            if wait == 0.0:
                frames = self._encode(subscription, now)
                if subscription.wait_time(now) is not None:
                    self._turn[topic] = None
                return frames, 0.0
            if wait is not None:
                first = wait if first is None else min(first, wait)
        return [], first

    def close(self) -> None:
        """Forget the client; callers of its services get an error."""
        self.calls.close()
        self.graph.remove(self)
        for session in self.graph.sessions:
            session.calls.forget(self)

    def _encode(self, subscription: Subscription, now: float) -> list[str | bytes]:
        try:
            return subscription.take(now)
        except (ValueError, TypeError, RecursionError, InputError) as error:  # a message of another client
            self.status("warning", f"{subscription.topic}: a message was left out: {str(error)[:100]}")
            return []

    def _operate(self, frame: Frame) -> None:
        operations: dict[str, Callable[[Frame], None]] = {
            "advertise": self._advertise,
            "unadvertise": self._unadvertise,
            "publish": self._publish,
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "set_level": self._set_level,
            "status": lambda frame: None,
            "auth": lambda frame: None,
            **self.calls.operations,
        }
        name = frame["op"]
        if name not in operations:
            raise InputError(f"the operation {name[:40]!r} is unknown; known are {', '.join(operations)}, fragment")
        operations[name](frame)

    def _advertise(self, frame: Frame) -> None:
        topic, kind = field(frame, "topic", str), field(frame, "type", str)
        self.graph.advertise(self, topic, kind, field(frame, "latch", bool, False))
        names = self._advertised.setdefault(topic, set())
        if len(names) >= LONGEST_QUEUE:
            raise InputError(f"{LONGEST_QUEUE} advertisements of one topic are too many")
        names.add(str(frame.get("id", "")))

    def _unadvertise(self, frame: Frame) -> None:
        topic = field(frame, "topic", str)
        if topic not in self._advertised:
            raise InputError(f"{topic[:60]!r} is not advertised")
        self._advertised[topic].discard(str(frame.get("id", "")))
        if "id" not in frame or not self._advertised[topic]:
            del self._advertised[topic]
            self.graph.unadvertise(self, topic)

    def _publish(self, frame: Frame) -> None:
        topic, fields = field(frame, "topic", str), field(frame, "msg", dict, {})
        self.graph.publish(self, topic, fields, field(frame, "latch", bool, False))

    def _subscribe(self, frame: Frame) -> None:
        topic, kind = field(frame, "topic", str), field(frame, "type", str, "")
        self.graph.check_name(topic)
        known = self.graph.topic_types(topic)
        if kind and known and ros2_type(kind) not in known:
            raise InputError(f"{topic!r} has the type {known[0]}, not {kind[:80]!r}")
        subscription = self.subscriptions.get(topic)
        if subscription is None:
            if len(self.subscriptions) >= MOST_SUBSCRIPTIONS:
                raise InputError(f"{MOST_SUBSCRIPTIONS} subscriptions are too many")
            subscription = Subscription(topic, self.graph.queue_depth(topic), self._backlog)
        subscription.add(str(frame.get("id", "")), frame)
        if topic not in self.subscriptions:
            self.subscriptions[topic] = subscription
            self.graph.collect_subscriptions()
            if topic in self.graph.latched:
                self.offer(self.graph.latched[topic])

    def _unsubscribe(self, frame: Frame) -> None:
        topic = field(frame, "topic", str)
        found = self.subscriptions.get(topic)
        if found is None:
            raise InputError(f"{topic[:60]!r} is not subscribed")
        name = frame.get("id")
        if found.remove(None if name is None else str(name)):
            del self.subscriptions[topic]
            self._turn.pop(topic, None)
            self.graph.collect_subscriptions()

    def _set_level(self, frame: Frame) -> None:
        level = field(frame, "level", str)
        if level not in LEVELS:
            raise InputError(f"level {level[:40]!r} must be one of {', '.join(LEVELS)}")
        self.level = level
