"""Gait: postures of people over time, and the seats of those who do not walk."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError, Paper, stream
from crowdbot.typing import Floats

from .activities import activity_index
from .activity_poses import pose_activities
from .feet import Gaits, advance
from .people import Capsules, People
from .posture import Posture, posture

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Seat:
    """A seat, in a frame on the floor at the position of the person, x forward.

    Args:
        height: height of the seat [m].
        ahead: distance of the hips ahead of the position [m].
        recline: backward inclination of the trunk [rad]; 0 is upright.
        feet: position of the left heel [m], mirrored for the right one; None puts the feet on the floor. The feet of
            short people do not touch the floor.
        slope: inclination of the foot rests, toes up [rad].
        hands: position of the left wrist [m], mirrored for the right one; None puts the hands on the thighs.

    Raises:
        InputError: a number is not finite, or ``height`` is not from 0.2 to 1.2 m.

    >>> WHEELCHAIR.height, CHAIR.feet
    (0.555, None)
    """

    height: float = 0.46
    ahead: float = 0.0
    recline: float = 0.0
    feet: Point | None = None
    slope: float = 0.0
    hands: Point | None = None

    def __post_init__(self) -> None:
        """Raise :class:`InputError` for invalid values."""
        if not np.all(np.isfinite(self.row)):
            raise InputError(f"Seat: {self} has a value that is not finite")
        if not 0.2 <= self.height <= 1.2:
            raise InputError(f"Seat: height = {self.height} m must be from 0.2 to 1.2 m")

    @property
    def row(self) -> list[float]:
        """Values for the kernels: height, ahead, recline, slope, has feet, x, y, z, has hands, x, y, z."""
        feet, hands = self.feet or (0.0, 0.0, 0.0), self.hands or (0.0, 0.0, 0.0)
        there = [float(self.feet is not None), float(self.hands is not None)]
        return [self.height, self.ahead, self.recline, self.slope, there[0], *feet, there[1], *hands]


CHAIR = Seat()
"""A chair: seat at 0.46 m, feet on the floor, hips at the position."""
WHEELCHAIR = Seat(
    height=0.555, ahead=-0.075, recline=0.17, feet=(0.39, 0.1, 0.1446), slope=0.1, hands=(0.09, 0.262, 0.79)
)
"""Seat of the built-in robot ``wheelchair``: the position is that of its ``base_link``."""


def seat_rows(seat: Seat | Sequence[Seat], count: int) -> Floats:
    """Return the kernel values ``[N, 12]`` of one seat for all or of one for each.

    Raises:
        InputError: the number of seats is not ``count``.

    >>> seat_rows(CHAIR, 2).shape
    (2, 12)
    """
    seats = [seat] * count if isinstance(seat, Seat) else list(seat)
    if len(seats) != count:
        raise InputError(f"Gait: {len(seats)} seats are given for {count} people; give one, or one for each")
    return np.array([seat.row for seat in seats], dtype=np.float64).reshape(count, 12)


FASTEST = 12.0
"""Maximum speed [m/s]."""


@dataclass(frozen=True, eq=False)
class Gait:
    """Gait of a group of people. Planted feet are fixed in the world; the body moves relative to them.

    Args:
        people: bodies of the people.
        seed: seed of the walking styles (phase, stride, arms, toes, lean, gestures). The style of a person depends only
            on the seed and its number in ``ids``.
        ids: number of each person ``[N]`` (default: from 0).
        seat: seat of sitting people, one for all or one for each.

    Above about 2 m/s, only the cadence increases; the activity ``run`` has a phase of flight. A planted foot keeps its
    position unless the body leaves its reach (velocity jumps of several m/s) or turns more than 80 degrees relative to
    it. Sitting people move and turn with the seat, for example on the robot ``wheelchair`` with ``seat=WHEELCHAIR`` and
    its pose.

    Source: stride and speed relations of Boulic, Magnenat-Thalmann & Thalmann 1990, doi:10.1007/BF01901021.

    >>> gait = Gait(People.of(["man-20"]))
    >>> state = gait.start(position=[[0, 0]], heading=[0.0])
    >>> for k in range(1, 101):
    ...     state = gait.step(state, position=[[0.014 * k, 0]], velocity=[[1.4, 0]], heading=[0.0], dt=0.01)
    >>> gait.skin(state, level=2).shape, gait.limbs(state).radius.shape, float(state.moving[0])
    ((1, 447, 3), (1, 17), 1.0)
    """

    paper: ClassVar[Paper] = Paper(
        "Ronan Boulic, Nadia Magnenat-Thalmann, Daniel Thalmann",
        1990,
        "A global human walking model with real-time kinematic personification",
        "The Visual Computer 6",
        "10.1007/BF01901021",
    )

    people: People
    seed: int = 0
    ids: Sequence[int] | None = None
    seat: Seat | Sequence[Seat] = CHAIR
    seats: Floats = field(init=False, repr=False)
    style: Floats = field(init=False, repr=False)
    size: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Draw the walking styles and compute the leg lengths."""
        numbers = range(len(self.people)) if self.ids is None else list(self.ids)
        if len(numbers) != len(self.people):
            raise InputError(f"Gait: {len(numbers)} ids are given for {len(self.people)} people")
        style = np.array([_style(self.seed, int(k)) for k in numbers]).reshape(len(self.people), 9)
        m = self.people.measures
        size = np.stack([m.ankle, m.ball[:, 0], m.ball[:, 1], m.heel, m.toe, m.leg, m.thigh + m.shank], axis=1)
        object.__setattr__(self, "seats", seat_rows(self.seat, len(self.people)))
        object.__setattr__(self, "style", style)
        object.__setattr__(self, "size", size)

    def start(
        self,
        position: ArrayLike,
        heading: ArrayLike,
        velocity: ArrayLike | None = None,
        activity: str | Sequence[str] | NDArray[np.int64] = "walk",
    ) -> Gaits:
        """Return the initial state: walking if ``velocity`` is given, otherwise standing.

        Args:
            position: ``[N, 2]`` [m].
            heading: ``[N]`` [rad].
            velocity: ``[N, 2]`` [m/s].
            activity: one of :data:`ACTIVITIES` or a clip of the people for all, or one for each.

        Raises:
            InputError: a shape is wrong, a value is not finite or a speed is above 12 m/s.
            UnknownName: there is no such activity.
        """
        count = len(self.people)
        place, speed, ahead = self._check_motion(
            position, np.zeros((count, 2)) if velocity is None else velocity, heading
        )
        wish = activity_index(activity, count, self.people.activities).astype(np.float64)
        state = Gaits(
            position=place.copy(), yaw=ahead.copy(), turn=np.zeros(count), drift=speed.copy(), phase=np.zeros(count),
            moving=np.zeros(count), foot=np.zeros((count, 2, 3)), planted=np.ones((count, 2)),
            lift=np.zeros((count, 2, 6)), goal=np.zeros((count, 2, 3)), strike=np.zeros((count, 2)),
            clock=np.zeros(count), blend=np.eye(len(self.people.activities))[wish.astype(np.int64)], wish=wish,
        )  # fmt: skip
        advance(state, speed, place, ahead, np.ones(count), 0.0, self.style, self.size)
        return state

    def step(
        self,
        state: Gaits,
        position: ArrayLike,
        velocity: ArrayLike,
        heading: ArrayLike,
        dt: float,
        activity: str | Sequence[str] | NDArray[np.int64] | None = None,
    ) -> Gaits:
        """Return the state ``dt`` [s] later, with people at ``position`` and ``velocity``.

        Args:
            state: current state; it is not changed.
            position: ``[N, 2]`` [m]; people who are too far away to have walked there are repositioned.
            velocity: ``[N, 2]`` [m/s]; it determines the next foot placement.
            heading: ``[N]`` [rad]; the trunk turns to it by at most 4 rad/s.
            dt: time step [s], above 0; from 1 s on, all people are repositioned.
            activity: new activities (default: unchanged).

        Raises:
            InputError: as for :meth:`start`, or ``dt`` is not finite and above 0.
        """
        place, speed, ahead = self._check_motion(position, velocity, heading)
        if not (np.isfinite(dt) and dt > 0.0):
            raise InputError(f"Gait: dt = {dt} s must be finite and above 0")
        if len(state.yaw) != len(self.people):
            raise InputError(f"Gait: the state has {len(state.yaw)} people, it must have {len(self.people)}")
        after = Gaits(*(part.copy() for part in state))
        if activity is not None:
            after.wish[:] = activity_index(activity, len(self.people), self.people.activities)
        fresh = np.full(len(self.people), 1.0 if dt >= 1.0 else 0.0)
        advance(after, speed, place, ahead, fresh, float(dt), self.style, self.size)
        return after

    def posture(self, state: Gaits, targets: Mapping[int, Floats] | None = None) -> Posture:
        """Return the posture of all people; ``targets`` are points ``[3]`` [m] to look at, by row."""
        walking = posture(state, self.people.measures, self.style, self.size, self.seats)
        return pose_activities(walking, self.people, state, targets)

    def limbs(self, state: Gaits) -> Capsules:
        """Return the capsules of all people in world coordinates, in the order of :data:`LIMBS`."""
        return self.people.limbs(self.posture(state))

    def skin(self, state: Gaits, level: int = 2) -> Floats:
        """Return the vertices ``[N, V, 3]`` [m] of all people at a level of detail from 0 (finest) to 2."""
        return self.people.skin(self.posture(state), level)

    def _check_motion(
        self, position: ArrayLike, velocity: ArrayLike, heading: ArrayLike
    ) -> tuple[Floats, Floats, Floats]:
        count = len(self.people)
        found = []
        for name, value, shape in (
            ("position", position, (count, 2)), ("velocity", velocity, (count, 2)), ("heading", heading, (count,)),
        ):  # fmt: skip
            array = np.ascontiguousarray(value, dtype=np.float64)
            if array.shape != shape:
                raise InputError(f"Gait: {name} has shape {list(array.shape)}, it must be {list(shape)}")
            if not np.all(np.isfinite(array)):
                row = int(np.argmin(np.isfinite(array).reshape(count, -1).all(axis=1)))
                raise InputError(f"Gait: {name} of person {row} is not finite ({array[row]})")
            found.append(array)
        speed = np.sqrt((found[1] ** 2).sum(axis=1))
        if np.any(speed > FASTEST):
            raise InputError(
                f"Gait: a speed of {speed.max():.1f} m/s is not allowed, it must be at most {FASTEST:.0f} m/s"
            )
        return found[0], found[1], found[2]


def _style(seed: int, number: int) -> list[float]:
    """Return the random style parameters of one person, used by feet, posture and arms."""
    draw = stream(seed, "gait", number)
    return [
        float(draw.uniform(0.0, 1.0)),  # 0 phase at the start
        float(np.clip(draw.normal(1.0, 0.025), 0.94, 1.06)),  # 1 stride relative to the mean
        float(np.clip(draw.normal(1.0, 0.2), 0.5, 1.5)),  # 2 swing of the arms
        float(np.radians(draw.uniform(2.0, 10.0))),  # 3 toes outward [rad]
        float(np.radians(draw.uniform(0.0, 4.0))),  # 4 lean forward [rad]
        float(draw.uniform(0.0, 1.0)),  # 5 start of gestures
        float(draw.uniform(2.8, 5.0)),  # 6 pace of gestures [rad/s]
        float(draw.uniform(0.85, 1.15)),  # 7 width of the stance
        float(np.radians(draw.uniform(-4.0, 8.0))),  # 8 bend of the elbows [rad]
    ]


def posing_and_skinning(count: int = 100, level: int = 2) -> Callable[[], Floats]:
    """Return a benchmark workload: pose ``count`` random people and deform their skins at a level of detail.

    >>> posing_and_skinning(3)().shape
    (3, 447, 3)
    """
    draw = stream(0, "posing and skinning", count)
    gait = Gait(People.sample(count, draw))
    heading = draw.uniform(-np.pi, np.pi, count)
    velocity = 1.3 * np.stack([np.cos(heading), np.sin(heading)], axis=1)
    state = gait.start(draw.uniform(0.0, 30.0, (count, 2)), heading, velocity)
    return lambda: gait.skin(state, level)
