"""Worlds: what turns commands into the next scene. Contracts :class:`World` and :class:`Drive`."""

from .drive import DifferentialDrive, Drive, Omnidirectional, Twists, moved
from .planar import PlanarWorld
from .world import Contact, World

__all__ = ["Contact", "DifferentialDrive", "Drive", "Omnidirectional", "PlanarWorld", "Twists", "World", "moved"]
