"""What holds for every goal in the list of goals."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from goal_places import crowd, made, moved, street, windows
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, builtin_classes, find_class, kebab_case
from crowdbot.data import observed_velocity, steady_velocity
from crowdbot.models import CurrentDirection, Goal, goals
from crowdbot.models.goals import Choices

KINDS = list(builtin_classes(goals, Goal).values())
every_goal = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kebab_case(kind.__name__))


def answers(goal, past):
    choices = goal.choices(past)
    return goal.resolve(past), goal.velocity(past), choices.position, choices.weight


def test_the_goals_are_these():
    names = {"current-direction", "environment-layout", "ground-truth", "learned-destinations"}
    assert set(builtin_classes(goals, Goal)) == names
    assert find_class("learned-destinations", goals, Goal).learns
    assert find_class("environment-layout", goals, Goal).learns
    assert not CurrentDirection.learns


@every_goal
def test_shapes_and_weights(kind):
    past = crowd()
    place, velocity, choice, weight = answers(made(kind, past), past)
    here = past.present[:, -1]
    assert place.shape == velocity.shape == (4, 6, 2)
    assert choice.shape == (*weight.shape, 2)
    assert all(np.all(np.isfinite(values)) for values in (place, velocity, choice, weight))
    assert np.all(weight >= 0.0)
    assert np.allclose(np.sum(weight, axis=-1), here)
    assert np.all(place[~here] == 0.0)
    assert np.all(velocity[~here] == 0.0)
    assert np.all(choice[~here] == 0.0)


@every_goal
@settings(max_examples=8)
@given(seed=st.integers(0, 10_000), rows=st.integers(1, 11))
def test_a_window_alone_is_as_in_a_batch_bit_for_bit(kind, seed, rows):
    past = crowd(seed, T=rows)
    goal = made(kind, past)
    whole = answers(goal, past)
    for window in range(len(past)):
        one = past[window : window + 1]
        alone = answers(made(kind, one) if kind.knows_future else goal, one)
        assert all(np.array_equal(a[0], b[window]) for a, b in zip(alone, whole, strict=True))


@every_goal
@settings(max_examples=8)
@given(seed=st.integers(0, 10_000), angle=st.floats(-3.1, 3.1), shift=st.floats(-30.0, 30.0))
def test_turning_and_shifting_the_place(kind, seed, angle, shift):
    past = crowd(seed)
    by = (angle, (shift, -0.5 * shift))
    here = past.present
    place = np.where(here[..., None], moved(past.position, *by), 0.0)
    other = dataclasses.replace(past, position=place)
    before, after = made(kind, past), made(kind, other, *by)
    now = here[:, -1]
    assert moved(before.resolve(past), *by)[now] == pytest.approx(after.resolve(other)[now], abs=1e-5)
    old, new = before.choices(past).likeliest(2), after.choices(other).likeliest(2)
    assert old.weight == pytest.approx(new.weight, abs=1e-6)
    clear = now & (old.weight[..., 0] > old.weight[..., 1] + 1e-5)  # equal weights may change places
    assert moved(old.position[..., 0, :], *by)[clear] == pytest.approx(new.position[..., 0, :][clear], abs=1e-5)


@every_goal
@settings(max_examples=8)
@given(seed=st.integers(0, 10_000), order=st.permutations(range(6)))
def test_renumbering_and_padding(kind, seed, order):
    past = crowd(seed)

    def at(slots):
        named = {name: getattr(past, name)[:, slots] for name in ("scored", "robot", "id")}
        return dataclasses.replace(
            past, position=past.position[:, :, slots], present=past.present[:, :, slots], **named
        )

    other = at(list(order))
    for answer, two in zip(answers(made(kind, past), past), answers(made(kind, other), other), strict=True):
        assert answer[:, order] == pytest.approx(two, abs=1e-7)
    empty = np.zeros((4, 8, 3), dtype=bool)
    padded = dataclasses.replace(
        past,
        position=np.concatenate([past.position, np.zeros((4, 8, 3, 2))], axis=2),
        present=np.concatenate([past.present, empty], axis=2),
        **{
            name: np.concatenate([getattr(past, name), empty[:, 0].astype(getattr(past, name).dtype)], axis=1)
            for name in ("scored", "robot", "id")
        },
    )
    for answer, two in zip(answers(made(kind, past), past), answers(made(kind, padded), padded), strict=True):
        assert answer == pytest.approx(two[:, :6], abs=1e-7)


@every_goal
def test_who_is_scored_is_never_read_and_nothing_is_written(kind):
    past = crowd(3)
    for array in (past.position, past.present, past.scored, past.robot, past.id, past.frame):
        array.setflags(write=False)
    other = dataclasses.replace(past, scored=np.ones_like(past.scored))
    goal = made(kind, past)
    assert all(np.array_equal(a, b) for a, b in zip(answers(goal, past), answers(goal, other), strict=True))


@every_goal
def test_one_row_two_rows_many_rows_and_nobody(kind):
    for rows in (1, 2, 30):
        past = crowd(1, T=rows, holes=0.0)
        place, velocity, _, weight = answers(made(kind, past), past)
        assert np.allclose(np.sum(weight, axis=-1), past.present[:, -1])
        assert rows > 1 or np.all(velocity == 0.0)
        assert rows > 1 or np.array_equal(place, past.position[:, -1])
    nobody = windows(np.full((2, 8, 3, 2), np.nan))
    assert all(np.all(values == 0.0) for values in answers(made(kind, nobody), nobody))
    assert made(kind, crowd()[:0]).resolve(crowd()[:0]).shape == (0, 6, 2)


@pytest.mark.parametrize(
    "kind", [kind for kind in KINDS if not kind.learns], ids=lambda kind: kebab_case(kind.__name__)
)
def test_what_does_not_learn_says_so(kind):
    with pytest.raises(InputError, match=rf"{kebab_case(kind.__name__)} does not learn from recordings; use"):
        kind.learn(street())


def test_choices_must_fit():
    with pytest.raises(InputError, match=r"position has shape \[1, 2, 3, 2\] and weight \[1, 2, 4\]"):
        Choices(np.zeros((1, 2, 3, 2)), np.zeros((1, 2, 4)))
    few = Choices(np.ones((1, 1, 1, 2)), np.ones((1, 1, 1))).likeliest(3)
    assert few.weight.tolist() == [[[1.0, 0.0, 0.0]]]
    assert few.position.tolist() == [[[[1.0, 1.0]] * 3]]


def weighed_by_hand(past):
    """Return the steady velocity of the first person of a window without holes, person by person."""
    place = past.position[0]
    rows, people = place.shape[:2]
    aheads = sorted({max(1, round((rows - 1) * share / 7)) for share in (1, 2, 3)})

    def mean(row, k, person):
        first = max(0, row - k)
        return (place[row, person] - place[first, person]) / (row - first)

    error, seen = np.zeros((people, rows - 1)), np.zeros(people)
    for person in range(people):
        for extrapolate in aheads:
            for row in range(1, rows - extrapolate):
                seen[person] += 1
                for k in range(1, rows):
                    off = place[row + extrapolate, person] - place[row, person] - extrapolate * mean(row, k, person)
                    error[person, k - 1] += off @ off / extrapolate
    shared = (error[0] + 8.0 * error.mean(axis=0)) / (seen[0] + 8.0 * seen.mean())
    weight = (shared.min() / shared) ** 20
    steps = [mean(rows - 1, k, 0) for k in range(1, rows)]
    return sum(w * step for w, step in zip(weight / weight.sum(), steps, strict=True)) / past.dt


def test_the_steady_velocity_is_that_of_a_plain_loop():
    past = crowd(2, W=1, A=4, holes=0.0)
    assert steady_velocity(past)[0, 0] == pytest.approx(weighed_by_hand(past))


def test_the_steady_velocity_averages_as_much_as_noise_asks_for():
    rng = np.random.default_rng(1)
    time = 0.4 * np.arange(8.0)
    true = np.stack([1.2 * time, 0.0 * time], axis=-1)
    noisy = true[None, :, None] + rng.normal(0.0, 0.08, (200, 8, 6, 2))
    off = {k: np.std(observed_velocity(windows(noisy), k)[..., 1]) for k in (1, 7)}
    steady = np.std(steady_velocity(windows(noisy))[..., 1])
    assert steady < 0.3 * off[1]
    assert steady < 1.5 * off[7]
    bend = np.stack([3.0 * np.sin(time / 3.0), 3.0 * np.cos(time / 3.0)], axis=-1)[None, :, None]
    assert steady_velocity(windows(bend)) == pytest.approx(observed_velocity(windows(bend)), abs=1e-3)
