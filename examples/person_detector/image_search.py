"""The part of a detector process that is the same over every transport: the newest image is searched, others are
dropped. The programs ``detect_*.py`` translate the messages of a transport."""

from __future__ import annotations

import statistics
import threading
import time

import numpy as np

ORDERS = {"rgb8": (0, 1, 2), "bgr8": (2, 1, 0)}
"""Positions of red, green and blue in a pixel, by encoding."""


def pixels_of(encoding, height, width, step, data):
    """Return the pixels ``[H, W, 3]`` of a ``sensor_msgs/Image``, whose rows have ``step`` bytes.

    Raises:
        ValueError: the encoding is neither rgb8 nor bgr8.
    """
    if encoding not in ORDERS:
        raise ValueError(f"encoding {encoding!r} must be one of {', '.join(ORDERS)}")
    rows = np.frombuffer(data, dtype=np.uint8).reshape(height, step)
    pixels = rows[:, : 3 * width].reshape(height, width, 3)
    return np.ascontiguousarray(pixels[..., ORDERS[encoding]])


class ImageSearch:
    """Searches the newest image in :meth:`work`, while other threads give images and the end.

    Args:
        detector: has ``detect(rgb)``.
        decode: returns the pixels of a message.
        answer: takes a message and what was found in its image.
    """

    def __init__(self, detector, decode, answer):
        self.detector, self.decode, self.answer = detector, decode, answer
        self.newest, self.closed, self.fresh = None, False, threading.Condition()
        self.times, self.people = [], 0

    def take_image(self, message):
        """Keep an image until it is searched or replaced."""
        with self.fresh:
            self.newest = message
            self.fresh.notify()

    def close(self):
        """End :meth:`work`."""
        with self.fresh:
            self.closed = True
            self.fresh.notify()

    def work(self):
        """Answer images until the search is closed."""
        while True:
            with self.fresh:
                self.fresh.wait_for(lambda: self.closed or self.newest is not None)
                if self.closed:
                    return
                message, self.newest = self.newest, None
            begin = time.perf_counter()
            found = self.detector.detect(self.decode(message))
            self.times.append(time.perf_counter() - begin)
            self.people += len(found.scores)
            self.answer(message, found)

    def summary(self):
        """Return a line about the end."""
        median = 1000.0 * statistics.median(self.times) if self.times else 0.0
        return f"{len(self.times)} images, {self.people} people, median {median:.0f} ms an image"
