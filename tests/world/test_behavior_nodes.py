"""Nodes of behaviour trees: tables of ticks after the documentation of BehaviorTree.CPP, and files that are refused."""

from __future__ import annotations

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.world import parse_behavior_tree

STATUS = {"i": 0, "r": 1, "s": 2, "f": 3}
LETTER = {code: letter for letter, code in STATUS.items()}


def tree_of(body, head="", trees=""):
    text = f'<root main_tree_to_execute="main" {head}><BehaviorTree ID="main">{body}</BehaviorTree>{trees}</root>'
    return parse_behavior_tree(text.encode(), "t.xml")


def leaves(body):
    """Replace the letters a to e in a tree by leaves whose port tells which one it is."""
    for number, letter in enumerate("abcde"):
        body = body.replace(f"<{letter}/>", f'<Wait seconds="{number}"/>')
    return body


class Script:
    """Leaves that return the letters of a script one after the other, and tell in which order they are ticked."""

    def __init__(self, **scripts):
        self.scripts, self.calls = {letter: list(text) for letter, text in scripts.items()}, []

    def __call__(self, node, who, inputs, kept):
        letter = "abcde"[int(inputs["seconds"][0])]
        self.calls.append(letter)
        return np.full(len(who), STATUS[self.scripts[letter].pop(0)], dtype=np.int8)


def ticks(body, count, version=4, **scripts):
    """Return the statuses of the root, and the leaves that were ticked, of each tick."""
    tree, script = tree_of(leaves(body), f'BTCPP_format="{version}"'), Script(**scripts)
    state, rows = tree.begin(1), []
    for _ in range(count):
        script.calls = []
        status = tree.tick(state, np.array([True]), script)[0]
        rows.append(LETTER[int(status)] + ":" + "".join(script.calls))
    assert not any(script.scripts.values()), "a leaf was ticked less often than the script says"
    return " ".join(rows)


SEQUENCE, FALLBACK = "<Sequence><a/><b/><c/></Sequence>", "<Fallback><a/><b/><c/></Fallback>"


BOTH = [
    # a sequence goes on with the child that runs, and begins anew after a failure
    (SEQUENCE, {"a": "s", "b": "rs", "c": "s"}, "r:ab s:bc"),
    (SEQUENCE, {"a": "ss", "b": "fs", "c": "s"}, "f:ab s:abc"),
    (SEQUENCE, {"a": "ss", "b": "rfr"}, "r:ab f:b r:ab"),
    ("<Sequence><a/><Sequence><b/><c/></Sequence></Sequence>", {"a": "s", "b": "s", "c": "rrs"}, "r:abc r:c s:c"),
    # a reactive sequence ticks the children before the one that runs again, and halts it if one of them fails
    ("<ReactiveSequence><a/><b/></ReactiveSequence>", {"a": "ssfs", "b": "rrr"}, "r:ab r:ab f:a r:ab"),
    ("<ReactiveSequence><a/><Sequence><b/><c/></Sequence></ReactiveSequence>",
     {"a": "sfs", "b": "ss", "c": "rr"}, "r:abc f:a r:abc"),
    # a fallback goes on with the child that runs, until one succeeds
    (FALLBACK, {"a": "f", "b": "rf", "c": "s"}, "r:ab s:bc"),
    (FALLBACK, {"a": "ff", "b": "fs", "c": "f"}, "f:abc s:ab"),
    ("<ReactiveFallback><a/><b/></ReactiveFallback>", {"a": "ffsf", "b": "rrr"}, "r:ab r:ab s:a r:ab"),
    ("<ReactiveFallback><a/><b/></ReactiveFallback>", {"a": "ff", "b": "fr"}, "f:ab r:ab"),
    # all children of a parallel are ticked until they finish; by default all must succeed and one failure is enough
    ("<Parallel><a/><b/><c/></Parallel>", {"a": "s", "b": "rs", "c": "rrs"}, "r:abc r:bc s:c"),
    ("<Parallel><a/><b/><c/></Parallel>", {"a": "ss", "b": "rfs", "c": "rs"}, "r:abc f:b s:abc"),
    ('<Parallel success_count="2"><a/><b/><c/></Parallel>', {"a": "s", "b": "rs", "c": "r"}, "r:abc s:b"),
    ('<Parallel success_threshold="1" failure_threshold="2"><a/><b/><c/></Parallel>',
     {"a": "f", "b": "r", "c": "s"}, "s:abc"),
    ('<Parallel success_count="1" failure_count="2"><a/><b/><c/></Parallel>',
     {"a": "f", "b": "rf", "c": "r"}, "r:abc f:b"),
    ('<Parallel success_count="3" failure_count="3"><a/><b/><c/></Parallel>', {"a": "f"}, "f:a"),
    # decorators
    ("<Inverter><a/></Inverter>", {"a": "srf"}, "f:a r:a s:a"),
    ("<ForceSuccess><a/></ForceSuccess>", {"a": "srf"}, "s:a r:a s:a"),
    ("<ForceFailure><a/></ForceFailure>", {"a": "srf"}, "f:a r:a f:a"),
    ("<KeepRunningUntilFailure><a/></KeepRunningUntilFailure>", {"a": "srf"}, "r:a r:a f:a"),
    # a cycle that ran before is followed by the next one
    ('<Repeat num_cycles="2"><a/></Repeat>', {"a": "rsr"}, "r:a r:aa"),
    ('<Repeat num_cycles="0"><a/></Repeat>', {}, "s:"),
    ('<RetryUntilSuccesful num_attempts="2"><a/></RetryUntilSuccesful>', {"a": "rffs"}, "r:a f:aa s:a"),
]  # fmt: skip
MEMORY = "<SequenceWithMemory><a/><b/><c/></SequenceWithMemory>"
HALTED = "<ReactiveSequence><a/><SequenceWithMemory><b/><c/></SequenceWithMemory></ReactiveSequence>"
TWO_OF_THREE = '<Parallel success_count="2"><a/><b/><c/></Parallel>'
RETRY = '<RetryUntilSuccessful num_attempts="3"><a/></RetryUntilSuccessful>'
ONE = [
    # with memory, a sequence begins with the child that failed; in version 4 it ticks one new child in a tick
    (3, MEMORY, {"a": "s", "b": "fs", "c": "s"}, "f:ab s:bc"),
    (3, "<SequenceStar><a/><b/><c/></SequenceStar>", {"a": "ss", "b": "ffss", "c": "ss"}, "f:ab f:b s:bc s:abc"),
    (4, MEMORY, {"a": "s", "b": "fs", "c": "s"}, "r:a f:b r:b s:c"),
    # if it is halted, it begins anew in version 3, and goes on where it was in version 4
    (3, HALTED, {"a": "sfs", "b": "ss", "c": "rs"}, "r:abc f:a s:abc"),
    (4, HALTED, {"a": "sfs", "b": "s", "c": "s"}, "r:ab f:a s:ac"),
    # a cycle that begins and ends within one tick ends it in version 4
    (3, '<Repeat num_cycles="3"><a/></Repeat>', {"a": "sssr"}, "s:aaa r:a"),
    (4, '<Repeat num_cycles="3"><a/></Repeat>', {"a": "ssss"}, "r:a r:a s:a r:a"),
    (3, '<Repeat num_cycles="2"><a/></Repeat>', {"a": "sfss"}, "f:aa s:aa"),
    (4, '<Repeat num_cycles="2"><a/></Repeat>', {"a": "sfss"}, "r:a f:a r:a s:a"),
    (3, '<Repeat num_cycles="-1"><a/></Repeat>', {"a": "sssf"}, "f:aaaa"),
    (4, '<Repeat num_cycles="-1"><a/></Repeat>', {"a": "sssf"}, "r:a r:a r:a f:a"),
    (3, RETRY, {"a": "fffs"}, "f:aaa s:a"),
    (4, RETRY, {"a": "fffs"}, "r:a r:a f:a s:a"),
    # a node that is halted begins anew
    (4, '<ReactiveSequence><a/><Repeat num_cycles="2"><b/></Repeat></ReactiveSequence>',
     {"a": "sfss", "b": "sss"}, "r:ab f:a r:ab s:ab"),
    # children that have finished count when the loop reaches them in version 3, at once in version 4
    (3, TWO_OF_THREE, {"a": "rs", "b": "rr", "c": "s"}, "r:abc s:ab"),
    (4, TWO_OF_THREE, {"a": "rs", "b": "r", "c": "s"}, "r:abc s:a"),
]  # fmt: skip


@pytest.mark.parametrize(("version", "body", "scripts", "expected"), [(k, *row) for k in (3, 4) for row in BOTH] + ONE)
def test_ticks_of_nodes(version, body, scripts, expected):
    assert ticks(body, len(expected.split()), version, **scripts) == expected


def test_nodes_may_be_named_in_the_explicit_form():
    body = (
        '<Control ID="Sequence" name="x"><Decorator ID="Inverter"><Condition ID="AlwaysFailure"/></Decorator>'
        '<Action ID="StandStill"/></Control>'
    )
    assert [node.kind for node in tree_of(body).nodes] == ["Sequence", "Inverter", "AlwaysFailure", "StandStill"]


def test_a_node_that_repeats_without_end_is_told():
    tree = tree_of('<Repeat num_cycles="-1"><AlwaysSuccess/></Repeat>')
    with pytest.raises(InputError, match=r"t\.xml:1: <Repeat> ticks its node more than 1000 times within one tick"):
        tree.tick(tree.begin(1), np.array([True]), lambda *_: np.array([2], np.int8))


def test_people_of_one_call_are_ticked_as_alone():
    """Random trees and scripts for 40 people at once, against each person alone."""
    rng = np.random.default_rng(4)
    kinds = ["Sequence", "SequenceWithMemory", "ReactiveSequence", "Fallback", "ReactiveFallback", "Parallel"]
    single = ["Inverter", "ForceSuccess", "ForceFailure", "KeepRunningUntilFailure", 'Repeat num_cycles="2"']

    def draw(depth):
        if depth == 0 or rng.random() < 0.2:
            return f'<Wait seconds="{rng.integers(5)}"/>'
        if rng.random() < 0.35:
            tag = single[rng.integers(len(single))]
            return f"<{tag}>{draw(depth - 1)}</{tag.split()[0]}>"
        tag = kinds[rng.integers(len(kinds))]
        return f"<{tag}>{''.join(draw(depth - 1) for _ in range(rng.integers(1, 4)))}</{tag}>"

    for number in range(25):
        tree, people = tree_of(draw(4), f'BTCPP_format="{3 + number % 2}"'), 40
        luck = rng.integers(1, 4, (30, 5, people)).astype(np.int8)
        whole, alone = tree.begin(people), tree.begin(people)
        for tick in range(30):
            who = rng.random(people) < 0.9

            def leaf(node, mine, inputs, kept, now=luck[tick]):
                return now[inputs["seconds"].astype(int), np.arange(len(mine))]

            found = tree.tick(whole, who, leaf)
            for n in np.flatnonzero(who):
                row = np.arange(people) == n
                assert tree.tick(alone, row, leaf)[n] == found[n], number
            np.testing.assert_array_equal(whole, alone)


NOTHING = "<AlwaysSuccess/>"


def test_subtrees_share_the_entries_that_they_name():
    trees = (
        '<BehaviorTree ID="inner"><Sequence><SetBlackboard output_key="{out}" value="{in}"/>'
        '<SetBlackboard output_key="own" value="5"/></Sequence></BehaviorTree>'
    )
    old = '<SubTree ID="inner" in="x" out="y"/>'
    new = '<SubTree ID="inner" in="{x}" out="{y}"/>'
    plus = '<SubTreePlus ID="inner" in="{x}" out="{y}"/>'
    for head, call in (("", old), ('BTCPP_format="4"', new), ("", plus)):
        body = f'<Sequence><SetBlackboard output_key="x" value="7"/>{call}<IsRobotNear distance="{{y}}"/></Sequence>'
        tree = tree_of(body, head, trees)
        seen = []

        def leaf(node, who, inputs, kept, seen=seen):
            seen.append(float(inputs["distance"][0]))
            return np.array([2], np.int8)

        assert tree.tick(tree.begin(1), np.array([True]), leaf).tolist() == [2]
        assert seen == [7.0]


def test_a_constant_port_of_a_subtree_and_a_shared_blackboard():
    trees = '<BehaviorTree ID="inner"><IsRobotNear distance="{far}"/></BehaviorTree>'
    for head, body in (
        ('BTCPP_format="4"', '<SubTree ID="inner" far="3.5"/>'),
        ('BTCPP_format="4"', '<Sequence><SetBlackboard output_key="far" value="3.5"/>'
         '<SubTree ID="inner" _autoremap="true"/></Sequence>'),
        ("", '<Sequence><SetBlackboard output_key="far" value="3.5"/>'
         '<SubTree ID="inner" __shared_blackboard="true"/></Sequence>'),
    ):  # fmt: skip
        tree, seen = tree_of(body, head, trees), []

        def leaf(node, who, inputs, kept, seen=seen):
            seen.append(float(inputs["distance"][0]))
            return np.array([2], np.int8)

        tree.tick(tree.begin(1), np.array([True]), leaf)
        assert seen == [3.5]


def test_an_entry_is_not_read_before_it_is_written():
    body = '<Fallback><IsRobotNear distance="{far}"/><SetBlackboard output_key="far" value="1"/></Fallback>'
    tree = tree_of(body)
    with pytest.raises(InputError, match=r"t\.xml:1: <IsRobotNear> distance reads the entry {far} before"):
        tree.tick(tree.begin(1), np.array([True]), lambda *_: np.array([2], np.int8))


def test_includes_are_read_once_from_the_folder_of_the_file():
    files = {
        "trees/a.xml": '<root main_tree_to_execute="A"><include path="sub/b.xml"/><include path="c.xml"/>'
        '<BehaviorTree ID="A"><Sequence><SubTree ID="B"/><SubTree ID="C"/></Sequence></BehaviorTree></root>',
        "trees/sub/b.xml": '<root><include path="../c.xml"/><BehaviorTree ID="B"><StandStill/></BehaviorTree></root>',
        "trees/c.xml": '<root><BehaviorTree ID="C"><RegularNav/></BehaviorTree></root>',
    }
    asked = []

    def load(name):
        asked.append(name)
        return files[name].encode()

    tree = parse_behavior_tree(files["trees/a.xml"].encode(), "trees/a.xml", load)
    assert [node.kind for node in tree.nodes] == ["Sequence", "SubTree", "StandStill", "SubTree", "RegularNav"]
    assert asked == ["trees/sub/b.xml", "trees/c.xml"]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("<tree/>", "t.xml:1: the root element must be <root>, not <tree>"),
        ("<root><BehaviorTree ID='a'>", "t.xml:1: this is not well-formed XML: no element found"),
        ("<!DOCTYPE root [<!ENTITY a 'b'>]><root/>", "t.xml:1: a behaviour tree must not have a DOCTYPE or entities"),
        ("<root/>", "t.xml: main_tree_to_execute must name one of the trees; the file has none"),
        ("<root BTCPP_format='5'/>", 't.xml:1: BTCPP_format="5" must be 3 or 4'),
        ("<root main_tree_to_execute='Mian'>MAIN</root>",
         "t.xml: there is no tree 'Mian', did you mean 'Main'?; known are Main"),
        ("<root>MAIN<BehaviorTree ID='B'><StandStill/></BehaviorTree></root>",
         "t.xml: main_tree_to_execute must name one of the trees; the file has Main, B"),
        ("<root>MAINMAIN</root>", "t.xml:1: <BehaviorTree> ID='Main' exists already, in t.xml"),
        ("<root><BehaviorTree ID='a'/></root>", "t.xml:1: <BehaviorTree> has 0 nodes, it must have one"),
        ("<root><BehaviorTree><StandStill/></BehaviorTree></root>", "t.xml:1: <BehaviorTree> needs the attribute ID"),
        ("<root>\n<Nodes/></root>", "t.xml:2: <Nodes> is not allowed here; <root> has BehaviorTree, include and"),
        ("<root><include path='b.xml'/></root>", "t.xml:1: <include> cannot be read from a text alone"),
        ("<root><include ros_pkg='x' path='b.xml'/></root>", "t.xml:1: <include> needs a path beside this file"),
    ],
)  # fmt: skip
def test_wrong_files_are_refused_with_their_line(text, sentence):
    text = text.replace("MAIN", "<BehaviorTree ID='Main'><StandStill/></BehaviorTree>")
    with pytest.raises(InputError) as caught:
        parse_behavior_tree(text.encode(), "t.xml")
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        ("<Sequense><StandStill/></Sequense>", "<Sequense> is no known node, did you mean 'Sequence'?; known are"),
        ("<Action ID='SaySomething'/>", "<SaySomething> is no known node; known are Sequence,"),
        ("<Sequence/>", "<Sequence> has no nodes, it must have at least one"),
        ("<Inverter><StandStill/><StandStill/></Inverter>", "<Inverter> has 2 nodes, it must have one"),
        ("<StandStill><StandStill/></StandStill>", "<StandStill> is a condition or an action, which has no nodes"),
        ("<Repeat><StandStill/></Repeat>", "<Repeat> needs the port 'num_cycles'"),
        ("<Repeat num_cycles='1.5'><StandStill/></Repeat>", 'num_cycles="1.5" must be a whole number from -1 to 1e+06'),
        ("<Parallel success_count='2'><StandStill/></Parallel>", "success_count = 2 is more than its 1 nodes"),
        ("<IsRobotVisible/>", "<IsRobotVisible> needs the port 'distance'"),
        ("<IsRobotVisible distanc='3'/>", "has no port 'distanc', did you mean 'distance'?; it takes distance, field_"),
        ("<IsRobotVisible distance='-3'/>", 'distance="-3" must be from 0 to 1000'),
        ("<IsRobotVisible distance='far'/>", 'distance="far" is not a number; entries are numbers, true or false'),
        ("<IsRobotVisible distance='{far}'/>", "port distance reads {far}, which nothing writes; entries are"),
        ("<RegularNav agent_id='7'/>", "agent_id must be the person of the tree, {id}: nobody moves another one"),
        ("<RegularNav agent_id='{dt}'/>", "agent_id must be the person of the tree, {id}"),
        ("<RegularNav time_step='0.1'/>", "time_step must be the time step of the world, {dt}"),
        ("<CuriousNav speed='3'/>", "<CuriousNav> speed = 3 must be from 0 to 1.3"),
        ("<CuriousNav gap='{id}'/>", 'gap="{id}" is not a number'),
        ("<SetBlackboard output_key='x'/>", "<SetBlackboard> takes value and output_key, both"),
        ("<SetBlackboard output_key='id' value='1'/>", "<SetBlackboard> cannot write id and dt of the person"),
        ("<SetBlackboard output_key='{}' value='1'/>", "'' is no name of an entry or port"),
        ("<StandStill _skipIf='x'/>", "<StandStill> has no port '_skipIf'; it takes none"),
        ("<SubTree ID='main'/>", "<SubTree> ID='main' contains itself: main > main"),
        ("<SubTree ID='other'/>", "<SubTree> ID='other' is none of main"),
        ("<SubTree ID='main'><StandStill/></SubTree>", "<SubTree> must be empty: the nodes stand in its BehaviorTree"),
    ],
)  # fmt: skip
def test_wrong_nodes_are_refused_with_their_line(body, sentence):
    with pytest.raises(InputError) as caught:
        tree_of(f"\n\n{body}")
    assert f"t.xml:3: {sentence}" in str(caught.value) or (
        str(caught.value).startswith("t.xml:3: <") and sentence in str(caught.value)
    )


def test_trees_that_grow_without_bound_are_refused():
    body, trees = '<SubTree ID="t1"/>', '<BehaviorTree ID="t40"><StandStill/></BehaviorTree>'
    for k in range(1, 40):
        twice = 2 * f'<SubTree ID="t{k + 1}"/>'
        trees += f'<BehaviorTree ID="t{k}"><Sequence>{twice}</Sequence></BehaviorTree>'
    with pytest.raises(InputError, match="a tree has at most 1000 nodes on 100 levels"):
        tree_of(body, trees=trees)
    many = {f"{k}.xml": f'<root><include path="{k + 1}.xml"/></root>' for k in range(30)}
    with pytest.raises(InputError, match="more than 20 files are included"):
        parse_behavior_tree(many["0.xml"].encode(), "0.xml", lambda name: many[name].encode())


def test_mutated_files_are_read_or_refused_with_one_sentence():
    text = (
        '<root main_tree_to_execute="main"><TreeNodesModel/><BehaviorTree ID="main"><Fallback name="x"><Parallel '
        'success_count="1" failure_count="2"><Wait seconds="2"/><IsRobotVisible agent_id="{id}" distance="3"/>'
        "</Parallel>"
        '<Repeat num_cycles="2"><SetBlackboard output_key="far" value="{dt}"/></Repeat><SubTree ID="sub" d="far"/>'
        '</Fallback></BehaviorTree><BehaviorTree ID="sub"><IsPersonNear distance="{d}"/></BehaviorTree></root>'
    )
    rng = np.random.default_rng(8)
    words = text.replace(">", "> ").replace("=", " = ").split()
    read, sentences = 0, set()
    for _ in range(600):
        data = bytearray(text.encode())
        for _ in range(rng.integers(1, 3)):
            at, kind = int(rng.integers(len(data))), rng.integers(3)
            if kind == 0:
                data[at] = int(rng.integers(32, 127))
            elif kind == 1:
                del data[at : at + int(rng.integers(1, 30))]
            else:
                data[at:at] = words[rng.integers(len(words))].encode()
        try:
            parse_behavior_tree(bytes(data), "t.xml")
            read += 1
        except InputError as error:
            sentences.add(str(error))
    assert read > 3
    assert len(sentences) > 60
    assert not any("\n" in sentence or len(sentence) > 900 for sentence in sentences)
