"""ROS 2: a node of rclpy that carries a robot port."""

from .node import Ros2Node

__all__ = ["Ros2Node"]
