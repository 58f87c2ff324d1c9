"""The simulator tab: a running trial or a recorded episode, steered by orders."""

from .simulator_desk import SimulatorDesk

__all__ = ["SimulatorDesk"]
