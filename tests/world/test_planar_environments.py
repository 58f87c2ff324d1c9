"""Worlds that are joined, selected and replaced are the worlds alone, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Scene, Twist
from crowdbot.models import ORCA, CrowdModel, Mixture, SocialForce
from crowdbot.world import (
    AckermannDrive,
    DifferentialDrive,
    PlanarWorld,
    Twists,
    join_worlds,
    put_environments,
    select_environments,
    step_environments,
)


def world(seed: int, agents: int, kind: str) -> PlanarWorld:
    """Return a world of one robot and people with their own parameters."""
    rng = np.random.default_rng(seed)
    scene = Scene.of(
        rng.uniform(-3, 3, (agents, 2)), goal=rng.uniform(-3, 3, (agents, 2)), radius=0.2,
        external=np.arange(agents) == 0,
    )  # fmt: skip
    models: dict[str, CrowdModel] = {
        "same": ORCA(),
        "own": ORCA(time_horizon=rng.uniform(1.0, 3.0, agents)),
        "numbers": ORCA(time_horizon=float(rng.uniform(1.0, 3.0))),
        "mixed": Mixture((ORCA(), SocialForce()), rng.integers(2, size=agents)),
        "kinds": [ORCA(), SocialForce()][seed % 2],
    }
    drives = {0: DifferentialDrive()}
    return PlanarWorld(scene, models[kind], drives, 0.1, seed, heading_jitter=0.1, latency={0: 0.25})


def command(tick: int, seed: int) -> Twist:
    return Twist(0.1 * seed + 0.05 * tick, 0.3 - 0.1 * seed)


def digests(planar_world: PlanarWorld) -> list[bytes]:
    scene = planar_world.scene
    return [
        scene.position[e, :n].tobytes() + scene.velocity[e, :n].tobytes() + scene.heading[e, :n].tobytes()
        for e, n in enumerate(planar_world.slots.tolist())
    ]


def alone(seed: int, agents: int, kind: str, steps: int) -> bytes:
    one = world(seed, agents, kind)
    for tick in range(steps):
        one.step({0: command(tick, seed)})
    return digests(one)[0]


@pytest.mark.parametrize("kind", ["same", "own", "numbers", "mixed", "kinds"])
@pytest.mark.parametrize("agents", [[5, 5, 5], [2, 6, 3]])
def test_joined_worlds_keep_their_people_and_parameters(kind: str, agents: list[int]) -> None:
    whole = join_worlds([world(seed, count, kind) for seed, count in enumerate(agents)])
    assert whole.scene.shape == (3, max(agents))
    for tick in range(9):
        rows = [command(tick, seed) for seed in range(3)]
        whole.step({0: Twists(*np.array(rows).T.copy())})
    assert digests(whole) == [alone(seed, count, kind, 9) for seed, count in enumerate(agents)]  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", ["own", "mixed", "kinds"])
@given(data=st.data())
@settings(max_examples=5, deadline=None)
def test_environments_that_are_replaced_begin_anew(kind: str, data: st.DataObject) -> None:
    counts = [2, 6, 3]
    whole = join_worlds([world(seed, count, kind) for seed, count in enumerate(counts)])
    seeds, ages = [0, 1, 2], [0, 0, 0]
    for _ in range(12):
        new = data.draw(st.lists(st.integers(0, 2), max_size=1))
        for e in new:
            seeds[e], ages[e], counts[e] = seeds[e] + 3, 0, data.draw(st.integers(1, 8))
            fresh = world(seeds[e], counts[e], kind)
            fresh.clock.tick = 0
            whole = put_environments(whole, [e], fresh)
        rows = [command(age, seed) for age, seed in zip(ages, seeds, strict=True)]
        whole.step({0: Twists(*np.array(rows).T.copy())})
        ages = [age + 1 for age in ages]
    expected = [alone(*row) for row in zip(seeds, counts, [kind] * 3, ages, strict=True)]
    assert digests(whole) == expected  # type: ignore[arg-type]
    assert whole.ticks.tolist() == ages


@pytest.mark.parametrize("steps", [(3, 0), (0, 3)])
def test_a_car_at_rest_replaces_one_that_drives_and_the_reverse(steps: tuple[int, int]) -> None:
    """A car has a steering angle after its first step only."""
    scene = Scene.of([[0.0, 0.0], [3.0, 1.0]], external=[True, False])
    parts = [PlanarWorld(scene, ORCA(), {0: AckermannDrive()}, 0.1, seed) for seed in range(2)]
    for part, count in zip(parts, steps, strict=True):
        for _ in range(count):
            part.step({0: Twist(0.5, 0.3)})
    single = select_environments(parts[1], [0])
    assert put_environments(parts[0], [0], parts[1]) is parts[0]
    for _ in range(4):
        parts[0].step({0: Twist(0.4, -0.2)})
        single.step({0: Twist(0.4, -0.2)})
    assert digests(parts[0]) == digests(single)  # type: ignore[arg-type]


def test_commands_on_their_way_come_with_a_replaced_environment() -> None:
    """The latency is 0.25 s, three steps."""
    whole, other = join_worlds([world(seed, 4, "same") for seed in range(2)]), world(5, 4, "same")
    for tick in range(4):
        whole.step({0: command(tick, 1)})
        other.step({0: command(tick, 2)})
    alone = select_environments(other, [0])
    put_environments(whole, [1], other)
    for _ in range(4):
        whole.step({0: Twist(0.1)})
        alone.step({0: Twist(0.1)})
    assert digests(whole)[1] == digests(alone)[0]


def test_selected_environments_do_not_share_state() -> None:
    whole = join_worlds([world(seed, 4, "same") for seed in range(3)])
    whole.step({0: Twist(0.5)})
    some = select_environments(whole, [2, 0, 2])
    before = digests(whole)  # type: ignore[arg-type]
    for _ in range(5):
        some.step({0: Twist(0.1, 0.4)})
    assert digests(whole) == before  # type: ignore[arg-type]
    assert digests(some)[0] == digests(some)[2]  # type: ignore[arg-type]
    assert (whole.ticks.tolist(), some.ticks.tolist()) == ([1, 1, 1], [6, 6, 6])


class Weak(ORCA):
    """A model that fails for a crowd at one place."""

    def step(self, scene, dt, rng=None):  # type: ignore[no-untyped-def]
        if scene.position[0, -1, 0] > 2.0:
            raise RuntimeError("too far")
        return super().step(scene, dt, rng)


def test_an_environment_that_fails_leaves_the_others_alone() -> None:
    def build(x: float) -> PlanarWorld:
        return PlanarWorld(Scene.of([[0.0, 0.0], [x, 1.0]], goal=[[5.0, 0.0], [x, -5.0]]), Weak(), {}, 0.1)

    parts = [build(x) for x in (0.0, 3.0, 1.0)]
    whole, errors = step_environments(join_worlds(parts), {})
    assert {e: str(error) for e, error in errors.items()} == {1: "too far"}
    for e, x in ((0, 0.0), (2, 1.0)):
        single = build(x)
        single.step({})
        assert whole.scene.position[e].tobytes() == single.scene.position[0].tobytes()
    assert not whole.scene.active[1].any()
    with pytest.raises(InputError, match="3 seeds are given for 2 environments"):
        PlanarWorld(Scene.of(np.zeros((2, 1, 2))), ORCA(), {}, 0.1, seed=[1, 2, 3])
