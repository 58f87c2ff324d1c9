"""The plan of a measurement, and its results."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot.core import DataError, InputError, did_you_mean
from crowdbot.data import Trajectories

from .diagram import compute_fundamental_diagram
from .distances import compute_headways, compute_pair_distribution_function
from .encounters import compute_encounters, distribution
from .flow import compute_flow, compute_line_flow, compute_n_t, crossing_times, mean_flow
from .geometry import MeasurementArea, MeasurementLine, WalkableArea
from .interaction_energy import compute_interaction_energy
from .lanes import compute_lane_order
from .people import (
    ContinuousTracks,
    compute_individual_acceleration,
    compute_individual_speed,
    compute_individual_voronoi_polygons,
    pedpy_tracks,
)
from .profiles import Grid, compute_profiles
from .rows import check_metres, every_frame, select_rows, table
from .steady import combine_steady_states, detect_steady_state
from .waves import compute_stop_and_go, compute_stops

if TYPE_CHECKING:
    import pandas as pd


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


@dataclass(frozen=True, eq=False)
class Measurements:
    """Results of :func:`measure`.

    Fields:
        name: name of the recording.
        tables: tables by name, with the columns of the functions that make them.
        figures: single numbers by name.
        notes: sentences on what was left out.
        walkable, area, line: where it was measured.
        grid: grid of the profiles, or None.
    """

    name: str
    walkable: WalkableArea
    area: MeasurementArea
    line: MeasurementLine | None
    grid: Grid | None = None
    tables: dict[str, pd.DataFrame] = field(default_factory=dict)
    figures: dict[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def measure(tracks: Trajectories, plan: MeasurementPlan | None = None) -> Measurements:
    """Return all measurements of the people in a recording; robots are left out.

    Args:
        tracks: a recording, or ``episode.tracks()`` of a simulation, in metres.
        plan: methods and settings.

    Raises:
        InputError: a setting does not fit the recording.
        DataError: the tracks are in pixels, or there are no people in the walkable area.

    >>> import numpy as np
    >>> frame, id = np.repeat(np.arange(40), 10), np.tile(np.arange(10), 40)
    >>> tracks = Trajectories(id, frame, id + frame / 10.0, 0.5 + 0.0 * frame, row_rate=10.0)
    >>> found = measure(tracks, MeasurementPlan(line=MeasurementLine((9.5, 2), (9.5, -1))))
    >>> found.figures["flow"], round(found.figures["mean_speed"], 6)
    (1.0, 1.0)
    """
    plan = plan or MeasurementPlan()
    check_metres(tracks)
    people, walkable, notes = _people(tracks, plan)
    step = max(1, round(plan.window / people.dt)) * people.frame_step
    area = plan.area or MeasurementArea(walkable.border)
    grid = Grid.over(walkable, plan.grid) if "profiles" in plan.selection else None
    run = _Survey(people, plan, walkable, area, grid, step)
    for name in plan.selection:
        getattr(run, f"add_{name}")()
    figures = {
        "people": float(len(people.ids)),
        "duration": float(people.time[-1]),
        **{name: float(value) for name, value in run.figures.items()},
    }
    return Measurements(tracks.name, walkable, area, plan.line, grid, run.tables, figures, (*notes, *run.notes))


def pool_diagrams(found: Sequence[Measurements], width: float) -> pd.DataFrame:
    """Return one fundamental diagram of several recordings or starts, with 95 % intervals over them.

    Args:
        found: results of :func:`measure` with the method ``diagram``.
        width: width of the bins [1/m2].

    Raises:
        InputError: a result lacks the method, or there are none.
    """
    parts = [one.tables.get("diagram-values") for one in found]
    if not parts or any(part is None for part in parts):
        raise InputError("a pooled fundamental diagram needs results with the method diagram")
    density, speed = (np.concatenate([part[name].to_numpy() for part in parts if part is not None]) for name in
                      ("density", "speed"))  # fmt: skip
    start = np.repeat(np.arange(len(parts)), [0 if part is None else len(part) for part in parts])
    return compute_fundamental_diagram(density, speed, width, start)


def _people(tracks: Trajectories, plan: MeasurementPlan) -> tuple[Trajectories, WalkableArea, list[str]]:
    """Return the people inside the walkable area, this area, and notes on left out rows."""
    walkable = plan.walkable or WalkableArea.of(tracks)
    person = ~np.isin(tracks.id, sorted(tracks.robots))
    inside = walkable.covers(tracks.position)
    notes = []
    if tracks.robots:
        notes.append(f"{len(tracks.robots)} robots are not measured")
    outside = int(np.sum(person & ~inside))
    if outside:
        notes.append(f"{outside} of {int(person.sum())} rows are outside the walkable area and are not measured")
    if not np.any(person & inside):
        raise DataError(f"{tracks.name}: nobody is inside the walkable area")
    return select_rows(tracks, person & inside), walkable, notes


class _Survey:
    """Results that several methods share; each method ``add_...`` adds its tables and figures."""

    def __init__(
        self, people: Trajectories, plan: MeasurementPlan, walkable: WalkableArea, area: MeasurementArea,
        grid: Grid | None, step: int,
    ) -> None:  # fmt: skip
        self.plan, self.walkable, self.area, self.grid, self.step = plan, walkable, area, grid, step
        self.people = people
        self.tables: dict[str, Any] = {}
        self.figures: dict[str, float] = {}
        self.notes: list[str] = []
        self.speed = compute_individual_speed(people, step, border="single-sided")
        if len(self.speed) < len(people):
            rows = len(people) - len(self.speed)
            self.notes.append(f"{rows} rows without a second row of the same person have no speed and are not measured")
            self.people = people = _rows_with(people, self.speed)
        self.sample = _thin(people, plan.every)
        self._cells: Any = None

    @property
    def cells(self) -> Any:
        """Voronoi cells every ``every`` seconds."""
        if self._cells is None:
            self._cells = compute_individual_voronoi_polygons(self.sample, self.walkable, self.plan.cut_off)
        return self._cells

    @property
    def states(self) -> Any:
        """Density and speed of each person in each tessellation, with the position."""
        joined = self.cells.drop(columns="polygon").merge(self.speed, on=["id", "frame"])
        return joined.merge(self.sample.to_frame(), on=["id", "frame"])

    def add_individual(self) -> None:
        self.tables["individual"] = self.states[["id", "frame", "time", "x", "y", "density", "speed", "v_x", "v_y"]]
        self.figures["mean_speed"] = self.speed.speed.mean()
        numpy = compute_individual_acceleration(self.people, self.step).acceleration.to_numpy()
        if len(numpy):
            self.tables["acceleration"] = distribution(numpy, 0.1, 0.0, max(0.2, math.ceil(numpy.max() * 10.0) / 10.0))
            self.figures["mean_acceleration"] = numpy.mean()

    def add_area(self) -> None:
        import pedpy

        sample, area = pedpy_tracks(self.sample), pedpy.MeasurementArea(self.area.polygon)
        of_people: dict[str, Any] = {"traj_data": sample, "individual_speed": self.speed, "measurement_area": area}
        voronoi, parts = pedpy.compute_voronoi_density(individual_voronoi_data=self.cells, measurement_area=area)
        frames = every_frame(self.sample)
        # PedPy fills the frames between two Voronoi diagrams with 0
        classic, density, mean_speed, voronoi_speed = (
            found.set_index("frame").iloc[:, 0].loc[frames].to_numpy()
            for found in (
                pedpy.compute_classic_density(traj_data=sample, measurement_area=area),
                voronoi,
                pedpy.compute_mean_speed_per_frame(**of_people),
                pedpy.compute_voronoi_speed(**of_people, individual_voronoi_intersection=parts),
            )
        )
        time = (frames - self.people.frame[0]) / self.people.fps
        self.tables["area"] = table(
            frame=frames, time=time, classic_density=classic, voronoi_density=density,
            mean_speed=np.where(classic > 0.0, mean_speed, np.nan),  # PedPy: nobody inside walks at 0 m/s
            voronoi_speed=voronoi_speed, specific_flow=density * voronoi_speed,
        )  # fmt: skip
        self.figures |= {"classic_density": classic.mean(), "voronoi_density": density.mean()}
        self.figures["voronoi_speed"] = voronoi_speed.mean()
        if self.plan.steady is not None:
            self._add_steady(time, density, voronoi_speed)

    def _add_steady(self, time: Any, density: Any, speed: Any) -> None:
        assert self.plan.steady is not None
        states = [detect_steady_state(time, values, self.plan.steady) for values in (density, speed)]
        common = combine_steady_states(states)
        self.tables["steady"] = table(first=common[:, 0], last=common[:, 1])
        inside = np.zeros(len(time), dtype=np.bool_)
        for first, last in common:
            inside |= (time >= first) & (time <= last)
        if np.any(inside):
            self.figures |= {"steady_density": density[inside].mean(), "steady_speed": speed[inside].mean()}
            self.figures["steady_seconds"] = float(np.sum(common[:, 1] - common[:, 0]))
        else:
            self.notes.append("density and speed in the area are never steady together")

    def add_diagram(self) -> None:
        states = self.states
        inside = states[self.area.contains(states[["x", "y"]].to_numpy())]
        self.tables["diagram-values"] = inside[["id", "frame", "density", "speed"]].reset_index(drop=True)
        self.tables["diagram"] = compute_fundamental_diagram(
            inside.density.to_numpy(), inside.speed.to_numpy(), self.plan.bin, inside.id.to_numpy()
        )
        if not len(self.tables["diagram"]):
            self.notes.append("no bin of the fundamental diagram has 20 values")

    def add_line(self) -> None:
        import pedpy

        line, people = self.plan.line, self.people
        assert line is not None
        n_t, first = compute_n_t(people, line)
        times = crossing_times(people, line)
        self.tables |= {"n-t": n_t, "crossings": table(id=first.id, frame=first.frame, time=times)}
        frames = max(1, round(self.plan.interval * people.fps))
        self.tables["flow"] = compute_flow(people, n_t, first, self.speed, frames)
        flow = mean_flow(times)
        self.figures |= {"crossings": len(times), "flow": flow, "specific_flow": flow / line.length}
        species = pedpy.compute_species(
            individual_voronoi_polygons=self.cells, measurement_line=pedpy.MeasurementLine(line.line),
            trajectory_data=pedpy_tracks(people), frame_step=self.step // people.frame_step,
        )  # fmt: skip
        line_flow = compute_line_flow(self.sample, self.cells, line, self.speed, species)
        self.tables["line"] = line_flow.assign(time=(line_flow.frame - people.frame[0]) / people.fps)
        self.figures["line_flow"] = line_flow.flow.mean()

    def add_passing(self) -> None:
        import pedpy

        line, width = self.plan.line, self.plan.passage
        assert line is not None
        assert width is not None
        parts = ContinuousTracks.of(self.people)
        # PedPy puts the second line to the left of the first as well
        passages, between = pedpy.compute_frame_range_in_area(
            traj_data=parts.data, measurement_line=pedpy.MeasurementLine(line.line), width=width
        )
        inside = pedpy.compute_classic_density(traj_data=parts.data, measurement_area=between)
        density = pedpy.compute_passing_density(density_per_frame=inside, frames=passages).density
        speed = pedpy.compute_passing_speed(
            frames_in_area=passages, frame_rate=parts.data.frame_rate, distance=abs(width)
        ).speed
        self.tables["passages"] = parts.restore(
            passages.assign(density=density, speed=speed), "entering_frame", "leaving_frame"
        ).sort_values(["id", "entering_frame"], ignore_index=True)
        self.figures["passages"] = len(passages)

    def add_profiles(self) -> None:
        assert self.grid is not None
        self.tables["profiles"] = compute_profiles(self.grid, self.cells, self.speed)

    def add_encounters(self) -> None:
        pairs = compute_encounters(self.sample, _rows_of(self.speed, self.sample), self.plan.radius)
        gap, ttc = pairs.clearance.to_numpy(), pairs.ttc.to_numpy()
        self.tables["clearance"] = distribution(gap, 0.1, -2.0 * self.plan.radius, 10.0)
        energy = compute_interaction_energy(
            self.sample, _rows_of(self.speed, self.sample), self.plan.radius, seed=self.plan.seed
        )
        self.tables["time-to-collision"] = energy.table
        if not np.isnan(energy.exponent):
            self.figures |= {"energy_exponent": energy.exponent, "energy_strength": energy.strength}
        if not np.isnan(energy.exponent_low):
            ends = (energy.exponent_low, energy.exponent_high)
            self.figures |= {"energy_exponent_low": ends[0], "energy_exponent_high": ends[1]}
        if len(pairs):
            borders = np.flatnonzero(np.diff(pairs.frame.to_numpy(), prepend=pairs.frame[0] - 1))
            nearest = np.minimum.reduceat(gap, borders)
            self.figures |= {"smallest_clearance": gap.min(), "mean_smallest_clearance": nearest.mean()}
            self.figures["contact_share"] = float(np.mean(gap < 0.0))
        if np.any(np.isfinite(ttc)):
            self.figures["median_time_to_collision"] = float(np.median(ttc[np.isfinite(ttc)]))

    def add_pairs(self) -> None:
        self.tables["pair-distribution"] = compute_pair_distribution_function(
            self.sample, 0.1, farthest=5.0, shuffles=4, seed=self.plan.seed
        )

    def add_lanes(self) -> None:
        lanes = compute_lane_order(self.people, self.plan.axis, every=self.plan.every)
        self.tables["lanes"] = lanes
        if len(lanes) and not lanes.order.isna().all():
            self.figures["lane_order"] = lanes.order.mean()
        else:
            self.notes.append("there are never 5 people in each direction: no order of lanes")

    def add_stops(self) -> None:
        self.tables["stops"] = compute_stops(self.people, self.speed)
        found = compute_stop_and_go(self.people, self.speed, axis=self.plan.axis)
        self.figures |= {"stop_share": found.share, "stops_per_minute": found.stops_per_minute}
        self.figures |= {"stop_duration": found.duration, "wave_speed": found.wave}

    def add_headways(self) -> None:
        gaps = compute_headways(self.sample, self.plan.axis).merge(self.speed, on=["id", "frame"])
        self.tables["headways"] = gaps[["id", "frame", "ahead", "behind", "density", "speed"]]
        self.tables["file-diagram"] = compute_fundamental_diagram(
            gaps.density.to_numpy(), gaps.speed.to_numpy(), self.plan.bin, gaps.id.to_numpy()
        )
        self.figures["mean_headway"] = gaps.ahead.mean()


def _thin(tracks: Trajectories, every: float) -> Trajectories:
    """Return the rows every ``every`` seconds, with the time base of these rows."""
    rows = max(1, round(every / tracks.dt))
    kept = ((tracks.frame - tracks.frame[0]) // tracks.frame_step) % rows == 0
    kept &= (tracks.frame - tracks.frame[0]) % tracks.frame_step == 0
    thin = select_rows(tracks, kept)
    return dataclasses.replace(thin, frame_step=tracks.frame_step * rows, row_rate=tracks.row_rate / rows)


def _rows_of(speed: Any, tracks: Trajectories) -> Any:
    """Return the rows of a table for the people and frames of a recording."""
    return speed[speed.frame.isin(np.unique(tracks.frame))]


def _rows_with(tracks: Trajectories, speed: Any) -> Trajectories:
    known = set(zip(speed.id.tolist(), speed.frame.tolist(), strict=True))
    pairs = zip(tracks.id.tolist(), tracks.frame.tolist(), strict=True)
    return select_rows(tracks, np.asarray([pair in known for pair in pairs]))
