"""Reactions to robots in episodes: the same in memory, in files, in batches, in replays and in branches."""

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.recording import branch, read_episode, record, replay, run
from crowdbot.rendering import plot_reactions
from crowdbot.simulation import simulate, simulate_seeds
from crowdbot.trials import load_trial, parse_trial
from crowdbot.world import REACTIONS

LOBBY = """
<trial name="lobby" duration="9">
  <stage walkable="0,0 16,0 16,8 0,8"/>
  <crowd type="orca"/>
  <agent name="ann" x="8" y="4.3" goal="1,4.3"><reaction type="curious" duration="3"/></agent>
  <spawner name="visitors" count="6" zone="7,1 15,1 15,7 7,7" goal="0.5,1 2,1 2,7 0.5,7">
    <reaction type="scared" share="0.4"/>
    <reaction type="give-way" share="0.3"/>
    <reaction type="ignore" share="0.1"/>
  </spawner>
  <source zone="14,1 15,1 15,7 14,7" goal="0.5,1 2,1 2,7 0.5,7" rate="0.5">
    <reaction type="look" share="0.5" distance="9"/>
  </source>
  <robot name="cart" x="1" y="4" radius="0.3">
    <goal x="15" y="4"/>
    <drive type="differential-drive"/>
    <navigator type="orca"/>
  </robot>
  <end goal="false" collision="false"/>
</trial>
"""


@pytest.fixture(scope="module")
def lobby():
    return parse_trial(LOBBY)


@pytest.fixture(scope="module")
def recorded(lobby, tmp_path_factory):
    folder = tmp_path_factory.mktemp("lobby")
    record(lobby, seed=1, out=folder)
    return folder / "episode.mcap"


def test_a_file_holds_the_reactions_of_the_run(lobby, recorded):
    run_, file = simulate(lobby, 1), read_episode(recorded)
    assert file.digest == run_.digest
    np.testing.assert_array_equal(file.reactions, run_.reactions)
    assert run_.reactions.shape == run_.active.shape
    kinds = {REACTIONS[code] for code in np.unique(run_.reactions)}
    assert kinds >= {"curious", "scared", "give-way", "look"}
    assert not np.any(run_.reactions[~run_.active])
    assert not np.any(run_.reactions[:, run_.robots[0]])
    assert run_.reactions[:, 0].max() == REACTIONS.index("curious")


def test_replays_and_branches_react_as_the_run(recorded, tmp_path):
    again = replay(recorded)
    assert again.differs is None
    assert again.equal
    same = branch(recorded, at=6.0, out=tmp_path)
    assert same.digest == read_episode(recorded).digest
    after = read_episode(tmp_path / "episode.mcap")
    np.testing.assert_array_equal(after.reactions[-10:], read_episode(recorded).reactions[-10:])


def test_the_reactions_of_a_source_cannot_change_in_a_branch(recorded):
    with pytest.raises(InputError, match="the reactions of source '' cannot change in a branch"):
        branch(recorded, at=4.0, changes={"source.reaction.share": 0.1})


def test_environments_react_as_alone(lobby):
    episodes = simulate_seeds(lobby, [1, 2, 5])
    for seed, episode in zip([1, 2, 5], episodes, strict=True):
        alone = simulate(lobby, seed)
        assert episode.digest == alone.digest
        np.testing.assert_array_equal(episode.reactions, alone.reactions)


def test_without_reactions_nothing_is_recorded(tmp_path):
    trial = load_trial("frontal", duration=1.0)
    record(trial, out=tmp_path)
    file = tmp_path / "episode.mcap"
    assert read_episode(file).reactions is None
    assert b"/crowdbot/reactions" not in file.read_bytes()
    with pytest.raises(InputError, match="nobody can react to robots in this episode"):
        plot_reactions(read_episode(file), tmp_path / "plot.png")


def test_the_plot_is_a_picture(recorded, tmp_path):
    file = plot_reactions(read_episode(recorded), tmp_path / "plot.png")
    assert file.read_bytes().startswith(b"\x89PNG")


def test_reactions_change_the_run(lobby):
    plain = parse_trial("".join(line for line in LOBBY.splitlines() if "<reaction" not in line or "agent" in line))
    assert run(plain, seed=1).digest != run(lobby, seed=1).digest
