"""Robots of other makers in the drive laboratory, from their own files."""

from __future__ import annotations

import contextlib
import re
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from crowdbot.world import Robot, import_robot


@contextlib.contextmanager
def maker_robot(file: Path) -> Iterator[tuple[Robot, str]]:
    """Import a robot as ``crowdbot new robot FILE --yes`` does, and yield it with its kind of base.

    Its folder exists only inside the context.

    Args:
        file: URDF, xacro or SDF file of a whole robot.

    Raises:
        RobotError: the file has errors, or has no mass.
        InputError: the file is missing, or a controller file beside it cannot be read.

    >>> from importlib.resources import files
    >>> with maker_robot(files("crowdbot") / "assets/robots/turtlebot2/turtlebot2.urdf") as (robot, kind):
    ...     print(robot.name, kind)
    turtlebot2 differential
    """
    name = re.sub(r"[^\w-]", "_", file.name.partition(".")[0], flags=re.ASCII).lstrip("_-0123456789") or "robot"
    with tempfile.TemporaryDirectory() as place:
        made = import_robot(file, name)
        folder = Path(place) / name
        folder.mkdir()
        for path, source in made.copies.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, folder / path)
        for path, text in made.texts.items():
            (folder / path).write_text(text, encoding="utf-8")
        yield Robot.load(folder), made.kind
