"""What a navigator knows about the people around its robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from crowdbot.sensors import Lidar2D, Lidar3D

PEOPLE_INPUTS = ("seen", "true", "tracked")
ABOUT_PEOPLE = (
    "people in observations: seen (true states of those in the latest readings), true (everybody), or tracked (found in"
    " laser scans)"
)


def people_problems(people: str, mounts: Sequence[Any]) -> Iterator[str]:
    """Yield why a robot cannot have such an input.

    >>> list(people_problems("tracked", []))
    ['has people="tracked" but no laser scanner; add <sensor type="lidar2d"/> or <sensor type="lidar3d"/>']
    """
    if people == "tracked" and not any(isinstance(mount.sensor, Lidar2D | Lidar3D) for mount in mounts):
        yield ('has people="tracked" but no laser scanner; add <sensor type="lidar2d"/> or <sensor type="lidar3d"/>')
