"""VrDesk: what the operator sees of virtual reality, and what makes it safe."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import threading
import time
from collections.abc import Sequence
from typing import Any

from crowdbot import web
from crowdbot.core import CrowdbotError, InputError
from crowdbot.simulation import Simulation
from crowdbot.trials import Trial
from crowdbot.web import DeskWindows, LiveRun, Resource

from .capture import link_captures
from .link_code import link_picture
from .participants_desk import ParticipantsDesk
from .robot_stop import hold_sources, linked_robots, movable_robots, source_problems
from .vr_participant import VrParticipant

__all__ = ["VrDesk"]

TICK = 0.1
"""Interval [s] between two checks of the participants."""
STATUS = 5
"""Checks between two events with the state."""
MARGIN = 0.3
"""Distance [m] of a robot from the limits of its room at which it is stopped."""
STOPPED = "robots are stopped"
CAPTURE = "motion capture "
"""Begin of the names of motion capture among the controls of a run."""


class VrDesk(ParticipantsDesk):
    """The tab for virtual reality: participants, rooms, delays, and pause and stop for everybody.

    Participants move avatars of the trial that runs in the simulator tab, or of the trials of an experiment while the
    session of a participant is open in the experiments tab. A person of a trial with ``source="external"`` is an
    avatar; the trial of the simulator gets one if it has none.
    """

    name = "vr"

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self.address = ""
        """Address of the page of participants; the server sets it."""
        self.mirror, self.own_body = False, True
        self._pose: tuple[str, float] | None = None
        self._robot_margin: float | None = None
        self._captured: tuple[object, ...] = ()
        self._closed = threading.Event()
        self._watcher: threading.Thread | None = None

    def greet(self) -> dict[str, Any]:
        """Return the state."""
        if self.captures.texts:
            self._start_watcher()
        return self.state()

    @web.command
    def state(self) -> dict[str, Any]:
        """Return participants with their latency, settings and rooms."""
        with self._lock:
            pose = self._pose
            return {
                "participants": [one.summary() for one in self.participants.values()],
                "settings": dataclasses.asdict(self.settings),
                "rooms": {name: room.state() for name, room in self.rooms.rooms.items()},
                "captures": self.capture_states(),
                "warnings": sorted({*self._warnings, *source_problems(self._links()), *self._problems()}),
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
    def pause(self) -> None:
        """Pause the run, or the session of the experiment, for everybody; real robots stop at once."""
        self._hold_links(True)
        experiment = self.experiment
        if experiment is None:
            self.simulator.pause()
        else:
            experiment.pause("virtual reality")

    @web.command
    def resume(self) -> None:
        """Continue the run or the session."""
        with self._lock:
            self._warnings = {one for one in self._warnings if not one.startswith("paused")}
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
        super()._apply_captures()
        self._start_watcher()

    def depart(self, person: VrParticipant, cut: bool) -> None:
        """Remove a participant; the run pauses if the connection was cut, and in an experiment always."""
        moving = self._is_moving(person)
        self.leave(person)
        with self._lock:
            self._warnings.discard(f"tracking of {person.avatar} is lost")
        if moving and (cut or self._in_experiment) and self.settings.pause_when_lost:
            self._pause_for(f"paused since {person.avatar} is gone")
        self._tell_state()

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        """Return the address of the page of participants as a picture that a headset can read (QR code)."""
        if path != "link.svg":
            raise KeyError(path)
        return Resource(link_picture(self.address), "image/svg+xml")

    def close(self) -> None:
        """Stop the checks and close the recordings."""
        self._closed.set()
        for one in list(self.participants.values()):
            self._discard_recording(one)
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
                for one in people:
                    if run.controls.get(one.avatar) is not one and run.state == "running":
                        self._attach(run, one)
                self._move_by_captures(run)
                self._stop_at_limits(run)
        for one in people:
            self._pause_if_lost(one)
        if self._stop.set and STOPPED not in self._warnings:  # a robot was near the limits of its room
            self._warnings.add(STOPPED)
            self._tell_state()

    def _problems(self) -> list[str]:
        return self.unmoved_avatars() + ([self.capture_problem] if self.capture_problem else [])

    def _move_by_captures(self, run: LiveRun) -> None:
        """Let motion capture move robots, and avatars without a headset, of a run of the simulator."""
        worn = [one.avatar for one in self.participants.values() if run.controls.get(one.avatar) is one]
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
            self._pause_for(f"paused since tracking of {person.avatar} was lost")
        self._tell_state()

    def _pause_for(self, reason: str) -> None:
        with self._lock:
            self._warnings.add(reason)
        self._hold_links(True)
        with contextlib.suppress(InputError):  # paused already, or ended
            experiment = self.experiment
            if experiment is None:
                self.simulator.pause()
            else:
                experiment.pause(reason.removeprefix("paused since "))

    def _near_limits(self, simulation: Simulation) -> bool:
        self._robot_margin = None
        if self.rooms.rooms["robot"].limits is None:
            return False
        scene = simulation.world.environment_scene(0)
        places = [scene.position[0, one.agent] for one in simulation.robots if scene.active[0, one.agent]]
        margins = [self.rooms.margin("robot", *place.tolist()) or 0.0 for place in places]
        self._robot_margin = min(margins, default=None)
        return any(one < MARGIN for one in margins)

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
