"""AnchorNet: a small network that predicts residuals to constant velocity around 20 anchors.

Modules that are named ``training`` import PyTorch; nothing else here does.
"""

from .anchors import Anchors
from .predictor import AnchorNet, Modes

__all__ = ["AnchorNet", "Anchors", "Modes"]
