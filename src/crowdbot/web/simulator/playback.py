"""Playback: a recorded episode that plays, and jumps to any instant."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from crowdbot.core import CrowdbotError, InputError, notify_compiling
from crowdbot.recording import RecordedEpisode, RecordedSimulation, read_episode
from crowdbot.simulation import Simulation, SimulationRun
from crowdbot.web.scene import EpisodeEvent, RecordedScene, episode_events, episode_series, simulation_reason

from .paced_loop import PacedLoop
from .stage_view import StageView

NEAR = 2.0
"""Time [s] up to which the simulation for the inspector is continued; beyond it, a keyframe is nearer on average."""


class Playback:
    """A recorded episode. Its picture comes from its records, so that every instant is shown at once.

    An episode whose records do not tell all of the picture, see :func:`crowdbot.web.scene.simulation_reason`, is
    simulated again, with its orders, from the latest keyframe before an instant. So is what the inspector shows.

    Args:
        file: the episode.
        name: its name in the folder of the session.
        view: sends the state to the windows.
        tell: called when the status has changed.
        at: instant [s] that is shown first (default: the beginning).
        paused: whether it waits at its start.
    """

    kind = "episode"

    def __init__(
        self,
        file: Path,
        name: str,
        view: StageView,
        tell: Callable[[Any], None],
        at: float | None = None,
        paused: bool = True,
    ) -> None:
        self.name, self.view, self._tell, self._at = name, view, tell, at
        self.state, self.problems, self.compiling = "preparing", list[str](), False
        self.values: dict[str, float | None] = {}
        self.events: list[EpisodeEvent] = []
        self.series: dict[str, list[float | None]] = {}
        self._stack = contextlib.ExitStack()
        self._run: SimulationRun | None = None
        self._scene: RecordedScene | None = None
        self._now = math.nan
        self.recorded = RecordedSimulation(file)
        self.episode: RecordedEpisode = read_episode(file)
        if not len(self.episode.times):
            raise InputError(f"{name} has no recorded instant")
        self.begin_time, self.end_time = float(self.episode.times[0]), float(self.episode.times[-1])
        step = int(self.episode.metadata["step_ns"]) / 1e9
        self._step = step
        self.loop = PacedLoop(step, self._advance, self._begin, self._end, paused, view.settle)

    @property
    def simulation(self) -> Simulation:
        """The simulation at this instant; only for actions in the thread of the playback.

        If the picture comes from the records, the episode is simulated to this instant now.

        Raises:
            InputError: the episode is not ready yet.
            EpisodeError: the episode does not replay.
        """
        if math.isnan(self._now):
            raise InputError(self.problems[0] if self.problems else "the episode is not ready yet")
        run = self._run
        behind = math.inf if run is None else self._now - float(run.simulation.world.times[0])
        if run is None or not -1e-9 <= behind <= NEAR:
            run = self._run = self.recorded.run_from(self._now)
        while run.outcome is None and float(run.simulation.world.times[0]) < self._now - 0.5 * self._step:
            run.step()
        return run.simulation

    def do(self, action: Callable[[], Any]) -> Any:
        """Run an action in the thread of the playback."""
        return self.loop.do(action)

    def seek(self, seconds: float) -> None:
        """Jump to an instant [s]; one outside the episode is moved into it."""
        if not math.isfinite(seconds):
            raise InputError(f"time = {seconds}: expected a finite number of seconds")
        self.do(lambda: self._jump(min(max(seconds, self.begin_time), self.end_time)))

    def start(self) -> None:
        """Start the thread."""
        self.loop.start()

    def close(self, wait: float | None = None) -> None:
        """Stop."""
        self.view.close()
        self.loop.close(wait)

    def status(self) -> dict[str, Any]:
        """Return the status, JSON."""
        episode = self.episode
        now = self.begin_time if math.isnan(self._now) else self._now
        return {
            "kind": self.kind, "name": self.name, "state": self._state_word(), "time": now, "begin": self.begin_time,
            "duration": self.end_time, "speed": self.loop.speed, "late": self.loop.late, "factor": self.view.factor,
            "seed": episode.seed, "trial": episode.name, "outcome": episode.outcome, "problems": self.problems,
            "orders": len(episode.orders), "compiling": self.compiling, "values": self.values,
            "metrics": {key: metric for key, metric in episode.metrics.items() if math.isfinite(metric)},
        }  # fmt: skip

    def _state_word(self) -> str:
        if self.state == "running" and self.loop.paused:
            return "paused"
        return self.state

    def _begin(self) -> None:
        try:
            self._stack.enter_context(self.recorded)
            self.events, self.series = episode_events(self.episode), episode_series(self.episode)
            with notify_compiling(self._note_compiling):
                self._open()
                self._jump(self.begin_time if self._at is None else min(max(self._at, self.begin_time), self.end_time))
        except (CrowdbotError, OSError) as error:
            self._fail(str(error))
        except Exception as error:  # damaged files fail in many ways
            self._fail(f"{type(error).__name__}: {error}")

    def _note_compiling(self) -> None:
        self.compiling = True
        self._tell(self)

    def _fail(self, problem: str) -> None:
        self.problems, self.state = [problem], "failed"
        self.loop.ended.set()
        self._tell(self)

    def _open(self) -> None:
        """Prepare the picture from the records, if they tell all of it."""
        simulation = self.recorded.trial_simulation()
        if not simulation_reason(simulation, self.episode, self.recorded.changes()):
            self._scene = RecordedScene(simulation, self.episode)
            self.view.open_recording(self._scene, self.begin_time)

    def _jump(self, seconds: float) -> None:
        if self._scene is not None:
            self.view.move(seconds)
            self._now = seconds
        else:
            self._run = self.recorded.run_from(seconds)
            self.view.open(self._run.simulation)
            self._now = float(self._run.simulation.world.times[0])
        self.state, self.compiling = "running", False
        self.loop.restart()
        self.view.show(always=True)
        self.values = self.view.measure()
        self._tell(self)

    def _advance(self) -> bool:
        if math.isnan(self._now):
            return False
        if self._now >= self.end_time - 1e-9 or (self._scene is None and self._is_over()):
            self.state = "ended"
            self._tell(self)
            return False
        if self._scene is not None:
            self._now = min(self.end_time, round(self._now + self._step, 9))
            self.view.move(self._now)
        elif self._run is not None:
            self._run.step()
            self._now = float(self._run.simulation.world.times[0])
        self.view.show(always=self.loop.paused)
        if self.view.is_status_due() or self.loop.paused:
            self.values = self.view.measure()
            self._tell(self)
        return True

    def _is_over(self) -> bool:
        return self._run is not None and self._run.outcome is not None

    def _end(self) -> None:
        self._stack.close()
