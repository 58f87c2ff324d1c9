"""The headway layer: the speed by the space ahead, over any model."""

from __future__ import annotations

import copy
import pickle
from dataclasses import dataclass

import numpy as np
import pytest
from model_crowds import crowd

import crowdbot.models as room
from crowdbot.core import InputError, Paper, Scene, builtin_classes, find_class, from_attributes, parameters, stream
from crowdbot.models import ORCA, CollisionFreeSpeed, CrowdModel, Mixture, People, PowerLaw, with_headway
from crowdbot.models.model import begin_step

LAYER = [row.name for row in parameters(room.HeadwayLayer)]
BASES = [
    kind
    for name, kind in builtin_classes(room, room.CrowdModel).items()
    if name not in ("mixture", "people", "cost-model")
]


def file(*x: float, speed: float = 0.0, wish: float = 1.3, radius: float = 0.2) -> Scene:
    """Return people behind each other on the x axis, who walk along it."""
    places = [(item, 0.0) for item in x]
    return Scene.of(
        places, [(speed, 0.0)] * len(x), radius=radius, preferred_speed=wish, preferred_velocity=[(wish, 0.0)] * len(x)
    )


@dataclass(frozen=True)
class Straight(CrowdModel):
    """People take their desired velocity, whatever is ahead: what is left of it is the work of the layer."""

    paper = Paper("Nobody", 2026, "Straight ahead", "Nowhere")

    def velocity(self, scene, dt, rng=None):
        return begin_step(scene, dt).desired


def speeds(scene: Scene, dt: float = 0.1, kind: type = Straight, **values: float) -> list[float]:
    velocity = with_headway(kind)(**values).velocity(scene, dt)
    return np.hypot(velocity[0, :, 0], velocity[0, :, 1]).round(9).tolist()


@pytest.mark.parametrize("kind", BASES, ids=lambda kind: kind.__name__)
def test_alone_the_layer_changes_nothing(kind):
    alone = Scene.of([[0.0, 0.0]], [[0.4, 0.1]], goal=[[9.0, 2.0]], preferred_speed=1.3)
    plain, layered = kind(), with_headway(kind)()
    assert layered.velocity(alone, 0.1).tobytes() == plain.velocity(alone, 0.1).tobytes()
    first, second = plain.step(alone, 0.1), layered.step(alone, 0.1)
    assert first.position.tobytes() == second.position.tobytes()
    assert first.heading.tobytes() == second.heading.tobytes()
    assert first.memory.keys() == second.memory.keys()


@pytest.mark.parametrize("kind", BASES, ids=lambda kind: kind.__name__)
def test_the_layer_only_slows_down_and_never_turns(kind):
    scene = crowd(3, A=24, E=2, external=np.arange(24) == 5, active=np.arange(24) != 7)
    before = kind().velocity(scene, 0.1)
    after = with_headway(kind)().velocity(scene, 0.1)
    was, now = np.hypot(*np.moveaxis(before, -1, 0)), np.hypot(*np.moveaxis(after, -1, 0))
    assert np.all(now <= was + 1e-12)
    assert np.all(np.abs(before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]) < 1e-9)
    assert np.all((before * after).sum(axis=-1) >= 0.0)
    assert np.array_equal(after[:, 5], scene.velocity[:, 5])
    assert not after[:, 7].any()


def test_the_speed_is_the_space_by_the_time_gap():
    assert speeds(file(0.0, 0.93), headway_time_gap=1.06) == [0.5, 1.3]
    assert speeds(file(0.0, 0.93), headway_time_gap=1.06, headway_spacing=0.106) == [0.4, 1.3]


def test_in_contact_people_stand():
    assert speeds(file(0.0, 0.4))[0] == 0.0
    assert speeds(file(0.0, 0.35))[0] == 0.0


def test_nobody_walks_into_the_person_ahead_within_a_step():
    # the gap of 1 cm allows 0.1 m/s for 0.1 s, whatever the time gap
    assert speeds(file(0.0, 0.41), headway_time_gap=0.01)[0] <= 0.1 + 1e-9


def test_who_is_beside_or_behind_does_not_matter():
    beside = Scene.of([[0, 0], [0, 0.45], [-0.45, 0]], radius=0.2, preferred_velocity=[[1.3, 0]] * 3)
    assert speeds(beside)[0] == pytest.approx(speeds(beside, headway_time_gap=2.0)[0])


def test_a_narrow_corridor_lets_people_walk_past():
    scene = Scene.of([[0, 0], [0.7, 0.3]], radius=0.2, preferred_velocity=[[1.3, 0]] * 2)
    wide, tapered, narrow = (
        speeds(scene, **values)[0] for values in ({}, {"headway_taper": 1.0}, {"headway_width": 0.7})
    )
    assert wide < tapered <= narrow == 1.3


def test_anticipation_counts_people_who_walk_ahead_and_oncoming_people_need_less():
    ahead = file(0.0, 0.8, speed=0.5)
    assert speeds(ahead, headway_anticipation=0.2)[0] == pytest.approx(0.5 / 1.06)
    towards = Scene.of([[0, 0], [0.8, 0]], [[0, 0], [-1, 0]], radius=0.2, preferred_velocity=[[1.3, 0], [-1.3, 0]])
    assert [speeds(towards, headway_oncoming=share)[0] for share in (1.0, 0.5)] == pytest.approx(
        [0.4 / 1.06, 0.8 / 1.06]
    )


def test_the_reaction_time_delays_the_limit():
    braking = [speeds(file(0.0, 0.8, speed=1.0), headway_reaction_time=tau)[0] for tau in (0.0, 0.2, 0.5)]
    assert braking[0] < braking[1] < braking[2] < 1.3
    assert braking[1] == pytest.approx(0.4 / 1.06 + (1.0 - 0.4 / 1.06) * np.exp(-0.5))


def door() -> Scene:
    """Return two people in contact who want to the same place ahead: each is in the way of the other."""
    return Scene.of(
        [[0.0, 0.2], [0.0, -0.2]], radius=0.2, preferred_velocity=[[1.0, -0.6], [1.0, 0.6]], preferred_speed=1.2
    )


def test_two_people_who_block_each_other_stand_or_slide():
    stand, slide, half = (
        with_headway(Straight)(headway_width=0.5, headway_sliding=share).velocity(door(), 0.1)[0]
        for share in (0.0, 1.0, 0.5)
    )
    assert stand == pytest.approx(0.0, abs=1e-12)
    assert slide == pytest.approx(np.array([[1.0, 0.0], [1.0, 0.0]]), abs=2e-2)
    assert half == pytest.approx(0.5 * slide, abs=2e-2)


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_who_slides_is_not_faster_and_overlaps_nobody(share):
    scene = crowd(5, A=60, E=3, external=np.zeros(60, dtype=bool))
    plain, sliding = People(headway_sliding=0.0, time_gap=0.0), People(headway_sliding=share, time_gap=0.0)
    wanted = np.linalg.norm(plain.model.velocity(scene, 0.05), axis=-1)
    before, after = scene, sliding.step(scene, 0.05)
    assert np.all(np.linalg.norm(after.velocity, axis=-1) <= wanted + 1e-9)
    assert not np.array_equal(after.velocity, plain.velocity(scene, 0.05))

    def gaps(now: Scene) -> np.ndarray:
        away = now.position[:, :, None] - now.position[:, None]
        both = now.radius[:, :, None] + now.radius[:, None] + 1e3 * np.eye(60)
        return np.linalg.norm(away, axis=-1) - both

    was, now = gaps(before), gaps(after)
    free = was > 0.2  # nobody is faster than 2 m/s in 0.05 s
    assert np.all(now[free & (was < 1e2)] > -1e-9)


def test_where_nobody_is_in_the_way_sliding_changes_nothing():
    scene = file(0.0, 0.93, 3.0)
    assert speeds(scene, headway_sliding=1.0) == speeds(scene)


def test_invisible_people_and_absent_people_are_not_ahead():
    for name in ("active", "visible"):
        scene = file(0.0, 0.8).replace(**{name: np.array([[True, False]])})
        assert speeds(scene)[0] == 1.3


def test_a_robot_ahead_counts():
    scene = file(0.0, 0.8).replace(external=np.array([[False, True]]))
    assert speeds(scene)[0] == pytest.approx(0.4 / 1.06)


def test_environments_are_independent_and_agents_are_alike():
    scene, model = crowd(4, A=30, E=3), People()
    whole = model.velocity(scene, 0.1)
    for e in range(3):
        assert np.array_equal(model.velocity(scene.environments([e]), 0.1)[0], whole[e])
    many = model.velocity(scene.environments([0] * 40), 0.1)  # in several threads
    assert np.array_equal(many, np.repeat(whole[:1], 40, axis=0))


def test_parameters_may_differ_per_agent():
    scene = file(0.0, 0.93, 5.0, 5.93)
    found = speeds(scene, headway_time_gap=np.array([1.06, 1.0, 0.53, 1.0]))
    assert found == [0.5, 1.3, 1.0, 1.3]


def test_names_and_copies():
    kind = find_class("Power-Law+headway", room, room.CrowdModel)
    assert kind is with_headway(PowerLaw)
    assert kind.__name__ == "PowerLaw+headway"
    model = from_attributes(kind, {"headway-time-gap": "0.8"})
    assert pickle.loads(pickle.dumps(model)) == model
    assert copy.deepcopy(People(headway_time_gap=0.7)) == People(headway_time_gap=0.7)
    assert [row.name for row in parameters(kind)] == [*LAYER, *(row.name for row in parameters(PowerLaw))]
    for row in parameters(kind):
        assert f"{row.name}:" in kind.__doc__


def test_bad_names_and_values_are_told():
    with pytest.raises(InputError, match="headway_taper = 1.5"):
        with_headway(ORCA)(headway_taper=1.5)
    with pytest.raises(InputError, match="headway_sliding = 1.5"):
        with_headway(ORCA)(headway_sliding=1.5)
    with pytest.raises(InputError, match="single crowd model without it"):
        find_class("people+headway", room, room.CrowdModel)
    with pytest.raises(InputError, match="single crowd model without it"):
        with_headway(Mixture)
    with pytest.raises(InputError, match="did you mean"):
        find_class("orcc+headway", room, room.CrowdModel)


@pytest.mark.parametrize("kind", [with_headway(CollisionFreeSpeed), People], ids=lambda kind: kind.__name__)
@pytest.mark.parametrize("density", [1.0, 1.6])
def test_single_file_has_a_fundamental_diagram(kind, density):
    """After 20 s on a ring, people walk as the published line says: 1 / density = 0.36 m + 1.06 s * speed."""
    length, count, dt = 10.0, round(10.0 * density), 0.05
    x = (np.arange(count) + 0.5) * length / count + stream(1, "file").uniform(-0.05, 0.05, count)
    model, gone = kind(), np.zeros(count)
    speed = np.zeros(count)
    for _ in range(400):
        copies = np.concatenate([x, x + length, x - length])
        scene = Scene.of(
            np.stack([copies, np.zeros_like(copies)], axis=1),
            np.stack([np.tile(speed, 3), np.zeros_like(copies)], axis=1),
            radius=0.2,
            preferred_speed=1.34,
            preferred_velocity=[(1.34, 0.0)] * len(copies),
        )
        speed = model.velocity(scene, dt)[0, :count, 0]
        x, gone = x + dt * speed, gone + dt * speed
    assert gone.mean() / 20.0 == pytest.approx((length / count - 0.36) / 1.06, abs=0.2)
    assert np.all(np.diff(x) > 0.39)


def head_on(offset: float = 0.0) -> Scene:
    """Return two people in contact who want to walk through each other."""
    return Scene.of(
        [(0.0, 0.0), (0.4, offset)], radius=0.2, preferred_speed=1.3, preferred_velocity=[(1.3, 0.0), (-1.3, 0.0)]
    )


def test_two_people_in_contact_head_on_step_past_each_other():
    model, scene = with_headway(Straight)(headway_sliding=1.0, headway_sidestep=0.6), head_on()
    least = np.inf
    for _ in range(60):
        scene = model.step(scene.replace(preferred_velocity=head_on().preferred_velocity), 0.05)
        least = min(least, float(np.hypot(*(scene.position[0, 0] - scene.position[0, 1]))))
    assert scene.position[0, 0, 0] > scene.position[0, 1, 0]  # they have passed
    assert least > 0.4 - 1e-9
    assert np.all(scene.position[0, 0, 1] < scene.position[0, 1, 1])  # each on the own right


def test_the_sidestep_has_its_speed_only_for_people_who_want_to_walk_the_other_way():
    model = with_headway(Straight)(headway_sliding=1.0, headway_sidestep=0.6)
    assert model.velocity(head_on(), 0.05)[0, 0].round(9).tolist() == [0.0, -0.6]
    same = head_on().replace(preferred_velocity=np.array([[(1.3, 0.0), (1.3, 0.0)]]))
    assert np.hypot(*model.velocity(same, 0.05)[0, 0]) <= 0.3 + 1e-9


def test_people_who_are_stuck_step_back_from_those_whom_they_touch_ahead():
    # three walls leave the first person no way but back
    walls = [[(-2.0, 0.2), (2.0, 0.2)], [(-2.0, -0.2), (2.0, -0.2)]]
    scene = Scene.of(
        [(0.0, 0.0), (0.4, 0.0)], radius=0.2, preferred_velocity=[(1.3, 0.0), (-1.3, 0.0)], walls=walls
    )  # fmt: skip
    stands = with_headway(Straight)(headway_sliding=1.0).velocity(scene, 0.05)
    assert np.allclose(stands, 0.0)
    back = with_headway(Straight)(headway_sliding=1.0, headway_step_back=0.2).velocity(scene, 0.05)
    assert back[0, :, 0].round(9).tolist() == [-0.2, 0.2]
    assert np.allclose(back[0, :, 1], 0.0)


def test_people_who_have_a_way_do_not_step_back():
    scene = file(0.0, 1.0)
    plain = with_headway(Straight)(headway_sliding=1.0).velocity(scene, 0.05)
    assert with_headway(Straight)(headway_sliding=1.0, headway_step_back=0.2).velocity(scene, 0.05).tobytes() == (
        plain.tobytes()
    )
