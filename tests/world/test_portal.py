"""Portals: who goes in comes out elsewhere, as somebody new, where there is room."""

import numpy as np
import pytest

from crowdbot.core import InputError, Scene, Twist
from crowdbot.models import ORCA
from crowdbot.world import DifferentialDrive, PlanarWorld, Portal

RIGHT = Portal(zone=((5, -3), (8, -3), (8, 3), (5, 3)), dx=-10.0)
LEFT = Portal(zone=((-8, -3), (-5, -3), (-5, 3), (-8, 3)), dx=10.0)


def world(start, goal, **more):
    scene = Scene.of(start, goal=goal, radius=0.25, preferred_speed=1.5, max_speed=2.0)
    return PlanarWorld(scene, ORCA(), {}, 0.1, portals=(RIGHT, LEFT), **more)


def test_who_goes_in_comes_out_with_the_same_speed_and_another_identity():
    one = world([[4.9, 1.0], [0.0, -2.0]], [[99.0, 1.0], [0.0, -2.0]])
    scene = one.step({})
    assert scene.position[0, 0] == pytest.approx([-4.95, 1.0])
    assert scene.velocity[0, 0] == pytest.approx([1.5, 0.0])
    assert one.ids.tolist() == [[2, 1]]
    assert scene.goal[0, 0].tolist() == [99.0, 1.0]


def test_who_finds_no_room_waits_at_the_gate():
    one = world([[4.9, 1.0], [-5.0, 1.1]], [[99.0, 1.0], [-5.0, 1.1]])
    one.scene = one.scene.replace(external=np.array([[False, True]]))
    for _ in range(20):
        scene = one.step({})
    assert scene.position[0, 0, 0] == pytest.approx(5.05, abs=0.05)
    assert one.ids.tolist() == [[0, 1]]
    one.scene = one.scene.replace(active=np.array([[True, False]]))
    assert one.step({}).position[0, 0, 0] < -4.0


def test_two_who_want_to_change_places_do_not_wait_for_each_other():
    one = world([[4.9, 0.0], [-4.9, 0.0]], [[99.0, 0.0], [-99.0, 0.0]])
    for _ in range(5):
        scene = one.step({})
    assert scene.position[0, 0, 0] < 0.0 < scene.position[0, 1, 0]


def test_nobody_is_placed_on_a_person_who_cannot_leave_a_portal():
    # person 0 leaves on the right for the place of person 1, whose own exit is taken by person 2
    one = world([[4.95, 0.0], [-5.2, 0.1], [4.4, 0.1]], [[99.0, 0.0], [-99.0, 0.1], [4.4, 0.1]])
    one.scene = one.scene.replace(external=np.array([[False, False, True]]))
    for _ in range(5):
        scene = one.step({})
        gap = np.hypot(*(scene.position[0, 0] - scene.position[0, 1]))
        assert gap > 0.5
    assert one.ids.tolist() == [[0, 1, 2]]
    one.scene = one.scene.replace(active=np.array([[True, True, False]]))
    for _ in range(5):
        scene = one.step({})
    assert scene.position[0, 0, 0] < 0.0 < scene.position[0, 1, 0]


@pytest.mark.parametrize("seed", range(3))
def test_a_dense_two_way_flow_goes_on_without_overlaps_at_the_portals(seed):
    rng = np.random.default_rng(seed)
    ways = np.where(np.arange(40) % 2, 1.0, -1.0)
    grid = np.stack(np.meshgrid(np.linspace(-4.7, 4.7, 8), np.linspace(-2.4, 2.4, 5)), axis=-1).reshape(-1, 2)
    start = grid + rng.uniform(-0.05, 0.05, grid.shape)
    one = world(start, np.stack([99.0 * ways, start[:, 1]], axis=-1))
    new = 40
    for _ in range(100):
        before = one.ids[0].copy()
        scene = one.step({})
        moved = one.ids[0] != before
        away = scene.position[0][:, None] - scene.position[0]
        gap = np.hypot(away[..., 0], away[..., 1]) - 0.5 + 9.0 * np.eye(40)
        assert gap[moved].min(initial=1.0) >= 0.0
        new += int(moved.sum())
    assert new > 80


def test_robots_and_absent_people_are_not_moved():
    scene = Scene.of([[5.5, 0.0], [5.5, 2.0]], external=[True, False], active=[True, False], radius=0.25)
    one = PlanarWorld(scene, ORCA(), {0: DifferentialDrive()}, 0.1, portals=(RIGHT,))
    assert one.step({0: Twist()}).position[0].tolist() == [[5.5, 0.0], [5.5, 2.0]]


def test_environments_do_not_disturb_each_other():
    start = np.array([[[4.9, 1.0]], [[0.0, 0.0]]])
    scene = Scene.of(start, goal=start + [50.0, 0.0], radius=0.25, preferred_speed=1.5)
    both = PlanarWorld(scene, ORCA(), {}, 0.1, portals=(RIGHT,))
    after = both.step({})
    assert both.ids.tolist() == [[1], [0]]
    assert after.position[:, 0, 0] == pytest.approx([-4.95, 0.15])


@pytest.mark.parametrize(
    ("way", "message"), [({}, "needs dx or dy"), ({"dx": np.inf}, "is not finite"), ({"dy": np.nan}, "is not finite")]
)
def test_a_portal_leads_elsewhere(way, message):
    with pytest.raises(InputError, match=message):
        Portal(zone=RIGHT.zone, **way)
