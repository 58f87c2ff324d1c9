"""Experiments as files: read back as they were, every problem at once, screens that do nothing, balanced orders."""

from __future__ import annotations

import itertools
import random
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, TrialError
from crowdbot.experiments import (
    Block,
    Choice,
    ChoiceOption,
    Experiment,
    FreeText,
    Number,
    Scale,
    Screen,
    TrialEntry,
    builtin_experiments,
    check_experiment,
    experiment_xml,
    is_experiment,
    load_experiment,
    orders,
    page_of,
    parse_experiment,
    plan,
    rows_of,
    sanitise_html,
    seed_of,
    williams,
)

SHIPPED = builtin_experiments()["robot-speed"]

NAMES = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,8}", fullmatch=True)
TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=["Cs", "Cc"], exclude_characters="\ufffe\uffff"))
TEXTS = TEXTS | st.just("two\nlines\tand <&> \"quotes'")
NUMBERS = st.none() | st.floats(-1e5, 1e5)
SAID = {"name": NAMES, "text": TEXTS, "required": st.booleans()}
OPTIONS = st.lists(st.builds(ChoiceOption, value=NAMES, text=TEXTS), min_size=1, max_size=3)
QUESTIONS = st.one_of(
    st.builds(Choice, **SAID, multiple=st.booleans(), options=OPTIONS),
    st.builds(Scale, **SAID, low=st.integers(-9, 0), high=st.integers(1, 9), low_text=TEXTS, high_text=TEXTS),
    st.builds(Number, **SAID, unit=TEXTS, min=NUMBERS, max=NUMBERS, integer=st.booleans()),
    st.builds(FreeText, **SAID, max_length=st.integers(1, 10_000)),
)
SCREENS = st.lists(
    st.builds(Screen, name=NAMES, text=TEXTS, file=TEXTS, questions=st.lists(QUESTIONS, max_size=2)), max_size=2
)
ENTRIES = st.builds(
    TrialEntry, name=NAMES, source=TEXTS, seed=st.none() | st.integers(-99, 2**53), before=SCREENS, after=SCREENS
)
BLOCKS = st.builds(
    Block, name=NAMES, order=st.sampled_from(["fixed", "random", "latin-square"]), repetitions=st.integers(1, 9),
    seeds=st.sampled_from(["same", "by-repetition", "by-participant"]), instructions=SCREENS, before=SCREENS,
    trials=st.lists(ENTRIES, min_size=1, max_size=2), after=SCREENS, transitions=SCREENS,
)  # fmt: skip
EXPERIMENTS = st.builds(
    Experiment, name=NAMES, about=TEXTS, seed=st.integers(-5, 5), participants=st.none() | st.integers(1, 99),
    instructions=SCREENS, blocks=st.lists(BLOCKS, min_size=1, max_size=2), endings=SCREENS,
)  # fmt: skip


@settings(max_examples=60)
@given(EXPERIMENTS)
def test_xml_to_experiment_to_xml_is_the_identity(experiment: Experiment) -> None:
    text = experiment_xml(experiment)
    again = parse_experiment(text, whole=False)
    assert again == experiment
    assert experiment_xml(again) == text


@pytest.mark.parametrize("name", builtin_experiments())
def test_what_is_shipped_is_right_and_reads_back(name: str) -> None:
    experiment = load_experiment(name)
    assert parse_experiment(experiment_xml(experiment), folder=experiment.folder) == experiment
    assert is_experiment(name)
    assert is_experiment(SHIPPED)
    assert not is_experiment("crossing-flows")
    assert not is_experiment(SHIPPED / "slow.xml")
    assert not is_experiment("nothing-like-it")


WRONG = """<experiment name="e" sed="3">
  <instructions name="hello" file="helo.txt">
    <scale name="a b" text="Well?" low="7" high="7"/>
    <number name="age" text="Age?" min="40" max="20"/>
    <number name="age" text=" "/>
    <choise name="hand" text="Hand?"/>
  </instructions>
  <block name="main" order="latin" repetitions="0">
    <trial name="x" source="frontl"/>
    <trial name="x" source="broken.xml" sead="4"/>
    <trial name="y" source="broken.xml"/>
    <trial name="z" source="../outside.xml"/>
  </block>
  <block name="second">
    <before name="hello" text="Again" file="hello.txt"/>
    <trial name="x" source="frontal"/>
    <trial name="x" source="frontal"/>
    <after name="nothing"/>
  </block>
</experiment>
"""


MENDED = {
    'sed="3"': 'seed="3"',
    '"a b"': '"a"',
    "choise name": "number name",
    '"latin" repetitions="0"': '"random"',
    'sead="4"': 'seed="4"',
}
"""Values of the wrong experiment that are mended before the rest of it is checked."""


def _wrong(tmp_path: Path, text: str) -> list[str]:
    folder = tmp_path / "inside"
    folder.mkdir()
    (tmp_path / "outside.xml").write_text((SHIPPED / "slow.xml").read_text())
    (folder / "broken.xml").write_text('<trial name="t" duration="-1">\n<crowd type="orka"/></trial>')
    (folder / "hello.txt").write_text("hello")
    with pytest.raises(TrialError) as found:
        parse_experiment(text, place="e.xml", folder=folder)
    return list(found.value.problems)


def test_every_wrong_value_is_said_at_once_with_its_line(tmp_path: Path) -> None:
    problems = _wrong(tmp_path, WRONG)
    for said in (
        "e.xml:1: <experiment> has no attribute 'sed', did you mean 'seed'?; it takes name, about, seed, participants",
        'e.xml:3: <scale> name="a b" must match',
        "e.xml:6: <choise> is not an element of <instructions>, did you mean 'choice'?",
        'e.xml:8: <block> order="latin" must be fixed or random or latin-square',
        'e.xml:8: <block> repetitions="0" must be at least 1',
        "e.xml:10: <trial> has no attribute 'sead', did you mean 'seed'?",
    ):
        assert any(said in problem for problem in problems), problems


def test_what_does_not_fit_together_is_said_at_once_with_its_line(tmp_path: Path) -> None:
    text = WRONG
    for old, new in MENDED.items():
        text = text.replace(old, new)
    problems = _wrong(tmp_path, text)
    for said in (
        "e.xml:4: <number> has min above max",
        "e.xml:5: <number> has an empty text; give the text of the question",
        "e.xml:9: <trial> source='frontl': there is no trial 'frontl', did you mean 'frontal'?",
        "e.xml:11: <trial> source='broken.xml': broken.xml:1: <trial> duration=\"-1\" must be above 0 s",
        "e.xml:11: <trial> source='broken.xml': broken.xml:2: <crowd> unknown crowd model 'orka', did you mean 'orca'?",
        "e.xml:12: <trial> source='../outside.xml': the trial '../outside.xml'",
        "e.xml:15: <before> has both a text and a file; give one of them",
        "e.xml:17: <trial> name 'x' is already used by another trial of this block; names must differ",
        "e.xml:18: <after> is empty; it needs a text, a file or a question",
    ):
        assert any(said in problem for problem in problems), problems


def test_what_is_wrong_with_the_whole_is_said_too(tmp_path: Path) -> None:
    (tmp_path / "e.xml").write_text("""<experiment name="e">
  <instructions name="hello" file="helo.txt"/>
  <block name="main" repetitions="900"><trial name="x" source="frontal"/></block>
  <block name="main" repetitions="1000">
    <trial name="x" source="frontal"><after name="hello" text="?"/><after name="b" text="b"/>
      <after name="b" text="c"/></trial>
  </block>
  <ending name="hello" text="bye"/>
</experiment>""")
    with pytest.raises(TrialError) as found:
        load_experiment(tmp_path / "e.xml")
    words = "\n".join(found.value.problems)
    assert "e.xml:2: <instructions> file='helo.txt' does not exist" in words
    assert "e.xml:4: <block> name 'main' is already used by another block" in words
    assert "e.xml:5: <after> name 'hello' is already used by a screen outside this trial" in words
    assert "e.xml:6: <after> name 'b' is already used by another screen of this trial" in words
    assert "e.xml:8: <ending> name 'hello' is already used by another screen" in words
    assert len(found.value.problems) == 5
    many = [TrialEntry(name=f"t{k}", source="frontal") for k in range(11)]
    with pytest.raises(TrialError, match="has 11000 trials per participant, the maximum is 10000"):
        check_experiment(Experiment(name="e", blocks=[Block(name="b", repetitions=1000, trials=many)]))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Screen(name="1st"), "Screen: name="),
        (lambda: Block(name="b", trials=[]), "trials is empty"),
        (lambda: Choice(name="c", text="?", options=["left"]), "options holds a str, it takes ChoiceOption"),
        (lambda: Experiment(name="e", blocks=[Screen(name="s")]), "blocks holds a Screen"),
        (lambda: Scale(name="s", text="\x1b[2J"), "a character that XML cannot hold"),
    ],
)
def test_values_in_python_are_checked(make: object, said: str) -> None:
    with pytest.raises(InputError) as found:
        make()  # type: ignore[operator]
    assert said in str(found.value)


@pytest.mark.parametrize(
    "text", ["", "  ", "<experiment", "<trial/>", "\ud800", "<experiment name='e'/>", b"\xff\xfe<"]
)
def test_what_is_no_experiment_is_refused(text: str | bytes) -> None:
    with pytest.raises(TrialError):
        parse_experiment(text, place="e.xml")


def test_missing_and_empty_files_say_so(tmp_path: Path) -> None:
    (tmp_path / "empty.xml").write_text(" ")
    with pytest.raises(TrialError, match="is empty; an experiment is an XML file"):
        load_experiment(tmp_path / "empty.xml")
    with pytest.raises(TrialError, match="did you mean 'robot-speed'"):
        load_experiment("robot-sped")
    bomb = '<!DOCTYPE e [<!ENTITY a "aaaa">]><experiment name="&a;"/>'
    (tmp_path / "bomb.xml").write_text(bomb)
    assert not is_experiment(tmp_path / "bomb.xml")
    with pytest.raises(TrialError, match="DOCTYPE"):
        load_experiment(tmp_path / "bomb.xml")


def test_mutated_files_never_break_the_reader(tmp_path: Path) -> None:
    draw = random.Random(3)
    text = (SHIPPED / "experiment.xml").read_text()
    words = ["<", ">", '"', "=", "&", "/", "-1", "1e999", "../", "file", "é", "\x00", "]]>", "<block", "</block>", " "]
    ends = Counter()
    for _ in range(300):
        mutated = text
        for _ in range(draw.randint(1, 4)):
            at, cut = draw.randrange(len(mutated)), draw.choice([0, 1, 5, 40])
            mutated = mutated[:at] + draw.choice([*words, mutated[at : at + 60]]) + mutated[at + cut :]
        try:
            parse_experiment(mutated, folder=SHIPPED)
            ends["right"] += 1
        except TrialError as error:
            ends["wrong" if error.problems else "wordless"] += 1
    assert ends["wrong"] > 150
    assert ends["wordless"] == 0


def test_a_mean_page_does_nothing() -> None:
    text, html = sanitise_html(
        """<html><head><title>t</title><style>p{}</style></head><body onload="x()">
        <h1 style="x">A&lt;b&gt;</h1><script>alert(1)</script><p>one <a href="javascript:x()">link</a><br>two
        <iframe src="http://x/">in</iframe><svg><script>y()</script></svg><img src="a.png" onerror="z()" alt="pic">
        <img src="http://x/a.png"><img src="../a.png"><ul><li>p</li><li>q</ul><form><input value=1></form>
        \x1b[2J<b>bold<unknown>inside</unknown>&#27;]0;x&#7;</p><template><p>no</p></template></body>"""
    )
    low = html.lower()
    for bad in (
        "script",
        "style",
        "href",
        "onload",
        "onerror",
        "iframe",
        "http",
        "..",
        "<a",
        "input",
        "\x1b",
        "title",
        "\x07",
    ):
        assert bad not in low, bad
    assert '<img src="a.png" alt="pic">' in html
    assert "<h1>A&lt;b&gt;</h1>" in html
    assert "[picture: pic]" in text
    assert "- p\n- q" in text
    assert "\x1b" not in text
    for word in ("alert", "no", "x()"):
        assert word not in text.split()


@settings(max_examples=100)
@given(
    st.lists(
        st.sampled_from(
            [
                "<p>",
                "</p>",
                "<b>",
                "<script>",
                "</script>",
                "<img src=a.png>",
                "<",
                "&lt;",
                "x",
                "<svg/>",
                "\x1b[1m",
                "<!--",
                "-->",
                "<p/>",
            ]
        ),
        max_size=20,
    )
)
def test_pages_are_closed_and_stay_so(parts: list[str]) -> None:
    text, html = sanitise_html("".join(parts))
    assert sanitise_html(html)[1] == html
    assert html.count("<p>") == html.count("</p>")
    assert "\x1b" not in html + text
    assert "<script" not in html


def test_great_pages_are_read() -> None:
    """Work that grew with the square of the length would take hours here."""
    for text in ("<p>" * 60_000, "<pre>" + " " * 199_000 + "x", "</b>" * 40_000, "<script>" * 20_000, "\n \n" * 60_000):
        assert len(sanitise_html(text)[0]) <= len(text)


def test_screens_come_from_the_folder_only(tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    (tmp_path / "out.txt").write_text("secret")
    (folder / "link.txt").symlink_to(tmp_path / "out.txt")
    (folder / "latin.txt").write_bytes(b"caf\xe9")
    (folder / "large.txt").write_bytes(b"x" * 300_000)
    (folder / "ok.txt").write_bytes("\ufeffone\r\ntwo\r\n\r\n<three>".encode())
    page = page_of(Screen(name="s", file="ok.txt"), folder)
    assert page.text == "one\ntwo\n\n<three>"
    assert page.html == "<p>one<br>two</p><p>&lt;three&gt;</p>"
    for name, said in (
        ("../out.txt", "outside"), ("link.txt", "outside"), ("latin.txt", "UTF-8"), ("large.txt", "larger"),
        ("none.txt", "does not exist"), ("in.exe", "must end in"), (str(tmp_path / "out.txt"), "outside"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=said):
            page_of(Screen(name="s", file=name), folder)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 6, 7, 10, 11])
def test_williams_squares_balance_places_and_what_comes_before(count: int) -> None:
    rows = np.array(williams(count))
    assert len(rows) == (count if count % 2 == 0 or count == 1 else 2 * count)
    for column in rows.T:
        assert set(np.bincount(column, minlength=count)) == {len(rows) // count}
    follows = Counter(pair for row in rows.tolist() for pair in itertools.pairwise(row))
    if count > 1:
        assert set(follows.values()) == {len(rows) // count}
        assert len(follows) == count * (count - 1)


def test_a_published_square() -> None:
    # first rows of williams(10) of the R package crossdes, as its documentation prints them, counted from 1
    assert [c + 1 for c in williams(10)[0]] == [1, 2, 10, 3, 9, 4, 8, 5, 7, 6]
    assert [c + 1 for c in williams(10)[1]] == [2, 3, 1, 4, 10, 5, 9, 6, 8, 7]
    with pytest.raises(InputError, match="at least one"):
        williams(0)


def _experiment(order: str, count: int, **fields: object) -> Experiment:
    entries = [TrialEntry(name=f"t{k}", source="frontal") for k in range(count)]
    return Experiment(name="e", seed=4, blocks=[Block(name="b", order=order, trials=entries, **fields)])  # type: ignore[arg-type]


@pytest.mark.parametrize("count", [2, 3, 4])
def test_every_repetition_is_balanced_over_the_participants(count: int) -> None:
    experiment = _experiment("latin-square", count, repetitions=3)
    every = rows_of(experiment.blocks[0])
    seen = [orders(experiment, experiment.blocks[0], who) for who in range(1, every + 1)]
    for repetition in range(3):
        assert sorted(row[repetition] for row in seen) == sorted(williams(count))
    assert orders(experiment, experiment.blocks[0], every + 1) == seen[0]


def test_random_orders_are_drawn_for_each_and_stay() -> None:
    experiment = _experiment("random", 4, repetitions=50)
    one = orders(experiment, experiment.blocks[0], 1)
    assert one == orders(experiment, experiment.blocks[0], 1)
    assert one != orders(experiment, experiment.blocks[0], 2)
    assert len({tuple(row) for row in one}) > 10
    assert all(sorted(row) == [0, 1, 2, 3] for row in one)
    fixed = _experiment("fixed", 4, repetitions=2)
    assert orders(fixed, fixed.blocks[0], 7) == [[0, 1, 2, 3]] * 2
    for who in (0, -1, 100_001):
        with pytest.raises(InputError, match="in the experiment 'e'; participants are 1 to 100000"):
            orders(fixed, fixed.blocks[0], who)


def test_seeds_are_the_same_or_new_as_the_block_says() -> None:
    assert {seed_of(5, "same", who, r) for who in range(9) for r in range(9)} == {5}
    assert seed_of(5, "by-repetition", 1, 0) == 5
    assert seed_of(5, "by-repetition", 1, 2) == seed_of(5, "by-repetition", 8, 2)
    assert len({seed_of(5, "by-repetition", 1, r) for r in range(20)}) == 20
    assert len({seed_of(5, "by-participant", who, r) for who in range(20) for r in range(5)}) == 100


def test_the_plan_puts_screens_around_trials() -> None:
    def said(name: str) -> list[Screen]:
        return [Screen(name=name, text=name)]

    first = TrialEntry(name="x", source="frontal", before=said("before_x"), after=said("after_x"))
    block = Block(
        name="b", trials=[first, TrialEntry(name="y", source="frontal")], repetitions=2, instructions=said("task"),
        before=said("ready"), after=said("ask"), transitions=said("rest"),
    )  # fmt: skip
    experiment = Experiment(name="e", blocks=[block], instructions=said("hello"), endings=said("bye"))
    names = " ".join(step.name for step in plan(experiment, 1))
    once = "ready before_x x after_x ask rest ready y ask"
    assert names == f"hello task {once} rest {once} bye"
    assert [(s.number, s.repetition) for s in plan(experiment, 1) if s.role == "trial"] == [
        (1, 0),
        (2, 0),
        (3, 1),
        (4, 1),
    ]


HAND = Choice(name="hand", text="?", options=[ChoiceOption(value="left"), ChoiceOption(value="right", text="Right")])
SOME = Choice(name="some", text="?", multiple=True, required=False, options=HAND.options)
EASE = Scale(name="ease", text="?", low=-2, high=2)
AGE = Number(name="age", text="?", min=18, max=99, integer=True)
SIZE = Number(name="size", text="?", unit="m", required=False)
WORDS = FreeText(name="words", text="?", max_length=5, required=False)


@pytest.mark.parametrize(
    ("question", "typed", "meant"),
    [
        (HAND, "left", "left"), (HAND, " 2 ", "right"), (SOME, "2, left", ("left", "right")), (SOME, "", None),
        (EASE, "-2", -2), (EASE, "+1", 1), (AGE, "18", 18), (AGE, "99.0", 99), (SIZE, "1.5", 1.5), (SIZE, " ", None),
        (WORDS, " a\tb ", "a\tb"), (WORDS, "", None),
    ],
)  # fmt: skip
def test_typed_answers(question: Choice, typed: str, meant: object) -> None:
    assert question.read(typed) == meant
    assert type(question.read(typed)) is type(meant)
    assert question.take(question.read(typed)) == meant


@pytest.mark.parametrize(
    ("question", "typed", "said"),
    [
        (HAND, "", "'hand' requires an answer: left or right"), (HAND, "3", "must be left or right"),
        (HAND, "0", "must be"), (HAND, "1 2", "must be"), (HAND, "rigth", "did you mean 'right'"),
        (EASE, "3", "a whole number from -2 to 2"),
        (EASE, "1.5", "whole"), (EASE, "one", "whole"), (EASE, "٣", "whole"),
        (AGE, "17", "at least 18"), (AGE, "nan", "must be"), (AGE, "20.5", "whole"), (AGE, "1e99", "must be"),
        (WORDS, "abcdef", "at most 5 characters"),
        (WORDS, "\x1b[2J", "control character"), (WORDS, "\udcff", "control"),
    ],
)  # fmt: skip
def test_answers_that_are_not_allowed(question: Choice, typed: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        question.read(typed)


@pytest.mark.parametrize("question", [HAND, SOME, EASE, AGE, SIZE, WORDS])
@pytest.mark.parametrize("value", [True, {"a": 1}, [["left"]], float("nan"), float("inf"), "\x00", 10**400, b"left"])
def test_values_from_a_form_are_refused_when_they_are_something_else(question: Choice, value: object) -> None:
    with pytest.raises(InputError):
        question.take(value)
