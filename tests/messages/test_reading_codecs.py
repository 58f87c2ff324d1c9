"""Codecs of readings: every class is a standard message that other tools read, and comes back as it was."""

from __future__ import annotations

import dataclasses
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crowdbot import sensors
from crowdbot.core import EpisodeError, Pose, Scene, builtin_classes
from crowdbot.messages import (
    CODECS,
    KIND,
    REST,
    MeasuredReading,
    Messages,
    codec_of,
    decode_reading,
    encode_reading,
    image_in,
    markers,
    picture_codec,
    reading_table,
    reading_topics,
)
from crowdbot.sensors import Gaussian, Lens, Reading, Sensor
from reading_comparison import same

SENSORS: dict[str, Sensor] = {
    "Scan": sensors.Lidar2D(rays=31, noise=Gaussian(0.01)),
    "PulsedScan": sensors.PulsedLidar2D(rays=31, noise=Gaussian(0.01), scan_time=0.1, beam_width=0.02, echoes=2),
    "PointCloud": sensors.Lidar3D(columns=24, noise=Gaussian(0.01)),
    "RangeReading": sensors.Ultrasound(),
    "DepthImage": sensors.DepthCamera(width=12, height=9),
    "ImuReading": sensors.IMU(rate=100.0, acceleration_noise=0.01, turn_offset=0.1),
    "Odometry": sensors.WheelOdometry(slip=0.01, ticks_per_turn=500),
    "RgbImage": sensors.RGBCamera(width=12, height=9, segmentation=True),
    "BumperReading": sensors.Bumper(radius=0.9),
    "TrackedPeople": sensors.GroundTruthPeople(),
}
"""A sensor for each class of readings; a new class needs a row here."""
SCENE = Scene.of([[1.0, 0.2], [2.5, -0.7], [-9.0, 3.0]], [[0.3, 0.1], [0.0, -1.0], [0.0, 0.0]], radius=0.3,
                 walls=[[(4.0, -9.0), (4.0, 9.0)]])  # fmt: skip
KINDS = [getattr(sensors, name) for name in sensors.__all__]
READINGS = [cls for cls in KINDS if isinstance(cls, type) and issubclass(cls, Reading) and cls is not Reading]


def back(reading: Reading, sensor: Any) -> Reading:
    """Return a reading after it was messages, as bytes."""
    make = Messages()
    found = {}
    for ending, message in encode_reading(make, MeasuredReading(reading, sensor, "robot", "robot/eye")):
        found[ending] = make.decode_message(make.encode_message(message), message.__msgtype__)
    whole = found.pop(REST)
    assert whole.__msgtype__ == KIND
    return decode_reading(whole, found)


def test_recordings_keep_the_names_of_kinds_and_fields() -> None:
    """Names in files do not change with those in Python: older recordings open, older versions read newer ones."""
    kinds, names = {}, set()
    for name, sensor in SENSORS.items():
        reading = sensor.read(SCENE, Pose.of((0.1, 0.0), 0.3), np.random.default_rng(0))
        whole = dict(encode_reading(Messages(), MeasuredReading(reading, sensor, "robot", "robot/eye")))[REST]
        kinds[name] = whole.kind
        names |= {field.name for field in whole.fields}
    unlike = {name: kind for name, kind in kinds.items() if name != kind}
    assert unlike == {
        "PointCloud": "Cloud", "RangeReading": "Echo", "ImuReading": "Inertial", "RgbImage": "Picture",
        "BumperReading": "Touch", "TrackedPeople": "Tracked",
    }  # fmt: skip
    assert "facing" in names
    assert "cos_incidence" not in names


def test_no_class_of_readings_is_forgotten() -> None:
    missing = sorted({cls.__name__ for cls in READINGS} - {cls.__name__ for cls in CODECS})
    assert not missing, f"{missing} need a row in CODECS, src/crowdbot/messages/reading_codecs.py"
    missing = sorted({cls.__name__ for cls in READINGS} - set(SENSORS))
    assert not missing, f"{missing} need a sensor in SENSORS of this file"
    assert {cls.__name__ for cls in CODECS} >= set(SENSORS)


def test_the_page_on_recordings_has_the_table_of_codecs() -> None:
    page = Path(__file__).parents[2] / "docs/reference/recording.md"
    assert reading_table() in page.read_text(encoding="utf-8"), "run python tools/fix.py readings"


def test_every_builtin_sensor_names_its_reading() -> None:
    """Bridges announce topics before the first reading, by the annotation of ``measure``."""
    silent = [name for name, kind in builtin_classes(sensors, Sensor).items() if not reading_topics(kind())]
    assert not silent, f"measure of {silent} needs a return annotation with a class of CODECS"
    for sensor in SENSORS.values():
        reading = sensor.read(SCENE, Pose.of((0.1, 0.0), 0.3), np.random.default_rng(0))
        messages = encode_reading(Messages(), MeasuredReading(reading, sensor, "robot", "robot/eye"))
        sent = {ending: message.__msgtype__ for ending, message in messages}
        assert sent.items() <= reading_topics(sensor).items()


@pytest.mark.parametrize("kind", READINGS, ids=lambda cls: cls.__name__)
@pytest.mark.parametrize("place", ["in the plane", "in space"])
def test_every_class_of_readings_comes_back(kind: type[Reading], place: str) -> None:
    sensor = SENSORS[kind.__name__]
    pose: Any = Pose.of((0.1, 0.0), 0.3)
    state = sensor.begin()
    for number in range(2):
        if place == "in space":
            pose = Pose.of((0.1 + 0.2 * number, 0.0), 0.3).to_spatial(0.7, 0.02, 0.1)
        view = sensors.SensorView(SCENE.replace(time=0.05 * number), pose)
        reading, state = sensor.measure(view, state, np.random.default_rng(number))
        assert type(reading) is kind
        read = back(reading, sensor)
        assert type(read) is kind
        assert read.time == reading.time
        assert (read.pose.position == reading.pose.position).all()
        same(read, reading, kind.__name__)
        same(back(read, sensor), read, "a second time")
    with np.errstate(invalid="ignore"):
        assert any(np.any(np.asarray(getattr(reading, f.name)) != 0) for f in dataclasses.fields(reading)[2:])


def test_a_sensor_of_ones_own_may_give_these_readings() -> None:
    @dataclasses.dataclass(frozen=True)
    class Warm(sensors.RangeReading):
        pass

    own = types.SimpleNamespace(rate=5.0)
    reading = Warm(1.0, Pose.of((0.0, 0.0), 0.0), np.array([1.5]), np.array([3]), np.array([-1]), np.ones((1, 3)))
    assert codec_of(Warm) is CODECS[sensors.RangeReading]
    read = back(reading, own)
    assert type(read) is sensors.RangeReading
    assert read.ranges.tolist() == [1.5]
    with pytest.raises(
        EpisodeError, match=r"returns a Reading, which has no ROS message; return one of Scan, PointCloud"
    ):
        codec_of(Reading, "robot/eye")


@dataclasses.dataclass(frozen=True)
class Colours(Reading):
    """What a colour camera gives."""

    rgb: Any
    lens: Lens
    hit: Any


def test_pictures_are_images_with_their_lens(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CODECS, Colours, picture_codec)
    rgb = np.random.default_rng(0).integers(0, 256, (1, 6, 8, 3), dtype=np.uint8)
    lens = Lens.of(8, 6, 1.0, (0.1, 0.0, 0.0, 0.0, 0.01))
    picture = Colours(0.5, Pose.of((0.0, 0.0), 0.0).to_spatial(1.0), rgb, lens, np.full((1, 6, 8), -1))
    make = Messages()
    messages = dict(encode_reading(make, MeasuredReading(picture, None, "robot", "robot/eye")))
    assert (messages["/image"].encoding, messages["/image"].step) == ("rgb8", 24)
    assert messages["/image"].header.frame_id == "robot/eye_optical"
    assert bytes(messages["/image"].data) == rgb.tobytes()
    read = back(picture, None)
    same(read, picture, "picture")
    assert read.lens == lens  # type: ignore[attr-defined]
    bare = dataclasses.replace(picture, hit=None)
    assert "/labels" not in dict(encode_reading(make, MeasuredReading(bare, None, "robot", "robot/eye")))
    assert back(bare, None).hit is None  # type: ignore[attr-defined]
    ((parent, child, turn),) = picture_codec.frames("robot", "robot/eye")
    assert (parent, child) == ("robot/eye", "robot/eye_optical")
    assert np.allclose(turn.matrix[0], [[0, 0, 1], [-1, 0, 0], [0, -1, 0]])


def test_pixels_and_points_are_little_endian() -> None:
    make = Messages()
    for name, endings in {"DepthImage": ("/image", "/labels"), "PointCloud": ("",), "BumperReading": ("",)}.items():
        reading = SENSORS[name].read(SCENE, Pose.of((0.1, 0.0), 0.3), np.random.default_rng(0))
        messages = dict(encode_reading(make, MeasuredReading(reading, SENSORS[name], "robot", "robot/eye")))
        for ending in endings:
            assert not messages[ending].is_bigendian, name
    camera = SENSORS["DepthImage"]
    depth: Any = camera.read(SCENE, Pose.of((0.1, 0.0), 0.3), np.random.default_rng(0))
    image = dict(encode_reading(make, MeasuredReading(depth, camera, "robot", "robot/eye")))["/image"]
    assert np.array_equal(image_in(image), depth.depth[0].astype("<f4"))


def test_a_viewer_gets_a_body_for_each_agent_in_distinct_colours() -> None:
    scene = SCENE.replace(external=np.array([[True, False, False]]), active=np.array([[True, True, False]]))
    shown = Messages().decode_message(
        markers(0, scene, np.array([7, 8, 9]), [(1.0, 2.0, 0.3)]), "visualization_msgs/msg/MarkerArray"
    )
    colours = {
        tuple(round(part, 2) for part in (marker.color.r, marker.color.g, marker.color.b)) for marker in shown.markers
    }
    assert {(0.9, 0.6, 0.0), (0.0, 0.45, 0.7), (0.0, 0.62, 0.45)} <= colours
