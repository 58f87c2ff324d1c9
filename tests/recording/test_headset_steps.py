"""Time steps of headsets and cameras, of which control, sensor and recording periods are no multiples."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from crowdbot.recording import branch, read_episode, record, replay
from crowdbot.simulation import simulate, simulate_seeds
from crowdbot.trials import parse_trial
from trial_texts import FLOW


@pytest.mark.parametrize("step", [1 / 60, 1 / 72, 1 / 90])
def test_a_run_is_recorded_replayed_and_branched(step: float, tmp_path: Path) -> None:
    trial = dataclasses.replace(parse_trial(FLOW), step=step, duration=1.5)
    summary = record(trial, 3, out=tmp_path)
    file = tmp_path / "episode.mcap"
    read = read_episode(file)
    assert replay(file).equal
    wanted = 0.1 * np.arange(len(read.times))
    assert np.all((read.times - wanted > -1e-6) & (read.times - wanted < step))
    for time in read.times[[0, 4, 9]].tolist():
        assert branch(file, time).digest == summary.digest
    assert read.tracks(0.4).row_rate == pytest.approx(2.5)
    assert len(np.unique(read.tracks(0.4).frame)) == 4
    many = simulate_seeds(trial, [3, 4])
    assert [item.digest for item in many] == [summary.digest, simulate(trial, 4).digest]
