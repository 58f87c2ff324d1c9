"""Frames and descriptions of a scene against the numbers of the simulation."""

import dataclasses
import json

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.humans import shapes
from crowdbot.simulation import AddElementOrder, AddPersonOrder, Simulation
from crowdbot.trials import load_trial, parse_trial
from crowdbot.web import StateFrame
from crowdbot.web.scene import LAYERS, WalkingBodies, scene_description, scene_frame, scene_resource
from crowdbot.web.scene.frame import pack_bones
from crowdbot.web.scene.quaternions import quaternions
from crowdbot.world import simulated_body, worlds_of

HALL = """
<trial name="hall" duration="20" world="WORLD" bodies="limbs">
  <stage walkable="-6,-4 6,-4 6,4 -6,4">
    <obstacle points="-4,2 -3,2 -3,3 -4,3"/>
    <cube x="1.4" y="0" size="0.4" mass="5"/><table x="-4" y="-3"/>
    <chair x="-4" y="-2.2" heading="-1.5" seat="0.5"/><tree x="4" y="3"/>
    <door name="hall" points="3,-1 3,1" opening="schedule" times="0.2"/>
  </stage>
  <crowd type="orca"/>
  <spawner count="6" zone="-3,-2 2,-2 2,1.5 -3,1.5" goal="4,-3 5,-3 5,3 4,3"/>
  <robot name="pepper" type="pepper" x="0" y="0"><goal x="5" y="0"/><navigator type="straight"/></robot>
  <robot name="chair" type="wheelchair-rider" x="-5" y="0"><goal x="5" y="2"/><navigator type="straight"/></robot>
</trial>
"""


def run(trial, steps, seed=0):
    simulation = Simulation(trial, seed, posed=True)
    simulation.begin()
    for _ in range(steps):
        simulation.advance()
    return simulation


@pytest.fixture(scope="module", params=["planar", "physics"])
def hall(request):
    """A hall with everything after a second, in both worlds."""
    return run(parse_trial(HALL.replace("WORLD", request.param)), 20)


def sent(simulation, *layers):
    """The arrays as a browser gets them."""
    return StateFrame.decode(scene_frame(simulation, layers).encode())


def rotations(quaternion):
    """Rotations ``[..., 3, 3]`` of quaternions w, x, y, z of any length."""
    w, x, y, z = np.moveaxis(quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def test_people_are_where_the_simulation_has_them(hall):
    frame, scene = sent(hall), hall.world.scene
    motion = worlds_of(hall.world)[0].people
    assert frame.channel == "scene"
    assert frame.time == hall.world.clock.time
    agents = motion.agents[frame.arrays["who"]]
    assert len(agents) == int(scene.active[0, motion.agents].sum()) >= 7
    assert np.array_equal(frame.arrays["ids"], hall.world.ids[0, agents])
    expected = np.column_stack([scene.position[0, agents], scene.heading[0, agents], scene.velocity[0, agents]])
    assert np.allclose(frame.arrays["place"], expected, rtol=0, atol=1e-5)


def test_bones_decode_to_the_posture(hall):
    frame, motion = sent(hall), worlds_of(hall.world)[0].people
    posture, rows = motion.posture(), frame.arrays["who"]
    turn = rotations(frame.arrays["bones"].reshape(-1, 28, 4) / 32767.0)
    assert np.abs(turn - posture.rotation[rows]).max() < 1e-3
    assert np.allclose(frame.arrays["pelvis"], posture.position[rows, 0], rtol=0, atol=1e-5)
    body = motion.people.body[rows]
    head = shapes().head[body] * motion.people.scale[rows][:, None, None]
    place = np.zeros_like(posture.position[rows])
    for k, parent in enumerate(shapes().parents):
        step = np.einsum("nij,nj->ni", turn[:, parent], head[:, k] - head[:, parent])
        place[:, k] = frame.arrays["pelvis"] if parent < 0 else place[:, parent] + step
    assert np.abs(place - posture.position[rows]).max() < 1e-3


def test_packed_bones_are_those_of_the_table_of_quaternions():
    rng = np.random.default_rng(2)
    every = rng.normal(size=(40, 28, 4))
    every[0, :4] = np.eye(4)  # each branch at its exact edge
    every[1, :6] = [[1, 1, 0, 0], [1, 0, 1, 0], [0, 1, 1, 0], [0, 0, 1, 1], [1, 1, 1, 1], [0, 1, 0, -1]]
    turn, rows = rotations(every), np.array([39, 0, 1, 7])
    found = pack_bones(turn, rows)
    expected = 32767.0 * quaternions(turn[rows]).reshape(4, 112)
    assert found.dtype == np.int16
    assert np.abs(rotations(found.reshape(4, 28, 4) / 32767.0) - turn[rows]).max() < 1e-4
    clear = np.ones((4, 28), dtype=bool)
    clear[1:3] = False  # where two parts are equally large, either may be the positive one
    assert np.abs(found - expected).reshape(4, 28, 4)[clear].max() <= 0.5 + 1e-6


def test_links_of_robots_have_the_poses_of_the_simulation(hall):
    frame, found = sent(hall), scene_description(hall)
    links = frame.arrays["links"].astype(np.float64)
    first = 0
    for row, place in zip(frame.arrays["bots"], frame.arrays["botplace"], strict=True):
        control, names = hall.robots[row], found["robots"][row]["links"]
        assert found["robots"][row]["name"] == control.robot.name
        pose = hall.world.pose(control.agent)
        assert np.allclose(place[:3], [*pose.position[0], pose.heading[0]], atol=1e-5)
        body = simulated_body(hall.world, control.agent, 0)
        if body is None:
            robot = control.robot.body
            base = np.eye(4)
            cos, sin = np.cos(pose.heading[0]), np.sin(pose.heading[0])
            base[:2, :2], base[:3, 3] = [[cos, -sin], [sin, cos]], (*pose.position[0], robot.lift)
            frames = {name: base @ pose for name, pose in robot.model.poses(robot.posture).items()}
        else:
            frames = body.frames()
        for name in names:
            assert np.allclose(links[first, :3], frames[name][:3, 3], atol=1e-5)
            assert np.abs(rotations(links[first, 3:]) - frames[name][:3, :3]).max() < 1e-5
            first += 1
    assert first == len(links) > 20


def test_doors_and_props_move(hall):
    frame, world = sent(hall), worlds_of(hall.world)[0]
    assert np.allclose(frame.arrays["doors"], world.doors.signed_share)
    assert abs(frame.arrays["doors"][0]) > 0.5
    if hall.trial.world == "planar":
        assert "props" not in frame.arrays
    else:
        assert frame.arrays["propnum"].tolist() == [0]
        assert np.allclose(frame.arrays["props"][0, :3], world.prop(0)[:3, 3], atol=1e-6)
        assert frame.arrays["props"][0, 2] == pytest.approx(0.2, abs=0.01)


def test_layers_are_there_only_when_asked_for(hall):
    plain, every = sent(hall).arrays, sent(hall, *LAYERS).arrays
    assert not any(name.startswith(("scan", "pose", "cloud", "cones", "forces", "goals")) for name in plain)
    number = next(k for k, item in enumerate(scene_description(hall)["sensors"]) if item["kind"] == "scan")
    sensors = [sensor for control in hall.robots for sensor in control.sensors]
    ranges = sensors[number].reading(0).ranges[0]
    seen = np.isfinite(ranges)
    assert seen.sum() > 10
    assert np.abs(every[f"scan{number}"][seen] / 1000.0 - ranges[seen]).max() <= 5.1e-4
    assert (every[f"scan{number}"][~seen] == 65_535).all()
    agents = worlds_of(hall.world)[0].people.agents[every["who"]]
    assert np.allclose(every["goals"], hall.world.scene.goal[0, agents], atol=1e-5)
    assert every["cones"].shape[1] == 9
    assert len(every["cones"]) >= 2
    assert len(every["forces"]) == len(hall.world.forces_of(0))


def test_beams_end_where_the_reading_has_its_points(hall):
    found, arrays = scene_description(hall)["sensors"], sent(hall, "scans").arrays
    number = next(k for k, one in enumerate(found) if one["kind"] == "scan")
    reading = [sensor for control in hall.robots for sensor in control.sensors][number].reading(0)
    ranges, pose = arrays[f"scan{number}"], arrays[f"pose{number}"].astype(np.float64)
    angle = found[number]["first"] + found[number]["step"] * np.arange(found[number]["beams"])
    ends = pose[:3] + np.einsum(
        "ij,rj->ri", rotations(pose[3:]), np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    ) * (ranges[:, None] / 1000.0)
    points = reading.points()[0]
    seen = ranges < 65_535
    assert np.abs(ends[seen, : points.shape[1]] - points[seen]).max() < 2e-3


def test_description_is_json_of_everything_that_stands_still(hall):
    document = json.loads(json.dumps(scene_description(hall), allow_nan=False))
    assert [one["kind"] for one in document["stage"]["props"]] == ["cube", "table", "chair", "tree"]
    chair = document["stage"]["props"][2]
    assert (chair["seat"], chair["length"], chair["height"]) == (0.5, 0.44, 0.86)
    assert [wall["inner"] for wall in document["stage"]["walls"]].count(True) == 1
    assert document["stage"]["doors"][0]["width"] == pytest.approx(2.0)
    assert {zone["kind"] for zone in document["zones"]} == {"start", "goal"}
    people = document["people"]
    assert len(people["body"]) == len(people["colors"]) == 7
    assert people["rider"].count(True) == 1
    assert all(len(item) == 6 * len(document["regions"]) for item in people["colors"])
    low_x, low_y, high_x, high_y = document["bounds"]
    assert low_x <= -6 < 6 <= high_x
    assert low_y <= -4 < 4 <= high_y


def test_revision_changes_with_people_and_elements():
    simulation = run(parse_trial(HALL.replace("WORLD", "planar")), 2)
    first = int(sent(simulation).arrays["revision"][0])
    assert first == scene_description(simulation)["revision"]
    simulation.advance()
    assert int(sent(simulation).arrays["revision"][0]) == first
    AddPersonOrder(x=0.0, y=2.5, goal_x=3.0, goal_y=3.5).apply(simulation)
    second = int(sent(simulation).arrays["revision"][0])
    assert second != first
    AddElementOrder(xml='<cube x="0" y="3" fixed="true"/>', parent="stage").apply(simulation)
    assert int(sent(simulation).arrays["revision"][0]) not in (first, second)
    assert len(scene_description(simulation)["stage"]["props"]) == 5


def test_two_hundred_people_need_at_most_60_kb():
    trial = load_trial("challenge-against-200")
    simulation = run(trial, 1)
    data = scene_frame(simulation, ["scans"]).encode()
    assert len(StateFrame.decode(data).arrays["who"]) == 200
    assert len(data) <= 60_000


def test_refusals():
    trial = dataclasses.replace(load_trial("frontal"), robots=())
    with pytest.raises(InputError, match="make it with posed=True"):
        scene_frame(Simulation(trial))
    with pytest.raises(InputError, match="layer 'smell' of a scene does not exist; layers are scans, clouds"):
        scene_frame(Simulation(trial, posed=True), ["smell"])
    for path in ("bodies/3.bin", "bodies/-1.bin", "robots/nobody.bin", "../secret", "bodies/0.bin/x"):
        with pytest.raises(KeyError):
            scene_resource(Simulation(trial, posed=True), path, {})


def test_meshes_are_those_of_the_asset(hall):
    for level, mesh in enumerate(shapes().levels):
        arrays = StateFrame.decode(scene_resource(hall, f"bodies/{level}.bin", {}).data).arrays
        assert arrays["faces"].shape == mesh.faces.shape
        corners = arrays["source"][arrays["faces"]]
        assert np.array_equal(corners, mesh.faces)
        assert np.array_equal(arrays["region"][arrays["faces"][:, 0]], mesh.face_region)
        assert np.abs(arrays["rest"] * 1e-4 - mesh.rest.reshape(-1, 3)).max() <= 0.51e-4
        assert np.abs(arrays["weights"] / 65535.0 - mesh.weights[arrays["source"]]).max() < 1e-5
    robot = StateFrame.decode(scene_resource(hall, "robots/pepper.bin", {}).data).arrays
    assert len(robot["first"]) == len(scene_description(hall)["robots"][0]["links"])
    assert robot["faces"].max() == len(robot["vertices"]) - 1
    assert len(robot["color"]) == len(robot["faces"])


def test_a_scene_without_people_has_a_frame():
    simulation = Simulation(load_trial("empty-corridor"), 0)
    bodies = WalkingBodies(simulation)
    frame = StateFrame.decode(scene_frame(simulation, (), bodies.motion).encode())
    assert frame.arrays["bones"].shape == (0, 112)
    assert len(frame.arrays["bots"]) == 1


def test_bodies_beside_a_simulation_walk_as_its_own():
    own = run(load_trial("circle-crossing"), 0)
    beside = Simulation(load_trial("circle-crossing"), 0)
    beside.begin()
    bodies = WalkingBodies(beside)
    bodies.motion.people, bodies.motion.gait = own_bodies(own).people, own_bodies(own).gait
    bodies.motion.state = own_bodies(own).state
    for _ in range(12):
        own.advance()
        beside.advance()
        bodies.follow(beside)
    assert np.array_equal(sent(own).arrays["bones"], scene_frame(beside, (), bodies.motion).arrays["bones"])


def own_bodies(simulation):
    return worlds_of(simulation.world)[0].people
