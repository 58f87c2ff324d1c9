"""No mistake hides another, and none is told that is not there: many are planted in one file, which is read once."""

from __future__ import annotations

import itertools
import random
import re

import pytest
from planted import KINDS, RICH, Kind, planted, told_apart

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
        told = next((one for one in left if re.match(rf"t\.xml:{line}: {words}", one)), None)
        if told is None:
            missed.append(f"not told: {line}: {words}")
        else:
            left.remove(told)
    return missed + left


def drawn(chance: random.Random, count: int, fresh: set[frozenset[Kind]]) -> list[Kind]:
    """Return mistakes for one file, first those that were not together with others yet."""
    order = sorted(KINDS, key=lambda kind: (-sum(kind in pair for pair in fresh), chance.random()))
    chosen: list[Kind] = []
    for kind in order:
        if len(chosen) < count and told_apart([*chosen, kind]):
            chosen.append(kind)
    return chosen


def test_the_rich_trial_is_right_and_its_pieces_are_clear() -> None:
    assert problems(RICH) == []
    assert all(RICH.count(kind.old) == 1 for kind in KINDS)


@pytest.mark.parametrize("seed", sample(range(12), 4))
def test_a_few_mistakes_are_all_told_and_nothing_else(seed: int) -> None:
    chance = random.Random(seed)
    assert compared(drawn(chance, chance.randint(2, 8), set())) == []


def test_every_kind_is_told_together_with_every_other() -> None:
    pairs = {frozenset(pair) for pair in itertools.combinations(KINDS, 2) if told_apart([*pair])}
    assert len(pairs) > 3000
    chance, files = random.Random(0), 0
    while pairs:
        kinds = drawn(chance, len(KINDS), pairs)
        assert compared(kinds) == []
        pairs -= {frozenset(pair) for pair in itertools.combinations(kinds, 2)}
        files += 1
        assert files < 60, pairs


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
        assert [int(one.split(":")[1]) for one in told] == sorted(lines), (spoilt_text, told)


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
        assert {one.split(":")[1] for one in told} == {str(line)}, told


def test_a_reference_waits_for_a_name_that_is_missing_but_not_a_misspelt_one() -> None:
    nameless = FLOW.replace('<journey name="through">', "<journey>")
    assert len(problems(nameless)) == 1
    assert "needs the attribute 'name'" in problems(nameless)[0]
    twice = FLOW.replace('<crowd name="hurried"', '<crowd name="calm"')
    assert [one.partition("> ")[2] for one in problems(twice)] == [
        "name 'calm' is already used by another crowd; names must differ"
    ]
    misspelt = FLOW.replace('<journey name="in"', "<journey").replace('3" journey="through"', '3" journey="throug"', 1)
    assert [one.split(":")[1] for one in problems(misspelt)] == ["17", "20"]


def test_a_stage_with_a_mistake_keeps_its_other_solids_and_their_numbers() -> None:
    solid = '<obstacle points="0,1.5 1,1.5 1,2.5 0,2.5"/>'
    text = GOOD.replace(solid, f'<obstacle points="3,3"/><obstacle points="0,0 1,1 1,0 0,1"/>{solid}')
    told = problems(text.replace('x="-2" y="-2.4"', 'x="0.5" y="2"').replace("walkable", "walkabel"))
    assert [one.split(":")[1] for one in told] == ["3", "5", "5", "10"]
    assert told[3].endswith("<robot> starts at 0.5,2 inside obstacle 3 of the stage")


def test_the_whole_range_is_told() -> None:
    for old, new, said in (
        ('time-horizon="2"', 'neighbor-distance="-1"', "it must be at least 0 m and at most 1e+09 m"),
        ('time-horizon="2"', 'max-speed="-1"', "it must be at least 0 m/s and at most 1e+09 m/s, or None to use"),
        ('rays="90"', 'rays="0"', "rays = 0 must be a whole number of at least 1 and at most 1000000"),
        ('rays="90"', 'rate="-1"', "rate = -1.0 Hz must be finite and at least 1e-06 Hz, without an upper limit"),
        ('max-speed="1"', 'max-turn-rate="0"', "must be finite and above 0 rad/s, without an upper limit"),
        ('tolerance="0.3"', 'tolerance="0"', 'tolerance="0" must be above 0 m and at most 1000000 m'),
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


def test_no_mistake_hides_another_in_an_experiment() -> None:
    with pytest.raises(TrialError) as found:
        parse_experiment(EXPERIMENT, place="e.xml")
    lines = [int(one.split(":")[1]) for one in found.value.problems]
    assert lines == [2, 3, 3, 4, 4, 6, 7], found.value.problems
