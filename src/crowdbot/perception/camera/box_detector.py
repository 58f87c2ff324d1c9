"""BoxDetector, the contract of detectors in images: boxes in pixels become places on the floor in metres."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import SpatialPose, Walls, check_number, import_optional
from crowdbot.perception.detections import Coverage, Detections
from crowdbot.perception.detector import Detector
from crowdbot.sensors import Lens, Reading, RgbImage, spatial_pose
from crowdbot.typing import Floats

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
        """Return the people in an image; the walls are not used."""
        del walls
        self.check(reading)
        assert isinstance(reading, RgbImage)
        pose = spatial_pose(reading.pose)
        found = self.find_boxes(reading.rgb[0])
        place, covariance = self._places(found.box, reading.lens, pose)
        away = np.linalg.norm(place - pose.position[0, :2], axis=1)
        kept = np.isfinite(away) & (away <= self.max_range)
        area = np.maximum(1, (found.box[:, 2] - found.box[:, 0]) * (found.box[:, 3] - found.box[:, 1])).astype(np.int64)
        return Detections(
            float(np.max(reading.time)), place[kept], covariance[kept], area[kept],
            self._coverage(reading.lens, pose, found.box[kept], away[kept]),
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
