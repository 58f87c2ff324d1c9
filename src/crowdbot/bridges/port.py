"""BridgePort: carries a running simulation over transports, and brings orders and calls in."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from crowdbot.core import InputError
from crowdbot.navigation import ExternalNavigator
from crowdbot.recording import StepMessage, StepMessages, is_latched
from crowdbot.simulation import JointOrder, Order, Simulation, StepRecord
from crowdbot.trials import RobotSpec, Trial

from .inbox import Inbox
from .interface import Request, RobotInterface
from .joint_actions import ABORTED, INVALID_GOAL, JointActions, goal_end
from .joint_trajectory import JointTrajectory
from .run_control import RunControl
from .simulation_interfaces import RESULT_OPERATION_FAILED
from .simulation_services import answer_call, result
from .transport import Transport

SCENE_TOPICS = ("/people", "/crowdbot/reactions", "/crowdbot/gestures")
"""Topics of the scene, which are sent when it is due only."""


def steered_trial(trial: Trial, timeout: float = 0.5) -> Trial:
    """Return the trial with robots that other programs drive.

    Robots with the navigator ``external``, ``rosbridge`` or ``ros2`` are driven from outside, over the bridges that are
    given instead of their own; if there is none, all robots are.

    Args:
        trial: the trial.
        timeout: simulated time [s] without a command after which a robot stops.

    >>> from crowdbot.trials import load_trial
    >>> steered_trial(load_trial("frontal")).robots[0].navigator
    ExternalNavigator(timeout=0.5)
    """
    navigator = ExternalNavigator(timeout=timeout)
    chosen = [robot.navigator for robot in trial.robots if isinstance(robot.navigator, ExternalNavigator)]
    if chosen and not any(item.source for item in chosen):
        return trial

    def steered(robot_spec: RobotSpec) -> RobotSpec:
        if chosen and not (isinstance(robot_spec.navigator, ExternalNavigator) and robot_spec.navigator.source):
            return robot_spec
        return dataclasses.replace(robot_spec, navigator=navigator, deadline=None)

    robots = tuple(map(steered, trial.robots))
    return dataclasses.replace(trial, robots=robots)


class BridgePort:
    """Topics, commands and services of a running trial, over any number of transports.

    The messages are those of the recorder: :class:`crowdbot.recording.StepMessages` converts the records of steps.
    Clock, transforms, odometry, joints and readings are sent after every step, the scene at its recording period.
    Commands, orders and calls wait in :attr:`inbox` until the instant between two steps.

    Args:
        trial: the trial.
        transports: connections to other programs.
        control: state of the run.
        follows_clock: whether ``/clock`` is received instead of sent.

    >>> from crowdbot.trials import load_trial
    >>> port = BridgePort(load_trial("frontal"), [])
    >>> port.interface.output("/map").quality.latched
    True
    """

    labelled = True
    """Whether readings say which agent each beam met."""

    def __init__(
        self,
        trial: Trial,
        transports: Sequence[Transport],
        control: RunControl | None = None,
        follows_clock: bool = False,
    ) -> None:
        self.transports = list(transports)
        self.control = control or RunControl()
        self.follows_clock = follows_clock
        self.interface = self.describe(trial)
        self.inbox = Inbox(self.interface)
        self._steps: StepMessages | None = None
        self._skipped: set[str] = set()
        self._actions = JointActions()

    def describe(self, trial: Trial) -> RobotInterface:
        """Return the topics and services of a trial."""
        return RobotInterface.of(trial, self.follows_clock)

    def start(self) -> None:
        """Open all transports."""
        for transport in self.transports:
            transport.start(self.interface, self.inbox)

    def stop(self) -> None:
        """Answer what waits, since programs and transports wait for it, and close all transports."""
        self.answer_rest("the run has ended")
        for transport in self.transports:
            transport.stop()

    def change_trial(self, trial: Trial) -> None:
        """Announce another trial, or the same one from its beginning; clients stay connected."""
        self._announce(trial)
        self.inbox.clear(self.interface)
        self.control.spawned.clear()
        self._actions.end_all("the trial begins again")
        self._actions = JointActions()

    def begin(self, simulation: Simulation) -> None:
        """Send the first instant of a simulation that has begun, with the map."""
        trial = simulation.trial
        self._steps = StepMessages(trial, {}, simulation, labelled=self.labelled)
        self._skipped = {input_topic.name for input_topic in self.interface.inputs}
        self._scene_every = simulation.world.clock.schedule(trial.recording.period)
        self.publish(simulation)

    def publish(self, simulation: Simulation) -> None:
        """Send the messages of the current instant, before its orders."""
        assert self._steps is not None
        if simulation.trial.robots != self.interface.trial.robots:
            self._announce(simulation.trial)
        due = bool(self._scene_every.is_due(simulation.ticks)[0])
        frame = simulation.record(0, due=True, collisions=False)

        def wants(topic: str) -> bool:
            if topic in self._skipped or (not due and topic in SCENE_TOPICS):
                return False
            return is_latched(topic) or self._is_wanted(topic)

        messages = list(self._steps.messages(frame, wants))
        self.inbox.begin_instant(frame.nanoseconds)
        self.inbox.latency.note_step()
        self._send(messages)

    def take(self, frame: StepRecord) -> None:
        """Send what is known at the end of a step only: orders that were applied and contacts that have ended."""
        if self._steps is not None and (frame.orders or frame.collisions):
            self._send(list(self._steps.endings(frame, self._is_wanted)))

    def take_orders(self, simulation: Simulation) -> list[Order]:
        """Return the orders for the current instant; what is impossible now is reported to the other programs."""
        orders, motions = list[Order](), self._actions.motions
        for request in self.inbox.take_orders():
            self._take(request, simulation, orders)
            if isinstance(request, JointOrder):
                motions.stop(request.robot, request.joint)
        for target in motions.targets(simulation):
            if not self._take(target, simulation, orders):
                motions.stop(target.robot, target.joint)
        return orders

    def _take(self, request: Request, simulation: Simulation, orders: list[Order]) -> bool:
        """Append an order, or begin a trajectory; return whether it is possible now."""
        try:
            if isinstance(request, JointTrajectory):
                self._actions.motions.begin(request, simulation)
                return True
            request.check(simulation)
        except InputError as error:
            self.inbox.count.refused += 1
            self.report("error", str(error))
            return False
        orders.append(request)
        return True

    def serve(self, simulation: Simulation) -> None:
        """Answer the calls that wait, and follow the goals of actions."""
        for transport in self.transports:
            transport.poll()
        robots = {action.name: action.robot for action in self.interface.actions}
        for call in self.inbox.take_calls():
            if call.service in robots:
                self._actions.begin(call, robots[call.service], simulation)
            else:
                answer_call(call, simulation, self.control, self.inbox)
        self._actions.check(simulation)

    def answer_rest(self, text: str) -> None:
        """Answer the goals that are followed and the calls that wait with a problem, at the end."""
        self._actions.end_all(text)
        actions = {action.name for action in self.interface.actions}
        for call in self.inbox.close():
            is_goal = call.service in actions
            call.answer(goal_end(ABORTED, INVALID_GOAL, text) if is_goal else result(RESULT_OPERATION_FAILED, text))

    def report(self, level: str, text: str) -> None:
        """Tell all other programs about a problem."""
        for transport in self.transports:
            transport.report(level, text)

    @property
    def is_heard(self) -> bool:
        """Whether any program has subscribed a topic."""
        return self._is_wanted("/")

    def _announce(self, trial: Trial) -> None:
        self.interface = self.inbox.interface = self.describe(trial)
        self._skipped = {input_topic.name for input_topic in self.interface.inputs}
        for transport in self.transports:
            transport.start(self.interface, self.inbox)

    def _is_wanted(self, topic: str) -> bool:
        return any(transport.wants(topic) for transport in self.transports)

    def _send(self, messages: list[StepMessage]) -> None:
        if messages:
            for transport in self.transports:
                transport.publish(messages)
