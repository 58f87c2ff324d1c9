"""Actions of robots as ROS 2 knows them: servers of rclpy for the goals of the simulation."""

from __future__ import annotations

import functools
import importlib
import queue
import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from crowdbot.bridges.inbox import Inbox, ServiceCall
from crowdbot.bridges.interface import Fields, JointAction
from crowdbot.bridges.joint_actions import CANCELED, REJECTED, SUCCEEDED
from crowdbot.core import InputError

from .messages import fill_message, message_fields, ros_class

GOALS = 8
"""Number of goals that are followed at the same time: each has a thread of the executor, since rclpy before version 9
spins without a pause while a coroutine waits."""
CANCEL: Fields = {}
"""Stands between the feedback of a goal for the wish of its client to cancel it."""


@dataclass(eq=False)
class _Goal:
    """A goal of a client, and what the simulation tells of it: feedback, and its end, which alone has a status."""

    call: ServiceCall
    told: queue.SimpleQueue[Fields]
    first: Fields


class JointActionServers:
    """The actions of a trial on a node of rclpy.

    The simulation decides at its next instant whether a goal is accepted. ROS 2 carries no reason for a goal that is
    rejected, so it goes to the log of the node.

    Args:
        node: node of rclpy, in an executor with ``GOALS + 2`` threads.
        inbox: receives the goals.
        sender: name of the transport.
    """

    def __init__(self, node: Any, inbox: Inbox, sender: str) -> None:
        self._ros: Any = importlib.import_module("rclpy.action")
        self._node, self._inbox, self._sender = node, inbox, sender
        self._servers: dict[JointAction, Any] = {}
        self._decided: dict[JointAction, _Goal] = {}
        self._goals: dict[bytes, _Goal] = {}

    def offer(self, actions: Iterable[JointAction]) -> None:
        """Offer the actions of a trial, and no other ones; their types are installed."""
        wanted = {*actions}
        for action in {*self._servers} - wanted:
            self._servers.pop(action).destroy()
        for action in wanted - {*self._servers}:
            self._servers[action] = self._ros.ActionServer(
                self._node,
                ros_class(action.kind),
                action.name,
                execute_callback=functools.partial(self._follow, ros_class(action.kind)),
                goal_callback=functools.partial(self._decide, action),
                handle_accepted_callback=functools.partial(self._accept, action),
                cancel_callback=self._cancel,
            )

    def _decide(self, action: JointAction, request: Any) -> Any:
        """Return whether the simulation follows a goal; rclpy decides on one goal of an action at a time."""
        response = self._ros.GoalResponse
        if (gone := self._decided.pop(action, None)) is not None:  # its client had gone before it was accepted
            self._stop(gone)
        told: queue.SimpleQueue[Fields] = queue.SimpleQueue()
        try:
            if len(self._goals) >= GOALS:
                raise InputError(f"{GOALS} goals are followed; wait for their ends")
            call = self._inbox.call(action.name, message_fields(request), told.put, self._sender, told.put)
            first = told.get()
            if first.get("status") == REJECTED:
                raise InputError(first["result"]["error_string"])
        except InputError as error:
            self._node.get_logger().error(f"{action.name}: the goal is rejected: {error}")
            return response.REJECT
        self._decided[action] = _Goal(call, told, first)
        return response.ACCEPT

    def _accept(self, action: JointAction, handle: Any) -> None:
        self._goals[bytes(handle.goal_id.uuid)] = self._decided.pop(action)
        handle.execute()

    def _cancel(self, handle: Any) -> Any:
        response = self._ros.CancelResponse
        goal = self._goals.get(bytes(handle.goal_id.uuid))
        if goal is None:  # it has just ended
            return response.REJECT
        goal.told.put(CANCEL)
        return response.ACCEPT

    def _stop(self, goal: _Goal) -> None:
        goal.call.canceled = True
        self._inbox.wake()

    def _follow(self, kind: Any, handle: Any) -> Any:
        """Give feedback until the end of a goal, and return its result.

        In ROS 2, only the client cancels; a goal that the simulation ends for another one is aborted.
        """
        key = bytes(handle.goal_id.uuid)
        goal = self._goals[key]
        end = goal.first
        while "status" not in end:
            if end is CANCEL:
                while handle.is_active and not handle.is_cancel_requested:  # rclpy notes it after the callback
                    time.sleep(0.001)
                self._stop(goal)
            else:
                handle.publish_feedback(fill_message(kind.Feedback(), end))
            end = goal.told.get()
        if end["status"] == SUCCEEDED:
            handle.succeed()
        elif end["status"] == CANCELED and handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        del self._goals[key]
        return fill_message(kind.Result(), end["result"])
