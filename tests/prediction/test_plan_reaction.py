"""How people react to the plan of a robot: where futures differ, where they do not, and the fit of the coefficients."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import DataError, InputError, stream
from crowdbot.data import Trajectories, Windows
from crowdbot.prediction import AnchorNet, ConstantVelocity
from crowdbot.prediction.anchor_net.own_weights import load_reaction
from crowdbot.prediction.anchor_net.plan_reaction import PlanReaction
from crowdbot.prediction.anchor_net.reaction_fit import ReactionSamples, fit_reaction
from training_crowds import REACTING_MODELS, people_encounters, robot_encounters

Maker = Callable[..., Windows]
TIME = 0.4 * np.arange(-7.0, 1.0)
AHEAD = 0.4 * np.arange(1.0, 13.0)
KNOWN = PlanReaction(np.array([0.2, 0.5, -0.6]), np.array([0.1, 0.3, 0.2]), np.array([-0.3, -0.1, -0.2]), 0.3)


def encounter(
    windows: Maker, start: tuple[float, float], drive: tuple[float, float], radius: float = 0.4, pace: float = 1.3
) -> Windows:
    """A person who walks along x, with the sway of a real one, and a robot with a plan."""
    sway = 0.03 * np.sin(np.arange(8.0))
    person = np.stack([pace * TIME, sway - sway[-1]], axis=1)
    robot = np.asarray(start) + TIME[:, None] * np.asarray(drive)
    past = windows(np.stack([person, robot], axis=1)[None], robot=np.array([[False, True]]))
    past = dataclasses.replace(past, radius=np.array([[0.25, radius]]))
    return past.with_plans({1: np.asarray(start) + AHEAD[:, None] * np.asarray(drive)})


def moved(past: Windows, samples: int = 1, **settings: object) -> np.ndarray:
    """Return by how much the reaction moves the futures of the person ``[K, 12, 2]``, before people are separated."""
    net = AnchorNet("open", contact=0.0, **settings)  # type: ignore[arg-type]
    still = dataclasses.replace(net, reaction="none")
    one, other = (which.predict(past, 12, samples).position[0, :, :, 0] for which in (net, still))
    return np.asarray(one - other)


def test_people_give_way_where_they_meet_a_robot_head_on(windows: Maker) -> None:
    left = moved(encounter(windows, (6.0, -0.3), (-0.8, 0.0)))[0]
    right = moved(encounter(windows, (6.0, 0.3), (-0.8, 0.0)))[0]
    assert left[6, 1] > 0.1
    assert right[6, 1] < -0.1
    futures = moved(encounter(windows, (6.0, -0.3), (-0.8, 0.0)), 20)
    assert np.mean(np.abs(futures[:, :, 1]).max(axis=1) > 0.02) > 0.5


def test_people_wait_for_a_robot_that_crosses_before_them(windows: Maker) -> None:
    behind = moved(encounter(windows, (3.6, -3.0), (0.0, 1.2)))[0]
    assert behind[5, 0] < -0.05
    assert abs(behind[2, 0]) < abs(behind[5, 0])


@pytest.mark.parametrize(
    ("start", "drive"), [((6.0, 3.0), (-0.8, 0.0)), ((-3.0, 0.2), (-1.0, 0.0)), ((2.0, 1.5), (1.3, 0.4))]
)
@pytest.mark.parametrize("samples", [1, 20])
def test_nobody_reacts_to_a_robot_that_stays_away(
    start: tuple[float, float], drive: tuple[float, float], samples: int, windows: Maker
) -> None:
    past = encounter(windows, start, drive)
    change = moved(past, samples)
    if samples == 1:
        assert np.all(change == 0.0)
    still = AnchorNet("open", contact=0.0, reaction="none").predict(past, 12, samples).position[0, :, :, 0]
    assert past.plan is not None
    gap = np.linalg.norm(still - past.plan[0, None, :, 1], axis=2).min(axis=1)
    assert np.all(change[gap > 2.0] == 0.0)


def test_nobody_reacts_without_a_plan_and_with_none(windows: Maker) -> None:
    past = encounter(windows, (6.0, -0.3), (-0.8, 0.0))
    assert np.any(moved(past) != 0.0)
    assert np.all(moved(dataclasses.replace(past, plan=None)) == 0.0)
    assert np.all(moved(past, reaction="none") == 0.0)


def test_people_who_stand_and_people_seen_once_do_not_move(windows: Maker) -> None:
    for pace in (0.0, 1.3):
        past = encounter(windows, (4.0, -0.2), (-0.8, 0.0), pace=pace)
        place, here = past.position.copy(), past.present.copy()
        place[0, :, 0] *= np.array([1.0, 0.0])
        if pace:
            here[0, :-1, 0] = False
        assert np.all(moved(dataclasses.replace(past, position=place, present=here)) == 0.0)


def test_people_give_way_to_a_larger_robot_more(windows: Maker) -> None:
    size = [abs(moved(encounter(windows, (6.0, -0.3), (-0.8, 0.0), radius))[0, -1, 1]) for radius in (0.2, 0.4, 0.8)]
    assert size[0] < size[1] < size[2]


@given(angle=st.floats(0.1, 6.2), x=st.floats(-50.0, 50.0), side=st.floats(-0.5, 0.5))
@settings(max_examples=10, deadline=None)
def test_reactions_turn_and_move_with_the_scene(angle: float, x: float, side: float) -> None:
    def maker(place: np.ndarray, robot: np.ndarray) -> Windows:
        here = np.ones((1, 8, 2), np.bool_)
        return Windows(place, here, np.zeros((1, 2), np.bool_), robot, np.arange(2)[None], np.arange(8)[None], 0.4,
                       "all", "made")  # fmt: skip

    past = encounter(maker, (5.0, side), (-0.8, 0.1))
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, s], [-s, c]])
    assert past.plan is not None
    other = dataclasses.replace(past, position=past.position @ turn + x, plan=past.plan @ turn + x)
    np.testing.assert_allclose(moved(other), moved(past) @ turn, atol=1e-9)
    mirror = np.array([1.0, -1.0])
    flipped = dataclasses.replace(past, position=past.position * mirror, plan=past.plan * mirror)
    np.testing.assert_allclose(moved(flipped), moved(past) * mirror, atol=0.02)  # the network is not a mirror of itself


def test_reactions_do_not_depend_on_the_batch_or_on_the_order_of_robots(windows: Maker) -> None:
    rng = stream(3)
    walk = rng.normal(0.0, 3.0, (4, 1, 5, 2)) + TIME[None, :, None, None] * rng.normal(0.0, 1.0, (4, 1, 5, 2))
    walk += rng.normal(0.0, 0.02, walk.shape)
    past = windows(walk, robot=np.tile([False, False, False, True, True], (4, 1)))
    plans = {who: walk[0, -1, who] + AHEAD[:, None] * np.array([-0.5, 0.3]) for who in (3, 4)}
    past = past.with_plans(plans)
    whole = AnchorNet("open").predict(past, 12, 20)
    for window in range(4):
        alone = AnchorNet("open").predict(past[window : window + 1], 12, 20)
        np.testing.assert_array_equal(alone.position[0], whole.position[window])
    order = np.array([0, 1, 2, 4, 3])
    assert past.plan is not None
    other = dataclasses.replace(
        past, position=past.position[:, :, order], id=past.id[:, order], plan=past.plan[:, :, order]
    )
    np.testing.assert_array_equal(
        AnchorNet("open").predict(other, 12, 20).position[:, :, :, :3], whole.position[:, :, :, :3]
    )


def test_a_longer_horizon_and_another_clock_have_the_same_reaction(windows: Maker) -> None:
    past = encounter(windows, (6.0, -0.3), (-0.8, 0.0))
    net = AnchorNet("open", contact=0.0)
    long = net.predict(past, 20).position[0, 0, :, 0]
    np.testing.assert_array_equal(long[:12], net.predict(past, 12).position[0, 0, :, 0])
    still = dataclasses.replace(net, reaction="none").predict(past, 20).position[0, 0, :, 0]
    np.testing.assert_allclose((long - still)[12:], np.tile((long - still)[11], (8, 1)), atol=1e-9)


def test_own_coefficients_come_from_a_file(windows: Maker, tmp_path: Path) -> None:
    past, file = encounter(windows, (6.0, -0.3), (-0.8, 0.0)), tmp_path / "mine.npz"
    np.savez(file, **KNOWN.numbers())
    assert not np.array_equal(moved(past, reaction=str(file)), moved(past))
    np.savez(file, **KNOWN._replace(room=0.0, lateral=np.zeros(3)).numbers())
    assert load_reaction(str(file))["reaction_room"] == 0.0
    np.savez(file, **KNOWN._replace(lateral=np.zeros(2)).numbers())
    with pytest.raises(DataError, match="mine.npz is not a file of a reaction to plans: it has .*it must have"):
        load_reaction(str(file))
    with pytest.raises(DataError, match="absent.npz does not exist"):
        AnchorNet("open", reaction=str(tmp_path / "absent.npz")).predict(past, 12)


def test_the_fit_finds_the_coefficients_of_a_known_reaction(windows: Maker, tmp_path: Path) -> None:
    rng, groups, file = stream(5), [], tmp_path / "known.npz"
    np.savez(file, **KNOWN.numbers())
    net = AnchorNet("open", contact=0.0, reaction="none")
    for _ in range(40):
        drive, when = rng.uniform(-1.2, 1.2, 2), rng.uniform(1.0, 4.0)
        start = np.array([1.3, 0.0]) * when - drive * when + rng.uniform(-0.6, 0.6, 2)
        past = encounter(windows, (float(start[0]), float(start[1])), (float(drive[0]), float(drive[1])))
        true = dataclasses.replace(net, reaction=str(file)).predict(past, 12).position[:, 0]
        future = dataclasses.replace(
            past, position=true, present=np.ones((1, 12, 2), np.bool_), frame=past.frame[:, :1] + np.arange(1, 13),
            scored=~past.robot,
        )  # fmt: skip
        groups.append(ReactionSamples.of(net, past, future, KNOWN.room))
    reaction = fit_reaction(groups, KNOWN.room)
    for one, other in zip(reaction[:3], KNOWN[:3], strict=True):
        np.testing.assert_allclose(one, other, atol=0.06)
    left = sum(np.abs(group.missed - group.displacements(reaction)).sum() for group in groups)
    assert left < 0.05 * sum(np.abs(group.missed).sum() for group in groups)


def test_a_fit_needs_people_near_a_plan_at_the_right_clock(windows: Maker) -> None:
    past = encounter(windows, (30.0, 30.0), (-0.8, 0.0))
    future = dataclasses.replace(
        past, position=np.zeros((1, 3, 2, 2)), present=np.ones((1, 3, 2), np.bool_), scored=~past.robot
    )
    group = ReactionSamples.of(ConstantVelocity(), past, future, 0.3)
    assert len(group.missed) == 0
    with pytest.raises(InputError, match="nobody comes closer than 0.3 m to the plan of a robot"):
        fit_reaction([group], 0.3)
    with pytest.raises(InputError, match="at most 12 rows of 0.4 s, not 3 of 0.1 s"):
        ReactionSamples.of(ConstantVelocity(), dataclasses.replace(past, dt=0.1), future, 0.3)


def test_simulated_encounters_have_true_plans_radii_and_speeds() -> None:
    found = robot_encounters(2, seed=3)
    assert {name.split()[0] for name in found} == set(REACTING_MODELS)
    for past, future in found.values():
        assert past.position.shape == (2, 8, 8, 2)
        assert past.plan is not None
        assert past.radius is not None
        np.testing.assert_array_equal(past.plan[:, :, 4:], future.position[:, :, 4:])
        assert np.all(np.isnan(past.plan[:, :, :4]))
        assert np.all(past.radius[:, :4] == 0.25)
        assert np.all((past.radius[:, 4:] >= 0.2) & (past.radius[:, 4:] <= 0.9))
        speed = np.linalg.norm(np.diff(future.position[:, :, 4:], axis=1), axis=3) / 0.4
        assert np.all((speed < 1e-9) | ((speed >= 0.29) & (speed <= 2.01)))
        np.testing.assert_array_equal(future.scored, ~past.robot)
    again, other = robot_encounters(2, seed=3), robot_encounters(2, seed=4)
    for name, (past, _) in found.items():
        np.testing.assert_array_equal(past.position, again[name][0].position)
        assert not np.array_equal(past.position, other[name][0].position)


def test_people_of_a_recording_are_robots_for_each_other() -> None:
    time = 0.4 * np.arange(24.0)
    x = np.concatenate([1.2 * time, 20.0 - 1.2 * time, 1.2 * time])
    y = np.concatenate([0.0 * time, 0.3 + 0.0 * time, 1.0 + 0.0 * time])
    tracks = Trajectories(
        np.repeat(np.arange(3), 24), np.tile(np.arange(24), 3), x, y, row_rate=2.5, frame_step=1, name="street"
    )
    past, future = people_encounters(tracks, every=2)
    assert past.robot.sum(axis=1).tolist() == [1] * len(past)
    assert past.plan is not None
    window, robot = np.nonzero(past.robot)
    np.testing.assert_array_equal(past.plan[window, :, robot], future.position[window, :, robot])
    scored = {int(past.id[w, r]): past.id[w][future.scored[w]].tolist() for w, r in zip(window, robot, strict=True)}
    assert scored == {0: [1], 1: [0, 2], 2: [1]}  # 0 and 2 walk together
