"""Motion capture in virtual reality: suits that participants wear with the headset."""

from .stream_tap import StreamTap
from .suit import Suit

__all__ = ["StreamTap", "Suit"]
