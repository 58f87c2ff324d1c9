"""Calibrations and odometry of videos: wrong and mutated files end with a sentence."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest

from crowdbot.core import DataError, InputError
from crowdbot.evaluation.tracking import camera_files
from crowdbot.evaluation.tracking.camera_files import read_camera, read_odometry

CAMERA = """image_width: 640
image_height: 480
distortion_model: plumb_bob
camera_matrix: {rows: 3, cols: 3, data: [552.5, 0.0, 319.5, 0.0, 552.5, 239.5, 0.0, 0.0, 1.0]}
distortion_coefficients: {rows: 1, cols: 5, data: [0.0, 0.0, 0.0, 0.0, 0.0]}
mount: {x: 0.1, y: 0.0, z: 1.2, yaw: 0.2}
"""
ODOMETRY = "time,x,y,heading\n" + "".join(f"{0.1 * k:.1f},{0.05 * k:.2f},0,{0.01 * k:.2f}\n" for k in range(20))
READERS = {"camera.yaml": (CAMERA, read_camera), "odometry.csv": (ODOMETRY, read_odometry)}
ODD = [
    "nan", ".inf", "-1", "0", "1e400", "1" * 400, "9" * 5000, "[]", "{}", "null", "''", "true", "*a", "&a ", ": ", "- ",
    "\x00", "!!python/object:os.system x", "[[1]]", "~", "1e308", "'", ",", "\n", "2024-01-01", "0x10", "1_000", "1:30",
]  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("640", "1" * 400, "image_width = a number beyond the limit must be a number up to 1e"),
        ("data: [552.5", f"data: [-{'9' * 310}", "camera_matrix = a number beyond the limit must be"),
        ("z: 1.2", "z: 1e300", r"z = 1e\+300 must be a number up to 1e"),
        ("480", "480.5", "image_height = 480.5 must be a whole number of pixels"),
        ("plumb_bob", f"[{'9, ' * 500}9]", r"distortion_model = \[9, 9, 9.{40,60}\.\.\. is not supported"),
        ("yaw: 0.2", "yaw: .nan", "yaw = nan must be a number"),
        ("yaw: 0.2", "yaw: true", "yaw = True must be a number"),
        ("z: 1.2", "z: 0", "mount z = 0.0 m must be above 0"),
    ],
)
def test_wrong_calibrations_are_told(old: str, new: str, words: str, tmp_path: Path) -> None:
    file = tmp_path / "camera.yaml"
    file.write_text(CAMERA)
    assert read_camera(file).mount == (0.1, 0.0, 1.2, 0.0, 0.0, 0.2)
    file.write_text(CAMERA.replace(old, new, 1))
    with pytest.raises(DataError, match=words):
        read_camera(file)


@pytest.mark.parametrize("end", ["", "\n", "\n\n# the end\n"])
def test_odometry_beyond_the_limit_of_rows_is_told(end: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "odometry.csv"
    file.write_text(ODOMETRY.rstrip() + end)
    monkeypatch.setattr(camera_files, "MOST_ROWS", 20)
    assert len(read_odometry(file).time) == 20
    monkeypatch.setattr(camera_files, "MOST_ROWS", 19)
    with pytest.raises(DataError, match="odometry.csv has more than 19 rows of odometry, the limit; split it in time"):
        read_odometry(file)


def mutated(text: str, rng: random.Random) -> str:
    """Return the text with one to three changes."""
    for _ in range(rng.randint(1, 3)):
        spans = [match.span() for match in re.finditer(r"-?\d+\.?\d*" if rng.random() < 0.5 else r"\w+", text)]
        begin, end = rng.choice(spans or [(0, 0)])
        text = text[:begin] + rng.choice(ODD) + text[end if rng.random() < 0.8 else begin :]
        lines = text.splitlines(keepends=True)
        if rng.random() < 0.3 and lines:
            del lines[rng.randrange(len(lines))]
            text = "".join(lines)
    return text


@pytest.mark.parametrize("name", READERS)
def test_mutated_files_are_read_or_told(name: str, tmp_path: Path) -> None:
    text, read = READERS[name]
    file = tmp_path / name
    read_files, refusals = 0, list[str]()
    for number in range(300):
        file.write_text(mutated(text, random.Random(number)), encoding="utf-8")
        try:
            read(file)
            read_files += 1
        except InputError as error:  # any other error fails the test
            refusals.append(str(error).strip())
    assert read_files > 5
    assert len(refusals) > 5
    assert not [text for text in refusals if "\n" in text]


def test_blank_lines_of_odometry_are_skipped(tmp_path: Path) -> None:
    file = tmp_path / "odometry.csv"
    file.write_text(ODOMETRY.replace("0.5,", "\n# the robot turns\n0.5,", 1) + "\n\n")
    assert len(read_odometry(file).time) == 20
