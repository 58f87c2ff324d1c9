"""Foxglove: a live server for the Foxglove app, and a layout for it."""

from .server import FoxgloveServer, foxglove_layout

__all__ = ["FoxgloveServer", "foxglove_layout"]
