"""Connections of a ROS 1 node: master, slave API, topics and services over TCPROS.

Every frame is its length in 4 bytes, little endian, and its bytes. The first frame of each side is its header: fields
``name=value``, each as a frame. Source: wiki.ros.org/ROS/TCPROS.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import os
import struct
import xmlrpc.client
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any, cast
from urllib.parse import urlsplit

import aiohttp
from aiohttp import web

from crowdbot.bridges.fields import fields_of
from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import STATE, InputTopic, OutputTopic, RobotInterface
from crowdbot.bridges.simulation_interfaces import STATE_QUITTING
from crowdbot.bridges.simulation_services import PLAIN_SERVICES, PlainService
from crowdbot.core import InputError, close_listener, is_loopback
from crowdbot.messages import Messages, Ros1Messages

from .actions import STATUS_PERIOD, ActionServer

DEFAULT = "http://localhost:11311"
MASTER_ANSWER_TIME = 5.0
"""Longest real time [s] of a call."""
XML = {"Content-Type": "text/xml"}


def master_address(text: str) -> str:
    """Return the address of the master: a text, or ``ROS_MASTER_URI`` of the environment, or the default.

    Raises:
        InputError: it is no address.

    >>> master_address("http://10.0.0.2:11311/")
    'http://10.0.0.2:11311'
    """
    address = (text or os.environ.get("ROS_MASTER_URI") or DEFAULT).rstrip("/")
    try:
        parts = urlsplit(address)
        good = parts.scheme == "http" and bool(parts.hostname) and bool(parts.port)
    except ValueError:
        good = False
    if not good:
        raise InputError(f"ros1:{address[:60]} must be ros1 or ros1:http://HOST:PORT, such as ros1:{DEFAULT}")
    return address


class Master:
    """Calls of one node to a master.

    Args:
        address: address of the master, ``http://HOST:PORT``.
        node: name of the node.
        http: session of the HTTP client.
    """

    def __init__(self, address: str, node: str, http: aiohttp.ClientSession) -> None:
        self.address, self.node = address, node
        self._http = http

    async def call(self, method: str, *values: Any, to: str = "") -> Any:
        """Return the value of a call to the master, or to another node.

        Raises:
            InputError: there is no master, or it refuses the call.
        """
        address = to or self.address
        body = xmlrpc.client.dumps((self.node, *values), method)
        limit = aiohttp.ClientTimeout(total=MASTER_ANSWER_TIME)
        try:
            async with self._http.post(address, data=body.encode(), headers=XML, timeout=limit) as response:
                answer: Any = xmlrpc.client.loads(await response.read())[0]
            code, text, value = answer[0]
        except (aiohttp.ClientError, OSError, TimeoutError) as error:
            raise InputError(f"{address} does not answer: {error or type(error).__name__}") from None
        except Exception as error:  # the parser raises many kinds of errors
            raise InputError(f"{address} does not answer as ROS 1 does: {error}") from None
        if code != 1:
            raise InputError(f"{method}: {text}")
        return value

    async def knows(self, api: str) -> bool:
        """Return whether the master knows this node at its address; a master that was started anew does not.

        Raises:
            InputError: there is no master.
        """
        try:
            return str(await self.call("lookupNode", self.node)) == api
        except InputError as error:
            if "does not answer" in str(error):
                raise
            return False

    async def gather(self, *calls: tuple[Any, ...]) -> list[Any]:
        """Return the values of several calls, in their order."""
        return list(await asyncio.gather(*(self.call(*call) for call in calls)))


MOST_BODY = 1 << 20
ENDING = 0.2
"""Longest real time [s] for open connections at the end."""
Answer = tuple[int, str, Any]


class SlaveApi:
    """Answers the calls of the slave API: which topics a node has, and where it sends a topic.

    Args:
        master: address of the master.
        topic_address: returns the host and port of TCPROS of a topic that the node sends, None if it does not.
        found: called with the topic and addresses of its publishers.
        ended: called when the master or ``rosnode kill`` ends the node, with the reason.
        topics: returns the published and the subscribed topics, as rows of name and type.
    """

    def __init__(
        self,
        master: str,
        topic_address: Callable[[str], tuple[str, int] | None],
        found: Callable[[str, Sequence[str]], None],
        ended: Callable[[str], None],
        topics: Callable[[], tuple[list[list[str]], list[list[str]]]],
    ) -> None:
        self.master, self.topic_address, self.found, self.ended, self.topics = (
            master,
            topic_address,
            found,
            ended,
            topics,
        )
        self.port = 0
        self._runner: web.AppRunner | None = None
        self._listener: asyncio.Server | None = None

    async def open(self, host: str) -> None:
        """Listen on a free port, see :attr:`port`."""
        app = web.Application(client_max_size=MOST_BODY)
        app.router.add_post("/{path:.*}", self._serve)
        self._runner = web.AppRunner(app, access_log=None, shutdown_timeout=ENDING)
        await self._runner.setup()
        server = cast("web.Server", self._runner.server)
        self._listener = await asyncio.get_running_loop().create_server(server, host, 0)
        self.port = int(self._listener.sockets[0].getsockname()[1])

    async def close(self) -> None:
        """Stop listening."""
        if self._listener is not None:
            await close_listener(self._listener)
        if self._runner is not None:
            await self._runner.cleanup()

    async def _serve(self, request: web.Request) -> web.Response:
        if "Origin" in request.headers:  # only browsers send it; a page may post text to any port
            return web.Response(status=403, text="pages in a browser may not call a node")
        try:
            values, method = xmlrpc.client.loads(await request.read())
            answer = self.answer(str(method), values)
        except Exception as error:  # whatever another program sends gets an answer
            answer = (-1, f"{type(error).__name__}: {error}"[:200], 0)
        body = xmlrpc.client.dumps((answer,), methodresponse=True, allow_none=True)
        return web.Response(body=body.encode(), content_type="text/xml")

    def answer(self, method: str, values: Sequence[Any]) -> Answer:
        """Return code, status and value of a call; the first value is the name of the caller."""
        sent, received = self.topics()
        plain: dict[str, Any] = {
            "getPid": os.getpid(),
            "getMasterUri": self.master,
            "getPublications": sent,
            "getSubscriptions": received,
            "getBusStats": [[], [], [0, 0, 0]],
            "getBusInfo": [],
            "paramUpdate": 0,
        }
        if method in plain:
            return 1, "", plain[method]
        if method == "publisherUpdate":
            self.found(str(values[1]), [str(item) for item in values[2]])
            return 1, "", 0
        if method == "requestTopic":
            return self._request_topic(str(values[1]), values[2])
        if method == "shutdown":
            self.ended(str(values[1]) if len(values) > 1 else "")
            return 1, "", 0
        return -1, f"there is no method {method[:40]!r}", 0

    def _request_topic(self, topic: str, protocols: Any) -> Answer:
        if not any(protocol and protocol[0] == "TCPROS" for protocol in protocols):
            return 0, "only TCPROS is supported", 0
        place = self.topic_address(topic)
        if place is None:
            return 0, f"{topic[:80]} is not published here", 0
        return 1, "ready", ["TCPROS", *place]


SIZE = struct.Struct("<I")
MOST_HEADER, MOST_BYTES = 1 << 16, 1 << 22
"""Largest header, and largest message that is received [bytes]."""
GREETING = 5.0
"""Longest real time [s] until the other side has sent its header."""
ROS_ERRORS = (InputError, OSError, EOFError, TimeoutError)
"""Errors of a connection that ends: a wrong frame, a broken connection, its end, and silence."""


def pack_frame(data: bytes) -> bytes:
    """Return a frame.

    >>> pack_frame(b"ab")
    b'\\x02\\x00\\x00\\x00ab'
    """
    return SIZE.pack(len(data)) + data


def pack_header(fields: Mapping[str, str]) -> bytes:
    """Return the frame of a connection header.

    >>> pack_header({"a": "b"})
    b'\\x07\\x00\\x00\\x00\\x03\\x00\\x00\\x00a=b'
    """
    return pack_frame(b"".join(pack_frame(f"{name}={value}".encode()) for name, value in fields.items()))


def unpack_header(data: bytes) -> dict[str, str]:
    """Return the fields of a connection header.

    Raises:
        InputError: the bytes are no header.

    >>> unpack_header(pack_header({"topic": "/scan"})[4:])
    {'topic': '/scan'}
    """
    fields, at = {}, 0
    while at < len(data):
        if at + SIZE.size > len(data):
            raise InputError("a TCPROS header ends within a field")
        (size,) = SIZE.unpack_from(data, at)
        at += SIZE.size
        name, sign, value = data[at : at + size].decode(errors="replace").partition("=")
        if at + size > len(data) or not sign:
            raise InputError("a field of a TCPROS header must be name=value")
        fields[name] = value
        at += size
    return fields


async def read_frame(reader: asyncio.StreamReader, most: int = MOST_BYTES) -> bytes:
    """Return the bytes of the next frame.

    Raises:
        InputError: the frame is too long.
        EOFError: the other side has closed the connection.
    """
    (size,) = SIZE.unpack(await reader.readexactly(SIZE.size))
    if size > most:
        raise InputError(f"a TCPROS frame has {size} bytes; at most {most} are allowed")
    return await reader.readexactly(size)


async def read_header(reader: asyncio.StreamReader) -> dict[str, str]:
    """Return the connection header of the other side.

    Raises:
        InputError: it sends no header.
        EOFError, TimeoutError: it sends nothing.
    """
    return unpack_header(await asyncio.wait_for(read_frame(reader, MOST_HEADER), GREETING))


ANY = "*"
"""Type and checksum of a subscriber that takes everything, such as ``rosbag record`` and ``rostopic hz``."""
FULL = 1 << 18
"""Bytes in the buffer of a connection above which messages wait in the queue, where old ones are dropped."""


def ros1_kind(kind: str) -> str:
    """Return the name of a type in ROS 1.

    >>> ros1_kind("sensor_msgs/msg/LaserScan")
    'sensor_msgs/LaserScan'
    """
    return kind.replace("/msg/", "/").replace("/srv/", "/")


class Publication:
    """A topic that is sent.

    Args:
        output: the topic.
        codec: types of ROS 1.
    """

    def __init__(self, output: OutputTopic, codec: Ros1Messages) -> None:
        self.topic, self.kind, self.quality = output.name, output.kind, output.quality
        self.checksum, self.definition = codec.checksum(output.kind), codec.definition(output.kind)
        self.latest: bytes | None = None
        """Latest frame, of a latched topic."""
        self.count = 0
        """Number of subscribers."""
        self._queues: dict[asyncio.StreamWriter, tuple[deque[bytes], asyncio.Event]] = {}

    def deliver(self, frame: bytes) -> None:
        """Queue a frame for all subscribers; the oldest of a slow one is dropped."""
        if self.quality.latched:
            self.latest = frame
        for queue, news in self._queues.values():
            queue.append(frame)
            news.set()

    async def serve(self, fields: dict[str, str], writer: asyncio.StreamWriter, node: str) -> None:
        """Send messages to a subscriber until the task is cancelled or the connection breaks.

        Raises:
            InputError: the subscriber wants another type.
        """
        wanted = (fields.get("type", ANY), fields.get("md5sum", ""))
        own = (ros1_kind(self.kind), self.checksum)
        if any(given not in (ANY, mine) for given, mine in zip(wanted, own, strict=True)):
            raise InputError(f"{self.topic} is {' '.join(own)}, not {' '.join(wanted)[:120]}")
        header = {"callerid": node, "topic": self.topic, "type": own[0], "md5sum": self.checksum}
        header |= {"message_definition": self.definition, "latching": str(int(self.quality.latched))}
        writer.transport.set_write_buffer_limits(high=FULL)
        writer.write(pack_header(header))
        queue, news = deque[bytes](maxlen=self.quality.depth), asyncio.Event()
        if self.latest is not None:
            queue.append(self.latest)
            news.set()
        self._queues[writer] = queue, news
        self.count = len(self._queues)
        try:
            while True:
                await news.wait()
                news.clear()
                while queue:
                    writer.write(queue.popleft())
                    await writer.drain()
        finally:
            self._queues.pop(writer, None)
            self.count = len(self._queues)


FIRST, LONGEST = 0.2, 2.0
"""Real time [s] before the first and between later attempts to connect to a publisher again."""


class Ros1Subscription:
    """A topic that is received. Publishers may send any of its types; the header of each says which.

    Args:
        topic: the input topic.
        codec: types of ROS 1.
        receive: takes the topic, fields and sender of a message, as :meth:`Inbox.receive`.
        report: called with the level and text of a problem.
    """

    def __init__(
        self,
        topic: InputTopic,
        codec: Ros1Messages,
        receive: Callable[[str, Mapping[str, Any], str], None],
        report: Callable[[str, str], None],
    ) -> None:
        self.topic, self.kind = topic.name, topic.kinds[0]
        self._kinds = {ros1_kind(kind): kind for kind in topic.kinds}
        self._codec, self._receive_fields, self._report = codec, receive, report
        self._tasks: dict[str, asyncio.Task[None]] = {}

    def connect(self, publishers: Sequence[str], master: Master) -> None:
        """Connect to the nodes that publish the topic now, and leave others."""
        for api in set(self._tasks) - set(publishers):
            self._tasks.pop(api).cancel()
        for api in publishers:
            if api not in self._tasks or self._tasks[api].done():
                self._tasks[api] = asyncio.get_running_loop().create_task(self._follow(api, master))

    async def close(self) -> None:
        """Leave all publishers."""
        tasks = list(self._tasks.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _follow(self, api: str, master: Master) -> None:
        """Receive from a publisher; connect again as long as the master names it."""
        wait, told = FIRST, ""
        while True:
            try:
                await self._receive(api, master)
                wait = FIRST
            except ROS_ERRORS as error:
                if isinstance(error, InputError) and "does not answer" not in str(error) and str(error) != told:
                    told = str(error)
                    self._report("error", told)
            await asyncio.sleep(wait)
            wait = min(LONGEST, 2.0 * wait)

    async def _receive(self, api: str, master: Master) -> None:
        """Receive until the publisher closes the connection."""
        place = await master.call("requestTopic", self.topic, [["TCPROS"]], to=api)
        if not isinstance(place, list) or len(place) != 3:
            raise InputError(f"{api} does not send {self.topic} by TCPROS")
        host, port = str(place[1]) or urlsplit(api).hostname, int(place[2])
        reader, writer = await asyncio.open_connection(host, port)
        try:
            asked = {"callerid": master.node, "topic": self.topic, "type": ANY, "md5sum": ANY, "tcp_nodelay": "1"}
            writer.write(pack_header(asked))
            kind = self._kind(await read_header(reader))
            while True:
                self._take(await read_frame(reader), kind)
        except asyncio.IncompleteReadError:
            return
        finally:
            writer.close()
            with contextlib.suppress(OSError):
                await writer.wait_closed()

    def _kind(self, header: dict[str, str]) -> str:
        """Return the type that a publisher sends.

        Raises:
            InputError: it is none of the types of the topic.
        """
        if "error" in header:
            raise InputError(f"{self.topic}: {header['error'][:200]}")
        sent = header.get("type", "")
        kind = self._kinds.get(sent)
        if kind is None:
            names = " or ".join(self._kinds)
            raise InputError(f"{self.topic}: {header.get('callerid', 'a node')[:80]} sends {sent[:80]}, not {names}")
        if header.get("md5sum") not in (ANY, self._codec.checksum(kind)):
            raise InputError(f"{self.topic}: {header.get('callerid', 'a node')[:80]} has another version of {sent}")
        return kind

    def _take(self, data: bytes, kind: str) -> None:
        """Give a message to the inbox."""
        try:
            message = self._codec.message(data, kind)
            self._receive_fields(self.topic, fields_of(message), "ros1")
        except InputError as error:
            self._report("error", str(error))
        except Exception as error:  # rosbags raises many kinds of errors for bytes of another type
            self._report("error", f"a message on {self.topic} is no {ros1_kind(kind)}: {error}")


SERVICE_ANSWER_TIME = 60.0
"""Longest real time [s] that a call waits for the simulation."""
DEFINITIONS = {"Empty": "", "Trigger": "bool success\nstring message"}
"""Fields of the responses; the requests have none."""


def service_checksum(kind: str) -> str:
    """Return the md5 sum of a service type of ``std_srvs``.

    >>> service_checksum("Trigger")
    '937c9679a518e3a18d831e57125ea522'
    """
    return hashlib.md5(DEFINITIONS[kind].encode(), usedforsecurity=False).hexdigest()


class ServicePort:
    """Answers calls of :data:`PLAIN_SERVICES`.

    Args:
        inbox: receives the calls.
        node: name of the node.
    """

    def __init__(self, inbox: Inbox, node: str) -> None:
        self.inbox, self.node = inbox, node

    async def serve(self, fields: dict[str, str], reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Answer one call, or all calls of a persistent connection.

        Raises:
            InputError: there is no such service, or the caller has another type.
        """
        service = PLAIN_SERVICES.get(fields["service"])
        if service is None:
            raise InputError(f"there is no service {fields['service'][:80]!r}")
        checksum = service_checksum(service.kind)
        if fields.get("md5sum", "") not in (ANY, checksum):
            raise InputError(f"{fields['service']} is std_srvs/{service.kind}")
        kind = f"std_srvs/{service.kind}"
        header = {"callerid": self.node, "md5sum": checksum, "type": kind, "service": fields["service"]}
        header |= {"request_type": f"{kind}Request", "response_type": f"{kind}Response"}
        writer.write(pack_header(header))
        await writer.drain()
        persistent = fields.get("persistent") == "1"
        while fields.get("probe") != "1":
            await read_frame(reader)
            writer.write(response_frame(service, await self._ask(service)))
            await writer.drain()
            if not persistent:
                return

    async def _ask(self, service: PlainService) -> str:
        """Return the problem of a call, an empty text if it was done."""
        loop = asyncio.get_running_loop()
        done: asyncio.Future[str] = loop.create_future()

        def settle(problem: str) -> None:
            if not done.done():
                done.set_result(problem)

        def answer(problem: str) -> None:
            loop.call_soon_threadsafe(settle, problem)

        try:
            service.call(self.inbox, answer, "ros1")
            return await asyncio.wait_for(done, SERVICE_ANSWER_TIME)
        except InputError as error:
            return str(error)
        except TimeoutError:
            return "the simulation does not answer"


def response_frame(service: PlainService, problem: str) -> bytes:
    """Return the answer to a call: a byte, 0 for a failure, and a frame with the response or the problem.

    >>> response_frame(PLAIN_SERVICES["/crowdbot/pause"], "")
    b'\\x01\\x00\\x00\\x00\\x00'
    """
    text = problem.encode()
    if service.kind == "Trigger":
        return b"\x01" + pack_frame(struct.pack("<B", not problem) + pack_frame(text))
    return b"\0" + pack_frame(text) if problem else b"\x01" + pack_frame(b"")


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
        if all(input_topic.name != "/clock" for input_topic in self.interface.inputs):
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
        self._actions: dict[str, ActionServer] = {}
        self._telling: asyncio.Task[None] | None = None
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
        listen = self.host if is_loopback(self.host) else "0.0.0.0"  # noqa: S104, ROS 1 nodes connect to each other
        await self._api.open(listen)
        self._server = await asyncio.start_server(self._accept, listen, 0)
        self._port = int(self._server.sockets[0].getsockname()[1])
        self._choose_topics()
        await self._register()
        self._telling = asyncio.create_task(self._tell_states())

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
        for subscription in self._subscriptions.values():
            await subscription.close()
        if self._telling is not None:
            self._telling.cancel()
        if self._server is not None:
            await close_listener(self._server)
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
        loop = asyncio.get_running_loop()
        self._actions = {
            action.name: self._actions.get(action.name)
            or ActionServer(action, self.inbox, self.codec, self._send, loop.call_soon_threadsafe)
            for action in self.interface.actions
        }
        servers = self._actions.values()
        outputs = {item.name: item for item in (*self.interface.outputs, LOG)}
        outputs |= {item.name: item for server in servers for item in server.outputs}
        kept = {name: publication for name, publication in self.publications.items() if name in outputs}
        kept = {name: item for name, item in kept.items() if item.kind == outputs[name].kind}
        self.publications = {
            name: kept.get(name) or Publication(output, self.codec) for name, output in outputs.items()
        }
        receivers = [(item, self.inbox.receive) for item in self.interface.inputs]
        for item, receive in receivers + [(item, server.receive) for server in servers for item in server.inputs]:
            if item.name not in self._subscriptions:
                self._subscriptions[item.name] = Ros1Subscription(item, self.codec, receive, self.log)

    def _send(self, topic: str, data: bytes) -> None:
        if topic in self.publications:
            self.publications[topic].deliver(pack_frame(data))

    async def _tell_states(self) -> None:
        while True:
            for server in list(self._actions.values()):
                server.tell_states()
            await asyncio.sleep(STATUS_PERIOD)

    async def _register(self) -> None:
        """Tell the master all topics and services; what it knows already stays as it is."""
        master, url = self._master, self.url
        wanted = {input_topic.name for input_topic in self.interface.inputs}
        wanted |= {item.name for server in self._actions.values() for item in server.inputs}
        for name in set(self._subscriptions) - wanted:
            gone = self._subscriptions.pop(name)
            await gone.close()
            await master.call("unregisterSubscriber", name, url)
        sent = [
            ("registerPublisher", publication.topic, ros1_kind(publication.kind), url)
            for publication in self.publications.values()
        ]
        await master.gather(*sent)
        await self._drop_publications()
        heard = list(self._subscriptions.values())
        found = await master.gather(*(("registerSubscriber", item.topic, ros1_kind(item.kind), url) for item in heard))
        for one, publishers in zip(heard, found, strict=True):
            one.connect(publishers, master)
        address = f"rosrpc://{self.host}:{self._port}"
        await master.gather(*(("registerService", name, address, url) for name in PLAIN_SERVICES))
        await self._parameters.set()

    async def _drop_publications(self) -> None:
        """Unregister topics that are no longer sent."""
        state = await self._master.call("getSystemState")
        known = [topic for topic, nodes in state[0] if NODE in nodes]
        gone = [("unregisterPublisher", item, self.url) for item in known if item not in self.publications]
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
            request = {"state": {"state": STATE_QUITTING}}
            self.inbox.call("/crowdbot/set_simulation_state", request, lambda response: None, "ros1")
        self.end()

    def _topics(self) -> tuple[list[list[str]], list[list[str]]]:
        return (
            [[publication.topic, ros1_kind(publication.kind)] for publication in self.publications.values()],
            [[subscription.topic, ros1_kind(subscription.kind)] for subscription in self._subscriptions.values()],
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
            for item in (sending, gone):
                item.cancel()
            await asyncio.gather(sending, gone, return_exceptions=True)


async def _wait_for_end(reader: asyncio.StreamReader) -> None:
    """Wait until a subscriber, which sends nothing more, closes the connection."""
    with contextlib.suppress(OSError):
        while await reader.read(1024):
            pass
