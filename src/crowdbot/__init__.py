"""crowdbot: predict how a crowd moves in the next seconds, and test robots in simulated crowds.

The names below are the public interface. Each is imported at its first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .lazy import lazy_exports

__version__ = "0.1.0"

_ROOMS = {
    "core": ("CrowdbotError", "Paper", "Pose", "Scene", "Twist", "Walls", "stream"),
    "data": ("Forecast", "Trajectories", "Windows", "load", "save"),
    "models": ("ORCA", "CrowdModel", "CurrentDirection", "SocialForce"),
    "sensors": ("Lidar2D", "Sensor"),
    "metrics": ("score",),
    "calibration": ("Calibrator",),
    "world": ("Robot",),
    "navigation": ("Navigator", "Observation"),
    "prediction": (
        "AnchorNet",
        "Anchors",
        "ConstantAcceleration",
        "ConstantVelocity",
        "Kalman",
        "KalmanAcceleration",
        "LeastSquares",
        "Live",
        "Predictor",
        "SampledConstantVelocity",
        "Simulated",
        "SocialWays",
    ),
    "trials": ("Trial", "load_trial"),
    "simulation": ("Episode",),
    "recording": ("branch", "read_episode", "replay", "run"),
    "benchmark": ("cite",),
}
__getattr__, __dir__ = lazy_exports(__name__, _ROOMS)

__all__ = [  # noqa: PLE0604
    *(name for names in _ROOMS.values() for name in names),
    "__version__",
]


if TYPE_CHECKING:
    from .benchmark import cite as cite
    from .calibration import Calibrator as Calibrator
    from .core import CrowdbotError as CrowdbotError
    from .core import Paper as Paper
    from .core import Pose as Pose
    from .core import Scene as Scene
    from .core import Twist as Twist
    from .core import Walls as Walls
    from .core import stream as stream
    from .data import Forecast as Forecast
    from .data import Trajectories as Trajectories
    from .data import Windows as Windows
    from .data import load as load
    from .data import save as save
    from .metrics import score as score
    from .models import ORCA as ORCA
    from .models import CrowdModel as CrowdModel
    from .models import CurrentDirection as CurrentDirection
    from .models import SocialForce as SocialForce
    from .navigation import Navigator as Navigator
    from .navigation import Observation as Observation
    from .prediction import ConstantAcceleration as ConstantAcceleration
    from .prediction import ConstantVelocity as ConstantVelocity
    from .prediction import Kalman as Kalman
    from .prediction import KalmanAcceleration as KalmanAcceleration
    from .prediction import LeastSquares as LeastSquares
    from .prediction import Live as Live
    from .prediction import Predictor as Predictor
    from .prediction import SampledConstantVelocity as SampledConstantVelocity
    from .prediction import Simulated as Simulated
    from .prediction import SocialWays as SocialWays
    from .recording import branch as branch
    from .recording import read_episode as read_episode
    from .recording import replay as replay
    from .recording import run as run
    from .sensors import Lidar2D as Lidar2D
    from .sensors import Sensor as Sensor
    from .simulation import Episode as Episode
    from .trials import Trial as Trial
    from .trials import load_trial as load_trial
    from .world import Robot as Robot
