"""Peer: what the graph and the calls of one client know of another client."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from .encoding import OutgoingMessage


class PeerCalls(Protocol):
    """Calls of a client."""

    def hand(self, caller: Peer, asked: Mapping[str, Any], sent: Mapping[str, Any]) -> None:
        """Give the client a call of another one.

        Raises:
            InputError: too many calls wait for it.
        """

    def cancel(self, caller: Peer, name: str, action: str) -> bool:
        """Tell the client that a goal is cancelled; return whether it has the goal."""

    def fail(self, frame: Mapping[str, Any], text: str) -> None:
        """Answer a call of this client with an error."""

    def forget(self, caller: Peer) -> None:
        """Drop the calls of a client that has gone."""


class Peer(Protocol):
    """A client of a server."""

    @property
    def subscriptions(self) -> Mapping[str, Any]:
        """Subscriptions by topic."""

    @property
    def calls(self) -> PeerCalls:
        """Its calls."""

    def offer(self, message: OutgoingMessage) -> None:
        """Let a message wait if the client subscribes its topic."""

    def reply(self, frame: Mapping[str, Any], fragment_size: int | None = None, compression: str = "none") -> None:
        """Send a frame."""
