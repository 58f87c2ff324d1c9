"""Labels of segmentation images that are not agents."""

from __future__ import annotations

NOTHING, WALL, FLOOR, PROP = -1, -2, -3, -4


def geom_code(name: str) -> int:
    """Return the label of a shape by its name in the model of the engine: the agent of a robot, or what it is.

    >>> geom_code("robot3/base"), geom_code("wall/0"), geom_code("floor")
    (3, -2, -3)
    """
    if name.startswith("robot"):
        return int(name.removeprefix("robot").split("/")[0])
    return FLOOR if name.startswith("floor") else WALL if name.startswith("wall/") else PROP
