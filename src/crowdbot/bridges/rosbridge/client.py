"""RosbridgeClient: joins an existing rosbridge server, such as that of a ROS system on another machine."""

from __future__ import annotations

import asyncio
import contextlib
import fnmatch
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import aiohttp

from crowdbot.bridges.inbox import Inbox, ServiceCall
from crowdbot.bridges.interface import RobotInterface
from crowdbot.bridges.joint_actions import ABORTED, INVALID_GOAL, REJECTED, goal_end
from crowdbot.bridges.socket_server import MOST_TEXT
from crowdbot.core import InputError
from crowdbot.recording import StepMessage

from .frames import FrameReader, OutgoingMessage, dump_json, field
from .session import Subscription

LEFT_OUT = ("*/reading", "*/labels")
"""Patterns of topics that are not sent unless the user names them: exact readings and truth, which are large."""
FIRST, LONGEST = 0.2, 5.0
"""Real time [s] before the first and between later attempts to connect again."""
STARTUP, HEARTBEAT, MOST_REPLIES = 10.0, 10.0, 500


class RosbridgeClient:
    """A client of a rosbridge server: it advertises the topics, services and actions of the simulation
    there.

    The server then passes on commands to ``/robot/cmd_vel`` and calls of services. If the connection is lost, the robot
    stops after its timeout, and the client connects again by itself. A slow server receives the newest messages only.

    Args:
        url: address, such as ``ws://192.168.0.2:9090``.
        token: sent as ``Authorization: Bearer``; empty: none.
        topics: patterns of the topics to send; None: all but exact readings and labels.

    Raises:
        InputError: the address is no WebSocket URL.

    >>> RosbridgeClient("ws://127.0.0.1:9090").name
    'rosbridge-client'
    """

    name = "rosbridge-client"

    def __init__(self, url: str, token: str = "", topics: Sequence[str] | None = None) -> None:
        if not url.startswith(("ws://", "wss://")):
            raise InputError(f"{url[:60]!r} is no WebSocket address, such as ws://127.0.0.1:9090")
        self.url, self.token, self.topics = url, token, topics
        self.connections = 0
        """Number of connections until now."""
        self._interface: RobotInterface | None = None
        self._inbox: Inbox | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._ready, self._news = threading.Event(), asyncio.Event()
        self._failure = ""
        self._end: asyncio.Event | None = None
        self._outgoing: dict[str, Subscription] = {}
        self._latched: dict[str, OutgoingMessage] = {}
        self._replies: deque[str] = deque(maxlen=MOST_REPLIES)
        self._goals: dict[str | int, ServiceCall] = {}
        self._steps: deque[list[OutgoingMessage]] = deque(maxlen=MOST_REPLIES)

    @classmethod
    def of(cls, address: str, token: str = "", topics: Sequence[str] | None = None) -> RosbridgeClient:
        """Return the client of an address on the command line: ``ws://HOST:PORT``."""
        return cls(address, token, topics)

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Connect, or announce another interface.

        Raises:
            InputError: there is no rosbridge server at the address.
        """
        self._interface, self._inbox = interface, inbox
        if self._thread is not None:
            self._call(self._announce)
            return
        self._thread = threading.Thread(target=self._run, name="rosbridge-client", daemon=True)
        self._thread.start()
        if not self._ready.wait(STARTUP) or self._failure:
            self.stop()
            raise InputError(f"cannot join {self.url}: {self._failure or 'no answer'}")

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Hand the messages of a step to the thread of the client."""
        self._steps.append([OutgoingMessage.of(message) for message in messages])
        self._call(self._deliver)

    def poll(self) -> None:
        """Do nothing: the thread of the client gives what arrives to the inbox."""

    def report(self, level: str, text: str) -> None:
        """Send a status message to the server."""
        self._call(self._reply, {"op": "status", "level": level, "msg": text})

    def wants(self, topic: str) -> bool:
        """Return whether a topic is sent."""
        if topic.endswith("/"):
            return True
        if self.topics is not None:
            return any(fnmatch.fnmatchcase(topic, item) for item in self.topics)
        return not any(fnmatch.fnmatchcase(topic, item) for item in LEFT_OUT)

    def stop(self) -> None:
        """Disconnect."""
        if self._thread is not None and self._loop is not None:
            if self._end is not None:
                self._call(self._end.set)
            self._thread.join(STARTUP)

    def _call(self, function: Callable[..., Any], *values: Any) -> None:
        try:
            if self._loop is not None:
                self._loop.call_soon_threadsafe(function, *values)
        except RuntimeError:  # the loop is closed
            return

    def _run(self) -> None:
        try:
            asyncio.run(self._work())
        except Exception as error:  # told by start()
            self._failure = str(error)
        finally:
            self._ready.set()

    async def _work(self) -> None:
        self._loop, self._end, self._news = asyncio.get_running_loop(), asyncio.Event(), asyncio.Event()
        headers = {"Authorization": f"Bearer {self.token}"} if self.token else {}
        wait = FIRST
        async with aiohttp.ClientSession(headers=headers) as http:
            while not self._end.is_set():
                try:
                    async with http.ws_connect(self.url, heartbeat=HEARTBEAT, max_msg_size=MOST_TEXT) as socket:
                        wait = FIRST
                        self.connections += 1
                        self._announce()
                        self._ready.set()
                        await self._exchange(socket)
                except (aiohttp.ClientError, OSError, TimeoutError) as error:
                    if not self.connections:
                        raise InputError(str(error)) from None
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(self._end.wait(), wait)
                wait = min(2.0 * wait, LONGEST)

    async def _exchange(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        """Send and receive until the connection or the run ends."""
        assert self._end is not None
        tasks = [asyncio.create_task(work) for work in (self._receive(socket), self._send(socket), _wait(self._end))]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            for goal in self._goals.values():  # nobody watches the robot any more
                goal.canceled = True

    async def _receive(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        reader = FrameReader()
        async for message in socket:
            if message.type != aiohttp.WSMsgType.TEXT:
                continue
            try:
                frame = reader.read(message.data)
                if frame is not None:
                    self._handle(frame)
            except InputError as error:
                self._reply({"op": "status", "level": "error", "msg": str(error)})

    async def _send(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        while not socket.closed:
            self._news.clear()
            frames = [self._replies.popleft()] if self._replies else self._next_frames()
            if not frames:
                await self._news.wait()
            for frame in frames:
                await socket.send_str(str(frame))

    def _next_frames(self) -> list[str | bytes]:
        now = time.monotonic()
        for topic, item in self._outgoing.items():
            if item.wait_time(now) is not None:
                self._outgoing[topic] = self._outgoing.pop(topic)  # the next topic has its turn
                return item.take(now)
        return []

    def _announce(self) -> None:
        """Advertise topics and services, and subscribe the inputs."""
        assert self._interface is not None
        self._replies.clear()
        for output in self._interface.outputs:
            if self.wants(output.name):
                latch = output.quality.latched
                self._reply({"op": "advertise", "topic": output.name, "type": output.kind, "latch": latch})
        for input_topic in self._interface.inputs:
            wait = {"queue_length": input_topic.quality.depth}  # without it a server may keep the newest alone
            self._reply({"op": "subscribe", "topic": input_topic.name, "type": input_topic.kinds[0], **wait})
        for service in self._interface.services:
            self._reply({"op": "advertise_service", "service": service.name, "type": service.kind})
        for action in self._interface.actions:
            self._reply({"op": "advertise_action", "action": action.name, "type": action.kind})
        for message in self._latched.values():
            self._offer(message)

    def _deliver(self) -> None:
        assert self._interface is not None
        latched = {output.name for output in self._interface.outputs if output.quality.latched}
        while self._steps:
            for item in self._steps.popleft():
                if self.wants(item.topic):
                    if item.topic in latched:
                        self._latched[item.topic] = item
                    self._offer(item)

    def _offer(self, message: OutgoingMessage) -> None:
        if message.topic not in self._outgoing:
            self._outgoing[message.topic] = Subscription(message.topic)
            self._outgoing[message.topic].add("", {})
        self._outgoing[message.topic].offer(message)
        self._news.set()

    def _reply(self, frame: Mapping[str, Any]) -> None:
        self._replies.append(dump_json(frame))
        self._news.set()

    def _handle(self, frame: Mapping[str, Any]) -> None:
        assert self._inbox is not None
        if frame["op"] == "publish":
            self._inbox.receive(field(frame, "topic", str), field(frame, "msg", dict), self.name)
        elif frame["op"] == "call_service":
            service, request = field(frame, "service", str), field(frame, "args", dict, {})
            number = field(frame, "id", (str, int), "")
            row = {"op": "service_response", "id": number, "service": service}
            try:
                self._inbox.call(
                    service,
                    request,
                    lambda response: self._call(self._reply, {**row, "values": response, "result": True}),
                    self.name,
                )
            except InputError as error:
                self._reply({**row, "values": str(error), "result": False})
        elif frame["op"] == "send_action_goal":
            self._follow(self._inbox, frame)
        elif frame["op"] == "cancel_action_goal" and (goal := self._goals.get(field(frame, "id", (str, int), ""))):
            goal.canceled = True
            self._inbox.wake()

    def _follow(self, inbox: Inbox, frame: Mapping[str, Any]) -> None:
        """Hand a goal to a robot, and its feedback and result to the server."""
        number, action = field(frame, "id", (str, int), ""), field(frame, "action", str)
        row = {"id": number, "action": action}

        def finish(response: dict[str, Any]) -> None:
            self._goals.pop(number, None)
            state, end = response["status"], response["result"]
            good = state != REJECTED
            values = {"values": end if good else end["error_string"], "status": state if good else ABORTED}
            self._reply({"op": "action_result", **row, **values, "result": good})

        try:
            self._goals[number] = inbox.call(
                action,
                field(frame, "args", dict, {}),
                lambda response: self._call(finish, response),
                self.name,
                lambda fields: self._call(self._reply, {"op": "action_feedback", **row, "values": fields}),
            )
        except InputError as error:
            finish(goal_end(REJECTED, INVALID_GOAL, str(error)))


async def _wait(event: asyncio.Event) -> None:
    await event.wait()
