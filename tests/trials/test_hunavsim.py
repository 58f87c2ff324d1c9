"""Trials from agent files of HuNavSim: what is read, that it runs, and wrong files."""

import math
from pathlib import Path

import numpy as np
import pytest

from behavior_files import REGULAR, VISITOR
from crowdbot.cli import main
from crowdbot.core import TrialError
from crowdbot.models import GroupForce
from crowdbot.simulation import simulate
from crowdbot.trials import check_trial, import_hunavsim, import_trial, load_trial, parse_trial, trial_xml
from crowdbot.world import REACTIONS

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
      cyclic_goals: false
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
        "custom and random configurations of behaviours: reactions replace the trees",
        "the behaviour tree BTSurprisedNav.xml is not in behavior_trees beside the file or its folder: a reaction"
        " replaces it",
        "ids are not imported: people are numbered in the order of the file",
        "publish_people is not imported",
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


ONE = """
hunav_loader:
  ros__parameters:
    agents: [ann]
    ann:
      behavior: {behavior}
      init_pose: {{x: 4.0, y: 0.2, h: 3.14}}
      goals: [g0, g1]
      g0: {{x: -6.0, y: 0.2}}
      g1: {{x: 6.0, y: 0.2}}
      {more}
"""
ROBOT = (
    '<robot name="cart" x="0" y="0"><goal x="0" y="9"/><drive type="differential-drive"/>'
    '<navigator type="still.py:Still"/></robot>'
)


def tree_of(name, action):
    """Return a tree in the form of those of HuNavSim, which includes the regular walk."""
    return VISITOR.replace("VisitorTree", name).replace("CuriousNav", action).replace(' gap="0.6"', "")


def package(tmp_path, behavior, more="", folder="config", trees="behavior_trees"):
    """Write an agent file and trees as in the package of HuNavSim, and return the path of the agent file."""
    (tmp_path / trees).mkdir(parents=True, exist_ok=True)
    (tmp_path / folder).mkdir(parents=True, exist_ok=True)
    names = {
        "Surprised": "SurprisedNav",
        "Scared": "ScaredNav",
        "Curious": "CuriousNav",
        "Threatening": "ThreateningNav",
    }
    for name, action in names.items():
        text = tree_of(f"{name}NavTree", action)
        (tmp_path / trees / f"BT{name}Nav.xml").write_text(text, encoding="utf-8")
    for name in ("walk.xml", "BTRegularNav.xml"):
        (tmp_path / trees / name).write_text(REGULAR, encoding="utf-8")
    file = tmp_path / folder / "agents.yaml"
    file.write_text(ONE.format(behavior=behavior, more=more), encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("behavior", "name", "regular", "kind"),
    [
        (1, "WalkTree", "regular", ""),
        (2, "WalkTree", "impassive", "impassive"),
        (3, "SurprisedNavTree", "ignore", "look"),
        (4, "ScaredNavTree", "ignore", "scared"),
        (5, "CuriousNavTree", "ignore", "curious"),
        (6, "ThreateningNavTree", "ignore", "block"),
        (-1, "WalkTree", "regular", ""),
    ],
)
def test_each_behaviour_has_its_tree(tmp_path, behavior, name, regular, kind):
    """Goals are reached as by IsGoalReached of HuNavSim, 0.1 m outside their radius."""
    done = import_trial(package(tmp_path, behavior, "goal_radius: 0.25"))
    ((_, trial),) = done.trials
    (ann,), (way,) = trial.agents, trial.journeys
    (tree,) = ann.behaviors
    assert (tree.behavior().name, tree.regular, ann.reactions) == (name, regular, ())
    assert kind in {"", *(reaction.kind for reaction in tree.behavior().reactions)}
    assert [stop.tolerance for stop in way.stops] == [0.35, 0.35]
    assert (way.then, ann.speed, ann.radius) == ("again", 1.0, 0.35)
    assert not any("tree" in sentence for sentence in done.left_out)


@pytest.mark.parametrize(
    ("behavior", "more", "how", "file"),
    [
        (4, "", {}, "behavior_trees/BTScaredNav.xml"),
        (4, "", {"folder": "."}, "behavior_trees/BTScaredNav.xml"),
        (4, "", {"folder": "same", "trees": "same"}, "BTScaredNav.xml"),
        (1, "behavior_tree: BTCuriousNav.xml", {}, "behavior_trees/BTCuriousNav.xml"),
        ("{type: 6, configuration: 0}", "", {"trees": "config/behavior_trees"}, "behavior_trees/BTThreateningNav.xml"),
    ],
)
def test_trees_are_found_where_hunavsim_has_them_and_copied(tmp_path, behavior, more, how, file):
    out = tmp_path / "out" / "trial.xml"
    out.parent.mkdir()
    assert main(["new", "trial", str(out), "--import", str(package(tmp_path, behavior, more, **how))]) == 0
    (tree,) = load_trial(out).agents[0].behaviors
    assert tree.file == file
    assert sorted(path.name for path in tree.files()) == sorted({Path(file).name, "walk.xml"})
    assert all(path.is_relative_to(out.parent) for path in tree.files())
    check_trial(load_trial(out))


def test_an_imported_tree_runs_by_its_own_distances_and_times(tmp_path):
    """The reaction begins at 4 m and lasts 3 s, as the tree says; the timer counts once."""
    ((_, trial),) = import_trial(package(tmp_path, 5)).trials
    (tmp_path / "still.py").write_text(
        "from dataclasses import dataclass\nfrom crowdbot import Navigator, Twist\n\n\n@dataclass(frozen=True)\n"
        "class Still(Navigator):\n    def act(self, observation):\n        return Twist()\n"
    )
    text = trial_xml(trial).replace('duration="120"', 'duration="30"').replace("<end", ROBOT + "<end")
    (tmp_path / "trial.xml").write_text(text, encoding="utf-8")
    episode = simulate(load_trial(tmp_path / "trial.xml"), 0)
    curious = episode.reactions[:, 0] == REACTIONS.index("curious")
    period = float(episode.times[1] - episode.times[0])
    assert np.count_nonzero(curious) * period == pytest.approx(3.0, abs=0.15)
    assert episode.position[-1, 0, 0] != pytest.approx(episode.position[0, 0, 0], abs=0.5)
    assert np.ptp(episode.position[:, 0, 0]) > 6.0  # to the first goal, and on to the second one


def test_a_tree_that_cannot_be_read_is_replaced_by_a_reaction_and_told(tmp_path):
    file = package(tmp_path, 5)
    tree = tmp_path / "behavior_trees" / "BTCuriousNav.xml"
    tree.write_text(tree.read_text(encoding="utf-8").replace("<CuriousNav", "<DanceNav"), encoding="utf-8")
    done = import_trial(file)
    (ann,) = done.trials[0][1].agents
    assert (ann.behaviors, [reaction.type for reaction in ann.reactions]) == ((), ["curious"])
    (told,) = [sentence for sentence in done.left_out if "tree" in sentence]
    assert told.startswith(
        "the behaviour tree behavior_trees/BTCuriousNav.xml, a reaction replaces it: behavior_trees/BTCuriousNav.xml:8:"
        " <DanceNav> is no known node"
    )


def test_a_tree_outside_is_not_read(tmp_path):
    (tmp_path / "secret.xml").write_text(REGULAR, encoding="utf-8")
    file = package(tmp_path / "a" / "b", 4, "behavior_tree: ../../../secret.xml")
    done = import_trial(file)
    assert done.trials[0][1].agents[0].behaviors == ()
    assert any("../../../secret.xml is not in behavior_trees" in sentence for sentence in done.left_out)
