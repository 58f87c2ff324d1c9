"""Runs that wait for commands: which instants are sent again, and that no answer is taken for one to the next."""

from __future__ import annotations

import heapq
import itertools
import threading

import pytest
from bridge_runs import MemoryTransport, Running
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.bridges import BridgeClock, run_bridge
from crowdbot.bridges.run_control import LONGEST, REPEAT, SETTLED, InstantRepeat
from crowdbot.trials import load_trial

STEP = 50_000_000


class Time:
    """A clock that a test sets."""

    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


def simulate(compute, connects, lost, look=0.02, limit=10_000.0):
    """Let a program answer a run of instants in simulated real time; return the instants that its answers were for.

    Args:
        compute: computing time of the program for each instant [s].
        connects: when it has subscribed [s].
        lost: number of its first answers that are lost on the way.
    """
    time, events, got = Time(), [], []
    repeat, busy, sequence, commands, waiting = InstantRepeat(time), 0.0, 0, 0, []

    def send(instant):
        nonlocal busy, sequence
        if time.now >= connects:  # the program works off its queue
            busy = max(busy, time.now) + compute[instant]
            heapq.heappush(events, (busy, sequence, instant))
            sequence += 1

    for instant in range(len(compute)):
        repeat.begin(time.now >= connects, commands, unasked=instant == 0)
        send(instant)
        while not (waiting and repeat.is_settled(commands)):
            assert time.now < limit, "nothing hangs"
            if not waiting and repeat.must_send(time.now >= connects):
                send(instant)
            time.now += look
            while events and events[0][0] <= time.now:
                answered = heapq.heappop(events)[2]
                if lost:
                    lost -= 1
                    continue
                commands += 1
                waiting.append(answered)
        got.append(waiting[-1])
        waiting = []
    return got


def test_a_prompt_program_gets_each_instant_once():
    assert simulate([0.001] * 30, 0.0, 0) == list(range(30))


@given(
    compute=st.lists(st.floats(0.0, 9.0), min_size=1, max_size=12),
    connects=st.floats(0.0, 30.0),
    lost=st.integers(0, 2),
)
def test_no_answer_counts_for_another_instant(compute, connects, lost):
    assert simulate(compute, connects, lost) == list(range(len(compute)))


def test_a_program_at_its_own_rate_does_not_hold_up_a_run():
    time = Time()
    repeat = InstantRepeat(time)
    repeat.begin(heard=True, unasked=True)
    found = []
    for k in range(1, 5):
        time.now = 0.05 * k
        found.append(repeat.is_settled(k))
    assert found == [False, False, True, True]


def test_nothing_is_sent_again_while_nobody_listens_and_the_first_subscriber_gets_the_instant():
    time = Time()
    repeat = InstantRepeat(time)
    repeat.begin(heard=False)
    time.now = 100.0
    assert not repeat.must_send(heard=False)
    assert repeat.must_send(heard=True)
    assert not repeat.must_send(heard=True)
    times = []
    for k in range(1, 1000):
        time.now = 100.0 + 0.02 * k
        if repeat.must_send(heard=True):
            times.append(round(time.now - 100.0, 2))
    assert times[0] == pytest.approx(REPEAT, abs=0.05)
    gaps = [later - early for early, later in itertools.pairwise(times)]
    assert gaps[0] == pytest.approx(2.0 * REPEAT, abs=0.1)
    assert gaps[2:] == pytest.approx([LONGEST] * len(gaps[2:]), abs=0.1), "a program that comes later waits no longer"


def test_all_answers_end_the_wait_early():
    time = Time()
    repeat = InstantRepeat(time)
    repeat.begin(heard=True)
    time.now = 10.0
    assert repeat.must_send(heard=True)
    time.now = 20.0  # it needs 20 s, or its first answer is lost
    assert not repeat.is_settled(1)
    time.now = 20.0 + 2.0 * SETTLED
    assert not repeat.is_settled(1)
    time.now += 1.0
    assert not repeat.is_settled(2)
    time.now += 2.0 * SETTLED
    assert repeat.is_settled(2)


class SlowProgram(MemoryTransport):
    """A program that needs longer for some instants than the run waits before it sends one again."""

    def __init__(self, slow):
        super().__init__()
        self.slow, self.queue, self.news, self.ended = slow, [], threading.Condition(), False
        self.thread = threading.Thread(target=self._work, daemon=True)

    def start(self, interface, inbox):
        super().start(interface, inbox)
        self.thread.start()

    def publish(self, messages):
        super().publish(messages)
        with self.news:
            self.queue += [message.nanoseconds // STEP for message in messages if message.topic == "/clock"]
            self.news.notify_all()

    def stop(self):
        super().stop()
        with self.news:
            self.ended = True
            self.news.notify_all()

    def _work(self):
        while True:
            with self.news:
                self.news.wait_for(lambda: self.queue or self.ended)
                if self.ended:
                    return
                tick = self.queue.pop(0)
                self.news.wait_for(lambda: self.ended, self.slow.get(tick, 0.0))
            self.inbox.receive("/robot/cmd_vel", command_of(tick), "memory")


class HastyProgram(SlowProgram):
    """A program that sends a command when it has connected, and then answers the first instant, too."""

    def _work(self):
        with self.news:
            self.news.wait_for(lambda: self.queue or self.ended)
        self.inbox.receive("/robot/cmd_vel", command_of(0), "memory")
        with self.news:
            self.news.wait_for(lambda: self.ended, 0.05)
        super()._work()


class PromptProgram(MemoryTransport):
    """The same commands, immediately."""

    def publish(self, messages):
        for item in (message for message in messages if message.topic == "/clock"):
            self.inbox.receive("/robot/cmd_vel", command_of(item.nanoseconds // STEP), "memory")


def command_of(tick):
    return {"linear": {"x": 0.4}, "angular": {"z": 0.1 * (tick % 7) - 0.3}}


def test_a_command_before_the_first_answer_does_not_shift_the_others():
    trial = load_trial("frontal", duration=0.5)
    with Running(trial, [HastyProgram({})], "commands") as running:
        done = running.end(120.0)
    assert done.digest == run_bridge(trial, [PromptProgram()], 0, None, BridgeClock("free")).digest


def test_a_program_that_computes_longer_than_the_repeat_gives_the_digest_of_a_free_run():
    trial = load_trial("frontal", duration=0.5)
    slow = SlowProgram({0: 0.5, 3: 1.3, 4: 0.5})
    with Running(trial, [slow], "commands") as running:
        done = running.end(120.0)
    times = [item.nanoseconds // STEP for item in slow.sent if item.topic == "/clock"]
    assert times.count(3) > 1, "the instant was sent again"
    assert done.digest == run_bridge(trial, [PromptProgram()], 0, None, BridgeClock("free")).digest
