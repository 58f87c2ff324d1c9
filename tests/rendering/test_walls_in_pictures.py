"""Doors show in the overview, and cameras that show a wall are told."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.rendering import render_images
from crowdbot.trials import camera_remarks, load_trial, overview, parse_trial
from crowdbot.world import SceneCamera

WALL = -2
ROOMS = """<trial name="rooms" duration="1">
<stage walkable="-6,-4 6,-4 6,4 -6,4"><wall points="0,-4 0,-1"/><wall points="0,1 0,4"/>
<obstacle points="2,-2 4,-2 4,0 2,0"/></stage>
<crowd type="orca"/>
<camera name="eye" {pose} width="64" height="48"/></trial>"""


@pytest.mark.usefixtures("drawing")
def test_the_overview_shows_the_door_of_the_bottleneck() -> None:
    trial = load_trial("bottleneck")
    (shot,) = render_images(trial, "overview", segmentation=True)
    assert shot.segmentation is not None
    camera = overview(trial.stage, np.zeros((0, 2)))
    middle = shot.segmentation[:, camera.width // 2]
    walls = np.flatnonzero(middle == WALL)
    gaps = np.flatnonzero(np.diff(walls) > 20)
    assert len(gaps) == 1, "one door in the wall that is seen edge-on"
    columns = shot.segmentation[walls[gaps[0]] - 10]
    across = columns[camera.width // 2 - 10 : camera.width // 2 + 10]
    assert 3 <= np.count_nonzero(across == WALL) <= 8
    red = shot.rgb[walls[gaps[0]] - 10, camera.width // 2]
    assert red.max() < 110, "the top of the wall is darker than the floor"


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        ('x="-2" z="1.6"', ""),
        ('x="-0.1" y="2.5" z="1.6"', "looks at a wall: walls hide 100 % of the floor in its image"),
        ('x="0.005" y="2.5" z="1.6"', "is in a wall at 0.005,2.5"),
        ('x="3" y="-1" z="1.6"', "is in a wall at 3,-1"),
        ('x="3" y="-1" z="6" pitch="1.5"', ""),
        ('x="-9" z="1.0"', "looks at a wall: walls hide 100 % of the floor in its image"),
        ('x="-9" heading="3.14" z="1.0"', ""),
    ],
)
def test_cameras_in_or_behind_walls_are_told(pose: str, words: str) -> None:
    remarks = camera_remarks(parse_trial(ROOMS.format(pose=pose)))
    assert len(remarks) == bool(words)
    assert words in "".join(remarks)


def test_no_camera_of_a_builtin_trial_looks_at_a_wall() -> None:
    from crowdbot.trials import builtin_trials

    found = {name: camera_remarks(load_trial(name)) for name in builtin_trials()}
    assert not {name: remarks for name, remarks in found.items() if remarks}


@pytest.mark.usefixtures("drawing")
def test_the_program_tells_it_beside_the_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "behind.xml"
    file.write_text(ROOMS.format(pose='x="-0.1" y="2.5" z="1.6"'), encoding="utf-8")
    assert main(["render", str(file), "--out", str(tmp_path / "a.png")]) == 0
    assert "note: camera 'eye' looks at a wall" in capsys.readouterr().out
    assert main(["render", str(file), "--camera", "overview", "--out", str(tmp_path / "b.png"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["remarks"] == []
    assert main(["check", str(file)]) == 0
    assert "camera 'eye' looks at a wall" in capsys.readouterr().out


@pytest.mark.parametrize("width", [-0.1, float("inf"), float("nan")])
def test_strips_have_a_width(width: float) -> None:
    with pytest.raises(InputError, match="wall_tops"):
        SceneCamera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), wall_tops=width)
