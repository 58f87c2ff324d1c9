"""Export of the colour images of an episode as PNG files, in a folder beside their table."""

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


def folder_of(table: Path) -> Path:
    """Return the folder of the images of a table.

    >>> folder_of(Path("out/pictures.csv")).name
    'pictures-images'
    """
    return table.with_name(f"{table.stem}-images")


class ImageExport:
    """Writes images to a temporary folder while their table is written.

    Args:
        table: file of the table.
    """

    def __init__(self, table: Path) -> None:
        self.folder = folder_of(table)
        self.draft = table.with_name(f".{table.name}.{os.getpid()}.images")

    def columns(self, moment: RecordedStep, bodies: Mapping[str, tuple[int, float]]) -> dict[str, Any]:
        """Write the images of a step and return the rows of the table with their files."""
        rows = READING_TABLES["pictures"](moment, bodies)
        files = [
            self._written(topic, reading) for topic, reading in moment.readings.items() if isinstance(reading, RgbImage)
        ]
        return {**rows, "file": np.array(files, dtype=object)}

    def finish(self) -> None:
        """Move the images to their folder; other files in it are kept."""
        if self.draft.is_dir():
            self.folder.mkdir(exist_ok=True)
            for file in sorted(self.draft.iterdir()):
                file.replace(self.folder / file.name)

    def drop(self) -> None:
        """Remove unfinished images."""
        shutil.rmtree(self.draft, ignore_errors=True)

    def _written(self, topic: str, picture: RgbImage) -> str:
        """Write an image named by sensor and time [ns], and return its path relative to the table."""
        from PIL import Image

        name = f"{re.sub(r'[^A-Za-z0-9_]+', '-', topic)}-{round(float(picture.time) * 1e9):013d}.png"
        self.draft.mkdir(parents=True, exist_ok=True)
        Image.fromarray(picture.rgb[0]).save(self.draft / name, format="PNG")
        return f"{self.folder.name}/{name}"
