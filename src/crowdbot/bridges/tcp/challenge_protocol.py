"""Texts of the TCP protocol of the CrowdBot challenge (ICRA 2021): requests of clients, and replies.

A request is ``clock=0.1;vel_cmd=1.0 10.0;sim_control=i;``: time [s], speed [m/s] and turn rate [deg/s], and a letter.
It has no other end than the last semicolon. A reply is ``clock=3#0.1;crowd=3#0.1 2 (0 1.0 2.0) (1 ...);...;@``: topic,
number of the reply, and payload. The text ``stop`` ends the simulation.
"""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from crowdbot.core import InputError

LONGEST = 4096
"""Largest size of a request [bytes]."""
NO_PICTURE, QUALITY = "JPG", 80
"""Payload of the camera while there is no picture, and quality of pictures."""
CONTROLS = "inprfls"
"""Letters of ``sim_control``: idle, next, previous, reset, first, last, stop."""


class ChallengeRequest(NamedTuple):
    """A request of a client.

    Fields:
        clock: time up to which the simulation runs [s]; None: none is given.
        commands: speed [m/s] and turn rate [rad/s] by name of the robot; empty: the first robot.
        control: a letter of :data:`CONTROLS`.
    """

    clock: float | None
    commands: Mapping[str, tuple[float, float]]
    control: str


def read_request(text: str) -> ChallengeRequest:
    """Return the request of a text.

    Raises:
        InputError: the text is no request.

    >>> read_request("clock=0.1;vel_cmd=1.0 90.0;sim_control=i;").clock
    0.1
    """
    clock: float | None = None
    commands: dict[str, tuple[float, float]] = {}
    control = "i"
    if text.strip() == "stop":
        return ChallengeRequest(None, {}, "s")
    for part in text.split(";"):
        key, sign, value = part.strip().partition("=")
        if not key and not value:
            continue
        if not sign:
            raise InputError(f"{part[:40]!r} must be key=value")
        if key == "clock":
            clock = _numbers(key, value, 1)[0]
        elif key == "vel_cmd" or key.startswith("vel_cmd_"):
            speed, turn = _numbers(key, value, 2)
            commands[key.removeprefix("vel_cmd").removeprefix("_")] = (speed, math.radians(turn))
        elif key == "sim_control":
            control = value.strip()
            if len(control) != 1 or control not in CONTROLS:
                raise InputError(f"sim_control={value[:20]!r} must be one of {', '.join(CONTROLS)}")
        else:
            raise InputError(f"there is no key {key[:40]!r}; keys are clock, vel_cmd, vel_cmd_NAME and sim_control")
    if clock is not None and not 0.0 <= clock <= 1e6:
        raise InputError(f"clock={clock:g} must be from 0 to 1e6 s")
    return ChallengeRequest(clock, commands, control)


def _numbers(key: str, value: str, count: int) -> list[float]:
    try:
        found = [float(word) for word in value.split()]
    except ValueError:
        found = []
    if len(found) != count or not all(map(math.isfinite, found)):
        raise InputError(f"{key}={value[:40]!r} must have {count} finite numbers")
    return found


def encode_picture(image: Any) -> str:
    """Return a ``sensor_msgs/Image`` of colours as a JPEG file in base64."""
    from PIL import Image  # slow to import, and needed for robots with cameras only

    size = (int(image.width), int(image.height))
    stream = io.BytesIO()
    Image.frombytes("RGB", size, bytes(image.data)).save(stream, "JPEG", quality=QUALITY)
    return base64.b64encode(stream.getvalue()).decode()


def format_reply(number: int, payloads: Mapping[str, str]) -> bytes:
    """Return a reply.

    >>> format_reply(3, {"clock": "0.1", "report": ""})
    b'clock=3#0.1;report=3#;@'
    """
    return "".join(f"{topic}={number}#{payload};" for topic, payload in payloads.items()).encode() + b"@"
