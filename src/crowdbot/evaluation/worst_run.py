"""Worst runs of an evaluation, simulated again for the report, and their contacts with persons."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from crowdbot.simulation import Episode, RunFailureWarning, simulate
from crowdbot.trials import floor_plan

from .job import RunRow
from .plan import EvaluationPlan
from .result import CellResult, EvaluationResult

RATE = 10.0
"""Largest number of pictures a second in the report."""
ORDER = ("collision", "fall", "error", "timeout", "finished", "success")
"""Outcomes from the worst to the best."""
NEAR = 0.2
"""Clearance to a person [m] below which a run is dangerous: the discomfort distance of CrowdNav."""


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

    @property
    def sentence(self) -> str:
        """Seed, body region, speed and severity.

        >>> print(PersonContact(3, "hand", 2.0, 2.0, 0.5, "robot").sentence)
        seed 3, at the hand, 0.50 m/s, severity 2 (force over the limit of ISO/TS 15066 for the body region)
        """
        where = f"at the {self.region}" if self.region else "at an unknown body region"
        limit = "the body region" if self.region else "each region below the height of the robot"
        about = f"force over the limit of ISO/TS 15066 for {limit}"
        return f"seed {self.seed}, {where}, {self.speed:.2f} m/s, severity {self.severity} ({about})"


class WorstRun(NamedTuple):
    """A run as the report shows it.

    Fields:
        cell: trial, navigator and robot.
        row: the run.
        drawing: what the page draws: times, tracks, walls, ground and doors, bounds.
        same: whether the new run has the digest of the evaluated one.
    """

    cell: CellResult
    row: RunRow
    drawing: dict[str, Any]
    same: bool


def worst_runs(
    plan: EvaluationPlan,
    result: EvaluationResult,
    count: int = 1,
    progress: Callable[[float], object] | None = None,
) -> list[WorstRun]:
    """Return the worst runs of each cell, simulated again.

    See :func:`worst_rows` for their order.

    Args:
        plan, result: of the same evaluation.
        count: runs of each cell.
        progress: called with the share of the runs that are done.
    """
    rows = [
        (planned, cell, row)
        for planned, cell in zip(plan.cells, result.cells, strict=True)
        for row, _ in worst_rows(cell, count)
    ]
    runs = []
    for planned, cell, row in rows:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RunFailureWarning)
            episode = simulate(planned.variant, row.seed)
        runs.append(WorstRun(cell, row, _drawing(episode), episode.digest == row.digest))
        if progress is not None:
            progress(len(runs) / len(rows))
    return sorted(runs, key=lambda run: (not _hurts(run.row), _missed(run.row)))


def worst_rows(cell: CellResult, count: int = 3) -> list[tuple[RunRow, str]]:
    """Return the worst runs of a row, and why each is there.

    First are the runs in which a person is touched or falls, the hardest first; then the run with the smallest
    clearance to a person, the runs that do not arrive, and the others by their clearance. Runs that are not dangerous
    are left out, see :func:`is_dangerous`; if no run is, the one with the smallest clearance is the only one.

    Args:
        cell: the row.
        count: number of runs.

    >>> from crowdbot.evaluation import CellResult
    >>> values = {"person_collision": 0.0, "success": 1.0}
    >>> rows = tuple(RunRow(k, "success", "", values | {"min_clearance": 0.1 * k - 0.05}) for k in (3, 2, 1))
    >>> [(row.seed, reason) for row, reason in worst_rows(CellResult("hall", "orca", "", "", {}, rows), 3)]
    [(1, 'clearance 0.05 m'), (2, 'clearance 0.15 m')]
    """
    contacts = {contact.seed: contact for contact in person_contacts(cell)}
    order = [*contacts]
    order += [row.seed for row in cell.valid if _hurts(row) and row.seed not in contacts]
    close = sorted(cell.valid, key=lambda row: (_clearance(row), row.seed))
    missed = sorted((row for row in close if row.metrics.get("success") != 1.0), key=_missed)
    order += [row.seed for row in (*close[:1], *missed, *close)]
    rows = {row.seed: row for row in cell.valid}
    order = [*dict.fromkeys(order)]
    order = [seed for seed in order if is_dangerous(rows[seed])] or order[:1]
    return [(rows[seed], _reason(rows[seed], contacts.get(seed))) for seed in order[:count]]


def is_dangerous(row: RunRow) -> bool:
    """Whether a run has a contact or a fall, does not arrive, or comes nearer than 0.2 m to a person.

    >>> is_dangerous(RunRow(0, "success", "", {"success": 1.0, "min_clearance": 0.4}))
    False
    """
    touched = any(row.metrics.get(f"{kind}_collision") == 1.0 for kind in ("wall", "object", "robot"))
    return _hurts(row) or touched or row.metrics.get("success") != 1.0 or _clearance(row) < NEAR


def not_dangerous(cell: CellResult) -> str:
    """Return a sentence if no run of a row is dangerous, with the smallest clearance; empty otherwise."""
    if not cell.valid or any(is_dangerous(row) for row in cell.valid):
        return ""
    least = min(_clearance(row) for row in cell.valid)
    nearest = f"the smallest clearance is {least:.2f} m" if math.isfinite(least) else "nobody came near"
    return f"no run was dangerous: no contact, no fall, all arrived, and {nearest} (dangerous: below {NEAR:g} m)"


def _reason(row: RunRow, contact: PersonContact | None) -> str:
    if contact is not None:
        return f"contact with a person at {contact.speed:.2f} m/s, severity {contact.severity}"
    clearance = f"clearance {_clearance(row):.2f} m" if math.isfinite(_clearance(row)) else "nobody near"
    touched = [kind for kind in ("wall", "object", "robot") if row.metrics.get(f"{kind}_collision") == 1.0]
    what = f"contact with a {' and a '.join(touched)}" if touched and row.outcome == "collision" else row.outcome
    return clearance if row.outcome == "success" else f"{what}, {clearance}"


def _hurts(row: RunRow) -> bool:
    return row.metrics.get("person_collision") == 1.0 or row.outcome == "fall"


def _clearance(row: RunRow) -> float:
    value = row.metrics.get("min_clearance", math.inf)
    return math.inf if math.isnan(value) else value


def _missed(row: RunRow) -> int:
    return ORDER.index(row.outcome) if row.outcome in ORDER else len(ORDER)


def _drawing(episode: Episode) -> dict[str, Any]:
    step = max(1, round(1.0 / RATE / max(1e-9, float(np.diff(episode.times[:2]).sum() or 1.0 / RATE))))
    rows = np.arange(0, len(episode.times), step)
    rows = rows if rows[-1] == len(episode.times) - 1 else np.append(rows, len(episode.times) - 1)
    seen = episode.active[rows].any(axis=0) & (episode.radius > 0)
    outlines = dict(zip(episode.robots, episode.footprints, strict=True))
    tracks = []
    for agent in np.flatnonzero(seen).tolist():
        here = episode.active[rows, agent]
        points = np.round(episode.position[rows, agent], 2)
        tracks.append(
            {
                "robot": agent in episode.robots,
                "radius": round(float(episode.radius[agent]), 3),
                "outline": [] if (shape := outlines.get(agent)) is None else np.round(shape, 3).tolist(),
                "heading": np.round(episode.heading[rows, agent], 2).tolist(),
                "track": [point if on else None for point, on in zip(points.tolist(), here.tolist(), strict=True)],
            }
        )
    walls = [np.round(ring, 2).tolist() for ring in episode.walls]
    goals = [list(robot.goal.position) for robot in episode.trial.robots]
    return {
        "times": np.round(episode.times[rows], 2).tolist(),
        "agents": tracks,
        "walls": walls,
        "plan": _plan(episode),
        "goals": goals,
        "bounds": _bounds(episode, walls, goals),
    }


def _plan(episode: Episode) -> list[dict[str, Any]]:
    """Return the strokes of uneven ground and doors as values for the page."""
    plan = []
    for line in floor_plan(episode.trial.stage):
        gaps = np.flatnonzero(np.isnan(line.points[:, 0]))
        for stroke in np.split(line.points, gaps):
            points = np.round(stroke[~np.isnan(stroke[:, 0])], 2).tolist()
            plan.append({"color": line.color, "width": line.width, "points": points})
    return plan


def _bounds(episode: Episode, walls: Sequence[Any], goals: Sequence[Any]) -> list[float]:
    points = [episode.position[episode.active], np.array(goals, dtype=np.float64).reshape(-1, 2)]
    points += [np.array(ring, dtype=np.float64).reshape(-1, 2) for ring in walls]
    every = np.concatenate(points)
    low, high = every.min(axis=0) - 1.0, every.max(axis=0) + 1.0
    return [round(float(value), 2) for value in (*low, *high)]


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
