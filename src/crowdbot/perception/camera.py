"""Detectors of people in the images of a calibrated camera, as places on the floor."""

from __future__ import annotations

import functools
import math
from abc import abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, SpatialPose, Walls, check_number, import_optional
from crowdbot.sensors import Lens, Reading, RgbImage, spatial_pose
from crowdbot.typing import Floats

from .detector import Coverage, Detections, Detector

COLUMNS = 181
"""Number of directions of the coverage."""
HEIGHT_SD = 0.1
"""Standard deviation of the height of people [m]."""
OVERLAP = 0.5
"""Boxes that overlap a stronger one by this share of their union are left out."""


class Boxes(NamedTuple):
    """People in an image: ``box [N, 4]`` left, top, right, bottom [pixels], and ``score [N]``."""

    box: Floats
    score: Floats


@dataclass(frozen=True, kw_only=True)
class BoxDetector(Detector):
    """Finds people in colour images: :meth:`find_boxes` in pixels, then the places on the floor.

    The floor is z = 0 of the world. Two measurements are combined by their variances: where the viewing ray of the
    lower edge of the box meets the floor, and the distance at which a person is as tall as the box. The covariance has
    the variance of the distance along the ray, and that of the bearing across.

    Fields:
        person_height: mean height of people [m].
        edge_error: standard deviation of an edge of a box, as a share of its height.
        max_range: largest distance [m].

    Raises:
        InputError: a value is not allowed.
    """

    reads: ClassVar[tuple[type[Reading], ...]] = (RgbImage,)
    person_height: float = 1.7
    edge_error: float = 0.03
    max_range: float = 15.0

    def __post_init__(self) -> None:
        for name in ("person_height", "max_range"):
            check_number(type(self).__name__, name, getattr(self, name), "m", exclusive_min=0.0)
        check_number(type(self).__name__, "edge_error", self.edge_error, exclusive_min=0.0)

    @abstractmethod
    def find_boxes(self, rgb: NDArray[np.uint8]) -> Boxes:
        """Return the people in an image ``[H, W, 3]``; a box ends at the feet and at the top of the head."""

    def detect(self, reading: Reading, walls: Walls | None = None) -> Detections:
        # the walls are not used
        del walls
        self.check(reading)
        assert isinstance(reading, RgbImage)
        pose = spatial_pose(reading.pose)
        boxes = self.find_boxes(reading.rgb[0])
        place, covariance = self._places(boxes.box, reading.lens, pose)
        away = np.linalg.norm(place - pose.position[0, :2], axis=1)
        kept = np.isfinite(away) & (away <= self.max_range)
        area = np.maximum(1, (boxes.box[:, 2] - boxes.box[:, 0]) * (boxes.box[:, 3] - boxes.box[:, 1])).astype(np.int64)
        return Detections(
            float(np.max(reading.time)), place[kept], covariance[kept], area[kept],
            self._coverage(reading.lens, pose, boxes.box[kept], away[kept]),
        )  # fmt: skip

    def _places(self, box: Floats, lens: Lens, pose: SpatialPose) -> tuple[Floats, Floats]:
        """Return places ``[N, 2]`` and covariances ``[N, 2, 2]``; NaN without a place."""
        middle = 0.5 * (box[:, 0] + box[:, 2])
        low, high = (_directions(lens, pose, middle, box[:, row]) for row in (3, 1))
        origin, size = pose.position[0], np.maximum(box[:, 3] - box[:, 1], 1.0)
        level = np.linalg.norm(low[:, :2], axis=1)
        slope, top = low[:, 2] / level, high[:, 2] / np.linalg.norm(high[:, :2], axis=1)
        error = self.edge_error * size / lens.fy
        cut = box[:, 3] >= lens.height - 2.0  # the feet are outside the image
        with np.errstate(divide="ignore", invalid="ignore"):
            by_floor = np.where((slope < -1e-3) & ~cut, -origin[2] / slope, np.inf)
            floor_sd = np.where(np.isfinite(by_floor), by_floor**2 / max(origin[2], 1e-3) * error, np.inf)
            by_height = np.where(cut, (self.person_height - origin[2]) / top, self.person_height / (top - slope))
            by_height = np.where(by_height > 0.0, by_height, np.nan)
            height_sd = by_height * np.hypot(HEIGHT_SD / self.person_height, math.sqrt(2.0) * self.edge_error)
            weights = np.stack([1.0 / floor_sd**2, 1.0 / height_sd**2])
            known = np.stack([np.where(np.isfinite(by_floor), by_floor, 0.0), by_height])
            total = np.nansum(weights, axis=0)
            distance, along = np.nansum(known * weights, axis=0) / total, 1.0 / np.sqrt(total)
        unit = low[:, :2] / level[:, None]
        across = distance * error + 0.05
        side = np.stack([-unit[:, 1], unit[:, 0]], axis=-1)
        covariance = along[:, None, None] ** 2 * unit[:, :, None] * unit[:, None, :]
        covariance = covariance + across[:, None, None] ** 2 * side[:, :, None] * side[:, None, :]
        return origin[:2] + distance[:, None] * unit, covariance

    def _coverage(self, lens: Lens, pose: SpatialPose, box: Floats, away: Floats) -> Coverage:
        """Return the field of view; people who are found hide what is behind them."""
        row = np.full(2, lens.cy)
        edge = _directions(lens, pose, np.array([lens.width - 1.0, 0.0]), row)
        first, last = np.arctan2(edge[:, 1], edge[:, 0])
        width = (last - first) % (2.0 * math.pi)
        bearing = first + width * np.linspace(0.0, 1.0, COLUMNS)
        reach = np.full(COLUMNS, self.max_range)
        for left, right, distance in zip(box[:, 0], box[:, 2], away, strict=True):
            ends = _directions(lens, pose, np.array([right, left]), row)
            low, high = np.arctan2(ends[:, 1], ends[:, 0])
            inside = (bearing - low) % (2.0 * math.pi) <= (high - low) % (2.0 * math.pi)
            reach[inside] = np.minimum(reach[inside], distance)
        return Coverage(pose.position[0, :2].copy(), float(first), float(width / (COLUMNS - 1)), reach)


def opencv() -> Any:
    """Return the module ``cv2``.

    Raises:
        MissingExtra: OpenCV is not installed.
    """
    return import_optional("cv2", "detecting people in images", "perception")


def select_boxes(box: Floats, score: Floats, threshold: float) -> Boxes:
    """Return the boxes from a score on, without those that overlap a stronger one."""
    chosen = score >= threshold
    box, score = box[chosen], score[chosen]
    corner_and_size = np.concatenate([box[:, :2], box[:, 2:] - box[:, :2]], axis=1)
    best = opencv().dnn.NMSBoxes(corner_and_size.tolist(), score.tolist(), float(threshold), OVERLAP)
    kept = np.asarray(best, dtype=np.int64).ravel()
    return Boxes(box[kept], score[kept])


def _directions(lens: Lens, pose: SpatialPose, column: Floats, row: Floats) -> Floats:
    """Return the viewing directions ``[N, 3]`` of pixels in the world, of length 1 along the optical axis."""
    right, down = lens.undistort((column - lens.cx) / lens.fx, (row - lens.cy) / lens.fy)
    ahead = np.stack([np.ones_like(right), -right, -down], axis=-1)
    return np.asarray(ahead @ pose.matrix[0].T)


BODY = 0.75
"""Height of a person over that of the window, 128 pixels with a margin of 16 above and below."""
ASPECT = 0.41
"""Width of a person over the height (Dollár et al. 2012, doi 10.1109/TPAMI.2011.155)."""


@dataclass(frozen=True, kw_only=True)
class HogPeople(BoxDetector):
    """Histograms of oriented gradients with the support vector machine of OpenCV; needs the extra ``perception``.

    Dalal and Triggs (2005), Histograms of oriented gradients for human detection, doi 10.1109/CVPR.2005.177. A person
    must be about 96 pixels tall. With ``upscale``, people are found farther away; the time grows with its square.

    Fields:
        threshold: smallest distance to the plane of the support vector machine.
        upscale: factor of the size of the image.

    >>> HogPeople(upscale=2.0).reads[0].__name__
    'RgbImage'
    """

    threshold: float = 0.5
    upscale: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("HogPeople", "threshold", self.threshold)
        check_number("HogPeople", "upscale", self.upscale, min=0.5, max=4.0)

    def find_boxes(self, rgb: NDArray[np.uint8]) -> Boxes:
        cv2 = opencv()
        hog = cv2.HOGDescriptor()
        hog.setSVMDetector(cv2.HOGDescriptor_getDefaultPeopleDetector())
        grey = cv2.cvtColor(np.ascontiguousarray(rgb), cv2.COLOR_RGB2GRAY)
        if self.upscale != 1.0:
            grey = cv2.resize(grey, None, fx=self.upscale, fy=self.upscale, interpolation=cv2.INTER_LINEAR)
        if grey.shape[0] < 128 or grey.shape[1] < 64:
            return Boxes(np.zeros((0, 4)), np.zeros(0))
        found, score = hog.detectMultiScale(grey, winStride=(8, 8), padding=(8, 8), scale=1.05)
        window = np.asarray(found, dtype=np.float64).reshape(-1, 4) / self.upscale
        middle = window[:, :2] + 0.5 * window[:, 2:]
        half = 0.5 * BODY * window[:, 3:] * np.array([ASPECT, 1.0])
        box = np.concatenate([middle - half, middle + half], axis=1)
        return select_boxes(box, np.ravel(np.asarray(score, dtype=np.float64)), self.threshold)


LAYOUTS = ("yolov5", "yolov8")
LARGEST = 1_000_000_000
"""Largest size of a file [bytes]."""
GREY = 114
"""Value of the border around the image."""


@dataclass(frozen=True, kw_only=True)
class NetworkPeople(BoxDetector):
    """A detection network with weights of the user, an ONNX file that OpenCV runs; needs the extra ``perception``.

    The input is ``[1, 3, size, size]``, red, green, blue from 0 to 1; the image is scaled and gets a grey border. The
    output is, by ``layout``:

    * ``yolov8``: ``[1, 4 + classes, N]`` centre x, y, width, height [pixels], scores of the classes (YOLOv8 to YOLO11);
    * ``yolov5``: ``[1, N, 5 + classes]`` with an objectness before the scores.

    Fields:
        file: the ONNX file.
        layout: layout of the output.
        size: width and height of the input [pixels].
        threshold: smallest score.
        person: number of the class of people.

    Raises:
        InputError: a value is not allowed.
        DataError: the file or the output of the network cannot be read.
    """

    file: str
    layout: str = "yolov8"
    size: int = 640
    threshold: float = 0.25
    person: int = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.layout not in LAYOUTS:
            raise InputError(f"NetworkPeople: layout = {self.layout!r} must be {' or '.join(LAYOUTS)}")
        check_number("NetworkPeople", "size", self.size, "pixels", min=32, max=4096, whole=True)
        check_number("NetworkPeople", "person", self.person, min=0, whole=True)
        if not 0.0 < self.threshold < 1.0:
            raise InputError(f"NetworkPeople: threshold = {self.threshold} must be above 0 and below 1")

    def find_boxes(self, rgb: NDArray[np.uint8]) -> Boxes:
        cv2 = opencv()
        height, width = rgb.shape[:2]
        scale = self.size / max(height, width)
        inner = cv2.resize(np.ascontiguousarray(rgb), (round(width * scale), round(height * scale)))
        left, top = (self.size - inner.shape[1]) // 2, (self.size - inner.shape[0]) // 2
        padded = np.full((self.size, self.size, 3), GREY, dtype=np.uint8)
        padded[top : top + inner.shape[0], left : left + inner.shape[1]] = inner
        network = _network(self.file)
        try:
            network.setInput(cv2.dnn.blobFromImage(padded, 1.0 / 255.0))
            output = np.asarray(network.forward(), dtype=np.float64)
        except cv2.error as error:
            raise DataError(f"{self.file} does not run on {self.size} x {self.size} pixels: {error}") from None
        rows, score = self._rows(output)
        middle, half = (rows[:, :2] - [left, top]) / scale, 0.5 * rows[:, 2:] / scale
        box = np.clip(np.concatenate([middle - half, middle + half], axis=1), 0.0, [width, height, width, height])
        return select_boxes(box, score, self.threshold)

    def _rows(self, output: Floats) -> tuple[Floats, Floats]:
        """Return centres and sizes ``[N, 4]`` [pixels] and scores ``[N]``."""
        first = 5 if self.layout == "yolov5" else 4
        fits = output.ndim == 3 and len(output) == 1
        table = output[0] if not fits or self.layout == "yolov5" else output[0].T
        if not fits or table.shape[1] <= first + self.person or not np.isfinite(table).all():
            raise DataError(f"{self.file}: an output of shape {list(output.shape)} is not of layout {self.layout}")
        score = table[:, first + self.person]
        return table[:, :4], score * table[:, 4] if self.layout == "yolov5" else score


@functools.lru_cache(maxsize=4)
def _network(file: str) -> Any:
    cv2 = opencv()
    try:
        if Path(file).stat().st_size > LARGEST:
            raise DataError(f"{file}: a network has at most {LARGEST / 1e9:g} GB")
        return cv2.dnn.readNetFromONNX(file)
    except (OSError, cv2.error) as error:
        raise DataError(f"{file} cannot be read as ONNX: {error}") from None
