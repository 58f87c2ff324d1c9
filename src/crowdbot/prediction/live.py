"""Live: forecasts of a stream of tracked people."""

from __future__ import annotations

import dataclasses
import math
import re
import threading
import time as clocks
import warnings
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.calibration import Fit, TimeLimit
from crowdbot.core import InputError, stream
from crowdbot.data import PERSON_CLASSES, Forecast, Windows
from crowdbot.typing import Floats

from .predictor import Predictor
from .tracker_frame import TrackerFrame
from .tracker_history import TrackedRows, TrackerHistory
from .tracker_messages import TrackerMessages
from .tracker_plausibility import TrackerPlausibility, TrackerWarning

ROWS = 8
"""Default number of rows of predictors without a history in seconds."""
SAFETY = 0.85
"""Share of the budget that is planned."""
FIRST_SHARE = 0.5
"""Share of the planned time for the calibration in the first frame, when the time after it is unknown."""
FORGET = 0.9
"""Factor by which the largest time after the calibration shrinks from frame to frame."""
UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0}
"""Units of durations [s]."""


@dataclass(frozen=True)
class LiveReport:
    """What the last call of :meth:`Live.predict` took, and what it calibrated in this time.

    Fields:
        latency: duration of the call [s]; NaN before the first.
        budget: time that it had [s]; infinity without a limit.
        evaluations: candidate crowds that the calibration evaluated; 0 without calibration.
        wanted: candidate crowds of an unlimited calibration.
        cost: smallest cost that the calibration reached, in the unit of the cost; NaN without calibration.

    >>> str(LiveReport(0.039, 0.04, 120, 240, 0.031))
    '39 ms of 40 ms: 120 of 240 evaluations, cost 0.031'
    >>> LiveReport(0.05, 0.04).is_late
    True
    """

    latency: float = math.nan
    budget: float = math.inf
    evaluations: int = 0
    wanted: int = 0
    cost: float = math.nan

    @property
    def is_late(self) -> bool:
        """Whether the prediction took longer than its budget."""
        return self.latency > self.budget

    def __str__(self) -> str:
        """Return the report as a sentence."""
        if math.isnan(self.latency):
            return "no prediction yet"
        taken = f"{1e3 * self.latency:.3g} ms" + (f" of {1e3 * self.budget:.3g} ms" if self.budget < math.inf else "")
        late = ", too late" if self.is_late else ""
        searched = f": {self.evaluations} of {self.wanted} evaluations, cost {self.cost:.3g}" if self.wanted else ""
        return taken + late + searched


class Live:
    """Predicts a live stream of tracked people.

    People may appear, disappear, be missing for some rows and return. All people in the last row are predicted, and,
    with ``coast``, those hidden since a short time, from the rows in which they were observed. A calibrated crowd
    starts each search from the previous result. Methods may be called from several threads.

    Args:
        predictor: any predictor whose goal does not require the future.
        dt: time between rows of the forecast, and between rows without a time stamp [s].
        observe: number of observed rows; None: as many as the predictor reads (2.8 s for AnchorNet and Anchors), at
            least 8.
        walls: rings ``[N, 2]`` [m] of obstacles.
        seed: random seed.
        coast: how long a hidden person is predicted, at constant velocity [s]. The existence probability in the
            forecast halves every ``coast / 2``; 0: people who are not in the last row are not predicted.
        budget: time for a prediction, in seconds or as a text such as ``"40 ms"``; None: no limit. The calibration of a
            crowd stops in time, and :attr:`report` says what it reached. Its start values are always evaluated.
            Forecasts then depend on the speed of the computer.
        allowed_lateness: how much older than the newest a frame with a time stamp may be, in seconds or as a text such
            as ``"0.3 s"``. Up to it, frames may come in any order; older ones are dropped and counted in
            :attr:`drop_count`.
        max_speed: largest plausible speed of people and robots [m/s]. Whoever is faster between two frames, over more
            than 0.5 m, is a new track from there on; infinity: tracks are never cut, and speeds are not judged.
        frame: name of the fixed coordinate frame of messages, see :meth:`update_from`; None: the first fixed frame
            above that of the first people.
        robot: name of the coordinate frame of the robot, such as ``base_link``, that is added to the people of each
            message as a robot; None: messages bring no robot.
        person_classes: classes of people in messages of detections, in any case of letters.
        pose_covariance: whether the covariance of odometry is added to that of forecasts of people who were seen in
            the frame of a robot, and of the robot itself: then it is the covariance in the fixed frame. A planner of
            the same robot that plans in the frame of its odometry needs it not, since the error is the same for both.
        clock: returns the time [s] that latencies and the budget are measured with.

    Raises:
        InputError: ``dt``, ``budget`` or ``max_speed`` is not above 0, ``observe`` is below 1, ``coast`` or
            ``allowed_lateness`` is negative, a ring of walls is not ``[N, 2]``, ``person_classes`` is a text, or the
            predictor requires the future.

    Warns:
        TrackerWarning: people are so fast that positions are probably not in metres, time stamps are probably not in
            seconds, a track jumps, or a frame is too late; each kind once for a stream. Data are never rescaled.

    >>> from crowdbot.prediction import ConstantVelocity
    >>> live = Live(ConstantVelocity(), dt=0.4)
    >>> live.update([7], [[0.0, 0.0]])
    >>> live.update([7, 9], [[0.4, 0.0], [3.0, 1.0]])
    >>> live.predict(2).position[0, 0, :, 0].round(1).tolist(), live.ids.tolist()
    ([[0.8, 0.0], [1.2, 0.0]], [7, 9])

    Identities of any type and irregular time stamps:

    >>> live = Live(ConstantVelocity(), dt=0.4)
    >>> for now in (0.0, 0.13, 0.21, 0.38, 0.45):
    ...     live.update(["a"], [[now, 0.0]], time=now)
    >>> live.predict(1).position[0, 0, 0].round(2).tolist(), live.ids.tolist()
    ([[0.85, 0.0]], ['a'])
    """

    def __init__(
        self, predictor: Predictor, dt: float, observe: int | None = None, walls: Iterable[ArrayLike] = (),
        seed: int = 0, coast: float = 1.0, budget: float | str | None = None, allowed_lateness: float | str = 0.2,
        max_speed: float = 12.0, frame: str | None = None, robot: str | None = None,
        person_classes: Sequence[str] = PERSON_CLASSES, pose_covariance: bool = True,
        clock: Callable[[], float] = clocks.perf_counter,
    ) -> None:  # fmt: skip
        if not 0.0 < dt < np.inf:
            raise InputError(f"live: dt = {dt} s must be finite and above 0")
        if observe is not None and observe < 1:
            raise InputError(f"live: observe = {observe} rows must be at least 1")
        if not 0.0 <= coast < np.inf:
            raise InputError(f"live: coast = {coast} s must be finite and at least 0")
        time = math.inf if budget is None else parse_seconds(budget, "budget")
        if not time > 0.0:
            raise InputError(f"live: budget = {time:g} s must be above 0; None for no limit")
        lateness = parse_seconds(allowed_lateness, "allowed_lateness")
        if not 0.0 <= lateness < np.inf:
            raise InputError(f"live: allowed_lateness = {lateness:g} s must be finite and at least 0")
        if not max_speed > 0.0:
            raise InputError(f"live: max_speed = {max_speed} m/s must be above 0; infinity for no limit")
        if isinstance(person_classes, str):
            raise InputError(f"live: person_classes = {person_classes!r} must be a list, such as [{person_classes!r}]")
        if not isinstance(predictor, Predictor):
            raise InputError(f"live: {predictor!r} is not a predictor; pass an instance, such as crowdbot.AnchorNet()")
        goal = getattr(predictor, "goal", None)
        if getattr(goal, "knows_future", False):
            raise InputError(
                f"live: {type(goal).__name__} requires the future, which is unknown in live prediction; use"
                " current-direction"
            )
        self.predictor = predictor
        self.dt = dt
        self.observe = max(ROWS, math.ceil(predictor.history / dt - 1e-9) + 1) if observe is None else observe
        self.walls = tuple(_checked_ring(ring) for ring in walls)
        self.coast = coast
        self.budget = time
        self.report = LiveReport(budget=time)
        """What the last call of :meth:`predict` took, and what a calibration reached in this time."""
        self._clock = clock
        self._searched = math.nan  # last reading of the clock by a search
        self._after = math.nan  # time after the search [s]
        self._seed = seed
        self._plausibility = TrackerPlausibility(max_speed)
        self._history = TrackerHistory(dt, self.observe, coast, lateness, self._plausibility)
        self._messages = TrackerMessages(frame, robot, person_classes)
        self._pose_covariance = pose_covariance
        self._memory: Any = None
        self._reading, self._predicting = threading.RLock(), threading.Lock()

    @property
    def drop_count(self) -> int:
        """Number of frames that were dropped because they came later than ``allowed_lateness``."""
        return self._history.drop_count

    @property
    def ids(self) -> NDArray[Any]:
        """Identities of all predicted agents in the order of forecasts, including robots and hidden people."""
        with self._reading:
            labels = self._history.labels(self._history.numbers())
        if all(isinstance(label, int) for label in labels):
            return np.array(labels, dtype=np.int64)
        result = np.empty(len(labels), dtype=object)
        result[:] = labels
        return result

    def update(
        self, ids: Iterable[Hashable], position: ArrayLike, robots: Iterable[Hashable] = (), time: float | None = None,
        covariances: ArrayLike | None = None, radii: ArrayLike | None = None, existence: ArrayLike | None = None,
    ) -> None:  # fmt: skip
        """Add a row: identities ``[N]`` of any hashable type, and positions ``[N, 2]`` [m].

        Args:
            ids: identities, each once; integers of at least 0 are the ids of :meth:`past`, others are numbered in the
                order of arrival. Whole numbers of any type are integers; None, True, False and other floating-point
                numbers are refused.
            position: positions [m], finite.
            robots: identities of robots.
            time: time stamp [s]; None: ``dt`` after the newest one. The observed rows are interpolated to steps of
                ``dt`` before the newest time stamp. A frame that is older than the newest by at most
                ``allowed_lateness`` is put at its time, as if it had come in order; an older one is dropped. Frames
                with equal stamps, as of several cameras, are one frame of all their people; who is in both is where the
                one that came last says.
            covariances: ``[N, 2, 2]`` [m^2] of the positions, NaN where unknown. Kalman filters and the filtered line
                of AnchorNet trust positions accordingly, and covariances of forecasts contain them. Where they are
                unknown, the predictor assumes a noise of its own.
            radii: ``[N]`` [m] of the bodies, NaN where unknown; the last known one counts. Futures of learned
                predictors keep apart by the sum of radii, and crowd models simulate people of these sizes.
            existence: ``[N]`` probability that there is a person, in the sense of a tracker, above 0 and at most 1; NaN
                and None mean 1. It is in the forecast, and decays while a person is hidden.

        Raises:
            InputError: shapes do not match, a position is not finite, an identity is wrong or duplicate, the time stamp
                is not a finite number, a covariance is not symmetric and positive semidefinite, a radius is not
                above 0, or an existence probability is not above 0 and at most 1. The frame then has no effect.

        >>> from crowdbot.prediction import ConstantVelocity
        >>> live = Live(ConstantVelocity(), dt=0.1)
        >>> for stamp in (0.0, 0.1, 0.3, 0.2):  # the last two came in the wrong order
        ...     live.update([7], [[stamp, 0.0]], time=stamp)
        >>> live.past().position[0, :, 0, 0].round(2).tolist()
        [0.0, 0.1, 0.2, 0.3]
        """
        frame = TrackerFrame.of(ids, position, robots, time, covariances, radii, existence)
        with self._reading:
            self._history.add(frame)
        self._warn()

    def update_from(self, message: Any, topic: str = "") -> None:
        """Add a message of ROS 1 or 2: people, odometry or transforms, of rosbags, rclpy or rospy.

        People come as ``people_msgs/People`` or ``PositionMeasurementArray``, ``TrackedPersons`` of pedsim_msgs and
        spencer_tracking_msgs (with covariances), ``pedsim_msgs/AgentStates``, ``hunav_msgs/Agents``, or
        ``vision_msgs/Detection3DArray`` with the id of each person (with covariances and scores). The tag ``radius``
        and a reliability above 0 of ``people_msgs/Person`` are radius and existence probability. People in a
        frame that moves, such as ``base_link``, are brought to the fixed frame by ``nav_msgs/Odometry``, ``/tf`` and
        ``/tf_static``, interpolated at the stamp of the people; they wait until a transform as new as they are comes.

        Args:
            message: the message, with attributes named as its fields.
            topic: its topic; names that end in ``tf_static`` are static transforms.

        Raises:
            InputError: the type is unknown, the message names no frame, no transform joins the frame of the people with
                the fixed frame or there is none at their stamp, too many messages wait, or as :meth:`update`.

        >>> from crowdbot.messages import Messages
        >>> from crowdbot.prediction import ConstantVelocity
        >>> make, live = Messages(), Live(ConstantVelocity(), dt=0.4, robot="robot/base_link")
        >>> for second, x in enumerate((0.0, 1.0)):
        ...     stamp = second * 1_000_000_000
        ...     person = make.make("people_msgs/msg/Person", name="7", position=make.point(3.0, 0.0),
        ...         velocity=make.point(0.0, 0.0), reliability=0.9, tagnames=["radius"], tags=["0.3"])
        ...     live.update_from(make.odometry(stamp, "robot", x, 0.0, 0.0, [1.0, 0.0, 0.0], frame="odom"))
        ...     live.update_from(make.make("people_msgs/msg/People", header=make.header(stamp, "robot/base_link"),
        ...         people=[person]))
        >>> live.ids.tolist(), live.past().position[0, -1].round(2).tolist()
        ([7, 'robot/base_link'], [[4.0, 0.0], [1.0, 0.0]])
        """
        with self._reading:
            for frame in self._messages.add(message, topic):
                self._history.add(frame)
        self._warn()

    def past(self, plans: Mapping[Any, ArrayLike] | None = None) -> Windows:
        """Return the stored rows as one window of all predicted agents."""
        past, _, _ = self._past(plans)
        self._warn()
        return past

    def predict(self, steps: int, samples: int = 1, plans: Mapping[Any, ArrayLike] | None = None) -> Forecast:
        """Return the forecast of all agents of :attr:`ids`, with the existence probability of each.

        Args:
            steps: number of predicted rows of ``dt``.
            samples: number of futures.
            plans: planned positions of robots, identity -> ``[S, 2]`` [m]. A query with a plan does not change the
                memory of the predictor.

        Raises:
            InputError: no row yet, or a plan for an identity that is not predicted.
        """
        with self._predicting:
            begin = self._clock()
            past, rows, count = self._past(plans, required=True)
            rng = stream(self._seed, "live", count)
            limit = self._limit(begin)
            forecast, memory = self.predictor.follow(past, steps, samples, rng, self._memory, limit)
            if not plans:
                self._memory = memory
            self._report(memory, begin)
        self._warn()
        covariance, futures = forecast.covariance, forecast.future_covariance
        if self._pose_covariance and covariance is not None and rows.uncertainty is not None:
            mean = np.einsum("k,ktac->tac", forecast.weight[0], forecast.position[0])
            pose = _placed_covariances(rows.uncertainty, mean)[None]
            covariance = covariance + pose
            futures = None if futures is None else futures + pose[:, None]
        return dataclasses.replace(
            forecast, existence=rows.existence[None], covariance=covariance, future_covariance=futures
        )

    def _warn(self) -> None:
        """Warn the caller of a public method of what is new."""
        with self._reading:
            reports = self._plausibility.take_reports()
        for sentence in reports:
            warnings.warn(sentence, TrackerWarning, stacklevel=3)

    def _limit(self, begin: float) -> TimeLimit | None:
        """Return when a search must stop, so that the prediction after it is ready in time."""
        self._searched = math.nan
        if self.budget == math.inf:
            return None
        planned = SAFETY * self.budget
        own = FIRST_SHARE * planned if math.isnan(self._after) else planned - self._after
        return TimeLimit(begin + own, self._read_clock)

    def _read_clock(self) -> float:
        self._searched = self._clock()
        return self._searched

    def _report(self, memory: Any, begin: float) -> None:
        """Set the report, and what is known of the time after a search."""
        end = self._clock()
        if not math.isnan(self._searched):
            after = end - self._searched
            self._after = after if math.isnan(self._after) else max(after, FORGET * self._after)
        evaluations, wanted, cost = 0, 0, math.nan
        if isinstance(memory, Fit):
            evaluations, cost = int(memory.evaluations.sum()), float(memory.cost.sum())
            wanted = int(getattr(self.predictor, "budget", evaluations))
        self.report = LiveReport(end - begin, self.budget, evaluations, wanted, cost)

    def _past(self, plans: Mapping[Any, ArrayLike] | None, required: bool = False) -> tuple[Windows, TrackedRows, int]:
        """Return the window, its rows and the number of rows so far."""
        with self._reading:
            if required and not self._history.count:
                raise InputError("live: no row yet; call update first")
            rows = self._history.rows()
            count = self._history.count
            known = {self._history.number_of(who): path for who, path in plans.items()} if plans else {}
        nobody = np.zeros((1, len(rows.id)), dtype=np.bool_)
        frame = count - len(rows.position) + np.arange(len(rows.position))
        past = Windows(
            rows.position[None], rows.present[None], nobody, rows.robot[None], rows.id[None], frame[None], self.dt,
            "live", "live stream", self.walls, radius=None if rows.radius is None else rows.radius[None],
            covariance=None if rows.covariance is None else rows.covariance[None],
        )  # fmt: skip
        return (past.with_plans(known) if known else past), rows, count


def _placed_covariances(uncertainty: Floats, position: Floats) -> Floats:
    """Return the covariances ``[T, A, 2, 2]`` [m^2] of positions ``[T, A, 2]`` in frames of uncertain placement.

    The error of a pose is nearly the same in all rows, so it is no noise of the observations: filters would smooth
    turns away. It moves and turns the forecast as a whole.

    Args:
        uncertainty: ``[A, 3, 3]`` covariances of x, y [m] of the origin and yaw [rad].
        position: ``[T, A, 2]`` [m].
    """
    motion = np.zeros((*position.shape[:2], 2, 3))
    motion[..., 0, 0] = motion[..., 1, 1] = 1.0
    motion[..., 0, 2], motion[..., 1, 2] = -position[..., 1], position[..., 0]
    return np.asarray(motion @ uncertainty @ np.swapaxes(motion, -1, -2))


def _checked_ring(ring: ArrayLike) -> NDArray[np.float64]:
    """Return a ring ``[N, 2]`` [m] of walls."""
    try:
        corners = np.array(ring, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"live: a ring of walls must be numbers [N, 2] [m], it is {ring!r}") from None
    if corners.ndim != 2 or corners.shape[1] != 2 or not np.isfinite(corners).all():
        raise InputError(
            f"live: a ring of walls has shape {list(corners.shape)}, it must be finite corners [N, 2] [m]; pass a list"
            " of rings, one for each obstacle"
        )
    return corners


def parse_seconds(value: float | str, name: str) -> float:
    """Return a duration [s] from a number of seconds, or from a text with a unit (s, ms, us, min).

    Raises:
        InputError: the text is no number with a unit.

    >>> parse_seconds("40 ms", "budget"), parse_seconds("0.3s", "budget"), parse_seconds(2, "budget")
    (0.04, 0.3, 2.0)
    """
    if not isinstance(value, str):
        return float(value)
    match = re.fullmatch(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*([a-z]+)\s*", value)
    if match is None or match[2] not in UNITS:
        raise InputError(
            f"live: {name} = {value!r} is no duration; give seconds as a number, or a text with a unit"
            f" ({', '.join(UNITS)}), such as '40 ms'"
        )
    return float(match[1]) * UNITS[match[2]]
