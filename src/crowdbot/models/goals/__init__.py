"""Goal estimators: predicted destinations of people in observed windows."""

from .current_direction import CurrentDirection
from .environment_layout import EnvironmentLayout
from .goal import Choices, Goal
from .ground_truth import GroundTruth
from .learned_destinations import LearnedDestinations

__all__ = ["Choices", "CurrentDirection", "EnvironmentLayout", "Goal", "GroundTruth", "LearnedDestinations"]
