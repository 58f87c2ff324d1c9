"""ClientListener: what clients of the Foxglove server ask. The SDK calls it in threads of its own."""

from __future__ import annotations

import re
import threading
from typing import Any, Protocol

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.run_control import PAUSED, PLAYING
from crowdbot.core import InputError

from .decoding import decode_fields

STATE, RESET, STEPS = (f"/crowdbot/{name}" for name in ("set_simulation_state", "reset_simulation", "step_simulation"))
MOST_CHANNELS = 256
"""Largest number of channels that a client may advertise."""


class ServerPart(Protocol):
    """What a listener needs of its server."""

    name: str
    now: int

    def allows(self, name: str) -> bool:
        """Return whether clients may use a topic or service."""

    def report(self, level: str, text: str) -> None:
        """Send a status message to all clients."""

    def note_subscription(self, topic: str, change: int) -> None:
        """Count a subscription (1) or its end (-1)."""


class ClientListener:
    """Takes subscriptions, messages and playback requests of clients.

    Args:
        server: the server.
        inbox: receives commands and calls.
        websocket: module of the SDK.
    """

    def __init__(self, server: ServerPart, inbox: Inbox, websocket: Any) -> None:
        self.server, self.inbox, self.websocket = server, inbox, websocket
        self._channels: dict[tuple[int, int], tuple[str, str, str]] = {}
        self._speed = 1.0
        self._lock = threading.Lock()

    @property
    def has_channels(self) -> bool:
        """Whether a client can send messages."""
        with self._lock:
            return bool(self._channels)

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
        """Pause, play, set the speed, or go to a time: later by hurrying, 0 by a new beginning, earlier not at all."""
        playing = request.playback_command == self.websocket.PlaybackCommand.Play
        sought, wanted = False, {"state": {"state": PLAYING if playing else PAUSED}}
        try:
            if not self.server.allows(STATE):
                raise InputError(f"{STATE!r} is not among the services that clients may use")
            self.inbox.call(STATE, wanted, _ignore, self.server.name)
            if request.playback_speed != self._speed:  # the app sends the speed that it shows with every request
                self.inbox.asked_pace.set_rate(request.playback_speed)
                self._speed = request.playback_speed
            if request.seek_time is not None:
                self._seek(request.seek_time, playing)
                sought = True
        except InputError as error:
            self.server.report("error", str(error))
        status = self.websocket.PlaybackStatus.Playing if playing else self.websocket.PlaybackStatus.Paused
        return self.websocket.PlaybackState(
            status=status, current_time=request.seek_time if sought else self.server.now, playback_speed=self._speed,
            did_seek=sought, request_id=request.request_id,
        )  # fmt: skip

    def _seek(self, nanoseconds: int, playing: bool) -> None:
        """Go to a time.

        Raises:
            InputError: the run cannot go there.
        """
        now, step = self.server.now, round(self.inbox.interface.trial.step * 1e9)
        if nanoseconds < step <= now:
            self.inbox.call(RESET, {}, _ignore, self.server.name)
        elif playing or nanoseconds < now:
            self.inbox.asked_pace.hurry_to(nanoseconds, now)
        elif steps := (nanoseconds - now) // step:
            self.inbox.call(STEPS, {"steps": steps}, _ignore, self.server.name)


def _ignore(response: object) -> None:
    """Take a response that nobody waits for."""
