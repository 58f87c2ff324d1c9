"""TrialView: the picture of a running trial for the screens of an experiment."""

from __future__ import annotations

from typing import Any

from crowdbot.experiments import BackgroundRun
from crowdbot.simulation import StepRecord
from crowdbot.web.desk import DeskWindows, Resource
from crowdbot.web.scene import scene_resource
from crowdbot.web.simulator import StageView

__all__ = ["TrialView"]


class TrialView:
    """A sink of step records that shows the simulation to the windows of a session, on the channel ``trial``.

    Frames and description are made in the thread of the run.

    Args:
        session: the windows.

    Attributes:
        run: the run that is shown; set after its start.
        description: what stands still; empty before the first step.
    """

    def __init__(self, session: DeskWindows) -> None:
        self._view = StageView(session, channel="trial")
        self._always = True
        self._shown: Any = None
        self.run: BackgroundRun | None = None
        self.description: dict[str, Any] = {}

    def take(self, frame: StepRecord) -> None:
        """Show a step."""
        simulation = self.run.simulation if self.run is not None else None
        if simulation is None:
            return
        if simulation is not self._shown:
            self._shown = simulation
            self._view.open(simulation)
        if not self.description or self._always:
            self.description = self._view.description()
        self._view.show(self._always)
        self._always = False

    def refresh(self) -> None:
        """Show the next step and describe it anew, for a window that has just been opened."""
        self._always = True

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        """Return meshes of bodies and robots.

        Raises:
            KeyError: there is no such file, or nothing is shown.
        """
        if self._shown is None:
            raise KeyError(path)
        return scene_resource(self._shown, path, query)
