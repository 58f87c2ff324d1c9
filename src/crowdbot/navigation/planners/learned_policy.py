"""Learned navigators: networks whose velocities are realised within the limits of the drive, and the learned policy."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Paper, Twist, check_number
from crowdbot.navigation.batch_rows import drive_numbers, rows_for_kernels
from crowdbot.navigation.dynamic_window import dynamic_window_twists
from crowdbot.navigation.goal_motion import holonomic_twists
from crowdbot.navigation.navigator import BatchKernels, Navigator
from crowdbot.navigation.observation import Observation
from crowdbot.navigation.observation_batch import AgentsInView, ObservationBatch
from crowdbot.navigation.wall_arrays import wall_arrays
from crowdbot.typing import Bools, Floats

from .policy_kernels import OWN_VALUES, PERSON_VALUES, apply_network, avoid_contacts, limit_velocities, write_inputs
from .policy_weights import NetworkWeights, PolicyWeights, read_layers

MOST_PEOPLE = 20
"""Number of nearest people that the policy knows."""


class PolicyInputs(NamedTuple):
    """Inputs of the policy in N environments, in the goal frame: x towards the waypoint.

    Fields:
        axis: ``[N, 2]`` x axis of the goal frame, in the world.
        own: ``[N, F]`` values of the robot.
        people: ``[N, K, G]`` values of the nearest people, nearest first.
        present: ``[N]`` number of people.
    """

    axis: Floats
    own: Floats
    people: Floats
    present: NDArray[np.int64]


def policy_inputs(
    batch: ObservationBatch, most: int = MOST_PEOPLE, asking: NDArray[np.bool_] | None = None, speed: float = np.inf
) -> PolicyInputs:
    """Return the inputs of the policy for N observations.

    Args:
        batch: what the robot knows in N environments.
        most: number K of people.
        asking: ``[N]`` environments to fill; default all.
        speed: largest speed [m/s], limited by the drive.

    >>> from crowdbot.navigation import DriveLimits
    >>> batch = ObservationBatch(pose=np.zeros((2, 3)), goal=np.array([[4.0, 0.0], [0.0, 4.0]]),
    ...     radius=np.full(2, 0.3), limits=DriveLimits(1.0, 2.0), dt=0.1)
    >>> policy_inputs(batch).axis.tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    N, people = len(batch), batch.people
    inputs = PolicyInputs(
        np.tile([1.0, 0.0], (N, 1)),
        np.zeros((N, len(OWN_VALUES))),
        np.zeros((N, most, len(PERSON_VALUES))),
        np.zeros(N, dtype=np.int64),
    )
    write_inputs(
        np.ones(N, np.bool_) if asking is None else asking,
        batch.pose, batch.goal, batch.waypoint, batch.twist, batch.radius, min(speed, batch.limits.max_speed),
        people.position, people.velocity, people.radius, people.seen, *inputs,
    )  # fmt: skip
    return inputs


def goal_frame_twists(
    batch: ObservationBatch,
    asking: NDArray[np.bool_],
    axis: Floats,
    shares: Floats,
    out: Floats,
    speed: float = np.inf,
    horizon: float = 0.0,
    margin: float = 0.15,
) -> None:
    """Write the twists ``[N, 3]`` of velocities in the goal frame, within the limits of the drive.

    Args:
        batch: what the robot knows in N environments.
        asking: ``[N]`` rows to fill.
        axis: ``[N, 2]`` x axis of the goal frame, in the world.
        shares: ``[N, 2]`` velocities as shares of the maximum speed; they become velocities in the world [m/s].
        out: ``[N, 3]`` twists.
        speed: largest speed [m/s], limited by the drive.
        horizon, margin: see :class:`LearnedNavigator`.

    >>> from crowdbot.navigation import DriveLimits
    >>> batch = ObservationBatch(pose=np.zeros((1, 3)), goal=np.array([[0.0, 4.0]]), radius=np.full(1, 0.3),
    ...     limits=DriveLimits(1.0, 2.0, holonomic=True), dt=0.1)
    >>> out, aside = np.zeros((1, 3)), np.array([[0.5, 0.0]])
    >>> goal_frame_twists(batch, np.ones(1, np.bool_), np.array([[0.0, 1.0]]), aside, out)
    >>> out.round(2).tolist()
    [[0.05, 2.0, 0.5]]
    """
    numbers = drive_numbers(batch.limits, speed)
    limit_velocities(asking, batch.pose, batch.goal, batch.waypoint, axis, numbers, shares)
    if not batch.limits.holonomic or len(wall_arrays(batch.walls).segments):
        dynamic_window_twists(batch, asking, shares, speed, out)
        return
    if horizon > 0.0:
        people = batch.people
        avoid_contacts(
            asking, batch.pose, batch.radius, people.position, people.velocity, people.radius, people.seen,
            float(numbers[0]), horizon, margin, shares,
        )  # fmt: skip
    holonomic_twists(asking, batch.pose, shares, numbers, float(batch.dt), out)


@dataclass(frozen=True)
class LearnedNavigator(Navigator):
    """A network that returns a velocity in the goal frame, in a batch of environments.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        horizon: time for which people are expected to walk straight [s]; 0: the velocity of the network is not changed.
        margin: clearance to people that is kept for this time [m].
        file: file of weights from ``examples/train_navigator.py``, in a trial relative to its folder (default: the
            weights of the package).

    Raises:
        InputError: a number is out of its range.
    """

    file_parameters = ("file",)
    network: ClassVar[type[NetworkWeights]]
    """Layers of the network."""

    speed: float = 1.0
    horizon: float = 1.0
    margin: float = 0.15
    file: str = ""

    def __post_init__(self) -> None:
        kind = type(self).__name__
        check_number(kind, "speed", self.speed, "m/s", exclusive_min=0.0)
        check_number(kind, "horizon", self.horizon, "s", min=0.0)
        check_number(kind, "margin", self.margin, "m", exclusive_min=0.0)

    def check_files(self) -> None:
        read_layers(self.network, self.file)

    @abstractmethod
    def shares(self, batch: ObservationBatch, asking: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        """Return the x axis of the goal frame ``[N, 2]`` and the velocities in it ``[N, 2]``.

        Velocities are shares of the maximum speed; only rows of asking environments count.
        """

    def act(self, observation: Observation) -> Twist:
        out, asking = np.zeros((1, 3)), np.ones(1, np.bool_)
        self._move(as_batch(observation), asking, out)
        return Twist(*out[0].tolist())

    def _kernels(self) -> BatchKernels | None:
        return self._decided if self._keeps(LearnedNavigator, "act") else None

    def _decided(self, batch: ObservationBatch, out: Floats) -> Bools:
        """Write the twists of the environments with regular values, and return which they are."""
        asking = rows_for_kernels(batch, with_people=True)
        if asking.any():
            self._move(batch, asking, out)
        return asking

    def _move(self, batch: ObservationBatch, asking: NDArray[np.bool_], out: Floats) -> None:
        """Write the twists ``[N, 3]`` of the asking environments."""
        axis, shares = self.shares(batch, asking)
        goal_frame_twists(batch, asking, axis, shares, out, self.speed, self.horizon, self.margin)


@dataclass(frozen=True)
class PolicyNavigator(LearnedNavigator):
    """Moves as a small neural network that was trained in simulated crowds by reinforcement learning.

    The network knows the nearest 20 people within 10 m, with their velocities and radii, and returns a velocity; with
    nobody there, the robot goes straight. It is invariant to rotations and to the order of people. A velocity that
    would bring the robot closer than a margin to a person who keeps walking straight is replaced by a near one that
    does not. The network does not know walls: with walls, or with a drive that cannot move sideways,
    :func:`dynamic_window_twist` selects a twist near its velocity.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        horizon: time for which people are expected to walk straight [s]; 0: the velocity of the network is not changed.
        margin: clearance to people that is kept for this time [m].
        file: file of weights from ``examples/train_navigator.py``, in a trial relative to its folder (default: the
            weights of the package).

    Sources: proximal policy optimisation, Schulman et al. 2017, https://arxiv.org/abs/1707.06347; inputs in the goal
    frame, Chen et al. 2019, doi:10.1109/ICRA.2019.8794134.

    Raises:
        InputError: a number is out of its range.

    >>> from crowdbot.navigation import DriveLimits
    >>> limits = DriveLimits(1.0, 2.0, holonomic=True)
    >>> here = Observation(pose=(0.0, 0.0, 0.0), goal=(0.0, 4.0), radius=0.3, limits=limits, dt=0.25)
    >>> PolicyNavigator().act(here).left > 0.5
    True
    """

    paper: ClassVar[Paper] = Paper(
        "Schulman et al.", 2017, "Proximal policy optimization algorithms", "arXiv", "10.48550/arXiv.1707.06347"
    )
    network = PolicyWeights
    always_returns = True

    def shares(self, batch: ObservationBatch, asking: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        inputs, shares = policy_inputs(batch, MOST_PEOPLE, asking, self.speed), np.zeros((len(batch), 2))
        layers: Any = read_layers(self.network, self.file)
        apply_network(asking, inputs.own, inputs.people, inputs.present, shares, *layers)
        shares[inputs.present == 0] = (1.0, 0.0)  # towards the waypoint
        return inputs.axis, shares


def as_batch(observation: Observation) -> ObservationBatch:
    """Return one observation as a batch, without its readings and tracks.

    >>> from crowdbot.navigation import DriveLimits
    >>> here = Observation(pose=(0.0, 0.0, 0.0), goal=(0.0, 4.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.25)
    >>> len(as_batch(here))
    1
    """
    people, count = observation.people, len(observation.people)
    seen = AgentsInView(
        people.position.reshape(1, count, 2),
        people.velocity.reshape(1, count, 2),
        people.radius.reshape(1, count),
        np.ones((1, count), np.bool_),
        people.ids.reshape(1, count),
    )
    return ObservationBatch(
        pose=np.array([observation.pose], np.float64),
        goal=np.array([observation.goal], np.float64),
        waypoint=np.array([observation.waypoint], np.float64),
        twist=np.array([observation.twist], np.float64),
        radius=np.array([observation.radius], np.float64),
        limits=observation.limits,
        dt=float(observation.dt),
        time=np.array([observation.time], np.float64),
        people=seen,
        walls=observation.walls,
    )
