"""The plan of a measurement: methods, places and settings."""

from __future__ import annotations

import math
from dataclasses import dataclass

from crowdbot.core import InputError, did_you_mean

from .geometry import MeasurementArea, MeasurementLine, WalkableArea

METHODS = {
    "individual": "Voronoi density and speed of each person and frame; distribution of accelerations",
    "area": "classic and Voronoi density, mean and Voronoi speed and flow in the area over time",
    "diagram": "fundamental diagram of the people in the area: speed and specific flow by Voronoi density",
    "line": "N(t), flow and Voronoi flow at the line",
    "passing": "density and speed of each passage between two parallel lines",
    "profiles": "density, speed and flow on a grid",
    "encounters": "times to collision, interaction energy and clearances between people",
    "pairs": "pair distribution function",
    "lanes": "order of lanes along the axis",
    "stops": "stops of people and the speed of stop-and-go waves",
    "headways": "gaps, line density and fundamental diagram of a single file along the axis",
}
"""Methods of :func:`measure`."""

FIGURES = {
    "people": "1", "duration": "s", "mean_speed": "m/s", "mean_acceleration": "m/s2", "classic_density": "1/m2",
    "voronoi_density": "1/m2", "voronoi_speed": "m/s", "steady_density": "1/m2", "steady_speed": "m/s",
    "steady_seconds": "s", "crossings": "1", "flow": "1/s", "specific_flow": "1/(m s)", "line_flow": "1/(m s)",
    "passages": "1", "smallest_clearance": "m", "mean_smallest_clearance": "m", "contact_share": "1",
    "median_time_to_collision": "s", "energy_exponent": "1", "energy_exponent_low": "1", "energy_exponent_high": "1",
    "energy_strength": "s^n", "lane_order": "1", "stop_share": "1", "stops_per_minute": "1/min",
    "stop_duration": "s", "wave_speed": "m/s", "mean_headway": "m",
}  # fmt: skip
"""Units of the figures of :func:`measure`."""


@dataclass(frozen=True, eq=False)
class MeasurementPlan:
    """What is measured, and where.

    Fields:
        methods: names of ``METHODS`` (default: all that the other settings allow, without headways).
        walkable: walkable area (default: from the walls of the recording, or the box of all positions and 1 m).
        area: area of density, speed and fundamental diagram (default: the walkable area).
        line: line of the flow (default: none).
        passage: distance of a second line [m], for passages (default: none).
        axis: ``x`` or ``y``, the coordinate along a corridor or a file.
        window: time before and after an instant over which speeds are measured [s].
        every: time between two Voronoi tessellations [s].
        cut_off: largest radius of a Voronoi cell [m] (default: none).
        grid: cells of profiles [m].
        bin: width of the bins of the fundamental diagram [1/m2] or [1/m].
        interval: duration of an interval of the flow [s].
        radius: radius of people for encounters [m].
        steady: first and last time [s] of the reference of the steady state in the area (default: not detected).
        seed: seed of shuffles and intervals.

    Raises:
        InputError: a method is unknown, a number is not above 0, or a method lacks its line.
    """

    methods: tuple[str, ...] = ()
    walkable: WalkableArea | None = None
    area: MeasurementArea | None = None
    line: MeasurementLine | None = None
    passage: float | None = None
    axis: str = "x"
    window: float = 0.5
    every: float = 0.5
    cut_off: float | None = None
    grid: float = 0.5
    bin: float = 0.25
    interval: float = 10.0
    radius: float = 0.2
    steady: tuple[float, float] | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        for name in self.methods:
            if name not in METHODS:
                raise InputError(
                    f"unknown method {name!r}{did_you_mean(name, METHODS)}; known are {', '.join(METHODS)}"
                )
        for name in ("window", "every", "grid", "bin", "interval", "radius"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise InputError(f"{name} is {getattr(self, name)}, it must be above 0 and finite")
        if self.axis not in ("x", "y"):
            raise InputError(f"the axis is x or y, not {self.axis!r}")
        if self.line is None and ("line" in self.methods or "passing" in self.methods or self.passage is not None):
            raise InputError("flow and passages need a measurement line")
        if self.passage is None and "passing" in self.methods:
            raise InputError("passages need the distance of the second line")
        if self.passage is not None and (self.passage == 0.0 or not math.isfinite(self.passage)):
            raise InputError(f"the second line of a passage must be apart from the first, not {self.passage} m")
        if self.cut_off is not None and not 0.0 < self.cut_off < math.inf:
            raise InputError(f"cut-off of {self.cut_off} m: the radius must be above 0 and finite")

    @property
    def selection(self) -> tuple[str, ...]:
        """The methods that are used, in the order of ``METHODS``."""
        if self.methods:
            return tuple(name for name in METHODS if name in self.methods)
        left_out = {"headways"} | ({"line"} if self.line is None else set())
        left_out |= {"passing"} if self.passage is None else set()
        return tuple(name for name in METHODS if name not in left_out)
