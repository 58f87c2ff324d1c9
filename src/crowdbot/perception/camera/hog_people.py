"""HogPeople: people in images by histograms of oriented gradients."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import check_number

from .box_detector import BoxDetector, Boxes, opencv, select_boxes

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
        """Return the people in an image."""
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
