"""Travel: the navigation metrics of one robot, gathered while it is under way, in memory that hardly grows.

The numbers are those of :func:`crowdbot.metrics.navigation_metrics` on the arrays of the whole episode. People are
looked at two instants at a time; kept of them are a few numbers for each instant, and whom the robot touches.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from crowdbot.metrics import (
    ContactEvent,
    clearance,
    contact_events,
    local_density,
    navigation_metrics,
    personal_space_compliance,
    proxemic_shares,
    swept_clearance,
    time_to_collision,
)

__all__ = ["Instant", "Travel"]

Floats = NDArray[np.float64]

NEAR = 1.0
"""Whoever comes nearer than this [m] is followed ..."""
APART = 1.0
"""... until so long [s] farther away; longer than a contact needs to be over."""


@dataclass(frozen=True)
class Instant:
    """Who is where at one recorded instant: N who are there, robots too.

    Fields:
        time: [s].
        ids: ``[N]``, increasing.
        position, velocity: ``[N, 2]`` [m], [m/s].
        heading, radius: ``[N]`` [rad], [m].
    """

    time: float
    ids: NDArray[np.int64]
    position: Floats
    velocity: Floats
    heading: Floats
    radius: Floats

    def at(self, ids: NDArray[np.int64]) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """Return position and velocity ``[M, 2]`` of some people, 0 when they are not there, and who is ``[M]``."""
        place = np.clip(np.searchsorted(self.ids, ids), 0, len(self.ids) - 1)
        here = self.ids[place] == ids
        return (
            np.where(here[:, None], self.position[place], 0.0),
            np.where(here[:, None], self.velocity[place], 0.0),
            here,
        )


@dataclass
class _Row:
    """What is kept of an instant."""

    time: float
    position: Floats
    velocity: Floats
    heading: float
    swept: float
    nearest: float
    density: float
    soonest: float


@dataclass
class Travel:
    """The way of one robot.

    Args:
        robot: its id.
        radius: [m].
        goal, tolerance: place and distance [m] at which it has arrived.
        walls: segments ``[N, 4]`` [m].
    """

    robot: int
    radius: float
    goal: tuple[float, float]
    tolerance: float
    walls: Floats
    rows: list[_Row] = field(default_factory=list)
    events: list[ContactEvent] = field(default_factory=list)
    before: Instant | None = None
    arrived: bool = False
    met: dict[int, tuple[float, float, list[Instant]]] = field(default_factory=dict)
    """By id of somebody near: when that was last, the radius, and the instants with both alone."""

    def take(self, now: Instant) -> None:
        """Go on to the next recorded instant; what follows the arrival does not count."""
        if self.arrived:
            return
        steps = [now] if self.before is None else [self.before, now]
        ids, times = now.ids, np.array([step.time for step in steps])
        position, velocity, here = (np.stack(part) for part in zip(*(step.at(ids) for step in steps), strict=True))
        own = int(np.searchsorted(ids, self.robot))
        swept = swept_clearance(times, position, now.radius, here, own)[-1]
        last = (position[-1:], velocity[-1:], now.radius, here[-1:], own)
        gap = clearance(last[0], *last[2:])[0]
        self.rows.append(
            _Row(
                now.time,
                now.position[own],
                now.velocity[own],
                float(now.heading[own]),
                float(np.min(swept)),
                float(np.min(gap)),
                float(local_density(last[0], last[3], own)[0]),
                float(np.min(time_to_collision(*last))),
            )
        )
        self._follow(now, ids[np.minimum(swept, gap) < NEAR])
        self.before = now
        away = now.position[own] - np.array(self.goal)
        self.arrived = bool(np.hypot(away[0], away[1]) < self.tolerance)

    def metrics(self) -> dict[str, float]:
        """Return every metric of :data:`crowdbot.metrics.NAVIGATION_METRICS` up to now."""
        times = np.array([row.time for row in self.rows])
        found = navigation_metrics(
            times,
            np.array([row.position for row in self.rows])[:, None],
            np.array([row.velocity for row in self.rows])[:, None],
            np.array([self.radius]),
            np.ones((len(times), 1), dtype=np.bool_),
            0,
            np.array(self.goal),
            self.tolerance,
            heading=np.array([row.heading for row in self.rows]),
            walls=self.walls if len(self.walls) else None,
        )
        swept, nearest, density, soonest = np.array(
            [(row.swept, row.nearest, row.density, row.soonest) for row in self.rows]
        ).T
        someone = np.isfinite(nearest)
        if np.any(swept < 0.0) and not found["collision"]:
            found |= {"success": 0.0, "collision": 1.0, "timeout": 0.0, "time_to_goal": math.nan}
        found |= {
            "min_clearance": float(np.min(swept)),
            "min_clearance_time": float(times[np.argmin(swept)]) if np.any(np.isfinite(swept)) else math.nan,
            "mean_nearest_distance": float(np.mean(nearest[someone])) if np.any(someone) else math.inf,
            "personal_space_compliance": personal_space_compliance(nearest),
            **{f"{zone}_share": share for zone, share in proxemic_shares(nearest).items()},
            "local_density": float(np.mean(density)),
            "max_local_density": float(np.max(density)),
            "min_ttc": float(np.min(soonest)),
            "ttc_below_1s": float(np.mean(soonest < 1.0)),
            "ttc_below_3s": float(np.mean(soonest < 3.0)),
        }
        return found | self._contacts()

    def _contacts(self) -> dict[str, float]:
        events = [*self.events, *(event for who in self.met for event in self._touched(who))]
        events.sort(key=lambda event: (event.begin, event.person))
        return {
            "contacts": float(len(events)),
            "robot_caused_contacts": float(sum(event.cause == "robot" for event in events)),
            "person_caused_contacts": float(sum(event.cause == "person" for event in events)),
            "contact_time": sum((event.end - event.begin for event in events), 0.0),
            "max_penetration": max((event.depth for event in events), default=0.0),
            "max_impact_speed": max((event.impact_speed for event in events), default=0.0),
        }

    def _follow(self, now: Instant, near: NDArray[np.int64]) -> None:
        """Keep the instants of those who are near or were so lately; of those who are gone only the contacts."""
        for who in near.tolist():
            since = [] if self.before is None else [self._pair(self.before, who)]
            radius = float(now.radius[np.searchsorted(now.ids, who)])
            self.met[who] = (now.time, radius, self.met[who][2] if who in self.met else since)
        for who, (last, _, instants) in list(self.met.items()):
            instants.append(self._pair(now, who))
            if now.time - last > APART:
                self.events += self._touched(who)
                del self.met[who]

    def _pair(self, instant: Instant, who: int) -> Instant:
        """Return an instant with the robot and one person alone; who is not there has the id -1."""
        ids = np.array([self.robot, who])
        position, velocity, here = instant.at(ids)
        return Instant(instant.time, np.where(here, ids, -1), position, velocity, np.zeros(2), np.zeros(2))

    def _touched(self, who: int) -> tuple[ContactEvent, ...]:
        _, radius, instants = self.met[who]
        return contact_events(
            np.array([one.time for one in instants]),
            np.stack([one.position for one in instants]),
            np.stack([one.velocity for one in instants]),
            np.array([self.radius, radius]),
            np.stack([one.ids >= 0 for one in instants]),
            0,
        )
