"""Neighbour search: the nearest agents of each agent."""

from .cell_grid import CHUNK, SMALL, SPARE, Seekers
from .search import CROWD, FEW, IN_ORDER, Neighbors, compare_rows, nearest, nearest_of_rows

__all__ = [
    "CHUNK",
    "CROWD",
    "FEW",
    "IN_ORDER",
    "SMALL",
    "SPARE",
    "Neighbors",
    "Seekers",
    "compare_rows",
    "nearest",
    "nearest_of_rows",
]
