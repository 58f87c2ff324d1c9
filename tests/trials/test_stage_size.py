"""Stages that are implausibly small or large, and areas in degrees."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from crowdbot.core import InputError
from crowdbot.trials import Stage, builtin_trials, load_trial, parse_trial, trial_remarks

TRIAL = """<trial name="t" duration="2">
  <stage {stage}>{walls}</stage>
  <crowd type="orca"/>
  {people}
</trial>
"""


def remarks(stage: str = "", walls: str = "", people: str = "", folder: Path | None = None) -> list[str]:
    """Return the remarks on the size of a stage."""
    found = trial_remarks(parse_trial(TRIAL.format(stage=stage, walls=walls, people=people), folder=folder))
    return [sentence for sentence in found if " m x " in sentence]


def box(wide: float, deep: float) -> str:
    """Return the corners of a rectangle."""
    return f"0,0 {wide},0 {wide},{deep} 0,{deep}"


@pytest.mark.parametrize(
    ("wide", "deep", "sentence"),
    [
        (0.02, 0.008, "the walkable area is 0.02 m x 0.008 m, below 2 m in each direction: .*degrees.*millimetres"),
        (1.9, 1.5, "the walkable area is 1.9 m x 1.5 m, below 2 m"),
        (20_000, 8000, "the walkable area is 20000 m x 8000 m, above 2000 m: .*millimetres, or pixels"),
        (5, 2500, "the walkable area is 5 m x 2500 m, above 2000 m"),
    ],
)
def test_an_implausible_walkable_area_is_told(wide: float, deep: float, sentence: str) -> None:
    (found,) = remarks(f'walkable="{box(wide, deep)}"')
    assert re.match(sentence, found)
    x, y = wide, deep
    (found,) = remarks(f'area="POLYGON ((0 0, {x} 0, {x} {y}, 0 {y}, 0 0))"')
    assert re.match(sentence, found)


@pytest.mark.parametrize(("wide", "deep"), [(2.0, 0.5), (20, 8), (2000, 2000), (1, 30)])
def test_a_plausible_walkable_area_is_not(wide: float, deep: float) -> None:
    assert not remarks(f'walkable="{box(wide, deep)}"')


@pytest.mark.parametrize(
    ("wall", "people", "count"),
    [
        ('<wall points="0,0 0.02,0 0.02,0.01"/>', "", 1),
        ('<obstacle points="0,0 0.4,0 0.4,0.4"/>', "", 1),
        ('<obstacle points="0,0 0.4,0 0.4,0.4"/>', '<agent x="3" y="0"/>', 0),
        ('<obstacle points="0,0 0.4,0 0.4,0.4"/>', '<spawner count="1" zone="3,0 5,0 5,2" goal="-3,0 -5,0 -5,2"/>', 0),
        ('<wall points="0,0 9,0"/>', "", 0),
        ('<wall points="0,0 9000,0"/>', '<agent x="3" y="1"/>', 1),
        ("", "", 0),
    ],
)
def test_walls_on_open_ground(wall: str, people: str, count: int) -> None:
    assert len(remarks(walls=wall, people=people)) == count


def test_no_built_in_trial_has_an_implausible_stage() -> None:
    for name in builtin_trials():
        assert not [sentence for sentence in trial_remarks(load_trial(name)) if " m x " in sentence], name


def geojson(folder: Path, *corners: tuple[float, float], crs: Any = None, kind: str = "Polygon") -> Stage:
    """Return a stage from a GeoJSON file."""
    shape: dict[str, Any] = {"type": "Polygon", "coordinates": [[*corners, corners[0]]]}
    if kind == "FeatureCollection":
        shape = {"type": kind, "features": [{"type": "Feature", "properties": {}, "geometry": shape}]}
    if crs is not None:
        shape["crs"] = crs
    (folder / "area.geojson").write_text(json.dumps(shape))
    return Stage(area="area.geojson", folder=folder)


def named(name: Any) -> dict[str, Any]:
    """Return a reference system as GeoJSON of 2008 has it."""
    return {"type": "name", "properties": {"name": name}}


@pytest.mark.parametrize("kind", ["Polygon", "FeatureCollection"])
@pytest.mark.parametrize(("x", "y", "step"), [(-122.4, 37.8, 0.001), (2.35, 48.85, 0.02), (151.2, -33.86, 0.0001)])
def test_geojson_in_degrees_is_refused(tmp_path: Path, x: float, y: float, step: float, kind: str) -> None:
    with pytest.raises(InputError, match="its coordinates look like degrees of longitude and latitude; project it"):
        geojson(tmp_path, (x, y), (x + step, y), (x + step, y + step), kind=kind)


@pytest.mark.parametrize(
    "name",
    ["urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326", "urn:ogc:def:crs:EPSG::4258", "urn:ogc:def:crs:EPSG:6.6:4326"],
)
def test_geojson_that_names_a_system_in_degrees_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"area.geojson is in degrees \(.*remove its \"crs\" if"):
        geojson(tmp_path, (6, 50), (9, 50), (9, 53), crs=named(name))


@pytest.mark.parametrize(
    ("corners", "crs"),
    [
        (((0, 0), (16, 0), (16, 6)), None),
        (((0, 0), (16, 0), (16, 6)), named("urn:ogc:def:crs:EPSG::25832")),
        (((500, 0), (516, 0), (516, 6)), named("EPSG:4326")),
        (((0, 0), (16, 0), (16, 6)), named(4326)),
        (((0, 0), (16, 0), (16, 6)), "EPSG:4326"),
        (((0, 0), (0.05, 0), (0.05, 0.02)), None),
        (((7, 50), (8, 50), (8, 50.5)), None),
    ],
)
def test_geojson_in_metres_is_read(tmp_path: Path, corners: tuple[tuple[float, float], ...], crs: Any) -> None:
    assert geojson(tmp_path, *corners, crs=crs).bounded


def test_a_small_area_that_may_be_degrees_is_told(tmp_path: Path) -> None:
    geojson(tmp_path, (7, 50), (8, 50), (8, 50.5))
    assert "may be degrees" in remarks('area="area.geojson"', folder=tmp_path)[0]
