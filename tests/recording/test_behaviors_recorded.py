"""Runs with behaviour trees: the same in files, batches, replays, branches, and after a restore at any tick."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from behavior_files import write_hall
from crowdbot.core import InputError
from crowdbot.recording import branch, read_episode, record, replay
from crowdbot.simulation import (
    EpisodeDigest,
    Simulation,
    decode_state,
    encode_state,
    restore_state,
    simulate,
    simulate_seeds,
    state_of,
)
from crowdbot.trials import load_trial


@pytest.fixture(scope="module")
def hall(tmp_path_factory):
    return load_trial(write_hall(tmp_path_factory.mktemp("hall")))


@pytest.fixture(scope="module")
def recorded(hall, tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    record(hall, seed=1, out=folder)
    return folder / "episode.mcap"


def test_replays_and_branches_behave_as_the_run(hall, recorded, tmp_path):
    """The files of the trees are in the recording: it is replayed from there."""
    assert read_episode(recorded).digest == simulate(hall, 1).digest
    assert replay(recorded).equal
    same = branch(recorded, at=6.0, out=tmp_path)
    assert same.digest == read_episode(recorded).digest


def test_the_behaviour_of_a_source_cannot_change_in_a_branch(recorded):
    with pytest.raises(InputError, match="the behaviours of source '' cannot change in a branch"):
        branch(recorded, at=4.0, changes={"source.behavior.share": 0.1})


def test_environments_behave_as_alone(hall):
    for seed, episode in zip([1, 2, 5], simulate_seeds(hall, [1, 2, 5]), strict=True):
        alone = simulate(hall, seed)
        assert episode.digest == alone.digest
        np.testing.assert_array_equal(episode.reactions, alone.reactions)


@pytest.mark.parametrize("seeds", [3, [1, 2, 3]])
@given(tick=st.integers(0, 80))
@settings(max_examples=5, deadline=None)
def test_a_restored_run_continues_to_the_last_bit(hall, seeds, tick):
    first = Simulation(hall, seeds)
    for _ in range(tick):
        first.advance()
    second = Simulation(hall, seeds)
    restore_state(second, decode_state(encode_state(state_of(first))))
    digests = []
    for simulation in (first, second):
        digest = EpisodeDigest()
        for _ in range(10):
            simulation.advance()
            for e in range(simulation.count):
                digest.take(simulation.record(e))
        digests.append((digest.hexdigest(""), encode_state(state_of(simulation))))
    assert digests[0] == digests[1]
