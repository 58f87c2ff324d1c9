"""Gestures of people to a robot: who goes first, and the same in files, batches, replays, and after a restore."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import GESTURES, InputError, TrialError
from crowdbot.recording import read_episode, record, replay
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
from crowdbot.trials import ReactionSpec, load_trial, parse_trial, trial_xml
from crowdbot.world import RobotReaction

WAIT, PROCEED = GESTURES.index("wait"), GESTURES.index("proceed")
CROSSING = """
<trial name="crossing" duration="16">
  <stage walkable="-10,-10 10,-10 10,10 -10,10"/>
  <crowd type="orca"/>
  <agent name="ann" x="0" y="-7" goal="0,9" speed="1.2">
    {reaction}
  </agent>
  <robot name="cart" x="-6" y="0" radius="0.3">
    <goal x="6" y="0"/>
    <drive type="differential-drive" max-speed="{speed}"/>
    <navigator type="straight"/>
  </robot>
  <end goal="false" collision="false"/>
</trial>
"""
LOOK = '<reaction type="look" gesture="{}" distance="6" duration="20"/>'
PERSON, ROBOT = 0, 1


def crossing(gesture="wait", speed=0.7, reaction=LOOK):
    return parse_trial(CROSSING.format(reaction=reaction.format(gesture), speed=speed))


@pytest.fixture(scope="module")
def waiting():
    return crossing()


@pytest.fixture(scope="module")
def recorded(waiting, tmp_path_factory):
    folder = tmp_path_factory.mktemp("crossing")
    record(waiting, seed=1, out=folder)
    return folder / "episode.mcap"


def spans(episode):
    """Return the first and the last recorded step with a gesture of the person, and its code."""
    at = np.flatnonzero(episode.gestures[:, PERSON])
    assert np.array_equal(at, np.arange(at[0], at[-1] + 1))  # one gesture
    assert not np.any(episode.gestures[:, ROBOT])
    return int(at[0]), int(at[-1]), int(episode.gestures[at[0], PERSON])


def test_who_tells_the_robot_to_wait_walks_on_until_it_is_passed(waiting):
    episode = simulate(waiting, 1)
    first, last, code = spans(episode)
    person, robot = episode.position[:, PERSON], episode.position[:, ROBOT]
    assert code == WAIT
    assert np.hypot(*(person[first] - robot[first])) == pytest.approx(6.0, abs=0.3)
    assert np.hypot(*episode.velocity[first : last + 1, PERSON].T).min() > 1.0
    assert person[last, 1] - robot[last, 1] == pytest.approx(0.3 + 0.2, abs=0.15)
    assert person[:, 1].max() > 8.0


def test_who_tells_the_robot_to_proceed_stands_until_it_has_passed():
    episode = simulate(crossing("proceed", 1.0), 1)
    first, last, code = spans(episode)
    person, robot = episode.position[:, PERSON], episode.position[:, ROBOT]
    assert code == PROCEED
    assert np.hypot(*episode.velocity[first + 1 : last, PERSON].T).max() < 1e-6
    assert person[last, 1] < -2.0
    assert robot[last, 0] - person[last, 0] == pytest.approx(0.3 + 0.2, abs=0.15)
    assert person[-1, 1] > person[last, 1] + 6.0


def test_a_gesture_ends_with_its_duration_where_nobody_passes():
    episode = simulate(crossing("proceed", 0.05, '<reaction type="look" gesture="{}" distance="7" duration="3"/>'), 1)
    first, last, _ = spans(episode)
    assert episode.times[last] - episode.times[first] == pytest.approx(3.0, abs=0.21)
    assert episode.position[:, PERSON, 1].max() > 4.0


@pytest.mark.parametrize(("begin", "end", "made"), [(0.0, 1.0, False), (3.5, 9.0, True), (0.0, 3.2, True)])
def test_a_gesture_begins_within_its_times_only(begin, end, made):
    look = f'<reaction type="look" gesture="proceed" distance="6" duration="20" begin="{begin}" end="{end}"/>'
    episode = simulate(crossing(speed=0.4, reaction=look), 1)
    assert bool(np.any(episode.gestures)) is made
    if made:
        first, last, _ = spans(episode)
        assert begin <= episode.times[first] <= end
        assert episode.times[last] > 9.0


def test_a_behaviour_tree_makes_a_gesture_while_it_chooses_to(tmp_path):
    tree = (
        '<root BTCPP_format="4"><BehaviorTree ID="Courteous"><ReactiveFallback>'
        '<Sequence><IsRobotNear distance="5"/><SurprisedNav gesture="{}"/></Sequence><RegularNav/>'
        "</ReactiveFallback></BehaviorTree></root>"
    )
    text = CROSSING.format(reaction='<behavior file="courteous.xml"/>', speed=1.0)
    (tmp_path / "crossing.xml").write_text(text, encoding="utf-8")
    (tmp_path / "courteous.xml").write_text(tree.format("proceed"), encoding="utf-8")
    episode = simulate(load_trial(tmp_path / "crossing.xml"), 1)
    near = np.hypot(*(episode.position[:, PERSON] - episode.position[:, ROBOT]).T) <= 5.0
    assert set(np.unique(episode.gestures[:, PERSON])) == {0, PROCEED}
    assert np.sum((episode.gestures[:, PERSON] == PROCEED) != near) <= 2  # chosen up to a time step before
    (tmp_path / "courteous.xml").write_text(tree.format("go"), encoding="utf-8")
    with pytest.raises(InputError, match=r"courteous.xml:1: <SurprisedNav> gesture = 'go' must be one of none, wait"):
        simulate(load_trial(tmp_path / "crossing.xml"), 1)


def test_a_file_holds_the_gestures_of_the_run_and_is_replayed(waiting, recorded):
    episode, file = simulate(waiting, 1), read_episode(recorded)
    assert file.digest == episode.digest
    assert np.any(episode.gestures)
    np.testing.assert_array_equal(file.gestures, episode.gestures)
    assert replay(recorded).equal


def test_without_gestures_nothing_is_recorded(tmp_path):
    trial = crossing(reaction='<reaction type="look" distance="6"/>')
    assert simulate(trial, 1).gestures is None
    record(trial, seed=1, out=tmp_path)
    assert read_episode(tmp_path / "episode.mcap").gestures is None
    assert b"/crowdbot/gestures" not in (tmp_path / "episode.mcap").read_bytes()


def test_environments_make_gestures_as_alone(waiting):
    for seed, episode in zip([1, 2, 5], simulate_seeds(waiting, [1, 2, 5]), strict=True):
        alone = simulate(waiting, seed)
        assert episode.digest == alone.digest
        np.testing.assert_array_equal(episode.gestures, alone.gestures)


@pytest.mark.parametrize("seeds", [3, [1, 2, 3]])
@given(tick=st.integers(0, 300))
@settings(max_examples=5, deadline=None)
def test_a_restored_run_continues_to_the_last_bit(waiting, seeds, tick):
    first = Simulation(waiting, seeds)
    for _ in range(tick):
        first.advance()
    second = Simulation(waiting, seeds)
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


def test_gestures_are_read_and_written():
    one = crossing(reaction='<reaction type="look" gesture="proceed" begin="2" end="8"/>')
    (spec,) = one.agents[0].reactions
    assert (spec.gesture, spec.begin, spec.end, spec.reaction().speed) == ("proceed", 2.0, 8.0, 0.0)
    assert parse_trial(trial_xml(one)) == one
    assert '<reaction type="look" gesture="proceed" begin="2" end="8"/>' in trial_xml(one)


@pytest.mark.parametrize(
    ("reaction", "sentence"),
    [
        ('<reaction type="look" gesture="go"/>', 'trial:6: <reaction> gesture="go" must be none or wait or proceed'),
        (
            '<reaction type="curious" gesture="wait"/>',
            'trial:6: <reaction> gesture="wait" acts with type="look" only, not with type="curious"',
        ),
        ('<reaction type="look" begin="4" end="2"/>', 'begin="4" must be below end="2"'),
        ('<reaction type="ignore" begin="1"/>', 'begin and end have no effect with type="ignore"'),
        ('<reaction type="look" begin="-1"/>', 'begin="-1" must be at least 0'),
    ],
)
def test_wrong_gestures_are_told_with_their_line(reaction, sentence):
    with pytest.raises(TrialError) as caught:
        crossing(reaction=reaction)
    assert sentence in str(caught.value)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"gesture": "go"}, "gesture = 'go' must be one of none, wait, proceed"),
        ({"kind": "block", "gesture": "wait"}, "a gesture needs the kind 'look', not 'block'"),
        ({"begin": 3.0, "end": 3.0}, "begin = 3 must be below end = 3"),
        ({"kind": "ignore", "end": 3.0}, "begin and end have no effect with the kind 'ignore'"),
    ],
)
def test_wrong_gestures_in_python(values, sentence):
    with pytest.raises(InputError) as caught:
        RobotReaction(**{"kind": "look"} | values)
    assert sentence in str(caught.value)
    if "gesture" not in values or values["gesture"] != "go":
        with pytest.raises(InputError):
            ReactionSpec(**{"type": values.get("kind", "look")} | {k: v for k, v in values.items() if k != "kind"})
