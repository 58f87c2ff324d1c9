"""The simulator tab: a running trial or a recorded episode, steered by orders."""

from .first_trial import FIRST
from .live_run import LiveRun
from .simulator_desk import SimulatorDesk
from .stage_view import StageView
from .steering_desk import navigator_orders

__all__ = ["FIRST", "LiveRun", "SimulatorDesk", "StageView", "navigator_orders"]
