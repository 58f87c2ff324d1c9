"""The built-in trials: each is possible, written and read, and asked for by its parameters."""

from __future__ import annotations

import dataclasses
import hashlib
import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from shapely import LineString, Point, Polygon
from shapely.ops import nearest_points

from crowdbot.core import TrialError, stream
from crowdbot.metrics import metric_table
from crowdbot.models import SocialForce
from crowdbot.navigation import Straight
from crowdbot.recording import run
from crowdbot.simulation import Simulation
from crowdbot.trials import (
    DENSITIES,
    FLOWS,
    PRESETS,
    SIZES,
    Zone,
    builtin_trials,
    check_trial,
    load_trial,
    parse_trial,
    trial_xml,
)
from crowdbot.world import Chair, Router, Table
from samples import sample

LISTED = """
    frontal intersection blind-corner doorway elevator overtaking being-overtaken following joining-group leaving-group
    passing-group circle-crossing dense-circle square-crossing one-way-with one-way-against two-way perpendicular-flow
    crossing-flows bottleneck static-crowd random-goals density-ladder leading pedestrian-obstruction down-path
    parallel-walk object-handover delayed-circle circle-with-standing corner-traffic block four-blocks one-against-ten
    crowd-against-crowd entering-room exiting-room exiting-elevator crash-cart robot-crowding
    random-hall intersection-gesture-wait intersection-gesture-proceed
"""
QUICK = [
    name for name in LISTED.split() if name not in ("one-way-with", "one-way-against", "two-way", "density-ladder")
]


def test_the_list_of_scenarios_is_complete() -> None:
    assert set(LISTED.split()) <= set(builtin_trials())
    challenge = {name for name in builtin_trials() if name.startswith("challenge-")}
    flows = {f"challenge-{kind}-{size}" for kind in FLOWS for size in SIZES}
    assert challenge == flows | {"challenge-alone"}
    assert len(challenge) == 21


FRANCIS = """
    Frontal Approach, Pedestrian Obstruction, Pedestrian Overtaking, Robot Overtaking, Down Path, Intersection
    No Gesture, Intersection Gesture Wait, Intersection Gesture Proceed, Blind Corner, Narrow Hallway, Narrow
    Doorway, Entering Room, Exiting Room, Entering Elevator, Exiting Elevator, Join Group, Leave Group,
    Following, Leading, Accompanying Peer, Crowd Navigation, Parallel Traffic, Perpendicular Traffic, Circular
    Crossing, Robot Crowding, Object Handover, Crash Cart
"""
"""Names of Table 3 and Figure 7 of Francis et al. 2025, doi:10.1145/3700599."""


def test_every_scenario_of_francis_et_al_has_a_trial_with_a_card() -> None:
    cards = {card.name: (name, card) for name, preset in PRESETS.items() for card in preset.cards}
    names = {" ".join(name.split()) for name in FRANCIS.split(",")}
    assert len(names) == 27
    assert cards.keys() == names
    for name, card in cards.values():
        load_trial(name, **card.values)
        assert set(card.metrics) <= metric_table().keys()
        assert all((card.setup, card.robot, card.success, card.metrics, card.lacks))


def test_every_metric_of_francis_et_al_has_a_row() -> None:
    names = (
        "S C WC AC HC TO FP ST T PL SPL V_min V_avg V_max A_min A_avg A_max J_min J_avg J_max CD_min CD_avg SC DH_min"
    )
    aliases = [row.alias for row in metric_table().values() if row.alias and "source" not in row.alias]
    assert sorted(aliases) == sorted([*names.split(), "TTC", "AT"])


@pytest.mark.parametrize("name", builtin_trials())
def test_a_builtin_trial_is_right_and_survives_the_way_through_xml(name: str) -> None:
    trial = load_trial(name)
    check_trial(trial)
    assert (trial.name, bool(trial.about)) == (name, True)
    assert parse_trial(trial_xml(trial)) == trial
    assert len(trial.robots) == 1
    assert type(trial.robots[0].navigator).__name__ in ("ORCANavigator", "Straight")


@pytest.mark.parametrize("name", sample(QUICK, 4))
def test_a_scenario_runs_and_is_not_impossible(name: str) -> None:
    episode = run(load_trial(name))
    assert episode.outcome == ("collision" if name == "dense-circle" else "success")


def test_everything_that_is_asked_for_is_done() -> None:
    trial = load_trial("intersection", density=0.5, angle=45, navigator="straight", model="social-force", seed=7)
    assert trial.people == round(0.5 * 3.0 * 7.0)
    assert isinstance(trial.robots[0].navigator, Straight)
    assert isinstance(trial.crowd, SocialForce)
    assert trial.seed == 7
    assert load_trial("frontal", robot=False).robots == ()
    assert not load_trial("frontal", reactive="false").robots[0].visible
    assert load_trial("frontal", **{"robot/goal/x": "3"}).robots[0].goal.x == 3.0


MEETINGS = [(angle, delay) for angle in (45.0, 90.0, 135.0) for delay in (-1.0, 0.0, 1.0)]


@pytest.mark.parametrize(("angle", "delay"), sample(MEETINGS, [(45.0, -1.0), (135.0, 1.0)], rows=True))
def test_people_arrive_at_the_intersection_when_they_are_asked_to(angle: float, delay: float) -> None:
    trial = load_trial("intersection", angle=angle, delay=delay, robot=False)
    episode = run(trial)
    here = episode.active[:, 0]
    away = np.where(here, np.hypot(*episode.position[:, 0].T), np.inf)
    assert episode.times[int(np.argmin(away))] == pytest.approx(6.0 + delay, abs=0.3)
    way = episode.velocity[5, 0]
    assert math.degrees(math.atan2(way[1], way[0])) == pytest.approx(angle, abs=2.0)


@pytest.mark.parametrize("density", DENSITIES)
def test_every_rung_of_the_ladder_has_its_density(density: float) -> None:
    trial = load_trial("density-ladder", density=density)
    assert trial.people == round(density * 100.0)
    check_trial(trial)


def test_the_robot_stops_in_front_of_who_takes_something_within_reach() -> None:
    for approach in (-60.0, 0.0, 60.0):
        episode = run(load_trial("object-handover", reach=0.8, approach=approach))
        assert episode.outcome == "success"
        person, robot = episode.position[-1]
        assert np.hypot(*(robot - person)) == pytest.approx(0.8, abs=0.2)
        ahead = np.array([np.cos(episode.heading[-1, 0]), np.sin(episode.heading[-1, 0])])
        assert (robot - person) @ ahead > 0.6


@pytest.mark.parametrize(("name", "people"), [("pedestrian-obstruction", 1), ("circle-with-standing", 3)])
def test_who_stands_in_the_way_stays_there(name: str, people: int) -> None:
    episode = run(load_trial(name))
    standing = episode.position[:, :people]
    assert np.hypot(*(standing - standing[0]).transpose(2, 0, 1)).max() < 0.1
    if name == "pedestrian-obstruction":
        aside = run(load_trial(name, gives_way=True)).position[:, 0]
        assert np.hypot(*(aside - aside[0]).T).max() > 0.2


def test_people_come_into_a_delayed_circle_one_after_the_other() -> None:
    episode = run(load_trial("delayed-circle", delay=4.0))
    people = [a for a in range(len(episode.ids)) if a not in episode.robots]
    begins = sorted(float(episode.times[np.argmax(episode.active[:, a])]) for a in people)
    assert len(begins) == 5
    assert begins[0] <= 0.1
    assert 2.0 < begins[-1] <= 4.1
    assert len(set(begins)) == 5
    far = [np.hypot(*episode.position[np.argmax(episode.active[:, a]), a]) for a in people]
    assert np.allclose(far, 7.0, atol=0.6)


@pytest.mark.parametrize("angle", [45.0, 90.0, 180.0])
def test_ten_people_cross_at_the_angle_and_when_the_robot_does(angle: float) -> None:
    trial = load_trial("one-against-ten", angle=angle, robot=False)
    episode = run(dataclasses.replace(trial, duration=6.5))
    start, later = episode.position[0].mean(axis=0), episode.position[60].mean(axis=0)
    assert math.degrees(math.atan2(*(later - start)[::-1])) % 360.0 == pytest.approx(angle, abs=3.0)
    middle = np.hypot(*episode.position.mean(axis=1).T)
    assert episode.times[int(np.argmin(middle))] == pytest.approx(6.0, abs=0.6)


@pytest.mark.parametrize("people", [25, 100])
def test_ranks_are_a_metre_apart_and_everyone_has_an_own_goal(people: int) -> None:
    trial = load_trial("crowd-against-crowd", people=people, formation=True, angle=90.0)
    place = np.array([agent.position for agent in trial.agents])
    assert len(place) == 2 * people
    gap = np.hypot(*(place[:, None] - place[None]).transpose(2, 0, 1))
    assert gap[gap > 0.0].min() == pytest.approx(1.0, abs=1e-5)
    assert len({agent.goal for agent in trial.agents}) == 2 * people


def test_people_of_a_corridor_without_ends_stay_as_many() -> None:
    trial = load_trial("two-way", density=0.2, groups=0.5, robot=False)
    episode = run(parse_trial(trial_xml(trial).replace('duration="90"', 'duration="20"')))
    assert (episode.active.sum(axis=1) == trial.people).all()
    assert len(episode.ids) > trial.people


def test_the_challenge_is_that_of_its_files() -> None:
    trial = load_trial("challenge-cross-both-350")
    assert (trial.people, trial.duration) == (350, 180.0)
    assert (trial.end.goal, trial.end.collision) == (True, False)
    robot = trial.robots[0]
    assert (robot.position, robot.goal.position, robot.radius, robot.visible) == ((-20.0, 0.0), (20.0, 0.0), 0.5, True)
    assert (robot.type, robot.latency, round(robot.body.radius, 2)) == ("turtlebot2", 0.0, 0.23)
    assert {spawner.speed.extent for spawner in trial.spawners} == {(1.03, 1.63)}
    assert {spawner.radius.extent for spawner in trial.spawners} == {(0.33, 0.33)}
    assert not load_trial("challenge-with-50", reactive=False).robots[0].visible
    episode = run(parse_trial(trial_xml(load_trial("challenge-cross-50")).replace('duration="180"', 'duration="15"')))
    assert (episode.active[:, :50].sum() + episode.active[:, 51:].sum()) == 50 * len(episode.times)
    assert np.abs(episode.position[..., 1]).max() < 9.0
    down = episode.velocity[-1, episode.active[-1], 1]
    assert np.median(down) < -1.0


@pytest.mark.parametrize(
    "name", sample(["challenge-cross-350", "challenge-against-350", "challenge-both-350"], ["challenge-both-350"])
)
def test_nobody_begins_in_the_robot_of_the_challenge(name: str) -> None:
    trial = load_trial(name)
    people = Simulation(trial, trial.seed).people
    gap = np.hypot(*(people.position - trial.robots[0].position).T) - people.radius - trial.robots[0].radius
    assert gap.min() > 0.0
    touched = run(dataclasses.replace(trial, world="physics", duration=1.0))
    assert touched.outcome == "timeout"


def test_the_long_trial_of_the_documents_has_a_thousand_people_for_ten_minutes() -> None:
    trial = load_trial(Path(__file__).parents[2] / "docs" / "gallery" / "trials" / "thousand.xml")
    assert (trial.people, trial.duration, len(trial.robots), trial.world) == (1000, 600.0, 1, "planar")
    episode = run(dataclasses.replace(trial, duration=0.8))
    assert episode.active[-1].sum() == 1001
    assert parse_trial(trial_xml(trial)) == trial


@pytest.mark.parametrize(
    ("name", "values", "sentence"),
    [
        ("frontal", {"widht": 3}, "frontal has no parameter 'widht', did you mean 'width'?; it has width, gap, low"),
        ("frontal", {"width": 0.1}, 'frontal: width="0.1" must be from 1.2 to 20 m'),
        ("frontal", {"width": "wide"}, 'width="wide" is not a number'),
        ("frontal", {"robot": "maybe"}, 'robot="maybe" must be true or false'),
        ("frontal", {"model": "orka"}, "frontal: unknown crowd model 'orka', did you mean 'orca'?"),
        ("frontal", {"navigator": "x.py:Y"}, "frontal: "),
        ("random-goals", {"people": 2.5}, "must be a whole number"),
        ("random-goals", {"people": 400, "side": 6.0}, "fit into the spawn zone"),
        ("frontal", {"robot[2]/x": 1}, "does not exist: there are 1 <robot>"),
        ("crossing-flows", {"density": 1}, "names no attribute: <trial> has no 'density'"),
    ],
)
def test_wrong_parameters_are_told(name: str, values: dict[str, object], sentence: str) -> None:
    with pytest.raises(TrialError) as found:
        load_trial(name, **values)
    assert sentence in str(found.value)


def test_two_wrong_parameters_are_told_at_once() -> None:
    with pytest.raises(TrialError) as found:
        load_trial("frontal", width=-1, gap="no")
    assert len(found.value.problems) == 2


def test_every_parameter_has_a_line_for_people() -> None:
    for preset in PRESETS.values():
        assert preset.about.endswith(".")
        assert all(str(option).strip() and option.value(option.default) == option.default
                   for option in preset.options.values())  # fmt: skip


@pytest.mark.parametrize("width", [2.0, 4.0, 20.0])
@pytest.mark.parametrize("name", ["one-way-with", "one-way-against", "two-way"])
def test_every_density_of_a_corridor_can_be_placed(name: str, width: float) -> None:
    trial = load_trial(name, density=3.0, width=width)
    assert trial.people == pytest.approx(3.0 * 40.0 * width, abs=1)
    for seed in (0, 1, 2):
        check_trial(trial, seed)  # people who do not fit are an error


@pytest.mark.parametrize("layout", sample(range(400), 12))
def test_a_random_hall_is_possible_with_any_seed_and_parameters(layout: int) -> None:
    rng = stream(layout, "parameters")
    drawn: dict[str, float] = {}
    for name, option in PRESETS["random-hall"].own.items():
        value = float(rng.uniform(option.low, min(option.high, 30.0) if option.unit else option.high))
        drawn[name] = value if option.unit else round(value)
    for values in ({"layout": layout}, drawn):
        trial = load_trial("random-hall", values)
        check_trial(trial, layout)  # people who do not fit, and a robot without a path, are errors
        (robot,) = trial.robots
        planner = robot.stage_planner(trial.stage)
        assert planner is not None
        assert planner.waypoints(robot.position, robot.goal.position)[-1].tolist() == [*robot.goal.position]
        router = Router.of(trial.stage.as_walls(), 0.3)
        for journey in trial.journeys:
            corners = np.array([stop.points for stop in journey.stops if isinstance(stop, Zone)])
            assert trial.stage.clearance(corners.reshape(-1, 2)).min() >= router.radius
            middles = corners.mean(axis=1)
            router.towards(middles, middles[::-1])  # raises without a path


def test_tables_of_a_random_hall_have_chairs_and_change_nothing_else() -> None:
    bare, full = (load_trial("random-hall", layout=3, length=24.0, width=18.0, tables=n) for n in (0, 8))
    kinds = [type(prop).__name__ for prop in full.stage.props]
    assert (kinds.count("Table"), kinds.count("Chair")) == (8, 33)
    assert full == dataclasses.replace(bare, stage=dataclasses.replace(bare.stage, props=full.stage.props))
    lines = [LineString([*ring, ring[0]]) for ring in bare.stage.rings]
    tops = [Polygon(prop.ring) for prop in full.stage.props if isinstance(prop, Table)]
    gaps = [one.distance(other) for one, other in itertools.combinations(tops, 2)]
    assert min(gaps) > 0.9
    assert all(table.distance(line) > 0.9 for table in tops for line in lines)
    for chair in (prop for prop in full.stage.props if isinstance(prop, Chair)):
        nearest = min(tops, key=Point(chair.x, chair.y).distance)
        towards = np.subtract(nearest_points(nearest, Point(chair.x, chair.y))[0].coords[0], (chair.x, chair.y))
        assert 0.0999 <= np.hypot(*towards) <= 0.3801
        assert towards @ [math.cos(chair.heading), math.sin(chair.heading)] > 0.9 * np.hypot(*towards)


def test_a_scanner_in_space_sees_legs_of_furniture_where_a_flat_one_sees_solid_outlines() -> None:
    text = """<trial name="t" duration="0.1"{words}>
      <stage walkable="0,0 10,0 10,6 0,6"><table x="5" y="3" heading="0.3"/><chair x="5" y="1.8" heading="1.5"/></stage>
      <crowd type="orca"/><agent name="a" x="9" y="5" goal="1,5"/>
      <robot name="r" x="2" y="3"><goal x="9" y="1"/><drive type="differential-drive"/><navigator type="straight"/>
        <sensor name="scan" type="lidar2d" rays="1080" field-of-view="3" z="0.3"/></robot></trial>"""
    beams = {}
    for words in ("", ' bodies="limbs"'):
        scan = run(parse_trial(text.format(words=words)), 0).readings["r/scan"][0]
        near = (scan.ranges[0] > 2.0) & (scan.ranges[0] < 4.3) & (np.abs(scan.angles) < 0.6)
        beams[words] = int(near.sum()), int((np.diff(near.astype(int)) == 1).sum())
    assert beams[""][0] > 3 * beams[' bodies="limbs"'][0]
    assert beams[""][1] == 2
    assert beams[' bodies="limbs"'][1] >= 6  # of eight legs some are hidden by others


def test_a_random_hall_is_the_same_on_every_machine() -> None:
    text = "".join(trial_xml(load_trial("random-hall", layout=layout)) for layout in range(1, 6))
    assert hashlib.blake2b(text.encode(), digest_size=8).hexdigest() == "490972c590cd5baf"
    assert len({trial_xml(load_trial("random-hall", layout=layout)) for layout in range(1, 6)}) == 5
