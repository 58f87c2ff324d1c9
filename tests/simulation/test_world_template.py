"""A template makes the worlds of many seeds exactly as the world of each seed."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from crowdbot.core import InputError, TrialError
from crowdbot.models import ORCA
from crowdbot.simulation import ParameterOrder, Simulation, SimulationRun
from crowdbot.simulation.world_template import WorldTemplate
from crowdbot.trials import Agent, RandomizedModel, Spawner, Trial, load_trial

FIELDS = (
    "position", "velocity", "heading", "radius", "goal", "preferred_speed", "max_speed", "active", "visible",
    "external", "group",
)  # fmt: skip
NAMES = [
    "circle-crossing", "crossing-flows", "bottleneck", "delayed-circle", "two-crowds", "elevator", "four-blocks",
    "static-crowd",
]  # fmt: skip


def assert_same(many: Simulation, e: int, alone: Simulation) -> None:
    scene, one = many.world.environment_scene(e), alone.world.environment_scene(0)
    for name in FIELDS:
        assert getattr(scene, name).tobytes() == getattr(one, name).tobytes(), name
    assert sorted(scene.memory) == sorted(one.memory)
    for name, value in scene.memory.items():
        assert np.ascontiguousarray(value).tobytes() == np.ascontiguousarray(one.memory[name]).tobytes(), name
    slots = int(many.world.slots[e])
    assert slots == int(alone.world.slots[0])
    assert many.world.ids[e, :slots].tolist() == alone.world.ids[0, :slots].tolist()
    for robot, other in zip(many.robots, alone.robots, strict=True):
        assert robot.command[e].tolist() == other.command[0].tolist()


@pytest.mark.parametrize("name", NAMES)
def test_worlds_of_many_seeds_are_those_of_each(name: str) -> None:
    trial, seeds = load_trial(name), [5, -3, 8]
    many = Simulation(trial, seeds)
    for e, seed in enumerate(seeds):
        assert_same(many, e, Simulation(trial, seed))
    for _ in range(8):
        many.advance()
    many.restart([2, 0], [9, 5])
    for _ in range(12):
        many.advance()
    for e, (seed, steps) in enumerate([(5, 12), (-3, 20), (9, 12)]):
        alone = Simulation(trial, 1)
        alone.restart([0], [seed])
        for _ in range(steps):
            alone.advance()
        assert_same(many, e, alone)


@pytest.mark.parametrize("drawn", [True, False])
def test_each_environment_has_its_own_parameters(drawn: bool) -> None:
    model = RandomizedModel(ORCA(), {"time_horizon": "uniform(1, 3)"}) if drawn else ORCA()
    zone = [(0, 0), (4, 0), (4, 4), (0, 4)]
    trial = Trial(name="t", duration=2.0, crowd=model, spawners=[Spawner(count=4, zone=zone, goal="9,0 9,4 8,4")])
    many = Simulation(trial, [1, 2])
    for _ in range(15):
        many.advance()
    for e in range(2):
        alone = Simulation(trial, e + 1)
        for _ in range(15):
            alone.advance()
        assert_same(many, e, alone)


def test_a_template_follows_a_changed_trial() -> None:
    trial = load_trial("frontal")
    run = SimulationRun(Simulation(trial, 3))
    run.step([ParameterOrder(path="robot/drive/max-speed", value="0.2")])
    run.simulation.restart([0], [4])
    assert run.simulation.trial is not trial
    assert run.simulation.world.drives[trial.people].max_speed == 0.2


def test_a_template_makes_simulations() -> None:
    template = WorldTemplate(load_trial("circle-crossing"))
    assert_same(Simulation(template, [3, 4]), 1, Simulation(template.trial, 4))
    assert template.of_trial(template.trial) is template
    other = dataclasses.replace(template.trial, duration=3.0)
    assert template.of_trial(other).trial is other


def test_people_without_room_are_told_in_a_restart() -> None:
    zone = [(0, 0), (2.1, 0), (2.1, 2.1), (0, 2.1)]
    crowd = Spawner(name="hall", count=11, zone=zone, goal="9,0 9,4 8,4", radius=0.3)
    trial = Trial(name="t", duration=2.0, crowd=ORCA(), spawners=[crowd])
    fits = [seed for seed in range(30) if _fits(trial, seed)]
    fails = next(seed for seed in range(30) if seed not in fits)
    simulation = Simulation(trial, fits[:2])
    with pytest.raises(TrialError, match="spawner 'hall': only .* of 11 people fit"):
        simulation.restart([0, 1], [fits[0], fails])
    assert simulation.seeds == fits[:2]


def _fits(trial: Trial, seed: int) -> bool:
    try:
        Simulation(trial, seed)
    except TrialError:
        return False
    return True


def test_an_unreachable_goal_is_told_as_in_one_world() -> None:
    trial = load_trial("doorway")
    wrong = dataclasses.replace(trial, agents=[Agent(x=-2.0, y=0.0, goal="900,900")])
    with pytest.raises(InputError) as alone:
        Simulation(wrong, 0)
    with pytest.raises(InputError) as many:
        Simulation(wrong, [0, 1])
    assert str(many.value) == str(alone.value)
