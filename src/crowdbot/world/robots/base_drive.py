"""Choice of the drive of an imported robot: type, limits and geometry by kind of base."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from crowdbot.world.urdf import RobotModel

from .base_kind import BaseKind, FoundWheel
from .skid_steer import slip_of

__all__ = ["DriveChoice", "choose_drive", "rollers_of", "turns_wheels"]

WHEELED = ("differential", "skid-steer", "ackermann", "tricycle", "mecanum", "omnidirectional")
"""Kinds whose wheels are turned by motors in the physics world; the others are moved as a planar base."""
USUAL_RATE = 10.0
"""Guess of the maximum speed of a wheel [rad/s]."""
FASTEST = 3.0
"""Largest guess of the maximum turn rate [rad/s]."""
FASTEST_SLIDING = 2.0
"""The same for skid-steer bases and omnidirectional wheels, as that of Husky: faster, they slide outwards."""


class DriveChoice(NamedTuple):
    """Type of a drive, and its attributes: name, value and source."""

    drive: str
    rows: tuple[tuple[str, float, str], ...]


def turns_wheels(model: RobotModel, base: BaseKind) -> bool:
    """Return whether motors turn the wheels in the physics world.

    Wheels with rollers of their own links, and wheels that all steer, cannot be controlled: these bases are moved
    directly.
    """
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
    centre = np.mean([one.center for one in base.wheels], axis=0)
    ahead, aside = (wheel.center - centre)[:2].tolist()
    return -math.copysign(math.pi / 4.0, ahead * aside)


def choose_drive(model: RobotModel, base: BaseKind, given: Mapping[str, float], wheeled: bool) -> DriveChoice:
    """Return the drive of a base.

    Args:
        model: the robot.
        base: its wheels and kind.
        given: values of the drive plugin of the file.
        wheeled: whether motors turn the wheels in the physics world.
    """
    rows: list[tuple[str, float, str]] = []

    def choose(key: str, guess: float, why: str) -> float:
        value, source = (given[key], "the drive plugin") if key in given else (guess, why)
        rows.append((key.replace("_", "-"), value, source))
        return value

    radius = base.wheels[0].radius if base.wheels else 0.0
    limits = [model.joints[name].motor.velocity for name in base.driven]
    rates = [v for v in limits if math.isfinite(v) and v > 0.0]
    fastest = min(rates) if rates and 0.05 <= min(rates) * radius <= 5.0 else 0.0
    guess = min(1.0, USUAL_RATE * radius) if radius else 1.0
    why = "joint limits" if fastest else (f"guess: {USUAL_RATE:g} rad/s of the wheels" if radius else "guess")
    speed = choose("max_speed", fastest * radius or guess, why)
    choose("max_acceleration", 1.0, "guess")
    if base.kind in ("ackermann", "tricycle"):
        angle, source = _steering_limit(model, base)
        choose("max_steering", angle, source)
        choose("max_steering_rate", 1.0, "guess")
        rows.append(("wheelbase", base.wheelbase or given.get("wheelbase", 0.6), "places of the wheels"))
        steered = all(wheel.steering for wheel in base.wheels if wheel.joint in base.driven)
        drive = "tricycle-drive" if base.kind == "tricycle" and steered else "ackermann-drive"
        return DriveChoice(drive, tuple(rows))
    track = base.track or given.get("track", 0.5)
    geometry = _geometry(base, track) if wheeled else {}
    reach = geometry.pop("reach", 0.5 * track)
    highest = FASTEST_SLIDING if base.kind in ("skid-steer", "omnidirectional") else FASTEST
    turning = min(speed / reach, highest) if reach > 0.025 else 1.5
    turn = choose("max_turn_rate", turning, "speed and places of the wheels" if base.track else "guess")
    choose("max_turn_acceleration", 3.0, "guess")
    if base.kind == "legged":
        choose("max_side_speed", 0.5 * speed, "guess: half of the maximum speed")
    rows += [(key, value, "places of the wheels") for key, value in geometry.items()]
    if geometry:
        rows.append(("wheel-radius", radius, "shape of the wheels"))
        need = (speed + turn * reach) / radius * (math.sqrt(2.0) if base.kind == "mecanum" else 1.0)
        rows.append(("max-wheel-speed", fastest or need, "joint limits" if fastest else "speed and turn rate"))
    return DriveChoice(_drive_type(base, wheeled), tuple(rows))


def _drive_type(base: BaseKind, wheeled: bool) -> str:
    if base.kind == "legged":
        return "legged-drive"
    if base.kind in ("mecanum", "omnidirectional"):
        own = "mecanum-drive" if base.kind == "mecanum" else "omni-wheel-drive"
        return own if wheeled else "omnidirectional"
    return "skid-steer-drive" if base.kind == "skid-steer" and wheeled else "differential-drive"


def _geometry(base: BaseKind, track: float) -> dict[str, float]:
    """Return the attributes of a drive that say where its wheels are, and their ``reach``: rim speed per turn rate."""
    if base.kind == "skid-steer":
        long = base.wheelbase_of_axles
        return {"track": track, "wheelbase": long, "reach": 0.5 * track * slip_of(track, long)}
    if base.kind == "mecanum":
        long = base.wheelbase_of_axles
        return {"track": track, "wheelbase": long, "reach": 0.5 * (track + long)}
    star = _star(base) if base.kind == "omnidirectional" else None
    if star is None:
        return {}
    count, distance, first = star
    return {"wheels": float(count), "distance": distance, "first-angle": first, "reach": distance}


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


def _steering_limit(model: RobotModel, base: BaseKind) -> tuple[float, str]:
    """Return the maximum steering angle [rad] of the (virtual central) steered wheel, and where it is from.

    The inner wheel of a car steers more than the middle: ``cot(middle) = cot(inner) + track / (2 wheelbase)``.
    """
    steered = [wheel for wheel in base.wheels if wheel.steering]
    limits = [min(model.joints[one.steering].upper, -model.joints[one.steering].lower) for one in steered]
    inner = min([value for value in limits if value > 0.05], default=0.0)
    if base.kind == "tricycle":
        return (min(inner, math.pi / 2.0), "joint limits") if inner else (1.2, "guess")
    if not 0.0 < inner < 1.4:
        return 0.6, "guess"
    sides = [float(wheel.center[1]) for wheel in steered]
    half = 0.5 * (max(sides) - min(sides)) / base.wheelbase if base.wheelbase else 0.0
    return math.atan(1.0 / (1.0 / math.tan(inner) + half)), "joint limits of the inner wheel"
