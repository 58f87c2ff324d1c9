"""Actions of robots as ROS 1 knows them: the topics goal, cancel, status, feedback and result of actionlib.

Source: wiki.ros.org/actionlib/DetailedDescription, ``ActionServerBase`` of actionlib, ``control_msgs`` of ROS Noetic.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from crowdbot.bridges.fields import stamp_fields
from crowdbot.bridges.inbox import Inbox, ServiceCall
from crowdbot.bridges.interface import COMMAND, STATE, InputTopic, JointAction, OutputTopic, read_duration
from crowdbot.bridges.joint_actions import ABORTED, CANCELED, INVALID_GOAL, REJECTED, SUCCEEDED, SUCCESSFUL, goal_end
from crowdbot.core import InputError
from crowdbot.messages import Ros1Messages

KIND = "control_msgs/msg/FollowJointTrajectoryAction"
GOAL_ID, STATUS = "actionlib_msgs/msg/GoalID", "actionlib_msgs/msg/GoalStatusArray"
PENDING, ACTIVE, PREEMPTING, RECALLING, RECALLED = 0, 1, 6, 7, 8
STATES = {REJECTED: 5, SUCCEEDED: 3, CANCELED: 2, ABORTED: 4}
"""States of ``actionlib_msgs/GoalStatus`` by the state in which a goal ends."""
STATUS_PERIOD, KEPT = 0.2, 5.0
"""Real time [s] between two messages with all states, and for which they have a goal that is over or recalled early."""
MOST_GOALS = 200
RECALLED_BY_TIME = "its stamp is not later than that of a cancellation that came before it"


@dataclass
class _Goal:
    """A goal, or the cancellation of one that has not come: GoalID, state, text, call, and real time [s] of its end."""

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
        self._unnamed = 0
        self._canceled_until = self._now = 0

    def receive(self, topic: str, fields: Mapping[str, Any], sender: str) -> None:
        """Take a message on the topic of goals or of cancellations.

        Raises:
            InputError: there are too many goals.
        """
        self._note_time()
        if topic == self.inputs[0].name:
            self._begin(fields, sender)
        else:
            self._cancel(fields)

    def tell_states(self) -> None:
        """Send the states of all goals, and forget those that are over for long."""
        self._note_time()
        now = self._monotonic()
        self._goals = {
            name: goal for name, goal in self._goals.items() if goal.ended is None or now - goal.ended < KEPT
        }
        rows = [goal.status for goal in self._goals.values()]
        self._publish(0, {"status_list": rows})

    def _note_time(self) -> None:
        """Forget the time of cancellations when simulated time begins again, where actionlib refuses all goals."""
        if self._inbox.now < self._now:
            self._canceled_until = 0
        self._now = self._inbox.now

    def _begin(self, fields: Mapping[str, Any], sender: str) -> None:
        """Take a goal once. One that was canceled before it came, by its id or by a time, is recalled."""
        goal = self._add(fields["goal_id"], PENDING)
        if goal.state == RECALLING:
            goal.state = RECALLED
            self._end(goal, goal_end(CANCELED, SUCCESSFUL)["result"])
        if goal.state != PENDING or goal.call is not None:  # it was known
            return
        if 0 < read_duration(fields, "goal_id", "stamp") <= self._canceled_until:
            goal.state, goal.text = RECALLED, RECALLED_BY_TIME
            self._end(goal, goal_end(CANCELED, SUCCESSFUL)["result"])
            return

        def tell(values: dict[str, Any]) -> None:
            goal.state = {PENDING: ACTIVE, RECALLING: PREEMPTING}.get(goal.state, goal.state)
            self._publish(1, {"status": goal.status, "feedback": values})

        def finish(response: dict[str, Any]) -> None:
            if goal.ended is not None:  # recalled, and told so when the goal came twice
                return
            result = response["result"]
            recalled = goal.state == RECALLING and response["status"] == CANCELED
            goal.state, goal.text = RECALLED if recalled else STATES[response["status"]], result["error_string"]
            self._end(goal, result)

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

    def _add(self, identity: Mapping[str, Any], state: int) -> _Goal:
        """Return the goal of a GoalID; a new one gets an id and a time if it has none.

        Raises:
            InputError: there are too many goals.
        """
        stamp = identity["stamp"]
        if not read_duration(identity, "stamp"):
            stamp = stamp_fields(self._inbox.now)
        name = identity["id"]
        if not name:
            self._unnamed += 1
            name = f"goal-{self._unnamed}-{stamp['sec']}.{stamp['nanosec']}"
        if name in self._goals:
            self._keep(self._goals[name])
        elif len(self._goals) >= MOST_GOALS:
            raise InputError(f"{self.action.name}: {MOST_GOALS} goals are too many")
        else:
            self._goals[name] = _Goal({"stamp": stamp, "id": name}, state)
        return self._goals[name]

    def _keep(self, goal: _Goal) -> None:
        """Keep the state of a goal that is over for :data:`KEPT` from now on."""
        if goal.ended is not None:
            goal.ended = self._monotonic()

    def _end(self, goal: _Goal, result: dict[str, Any]) -> None:
        goal.ended = self._monotonic()
        self._publish(2, {"status": goal.status, "result": result})
        self.tell_states()

    def _cancel(self, fields: Mapping[str, Any]) -> None:
        """Cancel the goal of an id and those up to a time; all without both. A time of 0 stands for none.

        An id that has not come is remembered for :data:`KEPT`, and the latest time for all goals that come later.

        Raises:
            InputError: there are too many goals.
        """
        name, until = fields["id"], read_duration(fields, "stamp")
        everything = not name and not until
        self._canceled_until = max(self._canceled_until, until)
        for key, goal in self._goals.items():
            if everything or key == name or (until > 0 and read_duration(goal.identity, "stamp") <= until):
                self._keep(goal)
                if goal.call is not None and goal.state in (PENDING, ACTIVE):
                    goal.call.canceled, goal.state = True, RECALLING if goal.state == PENDING else PREEMPTING
        if name and name not in self._goals:
            self._add(fields, RECALLING).ended = self._monotonic()
        self._inbox.wake()

    def _publish(self, k: int, fields: dict[str, Any]) -> None:
        header, topic = {"stamp": stamp_fields(self._inbox.now)}, self.outputs[k]
        self._send(topic.name, self._codec.encode_fields({"header": header, **fields}, topic.kind))
