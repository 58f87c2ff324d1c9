"""Calibration, odometry and frames of a robot's camera, read from files."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, Pose, SpatialPose, import_optional, parse_yaml
from crowdbot.data import Recording
from crowdbot.sensors import Lens
from crowdbot.typing import Floats

LARGEST = 1_000_000
"""Largest size of a file of calibration [bytes]."""
LARGEST_NUMBER = 1e9
"""Largest number of a calibration: no image, focal length or place is larger."""
MOST_ROWS = 10_000_000
"""Largest number of rows of odometry."""
MOUNT = ("x", "y", "z", "roll", "pitch", "yaw")


@dataclass(frozen=True)
class CameraCalibration:
    """A camera on a robot.

    Fields:
        lens: the intrinsics.
        mount: x, y, z [m], roll, pitch, yaw [rad] of the camera on the robot; x of the camera points ahead.
    """

    lens: Lens
    mount: tuple[float, float, float, float, float, float]

    def pose(self, robot: Pose) -> SpatialPose:
        """Return the pose of the camera in the world."""
        return robot.to_spatial(0.0).offset(*self.mount)


@dataclass(frozen=True)
class RobotOdometry:
    """Poses of a robot: ``time [N]`` [s], ``position [N, 2]`` [m], ``heading [N]`` [rad], not wrapped."""

    time: Floats
    position: Floats
    heading: Floats

    def at(self, time: float) -> Pose:
        """Return the pose at a time [s], interpolated; the first or the last one outside."""
        x, y, turn = (float(np.interp(time, self.time, item)) for item in (*self.position.T, self.heading))
        return Pose.of((x, y), turn)


@dataclass(frozen=True)
class TruePaths:
    """Rows of time [s], x and y [m] of each person, in the order of time."""

    rows: dict[int, Floats]

    def at(self, time: float) -> dict[int, tuple[float, float]]:
        """Return the places of those who are there at a time [s], interpolated between their rows."""
        result = {}
        for who, rows in self.rows.items():
            if rows[0, 0] - 1e-6 <= time <= rows[-1, 0] + 1e-6:
                result[who] = tuple(float(np.interp(time, rows[:, 0], rows[:, k])) for k in (1, 2))
        return result  # type: ignore[return-value]


def read_camera(file: Path | str) -> CameraCalibration:
    """Read a calibration of ROS (``camera_info`` as YAML) with the pose of the camera on the robot under ``mount``.

    Raises:
        DataError: the file cannot be read, or a value is missing or wrong.
    """
    path = Path(file)
    try:
        if path.stat().st_size > LARGEST:
            raise DataError(f"{path}: a calibration has at most {LARGEST / 1e6:g} MB")
        whole = parse_yaml(path.read_text(encoding="utf-8"), path.name)
    except (OSError, UnicodeDecodeError, InputError) as error:
        raise DataError(f"{path} cannot be read as a calibration: {error}") from None
    if not isinstance(whole, dict):
        raise DataError(f"{path}: a calibration must be a mapping with image_width, image_height and camera_matrix")
    model = whole.get("distortion_model", "plumb_bob")
    if model != "plumb_bob":
        raise DataError(f"{path}: distortion_model = {_cut(model)} is not supported, it must be plumb_bob")
    matrix = _numbers(path, whole, "camera_matrix", 9)
    bend = _numbers(path, whole, "distortion_coefficients", 5) if "distortion_coefficients" in whole else [0.0] * 5
    width, height = (_whole(path, whole, name) for name in ("image_width", "image_height"))
    mount = whole.get("mount")
    if not isinstance(mount, dict) or not {"x", "y", "z"} <= set(mount) <= set(MOUNT):
        raise DataError(f"{path}: mount must have x, y, z [m], and may have roll, pitch and yaw [rad]")
    place: Any = tuple(_number(path, mount, name) if name in mount else 0.0 for name in MOUNT)
    if not place[2] > 0.0:
        raise DataError(f"{path}: mount z = {place[2]} m must be above 0, the camera is above the floor")
    distortion: Any = tuple(bend)
    try:
        lens = Lens(width, height, matrix[0], matrix[4], matrix[2], matrix[5], distortion)
    except InputError as error:
        raise DataError(f"{path}: {error}") from None
    return CameraCalibration(lens, place)


def read_odometry(file: Path | str) -> RobotOdometry:
    """Read the poses of a robot, a CSV file with the columns time [s], x, y [m] and heading [rad].

    Raises:
        DataError: the file cannot be read, a column is missing, or times do not grow.
    """
    rows = _read_rows(Path(file), ("time", "x", "y", "heading"), "odometry")
    if not (np.diff(rows[:, 0]) > 0.0).all():
        raise DataError(f"{file}: the times of odometry must grow")
    return RobotOdometry(rows[:, 0], rows[:, 1:3], np.unwrap(rows[:, 3]))


def read_true_paths(file: Path | str | Recording) -> TruePaths:
    """Read the true paths of people at the times of the clock of the file.

    Args:
        file: a recording in any format of :func:`crowdbot.data.load`, such as a CSV file with the columns id, time [s],
            x and y [m]; a :class:`crowdbot.data.Recording` says how it is read.

    Raises:
        DataError: the file cannot be read, or is in pixels without a scale.
    """
    recording = file if isinstance(file, Recording) else Recording(str(file), agents="all")
    tracks = recording.original
    if tracks.units != "m":
        raise DataError(f"{recording.path} is in pixels; give --scale METRES or --homography FILE")
    rows = np.column_stack([tracks.clock, tracks.position])
    people = [who for who in tracks.ids.tolist() if who not in tracks.robots]
    return TruePaths({who: rows[tracks.id == who] for who in people})


def _read_rows(path: Path, names: tuple[str, ...], what: str) -> Floats:
    """Return the columns ``names`` of a CSV file, ``[N, C]``."""
    try:
        with path.open(encoding="utf-8-sig") as lines:
            head = [word.strip().lower() for word in lines.readline().split(",")]
            missing = [name for name in names if name not in head]
            if missing:
                raise DataError(f"{path} has no column {missing[0]!r}; {what} need {', '.join(names)}")
            columns = [head.index(name) for name in names]
            filled = (line for line in lines if line.partition("#")[0].strip())  # NumPy warns of rows without data
            rows = np.loadtxt(filled, delimiter=",", usecols=columns, ndmin=2, max_rows=MOST_ROWS)
            more = next(filled, None) is not None
    except (OSError, ValueError) as error:
        raise DataError(f"{path} cannot be read as {what}: {error}") from None
    if more:
        raise DataError(f"{path} has more than {MOST_ROWS} rows of {what}, the limit; split it in time")
    if not len(rows) or not np.isfinite(rows).all():
        raise DataError(f"{path}: {what} need rows of finite numbers")
    return rows


def iterate_frames(file: Path | str, lens: Lens, start: float) -> Iterator[tuple[float, NDArray[np.uint8]]]:
    """Yield time [s] and colours ``[H, W, 3]`` of the frames of a video.

    Args:
        file: the video, in a format of OpenCV.
        lens: the intrinsics; the images must have their size.
        start: time of the first frame [s].

    Raises:
        DataError: the video cannot be read, or has images of another size.
        MissingExtra: OpenCV is not installed.
    """
    cv2 = import_optional("cv2", "reading videos", "perception")
    if not Path(file).is_file():
        raise DataError(f"{file} does not exist")
    video = cv2.VideoCapture(str(file))
    try:
        rate = float(video.get(cv2.CAP_PROP_FPS))
        if not video.isOpened() or not (math.isfinite(rate) and rate > 0.0):
            raise DataError(f"{file} cannot be read as a video")
        count = 0
        while True:
            there, image = video.read()
            if not there:
                break
            if image.shape[:2] != (lens.height, lens.width):
                size = f"{image.shape[1]} x {image.shape[0]}"
                raise DataError(f"{file} has images of {size} pixels, the camera has {lens.width} x {lens.height}")
            yield start + count / rate, np.ascontiguousarray(image[..., ::-1])
            count += 1
        if not count:
            raise DataError(f"{file} has no images")
    finally:
        video.release()


def _number(path: Path, table: dict[str, Any], name: str) -> float:
    value = table.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= LARGEST_NUMBER:
        raise DataError(f"{path}: {name} = {_cut(value)} must be a number up to {LARGEST_NUMBER:g}")
    return float(value)


def _whole(path: Path, table: dict[str, Any], name: str) -> int:
    value = _number(path, table, name)
    if not value.is_integer():
        raise DataError(f"{path}: {name} = {value:g} must be a whole number of pixels")
    return int(value)


def _cut(value: Any) -> str:
    """Return a value for a message; digits of a huge number are not converted, since Python limits that."""
    if isinstance(value, int) and not abs(value) <= LARGEST_NUMBER:
        return "a number beyond the limit"
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _numbers(path: Path, table: dict[str, Any], name: str, count: int) -> list[float]:
    inner = table.get(name)
    row = inner.get("data") if isinstance(inner, dict) else None
    if not isinstance(row, list) or len(row) != count:
        raise DataError(f"{path}: {name} must have data with {count} numbers")
    return [_number(path, {name: value}, name) for value in row]
