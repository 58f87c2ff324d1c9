"""Navigators: who steers a robot. Contract :class:`Navigator`; what it knows is an :class:`Observation`."""

from .navigator import Limits, Navigator, Observation, People
from .orca import ORCA
from .reachable import Caution, reachable
from .straight import Straight

__all__ = ["ORCA", "Caution", "Limits", "Navigator", "Observation", "People", "Straight", "reachable"]
