"""VrDesk: the tab for virtual reality, with participants, rooms, motion capture, and stops."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import shutil
import statistics
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ClassVar, Literal

from crowdbot import web
from crowdbot.bridges import CaptureSet, MotionCapture, parse_binding
from crowdbot.core import CrowdbotError, InputError
from crowdbot.humans import People
from crowdbot.simulation import OrderSource, Simulation
from crowdbot.trials import Trial, add_element
from crowdbot.web import AppSession, Desk, DeskWindows, ExperimentDesk, LiveRun, Resource, SimulatorDesk

from .body_estimate import BodyMeasure, BodySize, measure_pose
from .capture import Suit
from .headset_sample import HeadsetRecorder
from .headset_stream import StreamSettings
from .rigid_transform import RigidTransform
from .server_address import link_picture
from .shared_rooms import PERSON, RoomLimits, SharedRooms
from .trial_seats import (
    RobotStop,
    TrialSeats,
    external_avatars,
    free_place,
    hold_sources,
    link_captures,
    linked_robots,
    movable_robots,
    source_problems,
    with_bodies,
)
from .vr_participant import VrParticipant, avatar_body

TICK = 0.1
"""Interval [s] between two checks of the participants."""
STATUS = 5
"""Checks between two events with the state."""
MARGIN = 0.3
"""Distance [m] of a robot from the limits of its room at which it is stopped."""
STOPPED = "robots are stopped"
CAPTURE = "motion capture "
"""Begin of the names of motion capture among the controls of a run."""
TOUCH = 30
"""Samples of a controller of which a touched point is the median."""
NEW = "participant"
"""Name of the avatar of a trial that has none."""
OPENING = 5.0
"""Longest time [s] that a headset waits for the first trial of a session."""
LIVE = ("xsens:", "natnet:")


@dataclasses.dataclass(frozen=True)
class PauseCause:
    """Why a run or session pauses without the operator.

    Fields:
        kind: ``tracking``: the tracking of a headset was lost; ``gone``: a participant has left; ``asked``: a
            participant asked for it.
        avatar: name of the avatar of the participant.
    """

    kind: Literal["tracking", "gone", "asked"]
    avatar: str

    def __str__(self) -> str:
        if self.kind == "tracking":
            return f"tracking of {self.avatar} was lost"
        return f"{self.avatar} is gone" if self.kind == "gone" else f"{self.avatar} asked for it"


class VrDesk(Desk):
    """The tab for virtual reality: participants, rooms, delays, and pause and stop for everybody.

    Participants move avatars of the trial that runs in the simulator tab, or of the trials of an experiment while the
    session of a participant is open in the experiments tab. A person of a trial with ``source="external"`` is an
    avatar; the trial of the simulator gets one if it has none.
    """

    first_captures: ClassVar[tuple[str, ...]] = ()
    """Motion capture that the session ``main`` opens at its start, such as ``xsens:9763=guest``."""

    name = "vr"

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self.rooms = SharedRooms()
        self._lock = threading.RLock()
        self.captures = CaptureSet()
        self._opening = threading.Lock()
        self.capture_problem = ""
        """Why the motion capture of the start could not be opened."""
        if isinstance(session, AppSession) and session.name == "main":
            self._open_first()
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
        self._pause_cause: PauseCause | None = None
        self._number = 0
        self.address = ""
        """Address of the page of participants; the server sets it."""
        self.mirror, self.own_body = False, True
        self._pose: tuple[str, float] | None = None
        self._robot_margin: float | None = None
        self._captured: tuple[object, ...] = ()
        self._closed = threading.Event()
        self._watcher: threading.Thread | None = None

    def greet(self) -> dict[str, Any]:
        if self.captures.texts:
            self._start_watcher()
        return self.state()

    @web.command
    def state(self) -> dict[str, Any]:
        """Return participants with their latency, settings and rooms."""
        with self._lock:
            pose, cause = self._pose, self._pause_cause
            warnings = {*self._warnings, *source_problems(self._links()), *self._problems()}
            return {
                "participants": [participant.summary() for participant in self.participants.values()],
                "settings": dataclasses.asdict(self.settings),
                "rooms": {name: room.state() for name, room in self.rooms.rooms.items()},
                "captures": self.capture_states(),
                "warnings": sorted(warnings if cause is None else warnings | {f"paused since {cause}"}),
                "pause": None if cause is None else dataclasses.asdict(cause),
                "address": self.address,
                "mirror": self.mirror,
                "own_body": self.own_body,
                "pose": None if pose is None else {"avatar": pose[0], "seconds": max(0.0, pose[1] - time.monotonic())},
                "experiment": self._in_experiment,
                "robot_margin": self._robot_margin,
            }

    @web.command
    def show(self, mirror: bool | None = None, own_body: bool | None = None) -> None:
        """Show or hide the virtual mirror, and the participant's own body."""
        self.mirror = self.mirror if mirror is None else mirror
        self.own_body = self.own_body if own_body is None else own_body
        with self._lock:
            self._note_all({"mirror": self.mirror, "own_body": self.own_body})
        self._tell_state()

    @web.command
    def calibrate_pose(self, avatar: str, seconds: float = 4.0) -> None:
        """Measure stature and arms of a participant in a T or A pose, some seconds from now.

        The headset shows what to do; the event ``vr.measured`` or ``vr.problem`` tells the result.
        """
        if not 0.0 <= seconds <= 60.0:
            raise InputError(f"seconds = {seconds:g}: expected 0 to 60")
        with self._lock:
            self._participant(avatar)
            self._pose = (avatar, time.monotonic() + seconds)
        self._tell_state()

    @web.command
    def pause(self, avatar: str = "") -> None:
        """Pause the run, or the session of the experiment, for everybody; real robots stop at once.

        Args:
            avatar: the participant who asks for it; empty: the operator.
        """
        self._hold_links(True)
        cause = PauseCause("asked", avatar) if avatar in self.participants else None
        experiment = self.experiment
        if experiment is None:
            self.simulator.pause()
        else:
            experiment.pause(str(cause or "virtual reality"))
        with self._lock:
            self._pause_cause = cause
        self._tell_state()

    @web.command
    def resume(self) -> None:
        """Continue the run or the session."""
        with self._lock:
            self._pause_cause = None
        if not self._stop.set:
            self._hold_links(False)
        experiment = self.experiment
        if experiment is None:
            self.simulator.play()
        else:
            experiment.resume()
        self._tell_state()

    @web.command
    def stop_robots(self) -> list[str]:
        """Stop all robots at once: they get velocity 0 until they are released. Returns their names."""
        self._stop.set = True
        self._hold_links(True)
        trial = self._trial()
        names = [] if trial is None else movable_robots(trial)
        for name in names if not self._in_experiment else ():
            self.simulator.take_over(name)
            self.simulator.drive(name, 0.0, 0.0)
        names += [] if trial is None else linked_robots(trial)
        with self._lock:
            self._warnings.add(STOPPED)
            self._note_all({"stops": names})
        self._tell_state()
        return names

    @web.command
    def release_robots(self) -> None:
        """Give the robots back to their navigators."""
        self._stop.set = False
        self._hold_links(False)
        trial = None if self._in_experiment else self._trial()
        for name in () if trial is None else movable_robots(trial):
            self.simulator.release(name)
        with self._lock:
            self._warnings.discard(STOPPED)
            self._note_all({"releases": True})
        self._tell_state()

    def _trial(self) -> Trial | None:
        """Return the trial that runs, or None."""
        if self._in_experiment:
            return None if self._seats is None else self._seats.trial
        with contextlib.suppress(InputError):
            return self.simulator.run.trial
        return None

    def _links(self) -> Sequence[object]:
        """Return the connections of robots in what runs."""
        if self._in_experiment:
            seats = self._seats
            return () if seats is None or seats.links is None else seats.links
        with contextlib.suppress(InputError):
            return self.simulator.run.running.sources
        return ()

    def _hold_links(self, stop: bool) -> None:
        for problem in hold_sources(self._links(), stop):
            self.session.tell("vr.problem", problem)

    def arrive(self, tell: Any, wish: str = "") -> VrParticipant:
        """Add a participant as :meth:`join` does, and watch over everybody from now on."""
        person = self.join(tell, wish)
        self._start_watcher()
        return person

    def _start_watcher(self) -> None:
        with self._lock:
            if self._watcher is None:
                self._watcher = threading.Thread(target=self._watch, name="crowdbot-vr", daemon=True)
                self._watcher.start()

    def _apply_captures(self) -> None:
        for participant in self.participants.values():
            participant.suit = self.suit_of(participant.avatar)
        if self._seats is not None:
            self._seats.capture(self.captures_of(self._seats.trial, self._seats.avatars))
        self._start_watcher()

    def depart(self, person: VrParticipant, cut: bool) -> None:
        """Remove a participant; the run pauses if the connection was cut, and in an experiment always."""
        moving = self._is_moving(person)
        self.leave(person)
        with self._lock:
            self._warnings.discard(f"tracking of {person.avatar} is lost")
        if moving and (cut or self._in_experiment) and self.settings.pause_when_lost:
            self._pause_for(PauseCause("gone", person.avatar))
        self._tell_state()

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        # address of the page of participants as a picture that a headset can read (QR code)
        if path != "link.svg":
            raise KeyError(path)
        return Resource(link_picture(self.address), "image/svg+xml")

    def close(self) -> None:
        self._closed.set()
        for participant in list(self.participants.values()):
            self._discard_recording(participant)
        if self._watcher is not None:
            self._watcher.join(2.0)
        self.close_captures()

    def _watch(self) -> None:
        count = 0
        while not self._closed.wait(TICK):
            count += 1
            try:
                self._check()
                if count % STATUS == 0 and (self.participants or self.captures.texts):
                    self._tell_state()
            except CrowdbotError as error:
                self.session.tell("vr.problem", str(error))

    def _check(self) -> None:
        self.follow_experiment()
        self._measure_when_due()
        people = list(self.participants.values())
        if not self._in_experiment:
            with contextlib.suppress(InputError):
                run = self.simulator.run
                for person in people:
                    if run.controls.get(person.avatar) is not person and run.state == "running":
                        self._attach(run, person)
                self._move_by_captures(run)
                self._stop_at_limits(run)
        self._forget_cause()
        for person in people:
            self._pause_if_lost(person)
        if self._stop.set and STOPPED not in self._warnings:  # a robot was near the limits of its room
            self._warnings.add(STOPPED)
            self._tell_state()

    def _problems(self) -> list[str]:
        return self.unmoved_avatars() + ([self.capture_problem] if self.capture_problem else [])

    def _move_by_captures(self, run: LiveRun) -> None:
        """Let motion capture move robots, and avatars without a headset, of a run of the simulator."""
        worn = [
            participant.avatar
            for participant in self.participants.values()
            if run.controls.get(participant.avatar) is participant
        ]
        wanted = (run, self.captures.texts, tuple(worn))
        if run.state != "running" or wanted == self._captured:
            return
        self._captured = wanted
        for name in [name for name in run.controls if name.startswith(CAPTURE)]:
            run.controls.pop(name, None)
        found = link_captures(self.captures_of(run.trial, worn), self._links())
        run.controls.update({f"{CAPTURE}{k}": one for k, one in enumerate(found)})

    def _measure_when_due(self) -> None:
        pose = self._pose
        if pose is None or time.monotonic() < pose[1]:
            return
        self._pose = None
        try:
            found = self.take_pose(pose[0])
            self.session.tell("vr.measured", {"avatar": pose[0], **found._asdict()})
        finally:
            self._tell_state()

    def _is_moving(self, person: VrParticipant) -> bool:
        """Return whether a participant moves an avatar of what runs."""
        seats = self._seats
        if self._in_experiment:
            return seats is not None and person.avatar in seats.names
        with contextlib.suppress(InputError):
            return self.simulator.run.controls.get(person.avatar) is person
        return False

    def _pause_if_lost(self, person: VrParticipant) -> None:
        """Pause when tracking is lost; only the operator continues."""
        lost, words = person.is_lost() and person.stream.last > 0.0, f"tracking of {person.avatar} is lost"
        with self._lock:
            if lost == (words in self._warnings):
                return
            self._warnings ^= {words}
        if lost and self.settings.pause_when_lost and self._is_moving(person):
            self._pause_for(PauseCause("tracking", person.avatar))
        self._tell_state()

    def _pause_for(self, cause: PauseCause) -> None:
        self._hold_links(True)
        if self._is_paused():  # the first cause stands
            return
        with contextlib.suppress(InputError):  # paused already, or ended
            experiment = self.experiment
            if experiment is None:
                self.simulator.pause()
            else:
                experiment.pause(str(cause))
        with self._lock:
            self._pause_cause = cause

    def _forget_cause(self) -> None:
        """Forget why the run or session paused once it goes on, whoever continued it."""
        cause = self._pause_cause
        if cause is None or self._is_paused():
            return
        with self._lock:
            if self._pause_cause is cause:
                self._pause_cause = None
        self._tell_state()

    def _is_paused(self) -> bool:
        experiment = self.experiment
        if experiment is not None:
            return experiment.paused
        try:
            return self.simulator.run.loop.paused
        except InputError:  # no run
            return False

    def _near_limits(self, simulation: Simulation) -> bool:
        self._robot_margin = None
        if self.rooms.rooms["robot"].limits is None:
            return False
        scene = simulation.world.environment_scene(0)
        places = [scene.position[0, robot.agent] for robot in simulation.robots if scene.active[0, robot.agent]]
        margins = [self.rooms.margin("robot", *place.tolist()) or 0.0 for place in places]
        self._robot_margin = min(margins, default=None)
        return any(margin < MARGIN for margin in margins)

    def _stop_at_limits(self, run: LiveRun) -> None:
        """Stop the robots if one of them is near the limits of its room."""
        if self.rooms.rooms["robot"].limits is None:
            self._robot_margin = None
            return
        near = run.state == "running" and run.do(lambda: self._near_limits(run.simulation))
        if near and STOPPED not in self._warnings:
            self.stop_robots()

    def _tell_state(self) -> None:
        state = self.state()
        self.session.tell("vr.state", json.loads(json.dumps(state)))

    @property
    def simulator(self) -> SimulatorDesk:
        """The simulator tab of the session."""
        simulator_desk = self.session.desk("simulator") if isinstance(self.session, AppSession) else None
        if not isinstance(simulator_desk, SimulatorDesk):
            raise InputError("virtual reality needs the simulator tab")
        return simulator_desk

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
                for participant in self.participants.values():
                    if run.controls.get(participant.avatar) is participant:
                        del run.controls[participant.avatar]
                if opened:
                    self.simulator.pause()
            names = self._experiment_avatars() if opened else self._simulator_avatars()
            people, self.participants = list(self.participants.values()), {}
            for person in people:
                free = [name for name in names if name not in self.participants]
                if person.avatar not in free and free:
                    person.move_to(free[0])
                self.participants[person.avatar] = person
                self._discard_recording(person)
                if not opened:
                    person.record_to(self._recorder())
            if not opened:
                self.bodies.clear()  # the next participant has another size
        self._tell_state()

    def join_trial(self, trial: Trial, folder: Path) -> tuple[Trial, Sequence[OrderSource]]:
        self.follow_experiment()
        with self._lock:
            if not any(avatar.source == "external" for avatar in trial.avatars):
                return trial, ()
            stop = RobotStop()
            stop.set = self._stop.set
            trial = with_bodies(trial, self.bodies)
            self._stop = stop
            self._seats = TrialSeats(trial, folder, stop, self._near_limits)
            self._pause_cause = None
            self._warnings = {warning for warning in self._warnings if not warning.startswith("tracking")}
            for participant in self.participants.values():
                self._take_seat(self._seats, participant)
            self._seats.capture(self.captures_of(trial, self._seats.avatars))
            return trial, [self._seats]

    def leave_trial(self) -> None:
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
        rest = [avatar for avatar in seats.trial.avatars if avatar.source == "external" and avatar.name not in moved]
        ways = {True: "a headset or motion capture", False: "motion capture"}
        return [f"nothing moves {item.name!r}: it needs {ways[item.headset]}" for item in rest]

    @web.command
    def set(self, settings: dict[str, Any]) -> None:
        """Change settings: delays and noise [s], [m], timeout, and whether a run pauses when tracking is lost."""
        known = {field.name for field in dataclasses.fields(StreamSettings)}
        unknown = [name for name in settings if name not in known]
        if unknown:
            raise InputError(f"setting {unknown[0]!r} does not exist; settings are {', '.join(sorted(known))}")
        with self._lock:
            self.settings = dataclasses.replace(self.settings, **settings)
            for participant in self.participants.values():
                participant.apply(self.settings)
            self._note_all({"settings": dataclasses.asdict(self.settings)})
        self._tell_state()

    @web.command
    def add_wrist_pair(self, avatar: str, x: float, y: float, z: float, side: str = "right") -> int:
        """Add a calibration point: the wrist of a participant is at x, y, z [m] of the virtual room.

        The median of the last 30 samples counts. Returns the number of points.
        """
        with self._lock:
            person = self._participant(avatar)
            items = [item for item in person.history(TOUCH) if getattr(item, side, None) is not None]
            if side not in ("left", "right") or not items:
                raise InputError(f"the {side} controller or hand of {avatar!r} is not tracked")
            rows = [getattr(one, side)[:3].tolist() for one in items]
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
            heights = [float(item.head[2]) for item in person.history(TOUCH) if item.head is not None]
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
            body_measure = measure_pose(person.history(TOUCH + 10), self._body_of(avatar)[0])
            self._wear(person, body_measure)
        return body_measure

    def _wear(self, person: VrParticipant, measure: BodyMeasure) -> None:
        self.bodies[person.avatar] = measure
        self._note(person, {"body": measure._asdict()})
        if not self._in_experiment:
            self.simulator.run_trial(with_bodies(self.simulator.run.trial, self.bodies))

    def _body_of(self, avatar: str) -> tuple[str, float]:
        """Return the name of the body of an avatar, and its stature over the height of its eyes."""
        if self._in_experiment:
            specs = [item for trial in self._experiment_trials() for item in trial.avatars if item.name == avatar]
            name = next((spec.body for spec in specs if spec.body), "mannequin")
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
        own = next(avatar for avatar in seats.trial.avatars if avatar.name == person.avatar)
        room = self.rooms.room(person.room)
        room.guess_place(own.x, own.y, own.heading)
        self._note(person, {"avatar": person.avatar, "trial": seats.trial.name, "room": room.state(),
                            "settings": dataclasses.asdict(self.settings)})  # fmt: skip

    def _room_of(self, avatar: str) -> str:
        """Return the name of the room of the participant who moves an avatar; a second headset has its own origin."""
        taken = any(participant.room == PERSON for participant in self.participants.values())
        if avatar not in self._room_names or (taken and self._room_names[avatar] == PERSON):
            self._room_names[avatar] = self.rooms.add_person(avatar) if taken else PERSON
        return self._room_names[avatar]

    def _attach(self, run: LiveRun, person: VrParticipant) -> None:
        avatars = {avatar.name: avatar for avatar in run.trial.avatars if avatar.name in external_avatars(run.trial)}
        if person.avatar not in avatars:
            return
        own, room = avatars[person.avatar], self.rooms.room(person.room)
        if self._placed.get(person.room) is not run:
            room.guess_place(own.x, own.y, own.heading)
        run.controls[person.avatar] = person
        self._placed[person.room] = run
        self._note(person, {"avatar": person.avatar, "trial": run.trial.name, "seed": run.seed, "room": room.state(),
                            "settings": dataclasses.asdict(self.settings)})  # fmt: skip

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
        for participant in list(self.participants.values()):
            if participant.recorder is not None and not self._in_experiment:
                target = f"{saved[0].removesuffix('.mcap')}-{participant.avatar}.headset"
                shutil.copyfile(participant.recorder.path, self.session.workspace.writable(target))
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
        for participant in self.participants.values():
            self._note(participant, values)

    @web.command
    def add_capture(self, capture: str) -> None:
        """Open motion capture that moves an avatar or robot, such as xsens:9763=guest or natnet:HOST#Cart=robot.

        The connection to a NatNet server is made in the background, since the stop button must not wait for it; the
        event ``vr.problem`` says why it failed.
        """
        if not capture.startswith(LIVE):
            raise InputError(f"motion capture {capture!r:.80}: expected xsens:PORT=NAME or natnet:SERVER#SUBJECT=NAME")
        parse_binding(capture)
        if capture.startswith("natnet:"):
            threading.Thread(target=self._connect, args=(capture,), name="crowdbot-natnet", daemon=True).start()
        else:
            self._open(capture)

    def _connect(self, capture: str) -> None:
        try:
            self._open(capture)
        except InputError as error:
            self.session.tell("vr.problem", str(error))

    def _open(self, capture: str) -> None:
        with self._opening:
            self.captures.add(capture)
        with self._lock:
            self._apply_captures()
        self._tell_state()

    @web.command
    def remove_capture(self, capture: str) -> None:
        """Release what motion capture moves; a system without targets is closed."""
        with self._opening:
            self.captures.remove(capture)
        with self._lock:
            self._apply_captures()
        self._tell_state()

    def capture_states(self) -> list[dict[str, Any]]:
        """Return each binding with number, rate, losses and age of its samples, JSON."""
        result = []
        for text, binding in self.captures.bindings.items():
            target, known = binding.target, self.captures.stream_of(binding.target)
            if known is None:
                continue
            stream, subject = known
            counts, latency = stream.statistics(subject), stream.latency()
            age = None if latency is None else round(1e3 * latency[0], 1)
            result.append(
                {"capture": text, "target": target, "samples": counts.samples, "rate": round(counts.rate, 1),
                 "lost": counts.lost, "refused": counts.refused, "reason": counts.reason, "age": age}
            )  # fmt: skip
        return result

    def suit_of(self, avatar: str) -> Suit | None:
        """Return the suit of a participant with a headset, or None."""
        known = self.captures.stream_of(avatar)
        return None if known is None else Suit(*known)

    def captures_of(self, trial: Trial, worn: Sequence[str]) -> list[MotionCapture]:
        """Return what moves the robots of a trial and avatars without a headset.

        Args:
            trial: the trial.
            worn: names of avatars whose participants have a headset.
        """
        place = self.rooms.room("robot").place

        def origin() -> tuple[float, float, float]:
            return float(place.translation[0]), float(place.translation[1]), place.heading

        return self.captures.captures_of(trial, worn, origin)

    def close_captures(self) -> None:
        """Close all systems."""
        with self._opening:
            self.captures.close()

    def _open_first(self) -> None:
        for text in self.first_captures:
            try:
                self.captures.add(text)
            except InputError as error:
                self.capture_problem = str(error)

    @web.command
    def add_pair(self, room: str, source: list[float], target: list[float]) -> None:
        """Add a calibration point: coordinates in a room, such as ``robot``, and in the virtual room [m]."""
        with self._lock:
            self.rooms.add_pair(room, source, target)
        self._tell_state()

    @web.command
    def clear_points(self, room: str) -> None:
        """Remove the calibration points of a room."""
        with self._lock:
            self.rooms.clear(room)
        self._tell_state()

    @web.command
    def calibrate(self, room: str) -> dict[str, Any]:
        """Compute the place of a room from its points; returns it with the residuals."""
        with self._lock:
            self.rooms.calibrate(room)
            result = self.rooms.room(room).state()
            self._note_all({"calibration": {"room": room, **result}})
        self._tell_state()
        return result

    @web.command
    def place_room(self, room: str, x: float, y: float, heading: float = 0.0) -> None:
        """Set the place of a room without calibration: its origin and heading in the virtual room [m], [rad]."""
        with self._lock:
            self.rooms.room(room).set_place(RigidTransform.at(float(x), float(y), float(heading)))
        self._tell_state()

    @web.command
    def limit_room(self, room: str, corners: list[Any]) -> None:
        """Set the free floor of a room: corners x, y [m] in its frame; an empty list removes the limits."""
        with self._lock:
            self.rooms.room(room).limits = RoomLimits(tuple(corners)) if corners else None
        self._tell_state()

    @web.command
    def save_rooms(self, name: str = "rooms") -> str:
        """Write places, points and limits of the rooms to NAME.json in the folder of the app; returns its name."""
        target = name if name.endswith(".json") else f"{name}.json"
        with self._lock:
            text = json.dumps(self.rooms.record(), indent=1)
        self.session.workspace.writable(target).write_text(text + "\n", encoding="utf-8")
        return target

    @web.command
    def load_rooms(self, name: str = "rooms") -> None:
        """Take the rooms of a file that :meth:`save_rooms` has written."""
        path = self.session.workspace.readable(name if name.endswith(".json") else f"{name}.json")
        try:
            record = json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise InputError(f"{path.name} is not JSON: {error}") from None
        with self._lock:
            self.rooms.restore(record)
            self._note_all({"rooms": self.rooms.record()})
        self._tell_state()


def _with_avatar(run: LiveRun) -> Trial:
    """Return the trial with a person who is moved from outside, at the place of most room."""
    x, y = run.do(lambda: free_place(run.simulation))
    xml = f'<avatar name="{NEW}" source="external" x="{x:g}" y="{y:g}"/>'
    return add_element(run.trial, xml, place=f"trial {run.trial.name!r} with a participant", trust=False)
