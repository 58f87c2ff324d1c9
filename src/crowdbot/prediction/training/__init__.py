"""Training of learned predictors: samples, training loop, checkpoints, access to PyTorch.

PyTorch is an optional dependency: ``pip install 'crowdbot[learn]'``. Importing this package does not load it.
"""

from .checkpoint import load_checkpoint, save_checkpoint
from .loop import BEST, LAST, LOG, LogRow, Trainable, TrainingResult, TrainingSchedule, train
from .samples import (
    Samples,
    Scenes,
    TimeSplit,
    leave_out,
    recordings_with_windows,
    short_recordings,
    split_in_time,
)
from .torch_backend import to_tensors, torch_device, torch_module, torch_threads

__all__ = [
    "BEST",
    "LAST",
    "LOG",
    "LogRow",
    "Samples",
    "Scenes",
    "TimeSplit",
    "Trainable",
    "TrainingResult",
    "TrainingSchedule",
    "leave_out",
    "load_checkpoint",
    "recordings_with_windows",
    "save_checkpoint",
    "short_recordings",
    "split_in_time",
    "to_tensors",
    "torch_device",
    "torch_module",
    "torch_threads",
    "train",
]
