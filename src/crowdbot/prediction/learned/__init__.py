"""Learned predictors: all of crowdbot that uses torch lives in this folder, and none of it is loaded before it is used.

The extra is installed with ``pip install 'crowdbot[learn]'``. Files named ``*_network`` or ``*_training`` import torch
at their top and are imported inside functions only; everything else here works without it.
"""

from ..training.checkpoint import load_checkpoint, save_checkpoint
from ..training.samples import Samples, leave_out

__all__ = ["Samples", "leave_out", "load_checkpoint", "save_checkpoint"]
