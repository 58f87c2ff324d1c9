"""The kinds of files that tools/fuzz_readers.py mutates: for each its unchanged samples and how it is read."""

from __future__ import annotations

import contextlib
import io
import json
import random
import shutil
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from fuzz_trials import EXTRA, NEW
from fuzz_weights import make_weights, read_weights
from fuzz_xacro import make_xacro, read_xacro
from fuzzing import check_sentence, flatten_mcap

from crowdbot.core import CrowdbotError

ROOT = Path(__file__).parents[1]
sys.path += [str(ROOT / "tests" / folder) for folder in ("", "data", "trials", "world")]
SAMPLES = ROOT / "tests" / "fuzz-samples"
ASSETS = ROOT / "src" / "crowdbot" / "assets"
OUT = "out"
"""Folder for what a reader writes, beside the files of the sample."""
MOST_PEOPLE = 200
"""Trials with more people are read, but not run."""


class Kind(NamedTuple):
    """A kind of files.

    Fields:
        about: one line.
        make: writes the samples, one folder each, into a folder.
        read: reads the sample in a folder; the second argument is the name of the mutated file.
        fixed: endings of files that are not mutated.
    """

    about: str
    make: Callable[[Path], None]
    read: Callable[[Path, str, random.Random], None]
    fixed: tuple[str, ...] = ()


def _tracks(*formats: str) -> Kind:
    def make(folder: Path) -> None:
        from synthetic_recordings import SYNTHETIC

        for name, item in SYNTHETIC.items():
            if item.format in formats:
                path = Path(name)  # of a folder of files, the folder is the sample
                sample = folder / (path.parent.name or name)
                sample.mkdir()
                item.write(sample / path.name)
                if name.endswith(".mcap"):
                    _flatten(sample / name)

    return Kind(f"recordings: {', '.join(formats)}", make, read_tracks, (".ini",))


def read_tracks(folder: Path, name: str, rng: random.Random) -> None:
    """Read a recording; some as another format or with another frame rate."""
    from synthetic_recordings import SYNTHETIC

    from crowdbot.data import FORMATS, load

    main = next((item for item in SYNTHETIC if (folder / item).is_file()), name)
    options = dict(SYNTHETIC[main].options) if main in SYNTHETIC else {}
    if rng.random() < 0.1:
        options["format"] = rng.choice(list(FORMATS))
    if rng.random() < 0.2:
        options["fps"] = rng.choice((25.0, 2.5, 1e-3, 9999.0))
    try:
        tracks = load(folder / main, **options)  # type: ignore[arg-type]
        tracks.summary()
    except CrowdbotError as error:
        if name not in str(error) and main not in str(error):
            raise AssertionError(f"the message names no file: {error}") from None
        raise


def _flatten(path: Path) -> None:
    flat = path.parent.with_name(f"flat-{path.parent.name}")
    shutil.copytree(path.parent, flat)
    (flat / path.name).write_bytes(flatten_mcap(path.read_bytes()))


def _other_trials(folder: str, names: list[str]) -> list[str]:
    return [name for name in names if name.endswith(".xml")] if Path(folder) == SAMPLES / "trials" else []


def make_trials(folder: Path) -> None:
    """Write trials with all elements; the main file is trial.xml."""
    texts = {"extra": EXTRA, "new": NEW, "physics": NEW.replace("planar", "physics")}
    for path in sorted((SAMPLES / "trials").glob("*.xml")):
        texts[path.stem] = path.read_text(encoding="utf-8")
    for name, text in texts.items():
        shutil.copytree(SAMPLES / "trials", folder / name, ignore=_other_trials)
        (folder / name / "trial.xml").write_text(text, encoding="utf-8")


def read_trial(folder: Path, name: str, rng: random.Random) -> None:
    """Read a trial, write and read it again, and run some for three steps with a recording."""
    from crowdbot.recording import open_run
    from crowdbot.trials import expand_sweeps, load_trial, parse_trial, trial_xml

    trial = load_trial(folder / "trial.xml")
    if parse_trial(trial_xml(trial), folder=folder) != trial:
        raise AssertionError("written and read again it is another trial")
    one = expand_sweeps(trial)[0]
    if rng.random() < 0.1 and one.people <= MOST_PEOPLE and (one.capacity or 0) <= MOST_PEOPLE:
        with open_run(one, out=folder / OUT) as running:
            for _ in range(3):
                if running.outcome is None:
                    running.step()


ORIGINAL = """<Trial><scene meshName="Kerlann"><Position x="0" y="0" z="0"/><endingConditions>
  <condition parameter="time" test="greater" value="45"/><condition parameter="x" test="greater" value="8"/>
  </endingConditions></scene><player><TrialCamPlayer mesh="CamPlayer" in_sim="false"/></player>
  <robots><robot><TrialRegularRobot mesh="Pepper" radius="0.5" in_sim="true"><Position x="-6" y="1" z="0"/>
    <Rotation x="0" y="0" z="270"/><controlLaw><LawFake/></controlLaw></TrialRegularRobot></robot></robots>
  <agents><agent><TrialRegularAgent mesh="m002" radius="0.33" heightOffset="0.02"><Position x="0" y="3" z="0"/>
    <Rotation x="0" y="0" z="90"/><controlLaw><LawGoals speedDefault="1.2" reachedDist="0.7" isLooping="true">
    <Goals><Goal x="5" y="2" z="0"/><Goal x="-5" y="2" z="0"/></Goals></LawGoals></controlLaw><controlSim>
    <RVOconfig neighborDist="5" maxNeighbors="3" timeHorizon="2"/></controlSim></TrialRegularAgent></agent></agents>
  <obstacles><obstacle><TrialObstacle><Lines><Line x1="-9" y1="-9" x2="9" y2="-8" thickness="0.2"/></Lines>
    <Points><Point x1="0" y1="-5" thickness="1"/></Points></TrialObstacle></obstacle></obstacles>
</Trial>
"""
CONFIG = """<Config><experience currentUser="1" startingTrial="0" userHeight="1.8">
  <sourceFileExperiment>./Scenario/O{TWO}.csv</sourceFileExperiment></experience><log debugLvl="0"/></Config>
"""


def make_originals(folder: Path) -> None:
    """Write a configuration of the simulator of 2021 with its order files and trials."""
    place = folder / "study" / "Scenario"
    place.mkdir(parents=True)
    (place.parent / "Config.xml").write_text(CONFIG, encoding="utf-8")
    (place / "a.xml").write_text(ORIGINAL, encoding="utf-8")
    (place / "b.xml").write_text(ORIGINAL.replace('value="45"', 'value="5"'), encoding="utf-8")
    (place / "O0.csv").write_text("Scenario/a.xml\nScenario/b.xml\n", encoding="utf-8")
    (place / "O1.csv").write_text("Scenario/b.xml\nScenario/a.xml;note\n", encoding="utf-8")


def read_original(folder: Path, name: str, rng: random.Random) -> None:
    """Import the configuration and, on its own, the mutated file."""
    from crowdbot.experiments import experiment_xml, import_experiment
    from crowdbot.trials import check_trial, import_original, trial_xml

    for path in (folder / "Config.xml", folder / name):
        with contextlib.suppress(CrowdbotError):
            for _, trial in import_original(path).trials:
                trial_xml(trial)
                check_trial(trial)
    experiment_xml(import_experiment(folder / "Config.xml").experiment)


def make_scenes(folder: Path) -> None:
    """Write files of other simulators, a drawing and a building; the world of Gazebo has a mesh and another model."""
    from test_buildings import building
    from test_dxf import DOOR, SQUARE, drawing, insert, line, with_blocks
    from test_foreign import PEDSIM, UMANS, VADERE, WALLS
    from test_hunavsim import AGENTS
    from test_scene_files import FILES, GAZEBO, TABLE, named_files, two_boxes

    mesh = "<mesh><uri>hall.dae</uri><submesh><name>post</name><center>1</center></submesh></mesh>"
    texts = {name: {name: text} for name, text in FILES.items()}
    texts["hall.world"] = {
        "hall.world": GAZEBO.replace("<mesh><uri>chair.dae</uri></mesh>", mesh), "table/model.sdf": TABLE,
    }  # fmt: skip
    texts["umans"] = {"cross.xml": UMANS.replace("../walls.xml", "walls.xml"), "walls.xml": WALLS}
    texts["vadere"] = {"rooms.scenario": json.dumps(VADERE)}
    texts["pedsim"] = {"pedsim.xml": PEDSIM}
    texts["hunavsim"] = {"agents.yaml": AGENTS}
    texts["drawing"] = {"plan.dxf": with_blocks(drawing(SQUARE, line(1, 1, 4, 2), insert("door", 3, 3)), DOOR)}
    for sample, files in texts.items():
        (folder / sample).mkdir()
        if sample in ("hall.xml", "project.xml"):
            named_files(folder / sample)
        for name, text in files.items():
            (folder / sample / name).parent.mkdir(exist_ok=True)
            (folder / sample / name).write_text(text, encoding="utf-8")
    two_boxes(folder / "hall.world", "dae")
    (folder / "building").mkdir()
    building(folder / "building")


SCENES = (
    "hall.world", "project.xml", "hall.xml", "hallS.xml", "rooms.xml", "world.yaml", "scenario.json", "cross.xml",
    "rooms.scenario", "pedsim.xml", "agents.yaml", "plan.dxf", "hall.glb",
)  # fmt: skip
"""Main files of the samples of scenes, before the files that they name."""


def read_scene(folder: Path, name: str, rng: random.Random) -> None:
    """Import a scene, check the trial and write it."""
    from crowdbot.trials import check_trial, import_trial, trial_xml

    path = next(folder / main for main in SCENES if (folder / main).exists())
    for _, trial in import_trial(path).trials:
        trial_xml(trial)
        with contextlib.suppress(CrowdbotError):
            check_trial(trial)


def make_imports(folder: Path) -> None:
    """Write robots of makers with every kind of base as xacro, and a model as SDF."""
    from base_texts import BASES, base_file
    from test_sdf import CAR

    for kind in BASES:
        (folder / kind).mkdir()
        (folder / kind / "maker.xacro").write_text(base_file(kind), encoding="utf-8")
    (folder / "sdf").mkdir()
    (folder / "sdf" / "maker.sdf").write_text(CAR, encoding="utf-8")


def read_import(folder: Path, name: str, rng: random.Random) -> None:
    """Convert the file of a maker to a robot folder."""
    from crowdbot.world import import_robot

    import_robot(folder / name, "maker")


def make_robots(folder: Path) -> None:
    """Write robots: built-in ones, the one of ``crowdbot new`` and one with a mesh."""
    from crowdbot.cli.templates import robot_files

    for name in ("differential", "turtlebot2", "cuybot", "pepper"):
        shutil.copytree(ASSETS / "robots" / name, folder / name, ignore=shutil.ignore_patterns("*.md"))
    for name in ("mine", "meshed"):
        (folder / name).mkdir()
        for path, text in robot_files(folder / name / name).items():
            if path.parent.name == name and path.suffix != ".py":
                (folder / name / path.name).write_text(text, encoding="utf-8")
    urdf = folder / "meshed" / "meshed.urdf"
    text = urdf.read_text(encoding="utf-8")
    urdf.write_text(text.replace('<cylinder radius="0.25" length="0.48"/>', '<mesh filename="body.obj"/>'), "utf-8")
    (folder / "meshed" / "body.obj").write_bytes(_mesh("obj"))


def read_robot(folder: Path, name: str, rng: random.Random) -> None:
    """Read a robot, describe it, and build some in the physics engine."""
    from crowdbot.world import Robot, check_robot, describe
    from crowdbot.world.urdf import mjcf

    robot = Robot.load(folder)
    describe(robot.model, robot.posture)
    with contextlib.suppress(CrowdbotError):
        check_robot(robot)
    if rng.random() < 0.3:
        mjcf(robot.model, floor=True).load()


MESHES = ("stl", "stl-text", "obj", "ply", "ply-text", "glb", "dae")


def _mesh(kind: str) -> bytes:
    import trimesh

    body = trimesh.util.concatenate(
        [
            trimesh.creation.box((0.4, 0.3, 0.2)),
            trimesh.creation.icosphere(1, 0.2).apply_translation((0.2, 0.0, 0.3)),
        ]
    )
    if kind.endswith("-text"):
        options = {"stl-text": {"file_type": "stl_ascii"}, "ply-text": {"file_type": "ply", "encoding": "ascii"}}
        data = body.export(**options[kind])
    else:
        data = body.export(file_type=kind)
    return data.encode() if isinstance(data, str) else bytes(data)


def make_meshes(folder: Path) -> None:
    """Write a mesh in every format."""
    for kind in MESHES:
        (folder / kind).mkdir()
        (folder / kind / f"body.{kind.partition('-')[0]}").write_bytes(_mesh(kind))


def read_meshes(folder: Path, name: str, rng: random.Random) -> None:
    """Read a mesh and find its convex colliders."""
    from crowdbot.world.urdf import with_pieces
    from crowdbot.world.urdf.meshes import read_mesh

    scale = rng.choice(((1.0, 1.0, 1.0), (1.0, 1.0, 1.0), (0.001, -0.001, 0.001), (0.0, 1.0, 1.0)))
    mesh = read_mesh(folder / name, name, scale)
    with_pieces(mesh, rng.choice(("hull", "auto")))


def make_maps(folder: Path) -> None:
    """Write maps of ROS with images of bytes and of text, and areas as GeoJSON and WKT."""
    rng = np.random.default_rng(0)
    cells = np.where(rng.random((24, 30)) < 0.05, 0, 254).astype(np.uint8)
    cells[[0, -1]], cells[:, [0, -1]], cells[4:9, 5:9] = 0, 0, 205
    head = "# a map\nimage: {image}\nresolution: 0.200000\norigin: [-1.0, -2.0, 0.1]\nnegate: 0\n"
    images = {
        "bytes": b"P5\n# made by hand\n30 24\n255\n" + cells.tobytes(),
        "text": b"P2\n30 24\n255\n" + "\n".join(" ".join(map(str, row)) for row in cells).encode(),
        "wide": b"P5 30 24 65535\n" + (cells.astype(">u2") * 257).tobytes(),
    }
    for name, image in images.items():
        (folder / name).mkdir()
        (folder / name / "map.yaml").write_text(
            head.format(image="hall.pgm") + "occupied_thresh: 0.65\nfree_thresh: 0.196\n", encoding="utf-8"
        )
        (folder / name / "hall.pgm").write_bytes(image)
    shapes = {
        "hall.wkt": "POLYGON ((0 0, 16 0, 16 6, 0 6, 0 0), (7 2, 7 4, 9 4, 9 2, 7 2))",
        "both.wkt": "GEOMETRYCOLLECTION (MULTIPOLYGON (((0 0, 4 0, 4 4, 0 4, 0 0)), ((9 0, 9 3, 6 3, 9 0))))",
        "hall.geojson": (ASSETS / "templates" / "stage.txt").read_text(encoding="utf-8"),
        "list.geojson": json.dumps(
            {
                "type": "FeatureCollection",
                "features": [
                    {
                        "type": "Feature",
                        "properties": {"name": "hall"},
                        "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [9, 0], [9, 9], [0, 9], [0, 0]]]},
                    }
                ],
            }
        ),
    }
    for name, text in shapes.items():
        (folder / name).mkdir()
        (folder / name / name).write_text(text, encoding="utf-8")


def read_map(folder: Path, name: str, rng: random.Random) -> None:
    """Read a stage and look for free room in it."""
    from crowdbot.trials import Stage, check_stage

    if (folder / "map.yaml").exists():
        unknown = rng.choice(("occupied", "free"))
        stage = Stage(map="map.yaml", unknown=unknown, folder=folder, trust=False)
    else:
        stage = Stage(area=name, folder=folder, trust=False)
    check_stage(stage)


def make_episodes(folder: Path) -> None:
    """Record episodes of 2 s, each with and without chunks."""
    from crowdbot.recording import record
    from crowdbot.trials import load_trial

    trials = {name: SAMPLES / "trials" / f"{name}.xml" for name in ("hall", "own-code", "scripted", "pepper", "flow")}
    for name, source in {"frontal": "frontal", **trials}.items():
        trial = load_trial(source)
        (folder / name).mkdir()
        record(replace(trial, duration=min(trial.duration, 2.0)), 1, folder / name / "episode.mcap")
        if name == "own-code":
            shutil.copyfile(SAMPLES / "trials" / "shy.py", folder / name / "shy.py")
        _flatten(folder / name / "episode.mcap")


def read_episode_file(folder: Path, name: str, rng: random.Random) -> None:
    """Read, repair and export an episode, and unpack what replay needs."""
    from crowdbot.recording import export, read_episode, repair
    from crowdbot.recording.attachments import unpack_attachments
    from crowdbot.recording.episode_reader import read_metadata
    from crowdbot.recording.provenance import Provenance

    path = folder / "episode.mcap"
    problems = []
    for step in ("read", "export", "unpack", "repair"):
        try:
            if step == "read":
                read_episode(path).tracks()
            elif step == "export":
                table = rng.choice(("people", "robots", "scans", "contacts", "tracked", "odometry"))
                export(path, folder / OUT / "table.csv", table)
            elif step == "unpack":
                known = read_metadata(path)
                with unpack_attachments(path, known, None, trust=False) as place:
                    Provenance.of(path, place.folder)
            else:
                repair(path)
        except CrowdbotError as error:
            check_sentence(str(error))
            problems.append(error)
    if problems:
        raise problems[0]


def make_experiments(folder: Path) -> None:
    """Write the built-in experiment with a file of answers."""
    shutil.copytree(ASSETS / "experiments" / "robot-speed", folder / "robot-speed")
    answers = {"welcome.age": 30, "robots": "never", "opinion.comfort": 4, "remarks": "none"}
    (folder / "robot-speed" / "answers.json").write_text(json.dumps(answers), encoding="utf-8")


def read_experiment(folder: Path, name: str, rng: random.Random) -> None:
    """Read an experiment, plan it for some participants, show its screens and read scripted answers."""
    from crowdbot.experiments import (
        Experiment,
        ScriptedRespondent,
        experiment_xml,
        load_experiment,
        page_of,
        parse_experiment,
        plan,
    )

    experiment: Experiment = load_experiment(folder)
    if parse_experiment(experiment_xml(experiment), folder=folder) != experiment:
        raise AssertionError("written and read again it is another experiment")
    for participant in (1, 2, 7):
        for step in plan(experiment, participant):
            if step.screen is not None:
                page_of(step.screen, folder)
    ScriptedRespondent.load(folder / "answers.json", experiment)


def make_sessions(folder: Path) -> None:
    """Run the sessions of two participants with scripted answers, and leave out their episodes."""
    from crowdbot.cli import main

    source, sessions = SAMPLES / "experiment", folder / "sessions"
    for participant in ("1", "2"):
        words = ["experiment", "run", str(source), "--participant", participant, "--out", str(sessions)]
        with contextlib.redirect_stdout(io.StringIO()):
            status = main([*words, "--answers", str(source / "answers.json")])
        if status:
            raise AssertionError(f"the session of participant {participant} failed with status {status}")
    for path in sessions.rglob("*.mcap"):
        path.unlink()


def read_session(folder: Path, name: str, rng: random.Random) -> None:
    """Read sessions and write their summary as a table."""
    from crowdbot.experiments import save_summary, summary

    rows = summary(folder)
    save_summary(rows, folder / OUT / rng.choice(("table.csv", "table.json")))


KINDS = {
    "scenes": Kind("scenes of other simulators, drawings, buildings", make_scenes, read_scene),
    "imports": Kind("robots of makers: URDF, xacro, SDF", make_imports, read_import),
    "labels": _tracks("ind", "jrdb", "lcas", "wildtrack", "thor-magni"),
    "text": _tracks("petrack", "eth-obsmat", "sgan", "ucy-vsp", "sdd", "trajnetpp", "csv"),
    "peers": _tracks(
        "mot", "kitti", "vadere", "viswalk", "edinburgh", "grand-central", "four-rows", "atc", "rosbag1", "rosbag2"
    ),
    "hdf5": _tracks("juelich-hdf5"),
    "sqlite": _tracks("jupedsim"),
    "parquet": _tracks("parquet"),
    "npz": _tracks("social-ways"),
    "mcap": _tracks("episode"),
    "weights": Kind("weights of learned predictors, population priors", make_weights, read_weights),
    "trials": Kind("trial files with maps, areas and recordings", make_trials, read_trial, (".py",)),
    "originals": Kind("configurations, orders and trials of the simulator of 2021", make_originals, read_original),
    "robots": Kind("URDF and robot.xml", make_robots, read_robot),
    "xacro": Kind("xacro with includes, macros and YAML: expressions are parsed", make_xacro, read_xacro),
    "meshes": Kind("STL, OBJ, PLY, GLB, DAE", make_meshes, read_meshes),
    "maps": Kind("maps of ROS, areas as WKT and GeoJSON", make_maps, read_map),
    "episodes": Kind("recorded episodes: read, repair, export, unpack", make_episodes, read_episode_file, (".py",)),
    "experiments": Kind("experiments with screens and answers", make_experiments, read_experiment),
    "sessions": Kind("logs and answers of sessions", make_sessions, read_session),
}
