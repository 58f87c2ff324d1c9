"""Scenes of other simulators: what is read, what is left out by name, that they run, and wrong files."""

import math
import random

import numpy as np
import pytest
import shapely
from PIL import Image

from crowdbot.cli import main
from crowdbot.core import TrialError
from crowdbot.models import ORCA, SocialForce
from crowdbot.simulation import simulate
from crowdbot.trials import check_trial, import_trial, load_trial, parse_trial, trial_xml

IRSIM = """
world: {height: 12, width: 16, step_time: 0.1, control_mode: auto}
robot:
  kinematics: {name: 'diff'}
  shape: {name: 'circle', radius: 0.25}
  state: [1, 1, 0.5]
  goal: [14, 10, 0]
  vel_max: [0.8, 1.0]
  sensors: [{type: lidar2d}]
obstacle:
  - shape: {name: 'rectangle', length: 2.0, width: 1.0}
    state: [6, 5, 0]
  - shape: {name: 'linestring', vertices: [[0, 0], [0, 3]]}
    state: [12, 1, 0]
  - name: walker
    kinematics: {name: omni}
    behavior: {name: rvo, vxmax: 1.2, loop: true}
    shape: {name: circle, radius: 0.3}
    state: [2, 8, 0]
    goal: [[9, 8], [9, 10], [2, 8]]
"""
ARENA = """{
 "robots": [{"start": [0, 0, 0.5], "goal": [5, 5, 0]}],
 "obstacles": {
  "static": [{"name": "shelf1", "model": "shelf", "pos": [13, 11, -0.5]}],
  "interactive": [{"name": "door", "pos": [1, 1, 0]}],
  "dynamic": [
   {"name": "doctor", "pos": [-1, -7.5, 0], "type": "adult", "model": "actor1", "vmax": 1.1,
    "waypoints": [[-3, -7.5, 0], [-3, -5, 0]], "waypoint_mode": 2}, // in order
   {"name": "lift", "pos": [4, 4, 0], "type": "forklift", "waypoints": [[1, 1, 0]]}
  ]},
 "map": "hall", "resets": 5
}"""
GAZEBO = """<?xml version="1.0"?>
<sdf version="1.6"><world name="w">
<include><uri>model://sun</uri></include>
<include><uri>model://table</uri><name>table_1</name><pose>9 9 0 0 0 0</pose></include>
<model name="wall"><static>1</static><pose>2 0 0 0 0 1.5707963</pose><link name="l"><pose>0 0 1.25 0 0 0</pose>
 <collision name="c"><geometry><box><size>4 0.2 2.5</size></box></geometry></collision></link></model>
<model name="post"><link name="l"><collision name="c"><pose>5 1 0.5 0 0 0</pose>
 <geometry><cylinder><radius>0.3</radius><length>1</length></cylinder></geometry></collision></link></model>
<model name="ceiling"><static>true</static><link name="l"><collision name="c"><pose>0 0 3 0 0 0</pose>
 <geometry><box><size>9 9 0.2</size></box></geometry></collision></link></model>
<model name="cart"><link name="l"/><joint name="j" type="continuous"/></model>
<model name="chair"><static>1</static><link name="l"><collision name="c"><geometry><mesh><uri>chair.dae</uri></mesh>
 </geometry></collision></link></model>
<actor name="ann"><script><loop>true</loop><delay_start>2</delay_start><trajectory id="0" type="walking">
 <waypoint><time>0</time><pose>0 3 0 0 0 0</pose></waypoint><waypoint><time>5</time><pose>6 3 0 0 0 0</pose></waypoint>
 <waypoint><time>7</time><pose>6 3 0 0 0 3</pose></waypoint><waypoint><time>12</time><pose>0 3 0 0 0 3</pose></waypoint>
</trajectory></script></actor>
</world></sdf>"""
ROOMS = """<?xml version="1.0"?>
<geometry version="0.8" caption="hall" unit="m"><rooms><room id="0" caption="hall"><subroom id="0" class="subroom">
<polygon caption="wall"><vertex px="10" py="2"/><vertex px="10" py="0"/><vertex px="0" py="0"/><vertex px="0" py="6"/>
 <vertex px="10" py="6"/><vertex px="10" py="4"/></polygon>
<obstacle id="7" closed="1"><polygon><vertex px="5" py="2"/><vertex px="6" py="2"/><vertex px="6" py="3"/>
 <vertex px="5" py="2"/></polygon></obstacle></subroom></room></rooms>
<transitions><transition id="0" room1_id="0" subroom1_id="0" room2_id="-1" subroom2_id="-1"><vertex px="10" py="2"/>
 <vertex px="10" py="4"/></transition></transitions></geometry>"""
PROJECT = """<?xml version="1.0"?>
<JuPedSim project="p" version="0.8"><header><seed>1</seed><max_sim_time>60</max_sim_time><geometry>rooms.xml</geometry>
</header><agents><agents_distribution>
<group group_id="1" room_id="0" number="8" agent_parameter_id="1" x_min="1" x_max="4" y_min="1" y_max="5"/>
<group group_id="2" room_id="0" number="1" startX="8" startY="3" goal_id="4" pre_movement_mean="3"/>
</agents_distribution><agents_sources><source id="9" frequency="2" group_id="1"/></agents_sources></agents>
<operational_models><model>
<agent_parameters agent_parameter_id="1"><v0 mu="1.2" sigma="0.1"/></agent_parameters></model>
</operational_models><routing><goals><goal id="4" final="true"><polygon><vertex px="1" py="1"/><vertex px="2" py="1"/>
 <vertex px="2" py="2"/><vertex px="1" py="1"/></polygon></goal></goals></routing><train_constraints/></JuPedSim>"""
MENGE = """<?xml version="1.0"?>
<Experiment version="2.0"><SpatialQuery type="kd-tree"/><Common time_step="0.1"/>
<AgentProfile name="base"><Common r="0.2" pref_speed="1.3" max_speed="2"/></AgentProfile>
<AgentProfile name="slow" inherits="base"><Common class="2"><Property name="pref_speed" dist="c" value="0.8"/></Common>
</AgentProfile>
<AgentGroup><ProfileSelector type="const" name="base"/><StateSelector type="const" name="Walk"/>
<Generator type="explicit"><Agent p_x="1" p_y="2"/><Agent p_x="1" p_y="4"/></Generator></AgentGroup>
<AgentGroup><ProfileSelector type="const" name="slow"/><StateSelector type="const" name="Cross"/>
<Generator type="rect_grid" anchor_x="-9" anchor_y="-9" offset_x="1" offset_y="2" count_x="3" count_y="2"/></AgentGroup>
<ObstacleSet type="explicit" class="1"><Obstacle closed="1"><Vertex p_x="4" p_y="0"/><Vertex p_x="5" p_y="0"/>
<Vertex p_x="5" p_y="1"/></Obstacle><Obstacle closed="0"><Vertex p_x="0" p_y="8"/><Vertex p_x="9" p_y="8"/></Obstacle>
</ObstacleSet></Experiment>"""
STATES = """<?xml version="1.0"?>
<BFSM><GoalSet id="0"><Goal type="AABB" id="0" min_x="8" min_y="1" max_x="9" max_y="3"/>
<Goal type="point" id="1" x="2" y="6"/></GoalSet>
<State name="Walk" final="0"><GoalSelector type="explicit" goal_set="0" goal="0"/><VelComponent type="goal"/></State>
<State name="Back" final="0"><GoalSelector type="explicit" goal_set="0" goal="1"/><VelComponent type="goal"/></State>
<State name="Cross" final="0"><GoalSelector type="mirror" mirror_x="1" mirror_y="1"/></State>
<State name="Stop" final="1"><GoalSelector type="identity"/></State>
<Transition from="Walk" to="Back"><Condition type="goal_reached" distance="0.25"/></Transition>
<Transition from="Back" to="Walk"><Condition type="goal_reached" distance="0.25"/></Transition>
<Transition from="Cross" to="Stop"><Condition type="goal_reached" distance="0.05"/></Transition>
<Transition from="Stop"><Condition type="timer" dist="u"/></Transition></BFSM>"""
MENGE_PROJECT = '<Project scene="hallS.xml" behavior="hallB.xml" model="orca"/>'
FILES = {
    "hall.xml": MENGE_PROJECT, "hallS.xml": MENGE,
    "world.yaml": IRSIM, "scenario.json": ARENA, "hall.world": GAZEBO, "rooms.xml": ROOMS, "project.xml": PROJECT
}  # fmt: skip


def imported(tmp_path, name, text):
    named_files(tmp_path)
    file = tmp_path / name
    file.write_text(text, encoding="utf-8")
    return import_trial(file)


def named_files(folder):
    """Write the files that projects name."""
    for name, text in (("rooms.xml", ROOMS), ("hallS.xml", MENGE), ("hallB.xml", STATES)):
        (folder / name).write_text(text)


def trial_of(done):
    ((_, trial),) = done.trials
    return trial


@pytest.mark.parametrize("name", FILES)
def test_a_scene_is_written_checked_and_runs(tmp_path, capsys, name):
    named_files(tmp_path)
    (tmp_path / name).write_text(FILES[name])
    out = tmp_path / "out.xml"
    assert main(["new", "trial", str(out), "--import", str(tmp_path / name)]) == 0
    said = capsys.readouterr().out
    assert "errors" not in said
    trial = load_trial(out)
    check_trial(trial)
    assert parse_trial(trial_xml(trial)) == trial
    text = out.read_text().replace('duration="120"', 'duration="4"').replace('duration="60"', 'duration="4"')
    episode = simulate(parse_trial(text), 0)
    assert np.isfinite(episode.position[episode.active]).all()
    assert name == "rooms.xml" or np.ptp(episode.position, axis=0).max() > 1.0  # a geometry has nobody


def test_irsim_has_obstacles_people_and_robots(tmp_path):
    done = imported(tmp_path, "world.yaml", IRSIM)
    trial = trial_of(done)
    assert (type(trial.crowd), trial.step) == (ORCA, 0.1)
    assert trial.stage.obstacles[0].points == ((5.0, 4.5), (7.0, 4.5), (7.0, 5.5), (5.0, 5.5))
    assert trial.stage.walls[0].points == ((12.0, 1.0), (12.0, 4.0))
    (walker,) = trial.agents
    assert (walker.name, walker.position, walker.speed, walker.radius) == ("walker", (2.0, 8.0), 1.2, 0.3)
    (way,) = trial.journeys
    assert (way.then, [(stop.x, stop.y) for stop in way.stops]) == ("again", [(9.0, 8.0), (9.0, 10.0), (2.0, 8.0)])
    (robot,) = trial.robots
    assert (robot.position, robot.heading, robot.radius, robot.goal.position) == ((1.0, 1.0), 0.5, 0.25, (14.0, 10.0))
    assert robot.drive.max_speed == 0.8
    for sentence in ("world: control_mode is not imported", "robot 1: sensors is not imported"):
        assert sentence in done.left_out


@pytest.mark.parametrize(
    ("old", "new", "people", "obstacles", "sentence"),
    [
        ("world: {", "irsim:\n world: {", 0, 0, None),
        (
            "    state: [2, 8, 0]\n",
            "    number: 4\n    distribution: {name: circle, radius: 2, center: [9, 8]}\n",
            4,
            1,
            "the border of the world is no wall, as in IR-SIM",
        ),
        (
            "    state: [2, 8, 0]\n",
            "    number: 3\n    distribution: {name: random}\n",
            3,
            1,
            "obstacle 3: IR-SIM draws its 3 places in each run, here they are drawn once",
        ),
        ("    state: [6, 5, 0]\n", "    number: 2\n    state: [[6, 5, 0], [9, 2, 1]]\n", 1, 2, None),
        (
            "{name: 'rectangle', length: 2.0, width: 1.0}",
            "{name: polygon, vertices: [[0, 0], [1, 0], [0, 1]]}",
            1,
            1,
            None,
        ),
        (
            "{name: 'rectangle', length: 2.0, width: 1.0}",
            "{name: polygon, random_shape: true}",
            1,
            1,
            "obstacle 1 has random shapes in IR-SIM, here they are drawn once",
        ),
        (
            "    state: [6, 5, 0]\n",
            "    state: [6, 5, 0]\n    unobstructed: true\n",
            1,
            0,
            "obstacle 1 is unobstructed, nothing collides with it, and is left out",
        ),
        (
            "control_mode: auto",
            "obstacle_map: cave.png",
            1,
            1,
            "the obstacle_map 'cave.png' of world is left out: there is no file 'cave.png' in {folder}; put its image"
            " beside the world",
        ),
        (
            "name: rvo, vxmax: 1.2,",
            "name: dash, wander: true,",
            1,
            1,
            "the behaviour 'dash' of walker: ORCA replaces it",
        ),
        ("radius: 0.3", "radius: 2.5", 1, 1, "walker has a radius of 2.5 m, which is unlikely for a person"),
        ("vxmax: 1.2", "vxmax: 40", 1, 1, "walker: the speed of 40 m/s becomes 10 m/s"),
    ],
)
def test_variants_of_irsim(tmp_path, old, new, people, obstacles, sentence):
    assert old in IRSIM
    text = IRSIM.replace(old, new, 1)
    if new.startswith("irsim:"):
        text = "irsim:" + IRSIM.replace("\n", "\n  ")
        people = obstacles = 1
    done = imported(tmp_path, "world.yaml", text)
    trial = trial_of(done)
    assert (len(trial.agents), len(trial.stage.obstacles)) == (people, obstacles)
    assert sentence is None or sentence.replace("{folder}", str(tmp_path.resolve())) in done.left_out


@pytest.mark.parametrize("form", ["cave.png", "{path: cave.png}", "{name: image, path: cave.png}", "./cave.png"])
@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA", "1"])
def test_the_grid_map_of_irsim_becomes_solid(tmp_path, form, mode):
    cells = np.full((24, 32), 255, dtype=np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = 0
    cells[4:8, 6:10] = 40
    cells = np.kron(cells, np.ones((8, 8), dtype=np.uint8))
    Image.fromarray(cells).convert(mode, dither=Image.Dither.NONE).save(tmp_path / "cave.png")
    text = IRSIM.replace("control_mode: auto", f"obstacle_map: {form}, offset: [-1, 2]")
    done = imported(tmp_path, "world.yaml", text)
    shapes = [shapely.Polygon(obstacle.points) for obstacle in trial_of(done).stage.obstacles]
    assert not any("obstacle_map" in sentence for sentence in done.left_out)
    grid = shapely.union_all(shapes).difference(shapely.box(5, 4.5, 7, 5.5))
    assert grid.bounds == pytest.approx((-1.0, 2.0, 15.0, 14.0))
    block = shapely.box(2.0, 10.0, 4.0, 12.0)  # rows from the top, 0.5 m each
    border = shapely.box(-1.0, 2.0, 15.0, 14.0).difference(shapely.box(-0.5, 2.5, 14.5, 13.5))
    expected = block.union(border).difference(shapely.box(5, 4.5, 7, 5.5))
    assert shapely.hausdorff_distance(grid, expected) <= 0.0625 + 1e-9  # borders are simplified by one cell
    assert grid.symmetric_difference(expected).area < 2.0


def test_random_worlds_of_irsim_are_drawn_once(tmp_path):
    ranges = "{name: random, range_low: [3, 4, 0], range_high: [23, 24, 1]}"
    crowd = f"  - number: 9\n    distribution: {ranges}\n    kinematics: {{name: omni}}\n    behavior: {{name: rvo}}\n"
    crowd += "    shape: {name: circle, radius: 0.3}\n"
    posts = f"  - number: 5\n    distribution: {ranges}\n    shape: [{{name: circle, random_shape: true}}]\n"
    done = imported(tmp_path, "world.yaml", IRSIM + crowd + posts)
    trial = trial_of(done)
    people = np.array([agent.position for agent in trial.agents[1:]])
    posts = np.array([np.mean(obstacle.points, axis=0) for obstacle in trial.stage.obstacles[1:]])
    assert (len(people), len(posts)) == (9, 5)
    places = np.concatenate([people, posts])
    assert np.all((places >= [2.9, 3.9]) & (places <= [23.1, 24.1]))
    apart = np.hypot(*(places[:, None] - places).transpose(2, 0, 1)) + 9.0 * np.eye(14)
    assert apart.min() > 0.6
    check_trial(trial)
    goals = {(stop.x, stop.y) for journey in trial.journeys[1:] for stop in journey.stops}
    assert len(goals) == 9
    assert trial_of(imported(tmp_path, "world.yaml", IRSIM + crowd)).agents == trial.agents
    tight = imported(tmp_path, "world.yaml", IRSIM + crowd.replace("[23, 24, 1]", "[4, 5, 1]").replace("9", "900"))
    kept = len(trial_of(tight).agents)  # after the first one without room nothing is tried again
    (lost,) = (note for note in tight.left_out if "without room within 2 m, left out" in note)
    assert 30 < kept == 901 - int(lost.split()[0])
    assert sum("no room for all in its range, some may overlap" in sentence for sentence in tight.left_out) == 1
    with pytest.raises(TrialError, match="range_low must not be above range_high"):
        imported(tmp_path, "world.yaml", IRSIM + crowd.replace("[3, 4, 0]", "[33, 4, 0]"))


@pytest.mark.parametrize(
    ("number", "kinematics", "extra", "people"),
    [(100, "omni", "", 0), (101, "omni", "", 1), (130, "diff", "", 30), (200, "omni", "behavior: {name: orca}", 100),
     (150, "acker", "group_behavior: {name: orca, maxSpeed: 1.5}", 50)],
)  # fmt: skip
def test_robots_of_irsim_beyond_a_hundred_are_people(tmp_path, number, kinematics, extra, people):
    text = (
        "world: {height: 290, width: 290, offset: [-140, -140]}\nrobot:\n"
        f"  - number: {number}\n    kinematics: {{name: '{kinematics}'}}\n    shape: {{name: circle, radius: 0.4}}\n"
        f"    distribution: {{name: circle, radius: 140}}\n    vel_max: [2, 2]\n    {extra}\n"
    )
    done = imported(tmp_path, "world.yaml", text)
    trial = trial_of(done)
    check_trial(trial)
    assert (len(trial.robots), len(trial.agents)) == (number - people, people)
    told = [note for note in done.left_out if note.startswith("a trial has at most 100 robots: the other")]
    assert [note.split()[9] for note in told] == ([str(people)] if people else [])
    assert all((agent.radius, agent.speed) == (0.4, 2.0) and agent.journey for agent in trial.agents)


def test_people_on_a_circle_of_irsim_walk_across(tmp_path):
    text = IRSIM.replace(
        "    state: [2, 8, 0]\n    goal: [[9, 8], [9, 10], [2, 8]]\n", "    number: 4\n    distribution: circle\n"
    )
    trial = trial_of(imported(tmp_path, "world.yaml", text))
    places = np.array([agent.position for agent in trial.agents])
    assert places.ravel() == pytest.approx([13.5, 6, 8, 11.5, 2.5, 6, 8, 0.5])
    goals = {journey.name: journey.stops[0] for journey in trial.journeys}
    first = goals[trial.agents[0].journey]
    assert (first.x, first.y) == pytest.approx((2.5, 6.0))


def test_arena_has_people_and_robots_and_names_what_it_lacks(tmp_path):
    done = imported(tmp_path, "scenario.json", ARENA)
    trial = trial_of(done)
    (doctor,) = trial.agents
    assert (doctor.name, doctor.position, doctor.speed, type(trial.crowd)) == ("doctor", (-1, -7.5), 1.1, SocialForce)
    assert [(stop.x, stop.y) for stop in trial.journeys[0].stops] == [(-3.0, -7.5), (-3.0, -5.0)]
    assert trial.journeys[0].then == "again"
    assert (trial.robots[0].heading, trial.robots[0].goal.position) == (0.5, (5.0, 5.0))
    for sentence in (
        "lift is a forklift and is left out: people and robots are imported",
        "the static obstacle 'shelf1' (model shelf) is not imported, since its size is not in the file; add its"
        " outline as <obstacle> around (13.0, 11.0)",
        "'door' (interactive) is not imported",
        "the map 'hall' is not beside the scenario as hall/map.yaml or hall.yaml, nor in the folder above: the stage "
        "has no walls, add them",
    ):
        assert sentence in done.left_out


def write_map(file):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("image: hall.pgm\nresolution: 0.5\norigin: [-20, -20, 0]\n")
    (file.parent / "hall.pgm").write_bytes(b"P5 80 80 255\n" + b"\x00" * 80 + b"\xfe" * (79 * 80))


@pytest.mark.parametrize(
    ("scenario", "place", "name"),
    [
        ("hall.json", "hall/map.yaml", "hall/map.yaml"),
        ("hall.json", "hall.yaml", "hall.yaml"),
        ("worlds/hall/scenarios/1.json", "worlds/hall/map/map.yaml", "map/map.yaml"),
        ("worlds/hall/scenarios/1.json", "worlds/hall/scenarios/hall.yaml", "hall.yaml"),
        ("setup/scenarios/1.json", "setup/maps/hall/map.yaml", "maps/hall/map.yaml"),
    ],
)
def test_the_map_of_arena_is_the_stage_and_copied_to_the_trial(tmp_path, scenario, place, name, capsys):
    write_map(tmp_path / place)
    file = tmp_path / scenario
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(ARENA)
    out = tmp_path / "mine" / "ward.xml"
    out.parent.mkdir()
    assert main(["new", "trial", str(out), "--import", str(file)]) == 0
    assert f"copied {name} to the folder of the trial" in capsys.readouterr().out
    stage = load_trial(out).stage
    assert (stage.map, (out.parent / name).read_text()[:5]) == (name, "image")
    assert stage.clearance([(0.0, 0.0)])[0] == pytest.approx(19.5, abs=0.6)
    done = import_trial(file)
    assert trial_of(done).stage.map == name
    assert not any("the map" in sentence for sentence in done.left_out)
    home = (tmp_path / place.removesuffix(name)).resolve()
    assert f"the stage reads {name} in the folder of the trial, a copy of that in {home}" in done.left_out


@pytest.mark.parametrize("named", [True, False])
def test_the_map_of_another_world_is_not_taken(tmp_path, named):
    """A scenario that names no map has that of its world."""
    write_map(tmp_path / "other" / "map" / "map.yaml")
    (tmp_path / "other" / "scenarios").mkdir()
    file = tmp_path / "other" / "scenarios" / "1.json"
    file.write_text(ARENA if named else ARENA.replace('"map": "hall"', '"resets": 0'))
    assert trial_of(import_trial(file)).stage.map == ("" if named else "map/map.yaml")


@pytest.mark.parametrize(
    ("old", "new", "people", "sentence"),
    [
        (
            '"waypoint_mode": 2',
            '"waypoint_mode": 1',
            1,
            "doctor goes to its waypoints at random in Arena-Rosnav, here in order",
        ),
        (
            '"vmax": 1.1',
            '"number_of_peds": 3',
            1,
            "doctor stands for 3 people: one is imported, since the file has one place",
        ),
        (
            '"vmax": 1.1',
            '"wait_time": 4, "chatting_probability": 0.1',
            1,
            "parameters of people are not imported: chatting_probability, wait_time",
        ),
        (
            '"vmax": 1.1',
            '"start_up_mode": "trigger_zone"',
            1,
            "doctor: the start up mode trigger_zone is not imported, people go at once",
        ),
        ('"vmax": 1.1', '"vmax": 9', 1, "doctor has a speed of 9 m/s, which is unlikely for a person"),
        ('"type": "forklift"', '"type": "elder"', 2, None),
        ("[[-3, -7.5, 0], [-3, -5, 0]]", "[]", 1, None),
        (
            '"map": "hall"',
            '"map": "../../etc/hall"',
            1,
            "the map '../../etc/hall' is not beside the scenario as ../../etc/hall/map.yaml or ../../etc/hall.yaml, nor"
            " in the folder above: the stage has no walls, add them",
        ),
    ],
)
def test_variants_of_arena(tmp_path, old, new, people, sentence):
    assert old in ARENA
    done = imported(tmp_path, "scenario.json", ARENA.replace(old, new, 1))
    assert len(trial_of(done).agents) == people
    assert sentence is None or sentence in done.left_out


def test_older_scenarios_of_arena_are_read(tmp_path):
    text = """{"pedsim_agents": [{"name": "Pedestrian", "id": 0, "pos": [10.5, 1.8], "type": "adult", "vmax": 1.0,
      "waypoints": [[12.5, 5.9], [17.4, 8.1]], "waypoint_mode": 0}],
      "static_obstacles": [{"name": "shelf", "model_path": "obstacles/shelf.yaml", "pos": [11.9, 14], "angle": 6.28}],
      "robot_position": [-1.3, -1.3], "robot_goal": [22.3, 16.5], "map_path": "map4/map.yaml",
      "format": "arena-tools"}"""
    done = imported(tmp_path, "scenario.json", text)
    trial = trial_of(done)
    assert (trial.agents[0].position, len(trial.journeys[0].stops)) == ((10.5, 1.8), 2)
    assert (trial.robots[0].position, trial.robots[0].goal.position) == ((-1.3, -1.3), (22.3, 16.5))
    assert any("the map 'map4/map.yaml' is not beside" in sentence for sentence in done.left_out)


def test_gazebo_has_solids_and_actors_and_names_what_it_lacks(tmp_path):
    done = imported(tmp_path, "hall.world", GAZEBO)
    trial = trial_of(done)
    wall, post = (np.array(obstacle.points) for obstacle in trial.stage.obstacles)
    assert np.ptp(wall, axis=0) == pytest.approx([0.2, 4.0], abs=1e-5)
    assert wall.mean(axis=0) == pytest.approx([2.0, 0.0], abs=1e-5)
    assert np.hypot(*(post - (5.0, 1.0)).T) == pytest.approx(0.3, abs=1e-5)
    (ann,) = trial.agents
    assert (ann.name, ann.position, ann.speed) == ("ann", (0.0, 3.0), pytest.approx(1.2))
    (way,) = trial.journeys
    assert (way.then, [(stop.x, stop.y) for stop in way.stops]) == ("again", [(6.0, 3.0), (0.0, 3.0)])
    for sentence in (
        "<include> of 'table_1' in line 4 is left out: model://table is not beside the world; copy its folder there, or"
        " add its outline as <obstacle>",
        "the model 'post' can be moved in Gazebo, and is fixed here",
        "a box of the model 'ceiling' is above 1.8 m, and is left out",
        "the model 'cart' in line 11 is left out: it has joints and a wheel (joint 'j'), and is probably a robot; add"
        ' it as <robot x="0" y="0"/>, or as <door> if it is one',
        "the <mesh> chair.dae of the model 'chair' in line 12 is left out: the file is not beside the world; copy it"
        " there, or add its outline as <obstacle>",
        "the actor 'ann' waits at waypoints: here people go on at once",
        "the actor 'ann' starts 2 s later in Gazebo, here at once",
    ):
        assert sentence in done.left_out


@pytest.mark.parametrize("folder", ["table", "models/table"])
def test_included_models_beside_the_world_are_read(tmp_path, folder):
    model = (
        '<sdf version="1.6"><model name="table"><static>1</static><link name="l"><collision name="c"><geometry>'
        "<box><size>2 1 2</size></box></geometry></collision></link></model></sdf>"
    )
    (tmp_path / folder).mkdir(parents=True)
    (tmp_path / folder / "model.sdf").write_text(model)
    trial = trial_of(imported(tmp_path, "hall.world", GAZEBO))
    corners = [np.array(obstacle.points) for obstacle in trial.stage.obstacles]
    assert len(corners) == 3
    assert corners[0].mean(axis=0) == pytest.approx([9.0, 9.0])


def test_a_model_that_includes_itself_is_rejected(tmp_path):
    (tmp_path / "table").mkdir()
    (tmp_path / "table" / "model.sdf").write_text(
        '<sdf version="1.6"><model name="t"><include><uri>model://table</uri></include></model></sdf>'
    )
    with pytest.raises(TrialError, match="levels of them, are too many"):
        imported(tmp_path, "hall.world", GAZEBO)


@pytest.mark.parametrize(
    ("old", "new", "people", "obstacles", "sentence"),
    [
        ("<loop>true</loop>", "<loop>false</loop>", 1, 2, None),
        ("<size>4 0.2 2.5</size>", "<size>4 0.2 0.01</size>", 1, 2, None),
        ("2 0 0 0 0 1.5707963", "2 0 1 1.5707963 0 0", 1, 2, None),
        (
            "<cylinder><radius>0.3</radius><length>1</length></cylinder>",
            "<sphere><radius>0.5</radius></sphere>",
            1,
            2,
            None,
        ),
        (
            "<cylinder><radius>0.3</radius><length>1</length></cylinder>",
            "<polyline><point>0 0</point><point>1 0</point><point>0 1</point><height>2</height></polyline>",
            1,
            2,
            None,
        ),
        (
            "<cylinder><radius>0.3</radius><length>1</length></cylinder>",
            "<plane><normal>0 0 1</normal></plane>",
            1,
            1,
            None,
        ),
        ("<time>5</time>", "<time>0.5</time>", 1, 2, None),
        (
            '<actor name="ann">',
            '<actor name="ann"><plugin name="p" filename="libp.so"/><pose>1 2 0 0 0 0</pose>',
            1,
            2,
            "the plugin 'p' of the actor 'ann' is not imported",
        ),
        ('<sdf version="1.6">', '<sdf version="1.6"><world name="v"><model name="x"/></world>', None, None, None),
        (
            "<include><uri>model://sun</uri></include>",
            "<population name='p'/>",
            1,
            2,
            "<population> in line 3 is not imported",
        ),
        (
            "model://table",
            "model://../../table",
            1,
            2,
            "<include> of 'table_1' in line 4 is left out: model://../../table is not beside the world; copy its folder"
            " there, or add its outline as <obstacle>",
        ),
    ],
)
def test_variants_of_gazebo(tmp_path, old, new, people, obstacles, sentence):
    assert old in GAZEBO
    text = GAZEBO.replace(old, new, 1)
    if people is None:
        with pytest.raises(TrialError, match="no solids, people or robots that can be imported; the file has 2 worlds"):
            imported(tmp_path, "hall.world", text)
        return
    done = imported(tmp_path, "hall.world", text)
    trial = trial_of(done)
    assert (len(trial.agents), len(trial.stage.obstacles)) == (people, obstacles)
    assert sentence is None or sentence in done.left_out
    assert trial.journeys[0].then == ("stay" if "false" in new else "again")


TABLE = (
    '<sdf version="1.6"><model name="table"><pose>0 0 0.5 0 0 0</pose><static>1</static><link name="l"><collision'
    ' name="c"><geometry><box><size>2 1 1</size></box></geometry></collision></link></model></sdf>'
)
INCLUDE = "<include><uri>{uri}</uri><name>table_1</name>{more}</include>"


@pytest.mark.parametrize(
    ("file", "uri"),
    [
        ("package/worlds/table/model.sdf", "model://table"),
        ("package/worlds/models/table/model.sdf", "model://table"),
        ("package/models/table/model.sdf", "model://table"),
        ("package/models/table/table.sdf", "https://fuel.gazebosim.org/1.0/OpenRobotics/models/table/3"),
        ("package/models/table/model.sdf", "file://../models/table"),
        ("package/models/table/model.sdf", "package://package/models/table"),
        ("package/table/model.sdf", "model://table/"),
        ("package/models/table/model.sdf", "../models/table/model.sdf"),
    ],
)
@pytest.mark.parametrize(
    ("more", "middle"),
    [
        ("", (0.0, 0.0)),
        ("<pose>3 4 0 0 0 0</pose>", (3.0, 4.0)),
        ("<pose degrees='1'>3 4 0 0 0 90</pose><static>false</static>", (3.0, 4.0)),
    ],
)
def test_models_of_a_package_are_found(tmp_path, file, uri, more, middle):
    path = tmp_path / file
    path.parent.mkdir(parents=True)
    path.write_text(TABLE)
    worlds = tmp_path / "package" / "worlds"
    worlds.mkdir(exist_ok=True)
    done = imported(worlds, "w.world", f"<sdf><world name='w'>{INCLUDE.format(uri=uri, more=more)}</world></sdf>")
    (table,) = (np.array(obstacle.points) for obstacle in trial_of(done).stage.obstacles)
    assert table.mean(axis=0) == pytest.approx(middle)  # the pose of <include> replaces that of the model
    assert np.ptp(table, axis=0) == pytest.approx([1.0, 2.0] if "90" in more else [2.0, 1.0], abs=1e-5)
    assert any("can be moved" in sentence for sentence in done.left_out) == ("false" in more)


@pytest.mark.parametrize(
    ("pose", "middle"),
    [
        ("<pose>1 2 0 0 0 0</pose>", (11, 2)),
        ("<pose relative_to='__model__'>1 2 0 0 0 0</pose>", (11, 2)),
        ("<pose relative_to='leg'>1 2 0 0 0 0</pose>", (8, 4)),  # the leg is turned by 90 degrees
        ("<pose relative_to='mark'>1 2 0 0 0 0</pose>", (8, 5)),
        ("<pose relative_to='hinge'>1 2 0 0 0 0</pose>", (8, 5)),
        ("<pose frame='leg'>1 2 0 0 0 0</pose>", (8, 4)),
    ],
)
def test_poses_of_gazebo_are_relative_to_what_they_name(tmp_path, pose, middle):
    box = '<collision name="c">{}<geometry><box><size>2 1 1</size></box></geometry></collision>'
    world = (
        "<sdf version='1.9'><world name='w'><frame name='hall'><pose>10 0 0 0 0 0</pose></frame>"
        "<model name='desk'><static>1</static><pose relative_to='hall'>0 0 0.5 0 0 0</pose>"
        "<link name='leg'><pose degrees='1'>0 3 0 0 0 90</pose></link>"
        "<frame name='mark' attached_to='leg'><pose>1 0 0 0 0 0</pose></frame>"
        "<joint name='hinge' type='fixed'><child>leg</child><pose>1 0 0 0 0 0</pose></joint>"
        "<link name='top'>{}{}</link></model></world></sdf>"
    )
    for text in (world.format(pose, box.format("")), world.format("", box.format(pose))):
        done = imported(tmp_path, "w.world", text)
        (top,) = (np.array(obstacle.points) for obstacle in trial_of(done).stage.obstacles)
        assert top.mean(axis=0) == pytest.approx(middle, abs=1e-6)
        assert not any("relative" in sentence for sentence in done.left_out)
    unknown = imported(
        tmp_path, "w.world", world.format("<pose relative_to='shelf'>1 2 0 0 0 0</pose>", box.format(""))
    )
    assert any("is relative to 'shelf', which is not in the same model" in sentence for sentence in unknown.left_out)
    circle = world.format("<pose relative_to='top'>1 2 0 0 0 0</pose>", box.format(""))
    with pytest.raises(TrialError, match=r"w.world: line 1: the pose of 'top' is relative to itself"):
        imported(tmp_path, "w.world", circle)


def test_a_malformed_included_model_is_left_out_and_named(tmp_path):
    (tmp_path / "table").mkdir()
    (tmp_path / "table" / "model.sdf").write_text("<sdf><model name='table'>\n<link></model></sdf>")
    done = imported(tmp_path, "hall.world", GAZEBO)
    left_out = next(sentence for sentence in done.left_out if "'table_1'" in sentence)
    assert left_out.startswith("<include> of 'table_1' in line 4 is left out: table/model.sdf:2: ")
    assert left_out.endswith("mend the file, or add its outline as <obstacle>")
    (tmp_path / "table" / "model.sdf").write_text(TABLE.replace("2 1 1", "2 1"))
    with pytest.raises(TrialError, match=r"line 1 of table/model.sdf: <box> needs <size> with 3 numbers"):
        imported(tmp_path, "hall.world", GAZEBO)


def test_models_of_gazebo_stand_where_the_saved_state_puts_them(tmp_path):
    (tmp_path / "table").mkdir()
    (tmp_path / "table" / "model.sdf").write_text(TABLE)
    state = (
        "<state world_name='w'><model name='table_1'><pose>7 8 0.5 0 0 0</pose></model>"
        "<model name='wall'><pose>1 1 0 0 0 0</pose><scale>2 1 1</scale></model></state>"
    )
    done = imported(tmp_path, "hall.world", GAZEBO.replace("</world>", f"{state}</world>"))
    middles = [np.array(obstacle.points).mean(axis=0) for obstacle in trial_of(done).stage.obstacles]
    assert middles[0] == pytest.approx([7.0, 8.0])
    assert middles[1] == pytest.approx([1.0, 1.0])
    assert any(sentence.startswith("the scale of 'wall' in <state> (line 18)") for sentence in done.left_out)


@pytest.mark.needs("trimesh")
@pytest.mark.parametrize("ending", ["stl", "obj", "dae", "ply", "glb"])
@pytest.mark.parametrize("place", ["hall/meshes", "models/hall/meshes"])
def test_a_mesh_of_gazebo_becomes_walls(tmp_path, ending, place):
    import trimesh

    folder = tmp_path / place
    folder.mkdir(parents=True)
    box = trimesh.creation.box((400.0, 200.0, 250.0)).apply_translation((0.0, 0.0, 125.0))
    box.export(folder / f"wall.{ending}")
    mesh = f"<mesh><uri>model://hall/meshes/wall.{ending}</uri><scale>0.01 -0.01 0.01</scale></mesh>"
    text = GAZEBO.replace("<box><size>4 0.2 2.5</size></box>", mesh).replace("0 0 1.25 0 0 0", "0 0 0 0 0 0")
    done = imported(tmp_path, "hall.world", text)
    (wall,) = (np.array(wall.points) for wall in trial_of(done).stage.walls)
    assert wall[0] == pytest.approx(wall[-1])
    assert np.ptp(wall, axis=0) == pytest.approx([2.0, 4.0], abs=0.01)
    assert 0.5 * (wall.max(axis=0) + wall.min(axis=0)) == pytest.approx([2.0, 0.0], abs=0.01)
    low = imported(tmp_path, "hall.world", text.replace("0.01</scale>", "0.0001</scale>"))
    assert any("nothing of it is 0.25, 0.9, 1.6 m above" in sentence for sentence in low.left_out)
    (folder / f"wall.{ending}").write_bytes(b"no mesh")
    lost = imported(tmp_path, "hall.world", text)
    assert any("the <mesh>" in sentence and "in line 6 is left out" in sentence for sentence in lost.left_out)


DAE = """<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="0.5"/></asset>
<library_geometries>{shapes}</library_geometries><library_visual_scenes><visual_scene id="s">{nodes}</visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
SHAPE = """<geometry id="{id}"><mesh><source id="{id}p"><float_array id="{id}a" count="{count}">{points}</float_array>
<technique_common><accessor source="#{id}a" count="{rows}" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="{id}v"><input semantic="POSITION" source="#{id}p"/></vertices><triangles count="{faces}">
<input semantic="VERTEX" source="#{id}v" offset="0"/><p>{corners}</p></triangles></mesh></geometry>"""


def dae(meshes):
    """A DAE file in units of 0.5 m; a node has the name of a mesh, with that of its id only the mesh without spaces."""
    shapes = nodes = ""
    for k, (name, mesh) in enumerate(meshes.items()):
        points, corners = 2.0 * mesh.vertices, mesh.faces.ravel()
        shapes += SHAPE.format(
            id=f"g{k}", rows=len(points), count=points.size, faces=len(mesh.faces),
            points=" ".join(map(str, points.ravel())), corners=" ".join(map(str, corners)),
        )  # fmt: skip
        named = f'id="n{k}" name="{name}"' if " " in name else f'id="{name}"'
        nodes += f'<node {named}><node><instance_geometry url="#g{k}"/></node></node>'
    return DAE.format(shapes=shapes, nodes=nodes).encode()


def two_boxes(folder, ending):
    """Write a mesh of the parts "north wall", from (0, 4) to (2, 5), and "post", from (5, 0) to (6, 1), 2 m high."""
    import trimesh

    parts = {"north wall": ((2, 1, 2), (1, 4.5, 1)), "post": ((1, 1, 2), (5.5, 0.5, 1))}
    meshes = {name: trimesh.creation.box(size).apply_translation(at) for name, (size, at) in parts.items()}
    data = dae(meshes) if ending == "dae" else trimesh.Scene(meshes).export(file_type=ending)
    (folder / f"hall.{ending}").write_bytes(data.encode() if isinstance(data, str) else data)


@pytest.mark.needs("trimesh")
@pytest.mark.parametrize("ending", ["dae", "obj", "glb"])
@pytest.mark.parametrize(
    ("part", "low", "high"),
    [
        ("", (0, 0), (6, 5)),
        ("<submesh><name>north wall</name></submesh>", (0, 4), (2, 5)),
        ("<submesh><name>post</name><center>false</center></submesh>", (5, 0), (6, 1)),
        ("<submesh>\n<center>1</center>\n<name> post </name></submesh>", (-0.5, -0.5), (0.5, 0.5)),
        ("<submesh><name>north wall</name><center>true</center></submesh><scale>2 1 1</scale>", (-2, -0.5), (2, 0.5)),
    ],
)
def test_a_submesh_of_gazebo_is_the_part_of_its_name(tmp_path, ending, part, low, high):
    two_boxes(tmp_path, ending)
    world = (
        "<sdf version='1.7'><world name='w'><model name='m'><static>1</static><pose>0 0 0.7 0 0 0</pose><link name='l'>"
        f"<collision name='c'><geometry><mesh><uri>hall.{ending}</uri>{part}</mesh></geometry></collision></link>"
        "</model></world></sdf>"
    )
    done = imported(tmp_path, "w.world", world)
    corners = np.concatenate([np.array(wall.points) for wall in trial_of(done).stage.walls])
    assert (corners.min(axis=0), corners.max(axis=0)) == (pytest.approx(low, abs=0.01), pytest.approx(high, abs=0.01))
    assert not any("mesh" in sentence for sentence in done.left_out)


@pytest.mark.needs("trimesh")
@pytest.mark.parametrize(
    ("ending", "name", "sentence"),
    [
        ("dae", "pots", "it has no part 'pots', did you mean 'post'?; its parts: 'north wall', 'post'"),
        ("obj", "roof", "it has no part 'roof'; its parts: 'north wall', 'post'"),
        ("glb", "world", "it has no part 'world'; its parts: 'north wall', 'post'"),
        ("stl", "post", "its parts have no names, so it has no part 'post'; use a dae, obj, glb file"),
        ("ply", "post", "its parts have no names, so it has no part 'post'; use a dae, obj, glb file"),
    ],
)
def test_a_submesh_that_is_not_in_the_mesh_is_named(tmp_path, ending, name, sentence):
    two_boxes(tmp_path, ending)
    mesh = f"<mesh><uri>hall.{ending}</uri><submesh><name>{name}</name></submesh></mesh>"
    done = imported(tmp_path, "hall.world", GAZEBO.replace("<box><size>4 0.2 2.5</size></box>", mesh))
    assert not trial_of(done).stage.walls
    (lost,) = (text for text in done.left_out if "the <mesh> hall." in text)
    assert f"of the model 'wall' in line 6 is left out: {sentence}; add its outline as <obstacle>" in lost


@pytest.mark.parametrize(
    ("inside", "file", "extent"),
    [
        (
            "<uri>hills.png</uri><size>129 129 10</size><pos>0 0 0</pos>",
            "hills.png",
            "129 x 129 m with heights up to 10",
        ),
        ("<size>120 80 2.5</size><uri>file://dem.tif</uri>", "file://dem.tif", "120 x 80 m with heights up to 2.5"),
        ("<uri>model://yard/yard.png</uri>", "model://yard/yard.png", "1 x 1 m with heights up to 1"),
        ("<use_terrain_paging>1</use_terrain_paging><uri>a.jpg</uri><size>9 9 0</size>", "a.jpg", "9 x 9 m"),
        ("<uri>b.png</uri><size>30 30 5</size><texture><size>5</size></texture>", "b.png", "30 x 30 m"),
    ],
)
def test_a_heightmap_of_gazebo_says_which_ground_is_lost(tmp_path, inside, file, extent):
    hills = f"<heightmap>{inside}</heightmap>"
    done = imported(tmp_path, "hall.world", GAZEBO.replace("<box><size>4 0.2 2.5</size></box>", hills))
    assert len(trial_of(done).stage.obstacles) == 1
    (lost,) = (text for text in done.left_out if "<heightmap>" in text)
    assert f"the <heightmap> {file} of the model 'wall' in line 6 is left out: its ground of {extent}" in lost
    assert lost.endswith("its steps as <stairs> or <platform>, and what nobody passes as <obstacle>")


def test_a_heightmap_with_a_malformed_size_is_refused(tmp_path):
    hills = "<heightmap><uri>a.png</uri><size>129 129</size></heightmap>"
    with pytest.raises(TrialError, match="line 6: <heightmap> needs <size> with 3 numbers"):
        imported(tmp_path, "hall.world", GAZEBO.replace("<box><size>4 0.2 2.5</size></box>", hills))


HINGE = "<joint name='hinge' type='revolute'><axis><limit><lower>{}</lower><upper>{}</upper></limit></axis></joint>"


@pytest.mark.parametrize(
    ("joint", "robot"),
    [
        (HINGE.format(0, 1.57), False),
        (HINGE.format(-1e16, 1e16), True),
        (HINGE.format("-inf", "inf"), True),
        ("<joint name='slide' type='prismatic'/>", False),
        ("<joint name='wheel' type='revolute'/>", True),
        (HINGE.format(0, 1.57) + "<plugin name='door' filename='libdoor.so'/>", True),
    ],
)
def test_a_model_with_joints_is_a_robot_or_stands_still(tmp_path, joint, robot):
    text = GAZEBO.replace('<model name="post">', f'<model name="post">{joint}')
    done = imported(tmp_path, "hall.world", text)
    assert len(trial_of(done).stage.obstacles) == (1 if robot else 2)
    word = "is left out: it has joints and" if robot else "has joints: its links are fixed as they stand"
    assert any(f"the model 'post' in line 7 {word}" in sentence for sentence in done.left_out)


def test_an_actor_without_waypoints_stands(tmp_path):
    text = '<sdf version="1.6"><world name="w"><actor name="bob"><pose>1 2 0 0 0 1</pose></actor></world></sdf>'
    (bob,) = trial_of(imported(tmp_path, "hall.world", text)).agents
    assert (bob.position, bob.journey, bob.heading) == ((1.0, 2.0), "", pytest.approx(1.0))


def test_jupedsim_has_walls_doors_groups_and_goals(tmp_path):
    done = imported(tmp_path, "project.xml", PROJECT)
    trial = trial_of(done)
    assert (trial.duration, len(trial.stage.walls), len(trial.stage.obstacles)) == (60.0, 1, 1)
    (group,) = trial.spawners
    assert (group.count, str(group.speed)) == (8, "normal(1.2, 0.1, 0.9, 1.5)")
    (single,) = trial.agents
    ways = {journey.name: journey for journey in trial.journeys}
    assert (single.position, ways[single.journey].stops[0].points[1]) == ((8.0, 3.0), (2.0, 1.0))
    (door,) = trial.exits
    assert np.array(door.zone).mean(axis=0) == pytest.approx([10.0, 3.0])
    assert ways[group.journey].stops[0].points == door.zone
    for sentence in (
        "group 2: not imported are pre_movement_mean",
        "<train_constraints> in line 10 is not imported",
    ):
        assert sentence in done.left_out


@pytest.mark.parametrize(("name", "text"), [("hall.xml", MENGE_PROJECT), ("hallS.xml", MENGE)])
def test_menge_has_obstacles_agents_and_goals(tmp_path, name, text):
    done = imported(tmp_path, name, text)
    trial = trial_of(done)
    assert (trial.step, len(trial.stage.obstacles), len(trial.stage.walls)) == (0.1, 1, 1)
    assert [agent.position for agent in trial.agents[:3]] == [(1.0, 2.0), (1.0, 4.0), (-9.0, -9.0)]
    assert [agent.position for agent in trial.agents[3:]] == [(-8, -9), (-7, -9), (-9, -7), (-8, -7), (-7, -7)]
    assert {(agent.speed, agent.radius) for agent in trial.agents} == {(1.3, 0.2), (0.8, 0.2)}
    ways = {journey.name: journey for journey in trial.journeys}
    walk, cross = ways[trial.agents[0].journey], ways[trial.agents[2].journey]
    assert (walk.then, len(walk.stops), walk.stops[0].points[2]) == ("again", 2, (9.0, 3.0))
    assert (cross.then, [(stop.x, stop.y) for stop in cross.stops]) == ("stay", [(9.0, 9.0)])
    assert "the transition from 'Stop' in line 11 is not imported" in done.left_out


@pytest.mark.parametrize(
    ("old", "new", "people", "sentence"),
    [
        ('type="rect_grid"', 'type="hex_lattice"', 2, "the generator of type 'hex_lattice' in line 9 is left out"),
        ('count_y="2"', 'count_y="2" displace_dist="u"', 8,
         "random displacements of agents on a grid are not imported"),
        ('dist="c" value="0.8"', 'dist="u" min="0.6" max="1.0"', 8,
         "the distribution of pref_speed is not imported: all have its middle"),
        ('name="Walk"/>', 'name="Run"/>', 8, "there is no state 'Run': people stay"),
        ('<ObstacleSet type="explicit"', '<ObstacleSet type="nav_mesh"', 8,
         "the obstacle set of type 'nav_mesh' in line 10 is not imported"),
        ('r="0.2"', 'r="0.2" mass="80"', 8, None),
        ('</Experiment>', '<AgentSource rate="2"/></Experiment>', 8, "<AgentSource> in line 12 is not imported"),
        ('</Experiment>', '<Portal/></Experiment>', 8, "<Portal> in line 12 is not imported"),
        ('</Generator></AgentGroup>', '</Generator><Noise/></AgentGroup>', 8,
         "<Noise> of the agents in line 6 is not imported"),
        ('type="const" name="slow"', 'type="const" name="fast"', 8,
         "there is no profile 'fast': its agents have the usual values"),
    ],
)  # fmt: skip
def test_variants_of_menge(tmp_path, old, new, people, sentence):
    assert old in MENGE
    done = imported(tmp_path, "hallS.xml", MENGE.replace(old, new, 1))
    assert len(trial_of(done).agents) == people
    assert sentence is None or sentence in done.left_out


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('<VelComponent type="goal"/>', '<VelComponent type="nav_mesh" file_name="hall.nav"/>',
         "the velocity component 'nav_mesh' of state 'Walk' is not imported: routes avoid walls"),
        ('<VelComponent type="goal"/>', '<VelComponent type="road_map"/>',
         "the velocity component 'road_map' of state 'Walk' is not imported: routes avoid walls"),
        ('<VelComponent type="goal"/>', '<VelModifier type="formation"/>',
         "<VelModifier> of state 'Walk' is not imported"),
        ('<VelComponent type="goal"/>', '<Action type="teleport"/>',
         "the action 'teleport' of state 'Walk' is not imported"),
        ('</BFSM>', '<VelModifier type="formation"/></BFSM>', "<VelModifier> of the behaviour is not imported"),
    ],
)  # fmt: skip
def test_what_a_behaviour_of_menge_loses_is_named(tmp_path, old, new, sentence):
    named_files(tmp_path)
    assert old in STATES
    (tmp_path / "hallB.xml").write_text(STATES.replace(old, new, 1))
    (tmp_path / "hallS.xml").write_text(MENGE)
    assert sentence in import_trial(tmp_path / "hallS.xml").left_out


SOURCE = '<source id="9" frequency="2" group_id="1"/>'
GROUP_3 = '<group group_id="3" room_id="0" number="0" goal_id="4" x_min="6" x_max="9" y_min="4" y_max="5"/>'


@pytest.mark.parametrize(
    ("new", "rate", "begin", "end", "most", "middle", "sentence"),
    [
        (SOURCE, 0.5, 0.0, math.inf, None, (2.5, 3.0), None),
        (
            '<source id="9" frequency="4" N_create="8" agents_max="30" time_min="5" time_max="50" group_id="3"/>',
            2.0, 5.0, 50.0, 30, (7.5, 4.5), "source 9: 8 people each 4 s enter one after another, not at once",
        ),
        ('<source id="9" time="12" startX="3" startY="4" group_id="3"/>', 1.0, 12.0, math.inf, None, (3.0, 4.0), None),
        (
            '<source id="9" group_id="1" x_min="2" x_max="4" y_min="1" y_max="3" greedy="true" agents_max="-1"/>',
            1.0, 0.0, math.inf, None, (3.0, 2.0), "source 9: not imported are greedy",
        ),
        ("<file>sources.xml</file>", 0.25, 0.0, math.inf, 7, (7.5, 4.5), None),
    ],
)  # fmt: skip
def test_a_source_of_jupedsim_becomes_a_source(tmp_path, new, rate, begin, end, most, middle, sentence):
    (tmp_path / "sources.xml").write_text(
        '<JPScore><agents_sources><source id="2" frequency="4" agents_max="7" group_id="3"/></agents_sources></JPScore>'
    )
    text = PROJECT.replace(SOURCE, new).replace("</agents_distribution>", f"{GROUP_3}</agents_distribution>")
    done = imported(tmp_path, "project.xml", text)
    trial = trial_of(done)
    (source,) = trial.sources
    assert (source.rate, source.begin, source.end, source.max_count, source.timing) == (
        rate, begin, end, most, "regular"
    )  # fmt: skip
    assert np.array(source.zone).mean(axis=0) == pytest.approx(middle)
    ways = {journey.name: journey for journey in trial.journeys}
    goal = (1.6, 1.3) if 'group_id="3"' in new or "file" in new else (10.0, 3.0)
    assert np.array(ways[source.journey].stops[0].points).mean(axis=0) == pytest.approx(goal, abs=0.3)
    assert sentence is None or sentence in done.left_out
    assert parse_trial(trial_xml(trial)) == trial


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (SOURCE, SOURCE.replace('"1"', '"7"'), "there is no group '7'; add a <source> with a zone and a goal"),
        (SOURCE, SOURCE.replace('"2"', '"0"'), "nobody enters by its numbers"),
        (SOURCE, SOURCE.replace("/>", ' time_min="9" time_max="3"/>'), "nobody enters by its numbers"),
        ('x_min="1" x_max="4"', 'x_min="4" x_max="1"', "it needs a zone, and a goal or a door to the outside"),
        (SOURCE, "<file>../s.xml</file>", "<file> of <agents_sources> in line 6 is left out: the file '../s.xml' lies"),
    ],
)
def test_a_source_of_jupedsim_that_is_lost_is_named(tmp_path, old, new, sentence):
    done = imported(tmp_path, "project.xml", PROJECT.replace(old, new))
    assert trial_of(done).sources == ()
    assert any("in line 6" in item and sentence in item for item in done.left_out)


@pytest.mark.parametrize(
    ("old", "new", "spawners", "agents", "sentence"),
    [
        ('x_min="1" x_max="4" y_min="1" y_max="5"', 'subroom_id="0"', 1, 1,
         "group 1 begins in the box around its room"),
        ('x_min="1" x_max="4"', 'x_min="4" x_max="1"', 0, 1, "group 1 begins in a box without area and is left out"),
        ('room_id="0" number="8" agent_parameter_id="1" x_min="1"', 'room_id="5" number="8"', 0, 1,
         "group 1 is in room '5', which has no walls, and is left out"),
        ('goal_id="4"', 'goal_id="5"', 1, 1, "group 2: there is no goal '5' with a polygon, people go to an exit"),
        ('group_id="1" room_id="0" number="8"', 'group_id="5" room_id="0" number="0"', 0, 1,
         "group 5 has 0 people and is left out"),
        ('sigma="0.1"', "", 1, 1, None),
    ],
)  # fmt: skip
def test_variants_of_jupedsim(tmp_path, old, new, spawners, agents, sentence):
    assert old in PROJECT
    done = imported(tmp_path, "project.xml", PROJECT.replace(old, new, 1))
    trial = trial_of(done)
    assert (len(trial.spawners), len(trial.agents)) == (spawners, agents)
    assert sentence is None or sentence in done.left_out


@pytest.mark.parametrize(
    ("name", "old", "new", "sentence"),
    [
        ("hall.xml", "hallS.xml", "../hallS.xml", "the file '../hallS.xml' lies outside"),
        ("hall.xml", 'scene="hallS.xml"', "", "is not a project of Menge: it names no scene"),
        ("hall.xml", "hallS.xml", "hallB.xml", "the scene has the root element <BFSM>"),
        ("hallS.xml", 'count_x="3"', 'count_x="30000"', "30000 x 2 agents, at most 5000 are read"),
        ("hallS.xml", 'p_x="1"', 'p_x="left"', "p_x of <Agent> must be a number up to 1e6, not 'left'"),
        ("project.xml", "rooms.xml", "../rooms.xml", "the geometry the file '../rooms.xml' lies outside"),
        ("project.xml", "rooms.xml", "none.xml", "the geometry there is no file 'none.xml'"),
        ("project.xml", 'number="8"', 'number="90000"', "more than 20000 people are too many"),
        ("rooms.xml", 'px="5"', 'px="west"', "px of <vertex> must be a number up to 1e6, not 'west'"),
        ("rooms.xml", 'unit="m"', 'unit="cm"', "the unit 'cm' of the geometry is not m"),
        (
            "world.yaml",
            "state: [2, 8, 0]",
            "state: [west, 8, 0]",
            "world.yaml: obstacle 3: state must be a number up to 1e6, not 'west'",
        ),
        ("world.yaml", "state: [2, 8, 0]", "state: [1e9, 8, 0]", "must be a number up to 1e6"),
        (
            "world.yaml",
            "vertices: [[0, 0], [0, 3]]",
            "vertices: 3",
            "vertices of a linestring must be a list of points",
        ),
        ("world.yaml", "name: walker", "number: 900000", "more than 5000 objects are too many"),
        ("world.yaml", "world: {", "world: !!python/object:os.system {", "the tag '!!python/object:os.system'"),
        ("scenario.json", "[-1, -7.5, 0]", "[-1]", "person 'doctor': pos must be [x, y, angle], not '[-1]'"),
        ("scenario.json", "[[-3, -7.5, 0]", "[[NaN, -7.5, 0]", "doctor: waypoint 1 must be a number up to 1e6"),
        ("scenario.json", '"dynamic": [', '"dynamic": 3, "d": [', "dynamic must be a list of objects"),
        ("scenario.json", '"resets": 5', '"resets": ', "is not JSON"),
        ("hall.world", "<size>4 0.2 2.5</size>", "<size>4 0.2</size>", "<box> needs <size> with 3 numbers"),
        ("hall.world", "<size>4 0.2 2.5</size>", "<size>4 -1 2</size>", "<size> must not be below 0"),
        (
            "hall.world",
            "<pose>0 3 0 0 0 0</pose>",
            "<pose>0 3</pose>",
            "<pose> has 2 numbers, it needs x y z roll pitch yaw",
        ),
        ("hall.world", "<time>5</time>", "<time>x</time>", "<time> must be a number up to 1e6, not 'x'"),
        ("hall.world", '<?xml version="1.0"?>', '<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>', "DOCTYPE"),
    ],
)
def test_wrong_scenes_are_rejected(tmp_path, name, old, new, sentence):
    assert old in FILES[name]
    with pytest.raises(TrialError) as caught:
        imported(tmp_path, name, FILES[name].replace(old, new, 1))
    assert sentence in str(caught.value)


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("data", [b"", b"\xff\xfe\x00", b"{", b"[1]", b"<a/>", b"x" * 4_100_000, b"{}", b"[" * 9000])
def test_files_that_are_no_scene_end_with_a_sentence(tmp_path, name, data):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(TrialError, match=name.replace(".", r"\.")):
        import_trial(tmp_path / name)


WORDS = [
    "0",
    "-1",
    "1e300",
    "nan",
    "[]",
    "{}",
    "null",
    '""',
    "true",
    "<",
    ">",
    ",",
    ":",
    " ",
    "9" * 40,
    "é",
    "name",
    "[[1]]",
]


def mutated(text, chance):
    """A text with a few parts deleted, doubled, moved or replaced."""
    for _ in range(chance.randint(1, 4)):
        a, b = sorted(chance.randrange(len(text) + 1) for _ in range(2))
        b = min(b, a + chance.choice((1, 3, 12, 60)))
        piece = chance.choice(("", text[a:b] * 2, chance.choice(WORDS), text[a:b][::-1]))
        text = text[:a] + piece + text[b:]
    return text


@pytest.mark.parametrize("name", FILES)
def test_mutated_scenes_are_read_or_rejected(tmp_path, name):
    chance = random.Random(5)
    outcomes = set()
    for _ in range(150):
        try:
            done = imported(tmp_path, name, mutated(FILES[name], chance))
        except TrialError:
            outcomes.add("rejected")
        else:
            assert all(math.isfinite(value) for agent in trial_of(done).agents for value in agent.position)
            outcomes.add("read")
    assert outcomes == {"read", "rejected"}
