"""Pose of a robot that comes from outside: from a file, a function, or a program that sends orders."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.core import InputError, UnreadableValue, sources_of
from crowdbot.core.fields import attribute, check, quote_value
from crowdbot.navigation import ExternalNavigator, Navigator
from crowdbot.trials.agent import find_pose_source, load_poses
from crowdbot.trials.files.trial_files import resolve_file

if TYPE_CHECKING:
    from crowdbot.humans import BodyPose, PoseSource


SAME = 0.01
"""Tolerance of a start [m] and [rad]."""


@dataclass(frozen=True, kw_only=True)
class RobotPose:
    """Where a robot is over time, as for an :class:`Avatar`: it is mirrored, its drive and navigator do not move it.

    Of each pose, ``x``, ``y`` and ``heading`` are used. In the physics world the base is kinematic: contacts do not
    move it, and what it touches feels its speed.

    Raises:
        InputError: a value is not allowed.

    >>> RobotPose(source="external").source_from(1.0, 2.0, 0.0).at(0.0).x
    1.0
    """

    source: str = attribute(about="where the pose comes from", choices=("file", "function", "external"))
    file: str = attribute("", about="file of poses beside the trial: CSV or .jsonl", pattern=r"[^\x00]{0,500}")
    function: str = attribute(
        "", about="address of a PoseSource class, such as tour.py:Tour", pattern=r"([^\x00]{1,500}:[A-Za-z_]\w*)?"
    )
    begin: float = attribute(0.0, about="time in the file at which the trial begins", unit="s", min=0.0)
    delay: float = attribute(0.0, about="delay of the robot behind its source", unit="s", min=0.0, max=10.0)
    timeout: float = attribute(
        0.25,
        about="longest time after the last sample of an external pose with its last velocity; it stands afterwards",
        unit="s",
        min=0.0,
        max=10.0,
    )
    max_speed: float = attribute(
        8.0, about="speed between two samples above which the robot teleports", unit="m/s", exclusive_min=0.0, max=12.0
    )
    folder: Path | None = dataclasses.field(default=None, compare=False, repr=False)
    trust: bool = dataclasses.field(default=True, compare=False, repr=False)
    """Folder of the file or code, and whether it may lie outside; not part of the XML."""

    def __post_init__(self) -> None:
        check(self)
        for name in ("file", "function"):
            given, needs = getattr(self, name), self.source == name
            if needs and not given:
                raise InputError(f'source="{name}" needs the attribute {name}')
            if given and not needs:
                raise InputError(f'{name}={quote_value(given)} needs source="{name}", not source="{self.source}"')

    def source_from(self, x: float, y: float, heading: float) -> PoseSource:
        """Return the source of the pose of a robot that starts at a place [m] and heading [rad]; a file is read once.

        Raises:
            InputError: the file or the code cannot be read.
            UnreadableValue: code is only described, not run.
        """
        from crowdbot.humans import BodyPose, PoseTrack

        if self.source == "external":
            start = BodyPose(x, y, heading)
            track = PoseTrack.of([], [], start=start, extrapolation=self.timeout, max_speed=self.max_speed)
            return dataclasses.replace(track, turning=True)
        if self.source == "function":
            cls: Any = find_pose_source(self.function, self.folder, self.trust)
            try:
                made: PoseSource = cls()
            except TypeError as error:
                raise InputError(f"{self.function} must be made without arguments: {error}") from None
            return made
        path = resolve_file(self.file, self.folder, self.trust)
        return load_poses(path, self.file, self.begin, self.max_speed)

    def files(self) -> tuple[Path, ...]:
        """Return the file of poses, or the files of the code."""
        if self.source == "file":
            return (resolve_file(self.file, self.folder, self.trust),)
        if self.source == "function":
            return sources_of(find_pose_source(self.function, self.folder, self.trust))
        return ()


def mirrored_pose(pose: RobotPose | None, navigator: Navigator) -> RobotPose | None:
    """Return where a robot is over time if its drive does not move it: what is given, or samples of a real robot."""
    if pose is None and isinstance(navigator, ExternalNavigator) and navigator.mirrors:
        return RobotPose(source="external")
    return pose


def start_problem(robot: Any) -> Iterator[tuple[Any, str]]:
    """Yield why the source of the pose of a robot of a trial gives none, or begins elsewhere than the robot."""
    pose: RobotPose | None = robot.pose
    if pose is None:
        return
    try:
        start = _start(robot, pose)
    except UnreadableValue:
        raise
    except InputError as error:
        yield pose, f"{pose.source}={quote_value(getattr(pose, pose.source))} {error}"
        return
    turn = (start.heading - robot.heading + math.pi) % (2.0 * math.pi) - math.pi
    if math.hypot(start.x - robot.x, start.y - robot.y) > SAME or abs(turn) > SAME:
        yield (
            robot,
            f'starts at x="{robot.x:g}" y="{robot.y:g}" heading="{robot.heading:g}", but its pose begins elsewhere;'
            f' write x="{start.x:.6g}" y="{start.y:.6g}" heading="{start.heading:.6g}"',
        )


def _start(robot: Any, pose: RobotPose) -> BodyPose:
    from crowdbot.humans import BodyPose

    source = pose.source_from(robot.x, robot.y, robot.heading)
    try:
        return BodyPose.of_row(source.motion(-pose.delay).row)
    except InputError:
        raise
    except Exception as error:  # code of the user
        raise InputError(f"{pose.function} fails at 0 s: {type(error).__name__}: {error}") from None
