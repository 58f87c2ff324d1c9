"""Inbox: what other programs ask of a running simulation, from all threads of all transports."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError, did_you_mean
from crowdbot.simulation import Order, VelocityOrder

from .fields import memory_size
from .interface import Fields, InputTopic, Request, RobotInterface, read_stamp
from .run_control import CommandLatency

SLOWEST, FASTEST = 0.001, 100.0
"""Speeds that may be asked for, in simulated seconds per real second."""
NO_PACE = "the time of this run is that of another clock, of motion capture or of a real robot"


@dataclass
class PaceRequest:
    """What viewers have asked of the pace of a run. It changes when steps are taken, never their result.

    Fields:
        rate: simulated seconds per real second; None: the run is not in real time.
        until: simulated time [ns] up to which the run takes steps as fast as it can.

    >>> pace = PaceRequest(1.0)
    >>> pace.set_rate(2.0)
    >>> pace.rate
    2.0
    """

    rate: float | None = None
    until: int = 0

    def set_rate(self, rate: float) -> None:
        """Set the speed.

        Raises:
            InputError: the run is not in real time, or the speed is not possible.
        """
        if self.rate is None:
            raise InputError(f"the speed cannot be set: {NO_PACE}")
        if not SLOWEST <= rate <= FASTEST:
            raise InputError(f"the speed {rate:g} must be from {SLOWEST:g} to {FASTEST:g} times real time")
        self.rate = rate

    def hurry_to(self, nanoseconds: int, now: int) -> None:
        """Go to a later time as fast as possible.

        Args:
            nanoseconds: the time to reach [ns].
            now: the current time [ns].

        Raises:
            InputError: the time is over, or the run is not in real time.
        """
        if nanoseconds < now:
            raise InputError(
                f"a live run cannot go back from {now / 1e9:g} s to {nanoseconds / 1e9:g} s; it can begin again, at 0 s"
            )
        if self.rate is None:
            raise InputError(f"the time cannot be set: {NO_PACE}")
        self.until = nanoseconds


MOST_ORDERS, MOST_CALLS = 2000, 200
"""Largest number of orders and of calls that wait for the next step."""
MOST_MEMORY = 16 << 20
"""Memory [bytes] of the orders, and of the calls, that wait for the next step."""

Answer = Callable[[dict[str, Any]], None]
"""Receives the fields of a response, or raises nothing if the caller has gone."""


@dataclass(eq=False)
class ServiceCall:
    """A call of a service, or a goal of an action.

    Fields:
        service: name of the service or action.
        request: fields of the request or goal.
        answer: called once with the fields of the response, in the thread of the simulation; for a goal, ``status`` and
            ``result``.
        sender: name of the transport.
        feedback: called with the fields of each feedback of a goal, in the thread of the simulation.
        canceled: set, in any thread, to cancel a goal.
    """

    service: str
    request: Fields
    answer: Answer
    sender: str
    feedback: Answer = lambda fields: None
    canceled: bool = False


@dataclass
class _Count:
    """Numbers of messages since the start."""

    received: int = 0
    refused: int = 0
    velocities: int = 0
    stale: int = 0


class Inbox:
    """Collects commands, orders and calls until the simulation takes them between two steps.

    Memory is bounded: of the velocity commands for a robot only the newest waits, and other orders and calls are
    refused when too many wait.

    >>> from crowdbot.trials import load_trial
    >>> inbox = Inbox(RobotInterface.of(load_trial("frontal")))
    >>> inbox.receive("/robot/cmd_vel", {"linear": {"x": 0.5}, "angular": {"z": 0.1}}, "test")
    >>> [order.forward for order in inbox.take_orders()]
    [0.5]
    """

    def __init__(self, interface: RobotInterface) -> None:
        self.interface = interface
        self.count = _Count()
        self.latency = CommandLatency()
        self.asked_pace = PaceRequest()
        self.external_time: int | None = None
        """Latest time [ns] received on ``/clock``, for a simulation that follows it."""
        self.commanded: set[str] = set()
        """Robots that have received a velocity command since :meth:`take_orders`."""
        self.in_step = False
        """Whether each instant waits for its commands. A command for an earlier instant is then dropped, and so is a
        second one for the current instant: it answers an instant that was sent twice."""
        self.stamped: set[str] = set()
        """Robots whose command is known to answer the current instant."""
        self._now, self._taken = 0, -1
        self._velocity: dict[str, VelocityOrder] = {}
        self._orders: deque[Request] = deque()
        self._calls: deque[ServiceCall] = deque()
        self._order_memory = self._call_memory = 0
        self._arrivals = self._seen = 0
        self._closed = False
        self._news = threading.Condition()

    def receive(self, topic: str, fields: Fields, sender: str, instant: int | None = None) -> None:
        """Take a message from another program.

        Args:
            topic: an input topic of the interface.
            fields: the message as nested mappings; missing fields are 0.
            sender: name of the transport, the source of the orders.
            instant: the instant [ns] that a velocity command answers, if the transport knows it; None: that of the
                stamp in the message, if it has one.

        Raises:
            InputError: there is no such input topic, a value is not allowed, or too many orders wait.
        """
        try:
            orders = self._input(topic).requests(fields, sender)
            if instant is None and any(isinstance(order, VelocityOrder) for order in orders):
                instant = read_stamp(fields) or None
        except InputError:
            self.count.refused += 1
            raise
        with self._news:
            self.count.received += 1
            for order in orders:
                self._add(order, instant)
            if topic == "/clock":
                stamp = fields["clock"]
                self.external_time = int(stamp.get("sec", 0)) * 10**9 + int(stamp.get("nanosec", 0))
            self._note()

    def call(
        self, service: str, request: Fields, answer: Answer, sender: str, feedback: Answer = lambda fields: None
    ) -> ServiceCall:
        """Take a call of a service, or a goal of an action; ``answer`` receives the response later.

        Raises:
            InputError: there is no such service or action, or too many calls wait.
        """
        known = [item.name for item in self.interface.services] + [item.name for item in self.interface.actions]
        if service not in known:
            raise InputError(f"there is no service {service!r}{did_you_mean(service, known)}")
        memory = memory_size(request)
        with self._news:
            if self._closed:
                raise InputError("the run has ended")
            if len(self._calls) >= MOST_CALLS:
                raise InputError(f"{MOST_CALLS} calls wait for the simulation; wait for their responses")
            _check_memory("calls", self._call_memory + memory, "wait for their responses, or send less in a request")
            call = ServiceCall(service, request, answer, sender, feedback)
            self._calls.append(call)
            self._call_memory += memory
            self._note()
            return call

    def add(self, order: Request) -> None:
        """Add an order for the current instant.

        Raises:
            InputError: too many orders wait.
        """
        with self._news:
            self._add(order)

    def count_orders(self, kind: type[Order], text: str = "") -> int:
        """Return the number of orders of a kind that wait, with a text in their element."""
        with self._news:
            return sum(isinstance(order, kind) and text in getattr(order, "xml", text) for order in self._orders)

    def begin_instant(self, nanoseconds: int) -> None:
        """Note that the messages of an instant are sent now, at a simulated time [ns]."""
        with self._news:
            self._now = nanoseconds

    @property
    def now(self) -> int:
        """Simulated time [ns] of the current instant."""
        return self._now

    def wait(self, seconds: float) -> None:
        """Wait until something arrives, at most this time."""
        with self._news:
            if not self._calls and self._arrivals == self._seen:
                self._news.wait(seconds)
            self._seen = self._arrivals

    def wake(self) -> None:
        """End :meth:`wait` now."""
        with self._news:
            self._note()

    def take_orders(self) -> list[Request]:
        """Return the orders that wait, and forget them."""
        with self._news:
            orders: list[Request] = [*self._orders, *self._velocity.values()]
            self._forget_orders()
            self._taken = self._now
            return orders

    def take_calls(self) -> list[ServiceCall]:
        """Return the calls that wait, and forget them."""
        with self._news:
            service_calls = list(self._calls)
            self._calls.clear()
            self._call_memory = 0
            return service_calls

    def close(self) -> list[ServiceCall]:
        """Refuse further calls, and return those that wait."""
        with self._news:
            self._closed = True
        return self.take_calls()

    def clear(self, interface: RobotInterface) -> None:
        """Begin another run: forget commands and orders; calls stay."""
        with self._news:
            self.interface, self.external_time, self.asked_pace.until = interface, None, 0
            self._forget_orders()
            self._now, self._taken = 0, -1

    def _forget_orders(self) -> None:
        self._orders.clear()
        self._order_memory = 0
        self._velocity.clear()
        self.commanded.clear()
        self.stamped.clear()

    def _is_stale(self, robot: str, instant: int | None) -> bool:
        """Return whether a command answers another instant, or one that has its command."""
        if not self.in_step or instant is None or not 0 <= instant <= self._now:  # not known, or of another clock
            return False
        if instant < self._now or self._taken == self._now or robot in self.stamped:
            return True
        self.stamped.add(robot)
        return False

    def _note(self) -> None:
        self._arrivals += 1
        self._news.notify_all()

    def _add(self, order: Request, instant: int | None = None) -> None:
        if isinstance(order, VelocityOrder):
            self.count.velocities += 1
            if self._is_stale(order.robot, instant):
                self.count.stale += 1
                return
            self._velocity[order.robot] = order
            self.latency.note_command(order.robot)
            self.commanded.add(order.robot)
            return
        if len(self._orders) >= MOST_ORDERS:
            self.count.refused += 1
            raise InputError(f"{MOST_ORDERS} orders wait for the next step; send fewer")
        memory = memory_size(vars(order))
        try:
            _check_memory("orders", self._order_memory + memory, "send fewer, or smaller ones")
        except InputError:
            self.count.refused += 1
            raise
        self._orders.append(order)
        self._order_memory += memory

    def _input(self, topic: str) -> InputTopic:
        for input_topic in self.interface.inputs:
            if input_topic.name == topic:
                return input_topic
        known = [input_topic.name for input_topic in self.interface.inputs]
        raise InputError(f"{topic!r} is not an input{did_you_mean(topic, known)}; inputs are {', '.join(known)}")


def _check_memory(what: str, memory: int, remedy: str) -> None:
    if memory > MOST_MEMORY:
        raise InputError(
            f"the {what} that wait for the next step would take {memory / 2**20:.1f} MiB of memory, more than"
            f" {MOST_MEMORY >> 20} MiB; {remedy}"
        )
