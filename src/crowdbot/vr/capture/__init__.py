"""Motion capture in virtual reality: suits that participants wear with the headset, and systems that see robots."""

from .captures_desk import CapturesDesk, link_captures
from .stream_tap import StreamTap
from .suit import Suit

__all__ = ["CapturesDesk", "StreamTap", "Suit", "link_captures"]
