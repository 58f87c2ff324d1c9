"""Metrics of logs against cases worked out by hand."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from robot_logs import REGIONS, agents_of, log_of_paths, random_log, walk

from crowdbot.core import InputError
from crowdbot.metrics import (
    IMPACT_METRICS,
    LOG_FAMILIES,
    NAVIGATION_METRICS,
    BodyRegion,
    RobotLog,
    crowd_effect,
    detect_groups,
    empty_scene_ratios,
    head_injury_criterion,
    impact_region_metrics,
    log_metrics,
    metric_families,
    metric_page,
    metric_table,
)

FAR = walk((50, 50), (0, 0), 20)


def values(log, family):
    return log_metrics(log, [family])


# ---- the table -------------------------------------------------------------------------------------------------------


def test_the_table_has_every_metric_once_with_its_definition():
    table = metric_table()
    for row in table.values():
        assert row.better in ("higher", "lower", "none")
        assert row.unit
        assert row.formula
        assert row.source
        assert row.needs
        assert row.correlates
    for names in (NAVIGATION_METRICS, IMPACT_METRICS):
        for name, (unit, meaning) in names.items():
            assert (table[name].unit, table[name].formula) == (unit, meaning.replace('"', "'"))


@pytest.mark.parametrize("family", LOG_FAMILIES)
def test_every_value_is_in_the_table_under_its_family(family):
    known = {row.name for row in metric_families()[family]}
    found = set(values(random_log(1, path=np.zeros((2, 2))), family))
    assert found <= known, f"{sorted(found - known)} need a row in src/crowdbot/assets/metrics/metrics.toml"
    if family != "severity":  # regions above the robot are absent
        assert found == known, f"the function of family {family} does not return {sorted(known - found)}"


def test_the_reference_page_is_that_of_the_table():
    page = Path(__file__).parents[2] / "docs/reference/metrics.md"
    assert page.read_text(encoding="utf-8") == metric_page(), "run python tools/fix.py metrics"


def test_unknown_families_and_bad_logs_are_refused():
    log = log_of_paths(FAR, FAR)
    with pytest.raises(InputError, match="no family of metrics 'tusk', did you mean 'task'"):
        log_metrics(log, ["tusk"])
    with pytest.raises(InputError, match=r"position has shape \[3, 2\], it must be \[21, 2\]"):
        dataclasses.replace(log, position=np.zeros((3, 2)))
    with pytest.raises(InputError, match="times must increase"):
        dataclasses.replace(log, times=np.zeros(21))


def test_a_log_ends_at_the_goal():
    log = log_of_paths(walk((0, 0), (1, 0), 30), walk((9, 9), (0, 0), 30), goal=(2, 0), tolerance=0.25)
    assert (len(log.times), log.success) == (19, True)
    hit = log_of_paths(walk((0, 0), (1, 0), 30), walk((1, 0), (0, 0), 30), goal=(2, 0), tolerance=0.25)
    assert not hit.success


# ---- task ------------------------------------------------------------------------------------------------------------


def test_collisions_are_split_by_what_is_touched_and_who_caused_it():
    robot = walk((0, 0), (1, 0), 20)
    log = log_of_paths(robot, walk((1, 0), (0, 0), 20), goal=(9, 0))
    found = values(log, "task")
    assert (found["person_collision"], found["robot_caused_collision"], found["person_caused_collision"]) == (1, 1, 0)
    assert found["wall_collision"] == found["object_collision"] == found["robot_collision"] == 0
    still = log_of_paths(walk((0, 0), (0, 0), 20), walk((1, 0), (-1, 0), 20))
    assert values(still, "task")["person_caused_collision"] == 1
    both = log_of_paths(walk((0, 0), (1, 0), 20), walk((2, 0), (-1, 0), 20))
    assert values(both, "task")["mutual_collision"] == 1


def test_walls_objects_and_other_robots_are_counted_as_events():
    robot = np.concatenate([walk((0, 0), (1, 0), 20), walk((2, 0), (-1, 0), 20)[1:], walk((0, 0), (1, 0), 20)[1:]])
    wall = np.array([[1.8, -1.0, 1.8, 1.0]])
    log = log_of_paths(robot, walk((0, 9), (0, 0), 60), walls=wall)
    assert values(log, "task")["wall_collisions"] == 2
    assert values(log, "task")["mean_wall_clearance"] == pytest.approx(
        np.mean(np.abs(1.8 - robot[:, 0])) - 0.3, abs=1e-9
    )
    log = log_of_paths(robot, walk((0, 9), (0, 0), 60), objects=np.array([[2.3, 0.0, 0.2]]))
    assert values(log, "task")["object_collisions"] == 2
    agents = agents_of(robot, walk((2.5, 0), (0, 0), 60))
    assert values(RobotLog.of(agents, 0, others=[1]), "task")["robot_collisions"] == 2
    assert values(RobotLog.of(agents, 0, others=[1]), "task")["person_collision"] == 0


def test_failures_to_progress_goal_distances_and_aggregated_time():
    robot = np.concatenate([walk((0, 0), (0, 0), 70), walk((0, 0), (1, 0), 80)[1:]])  # 7 s at rest, then 8 s of motion
    agents = agents_of(robot, walk((5, 5), (0, 0), 150))
    active = agents.active.copy()
    active[41:, 1] = False  # the person leaves after 4 s
    found = values(RobotLog.of(agents._replace(active=active), 0, (10, 0)), "task")
    assert found["failures_to_progress"] == 1  # 0 to 5 s; from 5 to 10 s it advances by 3 m
    assert found["final_goal_distance"] == found["min_goal_distance"] == pytest.approx(2.0)
    assert found["aggregated_time"] == pytest.approx(15.0 + 4.0)


# ---- path ------------------------------------------------------------------------------------------------------------


def test_path_metrics_of_a_detour():
    robot = np.concatenate([walk((0, 0), (0, 1), 30), walk((0, 3), (1, 0), 40)[1:]])
    line = np.array([[0.0, 0.0], [4.0, 3.0]])
    log = log_of_paths(robot, walk((50, 50), (0, 0), 70), goal=(4, 3), tolerance=0.5, path=line, max_speed=1.0)
    found = values(log, "path")
    length, time = 6.6, 6.6  # it stops at the first sample that is nearer than 0.5 m
    assert found["shortest_length"] == 4.5
    assert found["spl"] == pytest.approx(4.5 / length)
    assert found["stl"] == pytest.approx(4.5 / time)
    assert found["heading_change_excess"] == pytest.approx(math.pi / 2)
    assert found["sdtw"] == found["ndtw"] < 0.2
    straight = log_of_paths(walk((0, 0), (0.8, 0.6), 50), FAR[[0] * 51], goal=(4, 3), tolerance=0.5, path=line)
    assert values(straight, "path")["ndtw"] > 0.85
    lost = dataclasses.replace(log, success=False)
    assert values(lost, "path")["spl"] == values(lost, "path")["sdtw"] == 0.0
    assert math.isnan(values(dataclasses.replace(log, path=None), "path")["spl"])


# ---- motion ----------------------------------------------------------------------------------------------------------


def test_motion_of_a_uniform_acceleration():
    t = 0.1 * np.arange(51)
    robot = np.stack([t**2, 0 * t], axis=1)
    log = dataclasses.replace(
        log_of_paths(robot, FAR[[0] * 51], goal=(60, 0)), velocity=np.stack([2 * t, 0 * t], axis=1)
    )
    found = values(log, "motion")
    assert [found[f"{k}_acceleration"] for k in ("min", "mean", "max")] == pytest.approx([2.0] * 3)
    assert [found[f"{k}_speed"] for k in ("min", "mean", "max")] == pytest.approx([0.0, 5.0, 10.0])
    assert found["rms_jerk"] == pytest.approx(0.0, abs=1e-9)
    assert found["path_irregularity"] == pytest.approx(0.0)
    assert found["motion_energy"] == pytest.approx(np.sum((2 * t[1:]) ** 2) * 0.1)


def test_irregularity_freezing_and_smoothness():
    across = log_of_paths(walk((0, 0), (0, 1), 20), FAR, goal=(1000, 1))
    assert values(across, "motion")["path_irregularity"] == pytest.approx(math.pi / 2, abs=2e-3)
    frozen = log_of_paths(walk((0, 0), (0, 0), 60), FAR[[0] * 61], goal=(9, 0))
    assert values(frozen, "motion")["freezing"] == 1
    assert values(log_of_paths(walk((0, 0), (0, 0), 50), FAR[[0] * 51]), "motion")["freezing"] == 0
    t = np.linspace(0.0, 1.0, 101)
    bell = 30 * t**2 * (1 - t) ** 2  # the minimum-jerk profile has a spectral arc length near -1.41
    log = dataclasses.replace(
        log_of_paths(walk((0, 0), (1, 0), 100), FAR[[0] * 101]), velocity=np.stack([bell, 0 * t], 1)
    )
    assert values(log, "motion")["spectral_arc_length"] == pytest.approx(-1.41, abs=0.02)


# ---- comfort ---------------------------------------------------------------------------------------------------------


def test_discomfort():
    people = [(0.6 + gap, 0.0) for gap in (1.0, 0.15, 0.05, -0.1, 0.3)]
    found = values(log_of_paths([(0, 0)] * 5, people, dt=0.5), "comfort")
    assert found["discomfort_share"] == pytest.approx(2 / 5)
    assert found["discomfort_distance"] == pytest.approx(0.1)
    assert found["discomfort_integral"] == pytest.approx(0.5 * (0.05 + 0.15) * 0.5)


def test_the_personal_space_is_larger_ahead():
    person = walk((0, 0), (1, 0), 10)  # walks at 1 m/s: deviations 2 m ahead, 4/3 m to the sides, 1 m behind
    for away, wanted in (((2.0, 0.0), -0.5), ((0.0, 4.0 / 3.0), -0.5), ((-1.0, 0.0), -0.5)):
        found = values(log_of_paths(person + np.array(away), person), "comfort")
        assert found["personal_space_cost"] == pytest.approx(math.exp(wanted))
        assert found["personal_space_integral"] == pytest.approx(math.exp(wanted))


def test_intended_paths():
    person = walk((0, 0), (1, 0), 10)
    ahead = walk((2.2, 0), (1, 0), 10)  # 5 steps of 0.25 s reach 1.25 m, and radii and space 0.85 m
    assert values(log_of_paths(ahead - [0.11, 0], person), "comfort")["intended_path_intrusion"] == 1.0
    assert values(log_of_paths(ahead - [0.11, 0], person), "comfort")["intended_path_distance"] == pytest.approx(1.49)
    assert values(log_of_paths(ahead, person), "comfort")["intended_path_intrusion"] == 0.0


def test_violations_are_counted_for_the_one_who_approaches():
    robot = walk((0, 0), (1, 0), 20)
    found = values(log_of_paths(robot, walk((2.5, 0), (0, 0), 20)), "comfort")
    assert (found["robot_on_person_personal"], found["person_on_robot_personal"]) == (1, 0)
    assert (found["robot_on_person_intimate"], found["person_on_robot_intimate"]) == (1, 0)
    still = log_of_paths(walk((0, 0), (0, 0), 12), walk((2.5, 0), (-1, 0), 12))
    assert values(still, "comfort")["person_on_robot_personal"] == 1
    assert values(still, "comfort")["robot_on_person_personal"] == 0


# ---- conflict --------------------------------------------------------------------------------------------------------


def test_fear_and_panic():
    log = log_of_paths(walk((0, 0), (1, 0), 1), walk((4.6, 0), (0, 0), 1))
    assert values(log, "conflict")["max_fear"] == pytest.approx(1 / 3.9)
    assert values(log, "conflict")["max_panic"] == 0
    # passes at 1 m: V = 1, C2 = 16 + 1, g = sqrt(17 - 16) = 1, rho = 0.6
    log = log_of_paths(walk((-0.1, 0), (1, 0), 1), walk((4, 1), (0, 0), 1))
    assert values(log, "conflict")["max_panic"] == pytest.approx(math.sqrt(1 / 17) * 1 / 0.4)


def test_who_solves_a_conflict_is_responsible():
    person = walk((6, 0), (-1, 0), 20)
    turns = np.concatenate([walk((0, 0), (1, 0), 10), walk((1, 0), (1, 0.8), 10)[1:]])
    found = values(log_of_paths(turns, person), "conflict")
    assert found["responsibility"] == pytest.approx(1.0)
    assert found["people_responsibility"] == pytest.approx(0.0)
    swapped = values(log_of_paths(person, turns), "conflict")
    assert (swapped["responsibility"], swapped["people_responsibility"]) == (pytest.approx(0.0), pytest.approx(1.0))
    mirror = np.concatenate([walk((6, 0), (-1, 0), 10), walk((5, 0), (-1, -0.8), 10)[1:]])
    shared = values(log_of_paths(turns, mirror), "conflict")
    assert shared["responsibility"] == pytest.approx(0.5) == pytest.approx(shared["people_responsibility"])
    back = np.concatenate([walk((0, 0), (1, 0.8), 10), walk((1, 0.8), (1, 0.0), 10)[1:]])
    assert values(log_of_paths(back, walk((6, 0.8), (-1, 0), 20)), "conflict")["engagement"] == pytest.approx(1.0)


# ---- groups ----------------------------------------------------------------------------------------------------------


def test_a_robot_that_passes_between_two_people_intrudes_their_group():
    robot = walk((-2.03, 0), (1, 0), 40)
    pair = walk((0, 0.7), (0, 0), 40), walk((0, -0.7), (0, 0), 40)
    log = log_of_paths(robot, *pair, walk((9, 9), (1, 0), 40))
    assert detect_groups(log) == [[0, 1]]
    found = values(log, "groups")
    assert (found["groups"], found["group_collision"], found["min_group_distance"]) == (1, 1, pytest.approx(0.03))
    assert found["group_intrusion"] == pytest.approx(6 / 41)  # |x| < 0.3
    assert found["group_space_share"] == pytest.approx(14 / 41)  # |x| < 0.7
    assert found["group_intimate_share"] == pytest.approx(9 / 41)
    assert values(log_of_paths(robot + [0, 5], *pair), "groups")["group_collision"] == 0
    alone = values(log_of_paths(robot, pair[0]), "groups")
    assert alone["groups"] == 0
    assert math.isnan(alone["group_intrusion"])


def test_people_who_only_pass_each_other_are_no_group():
    log = log_of_paths(FAR[[0] * 41], walk((0, 0), (1, 0), 40), walk((4, 0.5), (-1, 0), 40))
    assert detect_groups(log) == []


# ---- severity --------------------------------------------------------------------------------------------------------


def test_severity_of_a_contact_at_1_m_per_s():
    log = log_of_paths(walk((0, 0), (1, 0), 20), walk((1.2, 0), (0, 0), 20), mass=60.0, height=0.4, regions=REGIONS)
    found = values(log, "severity")
    reduced = 60 * 75 / 135
    force = math.sqrt(60e3 * reduced)
    assert found["severity_lower_leg"] == pytest.approx(force / 260)
    assert found["severity_lower_bound"] == found["severity_upper_bound"] == found["severity_lower_leg"]
    assert "severity_thigh" not in found
    assert found["contact_force"] == pytest.approx(force)
    assert found["contact_energy"] == pytest.approx(0.5 * reduced)
    assert found["severity_ratio_above_1"] == 1
    high = values(dataclasses.replace(log, height=0.9), "severity")
    assert high["severity_thigh"] == pytest.approx(math.sqrt(50e3 * reduced) / 440) == high["severity_lower_bound"]
    assert math.isnan(values(dataclasses.replace(log, mass=math.nan), "severity")["contact_force"])


def test_the_worked_example_of_the_standard():
    chest = BodyRegion(25e3, 40.0, 140.0)
    assert chest.force(1.0, 60.0) == pytest.approx(774.6, abs=0.1)
    assert chest.severity(0.3615, 60.0) == pytest.approx(1.0, abs=1e-3)
    assert BodyRegion(75e3, 4.4, 65.0, 0.0).severity(0.1, 40.0) == math.inf


def test_head_injury_criterion_against_a_search_over_windows():
    region, mass, force = BodyRegion(150e3, 4.4, 130.0, 0.0), 40.0, 3000.0
    mu = mass * 4.4 / (mass + 4.4)
    length = math.pi * math.sqrt(mu / region.stiffness)
    t = np.linspace(0.0, length, 400)
    area = np.concatenate([[0.0], np.cumsum(force / 4.4 / 9.81 * np.sin(math.pi * (t[1:] + t[:-1]) / 2 / length))])
    area *= t[1]
    best = max(
        (t[b] - t[a]) * ((area[b] - area[a]) / (t[b] - t[a])) ** 2.5
        for a in range(0, 400, 3) for b in range(a + 1, 400, 3) if t[b] - t[a] <= 0.015
    )  # fmt: skip
    assert head_injury_criterion(force, region, mass) == pytest.approx(best, rel=0.01)


def test_regions_of_impacts():
    class Hit:
        def __init__(self, region, force, severity):
            self.region, self.peak_force, self.severity = region, force, severity

    regions = {"face": BodyRegion(75e3, 4.4, 65.0, 0.0)}
    found = impact_region_metrics(
        [Hit("thigh", 90, 0.2), Hit("thigh", 200, 0.5), Hit("face", 500, math.inf)], regions, 60.0
    )
    assert found["impact_severity_thigh"] == 0.5
    assert found["head_impacts"] == 1
    assert found["hic15"] == pytest.approx(head_injury_criterion(500, regions["face"], 60.0))


# ---- people, density, legibility -------------------------------------------------------------------------------------


def test_density_and_speeds():
    log = log_of_paths(walk((0, 0), (0, 0), 10), walk((1, 0), (0, 1), 10), walk((4, 0), (0, 2), 10))
    found = values(log, "density")
    assert found["density_2_5m"] == pytest.approx(1 / (math.pi * 2.5**2))
    assert found["max_density_5m"] == pytest.approx(2 / (math.pi * 25))
    assert found["density_10m"] == pytest.approx(2 / (math.pi * 100))
    assert found["people_speed"] == pytest.approx(1.5)
    assert found["nearest_person_speed"] == pytest.approx(1.0)
    assert found["velocity_loss_2_5m"] == pytest.approx(0.5)


def test_the_worst_off_people():
    log = log_of_paths(walk((0, 0), (0, 0), 10), walk((1.0, 0), (0, 0), 10), walk((9, 0), (0, 0), 10))
    found = values(log, "people")
    assert found["worst_decile_clearance"] == pytest.approx(0.4)
    assert found["worst_person_intrusion_time"] == pytest.approx(1.0)
    assert (found["intimate_people_share"], found["personal_people_share"]) == (0.5, 0.5)


def test_a_path_straight_to_the_goal_is_more_legible_than_a_detour():
    straight = log_of_paths(walk((0, 0), (1, 0), 50), FAR[[0] * 51], goal=(5, 0))
    detour = np.concatenate([walk((0, 0), (0, 1), 25), walk((0, 2.5), (2, -1), 25)[1:]])
    assert values(straight, "legibility")["legibility"] > 0.4
    assert values(log_of_paths(detour, FAR[[0] * 51], goal=(5, 0)), "legibility")["legibility"] < 0.3
    still = values(log_of_paths(walk((0, 0), (0, 0), 50), FAR[[0] * 51], goal=(5, 0)), "legibility")
    assert still["legibility"] == pytest.approx(0.2)


# ---- paired runs -----------------------------------------------------------------------------------------------------


def test_the_effect_on_the_crowd_is_that_of_the_neighbours():
    robot = walk((0, 0), (1, 0), 20)
    run = agents_of(robot, walk((1, 1), (0, 0), 20), walk((99, 0), (0, 0), 20))
    ghost = agents_of(robot, walk((1, 1.5), (0, 0), 20), walk((97, 0), (0, 0), 20))
    shifted = agents_of(robot, walk((1, 1.1), (0, 0), 20), walk((97, 0), (0, 0), 20))
    found = crowd_effect(run, ghost, 0, shifted)
    assert found["neighbors"] == 1
    assert found["crowd_disturbance"] == found["worst_person_disturbance"] == pytest.approx(0.5)
    assert found["chaos_floor"] == pytest.approx(0.1)
    assert found["disturbance_ratio"] == pytest.approx(5.0)
    same = crowd_effect(run, run, 0)
    assert same["crowd_disturbance"] == 0.0
    assert math.isnan(same["chaos_floor"])


def test_time_and_length_of_neighbours():
    robot = walk((0, 0), (0, 0), 40)
    slow, fast = agents_of(robot, walk((1, 0), (0, 1), 40)), agents_of(robot, walk((1, 0), (0, 2), 40))
    active = np.ones((41, 2), bool)
    active[31:, 1] = False
    quick = active.copy()
    quick[16:, 1] = False
    found = crowd_effect(slow._replace(active=active), fast._replace(active=quick), 0)
    assert found["neighbor_time_ratio"] == pytest.approx(2.0)
    assert found["people_time_lost"] == pytest.approx(1.5)
    assert found["neighbor_length_ratio"] == pytest.approx(0.5) == pytest.approx(found["neighbor_speed_ratio"])


def test_ratios_to_the_empty_scene():
    empty = log_of_paths(walk((0, 0), (1, 0), 60), FAR[[0] * 61], goal=(5, 0))
    slow = log_of_paths(walk((0, 0), (0.5, 0), 120), FAR[[0] * 121], goal=(5, 0))
    found = empty_scene_ratios(slow, empty)
    assert found["relative_time"] == pytest.approx(2.0, rel=0.02)
    assert found["relative_length"] == pytest.approx(1.0, rel=0.02)
    lost = empty_scene_ratios(dataclasses.replace(slow, success=False), empty)
    assert math.isnan(lost["relative_time"])


BOX = np.array([[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]])
ROUND = float(np.hypot(0.5, 0.2))


@pytest.mark.parametrize(
    ("outline", "turn", "intrusion", "path", "room"),
    [
        (None, 0.0, 1.0, 1.0, 0.8 - ROUND),
        (BOX, 0.0, 0.0, 0.0, 0.6),  # drives along x, its side towards people and the wall
        (BOX, np.pi / 2.0, 1.0, 1.0, 0.3),  # its front towards them
        (BOX, np.nan, 1.0, 1.0, 0.8 - ROUND),  # a disc while its heading is unknown
    ],
)
def test_groups_intended_paths_and_walls_are_met_by_the_outline(outline, turn, intrusion, path, room):
    """People stand 0.45 and 0.9 m beside the robot, and a wall 0.8 m on the other side."""
    steps = 4
    pair = [walk((x, y), (0.0, 0.0), steps) for x, y in ((-0.3, 0.45), (0.3, 0.45), (0.0, 0.95))]
    robot = walk((0.0, 0.0), (0.0, 0.0), steps)
    log = log_of_paths(robot, *pair, groups=[(0, 1)], walls=np.array([[-5.0, -0.8, 5.0, -0.8]]), outline=outline)
    log = dataclasses.replace(log, radius=ROUND, heading=np.full(steps + 1, turn))
    found = log_metrics(log, ["groups", "force"])
    assert found["group_intrusion"] == found["group_collision"] == intrusion
    assert found["obstacle_force_on_robot"] == pytest.approx((steps + 1) * 10.0 * np.exp(-room / 0.2))
    alone = dataclasses.replace(log_of_paths(robot, pair[2], outline=outline), radius=ROUND, heading=log.heading)
    assert log_metrics(alone, ["comfort"])["intended_path_intrusion"] == path


# ---- gestures --------------------------------------------------------------------------------------------------------


def told(robot, *columns):
    """Return the log of a robot with the codes of the gestures of some people, each 0.1 s."""
    far = walk((50, 50), (0, 0), len(robot) - 1)
    log = log_of_paths(robot, *[far] * len(columns), goal=(9, 0))
    return dataclasses.replace(log, gestures=np.array(columns, dtype=np.int8).T)


def test_compliance_is_the_share_of_time_in_which_the_robot_does_what_it_is_told():
    moving, still = walk((0, 0), (1, 0), 40), walk((0, 0), (0, 0), 40)
    none, wait, proceed = ([code] * 41 for code in range(3))
    for robot, does in ((moving, 0.0), (still, 1.0)):
        assert values(told(robot, wait), "gestures")["gesture_compliance"] == does
        assert values(told(robot, proceed), "gestures")["gesture_compliance"] == 1.0 - does
        assert values(told(robot, wait, none), "gestures")["gesture_compliance"] == does
    # 1 s of the first gesture and 2 s of the second one count; in the second one, the robot does what it is told
    first = [1] * 20 + [0] * 21
    second = [0] * 11 + [2] * 30
    assert values(told(moving, first, second), "gestures")["gesture_compliance"] == pytest.approx(19 / 28)


def test_compliance_is_not_defined_without_a_gesture_that_lasts_longer_than_a_second():
    moving = walk((0, 0), (1, 0), 40)
    for codes in ([0] * 41, [1] * 10 + [0] * 31, [2] * 8 + [1] * 9 + [0] * 24):
        assert math.isnan(values(told(moving, codes), "gestures")["gesture_compliance"])
    log = log_of_paths(moving, FAR[[0] * 41], goal=(9, 0))
    assert math.isnan(values(log, "gestures")["gesture_compliance"])
    with pytest.raises(InputError, match=r"gestures has shape \[3, 1\], it must be \[41, 1\]"):
        dataclasses.replace(log, gestures=np.zeros((3, 1), dtype=np.int8))
