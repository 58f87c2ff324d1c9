"""Master: the XML-RPC calls of a node to the master of ROS 1, its name server and parameter server."""

from __future__ import annotations

import asyncio
import os
import xmlrpc.client
from typing import Any
from urllib.parse import urlsplit

import aiohttp

from crowdbot.core import InputError

DEFAULT = "http://localhost:11311"
ANSWER_TIME = 5.0
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
        limit = aiohttp.ClientTimeout(total=ANSWER_TIME)
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
        return list(await asyncio.gather(*(self.call(*one) for one in calls)))
