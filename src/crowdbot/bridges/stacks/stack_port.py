"""StackPort: the topics of a robot whose software is scored, without the truth and without power over the trial."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

from crowdbot.bridges.interface import OutputTopic, RobotInterface
from crowdbot.bridges.port import BridgePort
from crowdbot.bridges.quality import LATCHED
from crowdbot.bridges.transport import Transport
from crowdbot.messages import MAP, Messages
from crowdbot.recording import StepMessage
from crowdbot.simulation import Simulation
from crowdbot.trials import Trial

SHARED = ("/clock", "/tf", "/tf_static", "/map")
"""Topics of the scene that every robot software gets."""
TRUE = ("/ground_truth/odom", "/reading", "/labels")
"""Ends of the topics of a robot that hold the truth."""
DRIVEN = ("cmd_vel", "joint_command", "joint_trajectory")
"""Inputs of a robot that its software may use."""


GOAL = "geometry_msgs/msg/PoseStamped"


def _goal_topic(robot: str) -> OutputTopic:
    return OutputTopic(f"/{robot}/goal", GOAL, MAP, 0.0, LATCHED, robot, "goal")


class StackPort(BridgePort):
    """A port for the software of some robots of a trial.

    It offers the topics of these robots and of the scene that a real robot has, too, and the goals. It takes velocities
    and joint targets only: no goals, no other orders, no services.

    Args:
        trial: the trial.
        transports: connections to the software.
        robots: names of its robots.
        truth: whether the topics with the truth are sent, too, and readings say which agent each beam met.

    >>> from crowdbot.trials import load_trial
    >>> port = StackPort(load_trial("frontal"), [], ["robot"])
    >>> [one.name for one in port.interface.inputs], port.interface.services
    (['/robot/cmd_vel'], ())
    """

    def __init__(
        self, trial: Trial, transports: Sequence[Transport], robots: Sequence[str], truth: bool = False
    ) -> None:
        self.robots, self.truth = tuple(robots), truth
        self.labelled = truth
        self._goals: dict[str, tuple[float, float]] = {}
        self._make = Messages()
        super().__init__(trial, transports)

    def describe(self, trial: Trial) -> RobotInterface:
        """Return the topics of the robots of the software."""
        whole = RobotInterface.of(trial)
        inputs = tuple(
            one for one in whole.inputs if one.robot in self.robots and one.name.rpartition("/")[2] in DRIVEN
        )
        outputs = [*filter(self._offers, whole.outputs), *(_goal_topic(name) for name in self.robots)]
        return dataclasses.replace(whole, outputs=tuple(outputs), inputs=inputs, services=())

    def begin(self, simulation: Simulation) -> None:
        """Send the map, the goals and the first instant of a run."""
        self._goals.clear()
        super().begin(simulation)

    def publish(self, simulation: Simulation) -> None:
        """Send the messages of the current instant, and goals that have changed."""
        self._send(list(self._new_goals(simulation)))
        super().publish(simulation)

    def _new_goals(self, simulation: Simulation) -> Iterator[StepMessage]:
        make, now = self._make, simulation.world.clock.nanoseconds
        for control in simulation.robots:
            name, goal = control.robot.name, (float(control.goal[0, 0]), float(control.goal[0, 1]))
            if name in self.robots and self._goals.get(name) != goal:
                self._goals[name] = goal
                pose = make.make(GOAL, header=make.header(now), pose=make.pose(*goal, 0.0))
                yield StepMessage(f"/{name}/goal", GOAL, now, make, pose)

    def _offers(self, one: OutputTopic) -> bool:
        if not one.robot:
            return self.truth or one.name in SHARED
        return one.robot in self.robots and (self.truth or not one.name.endswith(TRUE))

    def _is_wanted(self, topic: str) -> bool:
        """Return whether the software subscribes a topic that it may have."""
        place = topic.rstrip("/")
        names = [one.name for one in self.interface.outputs]
        offered = place in names or (topic != place and any(one.startswith(topic) for one in names))
        return offered and super()._is_wanted(topic)
