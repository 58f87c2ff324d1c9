"""Writer of images and videos: PNG, JPEG, GIF, WebP, MP4, or a folder of numbered PNG files."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, lock_output

from .camera_images import RenderedImage
from .video_writer import av_module, reel

IMAGES = (".png", ".jpg", ".webp")
FILMS = (".mp4", ".gif", ".webp")
FARTHEST = 20.0
"""Depth [m] shown as black in videos."""
LABELS = {-1: 0, -2: 1, -3: 2, -4: 3}
"""Values in the PNG of a segmentation: background, wall, floor, prop; persons and robots are 4 plus their id."""


class ImageWriter:
    """Writes images to files; a file appears complete or not at all.

    Args:
        path: a file with an extension of :data:`IMAGES` (one image) or :data:`FILMS`, or a folder.
        film: whether to write a video.
        rate: frame rate of a video [Hz].
        force: whether existing files may be overwritten.

    Raises:
        InputError: the file name extension is unknown, the folder does not exist, or the file exists and ``force`` is
            false.
        MissingExtra: the file is an MP4 and av is not installed.
    """

    def __init__(self, path: Path, film: bool, rate: float = 20.0, force: bool = False) -> None:
        self.path, self.film, self.rate, self.force = path, film, rate, force
        known = FILMS if film else IMAGES
        self.folder = path.suffix == "" or path.is_dir()
        if not self.folder and path.suffix.lower() not in known:
            video = "" if film else f", or in {', '.join(FILMS)} for a video with --to T"
            raise InputError(
                f"{path} must end in {', '.join(known)} for {'a video' if film else 'an image'}{video}, or be a folder"
            )
        if not self.folder and path.parent.exists() and not path.parent.is_dir():
            raise InputError(f"{path.parent} is a file; use another path for {path.name}")
        if self.folder and path.is_file():
            raise InputError(f"{path} is a file without a known extension; use {', '.join(known)}, or a folder")
        self._check_overwrite()
        if path.suffix.lower() == ".mp4":
            av_module()

    def write(self, shots: Iterable[RenderedImage]) -> tuple[list[Path], int]:
        """Write the images and return the files and the number of images.

        Raises:
            InputError: a file cannot be written.
        """
        shots = iter(shots)
        first = next(shots)
        kinds = ["rgb", *(name for name in ("depth", "segmentation") if getattr(first, name) is not None)]
        every = itertools.chain([first], shots)
        try:
            (self.path if self.folder else self.path.parent).mkdir(parents=True, exist_ok=True)
            with lock_output(self.path / "rgb-00000.png" if self.folder else self.path, self.force):
                if self.folder:
                    return self._numbered(every, kinds)
                if not self.film:
                    return [_saved(first, kind, self._named(kind)) for kind in kinds], 1
                return self._films(every, kinds)
        except OSError as error:
            raise InputError(f"cannot write {self.path}: {error.strerror or error}; use another path") from None

    def _check_overwrite(self) -> None:
        """Reject an existing file before a possibly long run."""
        found = (
            next(iter(sorted(self.path.glob("*-[0-9][0-9][0-9][0-9][0-9].png"))), None) if self.folder else self.path
        )
        if found is not None and found.exists() and not self.force:
            raise InputError(f"{found} already exists; use another path, or --force (force=True) to overwrite it")

    def _named(self, kind: str) -> Path:
        more = "" if kind == "rgb" else f"-{kind}"
        other = kind != "rgb" and not self.film
        return self.path.with_name(f"{self.path.stem}{more}{'.png' if other else self.path.suffix}")

    def _numbered(self, shots: Iterator[RenderedImage], kinds: list[str]) -> tuple[list[Path], int]:
        files: list[Path] = []
        count = 0
        for shot in shots:
            files += [_saved(shot, kind, self.path / f"{kind}-{count:05d}.png") for kind in kinds]
            count += 1
        return files, count

    def _films(self, shots: Iterator[RenderedImage], kinds: list[str]) -> tuple[list[Path], int]:
        reels = [reel(self._named(kind), self.rate) for kind in kinds]
        count = 0
        try:
            for shot in shots:
                count += 1
                for kind, item in zip(kinds, reels, strict=True):
                    item.add(_painted(shot, kind))
            return [item.finish() for item in reels], count
        finally:
            for item in reels:
                item.abandon()


def _saved(shot: RenderedImage, kind: str, path: Path) -> Path:
    """Write one image: depth in millimetres with 16 bits, segmentation as palette indices."""
    from PIL import Image

    if kind == "rgb":
        image = Image.fromarray(shot.rgb)
    elif kind == "depth":
        assert shot.depth is not None
        metres = np.where(np.isfinite(shot.depth), shot.depth, 0.0)
        image = Image.fromarray(np.clip(np.round(1000.0 * metres), 0, 65_535).astype(np.uint16))
    else:
        assert shot.segmentation is not None
        image = Image.fromarray(_numbers(shot.segmentation), mode="P")
        image.putpalette(_palette().ravel().tolist())
    part = path.with_name(f".{path.name}.part")
    kinds = {".png": "PNG", ".jpg": "JPEG", ".webp": "WEBP"}
    try:
        image.save(part, format=kinds[path.suffix.lower()])
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
    return path


def _painted(shot: RenderedImage, kind: str) -> NDArray[np.uint8]:
    if kind == "rgb":
        return shot.rgb
    if kind == "depth":
        assert shot.depth is not None
        return painted_depth(shot.depth)
    assert shot.segmentation is not None
    return color_segmentation(shot.segmentation)


def painted_depth(depth: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return depth ``[H, W]`` [m] as a grey image ``[H, W, 3]``: near is white, 20 m and farther is black.

    >>> painted_depth(np.array([[0.0, 10.0, np.inf]]))[0, :, 0].tolist()
    [255, 128, 0]
    """
    grey = np.round(255.0 * (1.0 - np.clip(np.where(np.isfinite(depth), depth, FARTHEST) / FARTHEST, 0.0, 1.0)))
    return np.repeat(grey.astype(np.uint8)[..., None], 3, axis=-1)


def color_segmentation(who: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Return a segmentation ``[H, W]`` as an image ``[H, W, 3]``, one colour per object; the background is black.

    >>> color_segmentation(np.array([[-1, -3, 5]])).shape
    (1, 3, 3)
    """
    return _palette()[_numbers(who)]


def _numbers(who: NDArray[np.int64]) -> NDArray[np.uint8]:
    found = 4 + who % 252
    for code, number in LABELS.items():
        found = np.where(who == code, number, found)
    return found.astype(np.uint8)


def _palette() -> NDArray[np.uint8]:
    """Return the palette ``[256, 3]``: black, greys, then hues that differ between consecutive numbers."""
    hue = (np.arange(252) * 0.618034) % 1.0
    turn = (hue[:, None] * 6.0 + np.array([0.0, 4.0, 2.0])) % 6.0
    bright = np.clip(np.abs(turn - 3.0) - 1.0, 0.0, 1.0)
    people = np.round(255.0 * (0.25 + 0.75 * bright))
    return np.concatenate([[[0, 0, 0], [150, 150, 150], [90, 90, 90], [200, 170, 120]], people]).astype(np.uint8)
