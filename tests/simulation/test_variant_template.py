"""Variants of a trial as environments of one simulation."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.simulation import Simulation, VariantTemplate, simulate, simulate_variants
from crowdbot.trials import Trial, apply_values, expand_sweeps, load_trial, parse_trial
from space_trials import LEAN, room
from trial_texts import FLOW, GOOD

CHANGES: list[dict[str, Any]] = [
    {"crowd/time-horizon": 1},
    {"robot/x": -3.0, "robot/heading": 0.4},
    {"robot/goal/x": 2.0, "robot/goal/tolerance": 0.3},
    {"spawner[east]/zone": "-5,-1 -4,-1 -4,1 -5,1", "spawner[west]/speed": "1.1"},
]


def variants() -> list[Trial]:
    trial = dataclasses.replace(parse_trial(GOOD), duration=2.0)
    return [trial, *(apply_values(trial, change) for change in CHANGES)]


def test_each_variant_equals_its_own_run() -> None:
    trials, seeds = variants(), [5, 5, 6, 7, 8]
    together = simulate_variants(trials, seeds)
    alone = [simulate(trial, seed) for trial, seed in zip(trials, seeds, strict=True)]
    assert [item.digest for item in together] == [item.digest for item in alone]
    assert [item.outcome for item in together] == [item.outcome for item in alone]
    assert [repr(dict(item.metrics)) for item in together] == [repr(dict(item.metrics)) for item in alone]
    assert len({item.digest for item in together}) == 5


@pytest.mark.parametrize("text", [FLOW, room("physics", LEAN)])
def test_variants_with_sources_and_bodies(text: str) -> None:
    trial = dataclasses.replace(parse_trial(text), duration=0.6)
    name = trial.robots[0].name if trial.robots else ""
    changes = [{}, {f"robot[{name}]/goal/x": 5.0}] if name else [{}, {"spawner[hall]/zone": "-4,-2 -3,-2 -3,2 -4,2"}]
    trials = [apply_values(trial, change) for change in changes]
    together = simulate_variants(trials, [3, 3])
    assert [item.digest for item in together] == [simulate(trial, 3).digest for trial in trials]


def test_variants_are_restarted_selected_and_put_with_their_own_values() -> None:
    trials = variants()
    simulation = Simulation(VariantTemplate(trials), range(5))
    for _ in range(7):
        simulation.advance()
    simulation.restart([3, 1], [30, 10])
    some = simulation.select([3, 3, 2])
    some.restart([1], [31])
    simulation.put([3], some.select([1]))
    for _ in range(9):
        simulation.advance()
    for e, seed in ((1, 10), (3, 31)):
        alone = Simulation(trials[e], seed)
        for _ in range(9):
            alone.advance()
        assert np.array_equal(simulation.world.scene.position[e], alone.world.scene.position[0])
        assert np.array_equal(simulation.robots[0].goal[e], alone.robots[0].goal[0])


def test_a_sweep_over_a_model_runs_as_one_simulation() -> None:
    trial = dataclasses.replace(load_trial("frontal", duration=1.0, model="orca"), sweeps=())
    text = '<sweep path="crowd/time-horizon" values="1 2 3"/>'
    many = expand_sweeps(
        dataclasses.replace(trial, sweeps=parse_trial(GOOD.replace("</trial>", text + "</trial>")).sweeps)
    )
    assert [variant.digest for variant in simulate_variants(many, [1] * 3)] == [
        simulate(item, 1).digest for item in many
    ]


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"step": 0.1}, "step"),
        ({"robot/radius": 0.4}, "robots"),
        ({"spawner[east]/count": 1}, "spawners"),
        ({"crowd/type": "boids"}, "crowd"),
        ({"stage/wall/points": "-6,2.8 6,2.8"}, "stage"),
    ],
)
def test_variants_of_another_shape_are_refused(change: dict[str, Any], what: str) -> None:
    trial = parse_trial(GOOD)
    with pytest.raises(InputError, match=rf"differ in {what}; variants in one simulation can differ in parameters"):
        VariantTemplate([trial, apply_values(trial, change)])


def test_there_is_one_seed_for_each_variant() -> None:
    with pytest.raises(InputError, match="1 seeds are given for 5 variants"):
        Simulation(VariantTemplate(variants()), [1])
    with pytest.raises(InputError, match="at least one trial"):
        VariantTemplate([])
