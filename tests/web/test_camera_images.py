"""Images of camera sensors in the app: what the robot gets, at its own rate, from runs and from records."""

import io
import json
import time

import numpy as np
import pytest
from PIL import Image
from simulator_session import ready, simulator, wait_until

from crowdbot.core import InputError
from crowdbot.recording import read_episode, record
from crowdbot.simulation import Simulation
from crowdbot.trials import parse_trial
from crowdbot.web import call_command
from crowdbot.web.scene import encode_image, image_descriptions, sensor_images
from crowdbot.web.scene.camera_images import AGENTS, LABELS
from crowdbot.web.simulator.camera_feed import CameraFeed

TRIAL = """
<trial name="seen" duration="3">
  <stage walkable="-5,-3 6,-3 6,3 -5,3"/><crowd type="orca"/>
  <spawner count="3" zone="2,-2 4,-2 4,2 2,2" goal="-4,-2 -3,-2 -3,2 -4,2"/>
  <robot name="eye" type="differential" x="-3" y="0" default-sensors="false">
    <goal x="5" y="0"/><navigator type="straight"/>
    <sensor name="color" type="rgb-camera" z="1.2" width="160" height="120" rate="10" segmentation="true"/>
    <sensor name="depth" type="depth-camera" z="1.2" width="80" height="60" rate="5" range-min="0.5" range-max="6"/>
    <sensor name="scan" type="lidar2d"/>
  </robot>
</trial>
"""
COLOR, LABEL, DEPTH, DEPTH_LABEL = (
    f"eye/{item}" for item in ("color/color", "color/labels", "depth/depth", "depth/labels")
)


@pytest.fixture(scope="module")
def simulation():
    result = Simulation(parse_trial(TRIAL), 1)
    for _ in range(8):
        result.advance()
    return result


def picture(frame):
    return Image.open(
        io.BytesIO(next(frame.arrays[kind] for kind in ("jpeg", "png") if kind in frame.arrays).tobytes())
    )


def test_every_image_of_every_camera_is_described(simulation):
    found = {description["name"]: description for description in image_descriptions(simulation)}
    assert list(found) == [COLOR, LABEL, DEPTH, DEPTH_LABEL]
    assert (found[COLOR]["width"], found[COLOR]["height"], found[COLOR]["rate"]) == (160, 120, 10.0)
    assert found[COLOR]["title"] == "eye / color: colour"
    scale = found[DEPTH]["scale"]
    assert (scale["low"], scale["high"], scale["unit"]) == (0.5, 6.0, "m")
    assert set(found[LABEL]["scale"]["names"]) == {"background", "wall", "floor", "prop", "person or robot, by id"}
    assert json.loads(json.dumps(found)) == found


def test_colours_are_those_of_the_reading(simulation):
    image = sensor_images(simulation)[0]
    reading = image.sensor.reading(0)
    frame = encode_image(reading, image, "cam0", 7)
    assert (frame.channel, frame.time, int(frame.arrays["revision"][0])) == ("cam0", float(reading.time), 7)
    shown = np.asarray(picture(frame)).astype(int)
    assert shown.shape == (120, 160, 3)
    assert np.abs(shown - reading.rgb[0]).mean() < 4.0
    assert len(np.unique(reading.rgb[0].reshape(-1, 3), axis=0)) > 20  # there is something to see


def test_depth_has_its_scale(simulation):
    image = sensor_images(simulation)[2]
    reading = image.sensor.reading(0)
    shown = picture(encode_image(reading, image, "cam2"))
    index, depth = np.asarray(shown), reading.depth[0]
    assert shown.mode == "P"
    seen = np.isfinite(depth)
    assert seen.any()
    assert (index[depth == np.inf] == 1).all()
    assert np.abs((index[seen] - 2.0) / 253.0 * 5.5 + 0.5 - depth[seen]).max() < 5.5 / 500
    near = reading.__class__(
        reading.time, reading.pose, np.full((1, 2, 2), -np.inf), *[np.zeros((1, 2, 2), int)] * 2, reading.lens
    )
    assert (np.asarray(picture(encode_image(near, image, "cam2"))) == 0).all()
    assert shown.convert("RGB").getpalette() is None
    low, high = (np.array(shown.getpalette()[3 * k : 3 * k + 3]) for k in (2, 255))
    colors = image_descriptions(simulation)[2]["scale"]["colors"]
    assert [bytes(low.tolist()).hex(), bytes(high.tolist()).hex()] == [colors[0][1:], colors[-1][1:]]


def test_labels_tell_people_from_walls(simulation):
    image = sensor_images(simulation)[3]
    reading = image.sensor.reading(0)
    index = np.asarray(picture(encode_image(reading, image, "cam3")))
    hit = reading.hit[0]
    for code in np.unique(hit):
        wanted = -code - 1 if code < 0 else len(LABELS) + code % len(AGENTS)
        assert (index[hit == code] == wanted).all()
    assert (hit >= 0).any()


def test_large_images_are_thinned_out_and_other_readings_are_refused(simulation):
    image = sensor_images(simulation)[0]
    reading = image.sensor.reading(0)
    large = reading.__class__(reading.time, reading.pose, np.zeros((1, 1200, 1920, 3), np.uint8), None, reading.lens)
    assert picture(encode_image(large, image, "cam0")).size == (960, 600)
    with pytest.raises(InputError, match="eye/color/labels: a RgbImage has no such image"):
        encode_image(large, sensor_images(simulation)[1], "cam1")


def images(desk, name):
    channel = f"cam{[COLOR, LABEL, DEPTH, DEPTH_LABEL].index(name)}"
    return [frame for frame in desk.session.frames if frame.channel == channel]


def steps(desk, count):
    """Advance, and wait until it is done."""
    end = desk._status()["time"] + 0.05 * count
    desk.step(count)
    wait_until(lambda: desk._status()["time"] > end - 1e-6)


def test_a_run_sends_each_reading_once_and_only_the_chosen_images(tmp_path):
    (tmp_path / "seen.xml").write_text(TRIAL)
    with simulator(tmp_path) as desk:
        call_command(desk, "open", {"name": "seen.xml", "seed": 1, "paused": True})
        ready(desk)
        assert desk.greet()["cameras"] == []
        steps(desk, 4)
        assert [frame for frame in desk.session.frames if frame.channel.startswith("cam")] == []
        call_command(desk, "cameras", {"names": [DEPTH]})  # a run that waits shows what the robot has
        assert desk.greet()["cameras"] == [DEPTH]
        assert desk.session.latest("simulator.cameras") == [DEPTH]
        wait_until(lambda: images(desk, DEPTH))
        revision = desk.description()["revision"]
        for _ in range(20):
            steps(desk, 2)
            wait_until(lambda: not desk._cameras._waiting)
        wait_until(lambda: images(desk, DEPTH)[-1].time > 2.1)  # the last reading of 2.2 s
        found = images(desk, DEPTH)
        times = [one.time for one in found]
        assert np.diff(times) == pytest.approx(0.2)  # 5 Hz, although the time step is 0.05 s
        assert {int(one.arrays["revision"][0]) for one in found} == {revision}
        assert images(desk, COLOR) == []
        desk.show_frame()  # a new window gets the current image, too
        wait_until(lambda: images(desk, DEPTH)[-1] is not found[-1])
        assert images(desk, DEPTH)[-1].time == times[-1]
        call_command(desk, "cameras", {"names": []})
        desk.session.frames.clear()
        steps(desk, 8)
        desk.show_frame()
        assert images(desk, DEPTH) == []


def test_a_frame_of_the_run_between_a_choice_and_its_answer_sends_nothing_twice(tmp_path, monkeypatch):
    (tmp_path / "seen.xml").write_text(TRIAL)
    with simulator(tmp_path) as desk:
        call_command(desk, "open", {"name": "seen.xml", "seed": 1, "paused": True})
        ready(desk)
        steps(desk, 4)
        choose = desk._cameras.choose

        def choose_and_show(names):
            choose(names)
            desk.run.do(lambda: desk.run.view.show(always=True))  # as the run does after its step
            wait_until(lambda: images(desk, DEPTH))

        monkeypatch.setattr(desk._cameras, "choose", choose_and_show)
        call_command(desk, "cameras", {"names": [DEPTH]})
        wait_until(lambda: not desk._cameras._waiting)
        call_command(desk, "layers", {"names": ["velocities"]})
        wait_until(lambda: not desk._cameras._waiting)
        steps(desk, 4)
        wait_until(lambda: len(images(desk, DEPTH)) > 1)
        assert [frame.time for frame in images(desk, DEPTH)] == pytest.approx([0.2, 0.4])


def test_recorded_images_are_shown_from_the_records(tmp_path):
    record(parse_trial(TRIAL), 1, tmp_path / "seen.mcap")
    recorded = read_episode(tmp_path / "seen.mcap").readings["eye/color"]
    with simulator(tmp_path) as desk:
        desk.open_episode("seen.mcap")
        ready(desk)
        call_command(desk, "cameras", {"names": [COLOR]})
        for seconds in (0.5, 1.5):
            desk.seek(seconds)
            wait_until(lambda: images(desk, COLOR) and abs(images(desk, COLOR)[-1].time - seconds) < 1e-6)  # noqa: B023
            reading = next(item for item in recorded if abs(float(item.time) - seconds) < 1e-6)
            shown = np.asarray(picture(images(desk, COLOR)[-1])).astype(int)
            assert np.abs(shown - reading.rgb[0]).mean() < 4.0
        assert desk._player._run is None  # nothing was simulated


class SlowWindows:
    """Windows that are never ready, or take long."""

    def __init__(self):
        self.frames = []

    def is_ready(self):
        return False

    def show(self, frame):
        time.sleep(0.05)
        self.frames.append(frame)


@pytest.mark.live
def test_a_slow_window_never_delays_the_run(simulation):
    windows = SlowWindows()
    feed = CameraFeed(windows)
    feed.choose(frozenset([COLOR, DEPTH]))
    for _ in range(2000):
        feed.renew()
        feed.offer(simulation, 1)
    assert len(feed._waiting) <= 2  # the newest of each only
    wait_until(lambda: windows.frames)
    feed.close()
    assert len(windows.frames) < 200
    assert not feed._thread.is_alive()
    feed.choose(frozenset([DEPTH]))
    assert not feed._thread.is_alive()
