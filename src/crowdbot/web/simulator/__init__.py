"""The simulator tab: a running trial or a recorded episode, steered by orders."""

from .first_trial import FIRST
from .live_run import LiveRun
from .simulator_desk import SimulatorDesk, navigator_orders
from .stage_view import StageView

__all__ = ["FIRST", "LiveRun", "SimulatorDesk", "StageView", "navigator_orders"]
