"""Names of the gestures with which a person tells a robot who goes first."""

from __future__ import annotations

GESTURES = ("none", "wait", "proceed")
"""The index of a gesture is its code in arrays. ``wait`` tells the robot to stand until the person has passed,
``proceed`` tells it to go first."""
