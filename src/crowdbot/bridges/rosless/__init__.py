"""rosless: topics of ROS 2 without a ROS installation, experimental."""

from .node import RoslessNode

__all__ = ["RoslessNode"]
