"""Impact metrics of a robot in the physics world: forces, impulses and severity of its contacts with people."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Protocol

IMPACT_METRICS: dict[str, tuple[str, str]] = {
    "impacts": ("1", "number of contacts of bodies with people in the physics world"),
    "robot_caused_impacts": ("1", "impacts in which the robot closed the distance"),
    "person_caused_impacts": ("1", "impacts in which the person closed the distance"),
    "severe_impacts": ("1", "impacts with a severity above 1"),
    "max_severity": (
        "1",
        "maximum ratio of force to limit of the body region (ISO/TS 15066), or fall_severity if larger; 0 without"
        " impact",
    ),
    "peak_force": ("N", "maximum force of an impact by the two-body model, 0 without impact"),
    "steady_force": ("N", "maximum clamping force, 0 without clamping"),
    "total_impulse": ("N s", "sum of the impulses on people"),
    "surface_impact_speed": ("m/s", "maximum closing speed of the surfaces at first contact, 0 without impact"),
}
"""Unit and definition of each key of :func:`impact_metrics`, in order; absent in the planar world."""


class Impact(Protocol):
    """What the metrics read of a contact event; :class:`crowdbot.world.BodyContactEvent` and its record have it."""

    @property
    def cause(self) -> str:
        """Who caused the contact."""

    @property
    def impact_speed(self) -> float:
        """Approach speed at the first touch [m/s]."""

    @property
    def impulse(self) -> float:
        """Impulse [N s]."""

    @property
    def peak_force(self) -> float:
        """Largest force [N]."""

    @property
    def steady_force(self) -> float:
        """Clamping force [N]."""

    @property
    def severity(self) -> float:
        """Largest share of the limits of the body region."""


def impact_metrics(impacts: Iterable[Impact]) -> dict[str, float]:
    """Return every metric of :data:`IMPACT_METRICS` of the contacts of one robot with people.

    In the contact events of the world, the robot is the first body, and the person the second one.

    >>> impact_metrics([])["peak_force"]
    0.0
    """
    events = list(impacts)
    severity = [0.0 if math.isnan(event.severity) else event.severity for event in events]
    forces = [(event.peak_force, event.steady_force) for event in events]
    return {
        "impacts": float(len(events)),
        "robot_caused_impacts": float(sum(event.cause == "first" for event in events)),
        "person_caused_impacts": float(sum(event.cause == "second" for event in events)),
        "severe_impacts": float(sum(value > 1.0 for value in severity)),
        "max_severity": max(severity, default=0.0),
        "peak_force": max((peak for peak, _ in forces if not math.isnan(peak)), default=0.0),
        "steady_force": max((steady for _, steady in forces), default=0.0),
        "total_impulse": sum((event.impulse for event in events), 0.0),
        "surface_impact_speed": max((event.impact_speed for event in events), default=0.0),
    }
