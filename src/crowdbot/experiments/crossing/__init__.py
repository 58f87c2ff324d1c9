"""The experiment on crossing the way of a robot: who passes first, clearance, collisions."""

from .crossing_study import CrossingStudy

__all__ = ["CrossingStudy"]
