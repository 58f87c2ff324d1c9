"""Ros1Subscription: a topic that a ROS 1 node receives, with a connection to each of its publishers."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Sequence
from urllib.parse import urlsplit

from crowdbot.bridges.fields import fields_of
from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import InputTopic
from crowdbot.core import InputError
from crowdbot.messages import Ros1Messages

from .master import Master
from .publication import ANY, ros1_kind
from .tcpros import ROS_ERRORS, pack_header, read_frame, read_header

FIRST, LONGEST = 0.2, 2.0
"""Real time [s] before the first and between later attempts to connect to a publisher again."""


class Ros1Subscription:
    """A topic that is received. Publishers may send any of its types; the header of each says which.

    Args:
        topic: the input topic.
        codec: types of ROS 1.
        inbox: receives the messages.
        report: called with the level and text of a problem.
    """

    def __init__(
        self, topic: InputTopic, codec: Ros1Messages, inbox: Inbox, report: Callable[[str, str], None]
    ) -> None:
        self.topic, self.kind = topic.name, topic.kinds[0]
        self._kinds = {ros1_kind(kind): kind for kind in topic.kinds}
        self._codec, self._inbox, self._report = codec, inbox, report
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
        for one in tasks:
            one.cancel()
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
            self._inbox.receive(self.topic, fields_of(message), "ros1")
        except InputError as error:
            self._report("error", str(error))
        except Exception as error:  # rosbags raises many kinds of errors for bytes of another type
            self._report("error", f"a message on {self.topic} is no {ros1_kind(kind)}: {error}")
