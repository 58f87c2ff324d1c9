"""StageView: what a window sees of a simulation: description, frames and live values."""

from __future__ import annotations

import threading
import time
from dataclasses import replace
from typing import Any

import numpy as np

from crowdbot.core import InputError, Scene
from crowdbot.prediction import ConstantVelocity, Predictor
from crowdbot.simulation import Simulation
from crowdbot.web.desk import DeskWindows
from crowdbot.web.scene import (
    LAYERS,
    PredictedPaths,
    RecordedScene,
    SceneInstant,
    WalkingBodies,
    instant_frame,
    scene_description,
    scene_revision,
)
from crowdbot.web.state_frame import StateFrame
from crowdbot.world import PeopleMotion, worlds_of

from .camera_feed import CameraFeed
from .live_values import live_values

FRAME = 1.0 / 60.0
"""Shortest real time [s] between two frames."""
SHARE = 0.1
"""Largest share of a processor core for the frames; large crowds get fewer of them."""
STATUS = 0.2
"""Shortest real time [s] between two events with the status."""


class StageView:
    """Sends a simulation to the windows of a session: at most 60 frames a second, however fast it runs.

    Args:
        session: the windows.
        layers: names of the layers that a window shows.
        channel: channel of the frames.
        predictor: predicts the paths of people (default: constant velocity).
        cameras: sends the images of cameras (default: they are not sent).
    """

    def __init__(
        self,
        session: DeskWindows,
        layers: frozenset[str] = frozenset(),
        channel: str = "scene",
        predictor: Predictor | None = None,
        cameras: CameraFeed | None = None,
    ) -> None:
        self.session, self.layers, self.channel = session, layers, channel
        self._cameras = cameras
        self._bodies: WalkingBodies | None = None
        self._simulation: Simulation | None = None
        self._recorded: RecordedScene | None = None
        self._seconds = 0.0
        self._shown = self._told = 0.0
        self._closed, self._cost, self._owed = False, 0.0, False
        self._sending = threading.Lock()
        self._rate: tuple[float, float] | None = None
        self.predictor = predictor or ConstantVelocity()
        """Predictor of the layer ``paths``."""
        self._paths: PredictedPaths | None = None
        self.factor: float | None = None
        """Simulated time over real time since the status before."""

    def open(self, simulation: Simulation) -> None:
        """Show another simulation, or the same one after a jump in time."""
        self._simulation, self._bodies, self._rate = simulation, WalkingBodies(simulation), None
        self._recorded = self._paths = None

    def open_recording(self, recorded: RecordedScene, seconds: float) -> None:
        """Show an episode as it was recorded, from an instant [s] on."""
        self._simulation, self._recorded, self._rate = recorded.simulation, recorded, None
        self._seconds = seconds

    def move(self, seconds: float) -> None:
        """Go to another instant [s] of a recorded episode."""
        self._seconds = seconds

    @property
    def simulation(self) -> Simulation:
        """The simulation that is shown; of a recorded episode, one of its trial.

        Raises:
            InputError: nothing is shown yet.
        """
        if self._simulation is None:
            raise InputError("the simulation is not ready yet")
        return self._simulation

    @property
    def recording_instant(self) -> SceneInstant | None:
        """The recorded instant; None for a simulation."""
        return None if self._recorded is None else self._recorded.at(self._seconds)

    def close(self) -> None:
        """Send nothing more: the windows show something else. Called from any thread."""
        with self._sending:
            self._closed = True

    def description(self) -> dict[str, Any]:
        """Return what stands still."""
        if self._simulation is None:
            return {}
        return scene_description(self._simulation, self._motion)

    @property
    def _motion(self) -> PeopleMotion | None:
        if self._recorded is not None:
            return self._recorded.motion
        return None if self._bodies is None else self._bodies.motion

    def walk(self) -> None:
        """Let the bodies walk to the current positions, without a frame."""
        if self._bodies is not None and self._simulation is not None:
            self._bodies.follow(self._simulation)

    def prepare(self) -> None:
        """Compute a frame that is not sent, because the first one compiles kernels."""
        instant_frame(self._instant(self.simulation), [name for name in LAYERS if name in self.layers])

    def show(self, always: bool = False) -> bool:
        """Send a frame if one is due and a window can take it; return whether it was sent.

        A window that has not yet drawn the frames before costs nothing here. What it has missed is sent by
        :meth:`settle`.
        """
        now = time.monotonic()
        if self._closed or self._simulation is None:
            return False
        self._offer_images(self._simulation)
        early = now - self._shown < max(FRAME, self._cost / SHARE)
        if not always and (early or not self.session.is_ready(self.channel)):
            self._owed = True
            return False
        self._shown, self._owed = now, False
        layers = [name for name in LAYERS if name in self.layers]
        begin = time.thread_time()
        frame = instant_frame(self._instant(self._simulation), layers)
        stamp = {"stamp": np.array([time.monotonic()])}  # headsets tell when they have drawn it
        self._cost = time.thread_time() - begin
        return self._send(replace(frame, channel=self.channel, arrays={**frame.arrays, **stamp}))

    def _send(self, frame: StateFrame) -> bool:
        with self._sending:  # nothing after close()
            if not self._closed:
                self.session.show(frame)
            return not self._closed

    def _offer_images(self, simulation: Simulation) -> None:
        if self._cameras is None or not self._cameras.chosen:
            return
        motion, recorded = self._motion or worlds_of(simulation.world)[0].people, self._recorded
        revision, seconds = 0 if motion is None else scene_revision(simulation, motion), self._seconds
        if recorded is None:
            self._cameras.offer(simulation, revision)
        else:
            self._cameras.offer(simulation, revision, lambda one: recorded.reading(one.control, one.sensor, seconds))

    def _instant(self, simulation: Simulation) -> SceneInstant:
        if self._recorded is not None:
            return self._with_paths(self._recorded.at(self._seconds))
        if self._bodies is not None:
            self._bodies.follow(simulation)
        return self._with_paths(SceneInstant.of(simulation, self._motion))

    def _with_paths(self, instant: SceneInstant) -> SceneInstant:
        if self._paths is None:
            walls = tuple(np.asarray(ring) for ring in instant.simulation.trial.stage.rings)
            self._paths = PredictedPaths(self.predictor, walls)
        elif self._paths.predictor is not self.predictor:
            self._paths.exchange(self.predictor)
        paths, recorded = self._paths, self._recorded

        def before(seconds: float) -> Scene | None:
            return None if recorded is None else recorded.scene_at(seconds)

        return replace(instant, paths=lambda: paths.update(instant.time, instant.scene, instant.ids, before))

    def settle(self) -> None:
        """Send the current state if the windows have not seen it, because nothing more comes for a while."""
        if self._owed:
            self.show(always=True)

    def is_status_due(self) -> bool:
        """Return whether the windows should get the status."""
        return time.monotonic() - self._told >= STATUS

    def measure(self) -> dict[str, float | None]:
        """Return the live values, and note the real-time factor."""
        now = self._told = time.monotonic()
        if self._simulation is None:
            return {}
        recorded = self.recording_instant
        at = float(self._simulation.world.times[0]) if recorded is None else self._seconds
        if self._rate is not None and now - self._rate[1] > 0.05:
            self.factor = (at - self._rate[0]) / (now - self._rate[1])
        self._rate = (at, now)
        return live_values(self._simulation, None if recorded is None else recorded.scene)
