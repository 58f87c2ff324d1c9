"""Statistics of the checks: steady windows, intervals over starts, sections and contacts."""

import argparse
import json
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.cli import validate as command
from crowdbot.core import InputError, Scene, stream
from crowdbot.measurement import compute_individual_speed
from crowdbot.models import ORCA, AnticipationVelocity, CollisionFreeSpeed, CrowdModel
from crowdbot.validation import corridor
from crowdbot.validation.bottleneck import steady_flow
from crowdbot.validation.contacts import CONTACT_TRIALS, compare_contacts, measure_contacts, write_contact_page
from crowdbot.validation.crowd_motion import simulate_periodic
from crowdbot.validation.scenario import STEP, CrowdTracks, corridor_walls, substeps
from crowdbot.validation.section import section_of, section_values
from crowdbot.validation.statistics import find_steady_window, summarize_starts, text_of


class Counted(CrowdModel):
    """Walks as it wishes; keeps the time steps it is asked for."""

    paper = ORCA.paper
    steps: ClassVar[list[float]] = []

    def velocity(self, scene, dt, rng=None):
        self.steps.append(dt)
        return scene.desired_velocity(dt)


def _quiet(share):
    pass


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 1000), st.floats(1.0, 5.0))
def test_a_transient_is_left_out(seed, tau):
    times = np.arange(300) * 0.2
    values = 1.0 - np.exp(-times / tau) + 0.02 * np.random.default_rng(seed).normal(size=300)
    window = find_steady_window(times, values)
    assert window.end == times[-1]
    assert 0.5 * tau < window.begin <= times[-1] * 2.0 / 3.0 + 1e-9


def test_a_drift_is_not_steady():
    times = np.arange(300) * 0.2
    window = find_steady_window(times, 1.3 - 0.02 * times)
    assert not window.steady
    assert window.begin == pytest.approx(times[-1] * 2.0 / 3.0)


def test_a_constant_series_is_steady_from_its_first_value():
    times = np.arange(60) * 0.2
    assert find_steady_window(times, np.where(times < 2.0, 0.5, 1.3)) == (2.0, times[-1], True)
    assert find_steady_window(times, np.ones(60)) == (0.0, times[-1], True)


def test_intervals_contain_the_mean_and_one_start_has_none():
    found = summarize_starts([[1.0, 2.0, 3.0, 2.5], [0.5, 0.5, 0.5, 0.5]])
    assert found["starts"] == 4
    assert found["low"][0] < found["mean"][0] < found["high"][0]
    assert found["low"][1] == found["high"][1] == 0.5
    assert summarize_starts([[0.7]]) == {"mean": [0.7], "low": [0.7], "high": [0.7], "starts": 1}
    assert text_of(0.5, (0.4, 0.6)) == "0.50 (0.40 to 0.60)"


def test_models_take_the_time_step_they_are_made_for():
    assert [substeps(model) for model in (ORCA(), CollisionFreeSpeed(), AnticipationVelocity())] == [1, 5, 5]
    assert substeps(Counted()) == 1


def test_the_flow_is_measured_between_the_transients():
    times = np.concatenate([[0.0, 9.0], 10.0 + 0.5 * np.arange(8), [30.0, 50.0]])
    assert steady_flow(times) == pytest.approx(2.0)


def test_a_section_has_the_density_and_speed_of_a_lattice():
    x, y = np.meshgrid(np.arange(0.5, 12.0), np.arange(0.5, 3.0), indexing="ij")
    place = np.stack([x.ravel(), y.ravel()], axis=1)
    times = np.arange(40) * 0.2
    position = place[None, None] + times[:, None, None, None] * np.array([1.1, 0.0])
    walk = CrowdTracks(times, position, np.ones((40, 1, len(place)), dtype=bool))
    density, speed = section_values(section_of(walk, 0, 12.0, 2.0), 3.0, 1.0)
    assert len(density) > 20
    assert density == pytest.approx(1.0)
    assert speed == pytest.approx(1.1)


def test_a_section_begins_at_the_steady_state():
    crowd = Scene.of(
        [[1.0, 1.0]], radius=0.2, preferred_speed=1.3, preferred_velocity=[[1.3, 0.0]], walls=corridor_walls(12.0, 3.0)
    )
    walk = simulate_periodic(Counted(), crowd, 12.0, 20.0, stream(0), _quiet)
    tracks = section_of(walk, 0, 12.0, 10.0)
    assert Counted.steps[-1] == STEP
    assert tracks.frame.min() == round(10.0 / 0.2)
    assert np.nanmedian(np.abs(compute_individual_speed(tracks, 1).speed)) == pytest.approx(1.3)
    assert section_values(tracks, 3.0)[0].shape == (0,)  # a single person has no cell


def test_people_who_see_nobody_are_in_contact():
    blind = measure_contacts(Counted(), "crossing-flows", range(2), 12.0)
    assert blind.overlap > 0.1
    assert 0.0 < blind.low <= blind.share <= blind.high
    assert not blind.passed
    aware = measure_contacts(ORCA(), "crossing-flows", range(2), 12.0)
    assert aware.passed
    assert aware.share == 0.0 < aware.grazing  # ORCA has no margin: people pass at a distance of 0


def test_the_table_resumes_and_says_why(tmp_path):
    file = tmp_path / "contacts.json"
    models = {"orca": ORCA(), "blind": Counted()}
    rows = compare_contacts(models, file, _quiet, ("frontal",), 2, 6.0)
    before = file.stat().st_mtime_ns
    assert compare_contacts(models, file, _quiet, ("frontal",), 2, 6.0) == rows
    assert file.stat().st_mtime_ns == before
    assert json.loads(file.read_text())["orca"]["rimea-1"]["passed"] is True
    rows["blind"]["frontal"]["passed"] = False
    text = write_contact_page(
        rows, tmp_path / "contacts.md", "crowdbot validate", {"blind": "it sees nobody"}
    ).read_text()
    assert "| orca | 2 | 30.1 | 0.0, 0 % | ✓ |" in text
    assert "* **blind**: it sees nobody." in text
    assert "* **orca**" not in text


def test_the_corridor_has_intervals_over_starts(monkeypatch):
    for name, value in {"DENSITIES": (0.5, 1.0), "SECONDS": 8.0}.items():
        monkeypatch.setattr(corridor, name, value)
    rows = corridor.CORRIDOR.run(ORCA(), (0, 3), False, _quiet)
    found = corridor.CORRIDOR.summarize(rows)
    assert (len(rows), found["initial_density"]) == (2, [0.5, 1.0])
    assert all(begin is None or 0.0 <= begin < 8.0 for row in found["steady_from"] for begin in row)
    assert [len(row) for row in found["steady_from"]] == [2, 2]
    alone = corridor.CORRIDOR.run(ORCA(), (3,), False, _quiet)
    assert alone == rows[1:]  # a start does not depend on the others
    for low, mean, high in zip(found["low"], found["speed"], found["high"], strict=True):
        assert low <= mean <= high
    assert found["speed"] == pytest.approx([1.34] * len(found["speed"]), abs=0.1)  # ORCA has no fundamental diagram


def test_the_command_measures_contacts(tmp_path, capsys):
    parser = argparse.ArgumentParser()
    command.arguments(parser)
    given = ["--contacts", "--models", "orca", "--quick", "--starts", "1", "--out", str(tmp_path), "--json"]
    assert command.main(parser.parse_args(given)) == 0
    rows = json.loads(capsys.readouterr().out)["models"]["orca"]
    assert set(rows) == {*CONTACT_TRIALS, "rimea-1"}
    assert (tmp_path / "contacts.md").read_text().startswith("# Contacts and free walking")
    with pytest.raises(InputError, match="--starts 0 must be at least 1"):
        command.main(parser.parse_args(["--contacts", "--starts", "0", "--out", str(tmp_path)]))
