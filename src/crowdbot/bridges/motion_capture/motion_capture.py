"""Motion capture in a simulation: recorded or live motion of people."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from crowdbot.core import InputError, did_you_mean, read_bytes, wrap_angle
from crowdbot.humans import BodyPose, PoseTrack, RestSkeleton, rest_skeleton
from crowdbot.simulation import AvatarOrder, Order, RobotPoseOrder
from crowdbot.trials import Trial, people_appearance

from .motion_files import read_bvh, read_csv, read_mvnx
from .natnet import NatNetStream
from .pose_stream import MotionSample, PoseStream, ServerStream
from .retargeting import FootLock, Retargeting, SourceSkeleton, rotate_about, yaw_of
from .vrpn import VrpnStream
from .xsens import PORT as XSENS_PORT
from .xsens import XsensStream

AHEAD = 9.0
"""A time stamp that is further ahead [s] is not given: the clocks of sender and simulation are not related yet."""
EARLY = 1e-6
"""Tolerance [s] of time stamps."""


@dataclass(frozen=True)
class MotionBinding:
    """A subject of a stream and the avatar or mirrored robot that it moves.

    Fields:
        target: name of an avatar or robot of the trial.
        subject: name of the subject in the stream; empty: the first one.
        x, y, heading: place of the origin of the motion capture system in the trial [m], [rad].

    Raises:
        InputError: a number is not finite.
    """

    target: str
    subject: str = ""
    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0

    def __post_init__(self) -> None:
        if not all(math.isfinite(item) and abs(item) <= 1e5 for item in (self.x, self.y, self.heading)):
            raise InputError(f"the origin {self.x:g}, {self.y:g}, {self.heading:g} of {self.target!r} must be finite")


class MotionCapture:
    """Moves people and robots of a trial by a stream of poses. It is an :class:`crowdbot.simulation.OrderSource`.

    A skeleton moves the whole body of an avatar, scaled to its proportions; a rigid body moves the avatar, which then
    walks with its gait. A robot is where a rigid body, or the pelvis of a skeleton, is. Every step gives at most one
    order for each binding, which is recorded: the episode replays without the motion capture system.

    Args:
        stream: the motion capture system or recording, open.
        bindings: who moves whom.

    >>> from crowdbot.bridges.motion_capture import MotionBinding, MotionCapture, open_stream
    >>> with open_stream("xsens:0") as stream:
    ...     MotionCapture(stream, [MotionBinding("guide")]).unbound(("guide", "robot"))
    ()
    """

    def __init__(self, stream: PoseStream, bindings: Sequence[MotionBinding]) -> None:
        self.stream, self.bindings = stream, tuple(bindings)
        self.refused, self.reason = 0, ""
        """Number of samples that are no pose of a person, and why the last one is not."""
        self._fits: dict[str, tuple[SourceSkeleton, FootLock]] = {}
        self._bodies: dict[str, RestSkeleton] = {}
        self._ready = False

    def __enter__(self) -> MotionCapture:
        """Start the stream."""
        self.stream.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop the stream."""
        self.stream.__exit__(kind, error, trace)

    def unbound(self, names: Sequence[str]) -> tuple[str, ...]:
        """Return the targets that are not among some names."""
        return tuple(binding.target for binding in self.bindings if binding.target not in names)

    def check(self, trial: Trial) -> None:
        """Raise :class:`InputError` if a target is not an external avatar or mirrored robot of the trial."""
        mirrors = [(robot.name, robot.mirror) for robot in trial.robots]
        robots = [name for name, mirror in mirrors if mirror is not None and mirror.source == "external"]
        avatars = [avatar.name for avatar in trial.avatars if avatar.source == "external"]
        known = [*avatars, *robots]
        for name in self.unbound(known):
            raise InputError(
                f'trial {trial.name!r} has no avatar {name!r} with source="external" and no robot {name!r} with'
                f' <pose source="external"/>{did_you_mean(name, known)}; it has {", ".join(known) or "none"}'
            )

    def remarks(self) -> list[str]:
        """Return a line for each binding: number and rate of its samples, losses, and how old they were when used."""
        result = []
        latency = self.stream.latency()
        for binding in self.bindings:
            known = self.stream.statistics(binding.subject)
            parts = [f"{known.samples} samples", f"{known.rate:.1f} Hz"]
            if self.stream.live:
                parts += [f"{known.lost} lost", f"{known.refused} datagrams refused"]
            if latency is not None:
                parts.append(f"age median {1e3 * latency[0]:.1f} ms, p99 {1e3 * latency[1]:.1f} ms")
            reason = known.reason or self.reason
            refused = f"; {self.refused} are no pose" if self.refused else ""
            result.append(f"{binding.target}: {', '.join(parts)}{refused}{f' ({reason})' if reason else ''}")
        return result

    def orders(self, simulation: Any) -> list[Order]:
        """Return the poses for this step."""
        if not self._ready:
            self.check(simulation.trial)
            self._bodies, self._ready = _avatar_bodies(simulation), True
        now = float(simulation.world.times[0])
        ahead = now + float(simulation.trial.step)
        result: list[Order] = []
        for binding in self.bindings:
            samples = self.stream.read(binding.subject, now, ahead)
            samples = [(time, item) for time, item in samples if time <= now + AHEAD]
            if not samples:
                continue
            try:
                result.append(self._order(binding, samples, ahead))
            except InputError as error:  # for instance an actor far below the floor
                self.refused, self.reason = self.refused + 1, str(error)
        return result

    def _order(self, binding: MotionBinding, samples: list[tuple[float, MotionSample]], ahead: float) -> Order:
        poses = [self._pose(binding, sample) for _, sample in samples]
        time, pose = samples[-1][0], poses[-1]
        if len(samples) > 1 and samples[0][0] <= ahead + EARLY and ahead <= time:
            time, pose = ahead, PoseTrack.of([item for item, _ in samples], poses).at(ahead)
        how: dict[str, Any] = {"time": round(time, 6), "x": pose.x, "y": pose.y, "heading": pose.heading}
        if binding.target in self._bodies:
            return AvatarOrder(avatar=binding.target, skeleton=pose.skeleton, source="mocap", **how)
        return RobotPoseOrder(robot=binding.target, source="mocap", **how)

    def _pose(self, binding: MotionBinding, sample: MotionSample) -> BodyPose:
        """Return the pose of the target in the frame of the trial."""
        turn = rotate_about([0.0, 0.0, 1.0], binding.heading)
        position = sample.position @ turn.T + np.array([binding.x, binding.y, 0.0])
        rotation = turn @ sample.rotation
        if sample.skeleton is not None and binding.target in self._bodies:
            return self._fit(binding.target, sample.skeleton).pose(sample.number, sample.time, position, rotation)
        k = 0 if sample.skeleton is None else sample.skeleton.roles["pelvis"]
        x, y = (round(float(item), 6) for item in position[k, :2])
        return BodyPose(x, y, round(wrap_angle(yaw_of(rotation[k])), 6))

    def _fit(self, target: str, skeleton: SourceSkeleton) -> FootLock:
        known = self._fits.get(target)
        if known is None or known[0] is not skeleton:
            known = self._fits[target] = (skeleton, FootLock(Retargeting(skeleton, self._bodies[target])))
        return known[1]


def _avatar_bodies(simulation: Any) -> dict[str, RestSkeleton]:
    """Return the bones of each avatar of the first environment."""
    trial, people = simulation.trial, simulation.people
    figures = people_appearance(trial, people, simulation.world.scene.shape[1], simulation.seeds[0]).people
    names = [getattr(people.owners[owner], "name", "") for owner in people.owner.tolist()]
    first = len(names) - len(trial.avatars)
    return {avatar.name: rest_skeleton(figures, first + names[first:].index(avatar.name)) for avatar in trial.avatars}


SERVERS: dict[str, type[ServerStream]] = {"natnet": NatNetStream, "vrpn": VrpnStream}
FILES = {".bvh": read_bvh, ".csv": read_csv, ".mvnx": read_mvnx}
FORM = "SOURCE[#SUBJECT]=NAME[@X,Y,HEADING]"
EXAMPLES = "xsens:9763=guide, natnet:192.168.0.5#Cart=twin or walk.bvh=guide@4,0,3.14"


def open_stream(address: str) -> PoseStream:
    """Return the stream at an address; enter it as a context to receive.

    Args:
        address: ``xsens:PORT`` or ``xsens:HOST:PORT`` (the address to listen on), ``natnet:SERVER`` or
            ``natnet:SERVER:PORT``, ``vrpn:SERVER`` or ``vrpn:SERVER:PORT``, or the path of a .bvh, .csv or .mvnx file.

    Raises:
        InputError: the address or file is not valid.

    >>> open_stream("natnet:127.0.0.1").port
    1510
    """
    kind, _, rest = address.partition(":")
    if kind == "xsens":
        host, port = _host_port(rest, "127.0.0.1", XSENS_PORT, address)
        return XsensStream(host, port)
    if kind in SERVERS:
        server, _, port_text = rest.partition(":")
        stream = SERVERS[kind]
        return stream(server or "127.0.0.1", _port(port_text, stream.default_port, address))
    path = Path(address)
    reader = FILES.get(path.suffix.lower())
    if reader is None:
        raise InputError(
            f"motion capture {address!r} must be xsens:PORT, natnet:SERVER, vrpn:SERVER or a file that ends in"
            f" {', '.join(FILES)}"
        )
    return reader(read_bytes(path), str(path))


def _host_port(text: str, host: str, port: int, address: str) -> tuple[str, int]:
    """Return host and port of ``HOST:PORT``, ``HOST`` or ``PORT``."""
    first, colon, second = text.partition(":")
    if colon:
        return first or host, _port(second, port, address)
    return (host, _port(first, port, address)) if first.isdigit() or not first else (first, port)


def _port(text: str, default: int, address: str) -> int:
    if not text:
        return default
    if not re.fullmatch(r"\d{1,5}", text) or int(text) > 65535:
        raise InputError(f"motion capture {address!r}: port {text[:40]!r} must be a number from 0 to 65535")
    return int(text)


def parse_captures(texts: Sequence[str], trial: Trial) -> list[MotionCapture]:
    """Return the motion captures that some texts describe; those with the same source share a stream.

    Args:
        texts: such as ``xsens:9763=guide``: source, possibly ``#`` and a subject, ``=``, the name of an avatar or
            robot, and possibly ``@`` and the place of the origin of the source in the trial: x, y [m], heading [rad].
        trial: the trial, which must have the avatars and robots.

    Raises:
        InputError: a text, a file or a name is not valid.

    >>> from crowdbot.trials import parse_trial
    >>> trial = parse_trial('''<trial name="led" duration="1"><stage/><crowd type="orca"/>
    ...   <avatar name="guide" source="external" x="0" y="0"/></trial>''')
    >>> parse_captures(["xsens:9763#Anna=guide@2,0,1.57"], trial)[0].bindings[0].subject
    'Anna'
    """
    found: dict[str, list[MotionBinding]] = {}
    for text in texts:
        address, binding = parse_binding(text)
        found.setdefault(address, []).append(binding)
    targets = [binding.target for bindings in found.values() for binding in bindings]
    for name in targets:
        if targets.count(name) > 1:
            raise InputError(f"motion capture moves {name!r} twice")
    captures = []
    for address, bindings in found.items():
        capture = MotionCapture(open_stream(address), bindings)
        capture.check(trial)
        known = capture.stream.subjects()
        for item in bindings:
            if not capture.stream.live and item.subject and item.subject not in known:
                raise InputError(f"{address} has no subject {item.subject!r}; it has {', '.join(known)}")
        captures.append(capture)
    return captures


def parse_binding(text: str) -> tuple[str, MotionBinding]:
    """Return the address of a stream and the binding that a text such as ``xsens:9763=guide`` describes.

    Raises:
        InputError: the text has another form.

    >>> parse_binding("walk.bvh=guide@1,2")[1].y
    2.0
    """
    match = re.fullmatch(r"(?P<source>[^#=]+)(#(?P<subject>[^=]+))?=(?P<name>[^@=]+)(@(?P<origin>.*))?", text)
    if match is None:
        raise InputError(f"motion capture {text!r} must have the form {FORM}, such as {EXAMPLES}")
    origin = [0.0, 0.0, 0.0]
    if match["origin"] is not None:
        try:
            numbers = [float(word) for word in match["origin"].split(",")]
        except ValueError:
            numbers = []
        if len(numbers) not in (2, 3):
            raise InputError(f"motion capture {text!r}: {match['origin']!r} must be X,Y or X,Y,HEADING in m and rad")
        origin[: len(numbers)] = numbers
    return match["source"], MotionBinding(match["name"], match["subject"] or "", *origin)


Origin = Callable[[], tuple[float, float, float]]


class CaptureSet:
    """Motion capture of a session: streams stay open from one trial to the next. Use it as a context.

    >>> with CaptureSet(["xsens:0=guest", "xsens:0#Cart=twin@2,0"]) as captures:
    ...     captures.targets, len(captures.streams)
    (('guest', 'twin'), 1)
    """

    def __init__(self, texts: Sequence[str] = ()) -> None:
        self.streams: dict[str, PoseStream] = {}
        """Open streams by their addresses."""
        self._bindings: dict[str, tuple[str, MotionBinding]] = {}
        self._texts = tuple(texts)

    def __enter__(self) -> CaptureSet:
        """Open the streams."""
        try:
            for text in self._texts:
                self.add(text)
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the streams."""
        self.close()

    @property
    def texts(self) -> tuple[str, ...]:
        """The texts of the bindings, such as ``xsens:9763=guest``."""
        return tuple(self._bindings)

    @property
    def targets(self) -> tuple[str, ...]:
        """Names of the avatars and robots that are moved."""
        return tuple(binding.target for _, binding in tuple(self._bindings.values()))

    @property
    def bindings(self) -> dict[str, MotionBinding]:
        """Who is moved, by the texts of the bindings; a copy."""
        return {text: binding for text, (_, binding) in tuple(self._bindings.items())}

    @property
    def live(self) -> bool:
        """Whether a stream comes in real time."""
        return any(stream.live for stream in self.streams.values())

    def add(self, text: str) -> None:
        """Open a stream, such as ``xsens:9763=guest``, and bind a target to it.

        Raises:
            InputError: the text is not valid, the target is moved already, or the stream cannot be opened.
        """
        address, binding = parse_binding(text)
        if binding.target in self.targets:
            raise InputError(f"motion capture moves {binding.target!r} already; remove that first")
        if address not in self.streams:
            self.streams[address] = open_stream(address).__enter__()
        self._bindings[text] = (address, binding)

    def remove(self, text: str) -> None:
        """Release a target; a stream without targets is closed.

        Raises:
            InputError: there is no such binding.
        """
        if text not in self._bindings:
            raise InputError(f"there is no motion capture {text!r}; there is {', '.join(self._bindings) or 'none'}")
        address, _ = self._bindings.pop(text)
        if all(other != address for other, _ in self._bindings.values()):
            self.streams.pop(address).__exit__(None, None, None)

    def close(self) -> None:
        """Close all streams."""
        for text in self.texts:
            self.remove(text)

    def stream_of(self, target: str) -> tuple[PoseStream, str] | None:
        """Return the stream of a target and the name of its subject; None: it is not moved."""
        binding = next((pair for pair in tuple(self._bindings.values()) if pair[1].target == target), None)
        stream = None if binding is None else self.streams.get(binding[0])
        return None if binding is None or stream is None else (stream, binding[1].subject)

    def captures_of(self, trial: Trial, leave: Sequence[str] = (), origin: Origin | None = None) -> list[MotionCapture]:
        """Return what moves avatars and mirrored robots of a trial; targets that it lacks are left out.

        Args:
            trial: the trial.
            leave: names of targets that are moved in another way.
            origin: returns x, y [m] and heading [rad] of the origin of systems whose text has no ``@``.
        """
        mirrors = {
            robot.name for robot in trial.robots if robot.mirror is not None and robot.mirror.source == "external"
        }
        known = {avatar.name for avatar in trial.avatars if avatar.source == "external"} | mirrors
        found: dict[str, list[MotionBinding]] = {}
        for text, (address, binding) in tuple(self._bindings.items()):
            if binding.target not in known or binding.target in leave:
                continue
            x, y, heading = (binding.x, binding.y, binding.heading) if origin is None or "@" in text else origin()
            placed = dataclasses.replace(binding, x=x, y=y, heading=heading)
            found.setdefault(address, []).append(placed)
        return [MotionCapture(self.streams[address], bindings) for address, bindings in found.items()]
