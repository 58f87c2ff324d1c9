"""Model-predictive control keeps the probability of contact with people of a Gaussian mixture below a limit."""

import dataclasses

import numpy as np
import pytest
from scipy.stats import ncx2

from crowdbot.core import InputError, Pose, TrialError, Twist, Walls
from crowdbot.data import Forecast
from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods
from crowdbot.navigation import DriveLimits, MPCNavigator, Observation, TrackHistory, VisiblePeople
from crowdbot.prediction import AnchorNet, ConstantVelocity, Kalman, Predictor
from crowdbot.simulation import simulate_seeds
from crowdbot.trials import load_trial
from crowdbot.world import DifferentialDrive, Twists

LIMITS = DriveLimits(1.0, 1.5, 1.0, 3.0)
RADII = 0.55
PREDICTED = {"robot/tracks": 3.2, "robot/predictor/type": "anchor-net", "robot/predictor/step": 0.4}
CAREFUL = {"robot/navigator/type": "mpc", "robot/navigator/mixture": True, "robot/navigator/samples": 20}


@dataclasses.dataclass(frozen=True)
class Modes(Predictor):
    """Expects each person at one of some places beside the newest position, with a normal error."""

    places: tuple[tuple[float, float], ...]
    weights: tuple[float, ...]
    variance: tuple[float, float] = (0.01, 0.01)

    def predict(self, past, steps, samples, rng):
        here, valid = past.position[:, None, -1:], past.present[:, -1]
        position = np.repeat(here + np.array(self.places)[None, :, None, None], steps, axis=2)
        shape = (*position.shape, 2)
        own = np.repeat(np.array(self.weights)[None, :, None], valid.shape[1], axis=2)
        return dataclasses.replace(
            Forecast.of(position, valid, past.dt, "modes"),
            weight=np.array([self.weights]),
            person_weight=own,
            future_covariance=np.broadcast_to(np.diag(self.variance), shape).copy(),
        )


def observe(predictor, person=(3.0, 0.0), steps=9, **changes):
    """Return what a robot at the origin knows, which drives along x to a person who has stood for 0.1 s a step."""
    tracks = TrackHistory.empty()
    for k in range(steps):
        tracks = tracks.update(0.1 * (k - steps + 1), [4], [person])
    known = {"pose": (0.0, 0.0, 0.0), "goal": (8.0, 0.0), "radius": 0.3, "limits": LIMITS, "dt": 0.1}
    known |= {"twist": Twist(0.9), "predictor": predictor, "tracks": tracks}
    known["people"] = VisiblePeople(np.array([person]), np.zeros((1, 2)), np.array([0.25]), np.array([4]))
    return Observation(**(known | changes))


def drive(navigator, predictor, seconds=7.5, **changes):
    """Return the path ``[T, 2]`` of a robot past the person, who stays."""
    vehicle, pose, twist, path = (
        DifferentialDrive(1.0, 1.5, 1.0, 3.0),
        Pose.of((0.0, 0.0), 0.0),
        Twists.of(Twist(), 1),
        [],
    )
    for _ in range(round(seconds / 0.1)):
        x, y = pose.position[0].tolist()
        seen = observe(predictor, pose=(x, y, float(pose.heading[0])), twist=twist.at(0), **changes)
        pose, twist = vehicle.step(pose, twist, navigator.act(seen), 0.1)
        path.append(pose.position[0].copy())
    return np.array(path)


def contact(path, predictor, person=(3.0, 0.0)):
    """Return the largest probability that the robot touches the person at an instant of a path, exactly."""
    total = 0.0
    for place, weight in zip(predictor.places, predictor.weights, strict=True):
        away = np.linalg.norm(path - person - place, axis=1)
        variance = predictor.variance[0]
        total = total + weight * ncx2.cdf(RADII**2 / variance, 2, away**2 / variance)
    return float(np.max(total))


BOTH = Modes(((0.0, 0.7), (0.0, -0.7)), (0.6, 0.4))
LEFT = Modes(((0.0, 0.7),), (1.0,))


def test_the_plan_keeps_away_from_both_modes_of_a_person():
    careful = MPCNavigator(mixture=True, chance=0.05)
    around = drive(careful, BOTH)
    past_left = drive(careful, LEFT)
    assert contact(around, BOTH) <= 0.05
    assert contact(past_left, BOTH) > 0.3  # through the place of the other mode
    assert contact(past_left, LEFT) <= 0.05
    assert around[-1, 0] > 5.0


@pytest.mark.parametrize("chance", [0.02, 0.1, 0.3])
def test_the_limit_holds_for_the_exact_probability(chance):
    # costs of people that do not matter leave only the limit
    path = drive(MPCNavigator(mixture=True, chance=chance, risk=0.0, comfort=0.0), BOTH)
    assert contact(path, BOTH) <= chance


def test_a_mode_less_probable_than_the_limit_does_not_stop_a_plan():
    seldom = dataclasses.replace(BOTH, weights=(0.98, 0.02))
    path = drive(MPCNavigator(mixture=True, chance=0.05, risk=0.0, comfort=0.0), seldom)
    assert contact(path, seldom) <= 0.05
    assert contact(path, dataclasses.replace(BOTH, weights=(0.0, 1.0))) > 0.5


def test_only_the_spread_towards_the_robot_counts():
    beside = {"person": (2.0, 1.0)}
    careful = MPCNavigator(mixture=True, chance=0.01, risk=0.0, comfort=0.0)
    here = ((0.0, 0.0),)
    along, across = (careful.act(observe(Modes(here, (1.0,), v), **beside)) for v in ((0.09, 1e-4), (1e-4, 0.09)))
    assert along == Twist(1.0, 0.0)
    assert across.turn < 0.0 or across.forward < 1.0


def test_without_a_plan_below_the_limit_the_least_probable_contact_is_taken():
    near = observe(LEFT, person=(0.7, -0.7), twist=Twist(0.3))
    free = MPCNavigator(mixture=True, risk=0.0, comfort=0.0)
    assert free.act(near).forward > 0.5
    assert dataclasses.replace(free, chance=1e-9).act(near).forward < 0.5


def test_no_way_out_leads_through_a_wall():
    walls = Walls.of([[(-2.0, 0.5), (9.0, 0.5)], [(-2.0, -0.5), (9.0, -0.5)]])
    path = drive(MPCNavigator(mixture=True, chance=1e-6), BOTH, walls=walls)
    assert np.abs(path[:, 1]).max() < 0.2
    assert path[-1, 0] < 2.6


def test_the_mixture_replaces_growth_and_people_without_forecast_keep_it():
    careful, seen = MPCNavigator(mixture=True, chance=0.05), observe(BOTH)
    assert careful.act(seen) == dataclasses.replace(careful, growth=0.5).act(seen)
    new = dataclasses.replace(seen, people=dataclasses.replace(seen.people, ids=np.array([9])))
    assert careful.act(new) == dataclasses.replace(careful, mixture=False).act(new)


@pytest.mark.parametrize("predictor", [AnchorNet(), Kalman()], ids=["anchor-net", "kalman"])
def test_decisions_repeat(predictor):
    careful = MPCNavigator(mixture=True, samples=20, chance=0.05)
    seen = observe(predictor, predictor_step=0.4)
    assert careful.act(seen) == careful.act(seen)
    assert careful.act(seen) != careful.act(observe(predictor, people=VisiblePeople.none()))


def test_runs_are_equal_in_batches_and_alone():
    trial = load_trial("circle-crossing", duration=0.8, **PREDICTED, **CAREFUL, **{"robot/navigator/chance": 0.1})
    together = simulate_seeds(trial, range(2))
    (alone,) = simulate_seeds(trial, range(1, 2))
    assert together[1].digest == alone.digest
    assert together[1].failure is None


def test_an_evaluation_compares_sources_of_uncertainty():
    methods = parse_methods(
        "mpc uncertainty=0.001 growth=0 chance=0.1, mpc chance=0.1, mpc mixture=true samples=20 chance=0.1"
    )
    plan = EvaluationPlan([load_trial("circle-crossing", duration=1.5, **PREDICTED)], methods, seeds=[3])
    cells = evaluate(plan).cells
    assert [cell.estimate("error-rate").value for cell in cells] == [0.0] * 3
    assert len({run.digest for cell in cells for run in cell.runs}) == 3


def test_what_is_missing_is_named():
    careful = MPCNavigator(mixture=True)
    with pytest.raises(InputError, match='no predictor; add <predictor type="anchor-net"/>'):
        careful.act(observe(None))
    with pytest.raises(InputError, match="forecast of constant-velocity has no covariance; take a predictor with"):
        careful.act(observe(ConstantVelocity()))
    with pytest.raises(TrialError, match='mixture="true"/> but no predictor; add tracks="3.2"'):
        load_trial("circle-crossing", **CAREFUL)
    for chance in (0.0, 1.1):
        with pytest.raises(InputError, match=f"MPCNavigator: chance = {chance}"):
            MPCNavigator(chance=chance)
