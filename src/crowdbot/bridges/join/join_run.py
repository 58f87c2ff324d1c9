"""JoinRun: a trial in real time in which a real robot drives among simulated people."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from crowdbot.bridges.bridge_run import BridgeRun
from crowdbot.bridges.clock import BridgeClock
from crowdbot.bridges.transport import Transport
from crowdbot.core import InputError, did_you_mean
from crowdbot.navigation import ExternalNavigator
from crowdbot.simulation import Order, OrderSource, RobotPoseOrder
from crowdbot.trials import RobotPose, Trial

from .command_guard import CommandGuard
from .join_port import JoinPort


def joined_trial(trial: Trial, robot: str = "") -> Trial:
    """Return the trial with a robot that a real one moves.

    Args:
        trial: the trial.
        robot: name of the robot; empty: the only one.

    Raises:
        InputError: there is no such robot, or several and none is named.

    >>> from crowdbot.trials import load_trial
    >>> joined_trial(load_trial("frontal")).robots[0].pose.source
    'external'
    """
    names = [one.name for one in trial.robots]
    if not robot and len(names) != 1:
        raise InputError(f"trial {trial.name!r} has {len(names)} robots; name one of {', '.join(names) or 'none'}")
    chosen = robot or names[0]
    if chosen not in names:
        raise InputError(f"trial {trial.name!r} has no robot {chosen!r}{did_you_mean(chosen, names)}")
    pose = RobotPose(source="external")
    changes: dict[str, Any] = {"navigator": ExternalNavigator(), "pose": pose, "safety": None, "deadline": None}
    robots = tuple(dataclasses.replace(one, **changes) if one.name == chosen else one for one in trial.robots)
    return dataclasses.replace(trial, robots=robots)


class _Watch:
    """Passes on the orders of a source, and notes the poses of the robot in them."""

    def __init__(self, source: OrderSource, port: JoinPort) -> None:
        self.source, self.port = source, port

    def orders(self, simulation: Any) -> list[Order]:
        """Return the orders of the source."""
        found = list(self.source.orders(simulation))
        for one in found:
            if isinstance(one, RobotPoseOrder) and one.robot == self.port.robot.name:
                self.port.note_pose(one.x, one.y, one.heading)
        return found


class JoinRun(BridgeRun):
    """Runs a trial in real time with a real robot, see :class:`JoinPort`.

    Args:
        trial: the trial, see :func:`joined_trial`.
        transports: connections to the robot and its software.
        guard: emergency stop and limits.
        robot: name of the robot; empty: the only one.
        odometry, command: topics of the real robot.
        seed, out, force, note: as in :func:`crowdbot.bridges.run_bridge`.
        sources: motion capture that moves the robot, instead of its odometry, or people.

    Raises:
        InputError: the robot does not exist.
    """

    port: JoinPort

    def __init__(
        self,
        trial: Trial,
        transports: Sequence[Transport],
        guard: CommandGuard,
        robot: str = "",
        odometry: str = "/odom",
        command: str = "/cmd_vel",
        seed: int | None = None,
        out: Path | str | None = None,
        force: bool = False,
        note: Callable[[str], None] | None = None,
        sources: Sequence[OrderSource] = (),
    ) -> None:
        trial = joined_trial(trial, robot)
        super().__init__(trial, transports, seed, out, BridgeClock(), force, note)
        spec = next(one for one in trial.robots if one.name == (robot or trial.robots[0].name))
        self.port = JoinPort(trial, transports, spec, guard, odometry, command, self.note)
        self.port.control = self.control
        self.sources = self.port.captures = [_Watch(one, self.port) for one in sources]

    def remarks(self) -> list[str]:
        """Return lines for people: latencies and stops."""
        known, guard = self.port.latency, self.port.guard
        found = [
            f"{known.poses} poses of the robot, age median {1e3 * known.pose_age[0]:.1f} ms, p99"
            f" {1e3 * known.pose_age[1]:.1f} ms" if known.poses else "no odometry of the robot",
            f"{known.commands} commands passed on after {1e3 * known.command_delay[0]:.2f} ms (median),"
            f" {1e3 * known.command_delay[1]:.2f} ms (99 %)" if known.commands else "no commands",
        ]  # fmt: skip
        return found + [f"stopped: {one}" for one in guard.stops if one != "the run has ended"]
