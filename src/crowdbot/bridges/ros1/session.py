"""Ros1Session: the connections of a ROS 1 node, in the event loop of its thread."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
from collections.abc import Mapping, Sequence
from typing import Any

import aiohttp

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import OutputTopic, RobotInterface
from crowdbot.bridges.plain_services import PLAIN_SERVICES
from crowdbot.bridges.quality import STATE
from crowdbot.bridges.run_control import QUITTING
from crowdbot.core import InputError
from crowdbot.messages import Messages, Ros1Messages

from .master import Master
from .publication import Publication, ros1_kind
from .services import ServicePort
from .slave_api import SlaveApi
from .subscription import Ros1Subscription
from .tcpros import ROS_ERRORS, pack_frame, pack_header, read_header

TIME, DESCRIPTION = "/use_sim_time", "robot_description"


class Parameters:
    """``/use_sim_time``, and the URDF of each robot as ``/ROBOT/robot_description``.

    The description of the first robot is ``/robot_description``, too, where RViz and the navigation stack look. Other
    nodes wait for ``/clock`` as long as ``/use_sim_time`` is true, so it must not stay.

    Args:
        master: calls the parameter server.
        interface: the topics; with a received ``/clock``, the time is left alone.
    """

    def __init__(self, master: Master, interface: RobotInterface) -> None:
        self.interface = interface
        self._master = master
        self._before: dict[str, Any] = {}
        self._texts: dict[str, str] = {}

    def describe(self, texts: Mapping[str, str]) -> bool:
        """Take descriptions by their topic, and return whether one is new."""
        new = {topic: text for topic, text in texts.items() if self._texts.get(topic) != text}
        self._texts |= new
        return bool(new)

    async def set(self) -> None:
        """Set the parameters.

        Raises:
            InputError: there is no master.
        """
        values: dict[str, Any] = dict(self._texts)
        first = f"/{self.interface.trial.robots[0].name}/{DESCRIPTION}" if self.interface.trial.robots else ""
        if first in values:
            values[f"/{DESCRIPTION}"] = values[first]
        if all(one.name != "/clock" for one in self.interface.inputs):
            values[TIME] = True
        for name, value in values.items():
            if name not in self._before:
                self._before[name] = await self._get(name)
            await self._master.call("setParam", name, value)

    async def restore(self) -> None:
        """Give the parameters their earlier values.

        Raises:
            InputError: there is no master.
        """
        for name, value in self._before.items():
            if value is None:
                await self._master.call("deleteParam", name)
            else:
                await self._master.call("setParam", name, value)
        self._before.clear()

    async def _get(self, name: str) -> Any:
        if not await self._master.call("hasParam", name):
            return None
        return await self._master.call("getParam", name)


LEVELS = {"info": 2, "warning": 4, "error": 8}
"""Levels of ``rosgraph_msgs/Log``."""


def log_frame(codec: Ros1Messages, node: str, level: str, text: str) -> bytes:
    """Return the frame of ``rosgraph_msgs/Log``.

    >>> len(log_frame(Ros1Messages(), "/crowdbot", "error", "no"))
    56
    """
    types, stamp = codec.store.types, Messages().stamp(0)
    message = types["rosgraph_msgs/msg/Log"](
        header=types["std_msgs/msg/Header"](seq=0, stamp=stamp, frame_id=""),
        level=LEVELS.get(level, 8),
        name=node,
        msg=text,
        file="",
        function="",
        line=0,
        topics=[],
    )
    return pack_frame(codec.encode(message))


NODE = "/crowdbot"
LOG = OutputTopic("/rosout", "rosgraph_msgs/msg/Log", "", 0.0, STATE)
WATCH = 1.0
"""Real time [s] between two looks at the master."""
MOST_CONNECTIONS = 256


class Ros1Session:
    """Servers, registrations and connections of a node. All methods run in its event loop.

    Args:
        master: address of the master.
        host: name or address under which other nodes reach this one.
        interface: the topics.
        inbox: receives messages and calls.
        codec: types of ROS 1.
    """

    def __init__(self, master: str, host: str, interface: RobotInterface, inbox: Inbox, codec: Ros1Messages) -> None:
        self.host, self.interface, self.inbox, self.codec = host, interface, inbox, codec
        self.publications: dict[str, Publication] = {}
        self._subscriptions: dict[str, Ros1Subscription] = {}
        self._services = ServicePort(inbox, NODE)
        self._api = SlaveApi(master, self._address, self._found, self._ended, self._topics)
        self._http = aiohttp.ClientSession()
        self._master = Master(master, NODE, self._http)
        self._parameters = Parameters(self._master, interface)
        self._server: asyncio.Server | None = None
        self._peers: set[asyncio.Task[Any]] = set()
        self._wake, self._finished, self._changed = asyncio.Event(), False, False
        self._port = 0
        self._told = ""

    @property
    def url(self) -> str:
        """Address of the XML-RPC server of the node."""
        return f"http://{self.host}:{self._api.port}/"

    async def open(self) -> None:
        """Listen, and register the topics and services.

        Raises:
            InputError: there is no master.
        """
        listen = self.host if _is_loopback(self.host) else "0.0.0.0"  # noqa: S104, ROS 1 nodes connect to each other
        await self._api.open(listen)
        self._server = await asyncio.start_server(self._accept, listen, 0)
        self._port = int(self._server.sockets[0].getsockname()[1])
        self._choose_topics()
        await self._register()

    async def keep(self) -> None:
        """Stay registered until :meth:`end`: change topics, and register again if the master was started anew."""
        while not self._finished:
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._wake.wait(), WATCH)
            self._wake.clear()
            try:
                if self._changed or not await self._master.knows(self.url):
                    self._changed = False
                    await self._register()
                self._told = ""
            except InputError as error:
                if str(error) != self._told:
                    self._told = str(error)
                    self.log("error", self._told)

    async def close(self) -> None:
        """Unregister, and close all connections."""
        with contextlib.suppress(InputError):
            await self._unregister()
        for one in self._subscriptions.values():
            await one.close()
        if self._server is not None:
            self._server.close()
        for task in list(self._peers):
            task.cancel()
        await asyncio.gather(*self._peers, return_exceptions=True)
        await self._api.close()
        await self._http.close()

    def end(self) -> None:
        """End :meth:`keep`."""
        self._finished = True
        self._wake.set()

    def announce(self, interface: RobotInterface) -> None:
        """Change the topics to those of another trial."""
        self.interface, self._changed = interface, True
        self._parameters.interface = interface
        self._choose_topics()
        self._wake.set()

    def deliver(self, frames: Sequence[tuple[str, bytes]], texts: Mapping[str, str]) -> None:
        """Send frames to the subscribers, and descriptions of robots to the parameter server."""
        for topic, frame in frames:
            if topic in self.publications:
                self.publications[topic].deliver(frame)
        if self._parameters.describe(texts):
            self._changed = True
            self._wake.set()

    def log(self, level: str, text: str) -> None:
        """Send a line to ``/rosout``."""
        if LOG.name in self.publications:
            self.publications[LOG.name].deliver(log_frame(self.codec, NODE, level, text))

    def _choose_topics(self) -> None:
        """Make what is sent and received fit the interface; connections of topics that stay are kept."""
        outputs = {one.name: one for one in (*self.interface.outputs, LOG)}
        kept = {name: one for name, one in self.publications.items() if name in outputs}
        kept = {name: one for name, one in kept.items() if one.kind == outputs[name].kind}
        self.publications = {name: kept.get(name) or Publication(one, self.codec) for name, one in outputs.items()}
        for one in self.interface.inputs:
            if one.name not in self._subscriptions:
                self._subscriptions[one.name] = Ros1Subscription(one, self.codec, self.inbox, self.log)

    async def _register(self) -> None:
        """Tell the master all topics and services; what it knows already stays as it is."""
        master, url = self._master, self.url
        wanted = {one.name for one in self.interface.inputs}
        for name in set(self._subscriptions) - wanted:
            gone = self._subscriptions.pop(name)
            await gone.close()
            await master.call("unregisterSubscriber", name, url)
        sent = [("registerPublisher", one.topic, ros1_kind(one.kind), url) for one in self.publications.values()]
        await master.gather(*sent)
        await self._drop_publications()
        heard = list(self._subscriptions.values())
        found = await master.gather(*(("registerSubscriber", one.topic, ros1_kind(one.kind), url) for one in heard))
        for one, publishers in zip(heard, found, strict=True):
            one.connect(publishers, master)
        address = f"rosrpc://{self.host}:{self._port}"
        await master.gather(*(("registerService", name, address, url) for name in PLAIN_SERVICES))
        await self._parameters.set()

    async def _drop_publications(self) -> None:
        """Unregister topics that are no longer sent."""
        state = await self._master.call("getSystemState")
        known = [topic for topic, nodes in state[0] if NODE in nodes]
        gone = [("unregisterPublisher", one, self.url) for one in known if one not in self.publications]
        await self._master.gather(*gone)

    async def _unregister(self) -> None:
        master, url = self._master, self.url
        await self._parameters.restore()
        address = f"rosrpc://{self.host}:{self._port}"
        await master.gather(*(("unregisterService", name, address) for name in PLAIN_SERVICES))
        await master.gather(*(("unregisterSubscriber", name, url) for name in self._subscriptions))
        await master.gather(*(("unregisterPublisher", name, url) for name in self.publications))

    def _address(self, topic: str) -> tuple[str, int] | None:
        return (self.host, self._port) if topic in self.publications else None

    def _found(self, topic: str, publishers: Sequence[str]) -> None:
        if topic in self._subscriptions:
            self._subscriptions[topic].connect(publishers, self._master)

    def _ended(self, reason: str) -> None:
        """End the run: the master has another node of this name, or a user has killed this one."""
        with contextlib.suppress(InputError):
            request = {"state": {"state": QUITTING}}
            self.inbox.call("/crowdbot/set_simulation_state", request, lambda response: None, "ros1")
        self.end()

    def _topics(self) -> tuple[list[list[str]], list[list[str]]]:
        return (
            [[one.topic, ros1_kind(one.kind)] for one in self.publications.values()],
            [[one.topic, ros1_kind(one.kind)] for one in self._subscriptions.values()],
        )

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Serve a subscriber or a caller of a service."""
        task = asyncio.current_task()
        assert task is not None
        self._peers.add(task)
        try:
            if len(self._peers) <= MOST_CONNECTIONS:
                await self._serve(reader, writer)
        except asyncio.CancelledError:
            writer.transport.abort()
        except ROS_ERRORS as error:
            if isinstance(error, InputError):
                with contextlib.suppress(OSError):
                    writer.write(pack_header({"error": str(error)}))
        finally:
            self._peers.discard(task)
            writer.close()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        fields = await read_header(reader)
        if "service" in fields:
            await self._services.serve(fields, reader, writer)
            return
        found = self.publications.get(fields.get("topic", ""))
        if found is None:
            raise InputError(f"{fields.get('topic', '')[:80]!r} is not published here")
        sending = asyncio.ensure_future(found.serve(fields, writer, NODE))
        gone = asyncio.ensure_future(_wait_for_end(reader))
        try:
            done, _ = await asyncio.wait({sending, gone}, return_when=asyncio.FIRST_COMPLETED)
            if sending in done:
                sending.result()
        finally:
            for one in (sending, gone):
                one.cancel()
            await asyncio.gather(sending, gone, return_exceptions=True)


async def _wait_for_end(reader: asyncio.StreamReader) -> None:
    """Wait until a subscriber, which sends nothing more, closes the connection."""
    with contextlib.suppress(OSError):
        while await reader.read(1024):
            pass


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
