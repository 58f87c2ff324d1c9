"""ROS 1: a node without a ROS installation that carries a robot port to a rosmaster."""

from .node import Ros1Node

__all__ = ["Ros1Node"]
