"""Detections: people in ``vision_msgs/Detection3DArray``, in the forms of ROS 1 and of all versions of ROS 2."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

DETECTIONS = "vision_msgs/msg/Detection3DArray"
PERSON_CLASSES = ("person", "pedestrian")
"""Classes of people, in any case of letters."""


class DetectedPerson(NamedTuple):
    """A tracked person: identity, centre of the box [m], covariance ``[3, 3]`` [m^2] or None, and score."""

    name: str
    point: Any
    covariance: Floats | None
    score: float


def detected_people(message: Any, classes: Sequence[str] = PERSON_CLASSES) -> Iterator[DetectedPerson]:
    """Return the people of a message of type Detection3DArray.

    The class of a detection is that of its hypothesis with the highest score; a tracked detection without a class is a
    person. Other classes are left out. Bounding boxes contain arms and bags, so they give no radius.

    Args:
        message: the message.
        classes: classes of people.

    Raises:
        InputError: a person has no identity, or classes are numbers that ``classes`` does not name.
    """
    names = [name.lower() for name in classes]
    for detection in message.detections:
        best = max(detection.results, key=_score, default=None)
        kind = "" if best is None else _class(best)
        if kind.isdecimal() and not any(name.isdecimal() for name in names):
            raise InputError(
                f"a detection has the class {kind!r}, a number of a list of classes; name the number of people, as in"
                f" Live(..., person_classes=[{kind!r}])"
            )
        if kind and kind.lower() not in names:
            continue
        name = str(getattr(detection, "id", "") or getattr(detection, "tracking_id", ""))
        if not name:
            raise InputError(
                f"a detection of class {kind!r} has no id: people must be tracked; send what a tracker publishes, or"
                " track the detections with crowdbot.perception.GlobalNearestNeighbor"
            )
        covariance = None
        if best is not None:
            covariance = np.asarray(best.pose.covariance, dtype=np.float64).reshape(6, 6)[:3, :3]
        yield DetectedPerson(name, detection.bbox.center.position, covariance, 0.0 if best is None else _score(best))


def _score(result: Any) -> float:
    return float(getattr(result, "hypothesis", result).score)


def _class(result: Any) -> str:
    """Return the class of a hypothesis; its field was ``id`` before ROS 2 Humble."""
    hypothesis = getattr(result, "hypothesis", None)
    return str(result.id if hypothesis is None else hypothesis.class_id).strip()
