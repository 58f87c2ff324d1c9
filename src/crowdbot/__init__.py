"""crowdbot: predict how a crowd moves in the next seconds, and test robots in simulated crowds.

The names below are what most programs need, by job; the rooms (``crowdbot.prediction``, ``crowdbot.world``, ...) have
the others. Each name is imported at its first use.

>>> import crowdbot as cb
>>> cb.run(cb.load_trial("frontal", duration=3.0)).outcome
'timeout'
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .lazy import lazy_exports

__version__ = "0.1.0"

JOBS: dict[str, dict[str, tuple[str, ...]]] = {
    "Run a trial": {
        "trials": ("load_trial", "Trial"),
        "recording": ("run",),
        "simulation": ("Episode", "Simulation"),
        "world": ("Robot",),
    },
    "Use a recorded run": {"recording": ("read_episode", "replay", "branch")},
    "Compare navigators": {"evaluation": ("evaluate", "EvaluationPlan", "parse_methods")},
    "Read recordings of people": {"data": ("load", "save", "Trajectories", "Windows")},
    "Predict people": {
        "prediction": ("ConstantVelocity", "Kalman", "Simulated", "AnchorNet", "Live"),
        "data": ("Forecast",),
        "metrics": ("score",),
    },
    "Calibrate a crowd model": {"calibration": ("Calibrator",), "models": ("ORCA", "SocialForce")},
    "Write a part of your own": {
        "models": ("CrowdModel",),
        "prediction": ("Predictor",),
        "navigation": ("Navigator", "Observation"),
        "sensors": ("Sensor",),
        "metrics": ("LogMetric",),
        "core": ("Scene", "Pose", "Twist"),
    },
    "Handle errors, cite": {"core": ("CrowdbotError",), "catalogue": ("cite",)},
}
"""Public names by the job of the user and the module that defines them."""

__getattr__, __dir__, _ = lazy_exports(__name__)

__all__ = [  # noqa: PLE0604
    *(name for modules in JOBS.values() for names in modules.values() for name in names),
    "__version__",
]


if TYPE_CHECKING:
    from crowdbot.calibration import Calibrator as Calibrator
    from crowdbot.core import CrowdbotError as CrowdbotError
    from crowdbot.core import Pose as Pose
    from crowdbot.core import Scene as Scene
    from crowdbot.core import Twist as Twist
    from crowdbot.data import Forecast as Forecast
    from crowdbot.data import Trajectories as Trajectories
    from crowdbot.data import Windows as Windows
    from crowdbot.data import load as load
    from crowdbot.data import save as save
    from crowdbot.evaluation import EvaluationPlan as EvaluationPlan
    from crowdbot.evaluation import evaluate as evaluate
    from crowdbot.evaluation import parse_methods as parse_methods
    from crowdbot.metrics import LogMetric as LogMetric
    from crowdbot.metrics import score as score
    from crowdbot.models import ORCA as ORCA
    from crowdbot.models import CrowdModel as CrowdModel
    from crowdbot.models import SocialForce as SocialForce
    from crowdbot.sensors import Sensor as Sensor
    from crowdbot.trials import Trial as Trial
    from crowdbot.trials import load_trial as load_trial
    from crowdbot.world import Robot as Robot

    from .catalogue import cite as cite
    from .navigation import Navigator as Navigator
    from .navigation import Observation as Observation
    from .prediction import AnchorNet as AnchorNet
    from .prediction import ConstantVelocity as ConstantVelocity
    from .prediction import Kalman as Kalman
    from .prediction import Live as Live
    from .prediction import Predictor as Predictor
    from .prediction import Simulated as Simulated
    from .recording import branch as branch
    from .recording import read_episode as read_episode
    from .recording import replay as replay
    from .recording import run as run
    from .simulation import Episode as Episode
    from .simulation import Simulation as Simulation
