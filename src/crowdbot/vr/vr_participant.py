"""A participant in a headset, the avatar and its contacts."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from crowdbot.core import InputError
from crowdbot.humans import BodyPose, People
from crowdbot.simulation import AvatarOrder, Order, Simulation
from crowdbot.trials import people_appearance
from crowdbot.typing import Floats
from crowdbot.web import StateFrame
from crowdbot.world import two_body_force

from .body_estimate import BodyEstimator, BodySize
from .capture import Suit
from .headset_sample import HeadsetRecorder, HeadsetSample
from .headset_stream import HeadsetStream, StreamSettings
from .shared_rooms import PERSON, SharedRooms

REGION = "chest"
"""Region of the body that a disc of the planar world touches."""
STRONG = 60.0
"""Force [N] at which a controller vibrates with full strength."""
WEAKEST = 0.25
"""Strength of the vibration of a light contact."""


class AvatarContacts:
    """Contacts of one person, step by step.

    In the physics world each has a force: the mean over the last step, an estimate from the masses and velocities of
    both bodies. In the planar world bodies are discs: the force is the peak of the two-body model of ISO/TS 15066, from
    the closing speed of both and the mass of the robot, for the chest of a person.

    Args:
        agent: index of the person in the scene.

    >>> from crowdbot.trials import load_trial
    >>> AvatarContacts(0).update(Simulation(load_trial("frontal")))
    []
    """

    def __init__(self, agent: int) -> None:
        self.agent = agent
        self._held: set[tuple[str, int, str]] = set()
        self._velocity: Floats | None = None

    def update(self, simulation: Simulation) -> list[dict[str, Any]]:
        """Return the contacts of the last step, JSON.

        Each has ``kind`` and ``number`` of the other body, ``limb``, ``side`` (``left``, ``right`` or empty), ``force``
        [N], ``point`` [m] or null, ``begins`` (whether there was none in the step before), ``strength`` from 0 to 1.
        """
        result = self._forces(simulation) or self._overlaps(simulation)
        self._velocity = simulation.world.environment_scene(0).velocity[0].copy()
        keys = {(item["kind"], item["number"], item["limb"]) for item in result}
        for item in result:
            item["begins"] = (item["kind"], item["number"], item["limb"]) not in self._held
        self._held = keys
        return result

    def _forces(self, simulation: Simulation) -> list[dict[str, Any]]:
        forces = []
        for item in simulation.world.forces_of(0):
            pair = (item.first, item.second)
            if not any(body.kind == "person" and body.number == self.agent for body in pair) or item.force <= 0.0:
                continue
            own = pair.index(next(body for body in pair if body.kind == "person" and body.number == self.agent))
            other = pair[1 - own]
            limb = item.limb
            side = {"_l": "left", "_r": "right"}.get(limb[-2:], "")
            strength = min(1.0, max(WEAKEST, item.force / STRONG))
            forces.append(
                {"kind": other.kind, "number": int(other.number), "limb": limb, "side": side,
                 "force": round(float(item.force), 2), "point": [round(float(k), 4) for k in item.point],
                 "strength": round(strength, 3)}
            )  # fmt: skip
        return forces

    def _overlaps(self, simulation: Simulation) -> list[dict[str, Any]]:
        ids = simulation.world.ids[0].tolist()
        own = ids[self.agent]
        overlaps = []
        for contact in simulation.contacts():
            if contact.other != own:
                continue
            force = self._impact(simulation, ids.index(contact.robot))
            strength = round(min(1.0, max(WEAKEST, force / STRONG)), 3)
            overlaps.append(
                {"kind": "robot", "number": int(contact.robot), "limb": "", "side": "", "force": round(force, 2),
                 "point": None, "strength": strength}
            )  # fmt: skip
        return overlaps

    def _impact(self, simulation: Simulation, robot: int) -> float:
        """Return the peak force [N] of an impact at the closing speed before or after the last step."""
        scene = simulation.world.environment_scene(0)
        apart = scene.position[0, self.agent] - scene.position[0, robot]
        normal = apart / max(1e-9, float(np.hypot(*apart)))
        moves = [scene.velocity[0]]
        if self._velocity is not None and self._velocity.shape == scene.velocity[0].shape:
            moves.append(self._velocity)
        speed = max(float((move[robot] - move[self.agent]) @ normal) for move in moves)
        mass = next(float(item.robot.mass) for item in simulation.robots if item.agent == robot)
        return two_body_force(speed, mass, REGION)


SOURCE = "vr"
CLOCK_INTERVAL = 1.0
"""Time between two records of the clock offset [s]."""
LATEST = 100
"""Number of messages that are kept."""


class VrParticipant:
    """Gives the poses of a headset to an avatar, one order in each step, and tells the headset what it touches.

    It is a control of a :class:`crowdbot.web.LiveRun`. Messages arrive in one thread, steps happen in another.

    Args:
        avatar: name of an external avatar of the trial.
        rooms: where the room of the headset is in the virtual room.
        settings: delays and noise.
        recorder: recording of the raw messages, or None.
        clock: time of the server [s].
        tell: called with messages for the headset, JSON.
        utc: seconds since 1970, recorded beside ``clock``.
    """

    def __init__(
        self,
        avatar: str,
        rooms: SharedRooms,
        settings: StreamSettings | None = None,
        recorder: HeadsetRecorder | None = None,
        clock: Callable[[], float] = time.monotonic,
        tell: Callable[[dict[str, Any]], None] = lambda _: None,
        utc: Callable[[], float] = time.time,
    ) -> None:
        self.avatar, self.rooms, self.recorder = avatar, rooms, recorder
        self.stream = HeadsetStream(settings)
        self.room = PERSON
        """Name of the room in which the participant is."""
        self.suit: Suit | None = None
        """Motion capture suit of the participant; it moves the whole body while it sends."""
        self.refused, self.reason = 0, ""
        """Number of samples that are no pose of a person, and why the last one is not."""
        self.sample: HeadsetSample | None = None
        """The latest message."""
        self._latest: deque[HeadsetSample] = deque(maxlen=LATEST)
        self._clock, self._tell = clock, tell
        self._utc = utc
        self._noted: tuple[HeadsetRecorder | None, float] = (None, 0.0)
        self._lock = threading.Lock()
        self._simulation: Simulation | None = None
        self._estimator: BodyEstimator | None = None
        self._contacts: AvatarContacts | None = None
        self._id: int | None = None
        self._picture_delay = 0.0
        self._figure: tuple[People, int] = (People.of(["man-20"]), 0)
        self._dressed: Suit | None = None

    def take(self, data: bytes) -> dict[str, Any]:
        """Take a message of the headset, and return the answer: the times of its arrival and of the answer.

        Raises:
            InputError: it is no message of a headset.
        """
        arrival = self._clock()
        sample = HeadsetSample.of_frame(StateFrame.decode(data))
        recorder = self.recorder  # another thread may exchange it
        if recorder is not None:
            recorder.message(arrival, data)
        with self._lock:
            self.sample = sample
            self._latest.append(sample)
            self.stream.add(sample, arrival)
            self._note_clock(arrival)
        return {"clock": [sample.time, arrival, self._clock()]}

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the pose at the end of the next step; none while tracking is lost, so the avatar stands."""
        self._follow(simulation)
        now = self._clock()
        with self._lock:
            sample = self.stream.at(now)
            self._tell_contacts(simulation, now)
        if sample is None or self._estimator is None:
            return []
        at = round(float(simulation.world.times[0]) + float(simulation.world.clock.dt), 9)
        try:
            pose = self._estimator.update(sample, self.rooms.room(self.room).place)
            if pose is None:
                return []
            parts = {name: getattr(pose, name) for name in ("head", "left_hand", "right_hand")}
            if sample.gaze is not None and pose.head is not None:
                parts["gaze"] = tuple(sample.gaze.tolist())
            body = self._body(pose, float(simulation.world.times[0]), at)
            if body is not None:
                pose, parts = body, {"head": parts["head"], "gaze": parts.get("gaze"), "skeleton": body.skeleton}
            order = AvatarOrder(
                avatar=self.avatar, time=at, x=pose.x, y=pose.y, heading=pose.heading, source=SOURCE, **parts
            )
        except InputError as error:  # for instance a headset that lies on a cupboard
            self.refused, self.reason = self.refused + 1, str(error)
            return []
        recorder = self.recorder
        if recorder is not None:
            place = [pose.x, pose.y, pose.heading]
            age = round(self.stream.age, 6)
            recorder.note(now, {"step": at, "avatar": self.avatar, "sample": sample.time, "pose": place, "age": age})
            if body is not None and self.suit is not None:
                recorder.note(now, {"suit": self.suit.raw()})
        return [order]

    def _body(self, pose: BodyPose, now: float, at: float) -> BodyPose | None:
        """Return the pose of the suit, with the head where the headset is; None without one, or while it is silent."""
        suit = self.suit
        if suit is None or pose.head is None:
            return None
        if self._dressed is not suit:
            suit.dress(*self._figure)
            self._dressed = suit
        return suit.pose(np.array(pose.head), now, at)

    def move_to(self, avatar: str) -> None:
        """Move another avatar from now on, of another trial."""
        self.avatar, self._simulation, self._id = avatar, None, None
        self._tell({"avatar": avatar})

    def record_to(self, recorder: HeadsetRecorder | None) -> None:
        """Write the raw messages to another recording from now on, and close the one before."""
        before, self.recorder = self.recorder, recorder
        if before is not None:
            before.close()

    def history(self, count: int) -> list[HeadsetSample]:
        """Return the latest messages, at most 100."""
        with self._lock:
            return list(self._latest)[-count:]

    def is_lost(self) -> bool:
        """Return whether the head has not been tracked for longer than the timeout."""
        with self._lock:
            return self.stream.is_lost(self._clock())

    def apply(self, settings: StreamSettings) -> None:
        """Use other settings from now on."""
        with self._lock:
            self.stream.settings = settings

    def summary(self) -> dict[str, Any]:
        """Return latency, clock offset and state, JSON."""
        with self._lock:
            now, sample = self._clock(), self.sample
            found: dict[str, Any] = dict(self.stream.latency.summary())
            clock = self.stream.clock
            found |= {
                "avatar": self.avatar, "room": self.room, "id": self._id, "lost_tracking": self.stream.is_lost(now),
                "refused": self.refused, "reason": self.reason, "offset": clock.offset if clock else None,
                "round_trip": round(1e3 * clock.delay, 3) if clock else None,
                "suit": self.suit is not None, "steps": self.stream.latency.count("motion"),
                "picture_delay": self.stream.settings.picture_delay + self._picture_delay,
                "gaze": getattr(sample, "gaze", None) is not None,
                "hands": [name for name in ("left", "right") if getattr(sample, name, None) is not None],
            }  # fmt: skip
            if sample is not None and sample.head is not None:
                place = self.rooms.room(self.room).place.apply(sample.head[:3])
                found["place"] = place.round(3).tolist()
                found["margin"] = self.rooms.margin(self.room, float(place[0]), float(place[1]))
        return found

    def _note_clock(self, now: float) -> None:
        """Record how the clocks are related, in each recording first when it is known and then once a second."""
        clock, recorder = self.stream.clock, self.recorder
        if recorder is None or not clock or (recorder is self._noted[0] and now < self._noted[1] + CLOCK_INTERVAL):
            return
        self._noted = (recorder, now)
        recorder.note(now, {"clock": {"offset": clock.offset, "round_trip": clock.delay, "utc": self._utc()}})

    def _follow(self, simulation: Simulation) -> None:
        """Use the body of the avatar in a simulation that was not seen before."""
        if simulation is self._simulation:
            return
        self._simulation = simulation
        people, number, agent = avatar_body(simulation, self.avatar)
        self._estimator = BodyEstimator(BodySize.of(people, number))
        self._figure, self._dressed = (people, number), None
        self._contacts = AvatarContacts(agent)
        spec = next(avatar for avatar in simulation.trial.avatars if avatar.name == self.avatar)
        with self._lock:
            self.stream.trial_delay, self.stream.trial_noise = spec.delay, spec.noise
            self._picture_delay = spec.picture_delay
        self._id = int(simulation.world.ids[0, agent])

    def _tell_contacts(self, simulation: Simulation, now: float) -> None:
        for event in [] if self._contacts is None else self._contacts.update(simulation):
            recorder = self.recorder
            if recorder is not None:
                recorder.note(now, {"touch": event})
            self._tell({"touch": event})


def avatar_body(simulation: Simulation, name: str) -> tuple[People, int, int]:
    """Return the bodies of all people, the number of that of an avatar, and its agent.

    Raises:
        InputError: there is no such avatar.
    """
    trial, people = simulation.trial, simulation.people
    names = [getattr(people.owners[owner], "name", "") for owner in people.owner.tolist()]
    first = len(names) - len(trial.avatars)
    if name not in names[first:]:
        raise InputError(f"the trial has no avatar {name!r}")
    number = first + names[first:].index(name)
    count = simulation.world.environment_scene(0).shape[1]
    return people_appearance(trial, people, count, simulation.seeds[0]).people, number, number
