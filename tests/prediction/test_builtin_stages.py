"""Stages of published experiments."""

from __future__ import annotations

from pathlib import Path

import pytest

from crowdbot.core import InputError
from crowdbot.data import load
from crowdbot.trials import builtin_stages, check_trial, load_layout, load_trial

RECORDINGS = {
    "hermes-corridor-180": ("hermes/Corridor-1D/uo-050-180-180.txt", {"fps": 16.0, "units": "cm"}),
    "hermes-bottleneck-070": ("hermes/Corridor-1D/uo-180-180-070.txt", {"fps": 16.0, "units": "cm"}),
    "hermes-two-way-360": ("hermes/Corridor-2D/bo-360-090-090.txt", {"fps": 16.0, "units": "cm"}),
    "juelich-two-way-400": ("juelich/bidirectional/bi_corr_400_b_03.txt", {"units": "cm"}),
    "juelich-bottleneck-040": ("juelich/bottleneck/040_c_56_h-.txt", {}),
}


@pytest.mark.parametrize("name", RECORDINGS)
def test_people_of_the_experiment_walk_inside_of_the_stage(name: str, recordings: Path) -> None:
    layout = load_layout(name)
    path, options = RECORDINGS[name]
    tracks = load(recordings / path, **options)
    assert layout.outside(tracks.position[::7]).mean() < 0.01
    assert layout.remark(tracks.position) == ""
    assert layout.exits


def test_every_stage_is_tried_and_is_a_valid_trial() -> None:
    assert set(builtin_stages()) == set(RECORDINGS)
    for name, file in builtin_stages().items():
        trial = load_trial(str(file))
        check_trial(trial)  # raises an error
        assert trial.name == name


def test_an_unknown_stage_is_refused() -> None:
    with pytest.raises(InputError, match="hermes-corridor-999"):
        load_layout("hermes-corridor-999")
