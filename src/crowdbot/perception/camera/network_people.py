"""NetworkPeople: people in images by a network of the user in an ONNX file."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, check_number
from crowdbot.typing import Floats

from .box_detector import BoxDetector, Boxes, opencv, select_boxes

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
        """Return the people in an image."""
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
