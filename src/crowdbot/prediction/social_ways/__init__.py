"""Social Ways: a GAN with attention over neighbors.

The modules ``network``, ``inputs`` and ``training`` import PyTorch; nothing else here does.
"""

from .config import PRESETS, STEADY, SocialWaysConfig
from .predictor import SocialWays, SocialWaysNetwork

__all__ = ["PRESETS", "STEADY", "SocialWays", "SocialWaysConfig", "SocialWaysNetwork"]
