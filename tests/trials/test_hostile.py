"""Trial files from strangers: refused at once, nothing expanded, nothing fetched, no stack trace."""

from __future__ import annotations

import importlib.util
import itertools
import random
from pathlib import Path
from typing import Any

import pytest

from crowdbot.core import TrialError
from crowdbot.trials import Trial, load_trial, parse_trial
from samples import sizes
from space_trials import LEAN
from trial_texts import FLOW, GOOD, changed, written

BOMB = (
    '<?xml version="1.0"?>\n<!DOCTYPE trial [\n<!ENTITY a "'
    + "ha" * 100
    + '">\n'
    + "".join(f'<!ENTITY {chr(98 + k)} "{f"&{chr(97 + k)};" * 10}">\n' for k in range(12))
    + ']>\n<trial name="&m;" duration="1"/>'
)


def external(target: Path) -> str:
    return (
        f'<?xml version="1.0"?>\n<!DOCTYPE trial [<!ENTITY secret SYSTEM "{target.as_uri()}">]>\n'
        '<trial name="x" duration="1">&secret;</trial>'
    )


def refused(text: str | bytes) -> str:
    with pytest.raises(TrialError) as found:
        parse_trial(text, place="t.xml")
    return str(found.value)


def test_an_entity_bomb_is_refused_at_its_doctype() -> None:
    assert refused(BOMB).startswith("t.xml:2: a trial must not have a DOCTYPE or entities")


def test_external_entities_are_never_resolved(tmp_path: Path) -> None:
    secret = tmp_path / "secret.txt"
    secret.write_text("the password")
    path = written(tmp_path, external(secret))
    with pytest.raises(TrialError, match=r"trial.xml:2: a trial must not have a DOCTYPE") as found:
        load_trial(path)
    assert "password" not in str(found.value)
    remote = '<!DOCTYPE trial SYSTEM "http://127.0.0.1:9/none.dtd"><trial name="x" duration="1"/>'
    assert "DOCTYPE" in refused(remote)
    parameter = '<!DOCTYPE trial [<!ENTITY % p SYSTEM "http://127.0.0.1:9/p"> %p;]><trial name="x" duration="1"/>'
    assert "DOCTYPE" in refused(parameter)


def test_an_undeclared_entity_is_no_xml() -> None:
    assert refused(changed('about="four', 'about="&x; four')).startswith("t.xml:2: this is not well-formed XML")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("<a>" * 5000, "t.xml:1: more than 20 levels of elements"),
        ("<trial>" + "<robot/>" * 60_000 + "</trial>", "t.xml:1: more than 50000 elements"),
        ("<trial " + " ".join(f'a{k}=""' for k in range(200)) + "/>", "more than 100 attributes"),
        (b" " * 4_100_000, "larger than 4000000 bytes"),
        (b"\xff\xfe<\x00", "not well-formed"),
        (b'<?xml version="1.0" encoding="no-such-code"?><trial/>', "t.xml"),
        (b"\x00\x01\x02", "t.xml:1: this is not well-formed XML"),
        ("<trial/>\n<trial/>", "t.xml:2: this is not well-formed XML: junk after document element"),
        ('<trial name="a" name="b"/>', "duplicate attribute"),
        ("<trial>\ud800</trial>", "half a character"),
    ],
)
def test_absurd_files_are_refused_fast(text: str | bytes, sentence: str) -> None:
    assert sentence in refused(text)


def test_a_large_file_is_not_read_whole(tmp_path: Path) -> None:
    path = tmp_path / "large.xml"
    with path.open("wb") as stream:
        stream.truncate(3_000_000_000)
    with pytest.raises(TrialError, match="larger than 4000000 bytes"):
        load_trial(path)


def test_thousands_of_problems_are_cut() -> None:
    problems = refused('<trial name="a" duration="1"><crowd type="orca"/>' + "<x/>" * 5000 + "</trial>").splitlines()
    assert len(problems) == 101
    assert problems[-1] == "t.xml: and 4900 more problems"


def test_long_values_are_cut_in_messages() -> None:
    assert len(refused(changed('seed="3"', f'seed="{"9" * 100_000}"'))) < 300


def test_a_trial_that_would_fill_the_memory_is_refused() -> None:
    text = changed('duration="4"', 'duration="86400"').replace('count="2" zone="-5', 'count="99999" zone="-5', 1)
    assert "more than 100000000 positions in total" in refused(text)


@pytest.mark.parametrize("share", sizes(0.4, 1.0))
@pytest.mark.parametrize(("good", "count"), [(GOOD, 400), (FLOW, 150), (LEAN, 100)], ids=["good", "flow", "room"])
def test_mutated_files_are_read_or_refused_in_a_sentence(good: str, count: int, share: float) -> None:
    count = round(share * count)
    chance = random.Random(1)
    pool = ['"', "<", ">", "/", "&", "-", "nan", "1e999", "\x00", "é", " ", "\n", "robot", "zone", "uniform(", "9" * 30]
    read, problems = 0, []
    for _ in range(count):
        text = list(good)
        for _ in range(chance.randint(1, 3)):
            place = chance.randrange(len(text))
            text[place : place + chance.randint(0, 3)] = chance.choice(pool)
        try:
            read += isinstance(parse_trial("".join(text)), Trial)
        except TrialError as error:
            problems += error.problems
    assert 0 < read < count
    assert len(problems) >= count - read
    assert all("\n" not in problem and len(problem) < 600 for problem in problems)


@pytest.fixture(scope="module")
def fuzzing() -> Any:
    """Return ``tools/fuzz_trials.py``, which makes thousands of files when it is run by hand."""
    path = Path(__file__).parents[2] / "tools" / "fuzz_trials.py"
    spec = importlib.util.spec_from_file_location("fuzz_trials", path)
    assert spec is not None
    assert spec.loader is not None
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    return tool


@pytest.mark.parametrize("stride", sizes(401, 61))
def test_numbers_next_to_nothing_and_huge_ones_are_read_or_refused(fuzzing: Any, tmp_path: Path, stride: int) -> None:
    said: list[str] = []
    done = fuzzing.fuzz(itertools.islice(fuzzing.ends(), 0, None, stride), tmp_path, said.append)
    assert done["wrong"] == 0, "\n".join(said)
    assert min(done["refused"], done["run in the planar world"], done["run in the physics world"]) > 0


@pytest.mark.parametrize("count", sizes(60, 600))
def test_mutated_trials_of_all_kinds_are_read_or_refused(fuzzing: Any, tmp_path: Path, count: int) -> None:
    said: list[str] = []
    done = fuzzing.fuzz(fuzzing.drawn(count, 42), tmp_path, said.append)
    assert done["wrong"] == 0, "\n".join(said)
    assert done["refused"] > 0.3 * count
    assert done["run in the planar world"] > 0.1 * count
    assert done["run in the physics world"] > 0
