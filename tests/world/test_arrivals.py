"""Queues of sources in arrays let in the same people as queues one after the other."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_arrivals import PlainArrivals

from crowdbot.core import InputError, Scene, tree
from crowdbot.trials import Distribution
from crowdbot.world import PeopleSource, Point, WaypointSequence, Zone, arrival_counts
from crowdbot.world.crowd.arrivals import Arrivals

DOORS = [Zone(((0, 0), (2, 0), (2, 2), (0, 2))), Zone(((5, 0), (8, 0), (6, 3)))]
PATH = WaypointSequence((Point(9.0, 1.0),))
WALLS = [[(1.0, -1.0), (1.0, 0.6)]]


class Pairs:
    """A sampler of two random numbers for each value."""

    def draw(self, rng: np.random.Generator, count: int) -> np.ndarray:
        return 0.2 + 0.05 * rng.random((count, 2)).sum(axis=1) + 0.01 * rng.integers(3, size=count)


BODIES = [0.25, Distribution.parse("uniform(0.15, 0.3)"), Distribution.parse("normal(0.25, 0.02)"), Pairs()]
SOURCES = st.builds(
    PeopleSource,
    zone=st.sampled_from(DOORS),
    journey=st.just(PATH),
    rate=st.floats(0.2, 40.0),
    timing=st.sampled_from(["poisson", "regular"]),
    begin=st.sampled_from([0.0, 0.7]),
    end=st.sampled_from([np.inf, 3.0]),
    max_count=st.sampled_from([None, 0, 7]),
    speed=st.sampled_from(BODIES),
    radius=st.sampled_from(BODIES),
)
SEEDS = st.lists(st.integers(0, 2**63 - 1), min_size=1, max_size=3, unique=True)


def both(sources: list[PeopleSource], seeds: list[int]) -> tuple[Arrivals, PlainArrivals]:
    return Arrivals(sources, seeds, 0, {}), PlainArrivals(sources, seeds, 0, {})


def check_step(pair: tuple[Arrivals, PlainArrivals], scenes: list[Scene], time: float, ids: list) -> None:
    """Let people enter both worlds and compare; some agents leave."""
    shape = scenes[0].shape
    gone = np.random.default_rng(int(time * 1000)).random(shape) < 0.1
    for n in range(2):
        own, following = ids[n]
        scene = scenes[n].replace(active=scenes[n].active & ~gone)
        scenes[n], _ = pair[n].let_in(scene, time, own, following)
    assert scenes[0].digest() == scenes[1].digest()
    assert scenes[0].preferred_speed.tobytes() == scenes[1].preferred_speed.tobytes()
    assert scenes[0].radius.tobytes() == scenes[1].radius.tobytes()
    assert ids[0][0].tolist() == ids[1][0].tolist()
    assert pair[0].waiting_count.tolist() == pair[1].waiting_count.tolist()


@settings(max_examples=40, deadline=None)
@given(sources=st.lists(SOURCES, min_size=1, max_size=3), changed=SOURCES, seeds=SEEDS, restart=st.booleans())
def test_the_same_people_enter(
    sources: list[PeopleSource], changed: PeopleSource, seeds: list[int], restart: bool
) -> None:
    pair, count = both(sources, seeds), len(seeds)
    empty = Scene.of(np.zeros((count, 30, 2)), active=False, walls=WALLS)
    scenes = [empty, empty]
    ids = [(np.tile(np.arange(30), (count, 1)), np.full(count, 30)) for _ in range(2)]
    for k in range(60):
        check_step(pair, scenes, 0.1 * k, ids)
        if k in (20, 35, 36):
            new = [*sources[:-1], changed if k == 20 else dataclasses.replace(sources[-1], rate=3.0)]
            for item in pair:
                item.reconfigure(new, [seed // 2 for seed in seeds] if restart and k == 35 else None)
        if k == 45:
            fresh = both(new, [5])
            chosen = np.array([count - 1, *range(count)][:count])
            plain = pair[1].select(chosen.tolist())
            plain.put([0], fresh[1])
            pair = tree.put(tree.take(pair[0], chosen), np.array([0]), fresh[0]), plain


@settings(max_examples=30, deadline=None)
@given(sources=st.lists(SOURCES, min_size=1, max_size=3), seeds=SEEDS, time=st.floats(0.0, 20.0))
def test_arrivals_are_counted(sources: list[PeopleSource], seeds: list[int], time: float) -> None:
    plain = PlainArrivals(sources, seeds, 0, {})
    for queues in plain._queues:
        for queue in queues:
            queue.fill(time)
    expected = [[queue.come for queue in queues] for queues in plain._queues]
    assert arrival_counts(sources, seeds, time).tolist() == expected
    assert arrival_counts(sources[-1:], seeds[:1], time, len(sources) - 1).tolist() == [expected[0][-1:]]


def test_joined_queues_continue() -> None:
    sources = [PeopleSource(DOORS[0], PATH, rate=5.0, speed=BODIES[1], radius=BODIES[3])]
    alone = [both(sources, [seed]) for seed in (3, 4)]
    queues, plain = zip(*alone, strict=True)
    pair = tree.join(queues), plain[0].join(plain[1:])
    empty = Scene.of(np.zeros((2, 9, 2)), active=False)
    scenes, ids = [empty, empty], [(np.tile(np.arange(9), (2, 1)), np.full(2, 9)) for _ in range(2)]
    for k in range(20):
        check_step(pair, scenes, 0.1 * k, ids)
    assert scenes[0].active.any()


def test_a_wrong_body_is_refused() -> None:
    sources = [PeopleSource(DOORS[0], PATH, rate=5.0, timing="regular", speed=Distribution.of(-1.0))]
    empty = Scene.of(np.zeros((9, 2)), active=False)
    with pytest.raises(InputError, match=r"the sampled speed -1.0 must be finite and above 0"):
        Arrivals(sources, [0], 0, {}).let_in(empty, 1.0, np.arange(9)[None], np.array([9]))
