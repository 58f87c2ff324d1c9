"""Import of files of the CrowdBot simulator of 2021; they are made here, from what is known of their elements."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import TrialError
from crowdbot.models import ORCA, VBM, VOG
from crowdbot.recording import run
from crowdbot.trials import Crowds, check_trial, import_original, parse_trial, trial_xml
from trial_texts import written

AGENT = """<agent><TrialRegularAgent mesh="m002" radius="{radius}" heightOffset="0.02">
  <Position x="{x}" y="{y}" z="0"/><Rotation x="0" y="0" z="{turn}"/>
  <controlLaw>{law}</controlLaw><controlSim>{sim}</controlSim></TrialRegularAgent></agent>"""
GOALS = """<LawGoals speedCurrent="0" speedDefault="1.2" accelerationMax="0.8" reachedDist="0.7" isLooping="{loop}">
  <Goals><Goal x="5" y="2" z="0"/><Goal x="-5" y="2" z="0"/></Goals></LawGoals>"""
RVO = '<RVOconfig SimulationID="1" neighborDist="5" maxNeighbors="3" timeHorizon="{horizon}" timeHorizonObst="2"/>'
VOG_SIM = """<VOGConfig neighborDist="6" maxNeighbors="4" timeHorizon="3"><group groupID="2" neighbourNum="3"
  weightPrefVel="0.3"/></VOGConfig>"""


def agent(x: float, y: float, law: str, sim: str = "", turn: float = 0.0, radius: float = 0.33) -> str:
    return AGENT.format(x=x, y=y, law=law, sim=sim, turn=turn, radius=radius)


TRIAL = f"""<?xml version="1.0" encoding="utf-8"?>
<Trial>
  <scene meshName="Kerlann"><Position x="0" y="0" z="0"/><recordingFile>Output_{{USER}}_{{ITT}}.csv</recordingFile>
    <endingConditions><condition parameter="time" test="greater" value="45"/>
    <condition parameter="x" test="greater" value="8"/><condition parameter="y" test="less" value="-7"/>
    </endingConditions></scene>
  <player><TrialCamPlayer mesh="CamPlayer" in_sim="false"/></player>
  <robots><robot><TrialRegularRobot mesh="Pepper" radius="0.5" in_sim="true"><Position x="-6" y="1" z="0"/>
    <Rotation x="0" y="0" z="270"/><controlLaw><LawFake/></controlLaw></TrialRegularRobot></robot></robots>
  <agents>
    {agent(0, 3, GOALS.format(loop="true"), RVO.format(horizon="2"))}
    {agent(1, 4, GOALS.format(loop="true"), RVO.format(horizon="4"), radius=0.3)}
    {agent(2, 5, '<LawStanding animationType="2"><LookAt x="2" y="9" z="0"/></LawStanding>')}
    {agent(3, -3, '<LawMoveStraight speedDefault="1.4"/>', VOG_SIM, turn=90)}
    {agent(4, -4, '<LawFileData dataFile="a.csv"/>', '<VBMConfig sigTtca="1.5"/>')}
  </agents>
  <obstacles><obstacle><TrialObstacle><Lines><Line x1="-9" y1="-9" x2="9" y2="-8" thickness="0.2"/>
    <Line x1="0" y1="8" x2="4" y2="8" thickness="0"/></Lines>
    <Points><Point x1="0" y1="-5" thickness="1"/></Points></TrialObstacle></obstacle></obstacles>
  <screenRecorder record="false" framerate="25"/>
</Trial>
"""


def test_a_trial_is_carried_over(tmp_path: Path) -> None:
    done = import_original(written(tmp_path, TRIAL, "demo.xml"))
    ((name, trial),) = done.trials
    check_trial(trial)
    assert (name, trial.name, trial.duration) == ("demo", "demo", 45.0)
    assert parse_trial(trial_xml(trial)) == trial
    assert len(trial.agents) == 5
    assert run(trial, seed=1).outcome in ("success", "timeout")


def test_axes_and_degrees_are_converted(tmp_path: Path) -> None:
    ((_, trial),) = import_original(written(tmp_path, TRIAL)).trials
    first, second, standing, straight, _ = trial.agents
    assert [item.position for item in (first, second)] == [(0.0, -3.0), (1.0, -4.0)]
    # it looks from 2,5 to 2,9 of the file, which is from 2,-5 to 2,-9 here
    assert standing.heading == pytest.approx(-math.pi / 2.0)
    assert standing.facing == standing.heading
    # 90 degrees in the engine look along its +X, which is -x of the file
    way = {journey.name: journey for journey in trial.journeys}[straight.journey]
    assert math.cos(way.stops[0].heading) == pytest.approx(-1.0)
    (robot,) = trial.robots
    assert robot.position == (-6.0, -1.0)
    assert math.cos(robot.heading) == pytest.approx(1.0), "270 degrees look along +x of the file"
    assert (robot.goal.position, robot.radius) == ((8.5, -1.0), 0.5)
    x, y = trial.end.conditions
    assert (x.what, x.above, y.what, y.above) == ("x", 8.0, "y", 7.0)
    solid, pillar = trial.stage.obstacles
    assert len(trial.stage.walls) == 1
    slope = np.ptp([p[1] for p in solid.points])
    assert slope == pytest.approx(1.2, abs=0.01), "a slanted wall stays slanted"
    assert np.mean(pillar.points, axis=0).tolist() == pytest.approx([0.0, 5.0])


def test_laws_and_simulators_are_carried_over(tmp_path: Path) -> None:
    ((_, trial),) = import_original(written(tmp_path, TRIAL)).trials
    assert isinstance(trial.crowd, Crowds)
    assert [type(model) for model in trial.crowd.models] == [ORCA, VOG, VBM]
    orca, vog, vbm = trial.crowd.models
    assert (orca.max_neighbors, orca.time_horizon) == (3.0, 2.0)
    assert (vog.preference_weight, vog.group_neighbors, vog.time_horizon) == (0.3, 3.0, 3.0)
    assert vbm.time_scale == 1.5
    first, second, _, straight, _ = trial.agents
    assert first.parameters == ()
    assert [(p.name, p.value) for p in second.parameters] == [("time-horizon", 4.0)]
    assert (second.radius, second.speed, straight.group, straight.speed) == (0.3, 1.2, 2, 1.4)
    loop = trial.journeys[0]
    assert (first.journey, second.journey, loop.then) == (loop.name, loop.name, "again")
    assert [(stop.x, stop.y, stop.tolerance) for stop in loop.stops] == [(5.0, -2.0, 0.7), (-5.0, -2.0, 0.7)]


def test_what_is_left_out_is_told(tmp_path: Path) -> None:
    said = "\n".join(import_original(written(tmp_path, TRIAL)).left_out)
    for words in ("stage 'Kerlann'", "TrialCamPlayer", "screenRecorder", "recordingFile", "LawFileData",
                  "mesh, height, variation", "robots were controlled externally"):  # fmt: skip
        assert words in said


def test_an_experiment_gives_its_trials_in_order(tmp_path: Path) -> None:
    config = """<Config><experience currentUser="3" startingTrial="1">
      <sourceFileExperiment>./Scenario/Order{TWO}.csv</sourceFileExperiment></experience>
      <log debugLvl="0"/><AddOns/></Config>"""
    written(tmp_path / "Scenario", "first.xml\n./Scenario/b{USER}.xml\nScenario/a.xml\ngone.xml\n", "Order1.csv")
    written(tmp_path / "Scenario", TRIAL, "a.xml")
    written(tmp_path / "Scenario", TRIAL.replace('value="45"', 'value="9"'), "b3.xml")
    done = import_original(written(tmp_path, config, "config.xml"))
    assert [(name, trial.duration) for name, trial in done.trials] == [("b3", 9.0), ("a", 45.0)]
    assert any("gone.xml" in sentence for sentence in done.left_out)
    with pytest.raises(TrialError, match="the order file './Scenario/Order0.csv' cannot be read: there is no file"):
        import_original(tmp_path / "config.xml", participant=2)
    away = written(tmp_path, config.replace("./Scenario/Order{TWO}.csv", "../../etc/passwd"), "away.xml")
    with pytest.raises(TrialError, match="lies outside"):
        import_original(away)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ('<!DOCTYPE Trial [<!ENTITY a "b">]><Trial/>', "must not have a DOCTYPE or entities"),
        ("<trial/>", "the root element is <trial>, an original file has Trial or Config"),
        ("<Trial>", "not well-formed XML"),
        (TRIAL.replace('x="3"', 'x="nan"'), "x='nan' is not finite"),
        (TRIAL.replace('x="3"', 'x="1e9"'), "x='1e9' is more than 1e6"),
        (TRIAL.replace('radius="0.3"', 'radius="wide"'), "radius='wide' is not a number"),
        ("<a>" * 5000, "more than 20 levels"),
    ],
)
def test_hostile_files_are_refused(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(TrialError) as found:
        import_original(written(tmp_path, text))
    assert sentence in str(found.value)


def test_an_empty_trial_is_one(tmp_path: Path) -> None:
    done = import_original(written(tmp_path, "<Trial/>"))
    assert done.trials[0][1].duration == 600.0
    assert done.left_out == ("no end by time was set: the trial now ends after 600 s",)
