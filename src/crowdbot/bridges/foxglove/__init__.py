"""Foxglove: a live server for the Foxglove app, and a layout for it."""

from .layout import foxglove_layout
from .server import FoxgloveServer

__all__ = ["FoxgloveServer", "foxglove_layout"]
