"""Participants of a trial, and the stop of its robots."""

from __future__ import annotations

import dataclasses
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.bridges import MotionCapture, RealRobotLink
from crowdbot.core import InputError
from crowdbot.experiments import write_trial_latency
from crowdbot.metrics import wall_clearance
from crowdbot.navigation import ExternalNavigator
from crowdbot.simulation import Order, OwnSource, ParameterOrder, Simulation, VelocityOrder, open_own_sources
from crowdbot.trials import RobotSpec, Trial
from crowdbot.web import navigator_orders

from .body_estimate import BodyMeasure
from .capture import StreamTap
from .headset_sample import HeadsetRecorder
from .latency import read_headset_latency
from .vr_participant import VrParticipant

SOURCE = "vr"
OPERATOR = "the stop button"
"""Reason for robots with a connection."""
REPEAT = 0.2
"""Simulated time [s] after which the velocity is ordered again."""


class RobotStop:
    """Stops all robots of a trial while it is set, and gives them back to their navigators afterwards.

    It is a source of orders: whatever happens is in the episode. Robots with a connection of their navigator are
    stopped there (:func:`hold_sources`). A robot with ``<pose>`` is where its source says: it is stopped at itself.

    >>> from crowdbot.trials import load_trial
    >>> stop = RobotStop()
    >>> stop.set = True
    >>> [type(order).__name__ for order in stop.orders(Simulation(load_trial("frontal")))]
    ['ParameterOrder', 'VelocityOrder']
    """

    def __init__(self) -> None:
        self.set = False
        """Whether the robots are to stand."""
        self._held: dict[str, list[Order]] = {}
        self._returns: list[Order] = []
        self._due = 0

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the orders for this step."""
        if not self.set:
            self._returns += [order for orders in self._held.values() for order in orders]
            self._held.clear()
            return [self._returns.pop(0)] if self._returns else []  # one a step: each needs the one before
        found: list[Order] = []
        names = movable_robots(simulation.trial)
        for robot in simulation.trial.robots:
            if robot.name in names and robot.name not in self._held:
                own = isinstance(robot.navigator, ExternalNavigator)
                self._held[robot.name] = [] if own else navigator_orders(robot.name, robot.navigator)
                path = f"robot[{robot.name}]/navigator/type"
                found += [] if own else [ParameterOrder(path=path, value="external", source=SOURCE)]
                self._due = simulation.tick
        if simulation.tick >= self._due:
            self._due = simulation.tick + round(REPEAT / simulation.world.clock.dt)
            found += [VelocityOrder(robot=name, source=SOURCE) for name in names]
        return found


def movable_robots(trial: Trial) -> list[str]:
    """Return the names of the robots that orders can stop."""
    return [robot.name for robot in trial.robots if robot.mirror is None and not _has_source(robot)]


def linked_robots(trial: Trial) -> list[str]:
    """Return the names of the robots that are stopped at the connection of their navigator."""
    return [robot.name for robot in trial.robots if _has_source(robot)]


def hold_sources(sources: Sequence[object], stop: bool) -> list[str]:
    """Stop or release the robots of connections; return why some of them are not released."""
    found = [source.hold(stop, OPERATOR) for source in sources if isinstance(source, OwnSource)]
    return [one for one in found if one]


def source_problems(sources: Sequence[object]) -> list[str]:
    """Return why robots of connections stand."""
    return [line for source in sources if isinstance(source, OwnSource) for line in source.problems()]


def _has_source(robot: RobotSpec) -> bool:
    return isinstance(robot.navigator, ExternalNavigator) and bool(robot.navigator.source)


CAPTURES = "motion-capture"
"""Name of the file of the raw samples of motion capture, as that of an avatar."""
Watch = Callable[[Simulation], bool]
RADIUS = 0.3
"""Radius [m] of the person who is placed."""
ENOUGH = 1.5
"""Clearance [m] above which another place is not better."""
REACH, SPACING = 6.0, 0.5
"""Extent and spacing [m] of the places that are compared."""
NEARNESS = 0.05
"""Clearance [m] that is worth one metre of distance."""


class TrialSeats:
    """Gives the avatars of one trial to participants; those who come late, or again, take their seat while it runs.

    Args:
        trial: the trial.
        folder: folder of the trial, for the raw messages of each participant.
        stop: holds the robots.
        watch: returns whether the robots must stop; called in the thread of the run.
    """

    def __init__(self, trial: Trial, folder: Path, stop: RobotStop, watch: Watch) -> None:
        self.trial, self.folder = trial, folder
        self.names = external_avatars(trial)
        self._stop, self._watch, self._held = stop, watch, False
        self._seated: dict[str, VrParticipant] = {}
        self._captures: Sequence[MotionCapture] = ()
        self._moved: list[MotionCapture] | None = None
        self._raw: HeadsetRecorder | None = None
        self._lock = threading.Lock()
        self._files: dict[str, list[Path]] = {}
        self.links: tuple[OwnSource, ...] | None = None
        """Connections of navigators, such as to a real robot; None before the first step."""

    def seat(self, person: VrParticipant) -> None:
        """Give a participant the avatar with its name, and record its messages in the folder of the trial."""
        if person.avatar not in self.names:
            return
        file = _free_file(self.folder, person.avatar)
        self._files.setdefault(person.avatar, []).append(file)
        person.record_to(HeadsetRecorder(file))
        self._seated[person.avatar] = person

    @property
    def avatars(self) -> list[str]:
        """Names of the avatars that participants in headsets move."""
        return list(self._seated)

    def capture(self, captures: Sequence[MotionCapture]) -> None:
        """Let motion capture move robots, and avatars without a headset, from the next step on."""
        taps = [MotionCapture(StreamTap(capture.stream, self._note_sample), capture.bindings) for capture in captures]
        self._captures, self._moved = taps, None

    def _note_sample(self, record: dict[str, Any]) -> None:
        """Write a sample of motion capture, from any thread."""
        with self._lock:
            if self._raw is None:
                self._raw = HeadsetRecorder(_free_file(self.folder, CAPTURES))
        self._raw.note(time.monotonic(), record)

    def leave(self, person: VrParticipant) -> None:
        """Take the avatar away from a participant."""
        if self._seated.get(person.avatar) is person:
            del self._seated[person.avatar]
            person.record_to(None)

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the orders of the participants for this step, and those that hold the robots."""
        if self._watch(simulation):
            self._stop.set = True
        found = self._linked(simulation)
        found += self._stop.orders(simulation)
        for person in list(self._seated.values()):
            found += person.orders(simulation)
        if self._moved is None:
            self._moved = link_captures(self._captures, self.links or ())
        for item in self._moved:
            found += item.orders(simulation)
        return found

    def hold(self, stop: bool) -> list[str]:
        """Stop or release the robots that have a connection; return why some of them are not released."""
        return hold_sources(self.links or (), stop)

    def _linked(self, simulation: Simulation) -> list[Order]:
        """Return the orders of the connections, which this source opens, since it takes their place."""
        if self.links is None:
            self.links = open_own_sources(simulation)
            self._moved = link_captures(self._captures, self.links)
        if self._stop.set and not self._held:
            self.hold(True)
        self._held = self._stop.set
        return [order for link in self.links for order in link.orders(simulation)]

    def close(self) -> None:
        """Close the recordings and connections, and write the latencies of the trial to its folder."""
        for link in self.links or ():
            link.close()
        for person in list(self._seated.values()):
            self.leave(person)
        if self._raw is not None:
            self._raw.close()
        if self._files and self.folder.is_dir():
            found = {name: read_headset_latency(files).of_trial() for name, files in self._files.items()}
            write_trial_latency(self.folder, found)


def external_avatars(trial: Trial) -> list[str]:
    """Return the names of the avatars of a trial that participants in headsets can move."""
    return [avatar.name for avatar in trial.avatars if avatar.source == "external" and avatar.headset]


def with_bodies(trial: Trial, bodies: dict[str, BodyMeasure]) -> Trial:
    """Return a trial whose avatars have the size of their participants, by the names of the avatars."""
    avatars = tuple(
        dataclasses.replace(avatar, height=bodies[avatar.name].stature, body=bodies[avatar.name].body)
        if avatar.name in bodies and avatar.source == "external"
        else avatar
        for avatar in trial.avatars
    )
    return dataclasses.replace(trial, avatars=avatars)


def _free_file(folder: Path, avatar: str) -> Path:
    for count in range(1, 1000):
        file = folder / f"{avatar}{'' if count == 1 else f'-{count}'}.headset"
        if not file.exists():
            return file
    raise InputError(f"{folder} has 999 recordings of a headset")


def link_captures(captures: Sequence[MotionCapture], links: Sequence[object]) -> list[MotionCapture]:
    """Give motion capture of real robots to their connections, and return what moves everybody else."""
    rest = []
    for capture in captures:
        targets = [binding.target for binding in capture.bindings]
        own = [link for link in links if isinstance(link, RealRobotLink) and link.robot in targets]
        for link in own:
            link.use_capture(MotionCapture(capture.stream, [b for b in capture.bindings if b.target == link.robot]))
        others = [b for b in capture.bindings if b.target not in {link.robot for link in own}]
        if others:
            rest.append(MotionCapture(capture.stream, others))
    return rest


def free_place(simulation: Simulation) -> tuple[float, float]:
    """Return x, y [m] of a place with clearance to walls and everybody, that is seen by a robot or person.

    Places near the middle of all are preferred.

    >>> from crowdbot.trials import load_trial
    >>> x, y = free_place(Simulation(load_trial("frontal")))
    >>> abs(x) < 20.0 and abs(y) < 20.0
    True
    """
    scene = simulation.world.environment_scene(0)
    others, walls = scene.position[0, scene.active[0]], scene.walls.segments()
    middle = others.mean(axis=0) if len(others) else np.zeros(2)
    start = others[np.argmin(np.linalg.norm(others - middle, axis=1))] if len(others) else middle
    steps = np.arange(-REACH, REACH + SPACING, SPACING)
    best, found = -np.inf, start
    for place in np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) + middle:
        gap = float(np.min(np.linalg.norm(others - place, axis=1), initial=np.inf)) - 2.0 * RADIUS
        gap = min(gap, float(wall_clearance(np.stack([start, place]), 0.01, walls)[1]), _gap(place, walls), ENOUGH)
        score = gap - NEARNESS * float(np.linalg.norm(place - middle))
        if score > best:
            best, found = score, place
    return round(float(found[0]), 3), round(float(found[1]), 3)


def _gap(place: np.ndarray, walls: np.ndarray) -> float:
    return float(wall_clearance(place[None], RADIUS, walls)[0])
