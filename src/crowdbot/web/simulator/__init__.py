"""The simulator tab: a running trial or a recorded episode, steered by orders."""

from .simulator_desk import SimulatorDesk
from .stage_view import StageView

__all__ = ["SimulatorDesk", "StageView"]
