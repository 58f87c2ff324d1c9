"""ClientListener: what clients of the Foxglove server ask. The SDK calls it in threads of its own."""

from __future__ import annotations

import re
import threading
from typing import TYPE_CHECKING, Any

from foxglove import websocket

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.run_control import PAUSED, PLAYING
from crowdbot.core import InputError

from .server import MOST_CHANNELS, decode_fields

if TYPE_CHECKING:
    from .server import FoxgloveServer

__all__ = ["ClientListener"]

STATE = "/crowdbot/set_simulation_state"


class ClientListener(websocket.ServerListener):
    """Takes subscriptions, messages and playback requests of clients.

    Args:
        server: the server.
        inbox: receives commands and calls.
    """

    def __init__(self, server: FoxgloveServer, inbox: Inbox) -> None:
        self.server, self.inbox = server, inbox
        self._channels: dict[tuple[int, int], tuple[str, str, str]] = {}
        self._lock = threading.Lock()

    def on_subscribe(self, client: Any, channel: Any) -> None:
        """Count a subscription."""
        self.server.note_subscription(channel.topic, 1)

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        """Count the end of a subscription."""
        self.server.note_subscription(channel.topic, -1)

    def on_client_advertise(self, client: Any, channel: Any) -> None:
        """Note the topic and encoding of a channel of a client."""
        kind = re.sub(r"^(\w+)/(\w+)$", r"\1/msg/\2", channel.schema_name)
        with self._lock:
            if sum(one == client.id for one, _ in self._channels) < MOST_CHANNELS:
                self._channels[client.id, channel.id] = (channel.topic, channel.encoding, kind)

    def on_client_unadvertise(self, client: Any, client_channel_id: int) -> None:
        """Forget a channel of a client."""
        with self._lock:
            self._channels.pop((client.id, client_channel_id), None)

    def on_message_data(self, client: Any, client_channel_id: int, data: bytes) -> None:
        """Give a message to the inbox; what is wrong with it is told to the clients."""
        with self._lock:
            known = self._channels.get((client.id, client_channel_id))
        if known is None:
            return
        topic, encoding, kind = known
        try:
            if not self.server.allows(topic):
                raise InputError(f"{topic!r} is not among the topics that clients may use")
            self.inbox.receive(topic, decode_fields(data, encoding, kind), self.server.name)
        except InputError as error:
            self.server.report("error", str(error))

    def on_playback_control_request(self, request: Any) -> Any:
        """Pause or play; the time cannot be set, and the speed is that of the run."""
        wanted = PLAYING if request.playback_command == websocket.PlaybackCommand.Play else PAUSED
        try:
            if not self.server.allows(STATE):
                raise InputError(f"{STATE!r} is not among the services that clients may use")
            self.inbox.call(STATE, {"state": {"state": wanted}}, lambda response: None, self.server.name)
        except InputError as error:
            self.server.report("error", str(error))
        status = websocket.PlaybackStatus.Playing if wanted == PLAYING else websocket.PlaybackStatus.Paused
        return websocket.PlaybackState(
            status=status, current_time=self.server.now, playback_speed=1.0, did_seek=False,
            request_id=request.request_id,
        )  # fmt: skip
