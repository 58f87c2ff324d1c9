"""Behaviour trees in trial files: what is read, written, checked and refused."""

from pathlib import Path

import numpy as np
import pytest

from behavior_files import HALL, write_hall
from crowdbot.core import InputError, TrialError
from crowdbot.recording import named_files, write_trial_files
from crowdbot.simulation import simulate
from crowdbot.trials import (
    BehaviorSpec,
    ReactionSpec,
    Spawner,
    check_trial,
    expand_spawners,
    load_trial,
    parse_trial,
    robot_reactions,
    trial_xml,
)
from crowdbot.world import REACTIONS
from crowdbot.world.behaviors.node_kinds import KINDS, LEAVES


@pytest.fixture
def hall(tmp_path):
    return load_trial(write_hall(tmp_path))


def changed(tmp_path, old, new, file="hall.xml"):
    write_hall(tmp_path)
    text = (tmp_path / file).read_text(encoding="utf-8")
    assert old in text
    (tmp_path / file).write_text(text.replace(old, new, 1), encoding="utf-8")
    return tmp_path / "hall.xml"


def test_behaviours_are_read_and_written(hall):
    (ann,), (pairs,) = hall.agents[0].behaviors, hall.spawners[0].behaviors
    assert (ann.file, ann.tree, ann.share, ann.regular) == ("visitor.xml", "", 1.0, "ignore")
    assert ann.behavior().name == "VisitorTree"
    assert [reaction.kind for reaction in ann.behavior().reactions] == ["ignore", "curious"]
    assert (pairs.tree, pairs.share, pairs.behavior().leads_journey) == ("GroupTree", 0.6, True)
    check_trial(hall)
    assert parse_trial(trial_xml(hall), folder=hall.folder) == hall
    assert '<behavior file="visitor.xml" tree="GroupTree" share="0.6"/>' in trial_xml(hall)


def test_the_files_of_a_tree_belong_to_the_trial(hall, tmp_path):
    assert sorted(named_files(hall)) == ["visitor.xml", "walk.xml"]
    away = tmp_path / "away" / "hall.xml"
    away.parent.mkdir()
    write_trial_files(hall, away)
    assert simulate(load_trial(away), 2).digest == simulate(hall, 2).digest


def test_people_of_expanded_spawners_behave_alike(hall):
    found, alone = simulate(hall, 5), simulate(expand_spawners(hall, 5), 5)
    assert found.digest == alone.digest
    np.testing.assert_array_equal(found.reactions, alone.reactions)
    assert np.any(found.reactions[:, 0] == REACTIONS.index("curious"))


def test_groups_hold_reactions_and_trees_of_an_element(hall):
    owners = (*hall.agents, *hall.spawners)
    found = robot_reactions(owners, [0, 1, 1], hall.sources, 5)
    assert (found.members, found.sources) == ((0, 1, 1, -1, -1), (2,))
    assert [tree.name for tree in found.trees] == ["VisitorTree", "GroupTree", "VisitorTree"]
    assert [share for _, share in found.groups[1]] == [0.3, 0.6]


@pytest.mark.parametrize(
    ("old", "new", "file", "sentence"),
    [
        ("visitor.xml", "guest.xml", "hall.xml",
         "hall.xml:6: <behavior> file=\"guest.xml\" cannot be used: there is no file 'guest.xml' in"),
        ("visitor.xml", "../visitor.xml", "hall.xml", "lies outside"),
        ('tree="GroupTree"', 'tree="GruopTree"', "hall.xml",
         "hall.xml:10: <behavior> file=\"visitor.xml\" cannot be used: visitor.xml: there is no tree 'GruopTree', did"
         " you mean 'GroupTree'?; known are GroupTree, VisitorTree, WalkTree"),
        ("<CuriousNav", "<CuriosNav", "visitor.xml",
         "cannot be used: visitor.xml:8: <CuriosNav> is no known node, did you mean 'CuriousNav'?; known are"),
        ('path="walk.xml"', 'path="run.xml"', "visitor.xml",
         "cannot be used: visitor.xml:2: <include>: there is no file 'run.xml' in"),
        ('path="walk.xml"', 'path="/etc/hostname"', "visitor.xml",
         "visitor.xml:2: <include>: the file '/etc/hostname' lies outside"),
        ("<root main", '<!DOCTYPE a [<!ENTITY b SYSTEM "c">]><root main', "walk.xml",
         "cannot be used: walk.xml:1: a behaviour tree must not have a DOCTYPE or entities"),
        ('share="0.6"', 'share="0.8"', "hall.xml",
         "hall.xml:7: <spawner> the shares of the reactions and behaviours are 1.1 together, they must be at most 1"),
        ('regular="ignore"', 'regular="curious"', "hall.xml", 'regular="curious" must be regular or ignore'),
        ('<behavior file="visitor.xml" regular="ignore"/>', "<behavior/>", "hall.xml", "needs the attribute 'file'"),
    ],
)  # fmt: skip
def test_wrong_behaviours_are_told_with_their_line(tmp_path, old, new, file, sentence):
    with pytest.raises(TrialError) as caught:
        check_trial(load_trial(changed(tmp_path, old, new, file)))
    assert sentence in str(caught.value)


def test_large_files_are_refused(tmp_path):
    path = changed(tmp_path, "</root>", "<!--" + 1_000_000 * "x" + "--></root>", "walk.xml")
    with pytest.raises(TrialError, match=r"walk\.xml is larger than 1000000 bytes"):
        check_trial(load_trial(path))


def test_wrong_behaviours_in_python(tmp_path):
    zone = [(0, 0), (1, 0), (1, 1)]
    both = {"reactions": [ReactionSpec(type="look", share=0.6)], "behaviors": [BehaviorSpec(file="a.xml", share=0.5)]}
    with pytest.raises(InputError, match="shares of the reactions and behaviours are 1.1 together"):
        Spawner(count=1, zone=zone, goal=zone, **both)
    with pytest.raises(InputError, match=r"there is no file 'a\.xml'"):
        BehaviorSpec(file="a.xml", folder=tmp_path).behavior()


def test_the_page_lists_all_conditions_and_actions_with_their_ports():
    page = (Path(__file__).parents[2] / "docs" / "how-to" / "behavior-trees.md").read_text(encoding="utf-8")
    for name, kind in LEAVES.items():
        (row,) = [line for line in page.splitlines() if line.startswith(f"| `{name}`")]
        if name != "SetBlackboard":
            assert row.endswith(f"| {kind.about} |")
            for port in (*kind.ports, *kind.parameters):
                assert f"`{port}`" in row.removesuffix(f"{kind.about} |"), row
    assert all(f"`{name}`" in page for name in KINDS)


def test_without_behaviours_nothing_is_kept():
    text = "".join(line for line in HALL.splitlines() if "<behavior" not in line)
    assert simulate(parse_trial(text), 1).reactions is not None
    assert robot_reactions(parse_trial(text).sources, [0], [], 2) is None
