"""Lines of the log of ROS 1 on ``/rosout``."""

from __future__ import annotations

from crowdbot.messages import Messages, Ros1Messages

from .tcpros import pack_frame

LEVELS = {"info": 2, "warning": 4, "error": 8}
"""Levels of ``rosgraph_msgs/Log``."""


def log_frame(codec: Ros1Messages, node: str, level: str, text: str) -> bytes:
    """Return the frame of ``rosgraph_msgs/Log``.

    >>> len(log_frame(Ros1Messages(), "/crowdbot", "error", "no"))
    56
    """
    types, stamp = codec.store.types, Messages().stamp(0)
    message = types["rosgraph_msgs/msg/Log"](
        header=types["std_msgs/msg/Header"](seq=0, stamp=stamp, frame_id=""),
        level=LEVELS.get(level, 8),
        name=node,
        msg=text,
        file="",
        function="",
        line=0,
        topics=[],
    )
    return pack_frame(codec.encode(message))
