"""Contacts with persons of a row: how hard each run hit, and which region of the body."""

from __future__ import annotations

import math
from typing import NamedTuple

from .job import RunRow
from .result import CellResult

__all__ = ["PersonContact", "person_contacts"]

REGION = "impact_severity_"
"""Begin of the metrics of body regions in the physics world."""


class PersonContact(NamedTuple):
    """The contacts of one run with persons.

    Fields:
        seed: seed of the run.
        region: body region of the hardest impact; empty if unknown, as with discs in the plane.
        low, high: bounds of the severity, the force over the limit of ISO/TS 15066; equal if the region is known, NaN
            without the mass of the robot.
        speed: largest closing speed at first contact [m/s].
        cause: who closed the distance at the first contact: ``robot``, ``person``, ``both``, or empty if unknown.
    """

    seed: int
    region: str
    low: float
    high: float
    speed: float
    cause: str

    @property
    def severity(self) -> str:
        """Severity in words.

        >>> PersonContact(0, "", 1.5, 9.61, 2.0, "person").severity
        '1.5 to 9.6'
        """
        if math.isnan(self.high):
            return "unknown"
        return f"{self.high:.2g}" if self.low == self.high else f"{self.low:.2g} to {self.high:.2g}"


def person_contacts(cell: CellResult) -> list[PersonContact]:
    """Return the runs in which the robot touched a person, the hardest first.

    >>> from crowdbot.evaluation import CellResult
    >>> metrics = {"person_collision": 1.0, "max_severity": 2.0, "impact_severity_hand": 2.0}
    >>> person_contacts(CellResult("hall", "orca", "", "", {}, (RunRow(7, "collision", "", metrics),)))[0][:4]
    (7, 'hand', 2.0, 2.0)
    """
    found = [_contact(row) for row in cell.valid if row.metrics.get("person_collision") == 1.0]
    return sorted(found, key=lambda one: (-_known(one.high), -_known(one.low), -_known(one.speed), one.seed))


def _contact(row: RunRow) -> PersonContact:
    values = row.metrics
    regions = {name.removeprefix(REGION): value for name, value in values.items() if name.startswith(REGION)}
    region = max(regions, key=lambda name: regions[name], default="")
    if "max_severity" in values:
        low = high = regions.get(region, values["max_severity"])
    else:
        low, high = (values.get(f"severity_{side}_bound", math.nan) for side in ("lower", "upper"))
    speed = values.get("surface_impact_speed", values.get("max_impact_speed", math.nan))
    return PersonContact(row.seed, region.replace("_", " "), low, high, speed, _cause(row))


def _cause(row: RunRow) -> str:
    if "impacts" in row.metrics:
        robot, person = (row.metrics.get(f"{who}_caused_impacts", 0.0) > 0.0 for who in ("robot", "person"))
        return "both" if robot and person else "robot" if robot else "person" if person else "both"
    causes = {"robot_caused_collision": "robot", "person_caused_collision": "person", "mutual_collision": "both"}
    return next((word for name, word in causes.items() if row.metrics.get(name) == 1.0), "")


def _known(value: float) -> float:
    return -1.0 if math.isnan(value) else value
