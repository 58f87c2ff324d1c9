"""Every kind of mistake in a trial is told with its line, those of values all at once, and none that is not there."""

from __future__ import annotations

import random
import re

import pytest
from planted import KINDS, RICH, VALUES, Kind, planted

from crowdbot.core import TrialError
from crowdbot.experiments import parse_experiment
from crowdbot.trials import load_trial, parse_trial, trial_xml
from samples import sample
from trial_texts import FLOW, GOOD


def problems(text: str) -> list[str]:
    try:
        parse_trial(text, place="t.xml")
    except TrialError as error:
        return list(error.problems)
    return []


def compared(kinds: list[Kind]) -> list[str]:
    """Return which mistakes are not told, and what is told of none."""
    text, said = planted(kinds)
    left = problems(text)
    missed = []
    for line, words in said:
        told = next((item for item in left if re.match(rf"t\.xml:{line}: {words}", item)), None)
        if told is None:
            missed.append(f"not told: {line}: {words}")
        else:
            left.remove(told)
    return missed + left


def test_the_rich_trial_is_right_and_its_pieces_are_clear() -> None:
    assert problems(RICH) == []
    assert all(RICH.count(kind.old) == 1 for kind in KINDS)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.new or kind.old)
def test_a_mistake_is_told_with_its_line_and_nothing_else(kind: Kind) -> None:
    assert compared([kind]) == []


def test_all_wrong_values_of_a_file_are_told_at_once() -> None:
    left = list(VALUES)
    while left:
        spans = {kind: (RICH.index(kind.old), RICH.index(kind.old) + len(kind.old)) for kind in left}
        kinds: list[Kind] = []
        for kind, (begin, end) in spans.items():
            if all(end <= spans[other][0] or spans[other][1] <= begin for other in kinds):
                kinds.append(kind)
        assert len(kinds) > 30 or len(kinds) == len(left)
        assert compared(kinds) == []
        left = [kind for kind in left if kind not in kinds]


NUMBER = re.compile(r'(?<=")-?\d+(?:\.\d+)?(?=")')


def spoilt(text: str, chance: random.Random) -> tuple[str, set[int]]:
    """Return a file of which a few elements have a mistake, and their lines."""
    lines = text.splitlines()
    rows = [k for k, line in enumerate(lines) if re.match(r"\s*<[a-z]", line)]
    spoilt = chance.sample(rows, min(len(rows), chance.randint(2, 8)))
    for k in spoilt:
        ways = [re.sub(r"<([a-z-]+)", r'<\1 zzzqqq="1"', lines[k], count=1)]
        if NUMBER.search(lines[k]):
            ways.append(NUMBER.sub("many", lines[k], count=1))
        lines[k] = chance.choice(ways)
    return "\n".join(lines), {k + 1 for k in spoilt}


NAMES = (
    "frontal",
    "intersection",
    "doorway",
    "two-crowds",
    "joining-group",
    "empty-corridor",
    "static-crowd",
    "one-way-with",
)


@pytest.mark.parametrize("name", sample(NAMES, 3))
def test_mistakes_in_trials_that_ship_are_all_told(name: str) -> None:
    text = trial_xml(load_trial(name))
    for seed in range(4):
        spoilt_text, lines = spoilt(text, random.Random(f"{name} {seed}"))
        told = problems(spoilt_text)
        assert [int(item.split(":")[1]) for item in told] == sorted(lines), (spoilt_text, told)


def test_what_is_misspelt_is_there_for_others() -> None:
    for old, new in (
        ('<source name="west"', '<sorce name="west"'),
        ("<journey name", "<journey nmae"),
        ("<crowd name", "<crwd name"),
        ('type="social-force"', 'type="social"'),
        ('type="social-force"', 'type="zzz"'),
        ('type="orca" time-horizon="2"', ""),
        ("<zone points", "<zone qqq"),
        ("<routing", "<rooting"),
        ('variant="force"', 'variant="push"'),
    ):
        assert old in FLOW
        told = problems(FLOW.replace(old, new, 1))
        line = FLOW[: FLOW.index(old)].count("\n") + 1
        assert {item.split(":")[1] for item in told} == {str(line)}, told


def test_the_whole_range_is_told() -> None:
    for old, new, said in (
        ('time-horizon="2"', 'neighbor-distance="-1"', "it must be at least 0 m and at most 1e+09 m"),
        ('time-horizon="2"', 'max-speed="-1"', "it must be at least 0 m/s and at most 1e+09 m/s, or None to use"),
        ('rays="90"', 'rays="0"', "rays = 0 must be a whole number of at least 1 and at most 1000000"),
        ('rays="90"', 'rate="-1"', "rate = -1.0 Hz must be finite and at least 1e-06 Hz, without an upper limit"),
        ('max-speed="1"', 'max-turn-rate="0"', "must be finite and above 0 rad/s, without an upper limit"),
        ('tolerance="0.3"', 'tolerance="0"', 'tolerance="0" must be above 0 m and at most 1000000 m'),
        ('step="0.05"', 'step="3"', 'step="3" must be at most 1 s and at least 0.001 s'),
        ('duration="4"', 'duration="1e7"', 'duration="1e7" must be at most 86400 s and above 0 s'),
    ):
        told = problems(GOOD.replace(old, new, 1))
        assert len(told) == 1
        assert said in told[0]


EXPERIMENT = """<experiment name="e">
  <block name="main" repetitions="2" ordr="random">
    <trial name="x" source="frontl"><after name="b" text="b"/><after name="b" text="c"/></trial>
    <trail name="x" source="frontal"/>
  </block>
  <ending name="end" file="none.txt"/>
  <ending name="end" text="bye"/>
</experiment>"""


def test_mistakes_in_an_experiment_are_told_at_once_first_those_of_values() -> None:
    for text, lines in (
        (EXPERIMENT, [2, 4]),
        (EXPERIMENT.replace("ordr", "order").replace("trail", "trial"), [3, 3, 4, 6, 7]),
    ):
        with pytest.raises(TrialError) as found:
            parse_experiment(text, place="e.xml")
        assert [int(problem.split(":")[1]) for problem in found.value.problems] == lines, found.value.problems
