"""ParticipantsDesk: participants in headsets, the avatars that they move, and their bodies."""

from __future__ import annotations

import contextlib
import dataclasses
import shutil
import statistics
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from crowdbot import web
from crowdbot.core import InputError
from crowdbot.humans import People
from crowdbot.simulation import OrderSource, Simulation
from crowdbot.trials import Trial, add_element
from crowdbot.web import AppSession, DeskWindows, ExperimentDesk, LiveRun, SimulatorDesk

from .body_estimate import BodySize
from .calibration_pose import BodyMeasure, measure_pose
from .capture import CapturesDesk
from .free_place import free_place
from .headset_recording import HeadsetRecorder
from .headset_stream import StreamSettings
from .robot_stop import RobotStop
from .shared_rooms import PERSON
from .trial_seats import TrialSeats, external_avatars, with_bodies
from .vr_participant import VrParticipant, avatar_body

__all__ = ["ParticipantsDesk"]

TOUCH = 30
"""Samples of a controller of which a touched point is the median."""
NEW = "participant"
"""Name of the avatar of a trial that has none."""
OPENING = 5.0
"""Longest time [s] that a headset waits for the first trial of a session."""


class ParticipantsDesk(CapturesDesk):
    """A desk whose participants move avatars: of the trial of the simulator tab, or of an experiment that is open.

    Everything that happens to a simulation is an order, so the episode replays without a headset.
    """

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self.participants: dict[str, VrParticipant] = {}
        """Participants by the names of their avatars."""
        self.bodies: dict[str, BodyMeasure] = {}
        """Measured sizes by the names of the avatars."""
        self.settings = StreamSettings()
        self._stop = RobotStop()
        self._seats: TrialSeats | None = None
        self._in_experiment = False
        self._placed: dict[str, LiveRun] = {}
        self._room_names: dict[str, str] = {}
        self._warnings: set[str] = set()
        self._number = 0

    @property
    def simulator(self) -> SimulatorDesk:
        """The simulator tab of the session."""
        found = self.session.desk("simulator") if isinstance(self.session, AppSession) else None
        if not isinstance(found, SimulatorDesk):
            raise InputError("virtual reality needs the simulator tab")
        return found

    @property
    def experiment(self) -> ExperimentDesk | None:
        """The experiments tab, if the session of a participant is open there and not over."""
        found = self.session.desks.get("experiments") if isinstance(self.session, AppSession) else None
        return found if isinstance(found, ExperimentDesk) and found.session_open else None

    def join(self, tell: Callable[[dict[str, Any]], None], wish: str = "") -> VrParticipant:
        """Add a participant, who moves the first external avatar that is free.

        Args:
            tell: sends messages to the headset, from any thread.
            wish: name of the avatar that the same headset moved before; it is taken if it is free.

        Raises:
            InputError: a trial does not run, or each of its avatars already has a participant.
        """
        self.follow_experiment()
        run = None if self._in_experiment else self._running()
        with self._lock:
            names = self._experiment_avatars() if run is None else external_avatars(run.trial)
            if run is not None and not names:
                self.simulator.run_trial(_with_avatar(run))
                run, names = self._running(), [NEW]
            free = [name for name in names if name not in self.participants]
            if not free:
                raise InputError(f"each avatar of the trial has a participant already: {', '.join(names)}")
            name = wish if wish in free else free[0]
            person = VrParticipant(name, self.rooms, self.settings, tell=tell)
            person.room, person.suit = self._room_of(name), self.suit_of(name)
            self.participants[name] = person
            if run is not None:
                person.record_to(self._recorder())
                self._attach(run, person)
            elif self._seats is not None:
                self._take_seat(self._seats, person)
        self._tell_state()
        return person

    def leave(self, person: VrParticipant) -> None:
        """Remove a participant; the avatar then stands where it is."""
        with self._lock:
            if self.participants.get(person.avatar) is person:
                del self.participants[person.avatar]
            with contextlib.suppress(InputError):
                controls = self.simulator.run.controls
                if controls.get(person.avatar) is person:
                    del controls[person.avatar]
            self._note(person, {"leaves": person.avatar})
            if self._seats is not None:
                self._seats.leave(person)
            self._discard_recording(person)
        self._tell_state()

    def follow_experiment(self) -> None:
        """Let the participants change between the simulator tab and an experiment that was opened or has ended."""
        opened = self.experiment is not None
        with self._lock:
            if opened == self._in_experiment:
                return
            self._in_experiment = opened
            with contextlib.suppress(InputError):
                run = self.simulator.run
                for one in self.participants.values():
                    if run.controls.get(one.avatar) is one:
                        del run.controls[one.avatar]
                if opened:
                    self.simulator.pause()
            names = self._experiment_avatars() if opened else self._simulator_avatars()
            people, self.participants = list(self.participants.values()), {}
            for one in people:
                free = [name for name in names if name not in self.participants]
                if one.avatar not in free and free:
                    one.move_to(free[0])
                self.participants[one.avatar] = one
                self._discard_recording(one)
                if not opened:
                    one.record_to(self._recorder())
            if not opened:
                self.bodies.clear()  # the next participant has another size
        self._tell_state()

    def join_trial(self, trial: Trial, folder: Path) -> tuple[Trial, Sequence[OrderSource]]:
        """Give the avatars of a trial of the experiment to the participants, and record them in its folder."""
        self.follow_experiment()
        with self._lock:
            if not any(one.source == "external" for one in trial.avatars):
                return trial, ()
            stop = RobotStop()
            stop.set = self._stop.set
            trial = with_bodies(trial, self.bodies)
            self._stop = stop
            self._seats = TrialSeats(trial, folder, stop, self._near_limits)
            self._warnings = {one for one in self._warnings if not one.startswith(("paused", "tracking"))}
            for one in self.participants.values():
                self._take_seat(self._seats, one)
            self._seats.capture(self.captures_of(trial, self._seats.avatars))
            return trial, [self._seats]

    def leave_trial(self) -> None:
        """Close the recordings of the trial that has ended."""
        with self._lock:
            seats, self._seats = self._seats, None
            if seats is not None:
                seats.close()

    def unmoved_avatars(self) -> list[str]:
        """Return a warning for each avatar of the trial of an experiment that nothing moves."""
        seats = self._seats
        if seats is None:
            return []
        moved = {*seats.avatars, *self.captures.targets}
        rest = [one for one in seats.trial.avatars if one.source == "external" and one.name not in moved]
        ways = {True: "a headset or motion capture", False: "motion capture"}
        return [f"nothing moves {one.name!r}: it needs {ways[one.headset]}" for one in rest]

    @web.command
    def set(self, settings: dict[str, Any]) -> None:
        """Change settings: delays and noise [s], [m], timeout, and whether a run pauses when tracking is lost."""
        known = {one.name for one in dataclasses.fields(StreamSettings)}
        unknown = [name for name in settings if name not in known]
        if unknown:
            raise InputError(f"setting {unknown[0]!r} does not exist; settings are {', '.join(sorted(known))}")
        with self._lock:
            self.settings = dataclasses.replace(self.settings, **settings)
            for one in self.participants.values():
                one.apply(self.settings)
            self._note_all({"settings": dataclasses.asdict(self.settings)})
        self._tell_state()

    @web.command
    def add_wrist_pair(self, avatar: str, x: float, y: float, z: float, side: str = "right") -> int:
        """Add a calibration point: the wrist of a participant is at x, y, z [m] of the virtual room.

        The median of the last 30 samples counts. Returns the number of points.
        """
        with self._lock:
            person = self._participant(avatar)
            found = [one for one in person.history(TOUCH) if getattr(one, side, None) is not None]
            if side not in ("left", "right") or not found:
                raise InputError(f"the {side} controller or hand of {avatar!r} is not tracked")
            rows = [getattr(one, side)[:3].tolist() for one in found]
            source = [statistics.median(row[k] for row in rows) for k in range(3)]
            self.rooms.add_pair(person.room, source, [x, y, z])
            self._tell_state()
            return len(self.rooms.room(person.room).source)

    @web.command
    def measure_body(self, avatar: str) -> float:
        """Scale an avatar to its participant, who stands upright, and run the trial from its start.

        In an experiment the next trial has the new size. Returns the stature [m], from the median height of the eyes.
        """
        with self._lock:
            person = self._participant(avatar)
            heights = [float(one.head[2]) for one in person.history(TOUCH) if one.head is not None]
            if len(heights) < TOUCH:
                raise InputError(f"the headset of {avatar!r} was not tracked for long enough; stand upright and wait")
            body, ratio = self._body_of(avatar)
            eyes = statistics.median(heights)
            stature = round(eyes * ratio, 3)
            if not 0.5 <= stature <= 2.5:
                raise InputError(
                    f"the eyes of the participant are {eyes:.2f} m high: set the floor of the headset first"
                )
            self._wear(person, BodyMeasure(stature, None, body, None, ""))
        return stature

    def take_pose(self, avatar: str) -> BodyMeasure:
        """Measure a participant in a T or A pose; the avatar gets this size as in :meth:`measure_body`."""
        with self._lock:
            person = self._participant(avatar)
            found = measure_pose(person.history(TOUCH + 10), self._body_of(avatar)[0])
            self._wear(person, found)
        return found

    def _wear(self, person: VrParticipant, measure: BodyMeasure) -> None:
        self.bodies[person.avatar] = measure
        self._note(person, {"body": measure._asdict()})
        if not self._in_experiment:
            self.simulator.run_trial(with_bodies(self.simulator.run.trial, self.bodies))

    def _body_of(self, avatar: str) -> tuple[str, float]:
        """Return the name of the body of an avatar, and its stature over the height of its eyes."""
        if self._in_experiment:
            specs = [one for trial in self._experiment_trials() for one in trial.avatars if one.name == avatar]
            name = next((one.body for one in specs if one.body), "mannequin")
            size = BodySize.of(People.of([name]))
        else:
            run = self.simulator.run
            people, number, _ = run.do(lambda: avatar_body(run.simulation, avatar))
            name, size = people.persons[number].name, BodySize.of(people, number)
        return name, size.stature / size.eye_height

    def _take_seat(self, seats: TrialSeats, person: VrParticipant) -> None:
        seats.seat(person)
        if person.avatar not in seats.names:
            return
        person.suit = self.suit_of(person.avatar)
        seats.capture(self.captures_of(seats.trial, seats.avatars))
        own = next(one for one in seats.trial.avatars if one.name == person.avatar)
        room = self.rooms.room(person.room)
        room.guess_place(own.x, own.y, own.heading)
        self._note(person, {"avatar": person.avatar, "trial": seats.trial.name, "room": room.state(),
                            "settings": dataclasses.asdict(self.settings)})  # fmt: skip

    def _room_of(self, avatar: str) -> str:
        """Return the name of the room of the participant who moves an avatar; a second headset has its own origin."""
        taken = any(one.room == PERSON for one in self.participants.values())
        if avatar not in self._room_names or (taken and self._room_names[avatar] == PERSON):
            self._room_names[avatar] = self.rooms.add_person(avatar) if taken else PERSON
        return self._room_names[avatar]

    def _attach(self, run: LiveRun, person: VrParticipant) -> None:
        avatars = {one.name: one for one in run.trial.avatars if one.name in external_avatars(run.trial)}
        if person.avatar not in avatars:
            return
        own, room = avatars[person.avatar], self.rooms.room(person.room)
        if self._placed.get(person.room) is not run:
            room.guess_place(own.x, own.y, own.heading)
        run.controls[person.avatar] = person
        self._placed[person.room] = run
        self._note(person, {"avatar": person.avatar, "trial": run.trial.name, "seed": run.seed, "room": room.state(),
                            "settings": dataclasses.asdict(self.settings)})  # fmt: skip

    def _apply_captures(self) -> None:
        for one in self.participants.values():
            one.suit = self.suit_of(one.avatar)
        if self._seats is not None:
            self._seats.capture(self.captures_of(self._seats.trial, self._seats.avatars))

    def _near_limits(self, simulation: Simulation) -> bool:
        """Return whether a robot is near the limits of its room."""
        return False

    def _recorder(self) -> HeadsetRecorder:
        self._number += 1
        return HeadsetRecorder(self.session.workspace.writable(f".running/vr-{self._number}.headset"))

    def _discard_recording(self, person: VrParticipant) -> None:
        """Close the recording of a participant; one that nobody has saved is removed."""
        recorder = person.recorder
        person.record_to(None)
        if recorder is not None and recorder.path.parent.name == ".running":
            recorder.path.unlink(missing_ok=True)

    def _experiment_trials(self) -> tuple[Trial, ...]:
        desk = self.experiment
        return () if desk is None else desk.trials

    def _experiment_avatars(self) -> list[str]:
        names = [name for trial in self._experiment_trials() for name in external_avatars(trial)]
        return list(dict.fromkeys(names)) or [NEW]

    def _simulator_avatars(self) -> list[str]:
        with contextlib.suppress(InputError):
            return external_avatars(self.simulator.run.trial)
        return []

    @web.command
    def save(self, name: str) -> list[str]:
        """Save the episode as NAME.mcap and the raw messages of each participant as NAME-AVATAR.headset."""
        saved = [self.simulator.save(name)]
        for one in list(self.participants.values()):
            if one.recorder is not None and not self._in_experiment:
                target = f"{saved[0].removesuffix('.mcap')}-{one.avatar}.headset"
                shutil.copyfile(one.recorder.path, self.session.workspace.writable(target))
                saved.append(target)
        return saved

    def _running(self) -> LiveRun:
        """Return the run, which a new session opens just now."""
        end = time.monotonic() + OPENING
        while True:
            try:
                return self.simulator.run
            except InputError:
                if time.monotonic() > end:
                    raise
                time.sleep(0.05)

    def _participant(self, avatar: str) -> VrParticipant:
        if avatar not in self.participants:
            raise InputError(f"avatar {avatar!r} has no participant; those with one: {', '.join(self.participants)}")
        return self.participants[avatar]

    def _note(self, person: VrParticipant, values: dict[str, Any]) -> None:
        recorder = person.recorder
        if recorder is not None:
            recorder.note(time.monotonic(), values)

    def _note_all(self, values: dict[str, Any]) -> None:
        for one in self.participants.values():
            self._note(one, values)


def _with_avatar(run: LiveRun) -> Trial:
    """Return the trial with a person who is moved from outside, at the place of most room."""
    x, y = run.do(lambda: free_place(run.simulation))
    xml = f'<avatar name="{NEW}" source="external" x="{x:g}" y="{y:g}"/>'
    return add_element(run.trial, xml, place=f"trial {run.trial.name!r} with a participant", trust=False)
