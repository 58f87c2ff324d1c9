"""Edits of XML text by elements: everything else stays, undo gives the same bytes, hostile text is refused."""

import random

import pytest

from crowdbot.core import InputError, parse_xml
from crowdbot.trials import builtin_trials, load_trial, trial_xml
from crowdbot.web.editor import EditHistory, XmlDocument
from samples import sample

TEXT = """<?xml version="1.0"?>
<!-- a "wall" > than <this/> -->
<trial name='t' duration="9">
  <stage>  <!-- two walls -->
    <wall points="0,0 4,0"
          />
    <wall points = '0,3 4,3'/>   <!-- upper -->
  </stage>

  <crowd type="orca" name="a &lt; b &amp; &quot;c&quot;"></crowd><!-- end --></trial>
"""


def plain(element):
    return (element.tag, element.attributes, [plain(child) for child in element.children])


def test_the_elements_are_those_of_the_parser():
    document = XmlDocument(TEXT)
    assert plain(document.root) == plain(parse_xml(TEXT.encode(), "t"))
    assert [item.line for item in document.root.each()] == [3, 4, 5, 7, 10]


@pytest.mark.parametrize("name", sample(builtin_trials(), 5))
def test_builtin_trials_are_read(name):
    text = trial_xml(load_trial(name))
    document = XmlDocument(text)
    assert plain(document.root) == plain(parse_xml(text.encode(), "t"))


@pytest.mark.parametrize(
    ("edit", "old", "new"),
    [
        (lambda one: one.set((), "duration", "12"), 'duration="9"', 'duration="12"'),
        (lambda one: one.set((), "name", "it's"), "name='t'", "name='it&apos;s'"),
        (lambda one: one.set((), "seed", "3"), 'duration="9">', 'duration="9" seed="3">'),
        (lambda one: one.set((), "duration", None), ' duration="9"', ""),
        (lambda one: one.set((0, 0), "name", "w"), '0,0 4,0"\n          />', '0,0 4,0" name="w"\n          />'),
        (lambda one: one.set((0, 1), "points", "1,1"), "points = '0,3 4,3'", "points = '1,1'"),
        (lambda one: one.set((1,), "name", 'x"y'), "a &lt; b &amp; &quot;c&quot;", "x&quot;y"),
        (lambda one: one.remove((0, 1)), "    <wall points = '0,3 4,3'/>   <!-- upper -->", "       <!-- upper -->"),
        (lambda one: one.remove((0, 0)), '\n    <wall points="0,0 4,0"\n          />', ""),
        (
            lambda one: one.insert((0,), '<wall points="5,5 6,6"/>', 1),
            "          />\n",
            '          />\n    <wall points="5,5 6,6"/>\n',
        ),
        (
            lambda one: one.insert((0, 1), "<a>\n  <b/>\n</a>"),
            "<wall points = '0,3 4,3'/>",
            "<wall points = '0,3 4,3'>\n      <a>\n        <b/>\n      </a>\n    </wall>",
        ),
        (lambda one: one.replace((0, 1), "<wall/>"), "<wall points = '0,3 4,3'/>", "<wall/>"),
    ],
)
def test_an_edit_changes_nothing_else(edit, old, new):
    assert TEXT.count(old) == 1
    assert edit(XmlDocument(TEXT)).text == TEXT.replace(old, new)


@pytest.mark.parametrize(
    ("edit", "sentence"),
    [
        (lambda one: one.remove(()), "the root element cannot be removed"),
        (lambda one: one.node((0, 7)), r"the element at \[0, 7\] does not exist in <stage>"),
        (lambda one: one.set((), "a b", "1"), "name of an attribute = 'a b'"),
        (lambda one: one.set((), "name", "\x00"), "holds a character that XML cannot hold"),
        (lambda one: one.insert((), "<a><b></a>"), "not well-formed"),
        (lambda one: one.insert((), "<a/><b/>"), "not well-formed"),
        (lambda one: one.insert((), '<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>'), "DOCTYPE or entities"),
    ],
)
def test_wrong_edits_are_refused(edit, sentence):
    with pytest.raises(InputError, match=sentence):
        edit(XmlDocument(TEXT))


@pytest.mark.parametrize("text", ["", "<a>", "<!DOCTYPE a><a/>", "<a b='1' b='2'/>", "no"])
def test_other_text_is_refused(text):
    with pytest.raises(InputError):
        XmlDocument(text)


def test_a_thousand_random_edits_undone_give_the_same_text():
    draw = random.Random(5)
    text = trial_xml(load_trial("crossing-flows"))
    history = EditHistory(text)
    for _ in range(1000):
        document = XmlDocument(history.text)
        nodes = list(walk(document.root))
        path, node = draw.choice(nodes)
        kind = draw.random()
        if kind < 0.3 and path and len(nodes) > 5:
            document = document.remove(path)
        elif kind < 0.6:
            document = document.insert(path, f'<part name="p{draw.randrange(99)}"/>', draw.choice([None, 0, 1]))
        else:
            name = draw.choice([*node.attributes, "extra"])
            document = document.set(path, name, draw.choice([None, "1", '<&>"', "é\n"]))
        assert plain(document.root) == plain(parse_xml(document.text.encode(), "t"))
        history.add(document.text)
    last = history.text
    while history.can_undo:
        history.undo()
    assert history.text == text
    while history.can_redo:
        history.redo()
    assert history.text == last


def walk(node, path=()):
    yield path, node
    for i, child in enumerate(node.children):
        yield from walk(child, (*path, i))


def test_an_edit_after_undo_drops_what_was_undone():
    history = EditHistory("a")
    history.add("b")
    history.undo()
    history.add("c")
    assert (history.can_redo, history.undo()) == (False, "a")
