"""Environments for reinforcement learning with the interface of Gymnasium, over any trial.

The environments need the extra ``gym``: ``pip install 'crowdbot[gym]'``. Names are loaded on first use.
``train_navigator`` trains the navigator ``policy``; it also needs PyTorch.
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
    from .training.navigator_training import CHECKPOINT, POLICY_FILE, NavigatorTraining, train_navigator
    from .training.policy_task import TrainingTask, standard_tasks
    from .training.ppo_settings import PPOSettings
    from .vector_environment import CrowdVectorEnv

import_optional("gymnasium", "crowdbot.gym", "gym")

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "action_form": ["ActionForm"],
        "crowd_task": ["CrowdTask", "TaskStep"],
        "environment": ["CrowdEnv"],
        "observation_form": ["PERSON_VALUES", "ROBOT_VALUES", "ObservationForm"],
        "parallel_environment": ["ParallelCrowdEnv", "parallel_env"],
        "registration": ["register_environments"],
        "reward": ["Reward"],
        "training.navigator_training": ["CHECKPOINT", "POLICY_FILE", "NavigatorTraining", "train_navigator"],
        "training.policy_task": ["TrainingTask", "standard_tasks"],
        "training.ppo_settings": ["PPOSettings"],
        "vector_environment": ["CrowdVectorEnv"],
    },
)

__all__ = [
    "CHECKPOINT",
    "PERSON_VALUES",
    "POLICY_FILE",
    "ROBOT_VALUES",
    "ActionForm",
    "CrowdEnv",
    "CrowdTask",
    "CrowdVectorEnv",
    "NavigatorTraining",
    "ObservationForm",
    "PPOSettings",
    "ParallelCrowdEnv",
    "Reward",
    "TaskStep",
    "TrainingTask",
    "parallel_env",
    "register_environments",
    "standard_tasks",
    "train_navigator",
]
