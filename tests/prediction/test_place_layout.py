"""Layouts of places for recordings: trials, maps and areas; goals from a layout without tracks."""

from __future__ import annotations

import json

import numpy as np
import pytest

from crowdbot import cli
from crowdbot.calibration import goal_for
from crowdbot.core import DataError, InputError
from crowdbot.data import PlaceLayout, Recording
from crowdbot.trials import load_layout

HALL = """<trial name="hall" duration="5" step="0.1">
  <stage walkable="0,0 20,0 20,6 0,6"/>
  <crowd type="orca"/>
  <spawner count="2" zone="1,1 3,1 3,5 1,5" goal="18,1 19,1 19,5 18,5"/>
  {exits}
</trial>
"""


@pytest.fixture
def walkers(tmp_path):
    """Two people who walk along the hall, towards its right end."""
    rows = [f"{who},{0.4 * k:.1f},{2.0 + 0.5 * k},{1.5 + who}" for who in (1, 2) for k in range(24)]
    path = tmp_path / "walkers.csv"
    path.write_text("id,time,x,y\n" + "\n".join(rows) + "\n")
    return path


def hall(tmp_path, exits=""):
    path = tmp_path / "hall.xml"
    path.write_text(HALL.format(exits=exits))
    return path


def test_a_trial_has_walls_and_the_goal_zones_as_exits(tmp_path):
    layout = load_layout(hall(tmp_path))
    assert layout.exits == (((18.5, 1.0), (18.5, 5.0)),)
    assert layout.outside([(1.0, 1.0), (21.0, 1.0), (10.0, -0.5)]).tolist() == [False, True, True]


def test_the_exits_of_a_trial_come_first(tmp_path):
    layout = load_layout(hall(tmp_path, '<exit zone="0,2 1,2 1,4 0,4"/>'))
    assert layout.exits == (((0.5, 2.0), (0.5, 4.0)),)


def test_an_area_and_a_map(tmp_path):
    (tmp_path / "room.wkt").write_text("POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0), (4 4, 4 5, 5 5, 5 4, 4 4))")
    layout = load_layout(tmp_path / "room.wkt")
    assert layout.outside([(1.0, 1.0), (4.5, 4.5), (9.5, 1.0)]).tolist() == [False, True, True]
    (tmp_path / "map.pgm").write_bytes(b"P5 40 40 255\n" + bytes([0] * 400 + [254] * 1200))
    (tmp_path / "map.yaml").write_text(
        "image: map.pgm\nresolution: 0.1\norigin: [0.0, 0.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    )
    assert load_layout(tmp_path / "map.yaml").outside([(2.0, 3.5), (2.0, 1.5)]).tolist() == [True, False]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("plan.png", "", "plan.png is not a layout by its name; known are .xml"),
        ("room.wkt", "POINT (0 0)", "room.wkt is neither WKT nor GeoJSON of an area"),
        ("room.geojson", "{", "room.geojson is neither WKT nor GeoJSON"),
        ("hall.xml", "<trial", "hall.xml"),
    ],
)
def test_wrong_layouts(tmp_path, name, text, message):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=message):
        load_layout(tmp_path / name)


def test_a_trial_without_walls_is_no_layout(tmp_path):
    path = tmp_path / "open.xml"
    path.write_text('<trial name="open" duration="5"><stage/><crowd type="orca"/><agent x="0" y="0"/></trial>')
    with pytest.raises(InputError, match="open.xml has no walls; a layout needs walls"):
        load_layout(path)


def test_walls_that_are_not_finite():
    with pytest.raises(DataError, match="plan: walls need at least two finite points each"):
        PlaceLayout((((0.0, 0.0), (float("nan"), 1.0)),), name="plan")


def test_the_goal_of_a_layout_needs_no_tracks(tmp_path, walkers):
    recording = Recording(str(walkers), layout=load_layout(hall(tmp_path)))
    goal = goal_for("environment-layout", recording)
    past, _ = recording.windows
    aim = goal.resolve(past)[0]
    assert np.all(aim[:, 0] > 15.0)
    with pytest.raises(InputError, match="learns from recorded tracks of hall.xml; reserve a part"):
        goal_for("learned-destinations", recording)


def test_predict_and_calibrate_take_a_stage(tmp_path, walkers, capsys):
    words = [
        "--data",
        str(walkers),
        "--stage",
        str(hall(tmp_path)),
        "--goal",
        "environment-layout",
        "--model",
        "orca",
        "--json",
    ]
    assert cli.main(["predict", *words, "--predictor", "simulated"]) == 0
    assert "environment-layout" in json.dumps(json.loads(capsys.readouterr().out))
    assert cli.main(["calibrate", *words, "--budget", "20"]) == 0
    assert json.loads(capsys.readouterr().out)


def test_tracks_outside_of_the_stage_are_told(tmp_path, walkers, capsys):
    (tmp_path / "room.wkt").write_text("POLYGON ((0 0, 6 0, 6 9, 0 9, 0 0))")
    assert cli.main(["predict", "--data", str(walkers), "--stage", str(tmp_path / "room.wkt")]) == 0
    said = capsys.readouterr().err
    assert "walkers.csv: warning: 62% of the positions are in walls or outside of room.wkt; check" in said
