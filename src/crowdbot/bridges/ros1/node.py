"""Ros1Node: the transport ``ros1``, a node of ROS 1 without a ROS installation."""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
import threading
from collections.abc import Callable, Sequence
from typing import Any
from urllib.parse import urlsplit

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import RobotInterface
from crowdbot.bridges.transport import is_among
from crowdbot.core import InputError
from crowdbot.messages import Ros1Messages
from crowdbot.recording import StepMessage

from .session import Ros1Session, master_address, pack_frame

STARTUP = 10.0
"""Longest real time [s] of the start and of the end."""


class Ros1Node:
    """A ROS 1 node that publishes the outputs of a trial and takes its commands, with the messages of the recorder.

    It speaks the protocols of ROS 1 itself, so neither rospy nor message packages are needed. It sets ``/use_sim_time``
    and ``/robot_description`` on the parameter server, and restores them at its end. If the master is started anew, the
    node registers again; ``rosnode kill /crowdbot`` ends the run.

    ROS 1 has no password. The node is reachable from this computer only if the master is on this computer and neither
    a host nor ``ROS_IP`` or ``ROS_HOSTNAME`` is set.

    Args:
        master: address of the master (default: ``ROS_MASTER_URI``, or ``http://localhost:11311``).
        host: name or address under which other nodes reach this one.

    Raises:
        InputError: the address is none.

    >>> Ros1Node("http://127.0.0.1:11311").host
    '127.0.0.1'
    """

    name = "ros1"

    def __init__(self, master: str = "", host: str = "") -> None:
        self.master = master_address(master)
        self.host = host or os.environ.get("ROS_IP") or os.environ.get("ROS_HOSTNAME") or own_address(self.master)
        self._codec = Ros1Messages()
        self._session: Ros1Session | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._ready, self._failure = threading.Event(), ""

    @classmethod
    def of(cls, address: str, host: str = "") -> Ros1Node:
        """Return the node of an address on the command line: that of the master, or nothing.

        Raises:
            InputError: the address is none.
        """
        return cls(address, host)

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Register at the master, or change the topics to those of another trial.

        Raises:
            InputError: there is no master.
        """
        if self._thread is not None:
            self._call(lambda session: session.announce(interface))
            return
        self._thread = threading.Thread(target=self._run, args=(interface, inbox), name="ros1", daemon=True)
        self._thread.start()
        if not self._ready.wait(STARTUP) or self._failure:
            self.stop()
            raise InputError(f"ros1 cannot start a node: {self._failure or 'no answer'}")

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Hand the messages of a step to the thread of the node, in the bytes of ROS 1."""
        session = self._session
        if session is None:
            return
        frames = [
            (message.topic, pack_frame(self._codec.of_cdr(message.cdr, message.kind)))
            for message in messages
            if self._takes(message)
        ]
        texts = {
            message.topic: message.message.data for message in messages if message.topic.endswith("/robot_description")
        }
        self._call(lambda session: session.deliver(frames, texts))

    def _takes(self, step_message: StepMessage) -> bool:
        found = self._session and self._session.publications.get(step_message.topic)
        return bool(found) and (found.count > 0 or found.quality.latched)  # type: ignore[union-attr]

    def poll(self) -> None:
        """Do nothing: the thread of the node gives what arrives to the inbox."""

    def report(self, level: str, text: str) -> None:
        """Write a problem to the log of ROS, ``/rosout``."""
        self._call(lambda session: session.log(level, text))

    def wants(self, topic: str) -> bool:
        """Return whether a node subscribes a topic, or with a final slash one that starts with it."""
        found = {} if self._session is None else self._session.publications
        return is_among(topic, [name for name, publication in list(found.items()) if publication.count > 0])

    def stop(self) -> None:
        """Unregister and close all connections."""
        self._call(lambda session: session.end())
        if self._thread is not None:
            self._thread.join(STARTUP)

    def _call(self, act: Callable[[Ros1Session], Any]) -> None:
        """Call a function in the thread of the node."""
        session, loop = self._session, self._loop
        if session is not None and loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop is closed
                loop.call_soon_threadsafe(act, session)

    def _run(self, interface: RobotInterface, inbox: Inbox) -> None:
        try:
            asyncio.run(self._work(interface, inbox))
        except (InputError, OSError) as error:  # told by start()
            self._failure = str(error)
        finally:
            self._ready.set()

    async def _work(self, interface: RobotInterface, inbox: Inbox) -> None:
        self._loop = asyncio.get_running_loop()
        session = Ros1Session(self.master, self.host, interface, inbox, self._codec)
        try:
            await session.open()
            self._session = session
            self._ready.set()
            await session.keep()
        finally:
            await session.close()
            self._session = None


def own_address(master: str) -> str:
    """Return the address of this computer in the network of the master; no packet is sent.

    >>> own_address("http://localhost:11311")
    '127.0.0.1'
    """
    parts = urlsplit(master)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((parts.hostname, parts.port))
        except OSError:
            return "127.0.0.1"
        return str(probe.getsockname()[0])
