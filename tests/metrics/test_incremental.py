"""Incremental navigation metrics against whole-array formulas, and metrics of runs against their recorded logs."""

import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, stream
from crowdbot.metrics import (
    NAVIGATION_METRICS,
    AgentLog,
    AgentStates,
    NavigationMetrics,
    NavigationOutcome,
    clearance,
    contact_events,
    local_density,
    navigation_metrics,
    outcome,
    swept_clearance,
    time_to_collision,
    wall_clearance,
)
from crowdbot.recording import run
from crowdbot.trials import Trial, load_trial
from samples import sample

R = 0.3
TRIALS = ("crossing-flows", "frontal", "overtaking", "being-overtaken", "perpendicular-flow", "blind-corner")


def states(time, robot, *people, robot_velocity=(0.0, 0.0), heading=math.nan, ids=None, radius=R):
    """Return the robot 0 at a place and people as rows x, y, vx, vy."""
    rows = np.array([(*robot, *robot_velocity), *people], dtype=float)
    who = np.arange(len(rows)) if ids is None else np.array([0, *ids])
    headings = np.array([heading] + [math.nan] * len(people))
    return AgentStates(float(time), who, rows[:, :2], rows[:, 2:], headings, np.full(len(rows), radius))


def fed(*records, goal=(9.0, 0.0), tolerance=0.25, contacts=(), **options):
    metrics = NavigationMetrics(0, R, goal, tolerance, **options)
    for k, record in enumerate(records):
        metrics.update(record, contact=k in contacts)
    return metrics


def random_log(seed, steps=60, people=6):
    """Return times, positions, velocities, radii and presence of random walks that meet often; people come and go."""
    rng = stream(seed, "log")
    paths = np.cumsum(rng.normal(0, 0.12, (steps, people + 1, 2)), axis=0) + rng.uniform(-1.5, 1.5, (people + 1, 2))
    active = rng.uniform(size=(steps, people + 1)) > 0.02
    active[:, 1:] &= ~((np.arange(steps)[:, None] // 20 == 1) & (rng.uniform(size=people) < 0.3))
    active[:, 0] = True
    times = np.cumsum(rng.choice([0.05, 0.1, 0.2], steps))
    velocity = np.gradient(paths, times, axis=0)
    return times, paths, velocity, rng.uniform(0.2, 0.4, people + 1), active


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000))
def test_record_by_record_is_the_same_as_formulas_over_the_whole_log(seed):
    times, position, velocity, radius, active = random_log(seed)
    walls = np.array([[-3.0, -2.5, 3.0, -2.5], [2.5, -3.0, 2.5, 3.0]])
    goal = np.array([50.0, 0.0])
    found = navigation_metrics(times, position, velocity, radius, active, 0, goal, 0.3, walls=walls)
    assert set(found) == set(NAVIGATION_METRICS)
    swept = swept_clearance(times, position, radius, active, 0).min(axis=1)
    nearest = clearance(position, radius, active, 0).min(axis=1)
    soonest = time_to_collision(position, velocity, radius, active, 0).min(axis=1)
    density = local_density(position, active, 0)
    wall = wall_clearance(position[:, 0], radius[0], walls)
    events = contact_events(times, position, velocity, radius, active, 0)
    hit = np.flatnonzero(np.minimum(swept, wall) < 0.0)
    expected = {
        "collision": float(len(hit) > 0),
        "timeout": float(len(hit) == 0),
        "success": 0.0,
        "min_clearance": swept.min(),
        "min_clearance_time": times[swept.argmin()],
        "mean_nearest_distance": nearest[np.isfinite(nearest)].mean(),
        "personal_space_compliance": np.mean(nearest >= 0.5),
        "intimate_share": np.mean(nearest < 0.45),
        "min_wall_clearance": wall.min(),
        "local_density": density.mean(),
        "max_local_density": density.max(),
        "min_ttc": soonest.min(),
        "ttc_below_1s": np.mean(soonest < 1.0),
        "ttc_below_3s": np.mean(soonest < 3.0),
        "contacts": len(events),
        "robot_caused_contacts": sum(event.cause == "robot" for event in events),
        "person_caused_contacts": sum(event.cause == "person" for event in events),
        "contact_time": sum(event.end - event.begin for event in events),
        "max_penetration": max([0.0, *(event.depth for event in events)]),
        "max_impact_speed": max([0.0, *(event.impact_speed for event in events)]),
    }
    assert {name: found[name] for name in expected} == pytest.approx(expected, abs=1e-12)
    ended = outcome(times, position, radius, active, 0, goal, 0.3, walls=walls)
    assert ended == (
        NavigationOutcome("collision", hit[0]) if len(hit) else NavigationOutcome("timeout", len(times) - 1)
    )


@pytest.mark.parametrize(
    ("gaps", "lowest", "below_1s", "below_3s"),
    [
        ((1.0,), 1.0, 0.0, 1.0),
        ((0.999,), 0.999, 1.0, 1.0),
        ((3.0,), 3.0, 0.0, 0.0),
        ((2.999, 3.0, 4.0, 0.5), 0.5, 0.25, 0.5),
        ((5.0, 1.0, 2.0, 0.25), 0.25, 0.25, 0.75),
    ],
)
def test_time_to_collision_counts_below_its_bounds_only(gaps, lowest, below_1s, below_3s):
    """Somebody comes at 1 m/s from so many metres away: the time is the gap."""
    records = [states(k, (0.0, 0.0), (gap + 2 * R, 0.0, -1.0, 0.0)) for k, gap in enumerate(gaps)]
    found = fed(*records).result()
    shares = (found["min_ttc"], found["ttc_below_1s"], found["ttc_below_3s"])
    assert shares == pytest.approx((lowest, below_1s, below_3s), abs=1e-9)


def test_the_outcome_of_the_run_wins_over_that_of_the_records():
    metrics = fed(states(0, (0.0, 0.0)), states(1, (1.0, 0.0)), goal=(1.0, 0.0))
    assert metrics.outcome == NavigationOutcome("success", 1)
    own, told = metrics.result(), metrics.result("collision")
    assert (own["success"], own["collision"], own["time_to_goal"]) == (1.0, 0.0, 1.0)
    assert (told["success"], told["collision"], told["timeout"]) == (0.0, 1.0, 0.0)
    assert math.isnan(told["time_to_goal"])
    assert [metrics.result("interrupted")[word] for word in ("success", "collision", "timeout")] == [0.0, 0.0, 0.0]
    same = [name for name in own if name not in ("success", "collision", "timeout", "time_to_goal")]
    assert [own[name] for name in same] == pytest.approx([told[name] for name in same], nan_ok=True)


def test_a_contact_that_only_the_world_saw_is_a_collision_and_no_event():
    path = [states(k, (0.1 * k, 0.0), (5.0, 5.0, 0.0, 0.0)) for k in range(4)]
    assert fed(*path).outcome.name == "timeout"
    touched = fed(*path, contacts=(2,))
    assert touched.outcome == NavigationOutcome("collision", 2)
    assert (touched.result()["collision"], touched.result()["contacts"]) == (1.0, 0.0)


def test_a_contact_in_the_step_that_reaches_the_goal_comes_first():
    metrics = fed(states(0, (0.0, 0.0)), states(1, (1.0, 0.0)), goal=(1.0, 0.0), contacts=(1,))
    assert metrics.outcome == NavigationOutcome("collision", 1)


def test_nothing_counts_after_the_goal_or_the_time_limit():
    path = [states(k, (0.5 * k, 0.0)) for k in range(8)]
    there = fed(*path, goal=(1.0, 0.0), tolerance=0.1, contacts=(3,))
    assert (there.outcome, there.result()["duration"]) == (NavigationOutcome("success", 2), 2.0)
    late = fed(*path, goal=(3.0, 0.0), tolerance=0.1, time_limit=3.0)
    assert (late.outcome, late.result()["duration"]) == (NavigationOutcome("timeout", 3), 3.0)
    touching = fed(*path, goal=(1.0, 0.0), tolerance=0.5)
    assert touching.outcome.sample == 2  # the tolerance itself is not near enough


def test_headings_come_from_the_record_or_from_the_motion():
    known = [states(k, (0.0, 0.0), heading=0.5 * k) for k in range(3)]
    assert fed(*known).result()["heading_change"] == pytest.approx(1.0)
    moves = [(1.0, 0.0), (0.04, 0.03), (0.0, 1.0)]  # the second is too slow for a direction
    seen = [states(k, (0.0, 0.0), robot_velocity=move) for k, move in enumerate(moves)]
    assert fed(*seen).result()["heading_change"] == pytest.approx(math.pi / 2)


def test_contacts_are_followed_by_identity():
    """Persons 5 and 9 touch the robot one after the other, in the same place of the arrays."""
    one = [states(0.1 * k, (0.0, 0.0), (0.5 + 0.2 * abs(k - 2), 0.0, 0.0, 0.0), ids=[5]) for k in range(6)]
    two = [states(2.0 + 0.1 * k, (0.0, 0.0), (0.5, 0.0, 0.0, 0.0), ids=[9]) for k in range(3)]
    found = fed(*one, *two).result()
    assert found["contacts"] == 2.0
    assert found["max_penetration"] == pytest.approx(0.1)
    rest = [states(3.0 + 0.5 * k, (0.0, 0.0), (8.0, 0.0, 0.0, 0.0), ids=[9]) for k in range(6)]
    assert fed(*one, *two, *rest).result()["contacts"] == 2.0


def test_wrong_records_are_rejected():
    metrics = NavigationMetrics(0, R, (9.0, 0.0), 0.25)
    with pytest.raises(InputError, match="there is no record yet"):
        metrics.result()
    metrics.update(states(1.0, (0.0, 0.0)))
    with pytest.raises(InputError, match="1.0 s follows 1.0 s"):
        metrics.update(states(1.0, (0.0, 0.0)))
    alone = AgentStates(2.0, np.array([3]), np.zeros((1, 2)), np.zeros((1, 2)), np.zeros(1), np.ones(1))
    with pytest.raises(InputError, match="robot 0 is absent at 2.0 s"):
        metrics.update(alone)


@pytest.mark.parametrize("name", sample(TRIALS, ["overtaking", "perpendicular-flow"]))
def test_metrics_of_a_run_are_those_of_its_log(name):
    """The metrics of an episode, gathered while it ran, are those of its arrays; the outcome is that of the run."""
    trial: Trial = load_trial(name)
    episode = run(trial, seed=2)
    robot, goal = episode.robots[0], trial.robots[0].goal
    logged = navigation_metrics(
        episode.times,
        episode.position,
        episode.velocity,
        episode.radius,
        episode.active,
        robot,
        np.array(goal.position),
        goal.tolerance,
        heading=episode.heading[:, robot],
        walls=trial.stage.as_walls().segments(),
    )
    judged = ("success", "collision", "timeout", "time_to_goal")
    assert {key: value for key, value in logged.items() if key not in judged} == pytest.approx(
        {key: episode.metrics[key] for key in logged if key not in judged}, nan_ok=True, abs=1e-9
    )
    assert episode.metrics[episode.outcome] == 1.0
    assert sum(episode.metrics[word] for word in judged[:3]) == 1.0


def bits(values):
    """Return metrics as text with all digits."""
    return repr({key: float(value) for key, value in values.items()})


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.25, 2.0]), st.sampled_from([math.inf, 2.0]), st.booleans())
def test_a_whole_log_gives_the_bits_of_its_records(seed, tolerance, limit, known):
    times, paths, velocity, radius, active = random_log(seed)
    rng = stream(seed, "rest")
    heading = rng.uniform(-3, 3, active.shape) if known else np.full(active.shape, np.nan)
    radii = np.broadcast_to(radius, active.shape)
    log = AgentLog(times, paths, velocity, heading, radii, active)
    contact = rng.uniform(size=len(times)) < 0.02
    walls = rng.uniform(-3, 3, (3, 4))
    one, other, split = (
        NavigationMetrics(0, float(radius[0]), (1.0, 0.5), tolerance, walls=walls, time_limit=limit) for _ in range(3)
    )
    for states_, touched in zip(log.states(), contact.tolist(), strict=True):
        one.update(states_, touched)
    other.update_log(log, contact)
    half = len(times) // 2
    split.update_log(AgentLog(*(part[:half] for part in log)), contact[:half])
    split.update_log(AgentLog(*(part[half:] for part in log)), contact[half:])
    assert one.outcome == other.outcome == split.outcome
    assert bits(one.result()) == bits(other.result()) == bits(split.result())


@pytest.mark.parametrize(
    ("change", "message"),
    [("time", "1.0 s follows 1.0 s; time must increase"), ("robot", "robot 0 is absent at 1.0 s")],
)
def test_bad_logs_are_refused(change, message):
    place = np.zeros((3, 2, 2)) + 5.0
    times = np.array([0.0, 1.0, 1.0 if change == "time" else 2.0])
    active = np.array([[True, True], [change == "time", True], [True, True]])
    log = AgentLog(times, place, 0 * place, np.zeros((3, 2)), np.full((3, 2), 0.3), active)
    with pytest.raises(InputError, match=message):
        NavigationMetrics(0, 0.3, (0.0, 0.0), 0.2).update_log(log, np.zeros(3, dtype=bool))


def test_a_long_run_with_many_people_takes_little_memory():
    people, records = 200, 3000
    rng = np.random.default_rng(0)
    place, heading, radius = rng.uniform(-50.0, 50.0, (people, 2)), np.zeros(people), np.full(people, 0.25)
    place[0] = -60.0, -60.0  # nobody is near the robot
    metrics = NavigationMetrics(0, 0.3, (1e3, 0.0), tolerance=0.2)

    def update(begin, end):
        for k in range(begin, end):
            here = place + 1e-3 * k  # a new array for each record, as in a run
            metrics.update(AgentStates(0.1 * k, np.arange(people), here, np.ones((people, 2)), heading, radius))

    update(0, 50)
    tracemalloc.start()
    update(50, records)
    grown = tracemalloc.get_traced_memory()[0] / (records - 50)
    tracemalloc.stop()
    assert grown < 130.0, f"{grown:.0f} bytes per record"
    assert metrics.result()["duration"] == pytest.approx(0.1 * (records - 1))
