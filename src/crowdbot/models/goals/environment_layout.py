"""EnvironmentLayout: goal estimator based on walls and exits."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper, Walls, check_parameters, parameter
from crowdbot.data import PlaceLayout, Trajectories, Windows, fill_gaps, steady_velocity
from crowdbot.typing import Floats

from .exits import hull, openings, track_ends
from .goal import Choices, Goal
from .headings import MOVING, angle_between, extrapolate, length, median, rotate, unit
from .learned_velocity import LearnedVelocity
from .routes import Routes

ZIEBART = Paper(
    "Ziebart, Ratliff, Gallagher, Mertz, Peterson, Bagnell, Hebert, Dey, Srinivasa",
    2009,
    "Planning-based prediction for pedestrians",
    "IEEE/RSJ International Conference on Intelligent Robots and Systems",
    "10.1109/IROS.2009.5354147",
)


@dataclass(frozen=True, eq=False)
class EnvironmentLayout(Goal):
    """Exits of a place, weighted by the progress of each person towards them.

    The posterior of an exit is its prior times exp(``certainty`` x progress). The progress [m] is the decrease of the
    path length to the exit, averaged over the whole observation and its second half. This is the likelihood of the
    observed path for noisy shortest-path walking, up to a common factor (Ziebart et al. 2009). Paths to exits lead
    around walls. Walking straight on is an additional candidate, for destinations that are not in the layout.

    People turn towards their exit gradually: the predicted heading is between the current one and that to the exit.
    ``pull`` is the fraction of the turn, which increases if the next waypoint is closer than ``lookahead``.
    :meth:`resolve` returns the median direction of all candidates, :meth:`choices` the direction and the probability of
    each. All goals are ``horizon`` ahead, since crowd models walk straight to a goal.

    Args:
        exits: points ``[G, 2]`` or segments ``[G, 2, 2]`` [m], or points as text x y x y.
        walls: rings or lines that block view and movement, see :class:`~crowdbot.core.Walls`.
        prior: prior weights of the exits ``[G]`` (default: equal).
        straight: prior probability that people keep their direction.
        certainty: how directly people walk to their exit [1/m].
        pull: minimum fraction of the turn to the exit.
        lookahead: time [s] within which the turn is completed.
        horizon: distance of the goals as time at the observed velocity [s].
        pace: learned velocity from the last displacements, for a recorded place.

    Raises:
        InputError: there is no exit, or a value is not allowed.

    Source: Ziebart et al. 2009, doi:10.1109/IROS.2009.5354147.

    >>> layout = EnvironmentLayout([(10.0, 0.0), (0.0, 10.0)], walls=[[(2.0, 1.0), (2.0, -9.0)]])
    >>> layout.exits.shape, layout.routes.corners.round(1).tolist()
    ((2, 2, 2), [[2.0, 1.6], [2.0, -9.6]])
    """

    exits: tuple[float, ...] | Any
    walls: Any = ()
    prior: tuple[float, ...] | Any = None
    straight: float = parameter(0.5, unit="1", low=0.05, high=0.95, source="crowdbot")
    certainty: float = parameter(1.5, unit="1/m", low=0.5, high=20.0, source="crowdbot")
    pull: float = parameter(0.4, unit="1", low=0.0, high=1.0, source="crowdbot")
    lookahead: float = parameter(0.5, unit="s", low=0.0, high=5.0, source="crowdbot")
    horizon: float = parameter(20.0, unit="s", low=5.0, high=60.0, source="crowdbot", min=0.1)
    pace: LearnedVelocity | None = None
    routes: Routes = field(init=False, repr=False)

    learns: ClassVar[bool] = True
    paper: ClassVar[Paper] = ZIEBART

    def __post_init__(self) -> None:
        check_parameters(self)
        exits = _segments(self.exits)
        for name in ("straight", "pull"):
            if getattr(self, name) > 1.0:
                raise InputError(f"environment-layout: {name} = {getattr(self, name)} must be at most 1")
        weight = np.ones(len(exits)) if self.prior is None else np.asarray(self.prior, dtype=np.float64)
        if weight.shape != (len(exits),) or not (np.all(weight >= 0.0) and 0.0 < np.sum(weight) < np.inf):
            raise InputError(
                f"environment-layout: prior has shape {list(weight.shape)} for {len(exits)} exits;"
                " it must have one weight for each exit, at least 0 and not all 0"
            )
        object.__setattr__(self, "exits", exits)
        object.__setattr__(self, "prior", weight / np.sum(weight))
        object.__setattr__(self, "walls", Walls.of(self.walls))
        object.__setattr__(self, "routes", Routes.of(exits, self.walls))

    @classmethod
    def of(cls, walls: Any = (), area: Any = None, width: float = 2.0, **values: Any) -> Self:
        """Return the layout whose exits are the openings of the border of the walkable area.

        Args:
            walls: see :class:`EnvironmentLayout`.
            area: border as a ring ``[N, 2]`` [m] or shapely polygon (default: convex hull of the walls).
            width: openings are divided into exits of about this width [m].
            values: other fields.

        Raises:
            InputError: there is no border, no opening, or a value is not allowed.
        """
        solid = Walls.of(walls)
        if not (width > 0.0 and np.isfinite(width)):
            raise InputError(f"environment-layout: width = {width} m must be finite and above 0")
        if area is None and len(solid) < 2:
            raise InputError("environment-layout: there are neither walls nor an area; give exits")
        border = hull(solid.start) if area is None else _ring(area)
        return cls(openings(border, solid, width), solid, **values)

    @classmethod
    def at(cls, layout: PlaceLayout) -> Self:
        # goal for a place with its exits; without exits, they are the openings of the outermost walls
        return cls(layout.exits, layout.rings) if layout.exits else cls.of(layout.rings)

    @classmethod
    def learn(cls, *recordings: Trajectories, walls: Any = None, width: float = 2.0, **values: Any) -> Self:
        """Return the layout of a recorded place.

        The walkable area is the convex hull of the recorded positions, and its openings are the exits. The prior of an
        exit is the number of people who left there plus one. The velocity is learned, too.

        Args:
            recordings: recordings of the place, in metres.
            walls: walls (default: those of the first recording).
            width: width of an exit [m].
            values: other fields.

        Raises:
            InputError: no recording is given, they are in pixels or differ in time step, or there is no opening.
            DataError: a recording is too short to learn from.
        """
        pace = LearnedVelocity.learn(recordings)
        solid = Walls.of(recordings[0].walls if walls is None else walls)
        place = np.concatenate([tracks.position for tracks in recordings])
        layout = cls.of(solid, hull(place), width, **values)
        found = [track_ends(tracks) for tracks in recordings]
        left = np.concatenate([ends[gone] for _, ends, gone in found])
        centre = layout.routes.exits.mean(axis=1)
        nearest = np.argmin(length(left[:, None] - centre), axis=1)
        prior = 1.0 + np.bincount(nearest, minlength=len(centre))
        return cls(layout.routes.exits, solid, **{"prior": prior, "pace": pace, **values})

    @property
    def history(self) -> float:
        return 0.0 if self.pace is None else self.pace.history

    def velocity(self, past: Windows) -> Floats:
        return steady_velocity(past) if self.pace is None else self.pace.velocity(past)

    def resolve(self, past: Windows) -> Floats:
        velocity, turn, weight, here = self._candidates(past)
        return extrapolate(past.position[:, -1], here, rotate(velocity, median(turn, weight)), self.horizon)

    def choices(self, past: Windows) -> Choices:
        # straight on (slot 0) and the direction to each exit (slots 1 to G) with their posterior
        velocity, turn, weight, here = self._candidates(past)
        place = np.where(here[..., None], past.position[:, -1], 0.0)
        way = np.where(here[..., None, None], rotate(velocity[:, :, None], turn), 0.0)
        return Choices(place[:, :, None] + self.horizon * way, weight)

    def _candidates(self, past: Windows) -> tuple[Floats, Floats, Floats, NDArray[np.bool_]]:
        """Return velocity ``[W, A, 2]``, turn [rad] and weight ``[W, A, G + 1]`` of candidates, and presence."""
        if past.units != "m":
            raise InputError(f"environment-layout: {past.source} is in {past.units}; convert it to metres first")
        velocity, here = self.velocity(past), past.present[:, -1]
        turn = np.zeros((*here.shape, len(self.routes.exits) + 1))
        weight = np.zeros(turn.shape)
        weight[here, 0] = 1.0
        moving = here & (length(velocity) > MOVING)
        if np.any(moving):
            turn[moving], weight[moving] = self._weigh(fill_gaps(past), velocity[moving], moving)
        return velocity, turn, weight, here

    def _weigh(self, known: Windows, velocity: Floats, moving: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        """Return turn [rad] and posterior ``[P, G + 1]`` of moving people."""
        place = known.position[:, -1][moving]
        aim, way = self.routes.next(place)
        heading = unit(velocity)
        log = np.zeros((len(place), 1 + len(self.routes.exits)))
        now = known.position.shape[1] - 1
        begin = np.argmax(known.present, axis=1)
        for row in (begin, np.maximum(begin, now // 2)):
            start = np.take_along_axis(known.position, row[:, None, :, None], axis=1)[:, 0][moving]
            before = self.routes.next(start)[1]
            log[:, 0] += 0.5 * np.sum((place - start) * heading, axis=-1)
            known_way = np.isfinite(way) & np.isfinite(before)
            nearer = np.where(known_way, before, 0.0) - np.where(known_way, way, 0.0)
            log[:, 1:] += 0.5 * np.where(known_way, nearer, -np.inf)
        log = self.certainty * (log - log[:, :1])
        with np.errstate(divide="ignore"):
            log += np.log(np.concatenate([[self.straight], (1.0 - self.straight) * np.asarray(self.prior)]))
        weight = np.exp(log - log.max(axis=1, keepdims=True))
        weight /= np.sum(weight, axis=1, keepdims=True)
        off = aim - place[:, None]
        soon = self.lookahead * length(velocity)[:, None] / np.maximum(length(off), 1e-9)
        part = np.where(
            length(off) > 0.5, np.clip(soon, self.pull, 1.0), 0.0
        )  # very close to the exit, a heading is meaningless
        turn = np.zeros_like(weight)
        turn[:, 1:] = part * angle_between(heading[:, None], off)
        return turn, weight


def _segments(exits: Any) -> Floats:
    """Return exits as segments ``[G, 2, 2]`` [m]."""
    segments = np.asarray(exits, dtype=np.float64)
    if segments.ndim == 1 and segments.size % 2 == 0:
        segments = segments.reshape(-1, 2)
    if segments.ndim == 2 and segments.shape[1] == 2:
        segments = np.stack([segments, segments], axis=1)
    if segments.size == 0:
        raise InputError(
            "environment-layout: the layout has no exit; give exits as points, or an area with an opening in its border"
        )
    if segments.ndim != 3 or segments.shape[1:] != (2, 2) or not np.all(np.isfinite(segments)):
        raise InputError(
            f"environment-layout: exits have shape {list(segments.shape)}; they must be finite points [G, 2] or"
            " segments [G, 2, 2] in metres"
        )
    return segments


def _ring(area: Any) -> Floats:
    points = np.asarray(area.exterior.coords if hasattr(area, "exterior") else area, dtype=np.float64)
    if points.ndim != 2 or len(points) < 3 or points.shape[1] < 2 or not np.all(np.isfinite(points)):
        raise InputError("environment-layout: area must be one ring of at least three finite points [N, 2]")
    return points[:, :2]
