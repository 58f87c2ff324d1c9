"""Questions and their limits, respondents that type, events as records, and the log of a session line by line."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import pytest

from crowdbot.core import EpisodeError, InputError
from crowdbot.experiments import (
    Abort,
    Answered,
    Begin,
    Choice,
    ChoiceOption,
    ConsoleRespondent,
    Event,
    Fail,
    Finish,
    FreeText,
    Next,
    Number,
    Pause,
    Repeat,
    Resume,
    Scale,
    ScriptedRespondent,
    SessionLog,
    Start,
    event_of,
    load_experiment,
    read_log,
    record_of,
)
from crowdbot.experiments.original import _names

EVENTS = [
    Start(), Next(), Answered("age", 27), Answered("hand", ["left"]), Begin(3, "01"),
    Finish("success", "ab", {"duration": 1.5}), Fail("no way"), Pause("phone"), Resume(), Repeat(), Abort("menu"),
]  # fmt: skip


@pytest.mark.parametrize("event", EVENTS, ids=lambda event: type(event).__name__)
def test_an_event_is_read_as_it_was_written(event: Event) -> None:
    record = {"at": "2026-01-01", **json.loads(json.dumps(record_of(event)))}
    assert event_of(record) == event


@pytest.mark.parametrize(
    ("record", "message"),
    [
        ({"event": "sleep"}, "'sleep' is not an event; events are start, next"),
        ({}, "'None' is not an event"),
        ({"event": "pause"}, "event 'pause' has an invalid 'reason'"),
        ({"event": "pause", "reason": 3}, "event 'pause' has an invalid 'reason'"),
        ({"event": "finish", "outcome": "x", "digest": "y", "metrics": []}, "event 'finish' has an invalid 'metrics'"),
        ({"event": "pause", "reason": "x", "why": 1}, "event 'pause' has fields other than reason"),
        ({"event": "next", "why": 1}, "event 'next' has fields other than its name"),
    ],
)
def test_a_record_that_is_no_event_is_refused(record: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        event_of(record)


HAND = Choice(name="hand", text="Which hand?", options=(ChoiceOption(value="left"), ChoiceOption(value="right")))
BOTH = Choice(name="hand", text="Which?", multiple=True, options=HAND.options)
EASE = Scale(name="ease", text="How easy?", low=-3, high=3, low_text="hard")
AGE = Number(name="age", text="How old?", unit="years", min=18.0, max=99.0, integer=True)
SIZE = Number(name="size", text="How tall?", min=0.5)
WORDS = FreeText(name="words", text="Anything else?", max_length=5, required=False)


@pytest.mark.parametrize(
    ("question", "text", "answer"),
    [
        (HAND, "left", "left"), (HAND, "1", "left"), (HAND, "2", "right"), (HAND, " right ", "right"),
        (BOTH, "right left", ("left", "right")), (BOTH, "2; 1", ("left", "right")), (BOTH, "2", ("right",)),
        (EASE, "-3", -3), (EASE, "3", 3), (EASE, "+2", 2), (EASE, "0", 0),
        (AGE, "18", 18), (AGE, "99", 99), (AGE, "27.0", 27), (SIZE, "0.5", 0.5), (SIZE, "1e3", 1000.0),
        (WORDS, "hello", "hello"), (WORDS, "", None), (WORDS, "  no ", "no"),
    ],
)  # fmt: skip
def test_what_may_be_answered(question: Any, text: str, answer: object) -> None:
    found = question.read(text)
    assert found == answer
    assert type(found) is type(answer)


@pytest.mark.parametrize(
    ("question", "text", "message"),
    [
        (HAND, "0", "is not an answer to 'hand', it must be left or right"), (HAND, "3", "it must be left or right"),
        (HAND, "lefd", "did you mean 'left'"), (HAND, "left right", "it must be left or right"),
        (BOTH, "left up", "it must be some of left, right"),
        (EASE, "-4", "it must be a whole number from -3 hard to 3"), (EASE, "4", "from -3 hard to 3"),
        (EASE, "1.0", "a whole number"), (EASE, "1234567", "a whole number"),
        (AGE, "17", "it must be a whole number, in years, at least 18, at most 99"), (AGE, "100", "at most 99"),
        (AGE, "27.5", "a whole number"), (SIZE, "0.49", "it must be a number, at least 0.5"), (SIZE, "x", "a number"),
        (SIZE, "1e16", "a number"), (WORDS, "hello!", "a text of at most 5 characters"), (WORDS, "a\x07", "control"),
    ],
)  # fmt: skip
def test_what_may_not_be_answered(question: Any, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        question.read(text)


@pytest.mark.parametrize("question", [HAND, BOTH, EASE, AGE, SIZE])
def test_an_answer_that_is_required_must_be_given(question: Any) -> None:
    with pytest.raises(InputError, match=question.name):
        question.read("  ")


def test_problems_of_questions_whose_values_are_allowed() -> None:
    one = ChoiceOption(value="one")
    assert [q.problem() for q in (HAND, BOTH, EASE, AGE, SIZE, WORDS)] == [""] * 6
    assert Choice(name="a", text="b", options=(one, one)).problem() == (
        "has the option 'one' twice; values must differ"
    )
    assert Scale(name="a", text="b", low=2, high=2).problem() == "has low=2, which must be below high=2"
    assert Scale(name="a", text="b", low=-1000, high=1000).problem() == ""
    assert Number(name="a", text="b", min=2.0, max=1.0).problem() == "has min above max"
    assert Number(name="a", text="b", min=2.0, max=2.0).problem() == ""
    assert FreeText(name="a", text=" \n").problem() == "has an empty text; give the text of the question"
    for low, high in ((-1001, 0), (0, 1001)):
        with pytest.raises(InputError):
            Scale(name="a", text="b", low=low, high=high)


def test_who_types_answers_line_by_line_and_words_may_be_begun() -> None:
    shown: list[str] = []
    typed = ConsoleRespondent(io.StringIO("27\r\n\nre\nx\n Repeat \nLEAVE\nlast"), shown.append, patient=True)
    assert typed.answer("welcome", AGE) == "27"
    typed.go_on()
    words = ("resume", "repeat", "leave")
    assert typed.choose(words) == "repeat"
    assert [text.splitlines()[0] for text in shown] == [
        "  're' is not one of resume, repeat, leave", "  'x' is not one of resume, repeat, leave",
    ]  # fmt: skip
    assert typed.choose(words) == "leave"
    assert typed.answer("end", WORDS) == "last"
    with pytest.raises(InputError, match="the input ended before the Enter key"):
        typed.go_on()
    with pytest.raises(InputError, match=r"before welcome\.age; continue later with --resume"):
        typed.answer("welcome", AGE)


def test_a_script_answers_by_the_full_or_the_short_name() -> None:
    experiment = load_experiment("robot-speed")
    person = ScriptedRespondent({"age": 30, "welcome.robots": ["a", "b"]}, experiment)
    assert person.answer("welcome", AGE) == person.answer("elsewhere", AGE) == "30"
    robots = FreeText(name="robots", text="?")
    assert (person.answer("welcome", robots), person.answer("elsewhere", robots)) == ("a, b", "")
    assert person.choose(("resume", "leave")) == "leave"
    for name in ("aged", "opinion.age"):
        with pytest.raises(InputError, match=f"there is no question '{name}'"):
            ScriptedRespondent({name: 30}, experiment)


def test_a_log_is_read_back_and_continued(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "log.jsonl"
    log = SessionLog.create(path, {"experiment": "x"})
    log.append({"event": "start"})
    log.close()
    assert read_log(path) == [{"format": 1, "experiment": "x"}, {"event": "start"}]
    with pytest.raises(EpisodeError, match="already exists; sessions are not overwritten"):
        SessionLog.create(path, {})
    whole = path.read_bytes()
    path.write_bytes(whole + b'{"event": "ne')
    assert read_log(path) == [{"format": 1, "experiment": "x"}, {"event": "start"}]
    log, records = SessionLog.open(path)
    assert len(records) == 2
    with pytest.raises(EpisodeError, match="is in use by another program"):
        SessionLog.open(path)
    log.append({"event": "next"})
    log.close()
    assert path.read_bytes() == whole + b'{"event": "next"}\n'


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "is not a session log supported by this version"),
        ('{"event": "start"}\n', "is not a session log"),
        ('{"format": 2}\n', "is not a session log"),
        ('{"format": 1}', "is not a session log"),
        ('{"format": 1}\n[1]\n', ":2: invalid session record"),
        ('{"format": 1}\n{"a"\n{"event": "start"}\n', ":2: invalid session record"),
    ],
)
def test_what_is_no_log_is_refused(tmp_path: Path, content: str, message: str) -> None:
    path = tmp_path / "log.jsonl"
    path.write_text(content)
    with pytest.raises(EpisodeError, match=message):
        read_log(path)
    with pytest.raises(EpisodeError, match=message):
        SessionLog.open(path)
    assert path.read_text() == content


def test_a_log_that_is_missing_is_named(tmp_path: Path) -> None:
    for read in (read_log, SessionLog.open):
        with pytest.raises(EpisodeError, match=r"cannot (read|write) .*absent\.jsonl"):
            read(tmp_path / "absent.jsonl")


def test_imported_trials_have_short_names_of_their_own() -> None:
    long = "x" * 40
    names = _names(["a/One.xml", "b/one.xml", f"{long}.xml", "7 up.xml", "a/One.xml", "ä.xml"])
    assert list(names.values()) == ["One", "one_2", "x" * 30, "trial_7_up", "trial__"]
