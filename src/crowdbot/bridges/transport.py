"""Transport: the contract of everything that carries a robot port to other programs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from crowdbot.recording import StepMessage

from .inbox import Inbox
from .interface import RobotInterface


class Transport(Protocol):
    """Carries the topics and services of a port over one kind of connection.

    Every method is called in the thread of the simulation. A transport with threads of its own gives what it receives
    to the inbox, which all threads can use. Nothing may block: a slow or dead peer loses old messages.

    Attributes:
        name: short name, such as ``rosbridge``; it is the ``source`` of the orders.
    """

    name: str

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Open the connection and announce the topics and services.

        It is called again for another trial, without :meth:`stop` in between; clients then stay connected.

        Raises:
            InputError: the connection cannot be opened, with the reason.
        """

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Send the messages of a step. Those of latched topics must also reach later subscribers."""

    def poll(self) -> None:
        """Give to the inbox what has arrived; called at least every 20 ms. Without own threads only."""

    def report(self, level: str, text: str) -> None:
        """Tell the other programs about a problem; the level is ``info``, ``warning`` or ``error``."""

    def wants(self, topic: str) -> bool:
        """Return whether anybody receives a topic; others are not converted.

        A topic that ends in ``/`` stands for all topics that start with it, with or without the slash.
        """

    def stop(self) -> None:
        """Close the connection; called once."""


@runtime_checkable
class RemarkSource(Protocol):
    """A transport that has something to tell people after a run."""

    def remark(self) -> str:
        """Return a line, empty for none; called after :meth:`Transport.stop`."""
