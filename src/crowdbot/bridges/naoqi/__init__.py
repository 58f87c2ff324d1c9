"""NAOqi: virtual sensors in the memory of a Pepper, whose own motion moves the virtual robot."""

from .bridge import NaoqiBridge

__all__ = ["NaoqiBridge"]
