"""ORCA: against the steps of RVO2, against obvious twins of its kernels, and by what it must do."""

from __future__ import annotations

import dataclasses
import itertools
import json

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from model_crowds import PILLAR, ROOM, SCREEN, crowd, moved

from crowdbot.core import InputError, Scene, Walls
from crowdbot.core.geometry import time_to_segment
from crowdbot.models import ORCA
from crowdbot.models.velocity_obstacles.linear_program import best_velocity
from crowdbot.models.velocity_obstacles.orca_lines import (
    BLOCK,
    BLOCK_ROWS,
    LINE,
    avoid_agent,
    avoid_agents,
    avoid_edge,
    edges_in_reach,
    edges_of,
)

SCENES = ["blocks100", "bottleneck12", "circle250", "corridor_bidir", "crossing90", "hetero", "hetero_dense"]


@pytest.mark.parametrize("name", SCENES)
def test_one_step_agrees_with_rvo2(reference, name, capsys):
    steps = np.load(reference / "rvo2" / f"{name}.npz")
    about = json.loads((reference / "rvo2" / f"{name}.json").read_text())
    now = {key: steps[key].astype(np.float64) for key in steps.files}
    scene = Scene.of(
        now["x"],
        now["v"],
        radius=now["radius"],
        max_speed=now["maxSpeed"],
        preferred_velocity=now["pref"],
        walls=about["obstacles"],
    )
    model = ORCA(now["neighborDist"], now["maxNeighbors"], now["timeHorizon"], now["timeHorizonObst"])
    error = np.abs(model.velocity(scene, about["dt"]) - now["v_next"]).max(axis=-1)
    share = np.mean(error < 1e-4)
    with capsys.disabled():
        print(
            f"\n{name}: {share:.3%} of {error.size} within 1e-4, median {np.median(error):.0e}, worst {error.max():.0e}"
        )
    assert share > 0.99
    assert np.median(error) < 1e-6


def test_every_rvo2_scene_is_tested(reference):
    assert sorted(path.stem for path in (reference / "rvo2").glob("*.npz")) == SCENES


def left_of(lines, velocity):
    """Return how far ``velocity`` is on the forbidden side of the worst line."""
    x, y, ux, uy = np.asarray(lines).T
    return np.max(ux * (y - velocity[1]) - uy * (x - velocity[0]), initial=-np.inf)


def best_by_trying(lines, speed, wish):
    """Return the allowed velocity nearest to the wish, of all corners of the allowed region; None when it is empty."""
    points = [wish if np.hypot(*wish) <= speed else wish * speed / np.hypot(*wish)]
    for q, u in ((line[:2], line[2:]) for line in lines):
        foot = q - (q @ u) * u
        half2 = speed**2 - foot @ foot
        if half2 >= 0.0:
            points += [foot + np.sqrt(half2) * u, foot - np.sqrt(half2) * u, q + ((wish - q) @ u) * u]
    for item, two in itertools.combinations(lines, 2):
        matrix = np.stack([item[2:], -two[2:]], axis=1)
        if abs(np.linalg.det(matrix)) > 1e-9:
            points.append(item[:2] + np.linalg.solve(matrix, two[:2] - item[:2])[0] * item[2:])
    allowed = [p for p in points if np.hypot(*p) <= speed + 1e-9 and left_of(lines, p) <= 1e-9]
    return min(allowed, key=lambda p: np.hypot(*(p - wish)), default=None)


def random_lines(rng, count, spread):
    angle = rng.uniform(-np.pi, np.pi, count)
    return np.stack([*rng.normal(0.0, spread, (2, count)), np.cos(angle), np.sin(angle)], axis=1)


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 2**32), count=st.integers(0, 9))
def test_the_linear_program_finds_the_best_corner(seed, count):
    rng = np.random.default_rng(seed)
    lines, wish, speed = random_lines(rng, count, 1.0), rng.normal(0.0, 1.5, 2), rng.uniform(0.5, 2.0)
    found = np.array(best_velocity(lines, 0, count, speed, *wish, np.empty_like(lines)))
    expected = best_by_trying(lines, speed, wish)
    assert np.hypot(*found) <= speed * (1.0 + 1e-9)
    if expected is not None:
        assert np.allclose(found, expected, atol=1e-6)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32), fixed=st.integers(0, 2))
def test_without_an_allowed_velocity_the_worst_violation_is_small(seed, fixed):
    rng = np.random.default_rng(seed)
    lines = random_lines(rng, 8, 1.0)
    lines[:fixed, :2] = -0.3 * np.stack([-lines[:fixed, 3], lines[:fixed, 2]], axis=1)  # walls leave standing still
    found = np.array(best_velocity(lines, fixed, 8, 1.5, 1.0, 0.0, np.empty_like(lines)))
    tried = np.stack(np.meshgrid(*[np.linspace(-1.5, 1.5, 121)] * 2), axis=-1).reshape(-1, 2)
    violation = lines[:, 2] * (lines[:, 1] - tried[:, 1:]) - lines[:, 3] * (lines[:, 0] - tried[:, :1])
    possible = (np.hypot(*tried.T) <= 1.5) & np.all(violation[:, :fixed] <= 0.0, axis=1)
    least = max(violation[possible][:, fixed:].max(axis=1).min(), 0.0)
    assert np.hypot(*found) <= 1.5 * (1.0 + 1e-9)
    assert left_of(lines[:fixed], found) <= 1e-9
    assert left_of(lines[fixed:], found) <= least + 1e-9


def border_of_cone(place, reach, horizon):
    """Return many points on the border of the relative velocities that lead to contact within the horizon."""
    distance = np.hypot(*place)
    ahead, side = place / distance, np.array([-place[1], place[0]]) / distance
    half = np.arcsin(reach / distance)
    bow = np.linspace(0.5 * np.pi + half, 1.5 * np.pi - half, 2000)[:, None]
    cap = place / horizon + reach / horizon * (np.cos(bow) * ahead + np.sin(bow) * side)
    out = np.linspace(np.hypot(*cap[0]), 20.0, 20000)[:, None]
    legs = [out * (np.cos(half) * ahead + sign * np.sin(half) * side) for sign in (1.0, -1.0)]
    return np.concatenate([cap, *legs])


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32), share=st.sampled_from([0.5, 1.0]))
def test_a_line_is_the_least_change_to_the_border_of_the_cone(seed, share):
    rng = np.random.default_rng(seed)
    reach, horizon = rng.uniform(0.3, 0.8), rng.uniform(1.0, 4.0)
    place = rng.normal(0.0, 2.0, 2)
    place *= max(1.0, (reach + 0.05) / np.hypot(*place))
    mine, other = rng.normal(0.0, 1.0, (2, 2))
    line = np.empty((1, 4))
    avoid_agent(line, 0, *place, *mine, *other, reach, horizon, 0.1, share, 1.0)
    change = (line[0, :2] - mine) / share
    border = border_of_cone(place, reach, horizon)
    assert np.hypot(*change) == pytest.approx(np.linalg.norm(border - (mine - other), axis=1).min(), abs=2e-3)
    assert np.linalg.norm(border - (mine - other + change), axis=1).min() < 2e-3
    assert abs(change @ line[0, 2:]) < 1e-9  # a tangent
    assert left_of(line, mine + share * (place / horizon - (mine - other))) > 0.0  # contact is on the right


def test_overlapping_agents_part_within_the_step():
    line = np.empty((1, 4))
    avoid_agent(line, 0, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 2.0, 0.1, 0.5, 1.0)
    assert line[0] == pytest.approx([-1.0, 0.0, 0.0, 1.0])  # half of 0.2 m in 0.1 s
    avoid_agent(line, 0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.5, 2.0, 0.1, 0.5, -1.0)
    assert line[0] == pytest.approx([1.0 - 2.5, 0.0, 0.0, 1.0])  # the same place and velocity: the given side


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32), held=st.integers(1, BLOCK), spread=st.sampled_from([0.2, 2.0, 20.0]))
def test_lines_of_a_block_have_the_bits_of_one_line_at_a_time(seed, held, spread):
    rng = np.random.default_rng(seed)
    block = np.full((BLOCK_ROWS, BLOCK), np.nan)
    block[:2, :held], block[2:4, :held] = rng.normal(0.0, spread, (2, held)), rng.normal(0.0, 1.0, (2, held))
    block[4, :held], block[5, :held] = rng.uniform(0.2, 0.8, held), rng.choice([0.5, 1.0], held)
    mine, horizon, dt = rng.normal(0.0, 1.0, 2), rng.uniform(0.2, 8.0), rng.uniform(0.01, 0.4)
    block[:4, 0] = 0.0, 0.0, *mine  # the same place and velocity have no direction
    best = rng.normal(0.0, 1.0, 2)
    violated = avoid_agents(block, held, *mine, horizon, dt, *best)
    line = np.empty((1, 4))
    assert violated == 1 + sum(left_of(block[LINE:, n][None], best) > 0.0 for n in range(1, held))
    assert np.isnan(block[LINE + 2, 0])
    for n in range(1, held):
        x, y, vx, vy, reach, share = block[:LINE, n]
        avoid_agent(line, 0, x, y, *mine, vx, vy, reach, horizon, dt, share, 1.0)
        assert line[0].tobytes() == block[LINE:, n].tobytes()


L_SHAPED = [(-4.0, 1.0), (-2.0, 1.0), (-2.0, 2.0), (-3.0, 2.0), (-3.0, 3.0), (-4.0, 3.0)]
SOLID = [PILLAR, L_SHAPED]


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_allowed_velocities_keep_clear_of_walls(seed):
    rng = np.random.default_rng(seed)
    walls = Walls.of([ROOM, SCREEN, *SOLID])
    corner, direction, previous, following, convex = edges_of(walls)
    place, velocity = rng.uniform(-5.5, 5.5, 2), rng.normal(0.0, 1.0, 2)
    assume(not any(shapely.Polygon(ring).contains(shapely.Point(place)) for ring in SOLID))
    radius, horizon = rng.uniform(0.1, 0.3), rng.uniform(0.5, 3.0)
    found, gap2 = np.empty(len(walls), dtype=np.int64), np.empty(len(walls))
    seen = edges_in_reach(corner, following, *place, 2.0 * horizon + radius, found, gap2)
    lines = np.empty((len(walls), 4))
    count = 0
    for k in found[:seen]:
        count += avoid_edge(
            lines, count, k, corner, direction, previous, following, convex, *place, *velocity, radius, horizon
        )
    assert np.all(np.diff(gap2[:seen]) >= 0.0)
    facing = [
        k for k in range(len(walls)) if np.linalg.det([walls.start[k] - place, walls.end[k] - walls.start[k]]) < 0.0
    ]
    assert set(found[:seen].tolist()) <= set(facing)
    assume(min(time_to_segment(*place, 0.0, 0.0, radius, *walls.start[k], *walls.end[k]) for k in facing) > 0.0)
    tried = rng.uniform(-2.0, 2.0, (200, 2))
    for v in tried[[np.hypot(*v) <= 2.0 and left_of(lines[:count], v) <= 0.0 for v in tried]]:
        for k in facing:
            assert time_to_segment(*place, *v, radius, *walls.start[k], *walls.end[k]) >= horizon - 1e-3


@settings(max_examples=15, deadline=None, derandomize=True)
@given(seed=st.integers(0, 10_000), turn=st.floats(-3.0, 3.0), x=st.integers(-64, 64), mirror=st.booleans())
def test_turning_shifting_and_mirroring_the_scene(seed, turn, x, mirror):
    walls = [ROOM, PILLAR, SCREEN]
    scene = crowd(seed, A=8, walls=walls)
    there = moved(scene, walls, turn, (x, -0.5 * x), mirror)
    expected = moved(scene.replace(velocity=ORCA().velocity(scene, 0.1)), walls, turn, (x, -0.5 * x), mirror).velocity
    error = np.abs(ORCA().velocity(there, 0.1) - expected).max(axis=-1)
    # a program that is only just feasible may be decided by rounding
    assert np.mean(error < 1e-6) >= 7 / 8


def facing(offset, **more):
    return Scene.of(
        [[-4.0, 0.0], [4.0, offset]],
        [[1.3, 0.0], [-1.3, 0.0]],
        preferred_velocity=[[1.3, 0.0], [-1.3, 0.0]],
        radius=0.25,
        **more,
    )


def gaps(scene, model, steps=80, dt=0.1):
    closest = np.inf
    for _ in range(steps):
        scene = model.step(scene, dt)
        closest = min(closest, float(np.hypot(*(scene.position[0, 0] - scene.position[0, 1]))))
    return closest, scene


def test_two_who_meet_pass_without_contact():
    closest, scene = gaps(facing(0.1), ORCA())
    assert closest >= 0.5 - 1e-6
    assert scene.position[0, 0, 0] > 4.0
    assert scene.position[0, 1, 0] < -4.0
    sideways = np.abs(scene.position[0, :, 1] - [0.0, 0.1])
    assert sideways[0] == pytest.approx(sideways[1], abs=1e-6)  # both took half


def test_who_meets_a_robot_takes_the_whole_change():
    closest, scene = gaps(facing(0.1, external=[False, True]), ORCA())
    assert closest >= 0.5 - 1e-6
    assert scene.position[0, 1].tolist() == pytest.approx([4.0 - 80 * 0.13, 0.1])
    together = ORCA().velocity(facing(0.1), 0.1)[0, 0]
    alone = ORCA().velocity(facing(0.1, external=[False, True]), 0.1)[0, 0]
    assert alone - [1.3, 0.0] == pytest.approx(2.0 * (together - [1.3, 0.0]))


def test_nobody_walks_through_a_wall():
    walls = [[(3.0, -5.0), (3.2, -5.0), (3.2, 5.0), (3.0, 5.0)]]
    scene = Scene.of([[0.0, 0.0]], preferred_velocity=[[1.3, 0.4]], radius=0.25, walls=walls)
    for _ in range(60):
        scene = ORCA().step(scene, 0.1)
        assert scene.position[0, 0, 0] <= 2.75 + 1e-6
    assert scene.position[0, 0, 0] > 2.6
    assert scene.velocity[0, 0, 1] == pytest.approx(0.4, abs=1e-3)  # along the wall he goes on


def test_the_parameters_do_something():
    scene = crowd(0, A=20, width=6.0)
    usual = ORCA().velocity(scene, 0.1)
    for changed in (
        *(ORCA(neighbor_distance=1.0), ORCA(max_neighbors=1), ORCA(time_horizon=0.5), ORCA(time_horizon_walls=0.2)),
        ORCA(max_speed=0.3),
    ):
        assert not np.array_equal(changed.velocity(scene, 0.1), usual)
    assert np.linalg.norm(ORCA(max_speed=0.3).velocity(scene, 0.1), axis=-1).max() <= 0.3 + 1e-9
    assert np.array_equal(ORCA(max_neighbors=9.6).velocity(scene, 0.1), usual)  # rounded to 10
    alone = ORCA(max_neighbors=0).velocity(scene.replace(walls=Walls.of()), 0.1)
    assert np.allclose(alone, scene.desired_velocity(0.1))


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf, np.array([1.0, np.nan])])
def test_a_bad_maximum_speed(value):
    with pytest.raises(InputError, match=r"ORCA: max_speed = (-1\.0|nan|inf) \[m/s\] is not allowed"):
        ORCA(max_speed=value)


@pytest.mark.parametrize("given", [False, True])
@pytest.mark.parametrize("own", [False, True])
def test_small_crowds_step_as_in_a_large_batch_to_the_bit(given, own):
    rng = np.random.default_rng(5)
    shape = E, A = 70, 9
    model = ORCA(reciprocal=own)
    if own:
        numbers = {"neighbor_distance": rng.uniform(0.5, 6.0, shape), "max_neighbors": rng.uniform(0.0, 12.0, shape)}
        model = ORCA(**numbers, time_horizon=rng.uniform(0.5, 3.0, shape), max_speed=rng.uniform(0.5, 2.0, shape))
    wish = {"preferred_velocity": rng.normal(size=(E, A, 2))} if given else {"goal": rng.uniform(-4, 4, (E, A, 2))}
    scene = Scene.of(
        rng.uniform(-2.5, 2.5, (E, A, 2)), rng.normal(size=(E, A, 2)), radius=0.25, walls=[[(-1.0, 3.0), (3.0, -1.0)]],
        active=rng.random(shape) < 0.9, visible=rng.random(shape) < 0.9, external=rng.random(shape) < 0.2, **wish,
    )  # fmt: skip
    together = model.velocity(scene, 0.1)
    for e in range(0, E, 7):
        names = ("neighbor_distance", "max_neighbors", "time_horizon", "max_speed") if own else ()
        alone = dataclasses.replace(model, **{name: getattr(model, name)[e : e + 1] for name in names})
        np.testing.assert_array_equal(alone.velocity(scene.environment(e), 0.1)[0], together[e])


def test_a_small_crowd_names_the_value_that_is_not_allowed():
    scene = Scene.of([[0.0, 0.0], [1.0, 0.0]]).replace(position=np.array([[[0.0, 0.0], [2e9, 0.0]]]))
    with pytest.raises(InputError, match="position .* of agent 1 in environment 0 is not finite or larger than 1e"):
        ORCA().velocity(scene, 0.1)
    for dt in (0.0, np.nan, np.inf):
        with pytest.raises(InputError, match="time step .* is not allowed"):
            ORCA().velocity(Scene.of([[0.0, 0.0]]), dt)
