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
    "metrics": ("LogMetric", "score"),
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
    "catalogue": ("cite",),
}
__getattr__, __dir__ = lazy_exports(__name__, _ROOMS)

__all__ = [  # noqa: PLE0604
    *(name for names in _ROOMS.values() for name in names),
    "__version__",
]


if TYPE_CHECKING:
    from crowdbot.calibration import Calibrator as Calibrator
    from crowdbot.core import CrowdbotError as CrowdbotError
    from crowdbot.core import Paper as Paper
    from crowdbot.core import Pose as Pose
    from crowdbot.core import Scene as Scene
    from crowdbot.core import Twist as Twist
    from crowdbot.core import Walls as Walls
    from crowdbot.core import stream as stream
    from crowdbot.data import Forecast as Forecast
    from crowdbot.data import Trajectories as Trajectories
    from crowdbot.data import Windows as Windows
    from crowdbot.data import load as load
    from crowdbot.data import save as save
    from crowdbot.metrics import LogMetric as LogMetric
    from crowdbot.metrics import score as score
    from crowdbot.models import ORCA as ORCA
    from crowdbot.models import CrowdModel as CrowdModel
    from crowdbot.models import CurrentDirection as CurrentDirection
    from crowdbot.models import SocialForce as SocialForce
    from crowdbot.sensors import Lidar2D as Lidar2D
    from crowdbot.sensors import Sensor as Sensor
    from crowdbot.trials import Trial as Trial
    from crowdbot.trials import load_trial as load_trial
    from crowdbot.world import Robot as Robot

    from .catalogue import cite as cite
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
    from .simulation import Episode as Episode
