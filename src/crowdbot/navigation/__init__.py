"""Navigators steer a robot. Contract: :class:`Navigator`; input: :class:`Observation`; output: :class:`Action`."""

from .action import Action
from .navigator import Navigator
from .observation import Limits, Observation, People
from .orca import ORCA
from .reachable import Caution, reachable
from .straight import Straight

__all__ = ["ORCA", "Action", "Caution", "Limits", "Navigator", "Observation", "People", "Straight", "reachable"]
