"""Headway layer: people slow down by the space ahead, on top of any crowd model."""

from .layer import HeadwayLayer, find_layered, with_headway

__all__ = ["HeadwayLayer", "find_layered", "with_headway"]
