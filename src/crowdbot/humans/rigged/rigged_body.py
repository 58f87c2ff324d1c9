"""RiggedBody: a body made of a rigged character, and its file."""

from __future__ import annotations

import io
import json
import re
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.humans.asset import LEVELS, shapes
from crowdbot.typing import Bytes, Floats, Ints

BODY_NAME = re.compile(r"[A-Za-z0-9_-]{1,60}\.body")
"""Names of body files: files beside a trial."""
FORMAT = "crowdbot-body-1"
MOST_BYTES, MOST_VALUES = 64_000_000, 256_000_000
"""Largest size of the file, and of its arrays together."""
MOST_VERTICES = 60_000
PICTURE = 1024
"""Side [pixels] of the picture of a body."""
HEIGHTS, MASSES = (0.5, 2.5), (5.0, 300.0)
REACH = 4.0
"""Largest distance [m] of a point from the origin of the body."""


class RiggedLevel(NamedTuple):
    """One level of detail.

    Fields: ``rest [V, 3]`` [m], ``faces [F, 3]``, texture coordinates ``uv [F, 3, 2]`` of the corners from the top
    left, ``bones [V, 4]`` and ``weights [V, 4]`` (sum 1), and ``closed [F]``: whether the back of a triangle is never
    seen.
    """

    rest: Floats
    faces: Ints
    uv: Floats
    bones: Ints
    weights: Floats
    closed: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class RiggedBody:
    """A body with its own shape and texture on the bones of crowdbot.

    Fields:
        name: name of its file, such as ``ann.body``.
        height: stature [m]; mass [kg].
        head, tail: start and end of each bone at rest ``[28, 3]`` [m], in the rest pose of the included bodies.
        levels: levels of detail, the finest first.
        picture: texture ``[1024, 1024, 3]``.

    Raises:
        InputError: a shape or a value is not allowed.
    """

    name: str
    height: float
    mass: float
    head: Floats
    tail: Floats
    levels: tuple[RiggedLevel, ...]
    picture: Bytes

    def __post_init__(self) -> None:
        for word, value, (low, high) in (("height", self.height, HEIGHTS), ("mass", self.mass, MASSES)):
            if not low <= value <= high:
                raise InputError(f"{self.name}: {word} = {value:g} must be from {low:g} to {high:g}")
        shape = (len(shapes().bones), 3)
        for ends in (self.head, self.tail):
            if ends.shape != shape or not np.all(np.abs(ends) <= REACH):
                raise InputError(f"{self.name}: bones must be {shape[0]} points within {REACH:g} m")
        if len(self.levels) != LEVELS:
            raise InputError(f"{self.name} has {len(self.levels)} levels of detail; {LEVELS} are required")
        for level in self.levels:
            _check_level(self.name, level, shape[0])
        if self.picture.shape != (PICTURE, PICTURE, 3) or self.picture.dtype != np.uint8:
            raise InputError(f"{self.name}: the picture must have {PICTURE} x {PICTURE} pixels of 3 bytes")

    def face_colors(self, level: int) -> Floats:
        """Return the colour ``[F, 3]`` in the middle of each triangle of a level: red, green, blue from 0 to 1."""
        middle = np.minimum(self.levels[level].uv.mean(axis=1) * PICTURE, PICTURE - 1).astype(np.int64)
        return np.asarray(self.picture[middle[:, 1], middle[:, 0]] / 255.0)


def _check_level(name: str, level: RiggedLevel, bones: int) -> None:
    count, faces = len(level.rest), len(level.faces)
    expected: dict[str, tuple[int, ...]] = {
        "rest": (count, 3), "faces": (faces, 3), "uv": (faces, 3, 2), "bones": (count, 4), "weights": (count, 4),
        "closed": (faces,),
    }  # fmt: skip
    for key, shape in expected.items():
        if getattr(level, key).shape != shape:
            raise InputError(f"{name}: {key} has the shape {list(getattr(level, key).shape)}; expected {list(shape)}")
    if not 3 <= count <= MOST_VERTICES or not 1 <= faces <= 2 * MOST_VERTICES:
        raise InputError(f"{name}: {count} points and {faces} triangles; at most {MOST_VERTICES} points are allowed")
    for key, least, most in (("faces", 0, count - 1), ("bones", 0, bones - 1), ("weights", 0, 1), ("uv", 0, 1)):
        values = getattr(level, key)
        if not np.all((values >= least) & (values <= most)):
            raise InputError(f"{name}: {key} must be from {least} to {most}")
    if not np.all(np.abs(level.rest) <= REACH):
        raise InputError(f"{name}: a point is farther than {REACH:g} m away, or not finite")
    if not np.all(np.abs(level.weights.sum(axis=1) - 1.0) < 1e-3):
        raise InputError(f"{name}: weights of a point must have the sum 1")


def write_body(body: RiggedBody) -> bytes:
    """Return the bytes of the file of a body."""
    from PIL import Image

    picture = io.BytesIO()
    Image.fromarray(body.picture).save(picture, "PNG", optimize=False, compress_level=6)
    about = json.dumps({"format": FORMAT, "height": round(body.height, 5), "mass": round(body.mass, 3)})
    arrays: dict[str, Any] = {
        "about": np.frombuffer(about.encode(), np.uint8), "picture": np.frombuffer(picture.getvalue(), np.uint8),
        "head": body.head.astype(np.float32), "tail": body.tail.astype(np.float32),
    }  # fmt: skip
    for k, level in enumerate(body.levels):
        arrays |= {
            f"rest{k}": level.rest.astype(np.float32), f"faces{k}": level.faces.astype(np.int32),
            f"uv{k}": np.round(65535.0 * level.uv).astype(np.uint16), f"bones{k}": level.bones.astype(np.uint8),
            f"weights{k}": level.weights.astype(np.float32), f"closed{k}": level.closed,
        }  # fmt: skip
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for key, values in arrays.items():
            part = io.BytesIO()
            np.lib.format.write_array(part, np.ascontiguousarray(values), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{key}.npy"), part.getvalue(), zipfile.ZIP_DEFLATED)
    return out.getvalue()


def read_body(path: Path) -> RiggedBody:
    """Return the body of a file.

    Raises:
        InputError: the file is missing, too large or no body, or a value in it is not allowed.
    """
    name = path.name
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InputError(f"{name} is larger than {MOST_BYTES} bytes, the maximum")
        data = path.read_bytes()
    except OSError as error:
        raise InputError(
            f"cannot read the body {path}: {error.strerror}; crowdbot new body FILE.glb writes one"
        ) from None
    arrays = _arrays(data, name)
    try:
        about = json.loads(arrays["about"].tobytes())
        if about["format"] != FORMAT:
            raise InputError(f"{name} has the format {about['format']!r}; expected {FORMAT!r}")
        levels = tuple(
            RiggedLevel(
                arrays[f"rest{k}"].astype(np.float64), arrays[f"faces{k}"].astype(np.int64), arrays[f"uv{k}"] / 65535.0,
                arrays[f"bones{k}"].astype(np.int64), arrays[f"weights{k}"].astype(np.float64),
                arrays[f"closed{k}"].astype(np.bool_),
            )
            for k in range(LEVELS)
        )  # fmt: skip
        return RiggedBody(
            name, float(about["height"]), float(about["mass"]), arrays["head"].astype(np.float64),
            arrays["tail"].astype(np.float64), levels, _picture(arrays["picture"].tobytes(), name),
        )  # fmt: skip
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        raise InputError(f"{name} is no body: {type(error).__name__} {str(error)[:80]}") from None


def _arrays(data: bytes, name: str) -> dict[str, NDArray[Any]]:
    """Return the arrays of a file; objects of Python are refused."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            whole = sum(item.file_size for item in archive.infolist())
            if whole > MOST_VALUES or len(archive.infolist()) > 100:
                raise InputError(f"{name} holds {whole} bytes in {len(archive.infolist())} parts, which is too much")
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            return {key: file[key] for key in file.files}
    except (zipfile.BadZipFile, ValueError, OSError, EOFError, NotImplementedError, SyntaxError) as error:
        raise InputError(f"{name} is no body file: {str(error)[:80]}; crowdbot new body FILE.glb writes one") from None


def _picture(data: bytes, name: str) -> Bytes:
    from PIL import Image

    try:
        with Image.open(io.BytesIO(data), formats=("PNG",)) as image:
            if image.size != (PICTURE, PICTURE):
                raise InputError(f"{name}: the picture has {image.size} pixels; expected {PICTURE} x {PICTURE}")
            return np.asarray(image.convert("RGB"), dtype=np.uint8)
    except InputError:
        raise
    except Exception as error:  # a broken image causes many kinds of exceptions inside Pillow
        raise InputError(f"{name}: the picture cannot be read: {type(error).__name__}") from None
