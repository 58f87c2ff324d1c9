"""Trials from agent files of HuNavSim: what is read, that it runs, and wrong files."""

import math

import numpy as np
import pytest

from crowdbot.core import TrialError
from crowdbot.models import GroupForce
from crowdbot.simulation import simulate
from crowdbot.trials import check_trial, import_hunavsim, import_trial, parse_trial, trial_xml

AGENTS = """
hunav_loader:
  ros__parameters:
    map: cafe
    publish_people: true
    agents:
      - agent1
      - agent2
      - agent3
      - agent4
    agent1:
      id: 1
      skin: 0
      group_id: -1
      max_vel: 1.5
      radius: 0.4
      behavior:
        type: 5 # REGULAR=1, IMPASSIVE=2, SURPRISED=3, SCARED=4, CURIOUS=5, THREATENING=6
        configuration: 1
        duration: 40.0
        once: true
        vel: 0.6
        dist: 1.5
        social_force_factor: 5.0
      init_pose: {x: -4.0, y: -8.5, z: 1.25, h: 7.0}
      goal_radius: 0.2
      cyclic_goals: true
      goals:
        - g0
        - g1
      g0:
        x: -3.0
        y: -4.0
        h: 1.25
      g1: {x: 0.5, y: -4.0, h: 1.25}
    agent2:
      group_id: 3
      max_vel: 1.2
      radius: 0.3
      behavior: 3
      init_pose: {x: 1.0, y: 1.0, h: 0.0}
      goals: []
    agent3:
      group_id: 3
      behavior: {type: 6, configuration: 2}
      init_pose: {x: 2.0, y: 1.0, h: 0.0}
      goals: [7]
    agent4:
      behavior: {type: 1}
      init_pose: {x: 4.0, y: 1.0, h: 0.0}
    global_goals:
      7: {x: 9.0, y: 1.0, h: 0.0}
"""


def imported(tmp_path, text=AGENTS, name="agents.yaml"):
    file = tmp_path / name
    file.write_text(text, encoding="utf-8")
    return import_trial(file)


def test_agents_goals_groups_and_behaviours_are_read(tmp_path):
    done = imported(tmp_path)
    ((name, trial),) = done.trials
    one, two, three, four = trial.agents
    assert (name, trial.name, type(trial.crowd)) == ("agents", "agents", GroupForce)
    assert (one.position, one.speed, one.radius, one.group) == ((-4.0, -8.5), 1.5, 0.4, -1)
    assert one.heading == pytest.approx(7.0 - 2.0 * math.pi)
    way = next(journey for journey in trial.journeys if journey.name == one.journey)
    assert [(stop.x, stop.y, stop.tolerance) for stop in way.stops] == [(-3.0, -4.0, 0.2), (0.5, -4.0, 0.2)]
    assert way.then == "again"
    (curious,) = one.reactions
    assert (curious.type, curious.once, curious.duration, curious.speed) == ("curious", True, 40.0, 0.4)
    assert curious.gap == pytest.approx(1.5 - 0.4 - 0.3)
    assert [(agent.reactions[0].type, agent.reactions[0].speed) for agent in (two, three)] == [
        ("look", 0.0), ("block", None)
    ]  # fmt: skip
    assert (two.group, three.group, two.journey, four.reactions) == (3, 3, "", ())
    last = next(journey for journey in trial.journeys if journey.name == three.journey)
    assert (last.then, last.stops[0].x) == ("stay", 9.0)
    check_trial(trial)
    assert parse_trial(trial_xml(trial)) == trial


def test_what_is_not_imported_is_told(tmp_path):
    told = imported(tmp_path).left_out
    for sentence in (
        "the map cafe: the stage has no walls, add them",
        "the robot is not in the file: people react to the robots that you add",
        "random configurations of behaviours: the reactions have their defaults",
        "force factors of the behaviours: the model and the reactions have their defaults",
    ):
        assert sentence in told


def test_the_trial_runs(tmp_path):
    ((_, trial),) = imported(tmp_path).trials
    text = trial_xml(trial).replace('duration="120"', 'duration="6"')
    robot = (
        '<robot name="cart" x="-8" y="-6"><goal x="6" y="-6"/><drive type="differential-drive"/>'
        '<navigator type="straight"/></robot>'
    )
    episode = simulate(parse_trial(text.replace("<end", robot + "<end")), 0)
    assert np.isfinite(episode.position).all()
    assert episode.reactions is not None
    assert np.ptp(episode.position[:, 0], axis=0).max() > 1.0


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("hunav_loader:", "loader:", "files of HuNavSim have hunav_loader with ros__parameters"),
        ("      - agent4", "      - agent5", "agent 'agent5' is missing, or not a mapping"),
        ("type: 5 #", "type: 9 #", "agent1: behavior type = 9 must be from 1 to 6"),
        ("x: -4.0", "x: west", "agent1: x must be a number up to 1e6, not 'west'"),
        ("x: -4.0", "x: 1e9", "agent1: x must be a number up to 1e6, not '1000000000.0'"),
        ("- g1", "- g2", "agent1: goal g2 'g2' is missing"),
        ("goals: [7]", "goals: all", "agent3: goals must be a list of names"),
        ("max_vel: 1.5", "max_vel: !!python/object:os.system x", "the tag '!!python/object:os.system'"),
    ],
)
def test_wrong_files_are_told(tmp_path, old, new, sentence):
    assert old in AGENTS
    with pytest.raises(TrialError) as caught:
        imported(tmp_path, AGENTS.replace(old, new, 1))
    assert sentence in str(caught.value)


@pytest.mark.parametrize("data", [b"\xff\xfe\x00", b"", b"- 1\n", b"a: [1", b"hunav_loader: 3", b"x" * 5_000_000])
def test_hostile_files_end_with_a_sentence(tmp_path, data):
    file = tmp_path / "agents.yaml"
    file.write_bytes(data)
    with pytest.raises(TrialError, match=r"agents\.yaml"):
        import_hunavsim(file)
