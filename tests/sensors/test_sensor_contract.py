"""Every sensor and noise of the room keeps its contract."""

import dataclasses
import importlib.resources
import inspect
import math
import string

import numba
import numpy as np
import pytest
from crowds_in_space import carried_away, crowd, somewhere

from crowdbot import sensors
from crowdbot.core import InputError, Pose, Scene, builtin_classes, from_attributes, stream

SENSORS = builtin_classes(sensors, sensors.Sensor)
NOISES = builtin_classes(sensors, sensors.Noise)
EXAMPLES = {
    "gaussian": "gaussian(0.1)",
    "offset": "offset(0.2)",
    "peak": "peak(0.5, 1.0)",
    "dropout": "dropout(0.25)",
    "quantised": "quantised(0.125)",
}
RANGING = {"lidar2d", "lidar3d", "ultrasound", "infrared", "depth-camera"}


def template():
    """The sensor that ``crowdbot new sensor`` writes."""
    text = importlib.resources.files("crowdbot").joinpath("assets", "templates", "sensor.txt").read_text("utf-8")
    names = {"__name__": "template"}
    exec(string.Template(text).substitute(name="Mine"), names)
    return names["Mine"]


every_sensor = pytest.mark.parametrize("kind", [*SENSORS.values(), template()], ids=[*SENSORS, "template"])


def small(kind, **fields):
    """The sensor with few beams."""
    few = {"rays": 60, "columns": 30, "width": 16, "height": 12}
    return kind(**{name: value for name, value in few.items() if name in kind.__dataclass_fields__}, **fields)


def arrays(reading):
    """Every array of a reading, by name, those of its pose left out."""
    found = {}
    for field in dataclasses.fields(reading):
        value = getattr(reading, field.name)
        if field.name == "estimate":
            found |= {"estimate": value.position, "estimate_heading": value.heading}
        elif isinstance(value, np.ndarray) and field.name not in ("angles", "elevation", "azimuth", "beam_time"):
            found[field.name] = value
    return found


def measured(sensor, scene, pose, rng=None):
    """One reading; of sensors with state the third, after two moves."""
    state = sensor.begin()
    for step in range(3):
        there = pose.offset(0.1 * step, 0.02 * step * step, 0.0, 0.0, 0.0, 0.05 * step)
        view = sensors.SensorView(scene.replace(time=scene.time + 0.1 * step), there if step else pose)
        reading, state = sensor.measure(view, state, rng)
        if state is None:
            break
    return reading


def assert_same_bytes(one, two, rows=slice(None)):
    for name, value in arrays(one).items():
        assert value.tobytes() == np.ascontiguousarray(arrays(two)[name][rows]).tobytes(), name


@every_sensor
def test_sensors_are_frozen_and_pure(kind):
    assert dataclasses.fields(kind)
    assert kind.__dataclass_params__.frozen
    scene, pose = crowd(1, environments=2), somewhere(1, 2)
    before = scene.digest()
    reading = measured(small(kind, noise=sensors.Gaussian(0.01)), scene, pose, stream(0, "sensor"))
    assert isinstance(reading, sensors.Reading)
    assert scene.digest() == before
    assert arrays(reading)
    with pytest.raises(dataclasses.FrozenInstanceError):
        reading.time = 3.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        kind().rate = 3.0


@every_sensor
def test_a_planar_pose_is_enough(kind):
    scene, pose = (
        Scene.of(np.arange(12.0).reshape(2, 3, 2), walls=[[(-1, -1), (9, -1)]]),
        Pose.of(np.zeros((2, 2)), 0.3),
    )
    reading = small(kind).read(scene, pose)
    assert (reading.time, reading.pose) == (scene.time, pose)
    assert all(len(value) == 2 for value in arrays(reading).values())


@every_sensor
def test_sensors_are_exact_without_noise_and_need_no_generator(kind):
    scene, pose = crowd(2), somewhere(2)
    assert_same_bytes(measured(small(kind), scene, pose), measured(small(kind), scene, pose))


@every_sensor
def test_every_field_is_explained_and_read_from_text(kind):
    text = inspect.getdoc(kind) + inspect.getdoc(sensors.Sensor)
    made = kind()
    for field in dataclasses.fields(kind):
        assert field.name in text, f"{kind.__name__} does not explain {field.name}"
        value = getattr(made, field.name)
        words = " ".join(map(str, value)) if isinstance(value, tuple) else str(value).lower()
        if words and value is not None:
            assert getattr(from_attributes(kind, {field.name.replace("_", "-"): words}), field.name) == value


@every_sensor
def test_every_number_is_checked(kind):
    for field in dataclasses.fields(kind):
        if isinstance(getattr(kind(), field.name), float):
            with pytest.raises(InputError, match=field.name):
                kind(**{field.name: math.nan})
    with pytest.raises(InputError, match="delay = -0.1 s"):
        kind(delay=-0.1)


@every_sensor
def test_alone_in_a_batch_and_with_any_threads_the_bytes_are_the_same(kind):
    scene, pose = crowd(3, environments=5), somewhere(3, 5)
    sensor = small(kind, noise=(sensors.Gaussian(0.01), sensors.Peak(0.1, 0.5), sensors.Dropout(0.1)))
    most = numba.get_num_threads()
    numba.set_num_threads(1)
    single = measured(sensor, scene, pose, [stream(3, "scan", e) for e in range(5)])
    numba.set_num_threads(most)
    together = measured(sensor, scene, pose, [stream(3, "scan", e) for e in range(5)])
    assert_same_bytes(single, together)
    for e in range(5):
        place = type(pose)(pose.position[e : e + 1], pose.rotation[e : e + 1])
        alone = measured(sensor, scene.environments([e]), place, stream(3, "scan", e))
        assert_same_bytes(alone, together, slice(e, e + 1))


@every_sensor
def test_turning_and_shifting_the_world_changes_no_reading(kind):
    scene, pose = crowd(4, environments=2), somewhere(4, 2)
    there, place = carried_away(scene, pose, 0.8, np.array([3.0, -5.0]))
    one, two = arrays(measured(small(kind), scene, pose)), arrays(measured(small(kind), there, place))
    for name, value in one.items():
        if name in ("velocity", "estimate", "estimate_heading", "heading") and kind is not sensors.GroundTruthPeople:
            continue  # these are told in the world
        same = np.isclose(value, two[name], rtol=0, atol=1e-6, equal_nan=True) | (value == two[name])
        assert np.mean(same) > 0.97, name


@every_sensor
def test_hostile_scenes_give_readings_without_surprise(kind):
    scene, pose = crowd(5), somewhere(5)
    here = scene.active.copy()
    here[:, :4] = False
    holes = scene.replace(
        active=here,
        position=np.where(here[..., None], scene.position, np.nan),
        velocity=np.where(here[..., None], scene.velocity, np.inf),
        radius=np.where(here, scene.radius, np.nan),
        heading=np.where(here, scene.heading, np.nan),
    )
    assert_same_bytes(measured(small(kind), holes, pose), measured(small(kind), scene.replace(active=here), pose))
    nobody = Scene.of(np.zeros((1, 0, 2)))
    assert arrays(measured(small(kind), nobody, pose))
    inside = scene.replace(bodies=None, position=np.broadcast_to(pose.position[:, None, :2], scene.position.shape))
    for value in arrays(measured(small(kind), inside, pose.planar.to_spatial(0.3))).values():
        assert not np.isnan(np.where(np.isnan(value.astype(float)), 0.0, value)).any()


@every_sensor
def test_a_wrong_pose_is_refused(kind):
    with pytest.raises(InputError, match="the pose has 1 rows for 3 environments"):
        kind().read(crowd(0, environments=3), Pose.of((0.0, 0.0), 0.0))
    with pytest.raises(InputError, match="pose of the sensor is not finite"):
        kind().read(crowd(0), Pose.of((0.0, math.nan), 0.0))
    with pytest.raises(InputError, match="needs a random generator"):
        kind(noise=sensors.Gaussian(0.1)).read(crowd(0), Pose.of((0.0, 0.0), 0.0))


@pytest.mark.parametrize("name", sorted(RANGING - {"depth-camera"}))
def test_range_sensors_check_their_limits(name):
    kind = SENSORS[name]
    for values, message in (
        ({"range_min": -0.1}, "range_min = -0.1 m"),
        ({"range_min": 3.0, "range_max": 2.0}, "range_min the smaller one"),
        ({"range_max": math.inf}, "must be finite"),
        ({"max_incidence": 2.0}, "max_incidence = 2.0 rad"),
        ({"max_incidence": 0.0}, "max_incidence = 0.0 rad"),
        ({"resolution": 100.0}, "resolution = 100.0 m"),
        ({"columns" if name == "lidar3d" else "rays": 0}, "whole number of at least 1"),
        (
            {"columns" if name == "lidar3d" else "rays": 10**7},
            "at least 1 and at most 1000000",
        ),
    ):
        with pytest.raises(InputError, match=message):
            kind(**values)


@pytest.mark.parametrize("name", NOISES)
def test_noises(name):
    (noise,) = sensors.Noise.parse(EXAMPLES[name])
    assert isinstance(noise, NOISES[name])
    drawn = noise.draw((3, 5), stream(0, name))
    assert drawn.shape == (3, 5)
    assert drawn.tobytes() == noise.draw((3, 5), stream(0, name)).tobytes()
    assert sensors.Noise.parse(str(noise)) == (noise,)


@pytest.mark.parametrize("name", sorted(RANGING))
def test_every_noise_composes_on_every_range_sensor(name):
    sensor = small(SENSORS[name], noise=tuple(sensors.Noise.parse(" ".join(EXAMPLES.values()))))
    reading = measured(sensor, crowd(6), somewhere(6), stream(6))
    values = reading.depth if name == "depth-camera" else reading.ranges
    finite = values[np.isfinite(values)]
    assert not np.isnan(values).any()
    assert np.all((finite >= sensor.range_min) & (finite <= sensor.range_max))


def test_the_room_shows_its_contracts():
    assert set(NOISES) == set(EXAMPLES)
    assert all(hasattr(sensors, name) for name in sensors.__all__)
    assert len(set(sensors.__all__)) == len(sensors.__all__)


@every_sensor
def test_the_state_is_a_value_and_continues_the_sequence(kind):
    """The same view and state give the same reading and state again: nothing is kept in the sensor."""
    sensor, scene, pose = small(kind), crowd(7, environments=2), somewhere(7, 2)
    first, state = sensor.measure(sensors.SensorView(scene, pose), sensor.begin())
    later = sensors.SensorView(scene.replace(time=scene.time + 0.1), pose.offset(0.1, 0.0, 0.0, 0.0, 0.0, 0.2))
    one, after = sensor.measure(later, state)
    two, again = sensor.measure(later, state)
    assert_same_bytes(one, two)
    assert (after is None) == (state is None) == (again is None)
    assert_same_bytes(first, sensor.read(scene, pose))
    assert state is not None or kind not in (sensors.IMU, sensors.WheelOdometry)


@every_sensor
def test_skins_are_asked_for_in_one_way(kind):
    assert not kind().sees_skins
    assert kind().with_skins().sees_skins == ("skins" in kind.__dataclass_fields__)
    assert kind.spatial == (
        kind.__name__ in ("DepthCamera", "ExposedCamera", "Infrared", "Lidar3D", "RGBCamera", "Ultrasound")
    )
    assert kind.renders == issubclass(kind, sensors.RGBCamera)
