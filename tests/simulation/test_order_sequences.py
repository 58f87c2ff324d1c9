"""Random sequences of orders, valid and hostile, in both worlds: refused in a sentence, or applied and replayed."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from typing import Any

import numpy as np
import pytest

from crowdbot.core import CrowdbotError, InputError
from crowdbot.simulation import Order, Simulation, SimulationRun, StepRecord, order_kinds, read_order, write_order
from crowdbot.trials import parse_trial
from samples import sizes
from space_trials import LEAN, room
from trial_texts import FLOW

TEXTS = {"flow": FLOW, "physics": room("physics", LEAN)}
STEPS = 4
"""Steps of a sequence."""

WORDS = {
    "robot": ["robot", "puck", "hal", "", "../x", "\x00"],
    "path": ["duration", "crowd/time-horizon", "robot/drive/max-speed", "robot/goal/x", "stage/wall[2]", "robot[puck]",
             "crowd", "nothing", "", "///", "robot[", "source[west]/rate", "limits/max-speed", "stage/cube[1]"],
    "parent": ["", "stage", "crowd", "robot", "nothing"],
    "value": ["1", "-1", "x", "nan", "1e400", "", "0.7", "true", "<a/>"],
    "xml": ["<cube x='1' y='2' size='0.4'/>", "<wall points='1,1 2,1'/>", "<wall/>", "<!DOCTYPE a><a/>", "<a", "",
            "<robot name='new' x='3' y='3'><goal x='5' y='3'/><drive type='differential-drive'/>"
            "<navigator type='straight'/></robot>", "<end/>", "<crowd type='os.system'/>"],
    "joint": ["wheel", "", "HeadYaw"],
    "avatar": ["visitor", ""],
    "source": ["", "page", "ros"],
}  # fmt: skip
NUMBERS = [0.0, 1.0, -1.0, 0.5, 3.0, 7.5, 1e-300, 1e9, -1e308, float("nan"), float("inf"), 2**70]
HOSTILE = [None, True, "1", [1, 2], {"a": 1}, [], 2**80, -(2**63)]


def random_order(rng: np.random.Generator) -> str:
    """Return the JSON of an order with random values, some of a wrong type or name."""
    kinds = order_kinds()
    name = str(rng.choice([*kinds]))
    values: dict[str, Any] = {"order": name}
    for part in dataclasses.fields(kinds[name]):
        if part.default is not dataclasses.MISSING and rng.random() < 0.5:
            continue
        values[part.name] = random_value(part.name, str(part.type), rng)
    if rng.random() < 0.05:
        values["strange"] = 1
    if rng.random() < 0.03:
        values["order"] = "reset"
    return json.dumps(values)


def random_value(name: str, kind: str, rng: np.random.Generator) -> Any:
    if rng.random() < 0.08:
        return HOSTILE[rng.integers(len(HOSTILE))]
    if name == "environment":
        return int(rng.choice([0, 0, 0, 1, -1]))
    if "str" in kind:
        words = WORDS.get(name, ["robot", ""])
        return words[rng.integers(len(words))]
    if "int" in kind and "float" not in kind:
        return int(rng.integers(-2, 12))
    if "bool" in kind:
        return bool(rng.random() < 0.5)
    if "float" in kind and ("tuple" in kind or "list" in kind):
        return [round(float(item), 3) for item in rng.uniform(-5, 12, rng.choice([0, 3, 7]))]
    if rng.random() < 0.25:
        return NUMBERS[rng.integers(len(NUMBERS))]
    return round(float(rng.uniform(-5, 12)), 3)


class Log:
    """Keeps the orders that were applied, and a digest of all scenes."""

    def __init__(self) -> None:
        self.orders: dict[int, list[str]] = {}
        self.sum = hashlib.blake2b(digest_size=16)

    def take(self, frame: StepRecord) -> None:
        self.orders[frame.tick] = [write_order(order) for order in frame.orders]
        self.sum.update(frame.scene.digest().encode() + frame.ids.tobytes() + frame.commands.tobytes())


def run_orders(start: Simulation, orders: dict[int, list[str]]) -> tuple[Log, int]:
    """Advance a copy of a simulation with orders, and return what happened and how many orders were refused."""
    log, sentences = Log(), list[str]()
    running = SimulationRun(start.select([0]), [log])
    for _ in range(STEPS):
        given: list[Order] = []
        for text in orders.get(running.simulation.tick, ()):
            try:
                order = read_order(text)
                order.check(running.simulation)
            except InputError as error:
                sentences.append(str(error))
                continue
            assert read_order(write_order(order)) == order
            given.append(order)
        if running.outcome is not None:
            break
        running.step(given)
    running.close()
    scene = running.simulation.world.scene
    for values in (scene.position, scene.velocity, scene.heading, scene.goal):
        assert np.isfinite(values[scene.active]).all()
    assert all(failure is None for failure in running.simulation.failures), running.simulation.failures
    sentences += [sentence for _, sentence in running.refusals]
    assert all(len(sentence) > 10 for sentence in sentences), sentences
    return log, len(sentences)


@pytest.mark.parametrize("count", sizes(12, 1250))
@pytest.mark.parametrize("block", range(4))
@pytest.mark.parametrize("name", TEXTS)
def test_a_random_sequence_is_refused_clearly_or_replays(name: str, block: int, count: int) -> None:
    trial = dataclasses.replace(parse_trial(TEXTS[name]), seed=block)
    start = Simulation(trial, block)
    for _ in range(3):
        start.advance()
    rng = np.random.default_rng([block, count])
    applied = refused = 0
    for _ in range(count):
        orders = {start.tick + k: [random_order(rng) for _ in range(rng.integers(0, 5))] for k in range(STEPS)}
        log, bad = run_orders(start, orders)
        again, more = run_orders(start, log.orders)
        assert again.sum.digest() == log.sum.digest(), orders
        applied, refused = applied + sum(map(len, log.orders.values())), refused + bad
        assert more == 0
    assert applied > count / 20
    assert refused > count


def test_hostile_texts_are_no_orders() -> None:
    for text in ("", "[]", "null", "{", '{"order": 3}', '{"order": "velocity"}', "[" * 100_000, '"' + "a" * 2_000_000):
        with pytest.raises(CrowdbotError):
            read_order(text)
