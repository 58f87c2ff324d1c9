"""Orders of trials: balance over participants and repetitions, independence of random ones, seeds of crowds."""

from __future__ import annotations

import itertools
from collections import Counter

import pytest

from crowdbot.core import InputError
from crowdbot.experiments import Block, Experiment, TrialEntry, orders, rows_of, seed_of, williams


def experiment(order: str, count: int, repetitions: int = 1, **more: object) -> tuple[Experiment, Block]:
    """Return an experiment of one block of ``count`` trials, and this block."""
    trials = tuple(TrialEntry(name=f"t{k}", source="frontal") for k in range(count))
    block = Block(name="main", order=order, repetitions=repetitions, trials=trials)
    return Experiment(name="made", blocks=(block,), **more), block  # type: ignore[arg-type]


@pytest.mark.parametrize("count", range(1, 9))
def test_every_condition_is_at_every_place_and_follows_every_other_equally_often(count: int) -> None:
    rows = williams(count)
    assert len(rows) == (1 if count == 1 else count * (1 + count % 2))
    assert all(sorted(row) == list(range(count)) for row in rows)
    places = Counter((place, trial) for row in rows for place, trial in enumerate(row))
    follows = Counter(pair for row in rows for pair in itertools.pairwise(row))
    assert set(places.values()) == {len(rows) // count}
    assert len(follows) == count * (count - 1)
    assert len(set(follows.values())) <= 1
    assert rows[0][: min(count, 2)] == list(range(min(count, 2)))


@pytest.mark.parametrize("count", [2, 3, 4])
def test_repetitions_of_a_latin_square_take_its_rows_in_turn(count: int) -> None:
    made, block = experiment("latin-square", count, repetitions=3)
    rows = williams(count)
    for participant in range(1, 2 * len(rows) + 2):
        expected = [rows[(participant - 1 + repetition) % len(rows)] for repetition in range(3)]
        assert orders(made, block, participant) == expected
    for repetition in range(3):
        seen = Counter(tuple(orders(made, block, who)[repetition]) for who in range(1, len(rows) + 1))
        assert seen == Counter(map(tuple, rows))


def test_random_orders_differ_by_participant_repetition_block_and_seed() -> None:
    made, block = experiment("random", 9, repetitions=3)
    drawn = {who: orders(made, block, who) for who in range(1, 5)}
    assert all(sorted(order) == list(range(9)) for each in drawn.values() for order in each)
    assert len({tuple(order) for each in drawn.values() for order in each}) == 12
    assert orders(made, block, 3) == drawn[3]
    other, same = experiment("random", 9, repetitions=3, seed=1)
    assert orders(other, same, 3) != drawn[3]
    renamed = Block(name="second", order="random", repetitions=3, trials=block.trials)
    assert orders(made, renamed, 3) != drawn[3]


def test_a_random_order_has_every_trial_at_every_place() -> None:
    made, block = experiment("random", 3, repetitions=1)
    drawn = Counter(tuple(orders(made, block, who)[0]) for who in range(1, 301))
    assert len(drawn) == 6
    assert all(25 <= count <= 80 for count in drawn.values())


def test_a_fixed_order_is_that_of_the_file_every_time() -> None:
    made, block = experiment("fixed", 3, repetitions=2)
    assert orders(made, block, 5) == [[0, 1, 2], [0, 1, 2]]


@pytest.mark.parametrize(
    ("order", "count", "rows"),
    [("random", 4, 0), ("fixed", 4, 1), ("latin-square", 1, 1), ("latin-square", 2, 2), ("latin-square", 3, 6),
     ("latin-square", 4, 4), ("latin-square", 5, 10)],
)  # fmt: skip
def test_orders_begin_again_after_so_many_participants(order: str, count: int, rows: int) -> None:
    made, block = experiment(order, count)
    assert rows_of(block) == rows
    if rows:
        assert orders(made, block, 1) == orders(made, block, 1 + rows)


def test_participants_are_numbered_from_1_to_the_last() -> None:
    made, block = experiment("fixed", 2, participants=3)
    assert orders(made, block, 1) == orders(made, block, 3) == [[0, 1]]
    for nobody in (0, 4):
        with pytest.raises(
            InputError, match=f"no participant {nobody} in the experiment 'made'; participants are 1 to 3"
        ):
            orders(made, block, nobody)
    endless, block = experiment("fixed", 2)
    assert orders(endless, block, 100_000) == [[0, 1]]
    with pytest.raises(InputError, match="1 to 100000"):
        orders(endless, block, 100_001)


def test_a_square_of_nothing_is_refused() -> None:
    with pytest.raises(InputError, match="a Latin square of 0 conditions is not possible"):
        williams(0)


def test_seeds_of_crowds() -> None:
    places = [(who, repetition) for who in (1, 2) for repetition in (0, 1, 2)]
    assert {seed_of(7, "same", *place) for place in places} == {7}
    by_repetition = {place: seed_of(7, "by-repetition", *place) for place in places}
    assert by_repetition[1, 0] == 7
    assert all(by_repetition[1, k] == by_repetition[2, k] for k in (0, 1, 2))
    assert len(set(by_repetition.values())) == 3
    by_participant = [seed_of(7, "by-participant", *place) for place in places]
    assert len(set(by_participant)) == 6
    assert 7 not in by_participant
    assert all(0 <= seed < 2**31 for seed in by_participant)
    assert seed_of(8, "by-participant", 1, 0) != seed_of(7, "by-participant", 1, 0)
    assert seed_of(8, "by-repetition", 1, 1) != seed_of(7, "by-repetition", 1, 1)
