"""Uneven ground: heights, barriers, walking speed, rays, robots and people in the physics world."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Scene, Twist
from crowdbot.models import ORCA
from crowdbot.world import Ground, GroundPart, PhysicsStage, PhysicsWorld, Robot, scene_bodies
from crowdbot.world.ground.ground import PEOPLE_STEP
from crowdbot.world.physics.world import DOWNSTAIRS, UPSTAIRS, walking_speed_factor

RAMP = GroundPart(2.5, 0.0, length=3.0, width=4.0, rear=0.0, front=0.24)
TOP = GroundPart(6.0, 0.0, length=4.0, width=4.0, rear=0.24, front=0.24)

numbers = st.floats(-3.0, 3.0)
parts = st.builds(
    GroundPart,
    x=numbers,
    y=numbers,
    heading=st.floats(-4.0, 4.0),
    length=st.floats(0.1, 4.0),
    width=st.floats(0.1, 4.0),
    rear=st.floats(0.0, 2.0),
    front=st.floats(0.0, 2.0),
)


def _height(ground: Ground, x: float, y: float) -> float:
    """Return the height at a point, without kernels."""
    top = 0.0
    for part in ground.parts:
        dx, dy = x - part.x, y - part.y
        along = math.cos(part.heading) * dx + math.sin(part.heading) * dy
        across = math.cos(part.heading) * dy - math.sin(part.heading) * dx
        if abs(along) <= 0.5 * part.length and abs(across) <= 0.5 * part.width:
            share = 0.5 * (along / (0.5 * part.length) + 1.0)
            top = max(top, part.rear + share * (part.front - part.rear))
    return top


@given(st.lists(parts, max_size=4), st.lists(st.tuples(numbers, numbers), min_size=1, max_size=5))
@settings(max_examples=60, deadline=None)
def test_heights_are_those_of_the_plain_twin(some: list[GroundPart], points: list[tuple[float, float]]) -> None:
    ground = Ground(tuple(some))
    assert ground.height(points).tolist() == pytest.approx([_height(ground, x, y) for x, y in points], abs=1e-12)


@given(st.lists(parts, min_size=1, max_size=4), st.tuples(numbers, numbers), st.floats(0.0, 0.3))
@settings(max_examples=60, deadline=None)
def test_support_is_never_below_the_ground_and_continuous(
    some: list[GroundPart], point: tuple[float, float], reach: float
) -> None:
    ground, steep = Ground(tuple(some)), 2.0
    steepest = max(abs(part.slope) for part in some)
    near = np.array([point, (point[0] + 1e-4, point[1])])
    found = ground.support(near, reach, steep)
    assert found[0] >= ground.height([point])[0] - 1e-9
    assert abs(found[1] - found[0]) <= 1e-4 * (steep + 2.0 * steepest) + 1e-9


def test_the_normal_of_a_ramp_leans_against_its_rise() -> None:
    normal = Ground((RAMP,)).normal([[2.5, 0.0], [9.0, 0.0]])
    assert normal[0] == pytest.approx(np.array([-0.08, 0.0, 1.0]) / math.hypot(0.08, 1.0))
    assert normal[1].tolist() == [0.0, 0.0, 1.0]


def test_a_part_refuses_wrong_numbers() -> None:
    with pytest.raises(InputError, match="length = 0"):
        GroundPart(0.0, 0.0, length=0.0)
    with pytest.raises(InputError, match="rear = -1"):
        GroundPart(0.0, 0.0, rear=-1.0)
    with pytest.raises(InputError, match="x = nan must be finite"):
        GroundPart(math.nan, 0.0)
    with pytest.raises(InputError, match=r"expected \[..., 2\]"):
        Ground((RAMP,)).height([1.0, 2.0, 3.0])


def test_barriers_are_the_edges_that_are_too_high() -> None:
    ground = Ground((RAMP, TOP))
    low = ground.barriers(0.02, 0.1)
    # the sides of the ramp above 2 cm, three sides of the platform; not the joint between both
    assert all(len(line) == 2 for line in low)
    joint = [line for line in low if np.all(np.abs(line[:, 0] - 4.0) < 1e-6)]
    assert joint == []
    side = next(line for line in low if np.allclose(line[:, 1], -2.0) and line[:, 0].max() <= 4.0 + 1e-6)
    assert side[:, 0].min() == pytest.approx(1.0 + 0.02 / 0.08, abs=0.06)
    assert ground.people_barriers() == ()
    assert PEOPLE_STEP > 0.24


def test_steep_slopes_are_barriers_as_a_whole() -> None:
    ground = Ground((GroundPart(0.0, 0.0, length=2.0, width=1.0, rear=0.0, front=0.3),))
    assert 4 in [len(ring) for ring in ground.barriers(0.1, 0.1)]
    assert 4 not in [len(ring) for ring in ground.barriers(0.1, 0.15)]
    assert ground.barriers(1.0, 0.1) == ()  # no higher than a step


def test_people_are_slower_on_stairs_and_uphill() -> None:
    steps = [GroundPart(0.3 * k, 0.0, length=0.3, width=2.0, rear=r, front=r, stairs=True) for k, r in
             enumerate((0.17, 0.34, 0.51))]  # fmt: skip
    up, down = walking_speed_factor(Ground(tuple(steps)), np.full((2, 2), (0.3, 0.0)), np.array([[1.0, 0], [-1, 0]]))
    assert (up, down) == pytest.approx((UPSTAIRS, DOWNSTAIRS))
    assert pytest.approx((0.455, 0.518), abs=1e-3) == (UPSTAIRS, DOWNSTAIRS)
    found = walking_speed_factor(Ground((RAMP,)), np.full((3, 2), (2.5, 0.0)), np.array([[1.0, 0], [0, 1], [-1, 0]]))
    assert found.tolist() == pytest.approx([math.exp(-3.5 * 0.08), 1.0, 1.0])


def _world(robot: str, ground: Ground, people: int = 0, x: float = 0.0) -> PhysicsWorld:
    places = [[x, 0.0], *([0.0, 1.0] for _ in range(people))]
    goals = [[20.0, 0.0], *([20.0, 1.0] for _ in range(people))]
    start = Scene.of(places, goal=goals, external=[True] + [False] * people, preferred_speed=1.3, max_speed=1.7)
    return PhysicsWorld(start, ORCA(), {0: Robot.load(robot)}, 0.05, stage=PhysicsStage(ground=ground), slots=0)


CROSSING = ("cuybot", "differential", "qolo", "wheelchair")


@pytest.mark.parametrize("name", [*CROSSING, "turtlebot2"])
def test_shipped_robots_drive_up_a_ramp_of_8_percent_and_stay_level_on_top(name: str) -> None:
    world = _world(name, Ground((RAMP, TOP)))
    speed = min(0.5, Robot.load(name).drive.max_speed)  # type: ignore[attr-defined]
    for _ in range(int(5.2 / speed / 0.05)):
        world.step({0: Twist(speed, 0.0)})
    body = world.robot_body(0)
    assert world.scene.position[0, 0, 0] > 4.4
    assert body.tilt < 0.02
    level = _world(name, Ground((GroundPart(90.0, 0.0, front=0.1, rear=0.1),)))
    for _ in range(10):
        level.step({0: Twist()})
    rise = world.data.xpos[body.body][2] - level.data.xpos[level.robot_body(0).body][2]
    assert rise == pytest.approx(0.24, abs=0.01)


@pytest.mark.parametrize("name", CROSSING)
def test_shipped_robots_cross_a_threshold_of_2_cm(name: str) -> None:
    assert Robot.load(name).max_step >= 0.02
    world = _world(name, Ground((GroundPart(1.2, 0.0, length=0.1, width=4.0, rear=0.02, front=0.02),)))
    for _ in range(int(3.6 / 0.5 / 0.05)):
        world.step({0: Twist(0.5, 0.0)})
    assert world.scene.position[0, 0, 0] > 2.2


def test_robots_that_cannot_cross_2_cm_say_so() -> None:
    assert Robot.load("turtlebot2").max_step == 0.012
    assert (Robot.load("pepper").max_step, Robot.load("pepper").max_slope) == (0.0, 0.0)


def test_a_pulled_base_is_stopped_by_raised_ground() -> None:
    world = _world("pepper", Ground((GroundPart(1.5, 0.0, length=1.0, width=4.0, rear=0.05, front=0.05),)))
    for _ in range(80):
        world.step({0: Twist(0.5, 0.0)})
    assert 0.5 < world.scene.position[0, 0, 0] < 1.0


def test_a_robot_starts_on_a_platform_and_on_a_ramp() -> None:
    for x, height in ((6.0, 0.24), (2.5, 0.12)):
        world = _world("differential", Ground((RAMP, TOP)), x=x)
        world.step({0: Twist()})
        assert world.data.xpos[world.robot_body(0).body][2] == pytest.approx(height, abs=0.02)
        assert world.robot_body(0).tilt == pytest.approx(0.0 if x == 6.0 else math.atan(0.08), abs=0.02)


def test_people_walk_with_their_feet_on_the_ground_and_rise_smoothly() -> None:
    ground = Ground((RAMP, TOP, GroundPart(0.9, 1.0, length=0.1, width=1.0, rear=0.02, front=0.02)))
    world = _world("differential", ground, people=1, x=-3.0)
    last, fastest, lowest = None, 0.0, 1.0
    for _ in range(110):
        world.step({0: Twist()})
        posture = world.people.posture()
        ankle = posture.position[0, [22, 26]]
        lowest = min(lowest, float((ankle[:, 2] - ground.height(ankle[:, :2])).min()))
        pelvis = float(posture.position[0, 0, 2])
        fastest = max(fastest, abs(pelvis - (pelvis if last is None else last)))
        last = pelvis
    assert world.scene.position[0, 1, 0] > 5.0
    assert last == pytest.approx(0.9 + 0.24, abs=0.08)
    assert fastest < 0.05  # m in 0.05 s
    assert lowest > 0.03  # the ankle stays above the ground


def test_rays_hit_boxes_whose_tops_are_the_surface() -> None:
    ground = Ground((RAMP, TOP))
    scene = Scene.of([[0.0, 9.0]])
    found = scene_bodies(scene, None, {}, PhysicsStage(ground=ground))
    assert len(found.box_centre[0]) > 2
    for point in ([1.5, 0.3], [2.5, -1.0], [3.9, 0.0], [6.0, 1.0]):
        down = [_top(found, k, point) for k in range(len(found.box_centre[0]))]
        assert max(down) == pytest.approx(float(ground.height([point])[0]), abs=1e-6)


def _top(bodies: object, number: int, point: list[float]) -> float:
    """Return the largest height of a box above a point, minus infinity beside it."""
    centre, half, (w, x, y, z) = (getattr(bodies, name)[0, number] for name in ("box_centre", "box_half", "box_turn"))
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    low, high = -np.inf, np.inf
    start, way = turn.T @ (np.array([*point, 0.0]) - centre), turn.T @ np.array([0.0, 0.0, 1.0])
    for k in range(3):
        if abs(way[k]) < 1e-12:
            if abs(start[k]) > half[k]:
                return -math.inf
            continue
        one, two = sorted(((-half[k] - start[k]) / way[k], (half[k] - start[k]) / way[k]))
        low, high = max(low, one), min(high, two)
    return float(high) if low <= high else -math.inf
