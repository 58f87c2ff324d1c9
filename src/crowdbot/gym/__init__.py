"""Environments for reinforcement learning with the interface of Gymnasium, over any trial.

The environments need the extra ``gym``: ``pip install 'crowdbot[gym]'``. Names are loaded on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.core import import_optional
from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from .crowd_task import CrowdTask, Reward, TaskStep
    from .environment import CrowdEnv
    from .parallel_environment import ParallelCrowdEnv, parallel_env
    from .registration import register_environments
    from .spaces import PERSON_VALUES, ROBOT_VALUES, ActionForm, ObservationForm
    from .vector_environment import CrowdVectorEnv

import_optional("gymnasium", "crowdbot.gym", "gym")

__getattr__, __dir__, _ = lazy_exports(__name__)

__all__ = [
    "PERSON_VALUES",
    "ROBOT_VALUES",
    "ActionForm",
    "CrowdEnv",
    "CrowdTask",
    "CrowdVectorEnv",
    "ObservationForm",
    "ParallelCrowdEnv",
    "Reward",
    "TaskStep",
    "parallel_env",
    "register_environments",
]
