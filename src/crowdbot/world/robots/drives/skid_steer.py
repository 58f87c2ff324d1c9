"""Skid-steer drive: left and right wheels or tracks at different speeds, which slide sideways in a turn."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import Pose, Twist, check_number
from crowdbot.typing import Floats

from .drive import Twists, integrate_twist
from .skid_slide import GRAVITY, side_speeds
from .wheeled import WheeledDrive

SHARE = 0.4
"""Largest product of speed and turn rate, as a share of friction coefficient times gravity: sliding wheels need the
rest of the friction to turn the base."""
SLIDING = 0.3
"""Smallest lateral slip of a tyre of the first or last axle in a curve, as a share of that on the spot. The curve
shifts the slip of the inner end to 0; tyres that begin to stick there turn the base faster than its wheels say."""
LEAST_SHARE = 0.05
"""Least share for bases that never slide in this way: with the centre of mass above an axle."""


def slip_of(track: float, wheelbase: float, axles: int = 2) -> float:
    """Return the slip factor of a skid-steer base: effective track divided by track.

    At a wheel with the centre ``(+-wheelbase / 2, +-track / 2)`` whose rim runs at the speed ``v``, a base that turns
    at the rate ``w`` slides by ``(v - w track / 2, w wheelbase / 2)``. Coulomb friction opposes the slide. With equal
    loads its moment about the centre is zero for ``w = 2 v / (track (1 + (wheelbase / track)^2))``, whatever the
    friction coefficient and the forward speed. Real controllers have the same factor: 1.5 for Jackal (1.49 here),
    1.875 for Husky (1.80 here). With more axles at equal distances, the moment is zero for another ``w``, found by
    bisection: the wheels of middle axles slide less.

    Source: J. L. Martinez et al., Approximating Kinematics for Tracked Mobile Robots, IJRR 24(10), 2005 (instantaneous
    centres of rotation of the sides); ``wheel_separation_multiplier`` of jackal_control and husky_control.

    >>> round(slip_of(0.3756, 0.262), 2), round(slip_of(0.5708, 0.512), 2), round(slip_of(0.5, 0.6, axles=3), 2)
    (1.49, 1.8, 1.74)
    """
    if axles == 2:
        return 1.0 + (wheelbase / track) ** 2
    places, half = np.linspace(-0.5, 0.5, axles) * wheelbase, 0.5 * track
    low, high = 1.0, 1.0 + (wheelbase / track) ** 2
    for _ in range(50):
        middle = 0.5 * (low + high)
        along = half * (middle - 1.0)
        moment = (half * along - places**2) / np.maximum(np.hypot(along, places), 1e-300)
        low, high = (middle, high) if moment.sum() < 0.0 else (low, middle)
    return 0.5 * (low + high)


@dataclass(frozen=True)
class SkidSteerDrive(WheeledDrive):
    """Skid-steer drive, as in Husky, Jackal and Pioneer 3-AT: four wheels or two tracks that do not steer.

    In a turn the wheels slide sideways, so they run faster than those of a differential drive: by ``slip``, the
    effective track divided by the track. Speeds of the left and right wheels are about
    ``(forward -+ turn * slip * track / 2) / wheel_radius``. The lateral speed of a command is ignored; in a curve, the
    base slides outwards, see :meth:`slide`. A command beyond the limits of wheels or friction is shortened to a slower
    one on the same curve.

    Fields:
        track: distance between the left and right wheels [m].
        wheelbase: distance between the first and the last axle [m].
        axles: number of axles, at equal distances.
        slip: slip factor; 0: :func:`slip_of`.
        friction: friction coefficient of the tyres on the floor.
        wheels_x: middle of the wheels, ahead of the origin of the robot [m].
        center_x, center_y: centre of mass from the middle of the wheels, ahead and to the left [m].
        center_height: height of the centre of mass above the floor [m].
        gyration_radius: radius of gyration about the vertical [m]; 0: that of a box on the wheels.
        max_speed, max_turn_rate, max_acceleration, max_turn_acceleration, wheel_radius, max_wheel_speed: as in
            :class:`WheeledDrive`.

    Raises:
        InputError: a number is not finite, a length or limit is not above 0, ``slip`` is between 0 and 1, or there are
            fewer than two axles.

    >>> from crowdbot.core import Twist
    >>> drive = SkidSteerDrive(track=0.4, wheelbase=0.4, wheel_radius=0.1)
    >>> drive.wheel_speeds(Twist(1.0, 0.5)).round(9).tolist()
    [8.0, 12.0]
    """

    track: float = 0.4
    wheelbase: float = 0.3
    slip: float = 0.0
    friction: float = 1.0
    wheels_x: float = 0.0
    center_x: float = 0.0
    center_y: float = 0.0
    center_height: float = 0.0
    gyration_radius: float = 0.0
    axles: int = 2

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("SkidSteerDrive", "track", self.track, "m", exclusive_min=0.0)
        check_number("SkidSteerDrive", "wheelbase", self.wheelbase, "m", exclusive_min=0.0)
        if self.slip != 0.0:
            check_number("SkidSteerDrive", "slip", self.slip, min=1.0)
        check_number("SkidSteerDrive", "axles", self.axles, min=2)
        check_number("SkidSteerDrive", "friction", self.friction, exclusive_min=0.0)
        for name, most in (("center_x", 0.5 * self.wheelbase), ("center_y", 0.5 * self.track)):
            check_number("SkidSteerDrive", name, getattr(self, name), "m", min=-most, max=most)
        check_number("SkidSteerDrive", "wheels_x", self.wheels_x, "m")
        for name in ("center_height", "gyration_radius"):
            check_number("SkidSteerDrive", name, getattr(self, name), "m", min=0.0)

    @functools.cached_property
    def slip_factor(self) -> float:
        """Effective track divided by the track."""
        return self.slip or slip_of(self.track, self.wheelbase, self.axles)

    @property
    def matrix(self) -> Floats:
        half = 0.5 * self.track * self.slip_factor
        return np.array([[1.0, -half, 0.0], [1.0, half, 0.0]]) / self.wheel_radius

    def slide(self, before: Twists, after: Twists, dt: float) -> Floats:
        """Return the speeds ``[E, 3]`` [m/s] of the left and right rims, and of the middle of the wheels to the left.

        They are those at which the friction forces of the tyres give the base its acceleration: Coulomb's law against
        the slip of each tyre, with its load. If the forces do not suffice, the base has no lateral speed, and the rims
        have the speeds for equal loads.

        Args:
            before, after: twists before and after a time step; of ``after``, the lateral speed is not used.
            dt: time step [s].

        Source: J. Y. Wong and C. F. Chiang, A general theory for skid steering of tracked vehicles on firm ground,
        Proc. IMechE D 215, 2001.

        >>> drive, turning = SkidSteerDrive(track=0.4, wheelbase=0.4), Twists.of(Twist(0.0, 1.0), 1)
        >>> drive.slide(turning, turning, 0.05).round(3).tolist()
        [[-0.4, 0.4, 0.0]]
        """
        out, middle = np.empty((len(after.turn), 3)), before.left + before.turn * self.wheels_x
        body = np.array([self.friction * GRAVITY, self.center_height, self._gyration])
        old = np.stack([before.forward, before.turn, middle], axis=1)
        new = np.stack([after.forward, after.turn], axis=1)
        side_speeds(old, new, float(dt), self._tires, body, out)
        return out

    @property
    def _gyration(self) -> float:
        """Squared radius of gyration [m2]."""
        return self.gyration_radius**2 or (self.wheelbase**2 + self.track**2) / 12.0

    @functools.cached_property
    def _tires(self) -> Floats:
        """Places, shares of the weight and levers of the tyres ``[W, 5]``; see :func:`slide_of`.

        A given slip factor shortens or lengthens the wheelbase.
        """
        long = self.wheelbase * math.sqrt(
            (self.slip_factor - 1.0) / (slip_of(self.track, self.wheelbase, self.axles) - 1.0)
        )
        rows = [(x * long, y * self.track) for x in np.linspace(0.5, -0.5, self.axles) for y in (0.5, -0.5)]
        place = np.array(rows)
        balance = np.concatenate([np.ones((1, len(place))), place.T])
        load = np.linalg.pinv(balance) @ np.array([1.0, self.center_x, self.center_y])
        load = np.maximum(load, 0.0) / np.maximum(load, 0.0).sum()
        return np.concatenate([place, load[:, None], place - (self.center_x, self.center_y)], axis=1)

    @functools.cached_property
    def curve_share(self) -> float:
        """Largest product of speed and turn rate, as a share of friction coefficient times gravity: at most 0.4, and
        so small that all tyres slide sideways in the curve.

        >>> drives = [SkidSteerDrive(track=0.4, wheelbase=0.4, center_x=x) for x in (0.0, 0.05)]
        >>> [round(drive.curve_share, 2) for drive in drives]
        [0.27, 0.06]
        """
        low, high = 0.0, SHARE
        for _ in range(12):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self._slides_in_curve(middle) else (low, middle)
        return max(low, LEAST_SHARE)

    def _slides_in_curve(self, share: float) -> bool:
        """Return whether all tyres slide sideways in a steady curve with this product of speed and turn rate."""
        turn = 1.0
        ahead = share * self.friction * GRAVITY / turn
        before = Twists(np.array([ahead]), np.array([turn]), np.zeros(1))
        aside = float(self.slide(before, before, 1e6)[0, 2])
        ends = self._tires[np.abs(self._tires[:, 0]) > 0.49 * np.ptp(self._tires[:, 0]), 0]
        on_spot = 0.5 * float(np.ptp(ends)) * turn
        return bool((np.abs(aside + turn * ends) >= SLIDING * on_spot).all())

    def step(self, pose: Pose, twist: Twists, command: Twist | Twists, dt: float) -> tuple[Pose, Twists]:
        count = len(pose.heading)
        wanted, still = Twists.of(command, count), np.zeros(count)
        bend = np.abs(wanted.forward * np.clip(wanted.turn, -self.max_turn_rate, self.max_turn_rate))
        share = np.minimum(1.0, np.sqrt(self.curve_share * self.friction * GRAVITY / np.maximum(bend, 1e-300)))
        slower = Twists(wanted.forward * share, wanted.turn * share, still)
        _, after = super().step(pose, Twists(twist.forward, twist.turn, still), slower, dt)
        left = self.slide(twist, after, dt)[:, 2] - after.turn * self.wheels_x
        left[(after.forward == 0.0) & (after.turn == 0.0)] = 0.0  # tyres that stand do not creep
        after = Twists.of_columns(np.stack([after.forward, after.turn, left]))
        return integrate_twist(pose, after, dt), after
