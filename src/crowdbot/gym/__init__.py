"""Environments for reinforcement learning with the interface of Gymnasium, over any trial.

The environments need the extra ``gym``: ``pip install 'crowdbot[gym]'``. Names are loaded on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.core import import_optional
from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from .action_form import ActionForm
    from .crowd_task import CrowdTask, TaskStep
    from .environment import CrowdEnv
    from .observation_form import PERSON_VALUES, ROBOT_VALUES, ObservationForm
    from .parallel_environment import ParallelCrowdEnv, parallel_env
    from .registration import register_environments
    from .reward import Reward
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
