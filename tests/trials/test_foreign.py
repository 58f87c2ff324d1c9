"""Trials from files of Vadere, UMANS and pedsim: what is read, that it runs, and wrong files."""

import copy
import dataclasses
import json

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import TrialError
from crowdbot.models import ORCA, CollisionFreeSpeed, PowerLaw, SocialForce
from crowdbot.recording import run
from crowdbot.trials import Crowds, check_trial, import_pedsim, import_trial, import_umans, import_vadere, load_trial


def rectangle(x, y, width, height):
    return {"type": "RECTANGLE", "x": x, "y": y, "width": width, "height": height}


def spawner(count, start, end, every=1.0, most=-1):
    return {
        "constraintsElementsMax": most, "constraintsTimeStart": start, "constraintsTimeEnd": end,
        "eventElementCount": count, "distribution": {"updateFrequency": every},
    }  # fmt: skip


VADERE = {
    "name": "two rooms",
    "scenario": {
        "mainModel": "org.vadere.simulator.models.osm.OptimalStepsModel",
        "attributesSimulation": {"finishTime": 40.0},
        "topography": {
            "attributes": {"bounds": {"x": 0.0, "y": 0.0, "width": 12.0, "height": 6.0}, "boundingBoxWidth": 0.5,
                           "bounded": True},
            "obstacles": [
                {"shape": rectangle(5.5, 0.5, 0.5, 1.9)},
                {"shape": {"type": "POLYGON", "points": [{"x": 5.5, "y": 3.6}, {"x": 6.0, "y": 3.6},
                                                         {"x": 6.0, "y": 5.5}, {"x": 5.5, "y": 5.5}]}},
            ],
            "targets": [
                {"id": 1, "shape": rectangle(10.0, 2.0, 1.0, 2.0), "absorber": {"enabled": True}},
                {"id": 2, "shape": {"type": "CIRCLE", "center": {"x": 8.0, "y": 3.0}, "radius": 0.6}},
            ],
            "sources": [
                {"shape": rectangle(1.0, 1.0, 3.0, 4.0), "targetIds": [1], "spawner": spawner(8, 0.0, 0.0)},
                {"shape": rectangle(1.0, 1.0, 2.0, 2.0), "targetIds": [2, 1],
                 "spawner": spawner(1, 2.0, 20.0, 4.0, 3)},
            ],
            "dynamicElements": [
                {"position": {"x": 4.5, "y": 3.0}, "targetIds": [1], "freeFlowSpeed": 1.1,
                 "attributes": {"radius": 0.25}},
            ],
            "stairs": [{"id": 9}],
            "attributesPedestrian": {"radius": 0.2, "speedDistributionMean": 1.3, "speedDistributionStandardDeviation":
                                     0.2, "minimumSpeed": 0.6, "maximumSpeed": 2.0},
        },
    },
}  # fmt: skip


def write(folder, value):
    file = folder / "two.scenario"
    file.write_text(value if isinstance(value, str) else json.dumps(value))
    return file


def test_vadere_becomes_a_trial_that_runs(tmp_path):
    done = import_vadere(write(tmp_path, VADERE))
    ((name, trial),) = done.trials
    check_trial(trial)
    assert (name, trial.name, trial.duration) == ("two", "two rooms", 40.0)
    assert [tuple(point) for point in trial.stage.walkable] == [(0.5, 0.5), (11.5, 0.5), (11.5, 5.5), (0.5, 5.5)]
    assert len(trial.stage.obstacles) == 2
    assert isinstance(trial.crowd, CollisionFreeSpeed)
    first, second = trial.spawners[0], trial.sources[0]
    assert (first.count, str(first.speed), str(first.radius)) == (8, "normal(1.3, 0.2, 0.6, 2)", "0.2")
    assert (second.rate, second.begin, second.end, second.max_count) == (0.25, 2.0, 20.0, 3)
    assert [(len(way.stops), way.then) for way in trial.journeys] == [(1, "leave"), (2, "leave")]
    assert (trial.agents[0].speed, trial.agents[0].radius) == (1.1, 0.25)
    assert done.left_out == (
        "stairs of the topography are not imported",
        "the model OptimalStepsModel: collision-free speed with its defaults replaces it",
    )
    episode = run(trial)
    assert episode.outcome == "finished"
    tracks = episode.tracks(0.4)
    assert len(tracks.ids) == 12
    last = {int(id): tracks.x[tracks.id == id][-1] for id in tracks.ids}
    assert min(last.values()) > 9.0  # all have passed the door and reach the target


CONSTANT = {"type": "org.vadere.state.attributes.distributions.AttributesConstantDistribution", "updateFrequency": 12.0}


@pytest.mark.parametrize(
    ("target", "wait", "sentence"),
    [
        ({"waiter": {"enabled": True, "distribution": CONSTANT}}, 12.0, ""),
        ({"waiter": {"enabled": False, "distribution": CONSTANT}}, 0.0, ""),
        ({"waiter": {"enabled": True, "distribution": {"type": "AttributesPoissonDistribution"}}}, 0.0, "is drawn"),
        ({"waitingTime": 4.0}, 4.0, ""),
        ({"waitingTime": 4.0, "waitingTimeYellowPhase": 2.0}, 0.0, "target 2: people do not wait, since they wait tog"),
    ],
)
def test_people_wait_at_the_targets_of_vadere(tmp_path, target, wait, sentence):
    value = copy.deepcopy(VADERE)
    value["scenario"]["topography"]["targets"][1].update(target)
    done = import_vadere(write(tmp_path, value))
    assert [stop.wait for stop in done.trials[0][1].journeys[1].stops] == [wait, 0.0]
    assert sentence in " ".join(done.left_out)


def test_old_sources_of_vadere_are_read(tmp_path):
    value = copy.deepcopy(VADERE)
    source = {"shape": rectangle(1.0, 1.0, 2.0, 2.0), "targetIds": [1], "spawnNumber": 2, "startTime": 0.0,
              "endTime": 10.0, "maxSpawnNumberTotal": 6, "distributionParameters": [2.5]}  # fmt: skip
    value["scenario"]["topography"]["sources"] = [source]
    trial = import_vadere(write(tmp_path, value)).trials[0][1]
    assert (trial.sources[0].rate, trial.sources[0].max_count) == (0.8, 6)


def _broken(part, key, wrong):
    value = copy.deepcopy(VADERE)
    target = value["scenario"]["topography"]
    for step in part:
        target = target[step]
    target[key] = wrong
    return value


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("{", "is not JSON"),
        ("{}", "not a scenario of Vadere: it lacks scenario and topography"),
        (_broken(["sources", 0], "targetIds", [7]), "there is no target 7"),
        (_broken(["sources", 0, "shape"], "type", "BLOB"), "a shape must be a RECTANGLE, a POLYGON or a CIRCLE"),
        (_broken(["sources", 0, "shape"], "x", "a"), "x must be a finite number, not 'a'"),
        (_broken(["sources", 0, "shape"], "x", float("nan")), "x must be a finite number, not 'nan'"),
        (_broken(["obstacles", 1, "shape"], "points", [{"x": 1}]), "needs at least three points"),
        (_broken(["attributes"], "boundingBoxWidth", 7.0), "nothing is left inside the bounds"),
        (_broken([], "targets", {}), None),
        (_broken([], "targets", [3]), "targets of the topography must be a list of objects"),
        (_broken(["dynamicElements", 0], "position", None), "person 1 of dynamicElements has no position"),
    ],
)
def test_wrong_scenarios_of_vadere_are_refused(tmp_path, value, message):
    with pytest.raises(TrialError, match=message or "there is no target 1"):
        import_vadere(write(tmp_path, value))


UMANS = """<Simulation delta_time="0.1" end_time="15">
  <World type="Infinite"><Obstacles file="../walls.xml"/></World>
  <Policies>
    <Policy id="0"><costfunction name="ORCA" range="5"/></Policy>
    <Policy id="1"><costfunction name="PowerLaw"/><costfunction name="GoalReachingForce"/></Policy>
  </Policies>
  <Agents>
    <Agent rad="0.3" pref_speed="1.2" remove_at_goal="true">
      <pos x="0" y="0"/><goal x="8" y="0"/><Policy id="0"/>
    </Agent>
    <Agent><pos x="0" y="3"/><goal x="8" y="3"/><Policy id="1"/></Agent>
  </Agents>
  <SPH max_density="6"/>
</Simulation>"""
WALLS = '<Obstacles><Obstacle><Point x="2" y="1.2"/><Point x="3" y="1.2"/><Point x="3" y="1.8"/></Obstacle></Obstacles>'


@pytest.fixture
def umans(tmp_path):
    (tmp_path / "custom").mkdir()
    (tmp_path / "walls.xml").write_text(WALLS)
    file = tmp_path / "custom" / "cross.xml"
    file.write_text(UMANS)
    return file


def test_umans_becomes_a_trial_that_runs(umans):
    done = import_umans(umans)
    trial = done.trials[0][1]
    check_trial(trial)
    assert (trial.step, trial.duration, len(trial.stage.obstacles)) == (0.1, 15.0, 1)
    assert isinstance(trial.crowd, Crowds)
    assert [type(model) for model in trial.crowd.models] == [ORCA, PowerLaw]
    one, two = trial.agents
    assert (one.radius, one.speed, one.arrival, one.crowd) == (0.3, 1.2, "leave", "orca")
    assert (two.radius, two.speed, two.arrival, two.crowd) == (0.24, 1.3, "stay", "powerlaw")
    assert done.left_out == ("<SPH> is not imported", "parameters of the policies: the models have their defaults")
    tracks = run(trial).tracks(0.2)
    assert tracks.x[tracks.id == 1][-1] == pytest.approx(8.0, abs=0.4)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('<pos x="0" y="0"/>', "", "<Agent> lacks <pos>"),
        ('x="0" y="0"', 'x="0"', "<pos> lacks y"),
        ('rad="0.3"', 'rad="wide"', "rad='wide'"),
        ('x="8" y="0"', 'x="8e9" y="0"', "is more than 1e6"),
        ("../walls.xml", "../nothing.xml", "nothing.xml"),
    ],
)
def test_wrong_scenarios_of_umans_are_refused(umans, old, new, message):
    umans.write_text(UMANS.replace(old, new, 1))
    with pytest.raises(TrialError, match=message):
        import_umans(umans)


PEDSIM = """<scenario>
  <obstacle x1="-5" y1="3" x2="15" y2="3"/><obstacle x1="-5" y1="-3" x2="15" y2="-3"/>
  <waypoint id="left" x="0" y="0" r="1"/><waypoint id="right" x="10" y="0" r="1.5"/>
  <agent x="0" y="0" n="5" dx="4" dy="4" type="0"><addwaypoint id="right"/><addwaypoint id="left"/></agent>
  <agent x="10" y="0" n="1" dx="0" dy="0" type="0"><addwaypoint id="left"/><addwaypoint id="right"/></agent>
  <agent x="5" y="2" n="1" dx="0" dy="0" type="2"><addwaypoint id="right"/></agent>
  <attraction id="shop" x="1" y="1"/>
</scenario>"""


def test_pedsim_becomes_a_trial_that_runs(tmp_path):
    file = tmp_path / "hall.xml"
    file.write_text(PEDSIM)
    done = import_pedsim(file)
    trial = done.trials[0][1]
    check_trial(trial)
    assert isinstance(trial.crowd, SocialForce)
    assert (len(trial.stage.walls), trial.spawners[0].count, trial.agents[0].x) == (2, 5, 10.0)
    assert [(way.then, [stop.x for stop in way.stops]) for way in trial.journeys] == [
        ("again", [10.0, 0.0]), ("again", [0.0, 10.0]),
    ]  # fmt: skip
    assert (trial.robots[0].name, trial.robots[0].goal.x) == ("robot", 10.0)
    assert "<attraction> is not imported" in done.left_out
    tracks = run(trial).tracks(0.4)
    people = ~np.isin(tracks.id, list(tracks.robots))
    assert np.ptp(tracks.x[people]) > 4.0
    file.write_text(PEDSIM.replace('id="right" x', 'id="east" x'))
    with pytest.raises(TrialError, match="there is no waypoint 'right'"):
        import_pedsim(file)
    file.write_text("<scenario/>")
    with pytest.raises(TrialError, match="no agents that are people"):
        import_pedsim(file)


HALL = """<scenario>
  <obstacle x1="-5" y1="4" x2="25" y2="4"/><obstacle x1="-5" y1="-4" x2="25" y2="-4"/>
  <waypoint id="door" x="1" y="0" r="1" b="1"/><waypoint id="shop" x="9" y="1" r="1"/>
  <waypoint id="way_out" x="18" y="0" r="1.5" b="2"/><queue id="till" x="12" y="-1" direction="90"/>
  {}
</scenario>"""


def hall(tmp_path, text):
    file = tmp_path / "hall.xml"
    file.write_text(HALL.format(text))
    done = import_pedsim(file)
    check_trial(done.trials[0][1])
    return done.trials[0][1], done.left_out


@pytest.mark.parametrize(
    ("stops", "xs", "then"),
    [
        (("door", "way_out"), [1.0, 18.0], "leave"),
        (("shop", "way_out", "door"), [9.0, 18.0], "leave"),
        (("door", "shop"), [1.0, 9.0], "again"),
    ],
)
def test_a_source_of_pedsim_becomes_a_source(tmp_path, stops, xs, then):
    ways = "".join(f'<addwaypoint id="{stop}"/>' for stop in stops)
    trial, notes = hall(tmp_path, f'<source x="0" y="0" n="3" dx="2" dy="3" type="0">{ways}</source>')
    (source,) = trial.sources
    assert (source.rate, source.timing, source.zone[0], source.zone[2]) == (0.6, "regular", (-1.0, -1.5), (1.0, 1.5))
    assert ([stop.x for stop in trial.journeys[0].stops], trial.journeys[0].then) == (xs, then)
    assert any("never leave" in note for note in notes) == (then == "again")
    assert any("n people enter in 5 s" in note for note in notes)


def test_people_of_a_source_of_pedsim_enter_and_leave_at_the_sink(tmp_path):
    ways = '<addwaypoint id="way_out"/>'
    trial, _ = hall(tmp_path, f'<source x="0" y="0" n="2" dx="2" dy="3">{ways}</source>')
    tracks = run(dataclasses.replace(trial, duration=25.0)).tracks(0.4)
    first = tracks.x[tracks.id == tracks.id.min()]
    assert len(np.unique(tracks.id)) > 5
    assert np.ptp(first) > 12.0
    assert len(first) * 0.4 < 20.0


@pytest.mark.parametrize(
    ("lost", "why"),
    [
        ('<agent x="4" y="0" n="2" dx="1" dy="1"><addwaypoint id="roof"/></agent>', "there is no waypoint 'roof'"),
        ('<source x="4" y="0" n="2"><addqueue id="bar"/></source>', "there is no queue 'bar'"),
        ('<agent x="4" y="0" n="1" type="2"><addwaypoint id="roof"/></agent>', "there is no waypoint 'roof'"),
        ('<source x="4" y="0" n="2"/>', "it has no waypoints"),
    ],
)
def test_a_cluster_of_pedsim_without_its_waypoint_is_left_out(tmp_path, lost, why):
    kept = '<agent x="2" y="0" n="4" dx="2" dy="2"><addwaypoint id="shop"/></agent>'
    trial, notes = hall(tmp_path, kept + lost)
    assert (len(trial.spawners), trial.sources, trial.robots) == (1, (), ())
    assert next(note for note in notes if why in note).startswith(f"<{lost[1:].split()[0]}> in line 5 is left out: ")
    with pytest.raises(TrialError, match="no agents that are people, and no sources; .*is left out: "):
        hall(tmp_path, lost)


def test_queues_of_pedsim_are_places_to_walk_to(tmp_path):
    text = '<agent x="2" y="0" n="1"><addqueue id="till"/><addwaypoint id="way_out"/></agent>'
    trial, notes = hall(tmp_path, text)
    assert [stop.x for stop in trial.journeys[0].stops] == [12.0, 18.0]
    assert "queues are not imported: people walk to the place of a queue and do not wait there" in notes


def test_the_kind_of_file_is_found(tmp_path, umans):
    assert import_trial(write(tmp_path, VADERE)).trials[0][1].about == "Imported from Vadere."
    assert import_trial(umans).trials[0][1].about == "Imported from UMANS."
    (tmp_path / "a.xml").write_text("<city/>")
    with pytest.raises(TrialError, match="root element <city> is not known; files of UMANS have Simulation"):
        import_trial(tmp_path / "a.xml")


def test_the_command_writes_the_trial(tmp_path, capsys):
    file = tmp_path / "trial.xml"
    assert main(["new", "trial", str(file), "--import", str(write(tmp_path, VADERE))]) == 0
    assert "stairs of the topography are not imported" in capsys.readouterr().out
    assert load_trial(file).spawners[0].count == 8
