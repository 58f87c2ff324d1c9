"""Navigators steer a robot. Contract: :class:`Navigator`; input: :class:`Observation`; output: :class:`Action`."""

from .action import Action
from .contract import check_navigator
from .dynamic_window import WindowCosts, dynamic_window_twist
from .navigator import Navigator
from .observation import DriveLimits, Observation, VisiblePeople
from .orca import ORCANavigator
from .straight import Straight

__all__ = [
    "Action",
    "DriveLimits",
    "Navigator",
    "ORCANavigator",
    "Observation",
    "Straight",
    "VisiblePeople",
    "WindowCosts",
    "check_navigator",
    "dynamic_window_twist",
]
