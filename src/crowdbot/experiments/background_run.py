"""BackgroundRun: a trial that runs in a thread and can be paused, continued or aborted."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from pathlib import Path

from crowdbot.core import Clock
from crowdbot.recording import open_run
from crowdbot.simulation import Episode, EpisodeLog, OrderSource, Simulation, SimulationRun, Sink
from crowdbot.trials import Trial


class Aborted(Exception):
    """The trial was aborted on request."""


class BackgroundRun:
    """Runs a trial in a thread; the episode file appears when the trial has ended.

    The run can be paused between two steps. A pause does not change the result.

    Args:
        trial, seed: what to run.
        out: file of the episode (default: no file).
        clock: a paced clock shows the trial in real time (default: as fast as possible).
        sinks: further consumers of the step records, called in the thread of the run.
        sources: programs that steer the run, such as an emulated participant; called in the thread of the run.

    >>> from crowdbot.models import ORCA
    >>> running = BackgroundRun(Trial(name="empty", duration=1.0, crowd=ORCA()), seed=0)
    >>> while not running.wait(0.1):
    ...     pass
    >>> running.result().outcome
    'finished'
    """

    def __init__(
        self,
        trial: Trial,
        seed: int,
        out: Path | None = None,
        clock: Clock | None = None,
        sinks: Sequence[Sink] = (),
        sources: Sequence[OrderSource] = (),
    ) -> None:
        self.share = 0.0
        """Completed share of the duration, 0 to 1."""
        self._held = False
        self._running: SimulationRun | None = None
        self._given_up = False
        self._episode: Episode | None = None
        self._error: Exception | None = None
        self._ended = threading.Event()  # joining a thread is not safe against Ctrl-C in all Python versions
        threading.Thread(target=self._run, args=(trial, seed, out, clock, sinks, sources), daemon=True).start()

    @property
    def simulation(self) -> Simulation | None:
        """The simulation; None before it is built."""
        return None if self._running is None else self._running.simulation

    def hold(self) -> None:
        """Pause the run."""
        self._held = True
        if self._running is not None:
            self._running.hold()

    def go(self) -> None:
        """Continue the run."""
        self._held = False
        if self._running is not None:
            self._running.go()

    def give_up(self) -> None:
        """Abort the run at its next step, without an episode; :meth:`wait` for the end."""
        self._given_up = True
        self.go()

    def wait(self, seconds: float) -> bool:
        """Wait at most ``seconds``; return whether the run has ended."""
        return self._ended.wait(seconds)

    def result(self) -> Episode:
        """Return the episode.

        Raises:
            Aborted: the trial was aborted.
            Exception: the error of the trial.
        """
        self._ended.wait()
        if self._error is not None:
            raise self._error
        assert self._episode is not None
        return self._episode

    def _run(
        self,
        trial: Trial,
        seed: int,
        out: Path | None,
        clock: Clock | None,
        sinks: Sequence[Sink],
        sources: Sequence[OrderSource],
    ) -> None:
        log = EpisodeLog(trial, seed)
        try:
            with open_run(trial, seed, out, clock, sources, sinks=[log, *sinks]) as running:
                self._running = running
                if self._held:
                    running.hold()
                while running.advance(1) is None:
                    self.share = min(1.0, running.simulation.tick / trial.ticks)
                    if self._given_up:
                        raise Aborted
            self.share = 1.0
            end = running.ends[0]
            assert end is not None
            self._episode = log.episode(*end)
        except Exception as error:  # raised again by result(), for the caller
            self._error = error
        finally:
            self._ended.set()
