"""Navigators in processes of their own: same runs, explained failures, and a sandbox that holds."""

from __future__ import annotations

import dataclasses
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import crowdbot.navigation
from crowdbot.core import InputError, Twist, find_class
from crowdbot.navigation import Action, DriveLimits, Navigator, Observation, ProcessNavigator
from crowdbot.navigation.process.messages import (
    decode_action,
    decode_memory,
    decode_observation,
    encode_action,
    encode_memory,
    encode_observation,
)
from crowdbot.navigation.process.sandbox import sandbox_problem
from crowdbot.sensors import Lidar2D, Scan
from crowdbot.simulation import Simulation, simulate, simulate_seeds
from crowdbot.trials import Trial, load_trial, parse_trial, trial_xml

SANDBOX = sandbox_problem() is None
"""Whether this system has a sandbox; without one, such navigators are refused."""
CODE = """
from dataclasses import dataclass
import os, sys
from crowdbot.core import Twist
from crowdbot.navigation import Action, Navigator

@dataclass(frozen=True)
class Counter(Navigator):
    speed: float = 0.8
    def begin(self, observation):
        return {"n": 0, "near": ()}
    def act(self, observation, memory):
        near = (*memory["near"], float(min(observation.nearest, 99.0)))[-3:]
        slow = 0.5 if min(near) < 1.0 else 1.0
        return Action(observation.towards_goal(slow * self.speed)), {"n": memory["n"] + 1, "near": near}

@dataclass(frozen=True)
class Seen(Navigator):
    def act(self, observation):
        assert (observation.scan.hit == -1).all() and observation.predictor is None
        return Twist(0.1)

@dataclass(frozen=True)
class Wrong(Navigator):
    what: str = "raise"
    def act(self, observation):
        import socket, subprocess, resource, time
        here = os.path.dirname(__file__)
        {
            "raise": lambda: 1 / 0,
            "exit": lambda: os._exit(3),
            "sleep": lambda: time.sleep(60.0),
            "memory": lambda: bytearray(10**11),
            "socket": socket.socket,
            "fork": os.fork,
            "program": lambda: subprocess.run(["/bin/true"]),
            "kill": lambda: os.kill(os.getppid(), 9),
            "read": lambda: open(os.path.join(here, "..", "other", "secret.txt")).read(),
            "list": lambda: os.listdir(os.path.join(here, "..")),
            "write": lambda: open(os.path.join(here, "mine.txt"), "w"),
            "mode": lambda: os.chmod(os.path.join(here, "..", "other", "secret.txt"), 0),
            "cut": lambda: os.truncate(os.path.join(here, "..", "other", "secret.txt"), 0),
            "environment": lambda: open(f"/proc/{os.getppid()}/environ").read(),
            "limit": lambda: resource.setrlimit(resource.RLIMIT_AS, (-1, -1)),
            "limit of another": lambda: resource.prlimit(os.getppid(), resource.RLIMIT_CPU, (1, 1)),
        }[self.what.replace("_", " ")]()
        return Twist(0.5)

@dataclass(frozen=True)
class Odd(Navigator):
    def act(self, observation, memory):
        return Action(Twist(0.1)), open(__file__)

@dataclass(frozen=True)
class Loud(Navigator):
    def act(self, observation):
        print("hello")
        return Twist(0.25)
"""


@pytest.fixture
def mine(tmp_path: Path) -> str:
    (tmp_path / "own").mkdir()
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "secret.txt").write_text("seeds", encoding="utf-8")
    (tmp_path / "own" / "mine.py").write_text(CODE, encoding="utf-8")
    return str(tmp_path / "own" / "mine.py")


def observation() -> Observation:
    return Observation(pose=(0.0, 0.0, 0.0), goal=(4.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1)


def with_navigator(trial: Trial, navigator: Any) -> Trial:
    return dataclasses.replace(trial, robots=(dataclasses.replace(trial.robots[0], navigator=navigator),))


def own_counter(address: str) -> Any:
    return find_class(f"{address}:Counter", crowdbot.navigation, Navigator)()


@pytest.mark.program
@pytest.mark.parametrize("sandbox", sorted({False, SANDBOX}))
def test_a_run_is_that_of_the_navigator_in_this_process(mine: str, sandbox: bool) -> None:
    trial = load_trial("crossing-flows", duration="3")
    apart = with_navigator(trial, ProcessNavigator(address=f"{mine}:Counter", sandbox=sandbox))
    here = [simulate(with_navigator(trial, own_counter(mine)), seed).digest for seed in (0, 1)]
    assert [seed.digest for seed in simulate_seeds(apart, [0, 1])] == here


@pytest.mark.program
def test_a_branch_continues_with_the_memory(mine: str) -> None:
    trial = load_trial("crossing-flows", duration="3")
    simulation = Simulation(with_navigator(trial, ProcessNavigator(address=f"{mine}:Counter", sandbox=SANDBOX)), 0)
    for _ in range(20):
        simulation.advance()
    copy = simulation.select([0])
    for _ in range(20):
        simulation.advance()
        copy.advance()
    assert np.array_equal(simulation.world.scene.position, copy.world.scene.position)
    assert json.loads(simulation.robots[0].memories[0])["dict"]["n"] > 20


@pytest.mark.program
def test_parameters_reach_the_navigator(mine: str) -> None:
    navigator = ProcessNavigator(address=f"{mine}:Counter", parameters="speed=0.3", sandbox=SANDBOX)
    action, _ = navigator.act(observation(), navigator.begin(observation()))
    assert action.twist == Twist(0.3)
    with pytest.raises(InputError, match="counter has no attribute 'pace'"):
        ProcessNavigator(address=f"{mine}:Counter", parameters="pace=1", sandbox=SANDBOX).begin(observation())


def test_it_is_written_and_read_in_a_trial(mine: str) -> None:
    trial = with_navigator(
        load_trial("frontal"), ProcessNavigator(address=f"{mine}:Counter", timeout=2.0, sandbox=SANDBOX)
    )
    assert parse_trial(trial_xml(trial)).robots[0].navigator == trial.robots[0].navigator


@pytest.mark.program
def test_what_it_prints_does_not_matter(mine: str) -> None:
    assert ProcessNavigator(address=f"{mine}:Loud", sandbox=SANDBOX).act(observation(), "null")[0] == Action(
        Twist(0.25)
    )


@pytest.mark.live
@pytest.mark.parametrize(
    ("what", "message"),
    [
        ("raise", r"ZeroDivisionError: division by zero \(mine.py, line \d+\)"),
        ("exit", r"its process has ended \(exit status 3\)"),
        ("sleep", r"its process did not answer within 2 s"),
        ("memory", "MemoryError"),
        ("socket", "Operation not permitted"),
        ("fork", "Operation not permitted"),
        ("program", "Operation not permitted"),
        ("kill", "Operation not permitted"),
        ("read", "Permission denied"),
        ("list", "Permission denied"),
        ("write", "Permission denied"),
        ("mode", "Operation not permitted"),
        ("cut", "(Operation not permitted|Permission denied)"),
        ("environment", "Permission denied"),
        ("limit", "not allowed to raise maximum limit"),
        ("limit_of_another", "Operation not permitted"),
    ],
)
def test_hostile_code_fails_alone(mine: str, what: str, message: str) -> None:
    if not SANDBOX:
        with pytest.raises(InputError, match="sandbox=false runs the code without one"):
            ProcessNavigator(address=f"{mine}:Wrong")
        return
    navigator = ProcessNavigator(address=f"{mine}:Wrong", parameters=f"what={what}", timeout=2.0)
    with pytest.raises(InputError, match=message):
        navigator.act(observation(), "null")
    folder = Path(mine).parents[1]
    assert (folder / "other" / "secret.txt").read_text(encoding="utf-8") == "seeds"
    assert [path.name for path in (folder / "own").iterdir() if path.name != "__pycache__"] == ["mine.py"]


@pytest.mark.program
def test_a_failure_is_a_counted_failure_of_its_run(mine: str) -> None:
    navigator = ProcessNavigator(address=f"{mine}:Wrong", parameters="what=exit", sandbox=SANDBOX)
    with pytest.warns(UserWarning, match="its process has ended"):
        episode = simulate(with_navigator(load_trial("frontal", duration="1"), navigator))
    assert episode.outcome == "error"


@pytest.mark.program
def test_the_truth_of_sensors_stays_out(mine: str) -> None:
    trial = with_navigator(
        load_trial("crossing-flows", duration="1"), ProcessNavigator(address=f"{mine}:Seen", sandbox=SANDBOX)
    )
    assert simulate(trial).failure is None


@pytest.mark.program
def test_memories_must_be_plain(mine: str) -> None:
    with pytest.raises(InputError, match=r"memory is a TextIOWrapper; store numbers, texts, lists"):
        ProcessNavigator(address=f"{mine}:Odd", sandbox=SANDBOX).act(observation(), "null")


@pytest.mark.program
def test_a_program_of_another_language_can_answer(tmp_path: Path) -> None:
    program = tmp_path / "other.py"
    program.write_text(
        "import json, sys\n"
        "print(json.dumps({'ready': True}), flush=True)\n"
        "for line in sys.stdin:\n"
        "    call = json.loads(line)\n"
        "    x = call['observation']['goal'][0]\n"
        "    print(json.dumps({'memory': '1', 'twist': [0.1 * x, 0.0, 0.0]}), flush=True)\n",
        encoding="utf-8",
    )
    for sandbox in {False, SANDBOX}:
        navigator = ProcessNavigator(command=f"{sys.executable} {program}", sandbox=sandbox)
        assert navigator.act(observation(), navigator.begin(observation())) == (Action(Twist(0.4)), "1")


@pytest.mark.program
@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("say('no')", "answers with a line that is not JSON"),
        ("say('[1]')", "answers with JSON that is not an object"),
        ("say('{\"twist\": [1]}')", "the answer has no valid twist"),
        (
            "print('{}', flush=True)\nprint('{\"twist\": [1, 2, 3], \"memory\": 4}', flush=True)\ninput()",
            "must be a text",
        ),
        ("raise SystemExit('no map')", r"its process has ended \(exit status 1\): no map"),
    ],
)
def test_wrong_answers_are_explained(tmp_path: Path, lines: str, message: str) -> None:
    begin = "def say(text):\n    print('{}', flush=True)\n    print(text, flush=True)\n    input()\n"
    (tmp_path / "odd.py").write_text(begin + lines, encoding="utf-8")
    navigator = ProcessNavigator(command=f"{sys.executable} {tmp_path / 'odd.py'}", sandbox=False)
    with pytest.raises(InputError, match=message):
        navigator.act(observation(), "null")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({}, "give either an address such as mine.py:Mine, or a command"),
        ({"address": "a.py:A", "command": "b"}, "give either an address"),
        ({"command": "b", "parameters": "x=1"}, "parameters belong to an address"),
        ({"address": "a.py:A", "parameters": "x"}, "must be name=value"),
        ({"address": "a.py:A", "timeout": 0.0}, "timeout"),
    ],
)
def test_wrong_settings_are_refused(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        ProcessNavigator(**({"sandbox": SANDBOX} | values))


@pytest.mark.program
def test_a_missing_file_or_program_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nowhere.py"):
        ProcessNavigator(address=f"{tmp_path / 'nowhere.py'}:Mine", sandbox=SANDBOX).begin(observation())
    with pytest.raises(InputError, match="nowhere cannot be started"):
        ProcessNavigator(command="/nowhere", sandbox=False).begin(observation())


def test_observations_come_back() -> None:
    trial = load_trial("crossing-flows", duration="3")
    simulation = Simulation(trial, 0)
    for _ in range(12):
        simulation.advance()
    sent = simulation.observation("robot")
    found = decode_observation(json.loads(json.dumps(encode_observation(sent), allow_nan=False)))
    for name in ("pose", "goal", "waypoint", "radius", "limits", "dt", "time", "twist"):
        assert getattr(found, name) == getattr(sent, name)
    for name in ("position", "velocity", "radius", "ids", "existence", "gesture"):
        assert np.array_equal(getattr(found.people, name), getattr(sent.people, name))
    assert np.array_equal(found.walls.start, sent.walls.start)
    assert isinstance(found.scan, Scan)
    assert isinstance(sent.scan, Scan)
    assert np.array_equal(found.scan.ranges, sent.scan.ranges)
    assert (found.scan.hit == -1).all()
    assert isinstance(trial.robots[0].sensors[0].sensor, Lidar2D)


plain = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**53), 2**53) | st.floats(allow_nan=False) | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.lists(inner, max_size=4).map(tuple)
        | st.dictionaries(st.text(max_size=5), inner, max_size=4)
    ),
    max_leaves=12,
)


@given(memory=plain)
def test_plain_memories_come_back(memory: Any) -> None:
    found = decode_memory(encode_memory(memory))
    assert found == memory
    assert type(found) is type(memory)


@given(
    twist=st.tuples(*(st.floats(-9, 9) for _ in range(3))),
    joints=st.dictionaries(st.text(max_size=4), st.floats(-3, 3)),
)
def test_actions_come_back(twist: tuple[float, float, float], joints: dict[str, float]) -> None:
    action = Action(Twist(*twist), joints)
    assert decode_action(json.loads(json.dumps(encode_action(action)))) == action
