"""CallRelay: services and actions of one client: calls, and what the client offers to others."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from typing import Any

from crowdbot.core import InputError

from .frames import field
from .graph import RosGraph, ros2_type
from .peer import Peer
from .rosapi import ROSAPI, answer_rosapi

SIMULATE_STEPS, STEP = "/crowdbot/simulate_steps", "/crowdbot/step_simulation"
"""The action of the simulation, ``simulation_interfaces/action/SimulateSteps``, and the service that does its work."""
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
"""States of goals, as in ``action_msgs/GoalStatus``."""
PORTIONS, MOST_CALLS, MOST_OFFERS = 20, 200, 200
Frame = Mapping[str, Any]


class CallRelay:
    """Calls of a client, and services and actions that it offers.

    Args:
        session: the client.
        graph: topics and services.
    """

    def __init__(self, session: Peer, graph: RosGraph) -> None:
        self.session, self.graph = session, graph
        self._numbers = itertools.count(1)
        self._asked: dict[str, tuple[Peer, Frame]] = {}
        """Calls of other clients that this one has not answered: caller and frame."""
        self._goals: dict[str, bool] = {}
        """Goals of the action of the simulation, and whether each goes on."""
        self._open = 0

    @property
    def operations(self) -> dict[str, Callable[[Frame], None]]:
        """Functions by operation."""
        return {
            "call_service": self._call_service,
            "advertise_service": lambda frame: self._offer(frame, "service", self.graph.services),
            "unadvertise_service": lambda frame: self._withdraw(frame, "service", self.graph.services),
            "service_response": lambda frame: self._answer(frame, done=True),
            "advertise_action": lambda frame: self._offer(frame, "action", self.graph.actions),
            "unadvertise_action": lambda frame: self._withdraw(frame, "action", self.graph.actions),
            "send_action_goal": self._send_goal,
            "cancel_action_goal": self._cancel_goal,
            "action_feedback": lambda frame: self._answer(frame, done=False),
            "action_result": lambda frame: self._answer(frame, done=True),
        }

    def close(self) -> None:
        """Tell the callers that this client has gone."""
        for caller, frame in list(self._asked.values()):
            caller.calls.fail(frame, "the client that offers it has gone")
        self._asked.clear()
        self._goals.clear()

    def forget(self, caller: Peer) -> None:
        """Drop the calls of a client that has gone."""
        for number in [number for number, (one, _) in self._asked.items() if one is caller]:
            del self._asked[number]

    def fail(self, frame: Frame, text: str) -> None:
        """Answer a call or a goal of this client with an error."""
        if frame["op"] == "call_service":
            self._respond(frame, text, False)
        else:
            self._result(frame, {}, ABORTED, False, text)

    def _call_service(self, frame: Frame) -> None:
        service, values = field(frame, "service", str), field(frame, "args", (dict, list), {})
        try:
            self.graph.check_name(service)
            request = self.graph.positional(service, values) if isinstance(values, list) else values
            if service in self.graph.services:
                provider = self.graph.services[service][0]
                provider.calls.hand(self.session, frame, {**frame, "args": request})
            elif service.rpartition("/")[2] in ROSAPI and "rosapi" in service:
                self._respond(frame, answer_rosapi(self.graph, service.rpartition("/")[2], request), True)
            else:
                self._ask(service, request, lambda response: self._respond(frame, response, True))
        except InputError as error:
            self._respond(frame, str(error), False)

    def _ask(self, service: str, request: Frame, answer: Callable[[dict[str, Any]], None]) -> None:
        """Call a service of the simulation; the answer comes in the thread of the graph."""
        if self._open >= MOST_CALLS:
            raise InputError(f"{MOST_CALLS} calls wait; wait for their responses")

        def finish(response: dict[str, Any]) -> None:
            self._open -= 1
            answer(response)

        self.graph.inbox.call(service, request, lambda response: self.graph.later(finish, response), "rosbridge")
        self._open += 1

    def _respond(self, frame: Frame, values: Any, good: bool) -> None:
        name = _identity(frame)
        size, compression = frame.get("fragment_size"), frame.get("compression", "none")
        size = size if isinstance(size, int) and size > 0 else None
        row = {"op": "service_response", **name, "service": frame["service"], "values": values, "result": good}
        self.session.reply(row, size, compression if compression == "png" else "none")

    def _offer(self, frame: Frame, what: str, offered: dict[str, tuple[Peer, str]]) -> None:
        name, kind = field(frame, what, str), field(frame, "type", str)
        self.graph.check_name(name)
        if (name in self.graph.service_types and name not in self.graph.services) or name == SIMULATE_STEPS:
            raise InputError(f"{name!r} is offered by the simulation")
        if name in offered and offered[name][0] is not self.session:
            raise InputError(f"{name!r} is offered by another client")
        if len(offered) >= MOST_OFFERS:
            raise InputError(f"{MOST_OFFERS} of them are too many")
        offered[name] = (self.session, ros2_type(kind))

    def _withdraw(self, frame: Frame, what: str, offered: dict[str, tuple[Peer, str]]) -> None:
        name = field(frame, what, str)
        if name not in offered or offered[name][0] is not self.session:
            raise InputError(f"{name[:60]!r} is not offered by this client")
        del offered[name]

    def hand(self, caller: Peer, asked: Frame, sent: Frame) -> None:
        """Give this client a call or a goal of another one.

        Raises:
            InputError: too many calls wait for it.
        """
        if len(self._asked) >= MOST_CALLS:
            raise InputError("too many calls wait for the client that offers it")
        number = f"{asked['op']}:{next(self._numbers)}"
        self._asked[number] = (caller, asked)
        self.session.reply({**sent, "id": number})

    def cancel(self, caller: Peer, name: str, action: str) -> bool:
        """Tell this client that a goal of another one is cancelled; return whether it has the goal."""
        for number, (one, asked) in self._asked.items():
            if one is caller and asked.get("id") == name:
                self.session.reply({"op": "cancel_action_goal", "id": number, "action": action})
                return True
        return False

    def _answer(self, frame: Frame, done: bool) -> None:
        """Give a response, feedback or result of this client to the caller."""
        number = field(frame, "id", str)
        if number not in self._asked:
            raise InputError(f"nobody waits for {number[:60]!r}")
        caller, asked = self._asked.pop(number) if done else self._asked[number]
        name = _identity(asked)
        try:
            caller.reply({key: value for key, value in frame.items() if key != "id"} | name)
        except ValueError:
            if done:
                caller.calls.fail(asked, "the response has numbers that are not finite")
            raise

    def _send_goal(self, frame: Frame) -> None:
        action, name = field(frame, "action", str), field(frame, "id", str, "")
        values = field(frame, "args", (dict, list), {})
        try:
            self.graph.check_name(action)
            if action in self.graph.actions:
                self.graph.actions[action][0].calls.hand(self.session, frame, frame)
                return
            if action != SIMULATE_STEPS:
                raise InputError(f"there is no action {action[:60]!r}")
            steps = values.get("steps", 1) if isinstance(values, dict) else values[0] if values else 1
            if isinstance(steps, bool) or not isinstance(steps, int) or steps < 1:
                raise InputError("steps must be a whole number from 1")
            if name in self._goals or len(self._goals) >= MOST_CALLS:
                raise InputError(f"a goal {name[:40]!r} is active, or there are too many")
            self._goals[name] = True
            self._go_on(frame, 0, steps)
        except InputError as error:
            self._goals.pop(name, None)
            self._result(frame, {}, ABORTED, False, str(error))

    def _go_on(self, frame: Frame, done: int, steps: int) -> None:
        """Do the next portion of the steps of a goal."""
        portion = min(max(1, steps // PORTIONS), steps - done)

        def finish(response: dict[str, Any]) -> None:
            name = str(frame.get("id", ""))
            if name not in self._goals:
                return
            good, now = response["result"]["result"] == 1, done + portion
            if frame.get("feedback") and good:
                values = {"completed_steps": now, "remaining_steps": steps - now}
                self._feedback(frame, values)
            if good and now < steps and self._goals[name]:
                self._go_on(frame, now, steps)
                return
            going = self._goals.pop(name)
            state = ABORTED if not good else SUCCEEDED if going else CANCELED
            self._result(frame, {"result": response["result"]}, state, good)

        self._ask(STEP, {"steps": portion}, finish)

    def _cancel_goal(self, frame: Frame) -> None:
        action, name = field(frame, "action", str), field(frame, "id", str, "")
        if action in self.graph.actions and self.graph.actions[action][0].calls.cancel(self.session, name, action):
            return
        if name not in self._goals:
            raise InputError(f"there is no goal {name[:60]!r}")
        self._goals[name] = False

    def _feedback(self, frame: Frame, values: Frame) -> None:
        name = _identity(frame)
        self.session.reply({"op": "action_feedback", **name, "action": frame["action"], "values": values})

    def _result(self, frame: Frame, values: Any, state: int, good: bool, text: str = "") -> None:
        name = _identity(frame)
        row = {"op": "action_result", **name, "action": frame["action"], "status": state, "result": good}
        self.session.reply({**row, "values": values if good else text or values})


def _identity(frame: Frame) -> dict[str, Any]:
    """Return the id of a frame, if it is one."""
    name = frame.get("id")
    return {"id": name} if isinstance(name, str | int) else {}
