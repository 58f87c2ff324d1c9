"""Sensors and drive parameters from the Gazebo and ros2_control tags of a robot file."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from crowdbot.core import Element, InputError, parse_number


class FoundSensor(NamedTuple):
    """A sensor: name, link, attributes of ``<sensor>`` in robot.xml,
    and where it is from; without attributes it is left out."""

    name: str
    link: str
    attributes: dict[str, str]
    source: str


class DriveParameters(NamedTuple):
    """Numbers of drive plugins and controllers.

    Fields:
        plugins: names of plugins.
        values: numbers by name.
        sources: where each number is from; that of the drive plugin if left out.
        others: what a place that does not count gives instead, by name.
    """

    plugins: tuple[str, ...]
    values: dict[str, float]
    sources: Mapping[str, str] = MappingProxyType({})
    others: Mapping[str, str] = MappingProxyType({})

    def extend(self, plugins: tuple[str, ...], values: Mapping[str, float], source: str) -> DriveParameters:
        """Return the parameters with those of a controller, which come first."""
        sources = {**self.sources, **dict.fromkeys(values, source)}
        others = dict(self.others)
        for name, value in values.items():
            old = self.values.get(name, value)
            if not math.isclose(old, value, rel_tol=SAME):
                others[name] = f"{self.sources.get(name, 'the drive plugin')} has {old:.4g}"
        return DriveParameters((*plugins, *self.plugins), {**self.values, **values}, sources, others)


SAME = 0.01
"""Largest relative difference of two values that are the same, rounded."""
NAMES = {
    "track": ("wheelSeparation", "wheel_separation", "wheelseparation", "kingpin_width"),
    "radius": ("wheel_radius", "wheelRadius"),
    "diameter": ("wheelDiameter", "wheel_diameter"),
    "max_acceleration": ("wheelAcceleration", "max_linear_acceleration", "max_acceleration", "max_wheel_acceleration"),
    "max_turn_acceleration": ("max_angular_acceleration",),
    "max_speed": ("max_linear_velocity", "max_velocity", "maxVelocity", "max_speed"),
    "max_turn_rate": ("max_angular_velocity",),
    "effort": ("torque", "wheelTorque", "max_wheel_torque"),
    "max_steering": ("steering_limit", "max_steer"),
    "wheelbase": ("wheel_base", "wheelbase"),
}


SENSING = re.compile(
    r"(?<![a-z])(ir|imu|gps|opcode|camera|laser|lidar|ray|sonar|range|bumper|contact|sensor)s?(?![a-z])"
)
"""Words in the names of plugins that measure, such as the omnidirectional infrared receiver of Create 3."""


def _walk(element: Element) -> Iterator[Element]:
    yield element
    for child in element.children:
        yield from _walk(child)


def _text(element: Element | None, *path: str) -> str:
    for tag in path:
        element = None if element is None else next(iter(element.each(tag)), None)
    return "" if element is None else element.stray


def _number(element: Element | None, *path: str) -> float | None:
    try:
        return parse_number(_text(element, *path))
    except InputError:
        return None


def read_drive_parameters(root: Element) -> DriveParameters:
    """Return the plugins that move the base, and their numbers above 0."""
    plugins: list[str] = []
    values: dict[str, float] = {}
    for plugin in [item for outer in root.each("gazebo") for item in outer.each("plugin")]:
        name = f"{plugin.attributes.get('filename', '')} {plugin.attributes.get('name', '')}".strip()
        words = ("drive", "move", "ackermann", "mecanum", "omni", "steer")
        if not any(word in name.lower() for word in words) or SENSING.search(name.lower()):
            continue
        plugins.append(name)
        for key, names in NAMES.items():
            for inner in (child for child in plugin.children if child.tag in names):
                number = _number(inner)
                if number is not None and number > 0.0:
                    values.setdefault(key, number)
    if "diameter" in values:
        values.setdefault("radius", 0.5 * values["diameter"])
    return DriveParameters(tuple(plugins), values)


def find_sensors(root: Element) -> list[FoundSensor]:
    """Return the sensors of ``<gazebo reference=...><sensor>`` and of plugins that are sensors."""
    found_sensors: list[FoundSensor] = []
    for outer in root.each("gazebo"):
        link = outer.attributes.get("reference", "")
        for sensor in outer.each("sensor"):
            found_sensors += _sensor(sensor, link)
        for plugin in outer.each("plugin"):
            name = plugin.attributes.get("filename", "") or plugin.attributes.get("name", "")
            if "imu" in name.lower() and _text(plugin, "bodyName"):
                found_sensors.append(_imu_plugin(plugin, name))
    unique: list[FoundSensor] = []
    for one in found_sensors:
        used = [other.name for other in unique]
        name = one.name
        while name in used:
            name = f"{name}_{len(unique)}"
        unique.append(one._replace(name=name))
    return unique


LINK_NAMES = {
    "lidar2d": r"(?:^|_)(?:scan|laser|lidar|lds|rplidar|hokuyo)\d*(?:_(?:link|frame))?$",
    "imu": r"(?:^|_)imu\d*(?:_(?:link|frame))?$",
}
"""Names of links on which a sensor is guessed, by type of sensor."""
COMMON = {
    "lidar2d": {"rays": "360", "range-min": "0.1", "range-max": "10", "rate": "10"}, "imu": {"rate": "100"},
}  # fmt: skip


def guess_sensors(links: Sequence[str], found: Sequence[FoundSensor]) -> list[FoundSensor]:
    """Return sensors after which links are named, one of each type that the file does not describe.

    >>> [one.link for one in guess_sensors(["base_link", "base_scan", "imu_link"], [])]
    ['base_scan', 'imu_link']
    """
    types = {one.attributes.get("type", "").replace("-3d", "-2d") for one in found}
    guesses = []
    for kind, pattern in LINK_NAMES.items():
        link = next((name for name in links if re.search(pattern, name.lower())), None)
        if link is not None and kind not in types:
            name = "scan" if kind == "lidar2d" else "imu"
            used = [one.name for one in found]
            name = name if name not in used else f"{name}_guess"
            guesses.append(FoundSensor(name, link, {"type": kind, **COMMON[kind]}, f"name of the link {link[:60]!r}"))
    return guesses


def _sensor(sensor: Element, link: str) -> list[FoundSensor]:
    kind, name = sensor.attributes.get("type", ""), _name(sensor.attributes.get("name", "") or link)
    shared = _pose(sensor)
    rate = _number(sensor, "update_rate")
    if rate is not None and 0.0 < rate <= 1000.0:
        shared["rate"] = f"{rate:g}"
    source = f"<sensor type={kind[:30]!r}> of {link[:60]!r}"
    made: dict[str, str] = {}
    if kind in ("ray", "gpu_ray", "lidar", "gpu_lidar"):
        made = _lidar(sensor, shared)
    elif kind in ("camera", "wideanglecamera", "depth", "depth_camera", "rgbd_camera", "multicamera"):
        deep = "depth" in kind or "rgbd" in kind or _has_plugin(sensor, "openni", "depth", "realsense")
        made = _camera(sensor, "depth-camera" if deep else "rgb-camera")
        if deep and kind != "depth_camera":
            color = FoundSensor(f"{name}_rgb", link, _camera(sensor, "rgb-camera") | shared, source)
            return [FoundSensor(name, link, made | shared, source), color]
    elif kind == "imu":
        made = {"type": "imu"}
    elif kind in ("sonar", "ultrasonic"):
        made = _sonar(sensor)
    return [FoundSensor(name, link, made | shared if made else {}, source)]


def _name(text: str) -> str:
    plain = "".join(letter if letter.isalnum() or letter in "_-" else "_" for letter in text)[:60].strip("_")
    return plain if plain and plain[0].isalpha() else f"sensor_{plain}"


def _has_plugin(sensor: Element, *words: str) -> bool:
    names = [f"{item.attributes.get('filename', '')}".lower() for item in sensor.each("plugin")]
    return any(word in name for name in names for word in words)


def _pose(element: Element) -> dict[str, str]:
    words = _text(element, "pose").split()
    try:
        values = [parse_number(word) for word in words]
    except InputError:
        return {}
    keys = ("x", "y", "z", "roll", "pitch", "yaw")
    return {key: f"{value:g}" for key, value in zip(keys, values, strict=False) if value} if len(values) == 6 else {}


def _lidar(sensor: Element, shared: dict[str, str]) -> dict[str, str]:
    ray = next((item for tag in ("ray", "lidar") for item in sensor.each(tag)), None)
    samples = _number(ray, "scan", "horizontal", "samples") or 360.0
    low = _number(ray, "scan", "horizontal", "min_angle")
    high = _number(ray, "scan", "horizontal", "max_angle")
    near, far = _number(ray, "range", "min"), _number(ray, "range", "max")
    single = low is not None and low == high
    low, high = (-math.pi if low is None else low), (math.pi if high is None else high)
    if not high > low or high - low > 2.0 * math.pi + 0.01:
        low, high = -math.pi, math.pi
    reach = {"range-min": f"{max(near or 0.05, 0.0):g}", "range-max": f"{max(far or 10.0, (near or 0.05) + 0.1):g}"}
    rows = _number(ray, "scan", "vertical", "samples") or 1.0
    message = _message(sensor)
    if not message and rows < 1.5 and samples < 1.5:
        message = "infrared"  # one beam measures one distance
    if message in ("ultrasound", "infrared"):
        angle = 0.0 if single or samples < 1.5 else high - low
        return _range_finder(sensor, message, angle, shared, 0.5 * (low + high)) | reach | _noise(ray)
    if rows > 1.5 and message != "scan":
        down = _number(ray, "scan", "vertical", "min_angle") or 0.0
        up = _number(ray, "scan", "vertical", "max_angle") or 0.0
        count = int(min(rows, 64))
        angles = [down + (up - down) * k / max(1, count - 1) for k in range(count)]
        values = " ".join(f"{angle:.6g}" for angle in angles)
        columns = f"{int(min(max(samples, 1), 20_000 // count))}"
        return {"type": "lidar3d", "elevations": values, "columns": columns, "azimuth-from": f"{low:.9g}",
                "azimuth-to": f"{high:.9g}", **reach}  # fmt: skip
    middle = 0.5 * (low + high)
    if abs(middle) > 1e-3:
        shared["yaw"] = f"{float(shared.get('yaw', 0.0)) + middle:.9g}"
    made = {"type": "lidar2d", "rays": f"{int(min(max(samples, 2), 4000))}"}
    made["field-of-view"] = f"{min(high - low, 2.0 * math.pi - 1e-8):.9g}"
    return made | reach | _noise(ray)


RANGE_FINDERS = ("gazebo_ros_range", "gazebo_ros_sonar", "gazebo_ros_ir")
SCANNERS = ("gazebo_ros_laser", "gazebo_ros_gpu_laser")
"""Beginnings of file names of plugins that publish sensor_msgs/Range and sensor_msgs/LaserScan."""
NARROW = math.radians(5.0)
"""Smallest opening angle of a range finder [rad]."""


def _message(sensor: Element) -> str:
    """Return what the plugin of a ray sensor publishes: ``ultrasound`` or ``infrared`` for ranges with that radiation,
    ``scan``, or nothing if the file does not say it."""
    for plugin in sensor.each("plugin"):
        output = _text(plugin, "output_type").rpartition("/")[2].lower()
        file = plugin.attributes.get("filename", "").rpartition("/")[2].removeprefix("lib")
        words = [_text(plugin, tag).lower() for tag in ("radiation_type", "radiation") if _text(plugin, tag)]
        if output == "laserscan" or (not output and file.startswith(SCANNERS)):
            return "scan"
        if output == "range" or (not output and (words or file.startswith(RANGE_FINDERS))):
            if words:
                return "ultrasound" if words[0].startswith("ultraso") else "infrared"
            # the plugins assume these if the file has no radiation
            return "infrared" if output else "ultrasound"
    return ""


def _range_finder(sensor: Element, kind: str, angle: float, shared: dict[str, str], middle: float) -> dict[str, str]:
    """Return an ultrasonic or infrared range finder with an opening angle [rad], turned to the middle of its beams."""
    if abs(middle) > 1e-3:
        shared["yaw"] = f"{float(shared.get('yaw', 0.0)) + middle:.9g}"
    wide = next((value for plugin in sensor.each("plugin") if (value := _number(plugin, "fov"))), 0.0)
    angle = min(max(angle, wide, NARROW), 2.5)
    if kind == "infrared":
        return {"type": "infrared", "dispersion": f"{0.5 * angle:.9g}"}
    ray = next((item for tag in ("ray", "lidar") for item in sensor.each(tag)), None)
    far = _number(ray, "range", "max") or 10.0
    return {"type": "ultrasound", "radius": f"{max(0.05, far * math.tan(0.5 * angle)):g}"}


def _noise(element: Element | None) -> dict[str, str]:
    spread = _number(element, "noise", "stddev")
    return {"noise": f"gaussian({spread:g})"} if spread and 0.0 < spread < 1.0 else {}


def _camera(sensor: Element, kind: str) -> dict[str, str]:
    camera = next(iter(sensor.each("camera")), None)
    width, height = _number(camera, "image", "width"), _number(camera, "image", "height")
    angle = _number(camera, "horizontal_fov")
    made = {"type": kind, "width": f"{int(min(max(width or 320, 8), 1920))}"}
    made["height"] = f"{int(min(max(height or 240, 8), 1080))}"
    made["field-of-view"] = f"{min(max(angle or 1.0, 0.05), 2.8):.9g}"
    near, far = _number(camera, "clip", "near"), _number(camera, "clip", "far")
    if kind == "depth-camera":
        made["range-min"] = f"{max(near or 0.1, 0.01):g}"
        made["range-max"] = f"{min(max(far or 10.0, (near or 0.1) + 0.1), 100.0):g}"
    return made


def _sonar(sensor: Element) -> dict[str, str]:
    sonar = next(iter(sensor.each("sonar")), None)
    near, far, radius = _number(sonar, "min"), _number(sonar, "max"), _number(sonar, "radius")
    far = far or 2.5
    near = near if near is not None and 0.0 <= near < far else 0.0
    return {"type": "ultrasound", "range-min": f"{near:g}", "range-max": f"{far:g}", "radius": f"{radius or 0.5:g}"}


def _imu_plugin(plugin: Element, name: str) -> FoundSensor:
    made = {"type": "imu"}
    rate = _number(plugin, "updateRate")
    if rate is not None and 0.0 < rate <= 1000.0:
        made["rate"] = f"{rate:g}"
    for key, tag in (("acceleration-noise", "accelGaussianNoise"), ("turn-noise", "rateGaussianNoise")):
        words = _text(plugin, tag).split()
        try:
            spread = max(0.0, parse_number(words[0])) if words else 0.0
            made |= {key: f"{spread / math.sqrt(float(made.get('rate', 10.0))):g}"} if words else {}
        except InputError:
            continue
    return FoundSensor("imu", _text(plugin, "bodyName"), made, f"the plugin {name[:60]}")
