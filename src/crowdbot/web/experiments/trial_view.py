"""TrialView: the people and robots of a running trial for the screens of an experiment."""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.simulation import StepRecord
from crowdbot.trials import Trial
from crowdbot.web.desk import DeskWindows
from crowdbot.web.state_frame import StateFrame

__all__ = ["TrialView", "stage_outline"]


class TrialView:
    """A sink of step records that shows the scene to the windows of a session.

    Args:
        session: the windows.
    """

    def __init__(self, session: DeskWindows) -> None:
        self._session = session

    def take(self, frame: StepRecord) -> None:
        """Show a step."""
        scene = frame.scene
        rows = np.column_stack([scene.position[0], scene.heading[0], scene.radius[0]]).astype(np.float32)
        robot = np.isin(frame.ids, frame.robot_ids)
        here = scene.active[0]
        arrays = {"people": rows[here & ~robot], "robots": rows[here & robot]}
        self._session.show(StateFrame("trial", frame.nanoseconds * 1e-9, arrays))


def stage_outline(trial: Trial) -> dict[str, Any]:
    """Return the walls and goals of a trial as JSON."""
    return {
        "rings": [np.round(ring, 3).tolist() for ring in trial.stage.rings],
        "goals": [[robot.goal.x, robot.goal.y, robot.goal.tolerance] for robot in trial.robots],
    }
