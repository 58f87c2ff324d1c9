"""RunControl: the state of a run that other programs steer: play, pause, step, reset, load, quit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from crowdbot.trials import Trial

STOPPED, PLAYING, PAUSED, QUITTING = 0, 1, 2, 3
"""States of ``simulation_interfaces/SimulationState``."""


@dataclass
class RunControl:
    """What other programs have asked of a run.

    Fields:
        state: :data:`STOPPED`, :data:`PLAYING`, :data:`PAUSED` or :data:`QUITTING`.
        steps: steps that are still to do while paused.
        stepped: called after the last of them, or with False if the run has ended before.
        begun: the trial of the current run, as it began.
        restart: trial that runs next instead of the current one; None: none.
        restarted: called when it runs, with an empty text, or with the reason why it cannot.
        spawned: names of the entities that other programs have added.

    >>> control = RunControl()
    >>> control.may_step
    True
    """

    state: int = PLAYING
    steps: int = 0
    stepped: Callable[[bool], None] | None = None
    begun: Trial | None = None
    restart: Trial | None = None
    restarted: Callable[[str], None] | None = None
    spawned: list[str] = field(default_factory=list)

    @property
    def may_step(self) -> bool:
        """Whether a step is allowed: playing, or steps were asked for while paused."""
        return self.state == PLAYING or self.steps > 0

    @property
    def leaves(self) -> bool:
        """Whether the current run ends now."""
        return self.state == QUITTING or self.restart is not None

    def note_step(self) -> None:
        """Count a step that was asked for while paused, and answer after the last one."""
        if self.steps > 0:
            self.steps -= 1
            if self.steps == 0:
                self.finish_steps(True)

    def finish_steps(self, done: bool) -> None:
        """Answer the caller of the steps."""
        self.steps, answer, self.stepped = 0, self.stepped, None
        if answer is not None:
            answer(done)

    def finish_restart(self, problem: str = "") -> None:
        """Answer the caller of the restart."""
        self.restart, answer, self.restarted = None, self.restarted, None
        if answer is not None:
            answer(problem)
