"""Measurements of ``crowdbot bench``: what the picture of a simulation costs the server."""

from __future__ import annotations

import dataclasses
import statistics
import time
from collections.abc import Callable

from crowdbot.benchmark import Gauge, Measurement
from crowdbot.sensors import Lidar2D
from crowdbot.simulation import Simulation
from crowdbot.trials import Mount, Trial, load_trial
from crowdbot.world import PeopleMotion

from .frame import scene_frame
from .walking_bodies import WalkingBodies

PEOPLE, BEAMS = 200, 1080
STATES, REPEATS = 10, 20
"""States of a timed call, and calls of the measurement of processor time."""
RATE, SHARE = 60.0, 0.1
"""States a second that a page gets, and the share of a processor core for them."""


def app_measurements() -> dict[str, Callable[[], Measurement | Gauge]]:
    """Return functions that prepare the measurements, by name.

    ``app`` is the processor time for a state of 200 people and a robot with 1080 beams, from the positions of the
    simulation to the bytes of the frame, against 60 states a second on 10 % of a core; ``app-step`` compares its speed
    with that of the steps of the simulation itself; ``app-bytes`` is the size of the frame.

    >>> sorted(app_measurements())
    ['app', 'app-bytes', 'app-step']
    """
    return {"app": _processor_time, "app-step": _against_steps, "app-bytes": _bytes}


class _Picture:
    """A simulation whose picture is sent after each step."""

    def __init__(self) -> None:
        self.simulation = Simulation(_trial(), 0)
        self.simulation.begin()
        self.simulation.advance()
        self._bodies, self._step = WalkingBodies(self.simulation), self.simulation.trial.step

    def advance(self) -> None:
        """Advance the simulation by a number of steps."""
        for _ in range(STATES):
            self.simulation.advance()

    def encode(self) -> int:
        """Walk to the positions of the simulation and encode the state, a number of times; return its bytes."""
        size = 0
        for _ in range(STATES):
            self._bodies.walk(self.simulation, self._step)
            motion: PeopleMotion | None = self._bodies.motion
            size = len(scene_frame(self.simulation, ["scans"], motion).encode())
        return size


def _trial() -> Trial:
    trial = load_trial(f"challenge-against-{PEOPLE}")
    scanner = dataclasses.replace(trial.robots[0], sensors=(Mount(sensor=Lidar2D(rays=BEAMS, range_max=25.0)),))
    return dataclasses.replace(trial, robots=(scanner,))


def _processor_time() -> Gauge:
    picture, times = _Picture(), list[float]()
    for _ in range(1 + REPEATS):
        picture.advance()
        begin = time.thread_time()
        picture.encode()
        times.append(time.thread_time() - begin)
    words = f"{RATE:g} states/s on {100 * SHARE:g} % of a core, {PEOPLE} people"
    return Gauge("states/CPU s", STATES / statistics.median(times[1:]), words, RATE / SHARE)


def _against_steps() -> Measurement:
    picture = _Picture()
    words = f"steps of the simulation, {PEOPLE} people"
    return Measurement("states/s", STATES, picture.encode, words, other=picture.advance, other_amount=STATES)


def _bytes() -> Gauge:
    return Gauge("B", float(_Picture().encode()), "60 kB", 60_000.0)
