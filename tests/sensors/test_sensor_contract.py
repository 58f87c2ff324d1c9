"""Every sensor and noise of the room keeps its contract."""

import dataclasses

import numpy as np
import pytest

from crowdbot import sensors
from crowdbot.core import Pose, Scene, plug, stream

SENSORS = plug.built_in(sensors, sensors.Sensor)
NOISES = plug.built_in(sensors, sensors.Noise)
EXAMPLES = {"gaussian": "gaussian(0.1)", "offset": "offset(0.2)", "peak": "peak(0.5, 1.0)"}


def scene_and_pose():
    return Scene.of(np.arange(12.0).reshape(2, 3, 2), walls=[[(-1, -1), (9, -1)]]), Pose.of(np.zeros((2, 2)), 0.3)


@pytest.mark.parametrize("kind", SENSORS.values(), ids=list(SENSORS))
def test_sensors(kind):
    assert dataclasses.fields(kind)
    assert kind.__dataclass_params__.frozen
    scene, pose = scene_and_pose()
    before = scene.digest()
    reading = kind(noise=sensors.Gaussian(0.01)).measure(scene, pose, stream(0, "sensor"))
    assert isinstance(reading, sensors.Reading)
    assert (reading.time, reading.pose) == (scene.time, pose)
    assert scene.digest() == before
    with pytest.raises(dataclasses.FrozenInstanceError):
        reading.time = 3.0


@pytest.mark.parametrize("name", NOISES)
def test_noises(name):
    (noise,) = sensors.Noise.parse(EXAMPLES[name])
    assert isinstance(noise, NOISES[name])
    drawn = noise.draw((3, 5), stream(0, name))
    assert drawn.shape == (3, 5)
    assert drawn.tobytes() == noise.draw((3, 5), stream(0, name)).tobytes()
    assert sensors.Noise.parse(str(noise)) == (noise,)


def test_the_room_shows_its_contracts():
    assert "lidar2d" in SENSORS
    assert set(NOISES) == set(EXAMPLES)
    assert all(hasattr(sensors, name) for name in sensors.__all__)
