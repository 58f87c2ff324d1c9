"""Presets: data, the classes that are made of them, and the names that find them."""

from __future__ import annotations

import pytest

import crowdbot.models as room
from crowdbot.core import find_class, from_attributes, parameters
from crowdbot.models import CollisionFreeSpeed, People, check_model, crowd_presets


def test_people_is_a_model_by_name():
    assert find_class("people", room, room.CrowdModel) is People
    model = from_attributes(People, {"headway-time-gap": "0.8"})
    assert model.headway_time_gap == 0.8
    assert isinstance(model.model, CollisionFreeSpeed)
    check_model(People())


@pytest.mark.parametrize("preset", crowd_presets().values(), ids=lambda preset: preset.key)
def test_a_preset_has_its_values_and_its_provenance(preset):
    table = {row.name: row for row in parameters(getattr(room, preset.name))}
    assert set(preset.parameters) <= set(table)
    for name, given in preset.parameters.items():
        assert table[name].default == given["value"], name
        assert table[name].source == f"preset {preset.key}"
        assert table[name].low <= given["value"] <= table[name].high, name
    assert preset.data
    assert preset.held_back
    assert preset.errors
    assert preset.weaknesses
    assert preset.method.endswith(".")


def test_other_parameters_keep_their_defaults_and_sources():
    preset, own = crowd_presets()["people"], {row.name: row for row in parameters(CollisionFreeSpeed)}
    for row in parameters(People):
        if row.name in own and row.name not in preset.parameters:
            assert row == own[row.name]
