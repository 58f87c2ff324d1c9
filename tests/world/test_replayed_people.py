"""Scripts: agents that are moved along tracks, until a robot comes near."""

import numpy as np
import pytest

from crowdbot.core import InputError, Scene, Twist
from crowdbot.models import ORCA
from crowdbot.world import DifferentialDrive, PlanarWorld, ReplayedPeople, ReplayedTrack

TIME = np.array([0.5, 1.0, 2.0])
PLACE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 3.0]])


def scene(*more):
    return Scene.of([[9.0, 9.0], *more], radius=0.25, external=[False, *(True for _ in more)])


def test_somebody_is_on_the_track_from_its_beginning_to_its_end():
    world = PlanarWorld(scene(), ORCA(), {}, 0.25, script=ReplayedPeople([ReplayedTrack(0, TIME, PLACE)]))
    assert not world.scene.active[0, 0]
    expected = {0.5: [0, 0], 0.75: [0.5, 0], 1.0: [1, 0], 1.25: [1, 0.75], 1.5: [1, 1.5], 1.75: [1, 2.25], 2.0: [1, 3]}
    for k in range(1, 12):
        now = world.step({})
        there = 0.25 * k in expected
        assert bool(now.active[0, 0]) is there
        if there:
            assert now.position[0, 0] == pytest.approx(expected[0.25 * k], abs=1e-12)
            assert not now.external[0, 0]
    assert world.scene.memory["script"].tolist() == [[1.0]]


def test_velocity_and_heading_are_those_of_the_way_ahead():
    script = ReplayedPeople([ReplayedTrack(0, TIME, PLACE)])
    now = script.start(scene(), 1.0)
    assert now.velocity[0, 0].tolist() == [0.0, 3.0]
    assert now.heading[0, 0] == pytest.approx(np.pi / 2)


def test_nobody_jumps_into_a_contact_when_appearing():
    world = PlanarWorld(
        scene([-4.0, 0.0]),
        ORCA(),
        {1: DifferentialDrive()},
        0.25,
        script=ReplayedPeople([ReplayedTrack(0, TIME, PLACE)]),
    )
    for _ in range(12):
        world.step({1: Twist()})
        assert world.contacts == ()


def test_a_robot_frees_who_is_near_and_only_those_who_may():
    tracks = [ReplayedTrack(0, np.array([0.0, 9.0]), np.array([[0.0, 0.0], [9.0, 0.0]])),
              ReplayedTrack(1, np.array([0.0, 9.0]), np.array([[0.0, 2.0], [9.0, 2.0]]))]  # fmt: skip
    start = Scene.of([[0, 0], [0, 2], [5, 0.1]], radius=0.25, external=[False, False, True])
    world = PlanarWorld(start, ORCA(), {2: DifferentialDrive()}, 0.1, script=ReplayedPeople(tracks, [3.0, 0.0]))
    for _ in range(100):
        world.step({2: Twist()})
        assert world.contacts == () or world.contacts[0].other == 1
    state = world.scene.memory["script"][0]
    assert state[0] in (2.0, 3.0)
    assert state[1] == 1.0


@pytest.mark.parametrize(
    ("tracks", "release", "words"),
    [
        ([ReplayedTrack(0, np.array([1.0, 1.0]), np.zeros((2, 2)))], 0.0, "times that do not increase"),
        ([ReplayedTrack(0, np.array([1.0]), np.zeros((2, 2)))], 0.0, "must have positions"),
        ([ReplayedTrack(0, TIME, PLACE), ReplayedTrack(0, TIME, PLACE)], 0.0, "an agent has two tracks"),
        ([ReplayedTrack(0, TIME, PLACE * np.nan)], 0.0, "not finite"),
        ([ReplayedTrack(0, TIME, PLACE)], -1.0, "release = -1.0 m must be finite and at least 0"),
        ([ReplayedTrack(0, TIME, PLACE)], [1.0, 2.0], "give one value, or one per track"),
    ],
)
def test_wrong_scripts_are_told(tracks, release, words):
    with pytest.raises(InputError, match=words):
        ReplayedPeople(tracks, release)


@pytest.mark.parametrize(("distance", "visible", "state"), [(1.99, True, 2.0), (2.01, True, 1.0), (1.99, False, 1.0)])
def test_people_are_released_within_the_distance_of_a_visible_robot(distance, visible, state):
    tracks = [ReplayedTrack(0, np.array([0.0, 9.0]), np.array([[0.0, 0.0], [9.0, 0.0]]))]
    start = Scene.of([[0.0, 0.0], [0.0, distance]], external=[False, True], visible=[True, visible])
    script = ReplayedPeople(tracks, 2.0)
    now = script.start(start)
    assert now.memory["script"][0].tolist() == [state, 0.0]
    assert script.follower_mask(now)[0].tolist() == [state == 1.0, False]
    later = script.place(now, 1.0)
    if state == 2.0:
        assert later.position[0, 0].tolist() == [0.0, 0.0]
        assert later.goal[0, 0].tolist() == [2.5, 0.0]
        assert later.max_speed[0, 0] == pytest.approx(1.3 * 1.5)
        assert later.preferred_speed[0, 0] == pytest.approx(1.5)
    else:
        assert later.position[0, 0].tolist() == [1.0, 0.0]


def test_released_people_leave_at_the_end_of_their_track():
    tracks = [ReplayedTrack(0, np.array([0.0, 3.0]), np.array([[0.0, 0.0], [3.0, 0.0]]))]
    start = Scene.of([[0.0, 0.0], [0.0, 1.0]], external=[False, True])
    script = ReplayedPeople(tracks, 2.0)
    free = script.start(start)
    near = free.replace(position=np.array([[[2.75, 0.0], [0.0, 1.0]]]))
    assert script.place(near, 1.4).active[0].tolist() == [True, True]
    gone = script.place(near, 1.5)
    assert gone.active[0].tolist() == [False, True]
    assert gone.memory["script"][0, 0] == 3.0
