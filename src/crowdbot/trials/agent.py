"""Agents and avatars: single people of a trial, who follow the crowd model or a pose that comes from outside."""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.core import InputError, UnreadableValue, find_class, sources_of
from crowdbot.core.fields import NAME, Points, attribute, check, children, quote_value

from .files.trial_files import read_beside, resolve_file
from .human_kinds import ABOUT_ACTIVITY, ABOUT_BODY, check_words
from .robots.behavior import BehaviorSpec
from .robots.reaction import ReactionSpec, check_shares

if TYPE_CHECKING:
    from crowdbot.humans import BodyPose, PoseSource, PoseTrack


MOST_BYTES = 64 << 20
"""Largest size of a file of poses [bytes]."""


@dataclass(frozen=True)
class AgentParameter:
    """A parameter of the crowd model for one person.

    >>> AgentParameter("time-horizon", 1.5).value
    1.5
    """

    name: str = attribute(about="name of a parameter of the crowd model")
    value: float = attribute(about="value for this person")

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, kw_only=True)
class Agent:
    """One person. A person without a goal and a journey stays in place.

    Raises:
        InputError: a value is not allowed.

    >>> Agent(x=1, y=2, goal="8,0", speed=1.3).goal
    ((8.0, 0.0),)
    """

    name: str = attribute("", about="name for messages")
    x: float = attribute(about="start x", unit="m")
    y: float = attribute(about="start y", unit="m")
    heading: float | None = attribute(
        None, about="start heading, counter-clockwise from +x (default: towards the goal)", unit="rad"
    )
    goal: Points = attribute(Points(), about="goal point x,y; not with a journey", unit="m", points=1)
    goal_zone: Points = attribute(Points(), about="corners x,y of the goal zone", unit="m")
    journey: str = attribute("", about="name of the journey; not with a goal")
    speed: float = attribute(1.34, about="preferred speed", unit="m/s", exclusive_min=0.0, max=10.0)
    radius: float = attribute(0.2, about="radius of the body", unit="m", exclusive_min=0.0, max=5.0)
    arrival: str = attribute("leave", about="behaviour at the goal", choices=("leave", "stay"))
    crowd: str = attribute("", about="name of the crowd (default: the first)")
    group: int = attribute(-1, about="number of the group, -1 for none", min=-1, max=1e6)
    body: str = attribute("", about=ABOUT_BODY)
    outfit: int | None = attribute(None, about="number of the appearance (clothes and colours)", min=0, max=1e6)
    activity: str = attribute("", about=ABOUT_ACTIVITY)
    parameters: tuple[AgentParameter, ...] = children("parameter", about="model parameters of this person", max=100)
    reactions: tuple[ReactionSpec, ...] = children("reaction", about="reactions to robots (default: none)", max=50)
    behaviors: tuple[BehaviorSpec, ...] = children("behavior", about="behaviour trees (default: none)", max=50)

    def __post_init__(self) -> None:
        check(self)
        check_words(self.body, self.activity)
        check_shares(self.reactions, self.behaviors)

    @property
    def count(self) -> int:
        """Number of people: 1."""
        return 1

    @property
    def position(self) -> tuple[float, float]:
        """Start ``x, y`` [m]."""
        return self.x, self.y

    @property
    def facing(self) -> float:
        """Heading at the start [rad]; NaN means towards the goal."""
        if self.heading is None:
            return math.nan if self.goal or self.journey else 0.0
        return self.heading


@dataclass(frozen=True, kw_only=True)
class Avatar:
    """A person whose pose comes from outside: from a file of poses, a function of time, or a program that sends orders.

    Crowd, sensors and physics see an avatar where its source says. The crowd model does not move it, contacts do not
    displace it, and it never leaves. Head and hands are reached by inverse kinematics; legs walk with the gait.

    Raises:
        InputError: a value is not allowed.

    >>> guide = Avatar(name="guide", source="external", x=1, y=2)
    >>> guide.pose_source().at(0.0).x, guide.timeout
    (1.0, 0.25)
    """

    name: str = attribute(about="name for orders and messages", pattern=NAME)
    source: str = attribute(about="where the pose comes from", choices=("file", "function", "external"))
    file: str = attribute("", about="file of poses beside the trial: CSV or .jsonl", pattern=r"[^\x00]{0,500}")
    function: str = attribute(
        "", about="address of a PoseSource class, such as wave.py:Wave", pattern=r"([^\x00]{1,500}:[A-Za-z_]\w*)?"
    )
    x: float | None = attribute(None, about="start x of an external avatar", unit="m")
    y: float | None = attribute(None, about="start y of an external avatar", unit="m")
    heading: float = attribute(0.0, about="start heading of an external avatar", unit="rad")
    begin: float = attribute(0.0, about="time in the file at which the trial begins", unit="s", min=0.0)
    delay: float = attribute(0.0, about="delay of the avatar behind its source", unit="s", min=0.0, max=10.0)
    timeout: float = attribute(
        0.25,
        about="longest time after the last sample of an external avatar with its last velocity; it stands afterwards",
        unit="s",
        min=0.0,
        max=10.0,
    )
    max_speed: float = attribute(
        8.0, about="speed between two samples above which the avatar teleports", unit="m/s", exclusive_min=0.0, max=12.0
    )
    part_timeout: float = attribute(
        0.0,
        about="longest time for which head, hands and skeleton keep their latest sample while others lack them",
        unit="s",
        min=0.0,
        max=10.0,
    )
    headset: bool = attribute(True, about="whether a participant in a headset can move an external avatar")
    picture_delay: float = attribute(
        0.0, about="added delay of the picture in the headset of the participant", unit="s", min=0.0, max=2.0
    )
    noise: float = attribute(
        0.0, about="standard deviation of noise added to each coordinate that a headset measures", unit="m", min=0.0,
        max=1.0,
    )  # fmt: skip
    radius: float = attribute(0.25, about="radius of the body", unit="m", exclusive_min=0.0, max=5.0)
    height: float | None = attribute(None, about="stature (default: that of the body)", unit="m", min=0.5, max=2.5)
    body: str = attribute("", about=ABOUT_BODY)
    outfit: int | None = attribute(None, about="number of the appearance (clothes and colours)", min=0, max=1e6)
    folder: Path | None = dataclasses.field(default=None, compare=False, repr=False)
    trust: bool = dataclasses.field(default=True, compare=False, repr=False)
    """Folder of the file or code, and whether it may lie outside; not part of the XML."""

    def __post_init__(self) -> None:
        check(self)
        check_words(self.body, "")
        for name in ("file", "function"):
            given, needs = getattr(self, name), self.source == name
            if needs and not given:
                raise InputError(f'source="{name}" needs the attribute {name}')
            if given and not needs:
                raise InputError(f'{name}={quote_value(given)} needs source="{name}", not source="{self.source}"')
        if self.source == "external" and (self.x is None or self.y is None):
            raise InputError('source="external" needs x and y: the place before the first order')
        if self.source != "external" and (self.picture_delay or self.noise):
            raise InputError(f'picture-delay and noise need source="external" (a headset), not source="{self.source}"')
        if self.source != "external" and not (self.x is None and self.y is None):
            raise InputError(f'x and y need source="external"; here the {self.source} gives the place')

    def pose_source(self) -> PoseSource:
        """Return the source of the pose; a file is read once.

        Raises:
            InputError: the file or the code cannot be read.
            UnreadableValue: code is only described, not run.
        """
        from crowdbot.humans import BodyPose, PoseTrack

        if self.source == "external":
            start = BodyPose(self.x or 0.0, self.y or 0.0, self.heading)  # both are given, see __post_init__
            parts = self.part_timeout
            return PoseTrack.of(
                [], [], start=start, extrapolation=self.timeout, max_speed=self.max_speed, part_timeout=parts
            )
        if self.source == "function":
            cls: Any = find_pose_source(self.function, self.folder, self.trust)
            try:
                made: PoseSource = cls()
            except TypeError as error:
                raise InputError(f"{self.function} must be made without arguments: {error}") from None
            return made
        path = resolve_file(self.file, self.folder, self.trust)
        track = load_poses(path, self.file, self.begin, self.max_speed)
        return dataclasses.replace(track, part_timeout=self.part_timeout) if self.part_timeout else track

    def start_pose(self) -> BodyPose:
        """Return the pose at the beginning of the trial; errors as for :meth:`pose_source`."""
        from crowdbot.humans import BodyPose

        source = self.pose_source()
        try:
            return BodyPose.of_row(source.motion(-self.delay).row)
        except (InputError, UnreadableValue):
            raise
        except Exception as error:  # code of the user
            raise InputError(f"{self.function} fails at 0 s: {type(error).__name__}: {error}") from None

    @property
    def position(self) -> tuple[float, float]:
        """Start ``x, y`` [m]."""
        pose = self.start_pose()
        return pose.x, pose.y

    def files(self) -> tuple[Path, ...]:
        """Return the file of poses, or the files of the code."""
        if self.source == "file":
            return (resolve_file(self.file, self.folder, self.trust),)
        return sources_of(find_pose_source(self.function, self.folder, self.trust)) if self.source == "function" else ()


def find_pose_source(address: str, folder: Path | None, trust: bool) -> type:
    """Return the :class:`crowdbot.humans.PoseSource` at an address; errors as for :func:`crowdbot.core.find_class`."""
    from crowdbot import humans

    return find_class(address, humans, humans.PoseSource, folder=folder, trust=trust)


def load_poses(path: Path, name: str, begin: float, max_speed: float) -> PoseTrack:
    """Return the poses of a file, which is read again only if it has changed; see ``read_pose_file``."""
    stamp = path.stat()
    return _load(path, stamp.st_mtime_ns, stamp.st_size, name, begin, max_speed)


@functools.lru_cache(maxsize=8)
def _load(path: Path, changed: int, size: int, name: str, begin: float, max_speed: float) -> PoseTrack:
    from crowdbot.humans import read_pose_file

    return read_pose_file(read_beside(path, MOST_BYTES), name, begin=begin, max_speed=max_speed)
