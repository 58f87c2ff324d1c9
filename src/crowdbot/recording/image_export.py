"""Exported pictures: the colour images of an episode as PNG files, in a folder next to the table that names them."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.sensors import RgbImage

from .reading_tables import READING_TABLES
from .step_records import RecordedStep

__all__ = ["ImageExport", "folder_of"]


def folder_of(table: Path) -> Path:
    """Return the folder of the images of a table.

    >>> folder_of(Path("out/pictures.csv")).name
    'pictures-images'
    """
    return table.with_name(f"{table.stem}-images")


class ImageExport:
    """Writes images while their table is made, to a folder of another name until all are there.

    Args:
        table: the file of the table.
    """

    def __init__(self, table: Path) -> None:
        self.folder = folder_of(table)
        self.draft = table.with_name(f".{table.name}.{os.getpid()}.images")

    def columns(self, moment: RecordedStep, bodies: Mapping[str, tuple[int, float]]) -> dict[str, Any]:
        """Write the images of an instant, and return the rows of the table with their files."""
        rows = READING_TABLES["pictures"](moment, bodies)
        files = [
            self._written(topic, reading) for topic, reading in moment.readings.items() if isinstance(reading, RgbImage)
        ]
        return {**rows, "file": np.array(files, dtype=object)}

    def finish(self) -> None:
        """Give the images their folder; others that lie in it stay."""
        if self.draft.is_dir():
            self.folder.mkdir(exist_ok=True)
            for file in sorted(self.draft.iterdir()):
                file.replace(self.folder / file.name)

    def drop(self) -> None:
        """Remove what is not finished."""
        shutil.rmtree(self.draft, ignore_errors=True)

    def _written(self, topic: str, picture: RgbImage) -> str:
        """Write an image, named by its sensor and its time [ns], and return its name as seen from the table."""
        from PIL import Image

        name = f"{re.sub(r'[^A-Za-z0-9_]+', '-', topic)}-{round(picture.time * 1e9):013d}.png"
        self.draft.mkdir(parents=True, exist_ok=True)
        Image.fromarray(picture.rgb[0]).save(self.draft / name, format="PNG")
        return f"{self.folder.name}/{name}"
