"""Choice of the drive of an imported robot: type, limits and geometry by kind of base."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.world.robots.base_kind import BaseKind, FoundWheel
from crowdbot.world.urdf import RobotModel

from .skid_slide import GRAVITY
from .skid_steer import SHARE, slip_of

WHEELED = ("differential", "skid-steer", "ackermann", "tricycle", "mecanum", "omnidirectional")
"""Kinds whose wheels are turned by motors in the physics world; the others are moved as a planar base."""
FASTEST = 3.0
"""Largest guess of the maximum turn rate [rad/s]."""
PULLED = 1.0
"""Largest acceleration in curves [m/s2] of a base that is moved directly: a quarter of what its forces give. In tighter
curves, bodies on its joints lean out, and their reaction at a stop exceeds the declared turn acceleration."""
RUBBER = 1.0
"""Friction coefficient of rubber on the floor."""
SMOOTH = 0.01
"""Smaller friction coefficients of driven wheels in files are not meant: such wheels would not move the base."""
UPRIGHT = 0.5
"""The same of a base on wheels, as a share of the acceleration at which it would tip over (assumed)."""
FASTEST_SLIDING = 2.0
"""The same for skid-steer bases and omnidirectional wheels, as that of Husky: faster, they slide outwards."""


def turns_wheels(model: RobotModel, base: BaseKind) -> bool:
    """Return whether motors turn the wheels in the physics world.

    Wheels with rollers of their own links, and wheels that all steer, cannot be controlled, and a base on one axle
    without castors falls over unless it balances: these bases are moved directly.
    """
    if base.kind == "differential" and not base.castors and base.wheelbase_of_axles < 0.1 * base.track:
        return False
    driven = [wheel for wheel in base.wheels if wheel.joint in base.driven]
    needed = {"differential": 2, "skid-steer": 4, "mecanum": 4, "omnidirectional": 3}.get(base.kind, 1)
    if base.kind not in WHEELED or len(driven) < needed:
        return False
    if not all(model.links[wheel.link].collisions for wheel in base.wheels):
        return False
    if base.kind in ("mecanum", "omnidirectional"):
        plain = not any(joint.parent in {wheel.link for wheel in driven} for joint in model.movable)
        return plain and (len(driven) == 4 if base.kind == "mecanum" else _star(base) is not None)
    return base.kind != "skid-steer" or base.wheelbase_of_axles > 0.0


def rollers_of(base: BaseKind, wheel: FoundWheel) -> float | None:
    """Return the angle [rad] of the rollers of a wheel from its rolling direction, None without rollers.

    The rollers of mecanum wheels are taken to be in the usual arrangement, see :class:`MecanumDrive`.
    """
    if base.kind == "omnidirectional":
        return 0.0
    if base.kind != "mecanum":
        return None
    centre = np.mean([wheel.center for wheel in base.wheels], axis=0)
    ahead, aside = (wheel.center - centre)[:2].tolist()
    return -math.copysign(math.pi / 4.0, ahead * aside)


def drive_type(base: BaseKind, wheeled: bool) -> str:
    """Return the type of the drive of a base, as in ``robot.xml``."""
    if base.kind in ("ackermann", "tricycle"):
        steered = all(wheel.steering for wheel in base.wheels if wheel.joint in base.driven)
        return "tricycle-drive" if base.kind == "tricycle" and steered else "ackermann-drive"
    if base.kind == "legged":
        return "legged-drive"
    if base.kind in ("mecanum", "omnidirectional"):
        own = "mecanum-drive" if base.kind == "mecanum" else "omni-wheel-drive"
        return own if wheeled else "omnidirectional"
    return "skid-steer-drive" if base.kind == "skid-steer" and wheeled else "differential-drive"


def wheel_attributes(base: BaseKind, track: float, wheeled: bool) -> tuple[list[tuple[str, float, str]], float, float]:
    """Return attributes of a drive that say where its wheels are, rim speed per turn rate [m], and largest turn rate.

    The attributes are name, value and unit; the largest turn rate [rad/s] is a guess.
    """
    most = FASTEST_SLIDING if base.kind in ("skid-steer", "omnidirectional") else FASTEST
    long, star = base.wheelbase_of_axles, _star(base)
    radius = ("wheel_radius", base.wheels[0].radius if base.wheels else 0.0, "m")
    if wheeled and base.kind in ("skid-steer", "mecanum"):
        rows = [("track", track, "m"), ("wheelbase", long, "m"), radius]
        if base.kind == "mecanum":
            return rows, 0.5 * (track + long), most
        rows += [("axles", float(base.axles), "")] if base.axles > 2 else []
        return rows, 0.5 * track * slip_of(track, long, max(base.axles, 2)), most
    if wheeled and base.kind == "omnidirectional" and star is not None:
        count, distance, first = star
        return (
            [("wheels", float(count), ""), ("distance", distance, "m"), ("first_angle", first, "rad"), radius],
            (distance),
            most,
        )
    return [], 0.5 * track, most


def _star(base: BaseKind) -> tuple[int, float, float] | None:
    """Return number, distance [m] and first angle [rad] of wheels at equal angles on a circle; None for others."""
    places = np.array([wheel.center[:2] for wheel in base.wheels])
    if len(places) < 3 or any(wheel.steering for wheel in base.wheels):
        return None
    away = places - (places.mean(axis=0) * (1.0, 0.0))
    distance = np.hypot(away[:, 0], away[:, 1])
    angles = np.sort(np.arctan2(away[:, 1], away[:, 0]))
    gaps = np.diff([*angles, angles[0] + 2.0 * math.pi])
    radial = [
        abs(float(wheel.axle[0] * way[1] - wheel.axle[1] * way[0]))
        for wheel, way in zip(base.wheels, away / distance[:, None].clip(1e-9), strict=True)
    ]
    even = np.ptp(distance) < 0.02 * distance.mean() and np.ptp(gaps) < 0.05
    return (len(places), float(distance.mean()), float(angles[0])) if even and max(radial) < 0.1 else None


def middle_angle(base: BaseKind, inner: float) -> float:
    """Return the maximum steering angle [rad] of the (virtual central) steered wheel; 0 if the limit is useless.

    The inner wheel of a car steers more than the middle: ``cot(middle) = cot(inner) + track / (2 wheelbase)``.

    Args:
        base: wheels and kind of base.
        inner: limit of the steering joints [rad].
    """
    if base.kind == "tricycle":
        return min(inner, math.pi / 2.0 if drive_type(base, True) == "tricycle-drive" else 1.4)
    if not 0.0 < inner < 1.4:
        return 0.0
    sides = [float(wheel.center[1]) for wheel in base.wheels if wheel.steering]
    half = 0.5 * (max(sides) - min(sides)) / base.wheelbase if base.wheelbase else 0.0
    return math.atan(1.0 / (1.0 / math.tan(inner) + half))


def inner_angle(base: BaseKind, middle: float) -> float:
    """Return the angle [rad] of the inner steered wheel at a steering angle [rad] of the (virtual central) wheel.

    It is the inverse of :func:`middle_angle`, at most 1.4 rad for a car.

    Args:
        base: wheels and kind of base.
        middle: steering angle [rad].
    """
    if base.kind == "tricycle":
        return middle
    sides = [float(wheel.center[1]) for wheel in base.wheels if wheel.steering]
    half = 0.5 * (max(sides) - min(sides)) / base.wheelbase if base.wheelbase else 0.0
    return min(1.4, math.atan2(1.0, 1.0 / math.tan(middle) - half))


def tire_friction(model: RobotModel, base: BaseKind) -> float:
    """Return the mean friction coefficient of the driven wheels on the floor, at most that of rubber.

    Files for Gazebo often have coefficients far above 1, which mean that a wheel does not slip.
    """
    driven = [model.links[wheel.link].friction for wheel in base.wheels if wheel.joint in base.driven]
    known = [RUBBER if value is None or value < SMOOTH else min(value, RUBBER) for value in driven]
    return sum(known) / len(known) if known else RUBBER


def mass_attributes(model: RobotModel, base: BaseKind) -> list[tuple[str, float]]:
    """Return place of the wheels and of the centre of mass, and radius of gyration [m], of a skid-steer drive."""
    whole, places = model.inertial(), np.array([wheel.center for wheel in base.wheels])
    x, y = 0.5 * (places[:, :2].min(axis=0) + places[:, :2].max(axis=0))
    floor = min(float(wheel.center[2]) - wheel.radius for wheel in base.wheels)
    half = 0.5 * np.ptp(places[:, :2], axis=0)
    ahead, left = np.clip(whole.center[:2] - (x, y), -half, half).tolist()
    return [
        ("wheels_x", float(x)),
        ("center_x", ahead),
        ("center_y", left),
        ("center_height", max(0.0, float(whole.center[2]) - floor)),
        ("gyration_radius", math.sqrt(float(whole.tensor[2, 2]) / whole.mass)),
    ]


def _axle_share(model: RobotModel, base: BaseKind) -> float:
    """Return the share of the friction of all weight with which the wheels of one axle hold a base in a curve.

    Castors bear a part of the weight, and a centre of mass beside the axle turns the base out of the curve.
    """
    away = float(model.inertial().center[0]) - base.rear
    poses = model.poses()
    reach = max((math.copysign(1.0, away) * (float(poses[name][0, 3]) - base.rear) for name in base.castors), default=0)
    borne = 1.0 - abs(away) / reach if reach > abs(away) else 1.0
    return borne / math.hypot(1.0, 2.0 * away / base.track) if base.track else borne


def curve_limit(model: RobotModel, base: BaseKind, wheeled: bool) -> tuple[float, str]:
    """Return the largest product of speed and turn rate [m/s2] of a differential base, and the reason."""
    if not wheeled:
        return PULLED, "a quarter of the force that moves the base"
    floor = min(wheel.center[2] - wheel.radius for wheel in base.wheels)
    height = float(model.inertial().center[2] - floor)
    tips = UPRIGHT * GRAVITY * 0.5 * base.track / max(height, 1e-3)
    grip = SHARE * tire_friction(model, base) * GRAVITY * _axle_share(model, base)
    if tips < grip:
        return tips, "half of that at which it tips over"
    return grip, f"{SHARE:g} of the friction of {'rubber' if grip == SHARE * GRAVITY else 'its driven wheels'}"
