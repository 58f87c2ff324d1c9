"""Costs do not depend on the origin, the axes, the numbers of people, or the order of windows."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made_crowds import Drifting, resimulate, windows

from crowdbot.calibration import Absolute, Cost, InterPedestrian, Progressive, WeightedSum
from crowdbot.data import Windows
from crowdbot.models import ORCA, CrowdModel, SocialForce
from samples import sample

COSTS = [Absolute(), InterPedestrian(), Progressive(), WeightedSum((Absolute(), Progressive()), (0.3, 2.0))]
MODELS: list[CrowdModel] = [Drifting(share=0.8, push=1.5), ORCA(), SocialForce()]
every_cost = pytest.mark.parametrize("cost", COSTS, ids=lambda cost: type(cost).__name__)
seeds = st.integers(0, 1000)


def measure(cost: Cost, past: Windows, model: CrowdModel = MODELS[0]) -> np.ndarray:
    return cost.measure(resimulate(past, model))[0]


def moved(past: Windows, angle: float, shift: tuple[float, float]) -> Windows:
    """Return the windows turned about the origin and then shifted."""
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    return dataclasses.replace(past, position=past.position @ turn + np.array(shift))


@every_cost
@settings(max_examples=15)
@given(seed=seeds, x=st.floats(-1e3, 1e3), y=st.floats(-1e3, 1e3))
def test_shifting_the_crowd_changes_no_cost(cost: Cost, seed: int, x: float, y: float) -> None:
    past = windows(seed=seed)
    np.testing.assert_allclose(measure(cost, moved(past, 0.0, (x, y))), measure(cost, past), atol=1e-9)


@every_cost
@settings(max_examples=15)
@given(seed=seeds, angle=st.floats(-math.pi, math.pi))
def test_turning_the_crowd_changes_no_cost(cost: Cost, seed: int, angle: float) -> None:
    past = windows(seed=seed)
    np.testing.assert_allclose(measure(cost, moved(past, angle, (0.0, 0.0))), measure(cost, past), atol=1e-9)


@every_cost
@settings(max_examples=15)
@given(seed=seeds, order=st.permutations(range(5)))
def test_renumbering_people_renumbers_their_costs(cost: Cost, seed: int, order: list[int]) -> None:
    past = windows(seed=seed)
    renumbered = dataclasses.replace(
        past, position=past.position[:, :, order], present=past.present[:, :, order], scored=past.scored[:, order],
        robot=past.robot[:, order], id=past.id[:, order],
    )  # fmt: skip
    np.testing.assert_allclose(measure(cost, renumbered), measure(cost, past)[:, order], atol=1e-12)


@pytest.mark.parametrize("cost", sample(COSTS, 1), ids=lambda cost: type(cost).__name__)
@pytest.mark.parametrize("model", sample(MODELS[1:], 1), ids=lambda model: type(model).__name__)
def test_built_in_models_give_the_same_cost_in_a_turned_and_shifted_crowd(cost: Cost, model: CrowdModel) -> None:
    past = windows(seed=3)
    past = dataclasses.replace(past, position=4.0 * past.position)  # bodies do not overlap
    np.testing.assert_allclose(
        measure(cost, moved(past, 1.1, (20.0, -7.0)), model), measure(cost, past, model), atol=1e-7
    )


@every_cost
def test_windows_do_not_influence_each_other(cost: Cost) -> None:
    past = windows(W=4)
    whole = measure(cost, past)
    for order in ([2], [3, 0], [1, 1, 2]):
        assert np.array_equal(measure(cost, past[np.array(order)]), whole[order], equal_nan=True)


@every_cost
def test_costs_are_distances_of_people_who_count(cost: Cost) -> None:
    past = windows(W=5)
    found = measure(cost, past)
    counted = ~np.isnan(found)
    assert np.any(counted)
    assert np.all(found[counted] > 0.0)
    assert not np.any(counted & past.robot)
    never = ~past.present.any(axis=1)
    assert not np.any(counted & never)


@every_cost
@settings(max_examples=10)
@given(factor=st.floats(0.2, 5.0))
def test_costs_scale_with_length(cost: Cost, factor: float) -> None:
    """Without interaction, a crowd that is larger by a factor has costs that are larger by it."""
    past, model = windows(), Drifting(share=0.7, push=0.0)
    larger = dataclasses.replace(past, position=past.position * factor)
    np.testing.assert_allclose(measure(cost, larger, model), factor * measure(cost, past, model), rtol=1e-9)


@every_cost
def test_a_displacement_of_one_person_costs_that_person(cost: Cost) -> None:
    """The last recorded row decides no simulation: moving somebody there changes only costs that look at it."""
    past = windows(W=2)[np.array([0])]
    position = past.position.copy()
    position[:, -1, 0] += [3.0, 4.0]
    before, after = measure(cost, past), measure(cost, dataclasses.replace(past, position=position))
    changed = np.flatnonzero(~np.isclose(before, after, equal_nan=True)[0])
    assert 0 in changed
    if not isinstance(cost, InterPedestrian):
        assert changed.tolist() == [0]
