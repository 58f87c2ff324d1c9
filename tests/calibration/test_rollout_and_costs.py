"""People of windows simulated again, and the cost of doing it wrong, against slow, obvious twins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from crowdbot.calibration import AbsoluteDifference, Cost, Rollout
from crowdbot.core import InputError, Paper, PerAgent, Scene, per_agent, stream
from crowdbot.core.parameter import parameter
from crowdbot.data import Windows
from crowdbot.models import CrowdModel, CurrentDirection


@dataclass(frozen=True)
class Drifting(CrowdModel):
    """Everyone keeps a share of the desired velocity and is pushed sideways by everyone else's nearness."""

    paper: ClassVar[Paper] = Paper("Nobody", 2020, "Drifting", "Nowhere")
    share: PerAgent = parameter(1.0, unit="1", low=0.2, high=2.0, source="test")
    push: PerAgent = parameter(0.0, unit="1/s", low=0.0, high=1.0, source="test")

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> np.ndarray:
        share, push = per_agent(self.share, scene.shape), per_agent(self.push, scene.shape)
        away = scene.position[:, :, None] - scene.position[:, None, :]
        near = np.exp(-np.sum(away**2, axis=-1)) * (scene.active[:, None, :] & scene.active[:, :, None])
        pushed = np.sum(away * near[..., None], axis=2) * push[..., None] * scene.radius[..., None]
        return scene.desired_velocity(dt) * share[..., None] + pushed


def windows(W: int = 3, T: int = 6, A: int = 5, seed: int = 0) -> Windows:
    """People who walk about; agent 1 is a robot, agent 2 comes late, agent 3 leaves early, one row has a hole."""
    rng = stream(seed, "rollout")
    step = rng.normal(0.0, 0.3, (W, 1, A, 2)) + rng.normal(0.0, 0.05, (W, T, A, 2))
    position = rng.uniform(-1.0, 1.0, (W, 1, A, 2)) + np.cumsum(step, axis=1)
    present = np.ones((W, T, A), dtype=bool)
    present[:, :3, 2] = False
    present[:, 4:, 3] = False
    present[0, 2, 0] = False
    present[-1, :, 4] = False
    robot = np.tile(np.arange(A) == 1, (W, 1))
    return Windows(
        np.where(present[..., None], position, 0.0), present, np.zeros((W, A), bool), robot,
        np.tile(np.arange(A), (W, 1)), np.tile(np.arange(T), (W, 1)), 0.4, "all", "made",
    )  # fmt: skip


def slow_again(past: Windows, model: CrowdModel, w: int, substeps: int, radius: float) -> dict[int, list[np.ndarray]]:
    """Simulate one window with one-environment scenes, person by person, and return the rows of each simulated one."""
    T, A = past.present.shape[1:]
    rows = {a: [t for t in range(T) if past.present[w, t, a]] for a in range(A)}

    def recorded(a: int, t: int) -> np.ndarray | None:
        seen = rows[a]
        if not seen or t < seen[0] or t > seen[-1]:
            return None
        return np.array([np.interp(t, seen, past.position[w, seen, a, axis]) for axis in (0, 1)])

    walking = [a for a in range(A) if past.present[w, 0, a] and not past.robot[w, a]]
    place = {a: recorded(a, 0) for a in walking}
    first = {a: (recorded(a, 1) - place[a]) / past.dt for a in walking}
    velocity = dict(first)
    goal = {a: recorded(a, 1) + CurrentDirection().horizon * first[a] for a in walking}
    path: dict[int, list[np.ndarray]] = {a: [] for a in walking}
    for t in range(T - 1):
        here = [a for a in range(A) if (t <= rows[a][-1] if a in walking else recorded(a, t) is not None)]
        for a in set(here) - set(walking):
            place[a], goal[a] = recorded(a, t), np.zeros(2)
            after = recorded(a, t + 1)
            velocity[a] = np.zeros(2) if after is None else (after - place[a]) / past.dt
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


def test_people_simulated_again_equal_their_slow_twin() -> None:
    past = windows()
    model = Drifting(share=0.9, push=2.0)
    fast = Rollout(model, CurrentDirection(), radius=0.4, substep=0.2).again(past)
    assert fast.shape == (1, 3, 5, 5, 2)
    for w in range(3):
        for a, path in slow_again(past, model, w, 2, 0.4).items():
            until = int(np.flatnonzero(past.present[w, :, a])[-1])
            np.testing.assert_allclose(fast[0, w, :until, a], path[:until], atol=1e-10)


def test_copies_lie_along_e_and_equal_each_candidate_alone() -> None:
    past = windows()
    share, radius = np.array([0.5, 1.0, 1.5]), np.array([0.1, 0.3, 0.2])
    many = Drifting(share=np.repeat(share, 3)[:, None], push=1.0)
    together = Rollout(many, CurrentDirection(), np.repeat(radius, 3)[:, None]).again(past, copies=3)
    for number in range(3):
        alone = Rollout(Drifting(float(share[number]), 1.0), CurrentDirection(), float(radius[number])).again(past)
        assert np.array_equal(together[number], alone[0])


def test_the_absolute_difference_equals_its_slow_twin() -> None:
    past = windows()
    model = Drifting(share=0.7, push=1.0)
    rollout = Rollout(model, CurrentDirection())
    fast = AbsoluteDifference().measure(past, rollout.again)
    again = rollout.again(past)
    for w, a in np.ndindex(3, 5):
        seen = [t for t in range(1, 6) if past.present[w, t, a]]
        if past.robot[w, a] or not past.present[w, 0, a] or not seen:
            assert np.isnan(fast[0, w, a])
            continue
        distance = [float(np.linalg.norm(again[0, w, t - 1, a] - past.position[w, t, a])) for t in seen]
        assert fast[0, w, a] == pytest.approx(sum(distance) / len(distance), abs=1e-12)


def test_people_made_by_the_model_cost_nothing() -> None:
    past = windows()
    only = Windows(
        *[*list(vars(past).values())[:1], past.present & (np.arange(5) == 0), *list(vars(past).values())[2:]]
    )
    rollout = Rollout(Drifting(), CurrentDirection())
    straight = rollout.again(only)[0]
    made = np.concatenate([only.position[:, :1], straight], axis=1)
    everyone = np.ones_like(only.present) & (np.arange(5) == 0)
    copy = Windows(np.where(everyone[..., None], made, 0.0), everyone, *list(vars(only).values())[2:])
    cost = AbsoluteDifference().measure(copy, rollout.again)
    np.testing.assert_allclose(cost[0, :, 0], 0.0, atol=1e-12)


def test_a_later_row_starts_with_the_velocity_of_the_row_before() -> None:
    past = windows()
    late = Rollout(Drifting(), CurrentDirection()).again(past, row=2)
    assert late.shape == (1, 3, 3, 5, 2)
    step = past.position[1, 2, 0] - past.position[1, 1, 0]
    np.testing.assert_allclose(late[0, 1, 0, 0], past.position[1, 2, 0] + step, atol=1e-9)


def test_a_cost_of_ones_own_is_one_class() -> None:
    class Largest(Cost):
        def measure(self, past: Windows, simulate: object) -> np.ndarray:
            return np.linalg.norm(simulate(past, 0) - past.position[:, 1:], axis=-1).max(axis=2)  # type: ignore[operator]

    rollout = Rollout(Drifting(), CurrentDirection())
    cost = Largest().measure(windows(), rollout.again)
    assert cost.shape == (1, 3, 5)


def test_wrong_numbers_are_refused() -> None:
    with pytest.raises(InputError, match="displacements = 0 must be at least 1"):
        Rollout(Drifting(), CurrentDirection(), displacements=0)
    with pytest.raises(InputError, match="substep = inf s must be finite and above 0"):
        Rollout(Drifting(), CurrentDirection(), substep=float("inf"))
    with pytest.raises(InputError, match=r"radius = -0\.1 m must be finite and above 0"):
        Rollout(Drifting(), CurrentDirection(), radius=np.array([0.2, -0.1]))
