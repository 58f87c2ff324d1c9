"""Xacro without ROS: a macro language of robot files, expanded by a parser with limits."""

from .expansion import Expansion, expand_xacro, is_xacro
from .texts import FileSource

__all__ = ["Expansion", "FileSource", "expand_xacro", "is_xacro"]
