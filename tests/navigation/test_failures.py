"""Failures of navigators have clear messages: values that are not finite, and memory that cannot be copied."""

import math
import threading
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from crowdbot.core import InputError, Twist
from crowdbot.navigation import Action, DriveLimits, Navigator, Observation, check_navigator, copy_memory


def seen(time=2.5):
    return Observation(
        pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1, time=time
    )


@dataclass(frozen=True)
class Broken(Navigator):
    twist: Twist

    def act(self, observation):
        return self.twist


@dataclass(frozen=True)
class Hoarder(Navigator):
    memory: object = None

    def begin(self, observation):
        return self.memory

    def act(self, observation, memory):
        return Action(Twist()), memory


@pytest.mark.parametrize("twist", [Twist(math.nan), Twist(0.0, math.inf), Twist(left=-math.inf)])
def test_a_twist_that_is_not_finite_names_navigator_robot_and_time(twist):
    with pytest.raises(InputError) as error:
        Broken(twist).decide(seen(), None, robot="r2")
    assert str(error.value) == (f"navigator Broken of robot 'r2' returned {twist} at 2.5 s; its values must be finite")


@pytest.mark.parametrize(
    ("memory", "words"),
    [
        ({"net": {"lock": threading.Lock()}}, r"memory\['net'\]\['lock'\] is a lock"),
        ([1, SimpleNamespace(rows=(2, iter(c for c in "ab")))], r"memory\[1\].rows\[1\] is a generator"),
        (threading.Lock(), "memory is a lock"),
    ],
)
def test_memory_that_cannot_be_copied_names_the_attribute(memory, words):
    with pytest.raises(InputError, match=f"navigator Hoarder of robot 'r2': {words}, which cannot be copied"):
        Hoarder(memory).first_memory(seen(), robot="r2")
    with pytest.raises(InputError, match=f"navigator Hoarder: {words}"):
        check_navigator(Hoarder(memory))


def test_a_copy_does_not_share_anything():
    memory = {"map": np.zeros(3), "seen": [1]}
    other = copy_memory(memory)
    other["map"][0], other["seen"][0] = 1.0, 2
    assert (memory["map"][0], memory["seen"]) == (0.0, [1])
    assert Hoarder(memory).first_memory(seen()) is memory


def test_memory_that_refers_to_itself_can_be_copied():
    memory = [1]
    memory.append(memory)
    assert copy_memory(memory)[1][0] == 1
