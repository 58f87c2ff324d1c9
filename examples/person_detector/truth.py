"""True boxes of people in an image of the simulation, from its segmentation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from detectors import ASPECT

MOST_HIDDEN, SMALLEST = 0.35, 50
"""Largest occluded share, and smallest height [pixels], of a person that counts: the "reasonable" set of Dollár et al.
(2012). Others neither count as missed nor as found."""


@dataclass(frozen=True)
class TrueBoxes:
    """People in one image.

    Fields:
        boxes: ``[N, 4]`` left, top, right, bottom [pixels].
        distance: ``[N]`` horizontal distance to the camera [m].
        counts: ``[N]`` whether the person counts; the others are too small, occluded or cut by the image.
    """

    boxes: np.ndarray
    distance: np.ndarray
    counts: np.ndarray


def true_boxes(hit, lens, camera, people, standard=1.7):
    """Return the :class:`TrueBoxes` of an image.

    Args:
        hit: ``[H, W]`` number of the agent of each pixel, negative for none.
        lens: intrinsics of the camera, without distortion.
        camera: position of the camera x, y, z [m].
        people: ``[A, 2]`` positions of all agents [m].
        standard: height of a person [m], for the part of the body that others hide.
    """
    height, width = hit.shape
    boxes, distance, counts = [], [], []
    away = np.hypot(*(people - camera[:2]).T)
    for agent in np.unique(hit[hit >= 0]):
        rows, columns = np.nonzero(hit == agent)
        box = np.array([columns.min(), rows.min(), columns.max() + 1.0, rows.max() + 1.0])
        cut = box[0] <= 0 or box[1] <= 0 or box[2] >= width or box[3] >= height
        upright = upright_box(box, lens, camera[2], away[agent], standard)
        boxes.append(box)
        distance.append(away[agent])
        hidden = hidden_share(hit, upright, agent, away)
        tall = upright[3] - upright[1] >= SMALLEST
        counts.append(not cut and tall and hidden <= MOST_HIDDEN)
    return TrueBoxes(np.array(boxes).reshape(-1, 4), np.array(distance), np.array(counts, dtype=bool))


def upright_box(box, lens, eye, away, standard):
    """Return the box of a whole person of standard height at a distance [m], around the columns of a visible box."""
    bottom, top = lens.cy + lens.fy * eye / away, lens.cy + lens.fy * (eye - standard) / away
    middle, half = 0.5 * (box[0] + box[2]), 0.5 * ASPECT * (bottom - top)
    return np.array([middle - half, min(top, box[1]), middle + half, max(bottom, box[3])])


def hidden_share(hit, box, agent, away):
    """Return the share of a box that nearer people cover."""
    left, top, right, bottom = np.round(box).astype(int)
    part = hit[max(0, top) : max(0, bottom), max(0, left) : max(0, right)]
    others = (part >= 0) & (part != agent)
    return float((others & (away[np.where(others, part, 0)] < away[agent])).sum()) / max(1, part.size)


def standard_width(boxes):
    """Return boxes with the width :data:`ASPECT` times their height: arms and strides do not count."""
    boxes = np.asarray(boxes, dtype=float).reshape(-1, 4)
    middle, half = 0.5 * (boxes[:, 0] + boxes[:, 2]), 0.5 * ASPECT * (boxes[:, 3] - boxes[:, 1])
    return np.stack([middle - half, boxes[:, 1], middle + half, boxes[:, 3]], axis=1)
