"""SlaveApi: the XML-RPC server of a node of ROS 1, which the master and other nodes call."""

from __future__ import annotations

import os
import xmlrpc.client
from collections.abc import Callable, Sequence
from typing import Any

from aiohttp import web

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

    async def open(self, host: str) -> None:
        """Listen on a free port, see :attr:`port`."""
        app = web.Application(client_max_size=MOST_BODY)
        app.router.add_post("/{path:.*}", self._serve)
        self._runner = web.AppRunner(app, access_log=None, shutdown_timeout=ENDING)
        await self._runner.setup()
        await web.TCPSite(self._runner, host, 0).start()
        self.port = int(self._runner.addresses[0][1])

    async def close(self) -> None:
        """Stop listening."""
        if self._runner is not None:
            await self._runner.cleanup()

    async def _serve(self, request: web.Request) -> web.Response:
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
            self.found(str(values[1]), [str(one) for one in values[2]])
            return 1, "", 0
        if method == "requestTopic":
            return self._request_topic(str(values[1]), values[2])
        if method == "shutdown":
            self.ended(str(values[1]) if len(values) > 1 else "")
            return 1, "", 0
        return -1, f"there is no method {method[:40]!r}", 0

    def _request_topic(self, topic: str, protocols: Any) -> Answer:
        if not any(one and one[0] == "TCPROS" for one in protocols):
            return 0, "only TCPROS is supported", 0
        place = self.topic_address(topic)
        if place is None:
            return 0, f"{topic[:80]} is not published here", 0
        return 1, "ready", ["TCPROS", *place]
