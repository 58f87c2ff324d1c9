"""ServicePort: the services of a ROS 1 node, with types of ``std_srvs``."""

from __future__ import annotations

import asyncio
import hashlib
import struct

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.plain_services import PLAIN_SERVICES, PlainService
from crowdbot.core import InputError

from .publication import ANY
from .tcpros import pack_frame, pack_header, read_frame

ANSWER_TIME = 60.0
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
            return await asyncio.wait_for(done, ANSWER_TIME)
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
