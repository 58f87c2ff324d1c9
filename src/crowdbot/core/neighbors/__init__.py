"""Neighbour search: the nearest agents of each agent."""

from .cell_grid import CHUNK, SMALL, SPARE, Seekers
from .search import CROWD, FEW, Neighbors, nearest, nearest_of_rows

__all__ = ["CHUNK", "CROWD", "FEW", "SMALL", "SPARE", "Neighbors", "Seekers", "nearest", "nearest_of_rows"]
