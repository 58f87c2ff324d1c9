"""The memory of a navigator belongs to the running robot: replay, branch and batch keep it."""

from dataclasses import dataclass

from crowdbot.core import Twist
from crowdbot.models import ORCA
from crowdbot.navigation import Action, Navigator
from crowdbot.recording import branch, run
from crowdbot.simulation import simulate_seeds
from crowdbot.trials import RobotGoal, RobotSpec, Trial
from crowdbot.world import DifferentialDrive


@dataclass(frozen=True)
class Slowing(Navigator):
    """Drives ahead, a little slower at every decision."""

    def begin(self, observation):
        return 0.5 + observation.time

    def act(self, observation, memory):
        return Action(Twist(memory)), 0.8 * memory


def trial(duration=2.0):
    robot = RobotSpec(
        name="robot", x=0.0, y=0.0, radius=0.3, goal=RobotGoal(x=9.0, y=0.0), drive=DifferentialDrive(),
        navigator=Slowing(), control_period=0.5,
    )  # fmt: skip
    return Trial(name="slow", duration=duration, step=0.1, crowd=ORCA(), robots=[robot])


def test_memory_starts_once_and_goes_on_from_decision_to_decision():
    commands = run(trial()).commands[:, 0, 0]
    assert commands[[0, 5, 10, 15]].round(6).tolist() == [0.5, 0.4, 0.32, 0.256]


def test_a_branch_and_a_batch_keep_the_memory():
    whole = run(trial())
    assert [seed.digest for seed in simulate_seeds(trial(), [0, 0, 0])] == [whole.digest] * 3
    assert branch(whole, 1.0).digest == whole.digest
    assert run(trial()).digest == whole.digest
