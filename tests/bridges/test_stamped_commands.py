"""Commands that say which instant they answer: copies, delays and another order change nothing."""

import random

import pytest
from bridge_runs import MemoryTransport, endless_trial

from crowdbot.bridges import BridgeClock, Inbox, RobotInterface, run_bridge
from crowdbot.bridges.interface import read_stamp
from crowdbot.core import InputError

TRIAL = endless_trial(0.8)
STEP = round(TRIAL.step * 1e9)


def answer(nanoseconds, forward=None):
    """Return the command for an instant, as ``geometry_msgs/TwistStamped``."""
    seconds, rest = divmod(nanoseconds, 10**9)
    twist = {"linear": {"x": nanoseconds // STEP % 7 / 10 if forward is None else forward}, "angular": {"z": 0.1}}
    return {"header": {"stamp": {"sec": seconds, "nanosec": rest}}, "twist": twist}


class Program(MemoryTransport):
    """Answers each instant; with chance, again and again, later, and in another order."""

    def __init__(self, seed=None):
        super().__init__()
        self.rng, self.waiting = random.Random(seed), []
        self.faulty = seed is not None

    def publish(self, messages):
        super().publish(messages)
        for item in (message for message in messages if message.topic == "/tf"):
            copies = 1 + self.rng.randrange(4) * (self.faulty and item.nanoseconds > 0)
            self.waiting += [answer(item.nanoseconds)] * copies

    def poll(self):
        for _ in range(self.rng.randint(0, 3) if self.faulty else 1):
            if self.waiting:
                at = self.rng.randrange(len(self.waiting)) if self.faulty else 0
                self.inbox.receive("/robot/cmd_vel", self.waiting.pop(at), self.name)


def driven(program):
    done = run_bridge(TRIAL, [program], 0, None, BridgeClock("commands"))
    return done.steps, done.metrics


@pytest.fixture(scope="module")
def expected():
    return driven(Program())


@pytest.mark.parametrize("seed", range(4))
def test_copies_delays_and_another_order_change_nothing(seed, expected):
    program = Program(seed)
    assert driven(program) == expected
    assert program.inbox.count.stale > 10


@pytest.fixture
def inbox():
    inbox = Inbox(RobotInterface.of(TRIAL))
    inbox.in_step = True
    return inbox


def forward(inbox):
    return [order.forward for order in inbox.take_orders()]


def test_the_first_command_with_the_stamp_of_the_instant_counts(inbox):
    inbox.begin_instant(2 * STEP)
    for nanoseconds, speed in ((STEP, 0.1), (2 * STEP, 0.2), (2 * STEP, 0.3)):
        inbox.receive("/robot/cmd_vel", answer(nanoseconds, speed), "test")
    assert (inbox.commanded, inbox.stamped) == ({"robot"}, {"robot"})
    assert forward(inbox) == [0.2]
    inbox.receive("/robot/cmd_vel", answer(2 * STEP, 0.4), "test")  # before the next instant is sent
    assert (inbox.commanded, forward(inbox)) == (set(), [])
    assert (inbox.count.velocities, inbox.count.stale) == (4, 3)


def test_a_command_without_a_stamp_or_with_that_of_another_clock_counts_when_it_comes(inbox):
    inbox.begin_instant(2 * STEP)
    plain = {"linear": {"x": 0.5}, "angular": {"z": 0.0}}
    for fields, speed in ((plain, 0.5), (answer(0, 0.6), 0.6), (answer(1_700_000_000 * 10**9, 0.7), 0.7)):
        inbox.receive("/robot/cmd_vel", fields, "test")
        assert (inbox.commanded, inbox.stamped) == ({"robot"}, set())
        assert forward(inbox) == [speed]


def test_in_real_time_the_newest_command_counts(inbox):
    inbox.in_step = False
    inbox.begin_instant(2 * STEP)
    for speed in (0.1, 0.2):
        inbox.receive("/robot/cmd_vel", answer(STEP, speed), "test")
    assert forward(inbox) == [0.2]


@pytest.mark.parametrize("header", [5, {"stamp": 5}, {"stamp": {"sec": "x"}}, {"stamp": {"nanosec": float("nan")}}])
def test_a_wrong_stamp_is_refused(header, inbox):
    with pytest.raises(InputError, match="header"):
        inbox.receive("/robot/cmd_vel", {"header": header, "twist": {"linear": {}}}, "test")
    assert read_stamp({"header": {"stamp": {"secs": 2, "nsecs": 1}}, "twist": {}}) == 2_000_000_001
