"""Images of camera sensors as files for the browser: colours, depth with a colour map, and labels."""

from __future__ import annotations

import io
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.sensors import DepthCamera, DepthImage, Reading, RGBCamera, RgbImage
from crowdbot.simulation import RobotControl, Simulation
from crowdbot.typing import Bytes, Floats
from crowdbot.web.state_frame import StateFrame

LARGEST = 1280
"""Largest side of an image that is sent [pixels]; of larger ones, every second pixel is sent, or every third, ..."""
QUALITY = 82
"""Quality of JPEG files."""
VIRIDIS = (
    "440154", "48186a", "472d7b", "424086", "3b528b", "33638d", "2c728e", "26828e", "21918c", "1fa088", "28ae80",
    "3fbc73", "5ec962", "84d44b", "addc30", "d8e219", "fde725",
)  # fmt: skip
"""The colour map of depth, from the farthest to the nearest."""
NEARER, BEYOND = "ffffff", "000000"
"""Colours of what is too near for the sensor, and of what is beyond its range."""
LABELS = {-1: "1c2026", -2: "8a929c", -3: "cdd2d7", -4: "b08d57"}
"""Colours of labels: background, walls, floor, and props."""
AGENTS = ("0072b2", "e69f00", "009e73", "cc79a7", "56b4e9", "d55e00")
"""Colours of people and robots, by their id; those of Okabe and Ito."""
TITLES = {"color": "colour", "depth": "depth", "labels": "labels"}


class SensorImage(NamedTuple):
    """An image that a camera sensor of a simulation makes.

    Fields:
        control: the robot.
        sensor: the mounted sensor.
        kind: ``color``, ``depth`` or ``labels``.
    """

    control: RobotControl
    sensor: Any
    kind: str

    @property
    def name(self) -> str:
        """Name: robot, sensor and kind."""
        return f"{self.control.robot.name}/{self.sensor.name}/{self.kind}"


def sensor_images(simulation: Simulation) -> list[SensorImage]:
    """Return the images of all camera sensors; a colour camera has labels if its segmentation is requested.

    >>> from crowdbot.trials import load_trial
    >>> trial = load_trial("frontal", {"robot/type": "turtlebot2"})
    >>> [one.name for one in sensor_images(Simulation(trial))]
    ['robot/kinect_depth/depth', 'robot/kinect_depth/labels']
    """
    return [
        SensorImage(control, sensor, kind)
        for control in simulation.robots
        for sensor in control.sensors
        for kind in _kinds(sensor.mount.sensor)
    ]


def _kinds(camera: Any) -> tuple[str, ...]:
    if isinstance(camera, DepthCamera):
        return "depth", "labels"
    if isinstance(camera, RGBCamera):
        return ("color", "labels") if camera.segmentation else ("color",)
    return ()


def image_descriptions(simulation: Simulation) -> list[dict[str, Any]]:
    """Return name, title, robot, kind, size [pixels], rate [Hz] and scale of each image, JSON.

    The scale of depth has ``low`` and ``high`` [m] and colours from low to high; that of labels has names and colours.
    """
    return [
        {
            "name": image.name,
            "title": f"{image.control.robot.name} / {image.sensor.name}: {TITLES[image.kind]}",
            "kind": image.kind,
            "width": image.sensor.mount.sensor.width,
            "height": image.sensor.mount.sensor.height,
            "rate": round(1e9 / image.sensor.schedule.ticks.period_ns, 3),
            "scale": _scale(image),
        }
        for image in sensor_images(simulation)
    ]


def _scale(image: SensorImage) -> dict[str, Any]:
    if image.kind == "depth":
        camera = image.sensor.mount.sensor
        colors = [f"#{item}" for item in reversed(VIRIDIS)]
        ends = {"nearer": f"#{NEARER}", "beyond": f"#{BEYOND}"}
        return {"low": camera.range_min, "high": camera.range_max, "unit": "m", "colors": colors} | ends
    if image.kind == "labels":
        names = ("background", "wall", "floor", "prop")
        found = {name: f"#{color}" for name, color in zip(names, LABELS.values(), strict=True)}
        return {"names": found | {"person or robot, by id": f"#{AGENTS[0]}"}}
    return {}


def encode_image(reading: Reading, image: SensorImage, channel: str, revision: int = 0) -> StateFrame:
    """Return an image of a reading, as the sensor has delivered it, with noise and distortion.

    Arrays: ``revision`` of the description, and the bytes of the file as ``jpeg`` (colours) or ``png``. The time is
    that of the measurement.

    Args:
        reading: reading of the sensor.
        image: which image.
        channel: channel of the frame.
        revision: number of the description.

    Raises:
        InputError: the reading is not one of this camera.

    >>> from crowdbot.trials import load_trial
    >>> simulation = Simulation(load_trial("frontal", {"robot/type": "turtlebot2"}), 1)
    >>> simulation.advance()
    >>> depth = sensor_images(simulation)[0]
    >>> frame = encode_image(depth.sensor.reading(0), depth, "cam0")
    >>> sorted(frame.arrays), frame.arrays["png"][:4].tobytes()
    (['png', 'revision'], b'\\x89PNG')
    """
    if image.kind == "color" and isinstance(reading, RgbImage):
        kind, data = "jpeg", _jpeg(_thinned(reading.rgb[0]))
    elif image.kind == "depth" and isinstance(reading, DepthImage):
        kind, data = "png", _png(_depth_index(_thinned(reading.depth[0]), image.sensor.mount.sensor), _depth_palette())
    elif image.kind == "labels" and isinstance(reading, DepthImage | RgbImage) and reading.hit is not None:
        kind, data = "png", _png(_label_index(_thinned(reading.hit[0])), [*LABELS.values(), *AGENTS])
    else:
        raise InputError(f"{image.name}: a {type(reading).__name__} has no such image")
    time = float(np.ravel(reading.time)[0])
    content: dict[str, NDArray[Any]] = {
        "revision": np.array([revision], dtype=np.uint32),
        kind: np.frombuffer(data, dtype=np.uint8),
    }
    return StateFrame(channel, time, content)


def _thinned(pixels: NDArray[Any]) -> NDArray[Any]:
    step = -(-max(pixels.shape[:2]) // LARGEST)
    return pixels[::step, ::step]


def _depth_index(depth: Floats, camera: Any) -> Bytes:
    """Return 0 where it is too near, 1 beyond the range, and 2 to 255 from the smallest to the largest range."""
    share = (np.where(np.isfinite(depth), depth, 0.0).astype(np.float64) - camera.range_min) / (
        camera.range_max - camera.range_min
    )
    index = 2.0 + np.round(253.0 * np.clip(share, 0.0, 1.0))
    return np.where(depth == np.inf, 1.0, np.where(np.isfinite(depth), index, 0.0)).astype(np.uint8)


def _depth_palette() -> list[str]:
    stops = np.array([list(bytes.fromhex(item)) for item in reversed(VIRIDIS)], dtype=np.float64)
    at = np.linspace(0.0, len(stops) - 1.0, 254)
    rows = np.stack([np.interp(at, np.arange(len(stops)), stops[:, k]) for k in range(3)], axis=1)
    return [NEARER, BEYOND, *(bytes(row).hex() for row in np.round(rows).astype(np.uint8))]


def _label_index(hit: NDArray[np.int64]) -> Bytes:
    shapes = np.clip(-hit - 1, 0, len(LABELS) - 1)
    return np.where(hit < 0, shapes, len(LABELS) + hit % len(AGENTS)).astype(np.uint8)


def _jpeg(pixels: Bytes) -> bytes:
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(stream, "JPEG", quality=QUALITY)
    return stream.getvalue()


def _png(index: Bytes, palette: list[str]) -> bytes:
    from PIL import Image

    found = Image.fromarray(np.ascontiguousarray(index))
    found.putpalette(bytes.fromhex("".join(palette)))
    stream = io.BytesIO()
    found.save(stream, "PNG", compress_level=1)
    return stream.getvalue()
