"""Stages from buildings in binary glTF: walls where they are, with doors, and wrong files."""

from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh
from PIL import Image

from crowdbot.cli import main
from crowdbot.core import Scene, TrialError
from crowdbot.recording import read_episode, record, replay
from crowdbot.trials import import_trial, load_trial
from crowdbot.world import PeopleMotion, Renderer, SceneCamera

ROOM = 6.0


def box(low, high):
    """Return a box between two corners with z up."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    return trimesh.creation.box(high - low, trimesh.transformations.translation_matrix(0.5 * (low + high)))


def building(folder: Path, *more) -> Path:
    """Write a room of 6 by 4 m with a door of 1 m in a wall at x = 0, a floor, a lintel, and more parts."""
    parts = [
        box((-6, -4, -0.1), (12, 8, 0.0)),  # floor
        box((-0.1, 0, 0), (0.1, 1.5, 2.5)), box((-0.1, 2.5, 0), (0.1, 4, 2.5)), box((-0.1, 1.5, 2.1), (0.1, 2.5, 2.5)),
        box((ROOM, 0, 0), (ROOM + 0.2, 4, 2.5)), *more,
    ]  # fmt: skip
    whole = trimesh.util.concatenate(parts)
    whole.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, (1, 0, 0)))  # y up
    path = folder / "hall.glb"
    path.write_bytes(trimesh.Scene(whole).export(file_type="glb"))
    return path


def test_walls_are_where_the_building_has_them_and_the_door_is_open(tmp_path):
    ((name, trial),) = import_trial(building(tmp_path)).trials
    lines = [shapely.LineString(wall.points) for wall in trial.stage.walls]
    whole = shapely.union_all(lines)
    assert name == "hall"
    for expected in (shapely.box(-0.1, 0, 0.1, 1.5), shapely.box(-0.1, 2.5, 0.1, 4), shapely.box(6, 0, 6.2, 4)):
        assert expected.exterior.hausdorff_distance(whole.intersection(expected.buffer(0.05))) < 0.03
    assert not whole.intersects(shapely.box(-1.0, 1.6, 1.0, 2.4))  # the lintel is above heads
    assert trial.stage.wall_height == pytest.approx(2.5, abs=0.02)


def test_what_is_low_counts_and_what_is_flat_does_not(tmp_path):
    bench, mat = box((2, 1, 0), (3, 1.4, 0.45)), box((2, 2, 0), (3, 3, 0.04))
    ((_, trial),) = import_trial(building(tmp_path, bench, mat)).trials
    whole = shapely.union_all([shapely.LineString(wall.points) for wall in trial.stage.walls])
    assert whole.intersects(shapely.box(2.1, 0.9, 2.9, 1.5))
    assert not whole.intersects(shapely.box(1.9, 1.9, 3.1, 3.1))


def test_the_program_writes_a_trial_that_can_be_read(tmp_path, capsys):
    file = tmp_path / "stage.xml"
    assert main(["new", "trial", str(file), "--import", str(building(tmp_path))]) == 0
    assert "people and robots are not in the file" in capsys.readouterr().out
    assert len(load_trial(file).stage.walls) == 3


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"glTF", r"hall.glb: "),
        (b"", r"hall.glb: "),
        (None, r"there is no glTF file .*hall.glb"),
    ],
)
def test_a_wrong_file_is_refused_in_a_sentence(tmp_path, data, message):
    file = tmp_path / "hall.glb"
    if data is not None:
        file.write_bytes(data)
    with pytest.raises(TrialError, match=message) as error:
        import_trial(file)
    assert "\n" not in str(error.value)


def test_a_file_without_walls_and_layers_are_refused(tmp_path):
    flat = box((0, 0, 0), (4, 4, 0.1))
    file = tmp_path / "flat.glb"
    file.write_bytes(trimesh.Scene(flat.apply_transform(
        trimesh.transformations.rotation_matrix(-np.pi / 2, (1, 0, 0)))).export(file_type="glb"))  # fmt: skip
    with pytest.raises(TrialError, match=r"nothing is 0.25, 0.9 or 1.6 m above the floor"):
        import_trial(file)
    with pytest.raises(TrialError, match=r"layers and units belong to drawings in DXF"):
        import_trial(file, layers=["walls"])


RED, GREEN = (200, 20, 20), (20, 180, 20)


def picture(color) -> Image.Image:
    return Image.fromarray(np.full((8, 8, 3), color, dtype=np.uint8))


def furnished(folder: Path) -> Path:
    """Write a hall with a textured red floor, plain green walls, a ceiling, and two doors in a wall at x = 4."""
    scene = trimesh.Scene()
    turn = trimesh.transformations.rotation_matrix(-np.pi / 2, (1, 0, 0))

    def add(name, mesh, material):
        uv = np.asarray(mesh.vertices)[:, :2]
        mesh.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
        scene.add_geometry(mesh.apply_transform(turn), node_name=name, geom_name=name)

    red = trimesh.visual.material.PBRMaterial(baseColorTexture=picture(RED), metallicFactor=0.0)
    green = trimesh.visual.material.PBRMaterial(baseColorFactor=[*GREEN, 255], metallicFactor=0.0)
    add("floor", box((-4, -4, -0.2), (8, 4, 0.0)), red)
    add("ceiling", box((-4, -4, 2.8), (8, 4, 3.0)), green)
    for number, (low, high) in enumerate(((-4, -2), (-1, 1), (2, 4))):
        add(f"wall {number}", box((3.9, low, 0), (4.1, high, 2.8)), green)
    add("Door left", box((3.98, -2, 0), (4.02, -1, 2.1)), red)
    add("Door_right", box((3.98, 1, 0), (4.02, 2, 2.1)), red)
    add("doorframe", box((3.9, -2, 2.1), (4.1, -1, 2.8)), green)
    path = folder / "hall.glb"
    path.write_bytes(scene.export(file_type="glb"))
    return path


def test_doors_are_doors_and_the_rest_is_walls(tmp_path):
    ((_, trial),) = import_trial(furnished(tmp_path)).trials
    assert [door.name for door in trial.stage.doors] == ["Door left", "Door_right"]
    for door, low in zip(trial.stage.doors, (-2.0, 1.0), strict=True):
        ends = np.array(sorted(door.points))
        np.testing.assert_allclose(ends[:, 0], 4.0, atol=0.01)
        np.testing.assert_allclose(np.sort(ends[:, 1]), [low, low + 1.0], atol=0.01)
        assert door.height == pytest.approx(2.1, abs=0.01)
        assert door.opening == "approach"
    whole = shapely.union_all([shapely.LineString(wall.points) for wall in trial.stage.walls])
    assert not whole.intersects(shapely.box(3.5, -1.9, 4.5, -1.1))
    assert whole.intersects(shapely.box(3.5, -0.5, 4.5, 0.5))


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("renderer", ["software", "opengl"])
def test_pictures_show_the_materials_of_the_building(tmp_path, renderer):
    file = furnished(tmp_path)
    stage = import_trial(file).trials[0][1].stage
    scene = Scene.of([[0.0, 0.0]], walls=[np.array(wall.points) for wall in stage.walls])
    view = Renderer(scene, {}, stage.physical(), PeopleMotion(scene, np.zeros(0, dtype=np.int64)))
    camera = SceneCamera((-3.0, 0.0, 1.6), (4.0, 0.0, 0.9), 160, 120, renderer=renderer)
    images = view.images(camera, segmentation=True, depth=True)
    inner = slice(None), slice(60, 100)  # the hall is open at its sides
    colors, codes = images.rgb[inner].astype(int), images.segmentation[inner]
    wall, floor = colors[codes == -2], colors[codes == -3]
    assert np.mean(wall[:, 1] > wall[:, 0] + 30) > 0.9  # green
    assert np.mean(floor[:, 0] > floor[:, 1] + 30) > 0.99  # red
    middle = images.depth[55, 80]
    assert middle == pytest.approx(6.9, abs=0.05)  # the wall between the doors
    above = SceneCamera((0.0, -0.1, 12.0), (0.0, 0.0, 0.0), 80, 60, renderer=renderer, wall_tops=0.1)
    seen = view.images(above, segmentation=True)
    assert np.mean(seen.segmentation == -3) > 0.3  # no ceiling


def test_the_program_copies_the_building_and_a_robot_sees_walls_and_doors(tmp_path, capsys):
    (tmp_path / "from").mkdir()
    (tmp_path / "to").mkdir()
    original, file = furnished(tmp_path / "from"), tmp_path / "to" / "hall.xml"
    assert main(["new", "trial", str(file), "--import", str(original)]) == 0
    assert "copied hall.glb to the folder of the trial" in capsys.readouterr().out
    text = file.read_text(encoding="utf-8").replace(
        "</trial>", '<robot name="robot" type="turtlebot2" x="0" y="-1.5"><goal x="0.5" y="-1.5"/>'
        '<navigator type="straight"/><sensor name="scan" type="lidar2d" rays="181" field-of-view="1.5" z="0.5"/>'
        "</robot></trial>")  # fmt: skip
    file.write_text(text, encoding="utf-8")
    trial = load_trial(file, duration=0.2)
    summary = record(trial, out=tmp_path / "run")
    (tmp_path / "to" / "hall.glb").rename(tmp_path / "gone.glb")
    episode = read_episode(tmp_path / "run" / "episode.mcap")
    assert summary.outcome is not None
    assert replay(tmp_path / "run" / "episode.mcap").equal  # the episode carries the building along
    scan = episode.readings["robot/scan"][0]
    ahead = float(np.asarray(scan.ranges)[0, 90])
    assert 3.4 < ahead < 4.1
    with pytest.raises(TrialError, match=r"building=.hall.glb.: there is no file 'hall.glb'"):
        load_trial(file)
