"""Navigators: who steers a robot. Contract :class:`Navigator`; what it knows is an :class:`Observation`."""

from .navigator import Limits, Navigator, Observation, People
from .orca import ORCA
from .straight import Straight

__all__ = ["ORCA", "Limits", "Navigator", "Observation", "People", "Straight"]
