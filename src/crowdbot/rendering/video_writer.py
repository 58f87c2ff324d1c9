"""Videos as MP4, GIF and animated WebP, written image by image in constant memory.

Pillow encodes single images as GIF or WebP; this module writes the animation containers (GIF89a; WebP with the chunks
VP8X, ANIM and ANMF). Each image is cropped to its changed part, and identical images are merged.
"""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from fractions import Fraction
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import import_optional

Image = NDArray[np.uint8]
Box = tuple[int, int, int, int]
"""Left, top, right and bottom of a part of an image [pixels]."""
CLEAR = 255
"""Transparent colour index of a GIF; unchanged pixels compress well."""


class VideoWriter(ABC):
    """Writes a video to a temporary file until it is finished."""

    def __init__(self, path: Path, rate: float) -> None:
        self.path, self.rate = path, rate
        self.part = path.with_name(f".{path.name}.part")

    @abstractmethod
    def add(self, image: Image) -> None:
        """Append an image ``[H, W, 3]``."""

    @abstractmethod
    def close(self) -> None:
        """Write pending data."""

    @abstractmethod
    def drop(self) -> None:
        """Close the file."""

    def finish(self) -> Path:
        """Rename the finished file."""
        self.close()
        self.drop()
        self.part.replace(self.path)
        return self.path

    def abandon(self) -> None:
        """Remove the unfinished file."""
        self.drop()
        self.part.unlink(missing_ok=True)


def reel(path: Path, rate: float) -> VideoWriter:
    """Return a writer for this file extension, with ``rate`` images per second.

    Args:
        path: file that ends with .mp4, .gif or .webp.
        rate: images per second.

    >>> import tempfile
    >>> writer = reel(Path(tempfile.mkdtemp()) / "white.gif", 10.0)
    >>> writer.add(np.full((4, 4, 3), 255, dtype=np.uint8))
    >>> writer.finish().read_bytes()[:6]
    b'GIF89a'
    """
    kinds: dict[str, type[VideoWriter]] = {".mp4": _Mp4, ".gif": _Gif, ".webp": _WebP}
    return kinds[path.suffix.lower()](path, rate)


class _Mp4(VideoWriter):
    def __init__(self, path: Path, rate: float) -> None:
        super().__init__(path, rate)
        self.file: Any = None
        self.track: Any = None

    def add(self, image: Image) -> None:
        av = av_module()
        even = np.ascontiguousarray(
            image[: len(image) // 2 * 2, : image.shape[1] // 2 * 2]
        )  # the format requires even sizes
        if self.file is None:
            self.file = av.open(str(self.part), "w", format="mp4")
            self.track = self.file.add_stream("libx264", rate=Fraction(self.rate).limit_denominator(10_000))
            self.track.height, self.track.width = even.shape[:2]
            self.track.pix_fmt = "yuv420p"
            self.track.options = {"crf": "18", "threads": "1"}
        for packet in self.track.encode(av.VideoFrame.from_ndarray(even, format="rgb24")):
            self.file.mux(packet)

    def close(self) -> None:
        for packet in self.track.encode():
            self.file.mux(packet)

    def drop(self) -> None:
        if self.file is not None:
            self.file.close()
            self.file = None


class _Parts(VideoWriter):
    """A video of changed image parts; the last one is held back until its duration is known."""

    unit: float
    """Time unit [s]."""
    grid: int = 1
    """Alignment of left and top of a part [pixels]."""

    def __init__(self, path: Path, rate: float) -> None:
        super().__init__(path, rate)
        self.file: BinaryIO | None = None
        self.count = self.begin = 0
        self.last: Image = np.zeros((0, 0, 3), dtype=np.uint8)
        self.waiting: tuple[Image, NDArray[np.bool_], Box] | None = None

    def add(self, image: Image) -> None:
        if self.file is None:
            self.file = self.part.open("wb")
            self.head(*image.shape[1::-1])
            same = np.zeros(image.shape[:2], dtype=np.bool_)
        else:
            same = np.all(self.last == image, axis=-1)
        box = _changed(same, self.grid)
        if box is not None:
            self._write()
            part = np.s_[box[1] : box[3], box[0] : box[2]]
            self.waiting = image[part].copy(), same[part], box
        self.last = image
        self.count += 1

    def close(self) -> None:
        self._write()
        self.foot()

    def drop(self) -> None:
        if self.file is not None:
            self.file.close()
            self.file = None

    def _write(self) -> None:
        if self.waiting is not None:
            end = round(self.count / self.rate / self.unit)
            self.put(*self.waiting, max(1, end - self.begin))
            self.begin = end

    def write(self, data: bytes) -> None:
        assert self.file is not None
        self.file.write(data)

    @abstractmethod
    def head(self, width: int, height: int) -> None:
        """Start a video of this size."""

    @abstractmethod
    def put(self, image: Image, same: NDArray[np.bool_], box: Box, lasts: int) -> None:
        """Write a part with a mask of pixels that are the ``same`` as before, and its duration in time units."""

    @abstractmethod
    def foot(self) -> None:
        """Finish the video."""


class _Gif(_Parts):
    unit = 0.01

    def head(self, width: int, height: int) -> None:
        self.write(b"GIF89a" + _little(2, width, height) + b"\x70\0\0")
        self.write(b"\x21\xff\x0bNETSCAPE2.0\x03\x01\0\0\0")  # endless loop

    def put(self, image: Image, same: NDArray[np.bool_], box: Box, lasts: int) -> None:
        from PIL import Image as Pictures

        alone = io.BytesIO()
        few = Pictures.fromarray(image).convert("P", palette=Pictures.Palette.ADAPTIVE, colors=CLEAR)
        number = np.where(same, CLEAR, np.asarray(few)).astype(np.uint8)
        clear = Pictures.fromarray(number)
        clear.putpalette([*(few.getpalette() or []), *bytes(768)][:768])
        clear.save(alone, format="GIF", interlace=False, optimize=False)
        palette, data = _gif_parts(alone.getvalue())
        bits = (len(palette) // 3).bit_length() - 2
        self.write(
            b"\x21\xf9\x04\x05" + _little(2, min(lasts, 65_535)) + bytes([CLEAR, 0])
        )  # keep until the next image
        self.write(b"\x2c" + _little(2, *box[:2], box[2] - box[0], box[3] - box[1]) + bytes([0x80 | bits]))
        self.write(palette + data)

    def foot(self) -> None:
        self.write(b"\x3b")


class _WebP(_Parts):
    unit = 0.001
    grid = 2

    def head(self, width: int, height: int) -> None:
        self.write(b"RIFF\0\0\0\0WEBP")
        self._chunk(b"VP8X", b"\x02\0\0\0" + _little(3, width - 1, height - 1))
        self._chunk(b"ANIM", bytes(6))

    def put(self, image: Image, same: NDArray[np.bool_], box: Box, lasts: int) -> None:
        from PIL import Image as Pictures

        alone = io.BytesIO()
        Pictures.fromarray(image).save(alone, format="WEBP")
        place = _little(3, box[0] // 2, box[1] // 2, box[2] - box[0] - 1, box[3] - box[1] - 1, min(lasts, 2**24 - 1))
        self._chunk(b"ANMF", place + b"\x02" + alone.getvalue()[12:])

    def foot(self) -> None:
        assert self.file is not None
        size = self.file.tell()
        self.file.seek(4)
        self.write(_little(4, size - 8))

    def _chunk(self, name: bytes, data: bytes) -> None:
        self.write(name + _little(4, len(data)) + data + bytes(len(data) % 2))


def _changed(same: NDArray[np.bool_], grid: int) -> Box | None:
    """Return the smallest box around all changed pixels, None without changes.

    >>> same = np.ones((5, 8), dtype=np.bool_)
    >>> same[2:4, 3] = False
    >>> _changed(same, 1), _changed(same, 2), _changed(same | True, 1)
    ((3, 2, 4, 4), (2, 2, 4, 4), None)
    """
    rows, columns = np.flatnonzero(~np.all(same, axis=1)), np.flatnonzero(~np.all(same, axis=0))
    if not len(rows):
        return None
    left, top = int(columns[0]) // grid * grid, int(rows[0]) // grid * grid
    return left, top, int(columns[-1]) + 1, int(rows[-1]) + 1


def _gif_parts(data: bytes) -> tuple[bytes, bytes]:
    """Return palette and compressed pixels of a GIF of one image."""
    end = 13 + 3 * 2 ** ((data[10] & 7) + 1)
    palette, at = data[13:end], end
    while data[at] == 0x21:  # an extension: a label and blocks
        at = _after_blocks(data, at + 2)
    at += 10
    return palette, data[at : _after_blocks(data, at + 1)]


def _after_blocks(data: bytes, at: int) -> int:
    while data[at]:
        at += 1 + data[at]
    return at + 1


def _little(size: int, *values: int) -> bytes:
    return b"".join(value.to_bytes(size, "little") for value in values)


def av_module() -> Any:
    """Return the module ``av``, which writes MP4.

    Raises:
        MissingExtra: it is not installed.
    """
    return import_optional("av", "a video as .mp4", "sim")
