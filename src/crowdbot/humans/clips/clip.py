"""Clip: a recorded motion that all bodies can play, in a file of JSON."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field

import numpy as np

from crowdbot.core import InputError
from crowdbot.humans.asset import shapes
from crowdbot.typing import Floats

SUFFIX = ".clip"
FORMAT = "crowdbot-clip-1"
MOST_FRAMES, MOST_BYTES = 3000, 40_000_000
KEYS = {"format", "rate", "cyclic", "bones", "rotations", "lift"}


@dataclass(frozen=True, eq=False)
class Clip:
    """A motion of the bones, without the way and the heading.

    Fields:
        name: name of the activity, the name of its file.
        rate: frames per second.
        cyclic: whether it is one cycle of a gait from the landing of the left foot on, played in step with the way;
            otherwise it is played in time, again and again.
        bones: names of the bones that move.
        rotations: ``[T, K, 4]`` quaternions w, x, y, z of the bones relative to their rest, in the frame of the body.
        lift: height ``[T]`` of the lower foot above the floor, in leg lengths.

    Raises:
        InputError: a shape or a value is not allowed.
    """

    name: str
    rate: float
    cyclic: bool
    bones: tuple[str, ...]
    rotations: Floats
    lift: Floats
    matrices: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not 1.0 <= self.rate <= 1000.0:
            raise InputError(f"{self.name}: rate = {self.rate} Hz must be from 1 to 1000")
        unknown = [bone for bone in self.bones if bone not in shapes().bones]
        if unknown or not self.bones or len(set(self.bones)) < len(self.bones):
            what = f"unknown bone {unknown[0]!r}" if unknown else "no bones, or one twice"
            raise InputError(f"{self.name} has {what}; bones are {', '.join(shapes().bones)}")
        count = len(self.lift)
        if not 2 <= count <= MOST_FRAMES or self.rotations.shape != (count, len(self.bones), 4):
            raise InputError(
                f"{self.name}: rotations have shape {list(self.rotations.shape)}; they must be"
                f" [T, {len(self.bones)}, 4] for {count} frames, from 2 to {MOST_FRAMES}"
            )
        if not np.all(np.isfinite(self.rotations)) or not np.all((self.lift >= 0.0) & (self.lift <= 2.0)):
            raise InputError(f"{self.name}: a rotation is not finite, or a lift is not from 0 to 2 leg lengths")
        size = np.sqrt(np.sum(self.rotations**2, axis=-1, keepdims=True))
        if not np.all((size > 0.5) & (size < 2.0)):
            raise InputError(f"{self.name}: a quaternion has a length of {float(size.min()):g}; it must be 1")
        object.__setattr__(self, "matrices", _matrices(self.rotations / size))

    def at(self, phase: float, clock: float) -> tuple[Floats, float]:
        """Return the rotations ``[K, 3, 3]`` and the lift at a phase of the gait (0 to 1), or at a time [s]."""
        count = len(self.lift)
        place = (phase % 1.0) * count if self.cyclic else (clock * self.rate) % count
        first = int(place) % count
        share, second = place - math.floor(place), (first + 1) % count
        mixed = (1.0 - share) * self.matrices[first] + share * self.matrices[second]
        u, _, v = np.linalg.svd(mixed)
        return np.asarray(u @ v), float((1.0 - share) * self.lift[first] + share * self.lift[second])


def _matrices(q: Floats) -> Floats:
    w, x, y, z = np.moveaxis(q, -1, 0)
    rows = (
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z),
        2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    )  # fmt: skip
    return np.stack(rows, axis=-1).reshape(*q.shape[:-1], 3, 3)


def write_clip(clip: Clip) -> str:
    """Return the text of the file of a clip.

    >>> still = Clip("nod", 30.0, False, ("head",), np.tile((1.0, 0, 0, 0), (2, 1, 1)), np.zeros(2))
    >>> read_clip(write_clip(still), "nod.clip").bones
    ('head',)
    """
    values = {
        "format": FORMAT, "rate": clip.rate, "cyclic": clip.cyclic, "bones": list(clip.bones),
        "rotations": np.round(clip.rotations, 6).tolist(), "lift": np.round(clip.lift, 5).tolist(),
    }  # fmt: skip
    return json.dumps(values)


def read_clip(text: str, name: str) -> Clip:
    """Return the clip of a file.

    Args:
        text: content of the file.
        name: name of the file; it is the name of the activity.

    Raises:
        InputError: the file is no clip, or a value in it is not allowed.
    """
    if len(text) > MOST_BYTES:
        raise InputError(f"{name} has {len(text)} characters, at most {MOST_BYTES} are allowed")
    try:
        values = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{name} is not JSON: {error}") from None
    if not isinstance(values, dict) or values.get("format") != FORMAT:
        raise InputError(f"{name} is no clip: its format must be {FORMAT!r}; crowdbot new clip FILE.bvh writes one")
    if set(values) != KEYS:
        raise InputError(
            f"{name} has the keys {', '.join(sorted(map(str, values)))}; expected {', '.join(sorted(KEYS))}"
        )
    try:
        rotations, lift = (np.array(values[key], dtype=np.float64) for key in ("rotations", "lift"))
        rate, bones = float(values["rate"]), tuple(str(bone) for bone in values["bones"])
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: rate, rotations and lift must be numbers in lists of equal lengths") from None
    if not isinstance(values["cyclic"], bool) or lift.ndim != 1:
        raise InputError(f"{name}: cyclic must be true or false, and lift a list of numbers")
    return Clip(name, rate, values["cyclic"], bones, rotations, lift)
