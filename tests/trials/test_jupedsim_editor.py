"""Scenarios of the JuPedSim editor: areas, checkpoints, exits, flows and journeys; wrong and mutated files."""

from __future__ import annotations

import contextlib
import copy
import dataclasses
import json
import random

import pytest

from crowdbot.cli import main
from crowdbot.core import InputError, TrialError
from crowdbot.models import CollisionFreeSpeed, SocialForce
from crowdbot.recording import run
from crowdbot.trials import check_trial, import_trial

WKT = "POLYGON ((0 0, 20 0, 20 5, 0 5, 0 0), (9 2, 10 2, 10 3, 9 3, 9 2))"


def box(x, y, length, width, **more):
    corners = [[x, y], [x + length, y], [x + length, y + width], [x, y + width], [x, y]]
    return {"type": "polygon", "coordinates": corners, **more}


def people(number=10, **more):
    return {"number": number, "radius": 0.2, "v0": 1.2, "distribution_mode": "by_number", **more}


SCENE = {
    "config": {"simulation_settings": {"simulationParams": {"max_simulation_time": 60,
                                                            "model_type": "CollisionFreeSpeedModel"}}},
    "distributions": {"start": box(1, 1, 3, 3, parameters=people())},
    "checkpoints": {"desk": box(12, 1, 1, 1, waiting_time=0.0)},
    "exits": {"east": box(18, 0, 2, 5), "west": box(0, 4, 0.5, 1)},
    "journeys": [{"id": "j", "stages": ["start", "desk", "east"]}],
}  # fmt: skip


def changed(*changes):
    scene = copy.deepcopy(SCENE)
    for path, value in changes:
        *way, last = path.split("/")
        place = scene
        for key in way:
            place = place[key]
        place[last] = value
    return scene


def imported(folder, scene, wkt=WKT):
    if wkt:
        (folder / "geometry.wkt").write_text(wkt)
    (folder / "config.json").write_text(json.dumps(scene))
    done = import_trial(folder / "config.json")
    ((_, trial),) = done.trials
    check_trial(trial)
    return trial, done.left_out


def test_a_scenario_of_the_editor_runs(tmp_path):
    trial, notes = imported(tmp_path, SCENE)
    assert trial.stage.clearance([(5.0, 1.0), (9.5, 2.5), (30.0, 1.0)]).tolist() == [1.0, 0.0, 0.0]
    (start,), (way,) = trial.spawners, trial.journeys
    assert (start.count, str(start.speed), str(start.radius)) == (10, "1.2", "0.2")
    assert (way.then, [stop.points[0] for stop in way.stops]) == ("leave", [(12.0, 1.0), (18.0, 0.0)])
    assert (type(trial.crowd), trial.duration, trial.end.empty) == (CollisionFreeSpeed, 60.0, True)
    assert notes == ("robots are not in the file: people react to the robots that you add",)
    assert run(dataclasses.replace(trial, duration=5.0)).outcome == "finished"


def test_a_scenario_that_cannot_run_is_written_with_its_error_and_the_status_of_check(tmp_path, capsys):
    (tmp_path / "geometry.wkt").write_text(WKT)
    (tmp_path / "config.json").write_text(
        json.dumps(changed(("config/simulation_settings/simulationParams/max_simulation_time", 0.01)))
    )
    out = tmp_path / "full.xml"
    assert main(["new", "trial", str(out), "--import", str(tmp_path / "config.json")]) == 2
    assert "errors, mend them before a run:" in capsys.readouterr().out
    assert out.is_file()
    assert main(["check", str(out)]) == 2


WEIGHTS = (
    "distributions/start/journey_weights", [{"journey_id": "a", "weight": 70}, {"journey_id": "b", "weight": 30}],
)  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "groups", "flows", "sentence"),
    [
        ([("walkable_area_wkt", WKT), ("journeys", []), ("journeys_v2", [{"id": "j", "sequence": ["east"]}])],
         [10], [], "start has no journey: its people go to the nearest exit"),
        ([("journeys_v2", [{"id": "a", "sequence": ["east"]}, {"id": "b", "sequence": ["west"]}]), WEIGHTS],
         [7, 3], [], ""),
        ([("distributions/start/parameters", people(6, use_flow_spawning=True, flow_start_time=5, flow_end_time=15))],
         [], [(0.6, 5.0, 15.0, 6)], ""),
        ([("distributions/start/parameters", people(9, initial_number=2, flow_schedule=[
            {"start_time_s": 0, "end_time_s": 10, "sim_count": 5}, {"flow_start_time": 20, "flow_end_time": 22,
                                                                   "number": 4}]))],
         [2], [(0.5, 0.0, 10.0, 5), (2.0, 20.0, 22.0, 4)], ""),
        ([("checkpoints/desk/waiting_time_distribution", "gaussian")], [10], [], "desk: all people wait for the mean"),
        ([("zones", {"z": box(5, 0, 2, 5, speed_factor=0.5)})], [10], [], "the 1 zones are not imported"),
        ([("exits/east/enable_throughput_throttling", True), ("exits/east/max_throughput", 1.5)], [10], [],
         "east: its largest flow of 1.5 per s is not imported"),
        ([("distributions/start/parameters/use_premovement", True)], [10], [], "not imported are use_premovement"),
        ([("distributions/start/parameters/distribution_mode", "until_full")], [10], [], "the mode 'until_full'"),
        ([("exits/east", box(18, -1, 4, 7))], [10], [], "a goal zone around 20,2.5 reaches into a solid, and is cut"),
        ([("distributions/start", box(-1, 1, 4, 3, parameters=people()))], [10], [], "outside the walkable area"),
        ([("journeys", [{"id": "j", "stages": ["start", "gate", "east"]}])], [10], [], "no checkpoint or exit 'gate'"),
        ([("extra", {"a": 1})], [10], [], "extra is not imported"),
    ],
)  # fmt: skip
def test_variants_of_the_editor(tmp_path, changes, groups, flows, sentence):
    trial, notes = imported(tmp_path, changed(*changes))
    assert [group.count for group in trial.spawners] == groups
    assert [(flow.rate, flow.begin, flow.end, flow.max_count) for flow in trial.sources] == flows
    assert sentence in " ".join(notes)


def test_people_wait_at_the_checkpoints_of_the_editor(tmp_path):
    trial, _ = imported(tmp_path, changed(("checkpoints/desk/waiting_time", 5.0)))
    assert [stop.wait for stop in trial.journeys[0].stops] == [5.0, 0.0]


def test_models_and_distributions_of_the_editor(tmp_path):
    way = "config/simulation_settings/simulationParams/model_type"
    drawn = people(v0_std=0.1, v0_distribution="gaussian", radius_std=0.01, radius_distribution="gaussian")
    trial, _ = imported(tmp_path, changed((way, "SocialForceModel"), ("distributions/start/parameters", drawn)))
    assert isinstance(trial.crowd, SocialForce)
    assert [str(trial.spawners[0].speed), str(trial.spawners[0].radius)] == [
        "normal(1.2, 0.1, 0.9, 1.5)", "normal(0.2, 0.01, 0.17, 0.23)",
    ]  # fmt: skip
    _, notes = imported(tmp_path, changed((way, "AnticipationVelocityModel")))
    assert "the model 'AnticipationVelocityModel': the collision-free speed model replaces it" in notes


@pytest.mark.parametrize(
    ("changes", "wkt", "words"),
    [
        ([], "", "its walkable area is missing: put its geometry.wkt beside it"),
        ([], "POLYGON ((0 0, 1", "WKT"),
        ([("walkable_area_wkt", "hall")], "", "hall"),
        ([("distributions", [1])], WKT, "distributions must be an object"),
        ([("exits/east", [1])], WKT, "east of exits must be an object with coordinates"),
        (
            [("exits/east/coordinates", [[0, 0], [1, 1]])],
            WKT,
            "east: coordinates must have at least 3 different points",
        ),
        ([("exits/east/coordinates", 7)], WKT, r"east: coordinates must be a list of points \[x, y\]"),
        ([("distributions/start/parameters/number", "many")], WKT, "start: number must be a number up to 1e6"),
        ([("distributions/start/parameters/number", 1e6)], WKT, "more than 20000 people are too many"),
        (
            [("journeys", [{"id": "j", "stages": 3}])],
            WKT,
            "journey 1 of journeys must be an object with the list stages",
        ),
    ],
)
def test_wrong_scenarios_of_the_editor(tmp_path, changes, wkt, words):
    with pytest.raises(TrialError, match=f"config.json.*{words}"):
        imported(tmp_path, changed(*changes), wkt)


ODD = [None, [], {}, -1, 0, 1e308, "", "a", True, [[0, 0]], [1], {"a": 1}, "POLYGON EMPTY", 10**400]


def test_mutated_scenarios_are_read_or_refused(tmp_path):
    rng = random.Random(4)

    def paths(value, way=()):
        rows = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
        for key, inner in rows:
            yield (*way, key)
            yield from paths(inner, (*way, key))

    places, read = list(paths(SCENE)), 0
    (tmp_path / "geometry.wkt").write_text(WKT)
    for _ in range(60):
        scene = copy.deepcopy(SCENE)
        *way, last = rng.choice(places)
        place = scene
        for key in way:
            place = place[key]
        place[last] = rng.choice(ODD)
        (tmp_path / "config.json").write_text(json.dumps(scene))
        with contextlib.suppress(InputError):
            import_trial(tmp_path / "config.json")
            read += 1
    assert 5 < read < 60
