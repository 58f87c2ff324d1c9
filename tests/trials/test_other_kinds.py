"""Files that no importer reads say what they are; models and lists of goals that are read."""

from __future__ import annotations

import json

import pytest

from crowdbot.core import TrialError, strict_xml
from crowdbot.trials.importers.foreign import import_trial

IFC = "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('ViewDefinition'),'2;1');\nFILE_SCHEMA(('IFC4'));\nENDSEC;\n"
AREA = {"type": "Polygon", "coordinates": [[[0, 0], [9, 0], [9, 5], [0, 0]]]}


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("hall.ifc", IFC, "is a building in IFC, which is not read; export it as binary glTF"),
        ("hall.txt", "\ufeff" + IFC.replace("IFC4", "IFC2X3"), "is a building in IFC"),
        ("part.stp", "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));", "is a STEP file"),
        ("hall.dwg", "AC1032\x00\x00", "is a drawing in DWG, which is not read; export its walls as ASCII DXF"),
        ("hall.wkt", "POLYGON ((0 0, 9 0, 9 5, 0 0))", 'is a walkable area in WKT; .*<stage area="hall.wkt"/>'),
        ("hall.txt", "multipolygon(((0 0, 9 0, 9 5, 0 0)))", 'is a walkable area in WKT; .*<stage area="hall.txt"/>'),
        ("hall.geojson", json.dumps(AREA), 'is an area in GeoJSON; .*<stage area="hall.geojson"/>'),
        ("hall.json", json.dumps({"type": "FeatureCollection", "features": []}), "is an area in GeoJSON"),
        ("map.yaml", "image: a.pgm\nresolution: 0.05\norigin: [0, 0, 0]", 'is a map of ROS; .*<stage map="map.yaml"/>'),
        ("a.pgm", "P5\n3 3\n255\n012345678", "is a picture; a map of ROS is its .yaml beside it"),
        ("a.svg", "<svg width='3'/>", "is a drawing in SVG"),
        ("b.svg", "<?xml version='1.0'?>\n<!DOCTYPE svg PUBLIC 'a' 'b'>\n<svg width='3'/>", "is a drawing in SVG"),
        ("a.osm", "<osm version='0.6'><node id='1'/></osm>", "is a map of OpenStreetMap"),
        ("r.urdf", "<robot name='r'><link name='a'/></robot>", "is a robot in URDF; convert it by crowdbot new robot"),
        ("t.xml", "<trial name='a'/>", "is a trial of crowdbot already"),
        ("m.xml", "<mujoco><worldbody/></mujoco>", "is a model of MuJoCo"),
        ("c.json", json.dumps({"config": {}, "distributions": {}, "exits": {}}), "its walkable area is missing: put"),
        ("c.json", json.dumps({"rooms": 3}), 'is not a JSON scene .* it has "rooms"; scenarios of Vadere have'),
        ("c.json", "[1, 2]", "is not a JSON scene that can be imported, it is a list"),
        ("c.yaml", "repos: []", 'is not a YAML scene .* it has "repos"; files of HuNavSim .* worlds of IR-SIM'),
        ("a.csv", "id,time,x,y\n1,0.0,2,3\n", "is probably a recording of people, .*crowdbot predict --data"),
        ("a.txt", "0 1 2.5 3.5\n10 1 2.6 3.5\n", "is probably a recording of people"),
        ("a.bag", "#ROSBAG V2.0\n", "is probably a recording of people"),
        ("hall.stl", "solid hall\n  facet normal 0 0 1\n", "is a mesh in STL; export it as binary glTF"),
        ("hall.obj", "# Blender\n\nmtllib hall.mtl\no Cube\nv 1 1 -1\n", "is a mesh in OBJ"),
        ("hall.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n", "is a mesh in OBJ"),
        ("hall.pcd", "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\n", "is a cloud of points or a mesh"),
        ("hall.xml", "<!DOCTYPE html>\n<html lang='en'><head/></html>", "is a web page, perhaps about the file"),
    ],
)  # fmt: skip
def test_a_file_that_is_not_read_says_what_it_is(tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content.encode())
    with pytest.raises(TrialError, match=f"{name}.*{words}"):
        import_trial(tmp_path / name)


@pytest.mark.parametrize(
    ("name", "content", "begins"),
    [
        ("pyproject.toml", "[build-system]\nrequires = []\n", r"'\[build-system\]'"),
        ("setup.cfg", "[metadata]\nname = hall\n", r"'\[metadata\]'"),
        ("scene.xacro.j2", "{% for i in range(3) %}", "'{% for"),
        ("poetry.toml", "name = 3\n", "'name = 3'"),
        ("README.md", "\n# A hall\nSee a.xml, too.\n", "'# A hall'"),
        ("run.sh", "#!/bin/sh\nexec crowdbot\n", "'#!/bin/sh'"),
        ("hall.cpp", "#include <hall>\n", "'#include <hall>'"),
        ("hall.rtf", "{\\rtf1 hall}", r"'{\\\\rtf1 hall}'"),
        ("hall.so", "\x7fELF\x02\x01", r"'\\x7fELF"),
    ],
)
def test_a_file_of_an_unknown_kind_is_named_as_such_with_the_kinds_that_are_imported(tmp_path, name, content, begins):
    (tmp_path / name).write_bytes(content.encode())
    with pytest.raises(
        TrialError, match=f"{name} is of no kind that is imported, it begins with {begins}.*; scenes are"
    ):
        import_trial(tmp_path / name)


@pytest.mark.parametrize("content", ['{"scenario": ', "[1,", '{"a": 1}, 2', "{\n  // a scene\n  scenario", '[\n  "a"'])
def test_damaged_json_is_named_as_json(tmp_path, content):
    (tmp_path / "a.scenario").write_text(content)
    with pytest.raises(TrialError, match="is not JSON: "):
        import_trial(tmp_path / "a.scenario")


WALL = (
    "<link name='l'><pose>1 2 1 0 0 0</pose><collision name='c'><geometry><box><size>4 0.2 2</size></box></geometry>"
    "</collision></link>"
)


@pytest.mark.parametrize(
    ("text", "middle"),
    [
        (f"<sdf version='1.6'><model name='house'><static>1</static>{WALL}</model></sdf>", (1.0, 2.0)),
        (f"<sdf version='1.4'><model name='house'><pose>3 0 0 0 0 0</pose>{WALL}</model></sdf>", (4.0, 2.0)),
        (f"<gazebo version='1.0'><model name='house'>{WALL}</model></gazebo>", (1.0, 2.0)),
        (f"<sdf version='1.9'><model name='a'><model name='house'>{WALL}</model></model></sdf>", (1.0, 2.0)),
        (
            f"<sdf version='1.7'><model name='a'><pose>1 1 0 0 0 1.5707963267948966</pose>{WALL}</model></sdf>",
            (-1.0, 2.0),
        ),
    ],
)
def test_a_model_of_gazebo_is_a_scene(tmp_path, text, middle):
    (tmp_path / "model.sdf").write_text(text)
    done = import_trial(tmp_path / "model.sdf")
    (wall,) = done.trials[0][1].stage.obstacles
    x, y = (sum(axis) / 4 for axis in zip(*wall.points, strict=True))
    assert (round(x, 6), round(y, 6)) == middle
    assert "the file has a model and no world: the model stands at its own pose" in done.left_out
    assert not [note for note in done.left_out if "actors" in note]


def test_a_model_of_gazebo_that_is_a_robot_or_only_ground_is_named(tmp_path):
    joint = "<joint name='j' type='continuous'><parent>l</parent><child>w</child></joint>"
    file = tmp_path / "model.sdf"
    file.write_text(f"<sdf version='1.6'><model name='r'>{WALL}<link name='w'/>{joint}</model></sdf>")
    with pytest.raises(TrialError, match=r"has joints and a wheel \(joint 'j'\), and is probably a robot"):
        import_trial(file)
    ground = "<heightmap><uri>a.png</uri><size>20 10 3</size></heightmap>"
    file.write_text(
        "<sdf version='1.6'><model name='hill'><link name='l'><collision name='c'>"
        f"<geometry>{ground}</geometry></collision></link></model></sdf>"
    )
    with pytest.raises(TrialError, match=r"no solids, .*<heightmap> a.png .* its ground of 20 x 10 m .* is level here"):
        import_trial(file)


ROBOT = "robot:\n  kinematics: {{name: diff}}\n  state: [1, 1, 0]\n{}world: {{height: 10, width: 10}}\n"


@pytest.mark.parametrize(
    ("goals", "last"),
    [
        ("  goal: [9, 8, 0]\n", [(9.0, 8.0)]),
        ("  goal: [[9, 9, 0], [3, 4, 2]]\n", [(3.0, 4.0)]),
        ("  goal:\n    - [[9, 9, 0], [2, 4, 1], [3, 3, 2]]\n", [(3.0, 3.0)]),
        (
            "  number: 2\n  goal:\n    - [[9, 9, 0], [2, 4, 1]]\n    - [[5, 5, 0], [6, 7, 1]]\n",
            [(2.0, 4.0), (6.0, 7.0)],
        ),
        ("  number: 2\n  goal:\n    - [9, 9, 0]\n    - [5, 5, 0]\n", [(9.0, 9.0), (5.0, 5.0)]),
        ("  number: 2\n  goal:\n    - [[9, 9, 0], [2, 4, 1]]\n", [(2.0, 4.0), (2.0, 4.0)]),
    ],
)
def test_several_goals_of_irsim(tmp_path, goals, last):
    (tmp_path / "world.yaml").write_text(ROBOT.format(goals))
    done = import_trial(tmp_path / "world.yaml")
    assert [(robot.goal.x, robot.goal.y) for robot in done.trials[0][1].robots] == last


WORLD = f"<sdf version='1.6'><world name='w'><model name='house'><static>1</static>{WALL}</model></world></sdf>"


@pytest.mark.parametrize(
    "before",
    [
        "<?xml version='1.0'?>\n<!-- gz topic -t /a -m gz.msgs.Twist -p 'x' --once -->\n",
        "\n\n<?xml version='1.0' encoding='UTF-8'?>\n",
        "\ufeff\n<?xml version='1.0'?>\n<!-- a <!-- b -->\n",
        "<!--- three --->\n",
        "<!-- <model name='no'><link/></model> -- \n -->\n",
        "<?xml version='1.0' encoding='ISO-8859-1'?>\n<!-- -- -->",
    ],
)
def test_comments_and_declarations_that_gazebo_reads(tmp_path, before):
    file = tmp_path / "hall.sdf"
    file.write_bytes((before + WORLD).encode())
    assert len(import_trial(file).trials[0][1].stage.obstacles) == 1
    file.write_bytes((before + WORLD.replace("</world>", "</welt>")).encode())
    with pytest.raises(TrialError, match=f"hall.sdf:{before.count(chr(10)) + 1}: this is not well-formed XML"):
        import_trial(file)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "hall.xml",
            "<geometry version='0.8' unit='m'><!-- in -- out --><rooms><room id='0'><subroom id='0' class='subroom'>"
            "<polygon caption='wall'><vertex px='0' py='0'/><vertex px='9' py='0'/></polygon>"
            "<polygon caption='wall'><vertex px='9' py='5'/><vertex px='0' py='5'/></polygon>"
            "</subroom></room></rooms></geometry>",
        ),
        (
            "scene.xml",
            "<Experiment version='2.0'><!-- --a --><ObstacleSet type='explicit' class='1'><Obstacle closed='1'>"
            "<Vertex p_x='0' p_y='0'/><Vertex p_x='2' p_y='0'/><Vertex p_x='2' p_y='2'/></Obstacle></ObstacleSet>"
            "</Experiment>",
        ),
        (
            "pedsim.xml",
            "<scenario><!-- -- --><obstacle x1='0' y1='0' x2='5' y2='0'/><waypoint id='a' x='3' y='3' r='1'/>"
            "<agent x='1' y='1' n='2' dx='1' dy='1'><addwaypoint id='a'/></agent></scenario>",
        ),
    ],
)
def test_comments_of_other_simulators(tmp_path, name, text):
    (tmp_path / name).write_text(text)
    stage = import_trial(tmp_path / name).trials[0][1].stage
    assert stage.walls or stage.obstacles


@pytest.mark.parametrize("comment", ["<!-- -- -->", "<!-- roslaunch a b --x -->", "<!---- a ---->", "<!-- <b/> -- -->"])
def test_comments_of_a_robot(comment):
    from crowdbot.world.urdf import read_urdf

    model = read_urdf(f"<robot name='r'>{comment}<link name='a'/></robot>")
    assert list(model.links) == ["a"]


def test_cdata_keeps_its_text():
    kept = b"<a><![CDATA[<!-- x -- -->]]>"
    assert strict_xml(kept + b"<!-- -- --></a>") == kept + 11 * b" " + b"</a>"
