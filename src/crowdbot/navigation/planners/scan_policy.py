"""A learned navigator that knows only scans: surfaces around the robot in the last 0.6 s, its goal and its twist."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Paper, Twist, Walls, check_number, kernel
from crowdbot.navigation.action import Action
from crowdbot.navigation.dynamic_window import STANDARD, dynamic_window_twist
from crowdbot.navigation.goal_motion import STANDING, direction_to, holonomic_twists, turn_towards
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import DriveLimits, Observation, VisiblePeople
from crowdbot.sensors import Scan
from crowdbot.typing import Floats

from .policy_kernels import apply_layer, avoid_contacts, limit_velocities
from .policy_weights import NetworkWeights, Singles, dense_layers, read_layers

SCAN_SECTORS = 90
"""Number of directions of the resampled scans, equally spaced around the robot."""
LONGEST = 6.0
"""Ranges are limited to it [m]."""
SCAN_LAGS = (0.0, 0.3, 0.6)
"""Ages of the scans that the network knows [s]."""
SPACING = 0.05
"""Smallest time between two remembered scans [s]."""
SCAN_VALUES = (
    "waypoint_distance", "goal_distance", "vx", "vy", "heading_cos", "heading_sin", "turn", "max_speed", "radius",
    "holonomic",
)  # fmt: skip
"""Inputs about the robot, in the goal frame: origin at the robot, x axis towards the waypoint."""
WIDE = 0.5
"""Largest half angle that one return covers [rad]."""
KERNEL, SCAN_STRIDES, SCAN_CHANNELS = 5, (2, 3), (16, 32)
"""Width of both convolutions, their strides and their channels."""
SCAN_LAYERS = (96, 64)
"""Widths of the layers after the convolutions."""

Memory = tuple[tuple[float, Floats], ...]
"""Times and surface points of the remembered scans, oldest first; see :func:`surface_points`."""


class ScanInputs(NamedTuple):
    """Inputs of the network in one environment.

    Fields:
        axis: ``[2]`` x axis of the goal frame, in the world.
        own: ``[F]`` SCAN_VALUES.
        sectors: ``[3, 90]`` nearness of surfaces in the scans of SCAN_LAGS, seen from where the robot is now: 1 at the
            robot, 0 from 6 m on and where nothing is known. Sector k is around ``-pi + 2 pi (k + 0.5) / 90`` in the
            goal frame.
    """

    axis: Floats
    own: Floats
    sectors: Floats


def surface_points(scan: Scan) -> Floats:
    """Return the ends of the beams ``[M, 3]`` in the world, x, y and half of the distance to the next beam [m].

    Beams without a return, or with an invalid range, are left out.

    >>> from crowdbot.core import Pose, Scene
    >>> from crowdbot.sensors import Lidar2D
    >>> scene = Scene.of([[3.0, 0.0]], radius=0.5)
    >>> surface_points(Lidar2D(rays=4).read(scene, Pose.of((0.0, 0.0), 0.0))).round(3).tolist()
    [[2.5, 0.0, 1.963]]
    """
    ranges, angles = scan.ranges[0], scan.angles
    step = float(angles[1] - angles[0]) if len(angles) > 1 else 2.0 * math.pi / SCAN_SECTORS
    valid = np.isfinite(ranges)
    ends = scan.points()[0][valid, :2]
    return np.column_stack([ends, 0.5 * abs(step) * ranges[valid]])


def remember_scan(memory: Memory, time: float, points: Floats) -> Memory:
    """Return the memory with a newer scan; scans that are too old or too close in time are forgotten."""
    kept = [scan for scan in memory if time - scan[0] <= SCAN_LAGS[-1] + 2.0 * SCAN_LAGS[1]]
    if len(kept) > 1 and kept[-1][0] - kept[-2][0] < SPACING:
        del kept[-1]
    return (*kept, (time, points))


def scan_inputs(
    pose: Floats, goal: Floats, waypoint: Floats, twist: Floats, radius: float, limits: DriveLimits, memory: Memory,
    time: float,
) -> ScanInputs:  # fmt: skip
    """Return the inputs of the network.

    Args:
        pose: ``[3]`` x, y [m] and heading [rad].
        goal, waypoint: ``[2]`` [m].
        twist: ``[3]`` forward [m/s], turn [rad/s], left [m/s].
        radius: radius of the robot [m].
        limits: limits of the drive.
        memory: remembered scans.
        time: now [s].

    >>> points = np.array([[2.0, 0.0, 0.01]])
    >>> found = scan_inputs(np.zeros(3), np.array([4.0, 0.0]), np.array([4.0, 0.0]), np.zeros(3), 0.3,
    ...     DriveLimits(1.0, 2.0), ((0.0, points),), 0.0)
    >>> np.flatnonzero(found.sectors[0]).tolist(), found.axis.tolist()
    ([44, 45], [1.0, 0.0])
    """
    axis, own, sectors = np.zeros(2), np.zeros(len(SCAN_VALUES)), np.zeros((len(SCAN_LAGS), SCAN_SECTORS))
    _write_own(pose, goal, waypoint, twist, radius, limits.max_speed, float(limits.holonomic), axis, own)
    for row, lag in zip(sectors, SCAN_LAGS, strict=True):
        if memory:
            points = min(memory, key=lambda scan: abs(time - scan[0] - lag))[1]
            _write_sectors(pose, axis, points, radius, row)
    return ScanInputs(axis, own, sectors)


def drive_twist(velocity: Floats, heading: float, limits: DriveLimits, dt: float) -> Floats:
    """Return the twist ``[3]`` of a drive that shall move with a velocity.

    A drive that moves sideways takes the velocity and turns towards it. Another one turns towards it, on the spot if
    its direction is more than 60 degrees away.

    Args:
        velocity: ``[2]`` in the world [m/s].
        heading: heading of the robot [rad].
        limits: limits of the drive.
        dt: time until the next decision [s].

    >>> drive_twist(np.array([0.0, 0.5]), 0.0, DriveLimits(1.0, 2.0), 0.1).tolist()
    [0.0, 2.0, 0.0]
    """
    out = np.zeros((1, 3))
    numbers = np.array(limits[:4])
    if limits.holonomic:
        holonomic_twists(np.ones(1, np.bool_), np.array([[0.0, 0.0, heading]]), velocity[None], numbers, dt, out)
    else:
        _turn_and_go(velocity, heading, numbers, out[0])
    return np.asarray(out[0])


@dataclass(frozen=True)
class ScanPolicyWeights(NetworkWeights):
    """Layers of the navigator ``scan-policy``: two circular convolutions of the sectors, then three dense layers."""

    navigator: ClassVar[str] = "scan-policy"
    training: ClassVar[str] = "examples/train_scan_navigator.py"
    widths: ClassVar[Mapping[str, tuple[int, int]]] = {
        "scan1": (len(SCAN_LAGS) * KERNEL, SCAN_CHANNELS[0]),
        "scan2": (SCAN_CHANNELS[0] * KERNEL, SCAN_CHANNELS[1]),
    } | dense_layers(
        "action",
        SCAN_SECTORS // SCAN_STRIDES[0] // SCAN_STRIDES[1] * SCAN_CHANNELS[1] + len(SCAN_VALUES),
        *SCAN_LAYERS,
        2,
    )

    scan1_weight: Singles
    scan1_bias: Singles
    scan2_weight: Singles
    scan2_bias: Singles
    action1_weight: Singles
    action1_bias: Singles
    action2_weight: Singles
    action2_bias: Singles
    action3_weight: Singles
    action3_bias: Singles


@dataclass(frozen=True)
class ScanPolicyNavigator(Navigator):
    """Moves as a small neural network that knows only the scans of the last 0.6 s, the goal and its own motion.

    It knows no people and no walls. The returns of the main scanner, now and 0.3 and 0.6 s ago, are seen from where
    the robot is now, as 90 directions around it up to 6 m; directions that the scanner does not cover are free. Two
    convolutions and three layers return a velocity in the frame of the waypoint, and the drive follows it. Before the
    first scan the robot stands.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        horizon: time for which the velocity is checked against the surfaces of the newest scan, as if they stayed where
            they are [s]: a near velocity, or for a drive that cannot move sideways a near twist, without contact
            replaces it; 0: the drive follows the network.
        margin: clearance that is kept to them for this time [m].
        file: file of weights from ``examples/train_scan_navigator.py``, in a trial relative to its folder (default:
            the weights of the package).

    Sources: Long et al. 2018, doi:10.1109/ICRA.2018.8461113; Fan et al. 2020, doi:10.1177/0278364920916531.

    Raises:
        InputError: a number is out of its range, or the file has no weights of this network.

    >>> ScanPolicyNavigator().begin(None)
    ()
    """

    paper: ClassVar[Paper] = Paper(
        "Long et al.",
        2018,
        "Towards optimally decentralized multi-robot collision avoidance via deep reinforcement learning",
        "ICRA",
        "10.1109/ICRA.2018.8461113",
    )
    network: ClassVar[type[NetworkWeights]] = ScanPolicyWeights
    file_parameters = ("file",)
    needs_scan: ClassVar[bool] = True
    always_returns = True

    speed: float = 1.0
    horizon: float = 0.5
    margin: float = 0.1
    file: str = ""

    def __post_init__(self) -> None:
        check_number("ScanPolicyNavigator", "speed", self.speed, "m/s", exclusive_min=0.0)
        check_number("ScanPolicyNavigator", "horizon", self.horizon, "s", min=0.0)
        check_number("ScanPolicyNavigator", "margin", self.margin, "m", exclusive_min=0.0)

    def check_files(self) -> None:
        read_layers(self.network, self.file)

    def begin(self, observation: Observation) -> Memory:
        return ()

    def act(self, observation: Observation, memory: Memory) -> tuple[Action, Memory]:
        scan = observation.scan
        if isinstance(scan, Scan):
            taken = float(np.max(scan.time))
            if not memory or taken > memory[-1][0]:
                memory = remember_scan(memory, taken, surface_points(scan))
        if not memory:
            return Action(Twist()), memory
        places = (observation.pose, observation.waypoint, observation.goal)
        pose, waypoint, goal = (np.array(place, np.float64) for place in places)
        limits = observation.limits._replace(max_speed=min(self.speed, observation.limits.max_speed))
        inputs = scan_inputs(
            pose, goal, waypoint, np.array(observation.twist), observation.radius, limits, memory, observation.time
        )
        velocity, one = np.zeros((1, 2)), np.ones(1, np.bool_)
        layers: Any = read_layers(self.network, self.file)
        _apply_network(inputs.own, inputs.sectors, velocity[0], *layers)
        limit_velocities(one, pose[None], goal[None], waypoint[None], inputs.axis[None], np.array(limits[:4]), velocity)
        if self.horizon > 0.0:
            return Action(self._checked(observation, limits, memory[-1][1], velocity)), memory
        return Action(Twist(*drive_twist(velocity[0], pose[2], limits, observation.dt).tolist())), memory

    def _checked(self, observation: Observation, limits: DriveLimits, points: Floats, velocity: Floats) -> Twist:
        """Return a twist near a velocity ``[1, 2]`` that meets none of the surfaces, if they stay."""
        reach = observation.radius + self.margin + limits.max_speed * self.horizon + 0.5
        place, seen = np.zeros((SCAN_SECTORS, 2)), np.zeros(SCAN_SECTORS, np.bool_)
        _nearest_points(np.array(observation.pose[:2]), points, reach, place, seen)
        near = VisiblePeople(place[seen], np.zeros((int(seen.sum()), 2)), np.full(int(seen.sum()), POINT))
        if not limits.holonomic:
            known = dataclasses.replace(
                observation, people=near, walls=_NO_WALLS, limits=limits, tracks=None, predictor=None
            )
            caution = STANDARD._replace(look=self.horizon, margin=self.margin)
            return dynamic_window_twist(known, tuple(velocity[0].tolist()), limits.max_speed, caution)
        avoid_contacts(
            np.ones(1, np.bool_), np.array([observation.pose]), np.array([observation.radius]), near.position[None],
            near.velocity[None], near.radius[None], np.ones((1, len(near)), np.bool_), limits.max_speed, self.horizon,
            self.margin, velocity,
        )  # fmt: skip
        return Twist(*drive_twist(velocity[0], observation.heading, limits, observation.dt).tolist())


POINT = 0.02
"""Radius of a surface point in the check [m]."""
_NO_WALLS = Walls.of()


@kernel
def _write_own(
    pose: Floats, goal: Floats, waypoint: Floats, twist: Floats, radius: float, top: float, holonomic: float,
    axis: Floats, own: Floats,
) -> None:  # fmt: skip
    """Write the x axis of the goal frame and SCAN_VALUES."""
    dx, dy = waypoint[0] - pose[0], waypoint[1] - pose[1]
    away = math.sqrt(dx * dx + dy * dy)
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    ax, ay = cos, sin
    if away > 1e-6:
        ax, ay = dx / away, dy / away
    axis[0], axis[1] = ax, ay
    gx, gy = goal[0] - waypoint[0], goal[1] - waypoint[1]
    vx, vy = cos * twist[0] - sin * twist[2], sin * twist[0] + cos * twist[2]
    own[0], own[1] = min(away, 10.0) / 5.0, min(away + math.sqrt(gx * gx + gy * gy), 10.0) / 5.0
    own[2], own[3] = ax * vx + ay * vy, ax * vy - ay * vx
    own[4], own[5] = ax * cos + ay * sin, ax * sin - ay * cos
    own[6], own[7], own[8], own[9] = twist[1], top, radius, holonomic


@kernel
def _write_sectors(pose: Floats, axis: Floats, points: Floats, radius: float, out: Floats) -> None:
    """Write the nearness of the surface points in the sectors ``[90]`` of the goal frame: of the nearest in each."""
    step = 2.0 * math.pi / SCAN_SECTORS
    for m in range(len(points)):
        dx, dy = points[m, 0] - pose[0], points[m, 1] - pose[1]
        away = math.sqrt(dx * dx + dy * dy)
        if not away < LONGEST:
            continue
        angle = math.atan2(axis[0] * dy - axis[1] * dx, axis[0] * dx + axis[1] * dy) + math.pi
        half = min(points[m, 2] / max(away, 0.05), WIDE)
        gap = max(away - radius, 0.0)
        nearness = (1.0 / (1.0 + gap) - 1.0 / (1.0 + LONGEST)) * (1.0 + LONGEST) / LONGEST
        for k in range(math.floor((angle - half) / step), math.floor((angle + half) / step) + 1):
            out[k % SCAN_SECTORS] = max(out[k % SCAN_SECTORS], nearness)


@kernel
def _nearest_points(place: Floats, points: Floats, reach: float, out: Floats, seen: NDArray[np.bool_]) -> None:
    """Write the nearest surface point of each sector around a place that is within reach [m]."""
    step, nearest = 2.0 * math.pi / SCAN_SECTORS, np.full(SCAN_SECTORS, reach)
    for m in range(len(points)):
        dx, dy = points[m, 0] - place[0], points[m, 1] - place[1]
        away = math.sqrt(dx * dx + dy * dy)
        k = math.floor((math.atan2(dy, dx) + math.pi) / step) % SCAN_SECTORS
        if away < nearest[k]:
            nearest[k], out[k, 0], out[k, 1], seen[k] = away, points[m, 0], points[m, 1], True


@kernel
def _turn_and_go(velocity: Floats, heading: float, limits: Floats, out: Floats) -> None:
    """Write the twist of a drive that cannot move sideways; limits are speed, turn rate and their accelerations."""
    speed = min(math.sqrt(velocity[0] * velocity[0] + velocity[1] * velocity[1]), limits[0])
    if speed > STANDING:
        angle = direction_to(0.0, 0.0, heading, velocity[0], velocity[1])
        out[0] = speed * max(0.0, 2.0 * math.cos(angle) - 1.0)
        out[1] = turn_towards(angle, limits[1], limits[3])


@kernel
def _convolve(values: Floats, stride: int, weight: Floats, bias: Floats, patch: Floats, out: Floats) -> None:
    """Write a circular convolution ``[N / stride, D]`` of values ``[N, C]`` with rectification; weight [5 C, D]."""
    N, C = values.shape
    for j in range(len(out)):
        for i in range(KERNEL):
            patch[i * C : (i + 1) * C] = values[(j * stride + i - KERNEL // 2) % N]
        apply_layer(patch, KERNEL * C, weight, bias, True, out[j])


@kernel
def _apply_network(
    own: Floats, sectors: Floats, out: Floats,
    w1: Floats, b1: Floats, w2: Floats, b2: Floats, w3: Floats, b3: Floats, w4: Floats, b4: Floats,
    w5: Floats, b5: Floats,
) -> None:  # fmt: skip
    """Write the output ``[2]`` of the network: a velocity in the goal frame, as shares of the maximum speed."""
    N = sectors.shape[1]
    first = np.empty((N // SCAN_STRIDES[0], len(b1)))
    second = np.empty((len(first) // SCAN_STRIDES[1], len(b2)))
    values = np.ascontiguousarray(sectors.T)
    _convolve(values, SCAN_STRIDES[0], w1, b1, np.empty(len(w1)), first)
    _convolve(first, SCAN_STRIDES[1], w2, b2, np.empty(len(w2)), second)
    flat = np.empty(len(w3))
    flat[: second.size] = second.ravel()
    flat[second.size :] = own
    third, fourth = np.empty(len(b3)), np.empty(len(b4))
    apply_layer(flat, len(flat), w3, b3, True, third)
    apply_layer(third, len(third), w4, b4, True, fourth)
    apply_layer(fourth, len(fourth), w5, b5, False, out)
