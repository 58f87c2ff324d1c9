"""Reactions to robots in trial files: what is read, written and refused."""

import numpy as np
import pytest

from crowdbot.core import InputError, TrialError
from crowdbot.simulation import simulate
from crowdbot.trials import ReactionSpec, Spawner, expand_spawners, parse_trial, robot_reactions, trial_xml
from crowdbot.world import REACTIONS

TRIAL = """
<trial name="t" duration="4">
  <stage walkable="0,0 12,0 12,8 0,8"/>
  <crowd type="orca"/>
  {agent}
  <spawner name="s" count="8" zone="5,1 11,1 11,7 5,7" goal="0.5,1 2,1 2,7 0.5,7">{spawner}</spawner>
  <robot name="cart" x="1" y="4" radius="0.3">
    <goal x="11" y="4"/>
    <drive type="differential-drive"/>
    <navigator type="straight"/>
  </robot>
  <end goal="false" collision="false"/>
</trial>
"""
AGENT = '<agent name="a" x="4" y="4" goal="1,7"><reaction type="scared" repulsion="2" range="0.5" once="true"/></agent>'
SHARES = '<reaction type="curious" share="0.5" field-of-view="6"/><reaction type="give-way" share="0.3"/>'


def trial(agent=AGENT, spawner=SHARES):
    return parse_trial(TRIAL.format(agent=agent, spawner=spawner))


def test_reactions_are_read_and_written():
    one = trial()
    (scared,), (curious, gives) = one.agents[0].reactions, one.spawners[0].reactions
    assert (scared.type, scared.share, scared.reaction().pause) == ("scared", 1.0, np.inf)
    assert (scared.reaction().repulsion, scared.reaction().range) == (2.0, 0.5)
    assert (curious.field_of_view, gives.share, gives.reaction().duration) == (6.0, 0.3, 8.0)
    assert parse_trial(trial_xml(one)) == one
    assert '<reaction type="curious" share="0.5" field-of-view="6"/>' in trial_xml(one)


def test_people_of_expanded_spawners_react_alike():
    one = trial(agent="")
    found, alone = simulate(one, 5), simulate(expand_spawners(one, 5), 5)
    np.testing.assert_array_equal(found.reactions, alone.reactions)
    assert found.digest == alone.digest
    assert np.any(found.reactions == REACTIONS.index("curious"))


def test_groups_of_elements_with_and_without_reactions():
    one = trial()
    plain = Spawner(count=1, zone=[(0, 0), (1, 0), (1, 1)], goal=[(0, 0), (1, 0), (1, 1)])
    found = robot_reactions((plain, *one.agents, *one.spawners), [0, 1, 2, 2], [], 6)
    assert found.members == (-1, 0, 1, 1, -1, -1)
    assert [reaction.kind for reaction in found.reactions] == ["scared", "curious", "give-way"]
    assert robot_reactions((plain,), [0], [plain], 3) is None


@pytest.mark.parametrize(
    ("spawner", "sentence"),
    [
        ('<reaction type="curios"/>', 'trial:6: <reaction> type="curios" must be regular or ignore'),
        ('<reaction share="0.2"/>', "trial:6: <reaction> needs the attribute 'type'"),
        ('<reaction type="look" share="1.5"/>', 'share="1.5" must be at most 1 and at least 0'),
        ('<reaction type="look" speed="3"/>', 'speed="3" must be at most 1.3 and at least 0'),
        ('<reaction type="look" range="1"/>', 'range acts with type="scared" only, not with type="look"'),
        ('<reaction type="look" once="true" pause="2"/>', "pause has no effect with once"),
        (
            '<reaction type="look" share="0.7"/><reaction type="scared" share="0.6"/>',
            "trial:6: <spawner> the shares of the reactions are 1.3 together, they must be at most 1",
        ),
    ],
)
def test_wrong_reactions_are_told_with_their_line(spawner, sentence):
    with pytest.raises(TrialError) as caught:
        trial(spawner=spawner)
    assert sentence in str(caught.value)


def test_wrong_reactions_in_python():
    zone = [(0, 0), (1, 0), (1, 1)]
    with pytest.raises(InputError, match="shares of the reactions are 2 together"):
        Spawner(count=1, zone=zone, goal=zone, reactions=[ReactionSpec(type="look"), ReactionSpec(type="scared")])
    with pytest.raises(InputError, match="repulsion acts with"):
        ReactionSpec(type="look", repulsion=1.0)
