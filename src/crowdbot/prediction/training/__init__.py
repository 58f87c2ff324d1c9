"""Training of learned predictors: samples, training loop, checkpoints, access to PyTorch.

PyTorch is an optional dependency: ``pip install 'crowdbot[learn]'``. Importing this package does not load it.
"""

from .checkpoint import load_checkpoint, save_checkpoint
from .loop import BEST, LAST, LOG, Row, Schedule, Trainable, Trained, train
from .samples import Samples, Scenes, leave_out, short_recordings, split_in_time
from .torch_backend import device_of, tensors, threads, torch_module

__all__ = [
    "BEST",
    "LAST",
    "LOG",
    "Row",
    "Samples",
    "Scenes",
    "Schedule",
    "Trainable",
    "Trained",
    "device_of",
    "leave_out",
    "load_checkpoint",
    "save_checkpoint",
    "short_recordings",
    "split_in_time",
    "tensors",
    "threads",
    "torch_module",
    "train",
]
