"""A trial that runs beside its front end, so that it can be held, let go on, or given up."""

from __future__ import annotations

import threading
from pathlib import Path

from crowdbot.recording import run
from crowdbot.simulation import Episode
from crowdbot.trials import Trial

__all__ = ["Aborted", "BackgroundRun"]


class Aborted(Exception):
    """The trial was given up on purpose."""


class BackgroundRun:
    """Runs a trial in a thread of its own; the file of its episode appears when it is complete.

    It can be held whenever it tells its progress, 100 times in its duration; what comes out is the same.

    >>> from crowdbot.models import ORCA
    >>> running = BackgroundRun(Trial(name="empty", duration=1.0, crowd=ORCA()), seed=0)
    >>> while not running.wait(0.1):
    ...     pass
    >>> running.result().outcome
    'finished'
    """

    def __init__(self, trial: Trial, seed: int, out: Path | None = None) -> None:
        self.share = 0.0
        """How much of the duration is done, 0 to 1."""
        self._go = threading.Event()
        self._go.set()
        self._given_up = False
        self._episode: Episode | None = None
        self._error: Exception | None = None
        self._ended = threading.Event()  # joining a thread is not safe against Ctrl-C in every Python
        threading.Thread(target=self._run, args=(trial, seed, out), daemon=True).start()

    def hold(self) -> None:
        """Let it wait."""
        self._go.clear()

    def go(self) -> None:
        """Let it go on."""
        self._go.set()

    def give_up(self) -> None:
        """Let it end without an episode, where it is held or next tells its progress; :meth:`wait` for that."""
        self._given_up = True
        self._go.set()

    def wait(self, seconds: float) -> bool:
        """Wait as long at most; return whether it has ended."""
        return self._ended.wait(seconds)

    def result(self) -> Episode:
        """Return the episode.

        Raises:
            GivenUp: there is none.
            Exception: whatever the trial has raised.
        """
        self._ended.wait()
        if self._error is not None:
            raise self._error
        assert self._episode is not None
        return self._episode

    def _run(self, trial: Trial, seed: int, out: Path | None) -> None:
        try:
            self._episode = run(trial, seed=seed, out=out, progress=self._told)
        except Exception as error:  # raised again by result(), where somebody can be told
            self._error = error
        finally:
            self._ended.set()

    def _told(self, share: float) -> None:
        self.share = share
        self._go.wait()
        if self._given_up:
            raise Aborted
