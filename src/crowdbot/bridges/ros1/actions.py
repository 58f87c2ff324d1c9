"""Actions of robots as ROS 1 knows them: the topics goal, cancel, status, feedback and result of actionlib.

Source: wiki.ros.org/actionlib/DetailedDescription, and ``control_msgs`` of ROS Noetic.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from crowdbot.bridges.inbox import Inbox, ServiceCall
from crowdbot.bridges.interface import COMMAND, STATE, InputTopic, JointAction, OutputTopic
from crowdbot.bridges.joint_actions import ABORTED, CANCELED, INVALID_GOAL, REJECTED, SUCCEEDED, goal_end
from crowdbot.core import InputError
from crowdbot.messages import Ros1Messages

KIND = "control_msgs/msg/FollowJointTrajectoryAction"
GOAL_ID, STATUS = "actionlib_msgs/msg/GoalID", "actionlib_msgs/msg/GoalStatusArray"
PENDING, ACTIVE, PREEMPTING = 0, 1, 6
STATES = {REJECTED: 5, SUCCEEDED: 3, CANCELED: 2, ABORTED: 4}
"""States of ``actionlib_msgs/GoalStatus`` by the state in which a goal ends."""
STATUS_PERIOD, KEPT = 0.2, 5.0
"""Real time [s] between two messages with all states, and for which they have a goal that is over."""
MOST_GOALS = 200


@dataclass
class _Goal:
    """A goal of a client: its GoalID, state, text, call, and the real time [s] of its end."""

    identity: Mapping[str, Any]
    state: int = PENDING
    text: str = ""
    call: ServiceCall | None = None
    ended: float | None = None

    @property
    def status(self) -> dict[str, Any]:
        """Fields of ``actionlib_msgs/GoalStatus``."""
        return {"goal_id": self.identity, "status": self.state, "text": self.text}


class ActionServer:
    """An action of a robot, as the server of actionlib; used in the thread of the node.

    Args:
        action: the action.
        inbox: receives the goals.
        codec: types of ROS 1.
        send: sends the bytes of a message on a topic.
        later: calls a function in the thread of the node, from any thread.
        monotonic: source of real time [s].
    """

    def __init__(
        self,
        action: JointAction,
        inbox: Inbox,
        codec: Ros1Messages,
        send: Callable[[str, bytes], None],
        later: Callable[..., Any],
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        self.action = action
        name = action.name
        self.outputs = (
            OutputTopic(f"{name}/status", STATUS, "", 1.0 / STATUS_PERIOD, STATE),
            OutputTopic(f"{name}/feedback", f"{KIND}Feedback", "", 0.0, STATE),
            OutputTopic(f"{name}/result", f"{KIND}Result", "", 0.0, STATE),
        )
        self.inputs = (
            InputTopic(f"{name}/goal", (f"{KIND}Goal",), action.robot, COMMAND),
            InputTopic(f"{name}/cancel", (GOAL_ID,), action.robot, COMMAND),
        )
        self._inbox, self._codec, self._send, self._later, self._monotonic = inbox, codec, send, later, monotonic
        self._goals: dict[str, _Goal] = {}

    def receive(self, topic: str, fields: Mapping[str, Any], sender: str) -> None:
        """Take a message on the topic of goals or of cancellations.

        Raises:
            InputError: there are too many goals.
        """
        if topic == self.inputs[0].name:
            self._begin(fields, sender)
        else:
            self._cancel(fields)

    def tell_states(self) -> None:
        """Send the states of all goals, and forget those that are over for long."""
        now = self._monotonic()
        self._goals = {
            name: goal for name, goal in self._goals.items() if goal.ended is None or now - goal.ended < KEPT
        }
        rows = [goal.status for goal in self._goals.values()]
        self._publish(0, {"status_list": rows})

    def _begin(self, fields: Mapping[str, Any], sender: str) -> None:
        identity = fields["goal_id"]
        name = identity["id"] or f"goal-{identity['stamp']['sec']}.{identity['stamp']['nanosec']}"
        if name in self._goals:
            return
        if len(self._goals) >= MOST_GOALS:
            raise InputError(f"{self.action.name}: {MOST_GOALS} goals are too many")
        goal = self._goals[name] = _Goal({**identity, "id": name})

        def tell(values: dict[str, Any]) -> None:
            goal.state = max(goal.state, ACTIVE)
            self._publish(1, {"status": goal.status, "feedback": values})

        def finish(response: dict[str, Any]) -> None:
            result = response["result"]
            goal.state, goal.text = STATES[response["status"]], result["error_string"]
            goal.ended = self._monotonic()
            self._publish(2, {"status": goal.status, "result": result})
            self.tell_states()

        later = self._later
        try:
            goal.call = self._inbox.call(
                self.action.name,
                fields["goal"],
                lambda response: later(finish, response),
                sender,
                lambda values: later(tell, values),
            )
        except InputError as error:
            finish(goal_end(REJECTED, INVALID_GOAL, str(error)))

    def _cancel(self, fields: Mapping[str, Any]) -> None:
        """Cancel the goal of an id and those up to a time; all without both. A time of 0 stands for none."""
        name, until = fields["id"], _time(fields["stamp"])
        everything = not name and not until
        for key, goal in self._goals.items():
            chosen = everything or key == name or (until > 0 and _time(goal.identity["stamp"]) <= until)
            if chosen and goal.call is not None and goal.ended is None:
                goal.call.canceled, goal.state = True, PREEMPTING
        self._inbox.wake()

    def _publish(self, k: int, fields: dict[str, Any]) -> None:
        seconds, rest = divmod(self._inbox.now, 10**9)
        header = {"stamp": {"sec": seconds, "nanosec": rest}}
        topic = self.outputs[k]
        self._send(topic.name, self._codec.encode_fields({"header": header, **fields}, topic.kind))


def _time(stamp: Mapping[str, Any]) -> int:
    return int(stamp["sec"]) * 10**9 + int(stamp["nanosec"])
