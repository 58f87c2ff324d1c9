"""The contract of sensors, and their measurement times and delays."""

from __future__ import annotations

import dataclasses
import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, Self, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import (
    Clock,
    InputError,
    Pose,
    Scene,
    SpatialPose,
    TickSchedule,
    check_number,
    reset_undeclared,
    storable,
    tree,
    whole_ticks,
)
from crowdbot.typing import Ints

from .lens import ImageSource
from .noise import Noise, Randomness
from .view import SensorView

ReadingKind = TypeVar("ReadingKind", bound="Reading")
Reading_co = TypeVar("Reading_co", bound="Reading", covariant=True)


@storable
@dataclass(frozen=True)
class Reading:
    """The result of one measurement in E environments. Each sensor adds its own arrays.

    The first axis of every array is the environments, except for ``shared_fields``.

    Fields:
        time: simulated time of the measurement [s], a number or one for each environment ``[E]``.
        pose: pose of the sensor, planar or in space, as given.

    Class attributes:
        shared_fields: names of the fields that belong to all environments, such as the angles of beams. Numbers and
            texts always do.
        derived_fields: names of the fields that follow from the others, or None; digests of episodes leave them out.

    >>> reading = Reading(0.5, Pose.of([[0.0, 0.0], [3.0, 1.0]], 0.0))
    >>> reading.environment(1).pose.position.tolist()
    [[3.0, 1.0]]
    """

    time: float | NDArray[np.float64]
    pose: Pose | SpatialPose
    shared_fields: ClassVar[tuple[str, ...]] = ()
    derived_fields: ClassVar[tuple[str, ...]] = ()

    def select(self, index: ArrayLike) -> Self:
        """Return the reading of the environments ``index``, in this order.

        Raises:
            InputError: an environment does not exist, or the first axis of an array is not the environments.
        """
        name = type(self).__name__
        tree.check(self, len(self.pose.position), name)
        return tree.take(self, tree.environment_index(index, len(self.pose.position), name))

    def environment(self, number: int) -> Self:
        """Return the reading of one environment, with arrays ``[1, ...]`` and the time as a number.

        Raises:
            InputError: the environment does not exist, or the first axis of an array is not the environments.
        """
        count, name = len(self.pose.position), type(self).__name__
        if not 0 <= number < count:
            raise InputError(f"{name}: the environment is {number}, it must be from 0 to {count - 1}")
        tree.check(self, count, name)
        alone = tree.take(self, slice(number, number + 1))
        return dataclasses.replace(alone, time=float(alone.time[0])) if isinstance(alone.time, np.ndarray) else alone


class _Measures(Protocol[Reading_co]):
    """Contract of a sensor with a known type of reading."""

    def begin(self) -> Any: ...

    def measure(self, view: SensorView, state: Any, rng: Randomness | None = None) -> tuple[Reading_co, Any]: ...


@dataclass(frozen=True, kw_only=True)
class Sensor(ABC):
    """A sensor: a frozen specification and two pure functions.

    :meth:`begin` returns the state before the first measurement. :meth:`measure` takes a view of the scene and the
    state, and returns a reading and the next state. Most sensors have no state: it is None. Otherwise it is an array
    ``[E, ...]``, a number, or a dataclass, tuple, list or dict of these, so that a simulation can let some
    environments measure (:func:`take_state_rows`, :func:`put_state_rows`). A dataclass lists arrays that belong to all
    environments in the class variable ``shared_fields``. An environment gives the same reading alone and with others.

    Fields:
        rate: measurements per second [Hz].
        noise: noise added to every value, one :class:`Noise` or a tuple of them.
        delay: time from a measurement until its reading is available [s] (:class:`SensorSchedule`). The reading keeps
            the time of the measurement.

    Class attributes:
        spatial: whether the sensor always measures in space, also where people are discs in the plane.
        renders: whether the sensor needs a renderer for its usual images. Rendering is slow and needs graphics.
        encoders: whether the sensor reads the wheels of its robot, ``view.wheels``.
        truth: whether its readings are the truth, which no sensor of a real robot gives.
        batched: whether one call measures E environments of the plane, each from the row of its own of ``rng`` and
            of a state ``[E, ...]``. Otherwise each environment is measured alone. A subclass does not inherit it.

    >>> @dataclass(frozen=True, kw_only=True)
    ... class Counter(Sensor):
    ...     def begin(self):
    ...         return 0
    ...     def measure(self, view, state, rng=None):
    ...         return Reading(view.time, view.pose), state + 1
    >>> view = SensorView(Scene.of([[1.0, 0.0]]), Pose.of((0.0, 0.0), 0.0))
    >>> reading, state = Counter().measure(view, Counter().begin())
    >>> state
    1
    """

    rate: float = 10.0
    noise: Noise | tuple[Noise, ...] = ()
    delay: float = 0.0
    spatial: ClassVar[bool] = False
    renders: ClassVar[bool] = False
    encoders: ClassVar[bool] = False
    truth: ClassVar[bool] = False
    batched: ClassVar[bool] = False

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        reset_undeclared(cls, batched=False)

    def __post_init__(self) -> None:
        check_number(type(self).__name__, "rate", self.rate, "Hz", min=1e-6)
        check_number(type(self).__name__, "delay", self.delay, "s", min=0.0, max=3600.0)
        parts = (self.noise,) if isinstance(self.noise, Noise) else tuple(self.noise)
        for part in parts:
            if not isinstance(part, Noise):
                raise InputError(f"{type(self).__name__}: noise = {part!r} is not a Noise")
        object.__setattr__(self, "noise", parts)

    @property
    def noises(self) -> tuple[Noise, ...]:
        """The noise as a tuple."""
        return (self.noise,) if isinstance(self.noise, Noise) else self.noise

    @property
    def sees_skins(self) -> bool:
        """Whether the sensor sees people by their triangle skins."""
        return False

    def with_skins(self) -> Self:
        """Return a copy that sees people by their triangle skins, or the sensor itself if it cannot."""
        return self

    def begin(self) -> Any:
        """Return the state before the first measurement; None for sensors without state."""
        return None

    @abstractmethod
    def measure(self, view: SensorView, state: Any, rng: Randomness | None = None) -> tuple[Reading, Any]:
        """Return a reading and the next state.

        Args:
            view: scene without the robot that carries the sensor (``scene.without(robot)``), and pose of the sensor.
                Its time is a number or ``[E]``.
            state: from :meth:`begin` or from the previous call.
            rng: random generator, or a sequence of one for each environment; needed only if there is noise.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """

    def read(
        self: _Measures[Reading_co],
        scene: Scene,
        pose: Pose | SpatialPose,
        rng: Randomness | None = None,
        renderer: ImageSource | None = None,
    ) -> Reading_co:
        """Return a single reading: :meth:`measure` from the state of :meth:`begin`.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        return self.measure(SensorView(scene, pose, renderer), self.begin(), rng)[0]

    def check(self, view: SensorView) -> None:
        """Raise :class:`InputError` if the pose of ``view`` is not finite or does not fit its scene."""
        view.check(type(self).__name__)


def join_readings(readings: Sequence[ReadingKind], environments: Sequence[ArrayLike]) -> ReadingKind:
    """Return one reading of E environments from readings of some of them, for example of those that are due.

    Args:
        readings: readings of one class.
        environments: the environments of each reading; together 0 to E - 1, each once.

    Raises:
        InputError: an environment is missing or occurs twice, or the readings have different fields.

    >>> parts = [Reading(0.5, Pose.of((2.0, 0.0), 0.0)), Reading(0.5, Pose.of((1.0, 0.0), 0.0))]
    >>> join_readings(parts, [[1], [0]]).pose.position.tolist()
    [[1.0, 0.0], [2.0, 0.0]]
    """
    name = type(readings[0]).__name__ if readings else "readings"
    places = [tree.environment_index(index, None, name) for index in environments]
    every = np.concatenate(places) if places else np.zeros(0, dtype=np.int64)
    if not readings or not np.array_equal(np.sort(every), np.arange(len(every))):
        raise InputError(f"{name}: the environments are {every.tolist()}, they must be 0 to E - 1, each once")
    for reading, place in zip(readings, places, strict=True):
        tree.check(reading, len(place), name)
    try:
        joined: ReadingKind = tree.join(readings, places, len(every))
    except TypeError:
        raise InputError(f"{name}: the readings have different classes, fields or shapes") from None
    return joined


def spatial_pose(pose: Pose | SpatialPose) -> SpatialPose:
    """Return the pose in space; a planar pose becomes level, at the height of a usual mount."""
    return pose if isinstance(pose, SpatialPose) else pose.to_spatial()


def planar_pose(pose: Pose | SpatialPose) -> Pose:
    """Return the pose projected to the plane."""
    return pose.planar if isinstance(pose, SpatialPose) else pose


def finite_or_nan(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``values`` with NaN instead of infinite values."""
    return np.asarray(np.where(np.isfinite(values), values, np.nan))


@dataclass(frozen=True)
class SensorSchedule:
    """Schedule of a sensor: the ticks at which it measures, and the delay of its readings in whole ticks.

    Fields:
        ticks: ticks at which the sensor measures, see :class:`crowdbot.core.TickSchedule`.
        late: number of ticks from a measurement until its reading arrives.

    >>> from crowdbot.core import FreeClock
    >>> from crowdbot.sensors import Lidar2D
    >>> plan = SensorSchedule.of(Lidar2D(rate=10.0, delay=0.05), FreeClock(0.05))
    >>> [tick for tick in range(6) if plan.measures(tick)], plan.arrives(2)
    ([0, 2, 4], 3)
    """

    ticks: TickSchedule
    late: int

    @classmethod
    def of(cls, sensor: Sensor, clock: Clock) -> SensorSchedule:
        """Return the schedule of ``sensor``; a reading arrives at the first tick at or after time and delay.

        Raises:
            InputError: its period is shorter than the time step.
        """
        try:
            return cls(clock.schedule(1.0 / sensor.rate), _ticks_of(sensor.delay, clock))
        except InputError as error:
            raise InputError(
                f"{type(sensor).__name__}: rate {sensor.rate} Hz, delay {sensor.delay} s: {error}"
            ) from None

    @overload
    def measures(self, tick: int) -> bool: ...
    @overload
    def measures(self, tick: Ints) -> NDArray[np.bool_]: ...
    def measures(self, tick: int | Ints) -> bool | NDArray[np.bool_]:
        """Return whether the sensor measures at a tick, or at each of several."""
        return self.ticks.is_due(tick)

    @overload
    def arrives(self, tick: int) -> int: ...
    @overload
    def arrives(self, tick: Ints) -> Ints: ...
    def arrives(self, tick: int | Ints) -> int | Ints:
        """Return the tick at which a reading of a tick arrives."""
        return tick + self.late


def _ticks_of(delay: float, clock: Clock) -> int:
    """Return the number of ticks until a delay [s] is over."""
    if not 0.0 <= delay < math.inf:
        raise InputError(f"delay {delay} s must be finite and at least 0 s")
    nanoseconds = round(delay * 1e9)
    return whole_ticks(clock.step_ns, nanoseconds) or -(-nanoseconds // clock.step_ns)
