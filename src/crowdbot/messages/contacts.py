"""Contacts of people and their postures out of balance as messages."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from crowdbot.humans import LYING, FallPose

if TYPE_CHECKING:
    from .message_store import Messages


FORCES = "/crowdbot/forces"
"""Topic of the contact forces of each step."""
COLLISIONS = "/crowdbot/collisions"
"""Topic of finished contact events."""

FALLS = "/crowdbot/falls"
"""Topic of falls of people that are over."""


class ContactForceRecord(NamedTuple):
    """Force between two bodies in one step, see ``crowdbot.world.ContactForce``.

    Fields:
        time: end of the step [s].
        first, second: the bodies: name of a robot, id of a person, ``wall``, or ``prop`` with its number.
        first_part: link of a robot; limb, part: limb of the person, empty without a person.
        force: magnitude [N]; vector: force of the first on the second body [N]; depth: penetration [m]; point: position
            [m].
    """

    time: float
    first: str
    second: str
    first_part: str
    limb: str
    part: str
    force: float
    vector: tuple[float, float, float]
    depth: float
    point: tuple[float, float, float]


class ContactEventRecord(NamedTuple):
    """Contact of two bodies from start to end, see ``crowdbot.world.BodyContactEvent``; times in [s]."""

    first: str
    second: str
    begin: float
    end: float
    duration: float
    cause: str
    impact_speed: float
    depth: float
    impulse: float
    limb: str
    part: str
    region: str
    peak_force: float
    steady_force: float
    steady_region: str
    simulated_peak: float
    severity: float


class FallRecord(NamedTuple):
    """Fall of a person, see ``crowdbot.world.Fall``; ``cause`` is the body that pushed, as in contact events."""

    person: str
    begin: float
    end: float
    direction: str
    cause: str
    steps: float
    hand: float
    leg: float
    pelvis: float
    chest: float
    head: float
    hic15: float


def contact_messages(make: Messages, now: int, frame: Any, names: Mapping[int, str]) -> Iterator[tuple[str, Any]]:
    """Yield topic and message of the contact forces, contact events and falls of a step, if any.

    Args:
        make: message factory.
        now: simulated time [ns].
        frame: step record; ``forces``, ``collisions`` and ``falls`` are empty in the planar world.
        names: names of robots by id.
    """
    ids = frame.ids.tolist()

    def called(party: Any) -> str:
        kind, number = party
        who = ids[number] if kind in ("robot", "person") else number
        return {"robot": names.get(who, str(who)), "person": str(who), "wall": "wall"}.get(kind, f"{kind} {number}")

    forces = [_force(make, item, called) for item in getattr(frame, "forces", ())]
    if forces:
        yield FORCES, make.make("crowdbot_msgs/msg/Forces", header=make.header(now), forces=forces)
    collisions = [_collision(make, item, called) for item in getattr(frame, "collisions", ())]
    if collisions:
        yield COLLISIONS, make.make("crowdbot_msgs/msg/Collisions", header=make.header(now), collisions=collisions)
    falls = [_fall(make, item, called) for item in getattr(frame, "falls", ())]
    if falls:
        yield FALLS, make.make("crowdbot_msgs/msg/Falls", header=make.header(now), falls=falls)


def _force(make: Messages, one: Any, called: Callable[[Any], str]) -> Any:
    return make.make(
        "crowdbot_msgs/msg/Force",
        first=called(one.first),
        second=called(one.second),
        first_part=one.first_part,
        limb=one.limb,
        part=one.part,
        force=float(one.force),
        vector=make.vector(*map(float, one.vector)),
        depth=float(one.depth),
        point=make.point(*one.point),
    )


def _collision(make: Messages, one: Any, called: Callable[[Any], str]) -> Any:
    words = ("cause", "limb", "part", "region", "steady_region")
    numbers = [name for name in ContactEventRecord._fields if name not in ("first", "second", *words)]
    return make.make(
        "crowdbot_msgs/msg/Collision",
        first=called(one.first),
        second=called(one.second),
        **{name: str(getattr(one, name)) for name in words},
        **{name: float(getattr(one, name)) for name in numbers},
    )


def _fall(make: Messages, one: Any, called: Callable[[Any], str]) -> Any:
    words = {"person": called(("person", one.person)), "direction": one.direction}
    words["cause"] = called((one.cause, one.causer)) if one.cause else ""
    numbers = [name for name in FallRecord._fields if name not in words]
    return make.make("crowdbot_msgs/msg/Fall", **words, **{name: float(getattr(one, name)) for name in numbers})


def read_falls(message: Any) -> list[FallRecord]:
    """Return the falls of a message."""
    return [FallRecord(*(getattr(fall, name) for name in FallRecord._fields)) for fall in message.falls]


def read_forces(time: float, message: Any) -> list[ContactForceRecord]:
    """Return the forces of a message."""
    return [
        ContactForceRecord(
            time, force.first, force.second, force.first_part, force.limb, force.part, force.force,
            (force.vector.x, force.vector.y, force.vector.z), force.depth,
            (force.point.x, force.point.y, force.point.z),
        )
        for force in message.forces
    ]  # fmt: skip


def read_contact_events(message: Any) -> list[ContactEventRecord]:
    """Return the contact events of a message."""
    return [
        ContactEventRecord(*(getattr(collision, name) for name in ContactEventRecord._fields))
        for collision in message.collisions
    ]


FALL_POSES = "/crowdbot/fall_poses"
"""Topic of the poses of people who lean, fall, lie or get up, in recorded scenes."""
KIND = "crowdbot_msgs/msg/FallPoses"
WIDEST = LYING + 1e-3
"""Largest tilt [rad] that is read."""


def fall_pose_message(make: Messages, now: int, poses: Mapping[int, FallPose]) -> Any:
    """Return the message of poses by id of the person, at a simulated time [ns].

    >>> from crowdbot.messages import Messages
    >>> make = Messages()
    >>> message = fall_pose_message(make, 0, {3: FallPose(0.5, 1.25, 0.25, True, True)})
    >>> read_fall_poses(make.decode_message(make.encode_message(message), KIND))
    {3: FallPose(direction=0.5, tilt=1.25, start=0.25, struck=True, down=True, rising=False)}
    """
    rows = [
        make.make(
            "crowdbot_msgs/msg/FallPose", person=person, direction=pose.direction, tilt=pose.tilt, start=pose.start,
            struck=pose.struck, down=pose.down, rising=pose.rising,
        )
        for person, pose in poses.items()
    ]  # fmt: skip
    return make.make(KIND, header=make.header(now), poses=rows)


def read_fall_poses(message: Any) -> dict[int, FallPose]:
    """Return the poses of a message by id of the person.

    Raises:
        ValueError: an angle is not possible.
    """
    fall_poses = {}
    for item in message.poses:
        flags = bool(item.struck), bool(item.down), bool(item.rising)
        pose = FallPose(float(item.direction), float(item.tilt), float(item.start), *flags)
        if not (math.isfinite(pose.direction) and 0.0 <= pose.tilt <= WIDEST and 0.0 <= pose.start <= WIDEST):
            raise ValueError(f"person {item.person} has an impossible pose {tuple(pose)}")
        fall_poses[int(item.person)] = pose
    return fall_poses
