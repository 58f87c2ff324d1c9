"""Every drive and world of the room keeps its contract."""

import numpy as np
import pytest

from crowdbot import world as room
from crowdbot.core import Pose, Scene, Twist, builtin_classes, from_attributes
from crowdbot.models import ORCA

DRIVES = builtin_classes(room, room.Drive)
WORLDS = builtin_classes(room, room.World)


@pytest.mark.parametrize("kind", DRIVES.values(), ids=list(DRIVES))
def test_drives(kind):
    drive = from_attributes(kind, {"max-speed": "0.8"})
    assert (drive.max_speed, kind.__dataclass_params__.frozen) == (0.8, True)
    pose, twist = Pose.of(np.zeros((3, 2)), 0.2), room.Twists.of(Twist(), 3)
    after, changed = drive.step(pose, twist, Twist(0.5, 0.5), 0.1)
    assert after.position.shape == (3, 2)
    assert after.heading.shape == changed.forward.shape == changed.turn.shape == changed.left.shape == (3,)
    assert np.all(changed.forward > 0.0)
    for _ in range(100):
        after, changed = drive.step(after, changed, Twist(), 0.1)
    assert changed.at(0) == Twist()


@pytest.mark.parametrize("kind", WORLDS.values(), ids=list(WORLDS))
def test_worlds(kind):
    start = Scene.of([[0.0, 0.0], [3.0, 0.0]], goal=[[0.0, 0.0], [9.0, 0.0]], external=[True, False])
    world = kind(start, ORCA(), {0: room.DifferentialDrive()}, 0.1)
    scene = world.step({0: Twist(1.0, 0.0)})
    assert scene is world.scene
    assert scene.time == pytest.approx(0.1)
    assert scene.shape == start.shape


def test_the_room_shows_its_contracts():
    assert set(DRIVES) == {"ackermann-drive", "differential-drive", "omnidirectional", "velocity-servo"}
    assert set(WORLDS) == {"physics-world", "planar-world"}
    assert all(hasattr(room, name) for name in room.__all__)
