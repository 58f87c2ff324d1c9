"""Profiles of the values of a preset and errors of folds that are left out."""

from __future__ import annotations

import numpy as np
import pytest
from test_population import write_cart, write_street

from crowdbot.models import People
from people import value_profiles as module
from people.crowd_values import CrowdValues
from people.experiments import read_experiments
from people.value_profiles import ValueStudy, study_values, write_study

GOOD = CrowdValues(0.05, 0.1, 1.9, 0.7, (28.0, 2.0), 40.0, 0.0)


@pytest.fixture
def recordings(tmp_path):
    write_street(tmp_path / "eth_biwi/seq_eth/obsmat.txt")
    write_cart(tmp_path / "citr/vci_back")
    return tmp_path


def made_study():
    """Return a study in which data determine the strength, bound the time gap above, and do not see the width."""
    base = {"strength": 8.0, "headway_time_gap": 1.7, "headway_width": 0.5}
    base = {name: base.get(name, 1.0) for name in module.RANGES}
    sets, errors = [base], [0.0]
    for value in (4.0, 6.0, 10.0, 12.0):
        sets.append({**base, "strength": value})
        errors.append(0.05 * abs(value - 8.0))
    for value in (1.2, 1.5, 2.0, 2.2):
        sets.append({**base, "headway_time_gap": value})
        errors.append(max(0.0, value - 1.7))
    for value in (0.4, 0.6, 0.8):
        sets.append({**base, "headway_width": value})
        errors.append(0.0)
    noise = np.random.default_rng(0).normal(0.0, 0.003, (len(sets), 8, 3))
    tracks = 1.0 + np.array(errors)[:, None, None] + noise
    names = tuple(f"street {k}" for k in range(8))
    return ValueStudy(names, ("street",) * 8, tuple(k % 4 for k in range(8)), tuple(sets), tracks, (GOOD,) * len(sets))


def test_profiles_tell_which_values_the_data_determine():
    found = {profile.name: profile for profile in made_study().profiles()}
    assert found["strength"].identified == "yes"
    assert found["strength"].interval == (8.0, 8.0)
    assert found["headway_time_gap"].identified == "not from below"
    assert found["headway_time_gap"].interval[1] == 1.7
    assert found["headway_width"].identified == "no"
    assert found["strength"].values == (4.0, 6.0, 8.0, 10.0, 12.0)
    assert found["strength"].cost[2] == 0.0
    assert all(low <= mean <= high for low, mean, high in
               zip(found["strength"].low, found["strength"].cost, found["strength"].high, strict=True))  # fmt: skip


def test_a_fold_is_scored_on_experiments_that_its_choice_has_not_seen():
    study = made_study()
    study.tracks[3, [0, 4]] = 0.2  # very good in the first fold alone: the choice without it must not take it
    rows = study.fold_errors()
    assert [(fold, names) for fold, names, *_ in rows] == [(k, [f"street {k}", f"street {k + 4}"]) for k in range(4)]
    assert rows[0][3] == pytest.approx([1.0] * 3, abs=0.02)
    assert "| strength | 8 | 8 to 8 | yes |" in made_study().markdown()


def test_a_study_measures_each_value_once_and_resumes(recordings, tmp_path, monkeypatch):
    asked = []

    def crowds(model, sets):
        asked.append(len(sets))
        return [GOOD for _ in sets]

    monkeypatch.setattr(module, "measure_crowds", crowds)
    monkeypatch.setattr(module, "RANGES", {"strength": (3.0, 12.0), "range": (0.02, 0.12)})
    experiments, state = read_experiments(recordings, windows=2), tmp_path / "sets.jsonl"
    study = study_values(People(), experiments, 2, state)
    assert (len(study.sets), asked) == (5, [5])
    assert study.tracks.shape == (5, 2, 3)
    again = study_values(People(), experiments, 2, state)
    assert asked == [5]
    assert np.array_equal(again.tracks, study.tracks)
    write_study(again, tmp_path / "values.md", "# Values\n")
    assert (tmp_path / "values.md").read_text().startswith("# Values\n\n| experiments left out |")
    assert (tmp_path / "values.png").stat().st_size > 1000
