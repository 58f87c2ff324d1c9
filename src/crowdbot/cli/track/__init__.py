"""``crowdbot track`` and ``crowdbot predict --perception``: scores of perception on readings of a scanner."""

from .command import arguments, main
from .predict_perception import add_perception, predict_perception

__all__ = ["add_perception", "arguments", "main", "predict_perception"]
