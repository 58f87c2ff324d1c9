"""Clearances and contacts of a robot with an outline: live, from logs and from recordings."""

import math

import numpy as np
import pytest
from shapely import Polygon, affinity

from crowdbot.core import stream
from crowdbot.core.outlines import time_to_outline
from crowdbot.metrics import AgentLog, NavigationMetrics, RobotLog, contact_events, log_metrics, wall_clearance
from crowdbot.recording import read_episode, run
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial, parse_trial, trial_xml

BOX = np.array([[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]])
SIZE = math.hypot(0.5, 0.2)


def _log(people, heading, robot=None):
    people = np.asarray(people, dtype=np.float64)
    T = len(people)
    robot = np.zeros((T, 2)) if robot is None else np.asarray(robot, dtype=np.float64)
    position = np.concatenate([robot[:, None], people], axis=1)
    A = position.shape[1]
    headings = np.zeros((T, A))
    headings[:, 0] = heading
    radius = np.broadcast_to([SIZE] + [0.3] * (A - 1), (T, A))
    return AgentLog(np.arange(T) * 0.1, position, np.zeros_like(position), headings, radius, np.ones((T, A), bool))


def _metrics(log, walls=None, outline=BOX, each=False):
    metrics = NavigationMetrics(0, SIZE, (9.0, 0.0), 0.2, walls=walls, outline=outline)
    contact = np.zeros(len(log.times), dtype=bool)
    if each:
        for states in log.states():
            metrics.update(states)
    else:
        metrics.update_log(log, contact)
    return metrics.result()


def test_a_person_beside_the_robot_is_apart_although_the_disc_touches():
    log = _log([[[0.0, 0.6]]] * 2, 0.0)
    assert _metrics(log)["min_clearance"] == pytest.approx(0.1)
    assert _metrics(log)["collision"] == 0.0
    disc = _metrics(log, outline=None)
    assert disc["min_clearance"] == pytest.approx(0.6 - SIZE - 0.3)
    assert disc["collision"] == 1.0
    turned = _metrics(_log([[[0.0, 0.6]]] * 2, math.pi / 2))
    assert turned["min_clearance"] == pytest.approx(-0.2)
    assert turned["max_penetration"] == pytest.approx(0.2)


def test_a_robot_fits_a_door_that_is_narrower_than_its_disc():
    walls = np.array([[2.0, 0.475, 2.0, 5.0], [2.0, -0.475, 2.0, -5.0]])
    path = np.stack([np.linspace(0.0, 4.0, 41), np.zeros(41)], axis=1)
    far = np.full((41, 1, 2), 50.0)
    assert wall_clearance(path, SIZE, walls).min() < 0.0
    straight = _metrics(_log(far, 0.0, path), walls)
    assert straight["min_wall_clearance"] == pytest.approx(0.275)
    assert straight["collision"] == 0.0
    across = _metrics(_log(far, math.pi / 2, path), walls)
    assert across["min_wall_clearance"] == pytest.approx(-0.025, abs=1e-6)
    assert across["collision"] == 1.0


@pytest.mark.parametrize("seed", range(5))
def test_a_log_and_its_records_give_the_same_bits(seed):
    rng = stream(seed, "outline")
    people = rng.uniform(-1.5, 1.5, (1, 6, 2)) + np.cumsum(rng.normal(0.0, 0.1, (20, 6, 2)), axis=0)
    heading = np.cumsum(rng.normal(0.0, 0.3, 20))
    heading[4] = np.nan  # unknown: the robot is a disc
    log = _log(people, heading, np.cumsum(rng.normal(0.0, 0.05, (20, 2)), axis=0))
    walls = np.array([[1.0, -2.0, 1.2, 2.0]])
    whole, each = _metrics(log, walls), _metrics(log, walls, each=True)
    assert repr(whole) == repr(each)
    assert whole["min_clearance"] >= _metrics(log, walls, outline=None)["min_clearance"] - 1e-12


def test_first_contact_with_the_side_of_a_robot():
    """A person walks from the left onto the long side of the robot, which stands."""
    y = np.linspace(1.0, 0.4, 4)
    log = _log(np.stack([np.full(4, 0.3), y], axis=1)[:, None], 0.0)
    radius = np.array([SIZE, 0.3])
    event = contact_events(log.times, log.position, log.velocity, radius, log.active, 0, log.heading[:, 0], BOX)[0]
    assert event.begin == pytest.approx(0.25)
    assert (event.cause, event.impact_speed) == ("person", pytest.approx(2.0))
    assert event.depth == pytest.approx(0.1)


def test_time_to_a_corner():
    corner = np.ascontiguousarray(BOX)
    straight = time_to_outline(3.0, 0.0, -1.0, 0.0, 0.3, 0.0, SIZE, corner, 0, 4)
    assert straight == pytest.approx(2.2)
    assert time_to_outline(3.0, 0.0, -1.0, 0.0, 0.3, math.pi / 2, SIZE, corner, 0, 4) == pytest.approx(2.5)
    assert time_to_outline(3.0, 0.51, -1.0, 0.0, 0.3, 0.0, SIZE, corner, 0, 4) == math.inf
    assert time_to_outline(0.0, 0.4, 0.0, 1.0, 0.3, 0.0, SIZE, corner, 0, 4) == 0.0


def test_a_recording_keeps_the_outline(tmp_path):
    text = trial_xml(load_trial("frontal", duration=3.0))
    assert "<robot " in text
    trial = parse_trial(text.replace("<robot ", '<robot type="turtlebot2" default-sensors="false" ', 1))
    episode = run(trial, 0, out=tmp_path)
    recorded = read_episode(tmp_path / "episode.mcap")
    for item in (episode, recorded):
        assert np.array_equal(item.footprints[0], trial.robots[0].body.footprint)
    assert repr(dict(recorded.metrics)) == repr(dict(episode.metrics))


def test_a_disc_has_no_footprint():
    episode = simulate(load_trial("frontal", duration=1.0), 0)
    assert episode.footprints == (None,)
    assert episode.trial.robots[0].body.outline is None


def test_objects_are_touched_by_the_outline_and_not_by_the_disc():
    agents = _log(np.full((21, 1, 2), 50.0), 0.0, np.stack([np.linspace(0.0, 2.0, 21), np.zeros(21)], axis=1))
    beside = np.array([[1.0, 0.6, 0.3]])  # 0.1 m beside the outline, in the disc
    disc = RobotLog.of(agents, 0, objects=beside)
    assert log_metrics(disc, ["task"])["object_collisions"] == 1.0
    log = RobotLog.of(agents, 0, objects=beside, outlines={0: BOX})
    assert log_metrics(log, ["task"])["object_collisions"] == 0.0
    nearer = RobotLog.of(agents, 0, objects=np.array([[1.0, 0.45, 0.3]]), outlines={0: BOX})
    assert log_metrics(nearer, ["task"])["object_collision"] == 1.0


def test_an_object_between_two_samples_is_touched():
    jump = _log(np.full((2, 1, 2), 50.0), 0.0, [[0.0, 0.0], [3.0, 0.0]])
    log = RobotLog.of(jump, 0, objects=np.array([[1.5, 0.0, 0.1]]), outlines={0: BOX})
    assert log_metrics(log, ["task"])["object_collisions"] == 1.0


@pytest.mark.parametrize(
    ("away", "turn", "outlines", "touched"),
    [
        (0.45, 0.0, {0: BOX, 1: BOX}, 0.0),  # side by side: 0.05 m
        (0.45, math.pi / 2, {0: BOX, 1: BOX}, 1.0),  # the other stands across
        (0.65, 0.0, {0: BOX}, 1.0),  # the other is a disc of 0.54 m
        (0.75, 0.0, {0: BOX}, 0.0),
        (0.75, 0.0, {}, 1.0),  # two discs
        (0.65, 0.0, {1: BOX}, 1.0),  # the own robot is a disc
        (0.75, 0.0, {1: BOX}, 0.0),
    ],
)
def test_two_robots_touch_by_their_outlines(away, turn, outlines, touched):
    agents = _log(np.full((3, 1, 2), [0.0, away]), 0.0)
    agents.heading[:, 1] = turn
    agents = agents._replace(radius=np.full(agents.radius.shape, SIZE))
    log = RobotLog.of(agents, 0, others=[1], outlines=outlines)
    assert log_metrics(log, ["task"])["robot_collision"] == touched


def test_a_robot_whose_heading_is_unknown_is_a_disc_to_objects():
    agents = _log(np.full((2, 1, 2), 50.0), math.nan)
    log = RobotLog.of(agents, 0, objects=np.array([[0.0, 0.6, 0.3]]), outlines={0: BOX})
    assert log_metrics(log, ["task"])["object_collision"] == 1.0


def test_a_robot_that_leaves_is_not_touched_any_more():
    agents = _log(np.full((4, 1, 2), [0.0, 3.0]), 0.0)
    agents.position[2:, 1] = [0.0, 0.1]
    agents.active[2:, 1] = False
    log = RobotLog.of(agents, 0, others=[1], outlines={0: BOX, 1: BOX})
    assert log_metrics(log, ["task"])["robot_collisions"] == 0.0


def test_random_pairs_of_robots_agree_with_the_polygons_of_shapely():
    rng = stream(7, "pairs")
    for _ in range(40):
        place, turns = rng.uniform(-0.8, 0.8, 2), rng.uniform(-math.pi, math.pi, 2)
        agents = _log(np.full((1, 1, 2), place), turns[0])
        agents.heading[:, 1] = turns[1]
        agents = agents._replace(radius=np.full(agents.radius.shape, SIZE))
        log = RobotLog.of(agents, 0, others=[1], outlines={0: BOX, 1: BOX})
        first, second = (
            affinity.translate(affinity.rotate(Polygon(BOX), turn, (0, 0), use_radians=True), *at)
            for turn, at in zip(turns, ((0.0, 0.0), place), strict=True)
        )
        assert log_metrics(log, ["task"])["robot_collision"] == float(first.intersects(second))
