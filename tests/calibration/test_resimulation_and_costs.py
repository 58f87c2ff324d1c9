"""People of windows simulated again, and the cost of doing it wrong, against slow, obvious twins."""

from __future__ import annotations

import numpy as np
import pytest
from made_crowds import Drifting, resimulate, windows

from crowdbot.calibration import Absolute, Cost, InterPedestrian, Progressive, Resimulation, Rollout, WeightedSum
from crowdbot.core import InputError, Scene
from crowdbot.data import Windows, slice_rows
from crowdbot.models import CrowdModel, CurrentDirection

MODEL = Drifting(share=0.8, push=1.5)


def slow_again(
    past: Windows, model: CrowdModel, w: int, substeps: int, radius: float, start: int = 0
) -> dict[int, list[np.ndarray]]:
    """Simulate one window from a row on with one-environment scenes, and return the rows of each simulated person."""
    T, A = past.present.shape[1:]
    rows = {a: [t for t in range(T) if past.present[w, t, a]] for a in range(A)}

    def recorded(a: int, t: int) -> np.ndarray | None:
        seen = rows[a]
        if not seen or t < seen[0] or t > seen[-1]:
            return None
        return np.array([np.interp(t, seen, past.position[w, seen, a, axis]) for axis in (0, 1)])

    walking = [a for a in range(A) if recorded(a, start) is not None and not past.robot[w, a]]
    place = {a: recorded(a, start) for a in walking}
    first = {}
    for a in walking:
        before, after = (recorded(a, 0), recorded(a, 1)) if start == 0 else (recorded(a, start - 1), place[a])
        first[a] = np.zeros(2) if before is None else (after - before) / past.dt
    velocity = dict(first)
    goal = {a: recorded(a, max(1, start)) + CurrentDirection().horizon * first[a] for a in walking}
    path: dict[int, list[np.ndarray]] = {a: [] for a in walking}
    for t in range(start, T - 1):
        here = [a for a in range(A) if (t <= rows[a][-1] if a in walking else recorded(a, t) is not None)]
        for a in set(here) - set(walking):
            place[a], goal[a] = recorded(a, t), np.zeros(2)
            if start == 0:
                after = recorded(a, t + 1)
                velocity[a] = np.zeros(2) if after is None else (after - place[a]) / past.dt
            else:
                before = recorded(a, t - 1)
                velocity[a] = np.zeros(2) if before is None else (place[a] - before) / past.dt
        for _ in range(substeps):
            scene = Scene.of(
                [place[a] for a in here], [velocity[a] for a in here], radius=radius, goal=[goal[a] for a in here],
                preferred_speed=[np.linalg.norm(first[a]) if a in first else 0.0 for a in here],
                external=[a not in walking for a in here],
            )  # fmt: skip
            scene = model.step(scene, past.dt / substeps)
            for i, a in enumerate(here):
                place[a], velocity[a] = scene.position[0, i], scene.velocity[0, i]
        for a in walking:
            path[a].append(place[a].copy())
    return path


def test_people_simulated_once_equal_their_slow_twin() -> None:
    past = windows()
    fast = resimulate(past, MODEL, radius=0.4, substep=0.2).once
    assert fast.shape == (1, 3, 5, 5, 2)
    for w in range(3):
        for a, path in slow_again(past, MODEL, w, 2, 0.4).items():
            until = int(np.flatnonzero(past.present[w, :, a])[-1])
            np.testing.assert_allclose(fast[0, w, :until, a], path[:until], atol=1e-10)


def test_people_simulated_row_by_row_equal_their_slow_twin() -> None:
    past = windows()
    fast = resimulate(past, MODEL, radius=0.4, substep=0.2).stepwise
    assert fast.shape == (1, 3, 4, 5, 2)
    for w in range(3):
        for row in range(1, 5):
            known = slice_rows(past, 0, row + 1)  # what is seen later decides nothing
            for a, path in slow_again(_longer(known), MODEL, w, 2, 0.4, start=row).items():
                if past.present[w, row, a] and past.present[w, : row + 1, a].all():
                    np.testing.assert_allclose(fast[0, w, row - 1, a], path[0], atol=1e-10)


def _longer(past: Windows) -> Windows:
    """The same windows and one more row, in which everyone stands where they were last seen."""
    position = np.concatenate([past.position, past.position[:, -1:]], axis=1)
    present = np.concatenate([past.present, past.present[:, -1:]], axis=1)
    frame = np.concatenate([past.frame, past.frame[:, -1:] + 1], axis=1)
    return Windows(position, present, past.scored, past.robot, past.id, frame, *list(vars(past).values())[6:])


def test_copies_lie_along_e_and_equal_each_candidate_alone() -> None:
    past = windows()
    share, radius = np.array([0.5, 1.0, 1.5]), np.array([0.1, 0.3, 0.2])
    resimulation = Resimulation(Rollout(Drifting(push=1.0), CurrentDirection()), past)

    def apply_to_scene(rollout: Rollout, scene: Scene, copies: int) -> tuple[Rollout, Scene]:
        each = np.repeat(np.repeat(np.arange(3), 3), copies)
        model = Drifting(share=share[each][:, None], push=1.0)
        sized = scene.replace(radius=np.broadcast_to(radius[each][:, None], scene.shape).copy())
        return Rollout(model, rollout.goal), sized

    together = resimulation.resimulate(apply_to_scene, 3, np.arange(3))
    for number in range(3):
        alone = resimulate(past, Drifting(float(share[number]), 1.0), float(radius[number]))
        assert np.array_equal(together.once[number], alone.once[0])
        assert np.array_equal(together.stepwise[number], alone.stepwise[0])


def test_some_of_the_windows_equal_the_same_among_all() -> None:
    past = windows()
    resimulation = Resimulation(Rollout(MODEL, CurrentDirection()), past)
    some = resimulation.resimulate(lambda rollout, scene, copies: (rollout, scene), 1, np.array([2, 0]))
    whole = resimulate(past, MODEL)
    assert np.array_equal(some.once[0], whole.once[0][[2, 0]])
    assert np.array_equal(some.stepwise[0], whole.stepwise[0][[2, 0]])


def counted_from(past: Windows, w: int, a: int, first: int) -> list[int]:
    return [] if past.robot[w, a] else [t for t in range(first, 6) if past.present[w, t, a]]


def test_the_absolute_difference_equals_its_slow_twin() -> None:
    past, again = windows(), resimulate(windows(), MODEL)
    fast = Absolute().measure(again)
    for w, a in np.ndindex(3, 5):
        seen = counted_from(past, w, a, 1) if past.present[w, 0, a] else []
        distance = [float(np.linalg.norm(again.once[0, w, t - 1, a] - past.position[w, t, a])) for t in seen]
        _assert_mean(fast[0, w, a], distance)


def test_the_progressive_difference_equals_its_slow_twin() -> None:
    past, again = windows(), resimulate(windows(), MODEL)
    fast = Progressive().measure(again)
    for w, a in np.ndindex(3, 5):
        seen = [t for t in counted_from(past, w, a, 2) if past.present[w, t - 1, a]]
        distance = [float(np.linalg.norm(again.stepwise[0, w, t - 2, a] - past.position[w, t, a])) for t in seen]
        _assert_mean(fast[0, w, a], distance)


def test_the_inter_pedestrian_difference_equals_its_slow_twin() -> None:
    past, again = windows(), resimulate(windows(), MODEL)
    fast = InterPedestrian().measure(again)
    for w, a in np.ndindex(3, 5):
        difference = []
        for t in range(1, 6):
            there = [b for b in range(5) if t in counted_from(past, w, b, 1) and past.present[w, 0, b]]
            for b in set(there) - {a} if a in there else ():
                simulated = np.linalg.norm(again.once[0, w, t - 1, a] - again.once[0, w, t - 1, b])
                difference.append(
                    abs(float(simulated - np.linalg.norm(past.position[w, t, a] - past.position[w, t, b])))
                )
        _assert_mean(fast[0, w, a], difference)


def _assert_mean(found: float, values: list[float]) -> None:
    if values:
        assert found == pytest.approx(sum(values) / len(values), abs=1e-12)
    else:
        assert np.isnan(found)


def test_a_weighted_sum_adds_up_and_counts_who_counts_everywhere() -> None:
    again = resimulate(windows(), MODEL)
    one, other = Absolute().measure(again), InterPedestrian().measure(again)
    found = WeightedSum((Absolute(), InterPedestrian()), (2.0, 0.5)).measure(again)
    np.testing.assert_allclose(found, 2.0 * one + 0.5 * other)
    assert np.isnan(found).sum() > 0


@pytest.mark.parametrize("cost", [Absolute(), InterPedestrian(), Progressive()])
def test_a_crowd_made_by_the_model_costs_nothing(cost: Cost) -> None:
    begun = windows()
    everyone = np.ones_like(begun.present)
    whole = Windows(begun.position, everyone, begun.scored, np.zeros_like(begun.robot), *list(vars(begun).values())[4:])
    made = np.concatenate([whole.position[:, :1], resimulate(whole, Drifting(push=0.0)).once[0]], axis=1)
    copy = Windows(made, *list(vars(whole).values())[1:])
    np.testing.assert_allclose(cost.measure(resimulate(copy, Drifting(push=0.0))), 0.0, atol=1e-12)


def test_somebody_alone_has_no_distance_to_others() -> None:
    past = windows()
    only = past.present & (np.arange(5) == 0)
    alone = Windows(past.position, only, *list(vars(past).values())[2:])
    assert np.all(np.isnan(InterPedestrian().measure(resimulate(alone, MODEL))))
    assert not np.any(np.isnan(Absolute().measure(resimulate(alone, MODEL))[..., 0]))


def test_wrong_weights_are_refused() -> None:
    with pytest.raises(InputError, match="1 costs and 2 weights; each cost needs one weight"):
        WeightedSum((Absolute(),), (1.0, 2.0))
    with pytest.raises(InputError, match=r"weights \(0\.0,\) must be finite, at least 0 and not all 0"):
        WeightedSum((Absolute(),), (0.0,))


def test_wrong_numbers_are_refused() -> None:
    with pytest.raises(InputError, match="substep = inf s must be finite and above 0"):
        Rollout(Drifting(), CurrentDirection(), substep=float("inf"))
    with pytest.raises(InputError, match=r"radius = -0\.1 m must be finite and above 0"):
        Rollout(Drifting(), CurrentDirection(), radius=np.array([0.2, -0.1]))
