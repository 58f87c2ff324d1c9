"""Agents, groups, drawn parameters, sweeps and ends: read, checked, written, run."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from crowdbot.core import InputError, TrialError
from crowdbot.models import ORCA, SocialForce
from crowdbot.recording import run
from crowdbot.trials import (
    Agent,
    AgentParameter,
    Crowds,
    End,
    EndCondition,
    Group,
    RandomizedModel,
    Spawner,
    Stage,
    Sweep,
    Trial,
    apply_values,
    expand_spawners,
    expand_sweeps,
    load_trial,
    parse_trial,
    place,
    trial_xml,
)
from samples import sample
from trial_texts import BRIEF_FLOW, FLOW, GOOD, changed

HALL = [(0, 0), (12, 0), (12, 10), (0, 10)]
FAR = [(20, 0), (22, 0), (22, 10), (20, 10)]


def trial(**parts: object) -> Trial:
    return Trial(**{"name": "t", "duration": 4.0, "crowd": ORCA()} | parts)


def refused(text: str) -> str:
    with pytest.raises(TrialError) as found:
        parse_trial(text, place="t.xml")
    return str(found.value)


def test_an_agent_walks_to_its_goal_and_leaves() -> None:
    agent = Agent(name="ann", x=0, y=0, goal="3,0", speed=1.5, radius=0.2)
    episode = run(trial(agents=[agent]))
    assert not episode.active[-1, 0]
    assert episode.radius[0] == 0.2
    assert np.allclose(episode.velocity[5, 0], [1.5, 0.0], atol=1e-9)
    stays = run(trial(agents=[dataclasses.replace(agent, arrival="stay")]))
    assert stays.active[-1, 0]
    early = run(trial(agents=[dataclasses.replace(agent, goal_zone="1,-1 4,-1 4,1 1,1")]))
    assert early.active[:, 0].sum() < episode.active[:, 0].sum() - 10


def test_an_agent_without_goal_stands_and_looks_where_it_is_told() -> None:
    episode = run(trial(agents=[Agent(x=1, y=2, heading=2.0), Agent(x=5, y=5)]))
    assert np.allclose(episode.position[-1], [[1, 2], [5, 5]])
    assert np.allclose(episode.heading[-1], [2.0, 0.0])


@pytest.mark.parametrize(
    ("agent", "sentence"),
    [
        ('<agent x="0.5" y="2"/>', "t.xml:16: <agent> stands at 0.5,2, 0.00 m from a wall"),
        ('<agent x="-5.9" y="0"/>', "stands at -5.9,0, 0.10 m from a wall, and the radius is 0.2 m"),
        ('<agent x="-2" y="-2.3"/>', "stands at -2,-2.3 and overlaps a person or a robot"),
        ('<agent x="1" y="0" goal="2,0" journey="a"/>', "has both a goal and a journey"),
        ('<agent x="1" y="0" journey="a"/>', 'journey="a" is not the name of a journey'),
        ('<agent x="1" y="0" group="-2"/>', 'group="-2" must be at least -1'),
        ('<agent x="1" y="0" goal="2"/>', "has '2' where a point x,y should be"),
        ('<agent x="1" y="0"><parameter name="time-horizn" value="1"/></agent>',
         "<parameter> time-horizn cannot be given, did you mean 'time-horizon'?"),
        ('<agent x="1" y="0"><parameter name="time-horizon" value="-1"/></agent>', '<parameter> time-horizon="-1"'),
    ],
)  # fmt: skip
def test_wrong_agents_are_told(agent: str, sentence: str) -> None:
    assert sentence in refused(changed('  <end collision="false"/>', f"  {agent}\n  <end/>"))


def test_groups_begin_together_and_share_goal_and_speed() -> None:
    spawner = Spawner(count=40, zone=HALL, goal=FAR, groups=[Group(3, 0.3), Group(2, 0.4), Group(1, 0.3)])
    people, problems = place(Stage(), [spawner, spawner], [], 5)
    assert not problems
    numbers, sizes = np.unique(people.group[people.group >= 0], return_counts=True)
    assert set(sizes.tolist()) <= {2, 3}
    assert 4 < np.count_nonzero(people.group == -1) < 50
    for number in numbers:
        mates = people.group == number
        assert len(np.unique(people.owner[mates])) == 1
        assert np.ptp(people.goal[mates], axis=0).max() == 0.0
        assert np.ptp(people.speed[mates]) == 0.0
        assert np.ptp(people.position[mates], axis=0).max() < 2.5
    away = np.hypot(*(people.position[:, None] - people.position[None]).transpose(2, 0, 1))
    gap = away - people.radius[:, None] - people.radius[None] + np.eye(80) * 9.0
    assert gap.min() > 0.0
    full, problems = place(Stage(), [dataclasses.replace(spawner, count=800, groups=[Group(4)])], [], 0)
    assert problems[0][1].startswith(f"only {len(full)} of 800 people fit")
    assert len(full) % 4 == 0


def test_people_who_stand_stay() -> None:
    standing = Spawner(count=6, zone=HALL, stands=True, groups=[Group(2)])
    episode = run(trial(spawners=[standing]))
    assert np.allclose(episode.position[0], episode.position[-1], atol=0.01)
    assert len(np.unique(episode.heading[0])) == 6
    both = changed('count="2" zone="-5', 'stands="true" count="2" zone="-5')
    assert 'has stands="true" and a goal or a journey' in refused(both)


def test_parameters_differ_from_person_to_person() -> None:
    spawner = Spawner(count=30, zone=HALL, goal=FAR)
    crowd = RandomizedModel(ORCA(), {"time_horizon": "normal(2, 0.5)"})
    one = trial(crowd=crowd, spawners=[spawner])
    model = one.crowd
    assert isinstance(model, RandomizedModel)
    drawn = np.asarray(model.resolve(3, 0, 1000).time_horizon)
    assert drawn.mean() == pytest.approx(2.0, abs=0.05)
    assert drawn.std() == pytest.approx(0.5, abs=0.05)
    assert 'time-horizon="normal(2, 0.5)"' in trial_xml(one)
    assert parse_trial(trial_xml(one)) == one
    assert run(one).digest != run(trial(spawners=[spawner])).digest
    assert run(one).digest == run(one).digest


@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        ("normal(2)", 'time-horizon="normal(2)" normal takes 2 or 4 numbers, not 1'),
        ("uniform(-1, 3)", 'time-horizon="uniform(-1, 3)" ranges from -1 to 3: ORCA: time_horizon = -1.0'),
        ("gauss(1, 2)", "'gauss' is not a distribution"),
    ],
)
def test_wrong_distributions_of_parameters_are_told(value: str, sentence: str) -> None:
    assert sentence in refused(changed('time-horizon="2"', f'time-horizon="{value}"'))
    unknown = refused(changed('time-horizon="2"', 'max-sped="normal(2, 0.1)"'))
    assert "has no attribute 'max-sped', did you mean 'max-speed'?" in unknown
    assert "max-speed cannot be drawn" in unknown


@pytest.mark.parametrize("text", [GOOD, BRIEF_FLOW], ids=["good", "flow"])
@pytest.mark.parametrize("seed", sample([7, 0], 1))
def test_an_explicit_trial_runs_as_its_original(text: str, seed: int) -> None:
    given = parse_trial(text)
    explicit = expand_spawners(given, seed)
    assert (len(explicit.agents), explicit.spawners) == (given.people, ())
    assert parse_trial(trial_xml(explicit)) == explicit
    assert run(explicit).digest == run(given, seed=seed).digest


def test_an_explicit_trial_tells_everybodys_own_parameters() -> None:
    crowd = Crowds((RandomizedModel(ORCA(), {"time_horizon": "uniform(1, 3)"}), SocialForce()), names=("a", "b"))
    spawners = [Spawner(name=name, count=3, zone=HALL, goal=FAR, crowd=name, groups=[Group(3)]) for name in ("b", "a")]
    given = trial(crowd=crowd, spawners=spawners)
    explicit = expand_spawners(given)
    assert [len(agent.parameters) for agent in explicit.agents] == [0, 0, 0, 1, 1, 1]
    assert [agent.group for agent in explicit.agents] == [0, 0, 0, 1, 1, 1]
    assert run(explicit).digest == run(given).digest
    agents = [*explicit.agents[:3], *(dataclasses.replace(a, parameters=[AgentParameter("time-horizon", 2.5)]) for a in
                                      explicit.agents[3:])]  # fmt: skip
    edited = dataclasses.replace(explicit, agents=agents)
    assert run(edited).digest != run(given).digest
    fixed = dataclasses.replace(edited, crowd=Crowds((ORCA(time_horizon=2.5), SocialForce()), names=("a", "b")),
                                agents=[dataclasses.replace(a, parameters=()) for a in agents])  # fmt: skip
    assert run(fixed).digest == run(edited).digest


def test_sweeps_make_variants() -> None:
    text = changed("  <end", '  <sweep path="spawner[west]/count" values="1 2 3"/>\n'
                   '  <sweep path="crowd/time-horizon" values="1 normal(2, 0.1)"/>\n'
                   '  <sweep path="end/goal" values="true false"/>\n  <end')  # fmt: skip
    many = parse_trial(text)
    assert parse_trial(trial_xml(many)) == many
    ones = expand_sweeps(many)
    assert len(ones) == 12
    assert len({item.name for item in ones}) == 12
    assert [item.spawners[1].count for item in ones] == [1] * 4 + [2] * 4 + [3] * 4
    assert isinstance(ones[2].crowd, RandomizedModel)
    assert [item.end.goal for item in ones[:2]] == [True, False]
    assert not any(item.sweeps for item in ones)
    with pytest.raises(TrialError, match="has 12 variants in its sweeps; run one of them"):
        run(many)
    plain = parse_trial(GOOD)
    assert expand_sweeps(plain) == (plain,)


@pytest.mark.parametrize(
    ("path", "values", "sentence"),
    [
        ("spawner[3]/count", "1", "does not exist: there are 2 <spawner>"),
        ("spawner[est]/count", "1", "no <spawner> has the name 'est', did you mean 'west'?"),
        ("spawner/count", "1", "is not clear: <trial> has 2 <spawner>; choose one: spawner[east], spawner[west]"),
        ("spawnr[1]/count", "1", "has no element 'spawnr[1]'"),
        ("spawner[1]/cont", "1", "has no 'cont', did you mean 'count'?"),
        ("spawner[1]/count", "1 -4", 'with spawner[1]/count=-4: <spawner> count="-4" must be at least 0'),
        ("spawner[1]/count", "900", "with spawner[1]/count=900: <spawner> only"),
        ("seed", "", "needs the attribute 'values' with at least one value"),
        ("seed", "0:99999999", "more than 10000 values"),
        ("crowd/time-horizn", "2", "did you mean 'time-horizon'?"),
        ("robot[1]/navigator/type", "orca strait", "unknown navigator 'strait'"),
    ],
)
def test_wrong_sweeps_are_told_with_their_line(path: str, values: str, sentence: str) -> None:
    text = changed("  <end", f'  <sweep path="{path}" values="{values}"/>\n  <end')
    said = refused(text)
    assert sentence in said
    assert said.startswith("t.xml:16: <sweep> ")


def test_values_are_changed_by_their_paths() -> None:
    given = parse_trial(GOOD)
    other = apply_values(given, {"robot/goal/x": "2", "recording/period": "0.2", "robot/navigator/type": "orca"})
    assert (other.robots[0].goal.x, other.recording.period) == (2.0, 0.2)
    assert load_trial("crossing-flows", **{"crowd/headway-time-gap": 0.9}).crowd == dataclasses.replace(
        load_trial("crossing-flows").crowd, headway_time_gap=0.9
    )
    assert Sweep("a", "1;2 3; 4").each == ("1", "2 3", "4")


def test_conditions_end_a_trial() -> None:
    given = parse_trial(changed('<end collision="false"/>', '<end collision="false"><when what="x" above="-1"/></end>'))
    episode = run(given)
    assert episode.outcome == "finished"
    assert episode.position[-1, episode.robots[0], 0] == pytest.approx(-1.0, abs=0.15)
    assert parse_trial(trial_xml(given)) == given
    late = dataclasses.replace(
        given, end=End(collision=False, conditions=[EndCondition("time", above=1.0, outcome="timeout")])
    )
    assert (run(late).outcome, run(late).times[-1]) == ("timeout", pytest.approx(1.1))
    few = dataclasses.replace(given, duration=30.0, robots=(), end=End(conditions=[EndCondition("people", below=3.0)]))
    assert np.count_nonzero(run(few).active[-1]) < 3
    empty = run(dataclasses.replace(few, end=End(empty=True)))
    assert empty.outcome == "finished"
    assert empty.times[-1] < 20.0
    assert not empty.active[-1].any()
    for words in ('what="x"', 'what="x" above="1" below="2"'):
        text = changed('<end collision="false"/>', f"<end><when {words}/></end>")
        assert "needs one of below and above" in refused(text)


def test_a_trial_with_sources_is_not_empty_before_the_last_has_come() -> None:
    text = FLOW.replace('duration="20"', 'duration="40"').replace("<end ", '<end empty="true" ')
    text = text.replace('max-count="90"', 'end="6"').replace('end="15"', 'end="9"')
    given = parse_trial(text)
    episode = run(dataclasses.replace(given, robots=()), seed=1)
    assert episode.times[-1] > 9.0 or episode.outcome == "finished"


def test_portals_bring_people_back_as_others() -> None:
    text = """<trial name="ring" duration="20"><crowd type="orca"/>
    <journey name="east"><direction heading="0"/></journey>
    <spawner count="3" zone="-4,-2 4,-2 4,2 -4,2" journey="east" speed="1.5"/>
    <portal name="right" zone="5,-3 8,-3 8,3 5,3" dx="-10"/></trial>"""
    ring = parse_trial(text)
    assert parse_trial(trial_xml(ring)) == ring
    episode = run(ring)
    assert (episode.active.sum(axis=1) == 3).all()
    assert len(episode.ids) > 7
    assert episode.position[episode.active][:, 0].max() < 5.2
    for agent in range(len(episode.ids)):
        way = episode.position[episode.active[:, agent], agent]
        assert np.abs(np.diff(way[:, 0])).max(initial=0.0) < 0.3
    assert run(ring).digest == episode.digest
    crowded = text.replace('duration="20"', 'duration="86400"').replace('dx="-10"', 'dx="-0.1"')
    assert "positions in total; use a longer period" in refused(crowded)
    assert "t.xml:4: <portal> needs dx or dy" in refused(text.replace(' dx="-10"', ""))
    assert "t.xml:4: <portal> zone is not a simple polygon" in refused(text.replace("5,-3 8,-3 8,3 5,3", "5,0 6,0 7,0"))


def test_a_journey_can_begin_again() -> None:
    text = """<trial name="laps" duration="30"><crowd type="orca"/>
    <journey name="lap" then="again"><point x="0" y="0"/><point x="5" y="0"/></journey>
    <agent x="0" y="0" journey="lap" speed="1.5"/></trial>"""
    x = run(parse_trial(text)).position[:, 0, 0]
    turns = np.flatnonzero(np.diff(np.sign(np.diff(x))) != 0)
    assert len(turns) >= 7
    assert x.max() == pytest.approx(5.0, abs=0.4)
    wander = text.replace('<point x="0" y="0"/><point x="5" y="0"/>',
                          '<zone points="0,0 9,0 9,9 0,9" aim="random"/>')  # fmt: skip
    places = run(parse_trial(wander)).position[:, 0]
    assert np.ptp(places, axis=0).min() > 3.0
    assert math.isfinite(places.sum())


def test_many_problems_of_new_parts_are_told_at_once() -> None:
    text = GOOD.replace("  <end", '  <agent x="nan" y="1"/>\n  <portal zone="0,0 1,0 1,1" dx="x"/>\n'
                        '  <sweep path="seed"/>\n  <recorded fps="0"/>\n  <end')  # fmt: skip
    said = refused(text)
    for line, words in ((16, 'x="nan" is not finite'), (17, 'dx="x" is not a number'), (18, "needs the attribute"),
                        (19, 'fps="0" must be above 0')):  # fmt: skip
        assert any(row.startswith(f"t.xml:{line}:") and words in row for row in said.splitlines()), said


def test_a_part_made_in_python_is_checked() -> None:
    with pytest.raises(InputError, match='count="-1" must be at least 0'):
        Spawner(count=-1, zone=HALL)
    with pytest.raises(InputError, match='size="0" must be at least 1'):
        Group(0)
