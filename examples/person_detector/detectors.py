"""Person detectors for colour images: HOG of OpenCV, and networks of your own in ONNX files.

A detector has ``detect(rgb)``, which takes an image ``[H, W, 3]`` uint8 and returns :class:`Detections`.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

ASPECT = 0.41
"""Width of the box of a person over its height, as in evaluations of pedestrian detectors (Dollár et al. 2012)."""
PERSON = 0.75
"""Height of a person over the height of the window of HOG, 128 pixels with a margin of 16 at the top and bottom."""
LAYOUTS = ("yolov5", "yolov8")


@dataclass(frozen=True)
class Detections:
    """People in one image.

    Fields:
        boxes: ``[N, 4]`` left, top, right, bottom [pixels].
        scores: ``[N]``, larger is more certain; the scale is that of the detector.
    """

    boxes: np.ndarray
    scores: np.ndarray


def strongest(boxes, scores, threshold, overlap=0.5):
    """Return the :class:`Detections` from ``threshold`` on, without those that overlap a stronger one (IoU)."""
    chosen = np.asarray(scores) >= threshold
    boxes, scores = np.asarray(boxes, dtype=float).reshape(-1, 4)[chosen], np.asarray(scores, dtype=float)[chosen]
    corners_and_sizes = np.concatenate([boxes[:, :2], boxes[:, 2:] - boxes[:, :2]], axis=1)
    best = cv2.dnn.NMSBoxes(corners_and_sizes.tolist(), scores.tolist(), float(threshold), overlap)
    best = np.asarray(best, dtype=int).ravel()
    return Detections(boxes[best], scores[best])


class HogDetector:
    """Histograms of oriented gradients with the linear SVM that OpenCV brings (Dalal & Triggs 2005).

    The window is 64 x 128 pixels, so a person must be about 96 pixels tall. ``upscale`` enlarges the image first: people
    are found further away, and an image takes ``upscale`` squared times longer.

    Args:
        threshold: smallest distance to the plane of the SVM.
        upscale: factor of the size of the image.
    """

    def __init__(self, threshold=0.5, upscale=1.0):
        if not 0.5 <= upscale <= 4.0:
            raise ValueError(f"upscale = {upscale} must be from 0.5 to 4")
        self.threshold, self.upscale = threshold, upscale
        self.hog = cv2.HOGDescriptor()
        self.hog.setSVMDetector(cv2.HOGDescriptor_getDefaultPeopleDetector())

    def detect(self, rgb):
        """Return the people in an image."""
        grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
        if self.upscale != 1.0:
            grey = cv2.resize(grey, None, fx=self.upscale, fy=self.upscale, interpolation=cv2.INTER_LINEAR)
        found, scores = self.hog.detectMultiScale(grey, winStride=(8, 8), padding=(8, 8), scale=1.05)
        windows = np.asarray(found, dtype=float).reshape(-1, 4) / self.upscale
        middle = windows[:, :2] + 0.5 * windows[:, 2:]
        half = 0.5 * PERSON * windows[:, 3:] * [ASPECT, 1.0]
        boxes = np.concatenate([middle - half, middle + half], axis=1)
        return strongest(boxes, np.ravel(scores), self.threshold)


class OnnxDetector:
    """A network of your own in an ONNX file, run by OpenCV.

    Input: ``[1, 3, size, size]``, red, green, blue from 0 to 1; the image is scaled and padded with grey. Output:

    * ``yolov5``: ``[1, N, 5 + classes]`` centre x, y, width, height [pixels of the input], objectness, class scores;
    * ``yolov8``: ``[1, 4 + classes, N]`` centre x, y, width, height, class scores (also YOLOv9 and YOLO11).

    Args:
        file: the ONNX file.
        layout: layout of the output.
        size: width and height of the input [pixels].
        threshold: smallest score, from 0 to 1.
        person: number of the class of people, 0 in COCO.

    Raises:
        ValueError: the layout is unknown, the file cannot be read, or the output does not fit.
    """

    def __init__(self, file, layout="yolov8", size=640, threshold=0.25, person=0):
        if layout not in LAYOUTS:
            raise ValueError(f"layout = {layout!r} must be one of {', '.join(LAYOUTS)}")
        self.layout, self.size, self.threshold, self.person = layout, int(size), threshold, int(person)
        try:
            self.net = cv2.dnn.readNetFromONNX(str(file))
        except cv2.error as error:
            raise ValueError(f"{file} cannot be read as ONNX: {error}") from None

    def detect(self, rgb):
        """Return the people in an image."""
        height, width = rgb.shape[:2]
        scale = self.size / max(height, width)
        inner = cv2.resize(rgb, (round(width * scale), round(height * scale)), interpolation=cv2.INTER_LINEAR)
        left, top = (self.size - inner.shape[1]) // 2, (self.size - inner.shape[0]) // 2
        padded = np.full((self.size, self.size, 3), 114, dtype=np.uint8)
        padded[top : top + inner.shape[0], left : left + inner.shape[1]] = inner
        self.net.setInput(cv2.dnn.blobFromImage(padded, 1.0 / 255.0))
        rows, scores = self.decode(np.asarray(self.net.forward()))
        middle, half = (rows[:, :2] - [left, top]) / scale, 0.5 * rows[:, 2:] / scale
        boxes = np.clip(np.concatenate([middle - half, middle + half], axis=1), 0.0, [width, height, width, height])
        return strongest(boxes, scores, self.threshold)

    def decode(self, output):
        """Return centres and sizes ``[N, 4]`` [pixels of the input] and scores ``[N]`` of an output of the network."""
        first = 5 if self.layout == "yolov5" else 4
        table = output[0] if self.layout == "yolov5" or output.ndim != 3 else output[0].T
        if output.ndim != 3 or len(output) != 1 or table.shape[1] <= first + self.person:
            raise ValueError(f"an output of shape {output.shape} is not of layout {self.layout}")
        scores = table[:, first + self.person]
        return table[:, :4], scores * table[:, 4] if self.layout == "yolov5" else scores


def add_options(parser):
    """Add the options of :func:`detectors_of` to a parser of the command line."""
    parser.add_argument("--model", help="ONNX file of a network (default: HOG of OpenCV)")
    parser.add_argument("--layout", choices=LAYOUTS, default="yolov8", help="layout of the output of the network")
    parser.add_argument("--size", type=int, default=640, help="width and height of the input of the network [pixels]")
    parser.add_argument("--threshold", type=float, help="smallest score (default: 0.5 for HOG, 0.25 for networks)")
    help_text = "factors of the size of images for HOG; several are compared by an evaluation"
    parser.add_argument("--upscale", type=float, nargs="+", default=[1.0], help=help_text)


def detectors_of(options):
    """Return the detectors of the options of a command line, by name."""
    if options.model:
        threshold = 0.25 if options.threshold is None else options.threshold
        return {Path(options.model).stem: OnnxDetector(options.model, options.layout, options.size, threshold)}
    threshold = 0.5 if options.threshold is None else options.threshold
    return {f"HOG x {factor:g}": HogDetector(threshold, factor) for factor in options.upscale}
