"""The trials of CrowdNav: layouts, full state, and the published results of ORCA."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.core.fields import Points
from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods
from crowdbot.simulation import Simulation, simulate, simulate_seeds
from crowdbot.trials import PeopleBatch, PlacementPlan, Spawner, Stage, Trial, Wall, load_trial, place
from samples import sizes

SQUARE = Points.of([(-4, -4), (4, -4), (4, 4), (-4, 4)])
ORCA = "orca share=0.5 time-horizon=5 neighbor-distance=10 max-neighbors=10 reaction=0.25"


def layout(name: str = "circle", count: int = 5, **more: object) -> Spawner:
    """Return a spawner with a layout."""
    values: dict[str, object] = {"zone": SQUARE, "goal": SQUARE, "arrival": "stay", "radius": 0.3} | more
    return Spawner(count=count, layout=name, **values)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["crowdnav-circle-5", "crowdnav-circle-20", "crowdnav-square-10"])
def test_people_of_a_layout_are_clear_of_each_other_and_of_the_robot(name: str) -> None:
    trial = load_trial(name)
    plan = PlacementPlan.of(trial.stage, trial.spawners, trial.robots)
    people = plan.place(range(20))
    assert isinstance(people, PeopleBatch)
    robot = trial.robots[0]
    ends = [(people.position, robot.position), (people.goal, robot.goal.position)]
    for points, own in ends:
        whole = np.concatenate([points, np.broadcast_to(np.array(own), (20, 1, 2))], axis=1)
        away = np.hypot(*(whole[:, :, None] - whole[:, None]).transpose(3, 0, 1, 2))
        away[:, *np.diag_indices(away.shape[1])] = np.inf
        assert away.min() >= 0.6 + 0.2 - 1e-12


def test_people_on_the_circle_go_to_the_opposite_point() -> None:
    people, problems = place(Stage(), [layout(noise=0.5)], [], seed=3)
    assert not problems
    assert np.array_equal(people.goal, -people.position)
    off = np.abs(np.hypot(*people.position.T) - 4.0)
    assert 0.0 < off.max() <= 0.5 * np.sqrt(2.0)
    exact, _ = place(Stage(), [layout(noise=0.0)], [], seed=3)
    assert np.hypot(*exact.position.T) == pytest.approx(np.full(5, 4.0))


def test_people_in_halves_change_sides() -> None:
    people, _ = place(Stage(), [layout("halves", 12)], [], seed=3)
    assert np.all(people.position[:, 0] * people.goal[:, 0] <= 0.0)
    assert set(np.sign(people.position[:, 0])) == {-1.0, 1.0}


def test_many_seeds_are_placed_as_each_alone() -> None:
    trial = load_trial("crowdnav-circle-10")
    plan = PlacementPlan.of(trial.stage, trial.spawners, trial.robots)
    many = plan.place([5, -2, 2**52])
    assert isinstance(many, PeopleBatch)
    for k, seed in enumerate([5, -2, 2**52]):
        alone, _ = place(trial.stage, trial.spawners, trial.robots, seed)
        own = many.environment(k)
        for field in ("position", "goal", "radius", "speed"):
            assert np.array_equal(getattr(own, field), getattr(alone, field))


def test_too_many_people_for_the_circle_are_reported() -> None:
    people, problems = place(Stage(), [layout(count=60)], [], seed=1)
    assert len(people) < 60
    assert "of 60 people fit" in problems[0][1]
    wall = Stage(walls=(Wall(Points.of([(-9, 0), (9, 0)])),))
    assert any(place(wall, [layout(count=20, noise=0.5)], [], seed=s)[1] for s in range(5))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"arrival": "leave"}, 'layout="circle" needs a goal zone and arrival="stay"'),
        ({"layout": "halves", "noise": 0.2}, 'noise acts with layout="circle" only'),
        ({"groups": [{}]}, "groups"),
        ({"layout": "ring"}, "must be zone or circle or halves"),
    ],
)
def test_what_does_not_go_with_a_layout_is_reported(values: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        dataclasses.replace(layout(), **values)  # type: ignore[arg-type]


def test_people_begin_at_rest_and_the_robot_sees_all_of_them() -> None:
    trial = load_trial("crowdnav-circle-10")
    simulation = Simulation(trial, 4)
    assert np.all(simulation.world.scene.velocity == 0.0)
    walking = Simulation(load_trial("circle-crossing"), 4).world.scene
    assert np.hypot(*walking.velocity[0, :5].T) == pytest.approx(np.ones(5))
    simulation.begin()
    seen = simulation.observation("robot").people
    assert len(seen) == 10
    assert np.array_equal(seen.position, simulation.world.scene.position[0, :10])


def test_a_batch_gives_the_episodes_of_its_seeds() -> None:
    trial = load_trial("crowdnav-circle-5", duration=8.0)
    assert [seed.digest for seed in simulate_seeds(trial, [1, 2, 3])] == [simulate(trial, s).digest for s in (1, 2, 3)]


def published(trial: Trial, method: str, cases: int) -> tuple[float, float, float]:
    """Return shares of success and of collisions, and the mean time of successful runs."""
    result = evaluate(EvaluationPlan([trial], parse_methods(method), seeds=range(cases)))
    cell = result.cells[0]
    return tuple(cell.estimate(name).value for name in ("success-rate", "collision-rate", "time-to-goal"))  # type: ignore[return-value]


def success_rate(trial: Trial, cases: int) -> float:
    """Return the share of successes of the navigator of the trial, without the other metrics."""
    return float(np.mean([episode.outcome == "success" for episode in simulate_seeds(trial, range(cases))]))


@pytest.mark.parametrize("cases", sizes(120, 500))
def test_orca_has_its_published_results(cases: int) -> None:
    trial = load_trial("crowdnav-circle-5")
    success, collision, time = published(trial, f"{ORCA} safety=0.02", cases)
    assert (success, collision, time) == pytest.approx((0.426, 0.568, 10.86), abs=0.3)
    assert (success, collision) == pytest.approx((0.426, 0.568), abs=0.07)
    success, _, _ = published(trial, f"{ORCA} safety=0.32", cases)
    assert success == pytest.approx(0.904, abs=0.04)
    assert published(trial, "straight", cases)[0] == pytest.approx(0.026, abs=0.025)
    assert success_rate(load_trial("crowdnav-circle-5", visible=True), cases) == 1.0


def test_success_rises_with_the_attention_of_people() -> None:
    rates = []
    for attention in (0.0, 0.5, 1.0):
        trial = load_trial("attention-ladder", attention=attention)
        rates.append(success_rate(trial, 120))
    assert rates[0] < 0.5 < rates[2]
    assert rates[0] < rates[1] < rates[2]
