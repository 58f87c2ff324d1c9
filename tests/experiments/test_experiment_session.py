"""Sessions: every event leads where it should, a log brings back where it was, nothing that counts is lost."""

from __future__ import annotations

import itertools
import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from crowdbot.core import EpisodeError, InputError, TrialError
from crowdbot.experiments import (
    Abort,
    Answered,
    Begin,
    Block,
    Choice,
    ChoiceOption,
    Console,
    ConsoleClosed,
    ConsoleRespondent,
    Event,
    Experiment,
    Fail,
    Finish,
    FreeText,
    Next,
    Number,
    Pause,
    Repeat,
    Resume,
    Screen,
    ScriptedRespondent,
    Session,
    SessionLog,
    SessionRunner,
    Start,
    TrialEntry,
    event_of,
    load_experiment,
    parse_experiment,
    read_log,
    record_of,
    save_summary,
    summary,
)
from crowdbot.recording import read_episode
from samples import sample

AGE = Number(name="age", text="How old are you?", min=18, integer=True)
LIKED = Choice(
    name="liked", text="What?", multiple=True, options=[ChoiceOption(value="speed"), ChoiceOption(value="distance")]
)
REMARK = FreeText(name="remark", text="Anything?", required=False)
EXPERIMENT = Experiment(
    name="two",
    instructions=[Screen(name="hello", text="Hello.", questions=[AGE])],
    blocks=[
        Block(
            name="main",
            order="latin-square",
            trials=[TrialEntry(name="x", source="frontal", seed=4), TrialEntry(name="y", source="empty-corridor")],
            after=[Screen(name="ask", questions=[LIKED, REMARK])],
            transitions=[Screen(name="rest", text="Rest.")],
        )
    ],
    endings=[Screen(name="bye", text="Bye.")],
)
BEGIN, FINISH = Begin(4, "001-x"), Finish("success", "00", {"duration": 1.5})


def at(*events: Event) -> Session:
    return Session.of(EXPERIMENT, 1).after(Start()).through(events)


IN = (Answered("age", 30), Next())
RAN = (*IN, BEGIN, FINISH)


def test_the_way_through() -> None:
    asked = (Answered("liked", ["distance", "speed"]), Next())
    seen = [Session.of(EXPERIMENT, 1)]
    for event in (Start(), *RAN, *asked, Next(), Begin(1, "002-y"), FINISH, *asked, Next()):
        seen.append(seen[-1].after(event))
    phases = [(session.phase, session.step.name) for session, _ in itertools.groupby(seen, key=lambda s: s)]
    assert phases == [
        ("ready", "hello"), ("screen", "hello"), ("screen", "hello"), ("trial", "x"), ("running", "x"),
        ("screen", "ask"),
        ("screen", "ask"), ("screen", "rest"), ("trial", "y"), ("running", "y"), ("screen", "ask"), ("screen", "ask"),
        ("screen", "bye"), ("done", "bye"),
    ]  # fmt: skip
    assert seen[-1].over
    assert seen[-1].possible_events == ()
    assert seen[-1].answers[2] == {"liked": ("speed", "distance")}
    assert [result.folder for result in seen[-1].results.values()] == ["001-x", "002-y"]
    assert seen[0] == Session.of(EXPERIMENT, 1)


@pytest.mark.parametrize(
    ("events", "wrong", "said"),
    [
        ((), Next(), "the screen 'hello' has unanswered questions: 'age'"),
        ((), Start(), "is not possible while the session is 'screen' at instructions 'hello'; possible events:"),
        ((), Begin(1, "f"), "possible events: answered, next, pause, abort"),
        ((), Repeat(), "'repeat' is not possible"),
        ((), Answered("agee", 1), "has no question 'agee'; it has age"),
        ((), Answered("age", 17), "at least 18"),
        ((), Resume(), "'resume' is not possible"),
        (IN, FINISH, "possible events: begin, pause, abort"),
        (IN, Next(), "'next' is not possible while the session is 'trial' at trial 'x'"),
        ((*IN, BEGIN), BEGIN, "possible events: finish, fail, pause, repeat, abort"),
        ((*IN, BEGIN), Answered("age", 20), "'answered' is not possible"),
        ((*IN, BEGIN, Fail("x")), Resume(), "possible events: next, repeat, abort"),
        ((Pause(),), Answered("age", 20), "possible events: resume, abort"),
        ((Abort(),), Resume(), "possible events: nothing"),
    ],
)  # fmt: skip
def test_what_is_not_possible_is_said(events: tuple[Event, ...], wrong: Event, said: str) -> None:
    session = at(*events)
    with pytest.raises(InputError) as found:
        session.after(wrong)
    assert said in str(found.value)


def test_pauses_return_to_where_they_were() -> None:
    for events in ((), (Answered("age", 30),), IN, (*IN, BEGIN), RAN):
        session = at(*events)
        held = session.after(Pause("phone"))
        assert (held.phase, held.reason, held.waiting) == ("pause", "phone", session.phase)
        assert held.after(Resume()) == session
        assert held.after(Abort()).phase == "aborted"


def test_a_failed_trial_is_repeated_or_left_out() -> None:
    failed = at(*IN, BEGIN, Fail("no place"))
    assert (failed.phase, failed.waiting, failed.reason) == ("pause", "failed", "no place")
    assert failed.results[1].outcome == "failed"
    assert failed.after(Next()).step.name == "ask"
    assert failed.after(Next()).results[1].reason == "no place"
    again = failed.after(Repeat())
    assert (again.phase, again.step.name, again.results) == ("trial", "x", {})
    assert again.after(BEGIN).results[1].attempt == 2


def test_a_repeat_forgets_what_came_after() -> None:
    asked = at(*RAN, Answered("liked", ["speed"]))
    again = asked.after(Repeat())
    assert (again.phase, again.step.name) == ("trial", "x")
    assert again.answers == {0: {"age": 30}}
    resting = asked.after(Next())
    assert resting.step.name == "rest"
    assert resting.after(Pause()).after(Repeat()).step.name == "x"
    about = resting.after(Next())
    assert about.step.name == "y"
    assert about.after(Repeat()).step.name == "x"
    assert about.after(Begin(1, "002-y")).after(Repeat()).step.name == "y"
    assert about.after(Begin(1, "002-y")).after(Repeat()).results[1].outcome == "success"


def _any(session: Session, draw: random.Random) -> Event:
    asked = [question.name for question in session.step.screen.questions] if session.step.screen else []
    name = draw.choice(asked or ["age"])
    value = {"age": draw.randint(18, 90), "liked": draw.choice([["speed"], ["speed", "distance"]]), "remark": "ü\n"}[
        name
    ]
    made: dict[str, Callable[[], Event]] = {
        "start": Start, "next": Next, "pause": lambda: Pause(draw.choice(["", "x"])), "resume": Resume,
        "repeat": Repeat,
        "abort": Abort, "begin": lambda: Begin(draw.randrange(9), f"f{draw.random()}"), "fail": lambda: Fail("why"),
        "finish": lambda: Finish("timeout", "aa", {"m": None, "n": 2.0, "o": "inf"}),
        "answered": lambda: Answered(name, value),
    }  # fmt: skip
    weights = [
        {"abort": 0.02, "repeat": 0.3, "pause": 0.3, "fail": 0.2}.get(word, 1.0) for word in session.possible_events
    ]
    return made[draw.choices(session.possible_events, weights)[0]]()


@pytest.mark.parametrize("seed", sample(range(40), 8))
def test_any_way_is_brought_back_by_its_records(seed: int) -> None:
    draw = random.Random(seed)
    session, records = Session.of(EXPERIMENT, 1 + seed), []
    for _ in range(300):
        if session.over:
            break
        event = _any(session, draw)
        asked = session.step.screen.questions if session.step.screen else ()
        if (isinstance(event, Next) and any(question.required for question in session.open)) or (
            isinstance(event, Answered) and not asked
        ):
            with pytest.raises(InputError, match="has unanswered|has no question"):
                session.after(event)
            continue
        session = session.after(event)
        records.append(json.dumps(record_of(event)))
        assert session.phase in ("screen", "trial", "running", "pause", "done", "aborted")
        assert set(session.results) <= set(session.attempts)
        assert (session.phase == "running") == ("finish" in session.possible_events)
    assert session.over
    again = Session.of(EXPERIMENT, 1 + seed).through(event_of(json.loads(line)) for line in records)
    assert again == session
    if session.phase == "done":
        trials = [k for k, step in enumerate(session.steps) if step.role == "trial"]
        assert list(session.results) == trials
        assert {result.outcome for result in session.results.values()} <= {"timeout", "failed"}


@pytest.mark.parametrize(
    "record",
    [
        {}, {"event": "jump"}, {"event": "answered", "question": "age"}, {"event": "begin", "seed": "1", "folder": "f"},
        {"event": "pause", "reason": "", "more": 1}, {"event": "finish", "outcome": "s", "digest": "d", "metrics": []},
        {"event": ["start"]},
    ],
)  # fmt: skip
def test_records_that_are_no_events(record: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        event_of(record)


class Ticking:
    """A clock for tests: a second for every look."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        self.now += 1.0
        return self.now


ANSWERS = {"age": 30, "liked": ["distance"]}


def _through(
    out: Path, participant: int = 1, resume: bool = False, experiment: Experiment = EXPERIMENT
) -> SessionRunner:
    sitting = SessionRunner(experiment, participant, out, Ticking(), resume=resume)
    try:
        Console(sitting, ScriptedRespondent(ANSWERS, experiment), lambda text: None, lambda what, share: None).run()
    finally:
        sitting.close()
    return sitting


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("whole")
    assert _through(out).session.phase == "done"
    return out / "participant-001"


def test_a_session_leaves_its_folders(whole: Path) -> None:
    assert sorted(str(path.relative_to(whole)) for path in whole.rglob("*")) == [
        "001-x", "001-x/answers.jsonl", "001-x/clock.csv", "001-x/episode.mcap",
        "002-y", "002-y/answers.jsonl", "002-y/clock.csv", "002-y/episode.mcap",
        "answers.jsonl", "experiment.xml", "session.jsonl",
    ]  # fmt: skip
    assert parse_experiment((whole / "experiment.xml").read_text()) == EXPERIMENT
    records = read_log(whole / "session.jsonl")
    assert records[0]["participant"] == 1
    assert [record["at"] for record in records] == [101.0 + k for k in range(len(records))]
    shown = [record["text"] for record in records if "shown" in record]
    assert shown[0] == "Hello."
    assert "How old are you?" in shown[1]
    episodes = [read_episode(whole / name / "episode.mcap") for name in ("001-x", "002-y")]
    digests = [record["digest"] for record in records if record.get("event") == "finish"]
    assert [episode.digest for episode in episodes] == digests
    assert [episode.seed for episode in episodes] == [4, 1]
    rows = [json.loads(line) for line in (whole / "002-y" / "answers.jsonl").read_text().splitlines()]
    assert [(row["screen"], row["question"], row["answer"]) for row in rows] == [
        ("ask", "liked", ["distance"]), ("ask", "remark", None),
    ]  # fmt: skip


def test_a_log_cut_anywhere_is_gone_on_with(whole: Path, tmp_path: Path) -> None:
    data = (whole / "session.jsonl").read_bytes()
    head = data.index(b"\n") + 1
    records = read_log(whole / "session.jsonl")
    draw = random.Random(1)
    for number, cut in enumerate([head, head + 1, len(data) - 1, len(data), *draw.sample(range(head, len(data)), 40)]):
        path = tmp_path / str(number) / "participant-001" / "session.jsonl"
        path.parent.mkdir(parents=True)
        path.write_bytes(data[:cut])
        kept = data[:cut].count(b"\n")
        events = [event_of(record) for record in records[:kept] if "event" in record]
        expected = Session.of(EXPERIMENT, 1).through(events)
        sitting = SessionRunner(EXPERIMENT, 1, tmp_path / str(number), Ticking(), resume=True)
        sitting.close()
        if expected.phase == "running":
            expected = expected.after(Repeat())
        assert sitting.session == expected
        again = read_log(path)
        assert again[:kept] == records[:kept]
        assert again[kept]["resumed"] is True


def test_what_was_cut_is_gone_through_to_the_end(whole: Path, tmp_path: Path) -> None:
    lines = (whole / "session.jsonl").read_bytes().splitlines(keepends=True)
    begun = next(k for k, line in enumerate(lines) if b'"begin"' in line)
    folder = tmp_path / "participant-001"
    folder.mkdir()
    (folder / "session.jsonl").write_bytes(b"".join(lines[: begun + 1]) + b'{"at": 3, "ev')
    with pytest.raises(EpisodeError, match="participant 1 already has a session in"):
        _through(tmp_path)
    session = _through(tmp_path, resume=True).session
    assert session.phase == "done"
    names = [result.folder for result in session.results.values()]
    assert names == ["001-x-attempt-2", "002-y"]
    first, second = summary(tmp_path)
    assert (first["attempt"], first["folder"], first["outcome"]) == (2, "001-x-attempt-2", "success")
    assert first["digest"] == summary(whole)[0]["digest"]
    assert second["attempt"] == 1
    with pytest.raises(
        InputError, match="'start' is not possible while the session is 'done'; possible events: nothing"
    ):
        session.after(Start())


def test_a_damaged_or_foreign_log_is_refused(whole: Path, tmp_path: Path) -> None:
    data = (whole / "session.jsonl").read_bytes()
    path = tmp_path / "participant-001" / "session.jsonl"
    path.parent.mkdir()
    (path.parent / "experiment.xml").write_bytes((whole / "experiment.xml").read_bytes())
    lines = data.splitlines(keepends=True)
    for bad, said in (
        (b"", "not a session log"),
        (b"{}\n", "not a session log"),
        (lines[0] + b"garbage\n", "session.jsonl:2: invalid session record"),
        (lines[0] + b"[1]\n", "session.jsonl:2"),
        (lines[0] + b"\xff\xfe\n", "session.jsonl:2"),
        (lines[0] + lines[-1], "session.jsonl:2: 'next' is not possible"),
        (lines[0] + b'{"event": "fly"}\n', "session.jsonl:2: 'fly' is not an event"),
    ):
        path.write_bytes(bad)
        for use in (lambda: _through(tmp_path, resume=True), lambda: summary(tmp_path)):
            with pytest.raises(EpisodeError, match=said):
                use()
        assert path.read_bytes() == bad
    path.write_bytes(data)
    other = Experiment(name="two", blocks=EXPERIMENT.blocks)
    with pytest.raises(EpisodeError, match="another version of the experiment"):
        _through(tmp_path, resume=True, experiment=other)
    with pytest.raises(EpisodeError, match="participant 2 has no session"):
        _through(tmp_path, participant=2, resume=True)


def test_two_programs_do_not_write_one_log(tmp_path: Path) -> None:
    first = SessionRunner(EXPERIMENT, 1, tmp_path, Ticking())
    with pytest.raises(EpisodeError, match="is in use by another program"):
        SessionRunner(EXPERIMENT, 1, tmp_path, Ticking(), resume=True)
    first.close()
    log, records = SessionLog.open(tmp_path / "participant-001" / "session.jsonl")
    log.close()
    assert len(records) == 1


def test_nothing_is_written_for_a_wrong_experiment_or_participant(tmp_path: Path) -> None:
    wrong = Experiment(name="e", blocks=[Block(name="b", trials=[TrialEntry(name="t", source="nowhere")])])
    with pytest.raises(TrialError, match="experiment 'e': TrialEntry 't' source='nowhere': there is no trial"):
        SessionRunner(wrong, 1, tmp_path, Ticking())
    with pytest.raises(InputError, match="participant 0"):
        SessionRunner(EXPERIMENT, 0, tmp_path, Ticking())
    file = tmp_path / "file"
    file.write_text("x")
    with pytest.raises(EpisodeError, match="cannot write"):
        SessionRunner(EXPERIMENT, 1, file, Ticking())
    assert sorted(tmp_path.iterdir()) == [file]


class Script(ConsoleRespondent):
    """Somebody who types what stands in a list; ``^C`` presses Ctrl-C."""

    def __init__(self, lines: list[str]) -> None:
        super().__init__(self, self._said, patient=True)  # type: ignore[arg-type]
        self.lines, self.text = lines, ""

    def _said(self, text: str) -> None:
        self.text += text

    def readline(self) -> str:
        if not self.lines:
            return ""
        line = self.lines.pop(0)
        if line == "^C":
            raise KeyboardInterrupt
        return line + "\n"


def _typed(
    out: Path, lines: list[str], experiment: Experiment = EXPERIMENT, resume: bool = False
) -> tuple[SessionRunner, str]:
    person = Script(lines)
    sitting = SessionRunner(experiment, 1, out, Ticking(), resume=resume)
    try:
        Console(sitting, person, person._said, lambda what, share: None).run()
    except ConsoleClosed:
        person.text += "LEFT"
    finally:
        sitting.close()
    return sitting, person.text


def test_wrong_answers_are_asked_anew_and_a_pause_has_a_menu(tmp_path: Path) -> None:
    lines = ["17", "thirty", "30", "", "1", "", "^C", "re", "repeat", "2", "none", "", "", "1", "", "", ""]
    sitting, text = _typed(tmp_path, lines)
    assert sitting.session.phase == "done"
    assert text.count("at least 18") == 3
    assert "PAUSE (Ctrl-C)" in text
    assert "'re' is not one of resume, repeat, abort, leave" in text
    assert [result.folder for result in sitting.session.results.values()] == ["001-x-attempt-2", "002-y"]
    assert sitting.session.answers[2] == {"liked": ("distance",), "remark": "none"}
    assert (sitting.folder / "001-x" / "answers.jsonl").exists()


def test_leaving_and_coming_back(tmp_path: Path) -> None:
    sitting, text = _typed(tmp_path, ["30", "^C", "^C"])
    assert text.endswith("LEFT")
    assert sitting.session.phase == "pause"
    assert summary(tmp_path)[0]["session"] == "unfinished"
    sitting, text = _typed(tmp_path, ["", "1", "", "", "^C", "a"], resume=True)
    assert "How old" not in text
    assert sitting.session.phase == "aborted"
    rows = summary(tmp_path)
    assert [(row["session"], row["outcome"], row["hello.age"]) for row in rows] == [
        ("aborted", "success", 30), ("aborted", "not run", 30),
    ]  # fmt: skip
    with pytest.raises(InputError, match="input ended"):
        _typed(tmp_path / "other", ["30"])


BROKEN = """from dataclasses import dataclass
from crowdbot.navigation import Navigator
from crowdbot.core import Twist


@dataclass(frozen=True)
class Broken(Navigator):
    \"\"\"Fails.\"\"\"

    def act(self, observation):
        raise RuntimeError("a wheel fell off")
"""


def test_code_that_fails_pauses_the_session(tmp_path: Path) -> None:
    text = (load_experiment("robot-speed").folder / "alone.xml").read_text()  # type: ignore[operator]
    (tmp_path / "t.xml").write_text(text.replace('type="orca"/>\n  </robot>', 'type="broken.py:Broken"/>\n  </robot>'))
    (tmp_path / "broken.py").write_text(BROKEN)
    experiment = Experiment(
        name="e", blocks=[Block(name="b", trials=[TrialEntry(name="t", source="t.xml")])], folder=tmp_path
    )
    sitting, said = _typed(tmp_path / "out", ["repeat", "next"], experiment)
    assert "PAUSE (RuntimeError: a wheel fell off; more in error.txt)" in said
    assert sitting.session.phase == "done"
    assert "a wheel fell off" in (sitting.folder / "001-t-attempt-2" / "error.txt").read_text()
    (row,) = summary(tmp_path / "out")
    assert (row["outcome"], row["attempt"], row["session"]) == ("failed", 2, "done")
    assert [read_episode(path).outcome for path in sorted(sitting.folder.rglob("*.mcap"))] == ["error", "error"]


def test_summaries_are_saved(whole: Path, tmp_path: Path) -> None:
    import pandas as pd

    rows = summary(whole.parent)
    assert [row["hello.age"] for row in rows] == [30, 30]
    for name, read in (("a.csv", pd.read_csv), ("a.parquet", pd.read_parquet), ("a.json", pd.read_json)):
        save_summary(rows, tmp_path / "deep" / name)
        table = read(tmp_path / "deep" / name)  # type: ignore[operator]
        assert list(table.columns) == list(rows[0])
        assert table["ask.liked"].tolist() == ["distance", "distance"]
        assert table["duration"].tolist() == pytest.approx([row["duration"] for row in rows])
        assert table["participant"].tolist() == [1, 1]
    mixed = [{"a": 1, "b": "x", "c": None}, {"a": "two", "b": None, "c": None}]
    save_summary(mixed, tmp_path / "m.parquet")
    assert pd.read_parquet(tmp_path / "m.parquet")["a"].tolist() == ["1", "two"]
    with pytest.raises(InputError, match="must end in .csv, .parquet, .json"):
        save_summary(rows, tmp_path / "a.xls")
    with pytest.raises(EpisodeError, match="contains no sessions"):
        summary(tmp_path)
