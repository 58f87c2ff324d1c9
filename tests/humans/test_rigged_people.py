"""Imported bodies in trials: from the program to pictures, scans and episodes."""

from pathlib import Path

import numpy as np
import pytest
from characters import character

from crowdbot.cli import main
from crowdbot.core import InputError, Scene, TrialError
from crowdbot.humans import People, import_body, names
from crowdbot.recording import read_episode, record, replay
from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial, parse_trial
from crowdbot.world import PeopleMotion, Renderer, SceneCamera, scene_bodies

TRIAL = """<trial name="own" duration="0.6" world="{world}" bodies="skins">
<stage walkable="-2,-4 10,-4 10,4 -2,4"/><crowd type="orca"/>
<agent name="ann" x="3" y="0.4" goal="8,0.4" body="ann.body"/>
<spawner name="more" count="3" zone="5,-3 8,-3 8,3 5,3" goal="-1,-1 1,-1 1,1 -1,1" body="ann.body woman"/>
<robot name="robot" type="turtlebot2" x="0" y="0"><goal x="1" y="0"/><navigator type="straight"/></robot>
</trial>"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Return a folder with a character, its body, and a trial in each world."""
    place = tmp_path_factory.mktemp("own")
    character(place)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        assert main(["new", "body", "ann.glb"]) == 0
    for world in ("planar", "physics"):
        (place / f"{world}.xml").write_text(TRIAL.format(world=world), encoding="utf-8")
    return place


def test_the_program_says_what_it_has_made(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    assert main(["new", "body", "ann.glb"]) == 2
    assert "ann.body already exists; use --force to replace it" in capsys.readouterr().err
    assert main(["new", "body", "ann.glb", "--force", "--mass", "61"]) == 0
    assert "ann.body: 1.530 m, 61.0 kg, levels of 1580, 1580, " in capsys.readouterr().out
    assert main(["new", "body", "planar.xml"]) == 2
    assert "planar.xml must be a rigged character in glTF, .glb or .gltf" in capsys.readouterr().err
    (folder / "my hat (1).glb").write_bytes((folder / "ann.glb").read_bytes())
    assert main(["new", "body", "my hat (1).glb"]) == 0
    assert (folder / "my-hat-1.body").is_file()


@pytest.mark.parametrize("world", ["planar", pytest.param("physics", marks=pytest.mark.needs("mujoco"))])
def test_an_episode_carries_the_body_along_and_replays(folder, tmp_path, world):
    summary = record(load_trial(folder / f"{world}.xml"), out=tmp_path)
    assert summary.outcome != "failed"
    (tmp_path / "moved").mkdir()
    moved = (tmp_path / "episode.mcap").rename(tmp_path / "moved" / "episode.mcap")
    assert replay(moved).equal
    assert len(read_episode(moved).ids) == 5


@pytest.mark.needs("mujoco")
def test_people_of_a_trial_have_the_body(folder):
    people = Simulation(load_trial(folder / "physics.xml")).world.people.people
    who = [person.name for person in people.persons]
    assert who[0] == "ann.body"
    assert set(who) <= {"ann.body", *names()}
    assert people.height[0] == pytest.approx(1.53, abs=0.01)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('body="ann.body"', 'body="bob.body"', r"there is no file 'bob.body'"),
        ('body="ann.body"', 'body="../ann.body"', r"has '../ann.body'.*or a body beside the trial such as ann.body"),
        ('type="turtlebot2"', 'type="wheelchair" rider="ann.body"', r"is an imported body; riders take the included"),
    ],
)
def test_a_wrong_name_is_refused_in_a_sentence(folder, old, new, message):
    file = folder / "wrong.xml"
    file.write_text(TRIAL.format(world="planar").replace(old, new, 1), encoding="utf-8")
    with pytest.raises((InputError, TrialError), match=message):
        Simulation(load_trial(file))


def test_a_trial_without_a_folder_has_no_bodies():
    with pytest.raises(InputError, match=r"body 'ann.body' is a file beside the trial, but own has no folder"):
        Simulation(parse_trial(TRIAL.format(world="planar")))


def standing(folder):
    """Return a scene with the woman of whom the body was made and the imported body, and their motion."""
    body = import_body(folder / "ann.glb", "ann.body").body
    scene = Scene.of([[0.0, 1.0], [0.0, -1.0]])
    return scene, PeopleMotion(scene, np.arange(2), People.of(["woman-36", "ann.body"], own=[body]))


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("renderer", ["software", "opengl"])
@pytest.mark.parametrize("detail", [0, 2])
def test_pictures_have_the_texture_of_the_body(folder, renderer, detail):
    scene, motion = standing(folder)
    camera = SceneCamera((5.0, 0.0, 1.2), (0.0, 0.0, 0.9), 160, 120, renderer=renderer, detail=detail)
    images = Renderer(scene, {}, None, motion).images(camera, segmentation=True, depth=True)
    own = images.segmentation == 1
    other = images.segmentation == 0
    assert own.sum() == pytest.approx(other.sum(), rel=0.2)
    rows = np.nonzero(own)[0]
    colors = images.rgb[own].astype(int)
    upper = rows < rows.min() + 0.08 * np.ptp(rows)
    assert np.mean(colors[upper, 0] > colors[upper, 2] + 40) > 0.9  # a red head
    lower = rows > rows.min() + 0.3 * np.ptp(rows)
    assert np.mean(colors[lower, 2] > colors[lower, 0] + 40) > 0.6  # a blue body
    assert np.median(images.depth[own]) == pytest.approx(np.median(images.depth[other]), abs=0.1)


def test_scans_meet_the_skin_of_the_body(folder):
    scene, motion = standing(folder)
    skins = scene_bodies(scene, motion, skins=2).skins
    points = [skins.vertices[0, np.unique(skins.faces[skins.owner == agent])] for agent in (0, 1)]
    for point, y in zip(points, (1.0, -1.0), strict=True):
        assert np.abs(point[:, 1] - y).max() < 0.5
        assert point[:, 2].max() == pytest.approx(1.53, abs=0.04)
    assert np.sum(skins.owner == 1) == len(motion.people.own[0].levels[2].faces)
