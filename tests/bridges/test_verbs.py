"""The verbs of simulation_interfaces: entities, spawning, steps, reset and worlds; everything replays."""

import runpy
from pathlib import Path

import pytest
from bridge_runs import MemoryTransport, Running

from crowdbot.bridges import SERVICES, RobotInterface, interface_store, message_of, request_kind, response_kind
from crowdbot.bridges import simulation_interfaces as si
from crowdbot.bridges.simulation_interfaces import (
    RESULT_INCORRECT_STATE,
    RESULT_NOT_FOUND,
    RESULT_OK,
    RESULT_OPERATION_FAILED,
)
from crowdbot.bridges.simulation_services import Verbs
from crowdbot.core import InputError
from crowdbot.recording import read_episode, replay
from crowdbot.trials import load_trial

TOOL = Path(__file__).parents[2] / "tools/simulation_interfaces.py"


@pytest.fixture(scope="module")
def trial():
    return load_trial("frontal", duration=4.0)


def code(response):
    return response["result"]["result"]


def pose(x, y, frame="map"):
    return {"header": {"frame_id": frame}, "pose": {"position": {"x": x, "y": y}, "orientation": {"w": 1.0}}}


def test_every_service_is_a_verb_and_its_response_has_the_type_of_the_standard(trial):
    transport = MemoryTransport()
    names = [service.name for service in RobotInterface.of(trial).services]
    assert names == [f"/crowdbot/{name}" for name in SERVICES]
    assert all(callable(getattr(Verbs, name)) for name in SERVICES)
    requests = {
        "get_entity_state": {"entity": "robot"},
        "get_entity_info": {"entity": "person_0"},
        "set_entity_state": {"entity": "robot", "state": pose(-4.0, 0.2)},
        "spawn_entity": {"entity_resource": {"uri": "person"}, "initial_pose": pose(0.0, 1.0)},
        "spawn_entities": {"spawn_requests": []},
        "delete_entity": {"entity": "person_0"},
        "load_world": {"world_resource": {"uri": "nothing"}},
        "reset_simulation": {"scope": 4},
        "set_simulation_state": {"state": {"state": 2}},
    }
    with Running(trial, [transport], "step"):
        for name, service in SERVICES.items():
            message_of(requests.get(name, {}), request_kind(service))
            response = transport.call(name, requests.get(name))
            message_of(response, response_kind(service))
            assert (
                name == "load_world"
                or name == "set_simulation_state"
                or response.get("features")
                or code(response) == RESULT_OK
            )


def test_people_robots_and_props_are_added_moved_and_removed(tmp_path):
    trial = load_trial("frontal", duration=4.0, bodies="limbs")
    transport = MemoryTransport()
    with Running(trial, [transport], "step", out=tmp_path) as running:

        def step(steps=1):
            assert code(transport.call("step_simulation", {"steps": steps})) == RESULT_OK

        step(3)
        first = transport.call("spawn_entity", {"entity_resource": {"uri": "person"}, "initial_pose": pose(0.0, 1.0)})
        second = transport.call(
            "spawn_entity",
            {"uri": "person?goal_x=3&goal_y=-1&speed=1.0", "initial_pose": pose(-2.0, -1.0)},
        )
        assert (first["entity_name"], second["entity_name"]) == ("person_2", "person_3")
        bot = transport.call(
            "spawn_entity",
            {"name": "bot", "entity_resource": {"uri": "robot/turtlebot2"}, "initial_pose": pose(2.0, -0.8)},
        )
        assert bot["entity_name"] == "bot"
        assert code(transport.call("spawn_entity", {"uri": "cube", "initial_pose": pose(6.0, 1.0)})) == RESULT_OK
        step()
        names = transport.call("get_entities")["entities"]
        assert {*names} == {"robot", "bot", "person_0", "person_2", "person_3"}
        assert transport.call("get_entities", {"filters": {"filter": "^person_[23]$"}})["entities"] == [
            "person_2",
            "person_3",
        ]
        kinds = [{"filters": {"categories": [{"category": number}]}} for number in range(6)]
        people = [name for name in names if name.startswith("person")]
        found = [sorted(transport.call("get_entities", kind)["entities"]) for kind in kinds]
        assert found == [[], ["bot", "robot"], sorted(people), [], [], []]
        info = [transport.call("get_entity_info", {"entity": name})["info"] for name in ("bot", "person_2")]
        assert [row["category"]["category"] for row in info] == [1, 2]
        near = {"type": 3, "points": [{"x": 2.0, "y": -0.8}, {"x": 0.5}]}
        assert transport.call("get_entities", {"filters": {"bounds": near}})["entities"] == ["bot"]
        box = {"type": 1, "points": [{"x": 2.5, "y": -0.5}, {"x": 1.5, "y": -3.0}]}
        assert transport.call("get_entities", {"filters": {"bounds": box}})["entities"] == ["bot"]
        assert "/bot/cmd_vel" in {input_topic.name for input_topic in transport.interfaces[-1].inputs}
        transport.inbox.receive("/bot/cmd_vel", {"linear": {"x": 0.3}}, "test")
        assert code(transport.call("set_entity_state", {"entity": "person_2", "state": pose(1.0, 1.2)})) == RESULT_OK
        step(4)
        state = transport.call("get_entity_state", {"entity": "bot"})["state"]
        assert state["twist"]["linear"]["x"] > 0.1
        assert transport.call("get_entity_state", {"entity": "person_2"})["state"]["pose"]["position"]["y"] > 0.9
        assert code(transport.call("delete_entity", {"entity": "person_3"})) == RESULT_OK
        assert code(transport.call("delete_entity", {"entity": "bot"})) == RESULT_OK
        step()
        assert {*transport.call("get_entities")["entities"]} == {"robot", "person_0", "person_2"}
        assert code(transport.call("reset_simulation", {"scope": 4})) == RESULT_OK
        step(20)
        assert {*transport.call("get_entities")["entities"]} == {"robot", "person_0"}
        transport.call("set_simulation_state", {"state": {"state": 3}})
        done = running.end()
    assert done.outcome == "interrupted"
    assert replay(done.path).equal


def test_a_robot_rests_where_it_is_or_is_moved_as_the_flags_say(trial):
    transport = MemoryTransport()
    with Running(trial, [transport], "step"):
        transport.inbox.receive("/robot/cmd_vel", {"linear": {"x": 0.5}}, "test")
        assert code(transport.call("step_simulation", {"steps": 8})) == RESULT_OK
        before = transport.call("get_entity_state", {"entity": "robot"})["state"]
        assert before["twist"]["linear"]["x"] > 0.1
        request = {"entity": "robot", "state": pose(9.0, 9.0), "set_twist": True, "set_pose": False}
        assert code(transport.call("set_entity_state", request)) == RESULT_OK
        transport.inbox.receive("/robot/cmd_vel", {"linear": {}}, "test")
        assert code(transport.call("step_simulation", {"steps": 1})) == RESULT_OK
        after = transport.call("get_entity_state", {"entity": "robot"})["state"]
        assert after["twist"]["linear"]["x"] == pytest.approx(0.0, abs=1e-9)
        assert after["pose"]["position"]["x"] == pytest.approx(before["pose"]["position"]["x"], abs=1e-6)


def test_a_robot_of_a_text_has_the_name_of_the_text_and_a_reset_of_scope_4_removes_it():
    transport, trial = MemoryTransport(), load_trial("frontal", duration=4.0, bodies="limbs")
    text = '<robot name="mine" type="turtlebot2" x="3" y="2"><goal x="9" y="2"/><navigator type="external"/></robot>'
    with Running(trial, [transport], "step"):
        answer = transport.call("spawn_entity", {"entity_resource": {"resource_string": text}})
        assert (code(answer), answer["entity_name"]) == (RESULT_OK, "mine")
        transport.call("step_simulation", {"steps": 1})
        assert "mine" in transport.call("get_entities")["entities"]
        assert code(transport.call("reset_simulation", {"scope": 4})) == RESULT_OK
        transport.call("step_simulation", {"steps": 1})
        assert "mine" not in transport.call("get_entities")["entities"]


STANDARD = {
    "msg/Spawnable": ["entity_resource", "description", "spawn_bounds"],
    "msg/SpawnEntity": ["name", "allow_renaming", "entity_resource", "entity_namespace", "initial_pose"],
    "msg/SpawnResult": ["result", "entity_name"],
    "msg/WorldResource": ["name", "world_resource", "description", "tags"],
    "msg/SimulatorFeatures": ["features", "spawn_formats", "custom_info"],
    "msg/EntityState": ["header", "pose", "twist", "acceleration"],
    "msg/EntityFilters": ["filter", "categories", "tags", "bounds"],
    "msg/SpawnEntities_Request": ["spawn_requests"],
    "msg/SpawnEntities_Response": ["result", "results"],
    "msg/SetEntityState_Request": ["entity", "state", "set_pose", "set_twist", "set_acceleration"],
    "msg/LoadWorld_Request": ["world_resource", "fail_on_unsupported_element", "ignore_missing_or_unsupported_assets"],
    "msg/GetAvailableWorlds_Request": ["additional_sources", "filter", "offline_only", "continue_on_error"],
    "msg/GetSpawnables_Response": ["result", "spawnables"],
}
"""Fields of version 2.1.0, from docs.ros.org/en/rolling/p/simulation_interfaces."""


def test_the_fields_are_those_of_version_2_1_0_of_the_standard(trial):
    store = interface_store()
    found = {kind: [name for name, _ in store.fielddefs[f"simulation_interfaces/{kind}"][1]] for kind in STANDARD}
    assert found == STANDARD
    part = dict(store.fielddefs["simulation_interfaces/msg/SpawnEntities_Request"][1])["spawn_requests"]
    assert "simulation_interfaces/msg/SpawnEntity" in str(part)
    with Running(trial, [transport := MemoryTransport()], "step"):
        features = transport.call("get_simulator_features")["features"]["features"]
        rows = transport.call("get_spawnables")["spawnables"]
        time, state = (transport.call("reset_simulation", {"scope": scope}) for scope in (1, 2))
    assert not {21, 22} & set(features), "time and state have no reset of their own"
    assert code(time) == code(state) == 0
    assert {40, 44, 45, 50} <= set(features), "worlds, available worlds and several entities at once"
    assert {"person", "robot/pepper"} <= {row["entity_resource"]["uri"] for row in rows}


def test_the_numbers_are_those_of_version_2_1_0_of_the_standard():
    """Results, categories, bounds, scopes and states, from the pages of the package."""
    codes = (
        si.RESULT_FEATURE_UNSUPPORTED,
        RESULT_OK,
        RESULT_NOT_FOUND,
        RESULT_INCORRECT_STATE,
        RESULT_OPERATION_FAILED,
    )
    assert codes == (0, 1, 2, 3, 4)
    assert (si.CATEGORY_ROBOT, si.CATEGORY_HUMAN, si.TYPE_BOX, si.TYPE_SPHERE) == (1, 2, 1, 3)
    assert (si.NAME_NOT_UNIQUE, si.NAME_INVALID, si.SPAWN_ENTITY_NO_RESOURCE) == (101, 102, 104)
    spawning = (si.NAMESPACE_INVALID, si.SPAWN_ENTITY_RESOURCE_PARSE_ERROR, si.SPAWN_ENTITY_INVALID_POSE)
    assert spawning == (105, 106, 109)
    assert (si.LOAD_WORLD_NO_RESOURCE, si.LOAD_WORLD_RESOURCE_PARSE_ERROR) == (102, 103)
    assert (si.SCOPE_TIME, si.SCOPE_STATE, si.SCOPE_SPAWNED, si.SCOPE_ALL) == (1, 2, 4, 255)
    assert (si.SET_ENTITY_STATE_INVALID_POSE, si.ENTITIES_SPAWN_FAILED, si.ALREADY_IN_TARGET_STATE) == (101, 150, 101)
    assert (si.STATE_STOPPED, si.STATE_PLAYING, si.STATE_PAUSED, si.STATE_QUITTING) == (0, 1, 2, 3)


def test_the_types_are_written_from_the_files_of_the_package(tmp_path, monkeypatch, capsys):
    (tmp_path / "msg").mkdir()
    (tmp_path / "srv").mkdir()
    (tmp_path / "package.xml").write_text("<package><version>9.8.7</version></package>")
    (tmp_path / "msg/Lamp.msg").write_text("# A lamp.\nuint8 LAMP_OFF   = 0  # dark\nuint8 INVALID = 7\n\nuint8 lamp\n")
    (tmp_path / "srv/SetLamp.srv").write_text(
        "Lamp lamp\nuint64 steps 1 # how often\n---\nuint8 INVALID = 101\nbool done\n"
    )
    (tmp_path / "srv/GetTime.srv").write_text("---\nfloat64 time\n")
    out = tmp_path / "types.py"
    main = runpy.run_path(str(TOOL))["main"]
    monkeypatch.setattr("sys.argv", [str(TOOL), str(tmp_path), "--out", str(out)])
    assert main() == 0
    module = runpy.run_path(str(out))
    assert "simulation_interfaces`` 9.8.7" in module["__doc__"]
    assert module["MESSAGE_TYPES"] == {"Lamp": "uint8 LAMP_OFF = 0\nuint8 INVALID = 7\nuint8 lamp\n"}
    assert module["SERVICE_TYPES"]["SetLamp"] == "Lamp lamp\nuint64 steps 1\n---\nuint8 INVALID = 101\nbool done\n"
    assert module["SERVICE_TYPES"]["GetTime"].partition("---\n")[::2] == ("", "float64 time\n")
    assert (module["LAMP_OFF"], module["LAMP_INVALID"], module["SET_LAMP_INVALID"]) == (0, 7, 101)
    monkeypatch.setattr("sys.argv", [str(TOOL), str(tmp_path), "--out", str(out), "--check"])
    assert main() == 0
    (tmp_path / "srv/GetTime.srv").write_text("---\nfloat32 time\n")
    assert main() == 1
    assert "differs from the files" in capsys.readouterr().err


def test_a_reset_begins_the_same_run_again_in_another_file(trial, tmp_path):
    transport = MemoryTransport()
    with Running(trial, [transport], "step", out=tmp_path) as running:
        for _ in range(2):
            assert code(transport.call("step_simulation", {"steps": 20})) == RESULT_OK
            assert code(transport.call("reset_simulation", {"scope": 255})) == RESULT_OK
        assert transport.call("get_simulation_state")["state"]["state"] == 2
        transport.call("step_simulation", {"steps": 20})
        transport.call("set_simulation_state", {"state": {"state": 3}})
        running.end()
    files = [tmp_path / name for name in ("episode.mcap", "episode-2.mcap", "episode-3.mcap")]
    assert len({read_episode(path).digest for path in files}) == 1
    assert len({path.read_bytes() for path in files}) == 1
    times = [item.nanoseconds for item in transport.sent if item.topic == "/clock"]
    assert times.count(0) == 3


def test_another_world_is_loaded_stopped_and_its_topics_are_announced(trial):
    transport = MemoryTransport()
    with Running(trial, [transport], "free") as running:
        transport.call("set_simulation_state", {"state": {"state": 2}})
        assert code(transport.call("load_world", {"world_resource": {"uri": "circle-crossing"}})) == RESULT_OK
        assert transport.call("get_simulation_state")["state"]["state"] == 0
        assert transport.call("get_current_world")["world"]["name"] == "circle-crossing"
        text = transport.call("get_current_world")["world"]["world_resource"]["resource_string"]
        assert code(transport.call("load_world", {"world_resource": {"resource_string": text}})) == RESULT_OK
        assert len(transport.call("get_entities")["entities"]) > 3
        assert running.run.trial.name == "circle-crossing"


MOVING = {**pose(0, 0), "twist": {"linear": {"x": 0.5}}}
IMPOSSIBLE = [
    ("get_entity_state", {"entity": "robt"}, RESULT_NOT_FOUND, "did you mean 'robot'"),
    ("get_entity_state", {}, RESULT_NOT_FOUND, "there is no entity"),
    ("delete_entity", {"entity": ["robot"]}, RESULT_OPERATION_FAILED, "unhashable"),
    ("step_simulation", {"steps": -1}, RESULT_OPERATION_FAILED, "steps = -1"),
    ("step_simulation", {"steps": 1e300}, RESULT_OPERATION_FAILED, "steps = 1e"),
    ("set_simulation_state", {}, RESULT_NOT_FOUND, "state"),
    ("set_simulation_state", {"state": {"state": 9}}, RESULT_OPERATION_FAILED, "there is no state 9"),
    ("reset_simulation", {"scope": 1}, 0, "use scope 0, 4 or 255"),
    ("get_entities", {"filters": {"filter": "(a+)+$"}}, RESULT_OPERATION_FAILED, "single characters"),
    ("get_entities", {"filters": {"filter": "a" * 300}}, RESULT_OPERATION_FAILED, "at most 200"),
    ("get_entities", {"filters": {"filter": "["}}, RESULT_OPERATION_FAILED, "no regular expression"),
    ("get_entities", {"filters": {"tags": {"tags": ["x"]}}}, 0, "no tags"),
    ("get_entities", {"filters": {"bounds": {"type": 2, "points": [1, 2]}}}, 0, "must be a box (1) or a sphere (3)"),
    ("set_entity_state", {"entity": "robot", "state": pose(0, 0, "odom")}, 0, "frame map"),
    ("set_entity_state", {"entity": "robot", "state": pose(float("inf"), 0)}, 101, "must be a finite"),
    (
        "set_entity_state",
        {"entity": "robot", "state": pose(0, 0), "set_pose": False},
        RESULT_OPERATION_FAILED,
        "nothing is set",
    ),
    ("set_entity_state", {"entity": "robot", "state": MOVING, "set_twist": True}, 0, "to no other velocity"),
    ("spawn_entity", {}, 104, "give a uri"),
    ("spawn_entity", {"uri": "cat"}, RESULT_NOT_FOUND, "get_spawnables lists"),
    ("spawn_entity", {"uri": "person", "name": "bob"}, 102, "leave the name empty, or allow renaming"),
    ("spawn_entity", {"uri": "person", "entity_namespace": "/hall"}, 105, "under its name"),
    ("spawn_entity", {"uri": "person", "initial_pose": pose(0, 0, "odom")}, 109, "frame map"),
    ("spawn_entities", {"spawn_requests": [{"uri": "cat"}]}, 150, "not all were added"),
    ("spawn_entity", {"uri": "person?speed=fast"}, RESULT_OPERATION_FAILED, "must be a number"),
    ("spawn_entity", {"uri": "person?colour=1"}, RESULT_OPERATION_FAILED, "it has goal_x"),
    ("spawn_entity", {"uri": "robot/pepper"}, RESULT_OPERATION_FAILED, "trials with bodies"),
    ("spawn_entity", {"uri": "robot/pepper", "name": "robot"}, 101, "there is an entity 'robot'"),
    ("spawn_entity", {"resource_string": "<robot"}, 106, "add-element"),
    ("load_world", {}, 102, "give a uri"),
    (
        "load_world",
        {"world_resource": {"uri": "../../etc/passwd"}},
        RESULT_OPERATION_FAILED,
        "neither a built-in trial",
    ),
    ("load_world", {"world_resource": {"resource_string": "<trial"}}, 103, "load_world"),
]


def test_impossible_requests_are_answered_with_a_reason(trial):
    transport = MemoryTransport()
    with Running(trial, [transport], "step"):
        for service, request, result, message in IMPOSSIBLE:
            answer = transport.call(service, request)
            assert code(answer) == result, (service, request, answer)
            assert message in answer["result"]["error_message"]
        assert code(transport.call("step_simulation", {"steps": 1})) == RESULT_OK


def test_steps_need_a_paused_simulation(trial):
    transport = MemoryTransport()
    with Running(trial, [transport], "paced"):
        assert code(transport.call("step_simulation", {"steps": 1})) == RESULT_INCORRECT_STATE
        assert code(transport.call("set_simulation_state", {"state": {"state": 1}})) == 101
        assert code(transport.call("set_simulation_state", {"state": {"state": 2}})) == RESULT_OK
        sent = len(transport.sent)
        assert code(transport.call("step_simulation", {"steps": 2})) == RESULT_OK
        assert [item.topic for item in transport.sent[sent:]].count("/clock") == 2


def test_steps_beyond_the_end_are_answered(trial):
    transport = MemoryTransport()
    with Running(trial, [transport], "step") as running:
        assert (
            "ended before the last step" in transport.call("step_simulation", {"steps": 500})["result"]["error_message"]
        )
        assert running.end().outcome == "timeout"


def test_a_restart_that_cannot_be_recorded_is_answered(trial, tmp_path):
    (tmp_path / "episode-2.mcap").write_bytes(b"mine")
    transport = MemoryTransport()
    running = Running(trial, [transport], "step", out=tmp_path)
    running.thread.start()
    running._started.wait(60.0)
    assert "the run has ended" in transport.call("reset_simulation")["result"]["error_message"]
    with pytest.raises(InputError, match=r"episode-2\.mcap"):
        running.end()
    assert (tmp_path / "episode-2.mcap").read_bytes() == b"mine"
    assert transport.stopped == 1
    with pytest.raises(InputError, match="the run has ended"):
        transport.call("get_entities")
