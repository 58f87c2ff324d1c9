"""Manoeuvres of the drive laboratory: commands over time."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

from crowdbot.core import Twist
from crowdbot.world import AckermannDrive, Drive, Omnidirectional, Robot

from .traces import SAMPLE

HOLD = 2.0
"""Time [s] for which a speed of the grid is held after it is reached in the plane, and for standing after the stop."""


@dataclass(frozen=True)
class Manoeuvre:
    """Commands over time.

    Fields:
        name: ``grid``, ``straight``, ``sine``, ``ramp``, ``weave`` or ``slip``.
        commands: command of each sample.
        held: number of samples until the order to stop; all if there is none.
        friction: friction coefficient of the floor.
    """

    name: str
    commands: tuple[Twist, ...]
    held: int
    friction: float = 1.0


def speed_grid(drive: Drive, quick: bool = False) -> list[Twist]:
    """Return the speeds of the grid: shares of the largest speed and turn rate, without rest.

    Omnidirectional drives also go sideways and diagonally. Cars do not turn on the spot.

    >>> from crowdbot.world import DifferentialDrive
    >>> len(speed_grid(DifferentialDrive())), len(speed_grid(DifferentialDrive(), quick=True))
    (24, 3)
    """
    top, most = float(getattr(drive, "max_speed", 1.0)), float(getattr(drive, "max_turn_rate", 1.0))
    if quick:
        shares = [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    else:
        levels = (-1.0, -0.5, 0.0, 0.5, 1.0)
        shares = [(v, w) for v, w in itertools.product(levels, levels) if v or w]
    found = [Twist(v * top, w * most) for v, w in shares if v or not isinstance(drive, AckermannDrive)]
    if isinstance(drive, Omnidirectional):
        found += [Twist(0.0, 0.0, left=top), Twist(0.5 * top, 0.5 * most, left=-0.5 * top)]
    return found


def manoeuvres(robot: Robot, quick: bool = False) -> list[Manoeuvre]:
    """Return the manoeuvres of a robot.

    Each speed of the grid is a step from rest, held, and a stop. ``straight`` is full speed for a while; ``ramp`` a
    slow increase of speed; ``sine`` a turn rate like a sine at half speed; ``weave`` sudden swerves at full speed;
    ``slip`` the same as ``weave`` on a floor with a tenth of the friction.

    >>> from crowdbot.world import Robot
    >>> [one.name for one in manoeuvres(Robot.load("differential"), quick=True)]
    ['grid', 'grid', 'grid', 'straight', 'ramp', 'sine', 'weave', 'slip']
    """
    drive = robot.drive
    top, most = float(getattr(drive, "max_speed", 1.0)), float(getattr(drive, "max_turn_rate", 1.0))
    reach = _reach(drive)
    found = [_held("grid", twist, reach + robot.latency + HOLD, reach + HOLD) for twist in speed_grid(drive, quick)]
    long = 2.0 if quick else 10.0
    found.append(_held("straight", Twist(top, 0.0), long, reach + HOLD))
    found.append(_timed("ramp", long, lambda t: Twist(top * t / long, 0.0)))
    found.append(_timed("sine", long, lambda t: Twist(0.5 * top, 0.5 * most * math.sin(0.5 * math.pi * t))))
    swerves = _timed("weave", long, lambda t: Twist(top, most * (0.5 if int(t) % 2 else -0.5)))
    found.append(swerves)
    found.append(Manoeuvre("slip", swerves.commands, swerves.held, 0.1))
    return found


def _reach(drive: Drive) -> float:
    """Return the time [s] in which any speed of a drive is reached from rest."""
    push, spin = getattr(drive, "max_acceleration", math.inf), getattr(drive, "max_turn_acceleration", math.inf)
    lag = 5.0 * getattr(drive, "time_constant", 0.0)
    bend = getattr(drive, "max_steering", 0.0) / getattr(drive, "max_steering_rate", 1.0)
    top, most = getattr(drive, "max_speed", 0.0), getattr(drive, "max_turn_rate", 0.0)
    return float(max(top / push, most / spin, bend) + lag)


def _held(name: str, twist: Twist, held: float, still: float) -> Manoeuvre:
    count = round(held / SAMPLE)
    return Manoeuvre(name, (*[twist] * count, *[Twist()] * round(still / SAMPLE)), count)


def _timed(name: str, duration: float, at: Callable[[float], Twist]) -> Manoeuvre:
    count = round(duration / SAMPLE)
    return Manoeuvre(name, tuple(at(k * SAMPLE) for k in range(count)), count)
