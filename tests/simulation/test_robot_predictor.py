"""A predictor named in a trial is the default of the forecast of the observation."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crowdbot import prediction
from crowdbot.core import InputError, TrialError, builtin_classes, stream
from crowdbot.navigation import DriveLimits, Observation, ObservationBatch, TrackHistory
from crowdbot.prediction import AnchorNet, ConstantVelocity, Kalman, LeastSquares, Simulated
from crowdbot.recording import branch, named_files, record, replay
from crowdbot.simulation import Simulation
from crowdbot.trials import RobotPredictor, Trial, parse_trial, trial_xml
from space_trials import LEAN, WORLDS, room
from trial_schema import valid

SHY = """
from dataclasses import dataclass

import numpy as np

import crowdbot as cb


@dataclass(frozen=True)
class Foresight(cb.Navigator):
    def act(self, observation):
        ahead = observation.forecast(seconds=0.8)
        away = np.hypot(*(ahead.position[0, 0][:, ahead.valid[0]] - observation.position).T)
        return observation.towards_goal(0.1 + 0.05 * away.min(initial=9.0))
"""
MINE = """
from dataclasses import dataclass

import numpy as np

import crowdbot as cb


@dataclass(frozen=True)
class Still(cb.Predictor):
    drift: float = 0.0

    def predict(self, past, steps, samples=1, rng=None):
        self.check(past, steps, samples)
        place = past.position[:, -1, None] + self.drift * np.arange(1, steps + 1)[:, None, None]
        return self.forecast(past, place[:, None])
"""


def text(predictor: str, world: str = "planar", navigator: str = "straight", **robot: str) -> str:
    """Return the room with a predictor for its robot."""
    words = "".join(f' {name.replace("_", "-")}="{value}"' for name, value in ({"tracks": "0.8"} | robot).items())
    whole = room(world, LEAN).replace('name="puck"', f'name="puck"{words}')
    whole = whole.replace('<navigator type="straight"/>', f'{predictor}<navigator type="{navigator}"/>')
    people = '<sensor name="all" type="ground-truth-people" visible-only="false" rate="25"/>'
    return whole.replace('<sensor name="scan"', people + '<sensor name="scan"')


def first(trial: Trial) -> Any:
    return trial.robots[0].predictor


def with_tracks(seed: int, environments: int = 5) -> ObservationBatch:
    """Return observations with tracks of random people; one environment has fewer rows."""
    rng, tracks = stream(seed, "tracks"), []
    for e in range(environments):
        history, count = TrackHistory.empty(12), int(rng.integers(0, 6))
        place, velocity = rng.normal(0.0, 3.0, (count, 2)), rng.normal(0.0, 1.0, (count, 2))
        for k in range(5 if e == 1 else 12):
            seen = np.flatnonzero(rng.random(count) < 0.9)
            history = history.update(0.4 * k, seen + 3, (place + 0.4 * k * velocity)[seen])
        tracks.append(history)
    return ObservationBatch(
        pose=np.zeros((environments, 3)), goal=np.ones((environments, 2)), radius=np.full(environments, 0.3),
        limits=DriveLimits(1.0, 1.0), dt=0.4, tracks=tracks,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("predictor", "built"),
    [
        ('<predictor type="constant-velocity" displacements="3"/>', ConstantVelocity(3)),
        ('<predictor type="kalman" step="0.08"/>', Kalman()),
        ('<predictor type="simulated" model="social-force"/>', Simulated("social-force")),
        ('<predictor type="anchor-net" fold="eth" sample="draws"/>', AnchorNet("eth", "draws")),
    ],
)
def test_it_is_read_written_and_built(predictor: str, built: Any) -> None:
    whole = text(predictor)
    assert valid(whole)
    trial = parse_trial(whole)
    assert first(trial).build() == built
    assert parse_trial(trial_xml(trial)) == trial
    alone = dataclasses.replace(trial.robots[0], predictor=built)
    assert alone.predictor == RobotPredictor(predictor=built)


@pytest.mark.parametrize("world", WORLDS)
def test_the_forecast_of_the_observation_uses_it(world: str) -> None:
    trial = parse_trial(text('<predictor type="least-squares" anchored="true" step="0.08"/>', world))
    simulation = Simulation(trial, [3, 4])
    for _ in range(12):
        simulation.advance()
    observation = simulation.observation("puck", 1)
    assert observation.tracks is not None
    named, given = observation.forecast(seconds=0.5), observation.forecast(LeastSquares(True), 0.5, dt=0.08)
    assert named.steps == 7
    assert named.dt == 0.08
    np.testing.assert_array_equal(named.position, given.position)
    assert observation.forecast().steps == 60
    assert observation.forecast(LeastSquares(True), 0.5).dt == pytest.approx(0.04)


@pytest.mark.parametrize("world", WORLDS)
def test_a_navigator_with_a_forecast_replays_branches_and_is_equal_in_a_batch(world: str, tmp_path: Path) -> None:
    (tmp_path / "shy.py").write_text(SHY)
    (tmp_path / "mine.py").write_text(MINE)
    whole = text('<predictor type="mine.py:Still" drift="0.01"/>', world, "shy.py:Foresight")
    trial = parse_trial(whole, folder=tmp_path)
    assert parse_trial(trial_xml(trial), folder=tmp_path) == trial
    assert {"mine.py", "shy.py"} <= set(named_files(trial))
    done = record(trial, 3, out=tmp_path / "a.mcap")
    assert replay(tmp_path / "a.mcap").equal
    assert branch(tmp_path / "a.mcap", at=0.4).digest == done.digest
    other = branch(tmp_path / "a.mcap", at=0.4, changes={"robot.predictor.drift": 5})
    assert other.digest != done.digest
    many, alone = Simulation(trial, [2, 3]), Simulation(trial, 3)
    for _ in range(10):
        many.advance()
        alone.advance()
    np.testing.assert_array_equal(many.record(1).commands, alone.record(0).commands)


def test_own_weights_lie_in_the_folder_of_the_trial(tmp_path: Path) -> None:
    source = Path(prediction.__file__).parent.parent / "assets" / "predictors" / "anchor-net-open.npz"
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "own.npz").write_bytes(source.read_bytes())
    (tmp_path / "out.npz").write_bytes(source.read_bytes())
    whole = text('<predictor type="anchor-net" weights="own.npz" step="0.4"/>', control_period="0.08", tracks="3.2")
    trial = parse_trial(whole.replace('control-period="0.04"', ""), folder=tmp_path / "in")
    assert first(trial).build().file == str(tmp_path / "in" / "own.npz")
    assert 'weights="own.npz"' in trial_xml(trial)
    assert named_files(trial)["own.npz"][0] == "data"
    done = record(trial, 1, out=tmp_path / "run" / "a.mcap")
    assert replay(tmp_path / "run" / "a.mcap").recorded == done.digest
    with pytest.raises(TrialError, match=r"weights=\"../out.npz\".* lies outside .*--trust"):
        parse_trial(whole.replace('control-period="0.04"', "").replace("own.npz", "../out.npz"), folder=tmp_path / "in")
    with pytest.raises(TrialError, match="there is no file 'gone.npz'"):
        parse_trial(whole.replace('control-period="0.04"', "").replace("own.npz", "gone.npz"), folder=tmp_path / "in")


@pytest.mark.parametrize("name", sorted(builtin_classes(prediction, prediction.Predictor)))
@pytest.mark.parametrize("samples", [1, 5])
def test_the_batch_is_equal_to_the_forecast_of_each_environment(name: str, samples: int) -> None:
    predictor, batch = builtin_classes(prediction, prediction.Predictor)[name](), with_tracks(4)
    whole = batch.forecast(predictor, 2.0, samples=samples, seed=3)
    assert len(whole) == 5
    for k in range(5):
        one = batch.environment(k).forecast(predictor, 2.0, samples=samples, seed=3)
        _, K, T, A, _ = one.position.shape
        np.testing.assert_array_equal(whole.position[k, :K, :T, :A], one.position[0])
        np.testing.assert_array_equal(whole.valid[k, :A], one.valid[0])
        assert not whole.valid[k, A:].any()
        np.testing.assert_array_equal(whole.weight[k, :K], one.weight[0])
        if one.covariance is not None:
            assert whole.covariance is not None
            np.testing.assert_array_equal(whole.covariance[k, :T, :A], one.covariance[0])
        if one.future_covariance is not None:
            np.testing.assert_array_equal(whole.mixture().covariance[k, :K, :T, :A], one.mixture().covariance[0])
            np.testing.assert_array_equal(whole.mixture().weight[k, :K, :A], one.mixture().weight[0])


def test_a_built_in_predictor_is_called_once_for_environments_with_equally_many_rows(monkeypatch: Any) -> None:
    calls, batch = [], with_tracks(4)
    plain = ConstantVelocity.predict

    def predict(self: Any, past: Any, *others: Any) -> Any:
        calls.append(len(past))
        return plain(self, past, *others)

    monkeypatch.setattr(ConstantVelocity, "predict", predict)
    batch.forecast(ConstantVelocity(), 1.0)
    assert sorted(calls) == [1, 4]


@pytest.mark.parametrize(
    ("predictor", "sentence"),
    [
        ('<predictor type="constant-velocty"/>', "did you mean 'constant-velocity'"),
        ('<predictor type="kalman" sped="1"/>', "has no attribute 'sped', did you mean 'speed'"),
        ('<predictor type="constant-velocity" displacements="0"/>', "displacements = 0 must be at least 1"),
        ('<predictor type="kalman" weights="a.npz"/>', 'has weights="a.npz", but kalman takes none'),
        ('<predictor type="kalman" step="0.1"/>', "no multiple of its control period of 0.04 s"),
        ('<predictor type="kalman" step="1.2"/>', 'tracks="0.8", which hold no earlier row'),
        ('<predictor type="simulated" goal="ground-truth"/>', "ground-truth has no default values"),
        ("<predictor/>", "needs the attribute 'type'"),
    ],
)
def test_messages_name_what_is_wrong(predictor: str, sentence: str) -> None:
    with pytest.raises(TrialError, match=sentence):
        parse_trial(text(predictor))


def test_a_predictor_needs_tracks_and_a_forecast_a_predictor() -> None:
    with pytest.raises(TrialError, match='has <predictor> but no tracks to predict from; add tracks="4"'):
        parse_trial(text('<predictor type="kalman"/>').replace(' tracks="0.8"', ""))
    observation = with_tracks(4).environment(0)
    with pytest.raises(InputError, match="pass one, or name it in the trial with <predictor>"):
        observation.forecast(seconds=1.0)
    with pytest.raises(InputError, match="is not a predictor"):
        observation.forecast("kalman", 1.0)  # type: ignore[arg-type]
    assert isinstance(observation, Observation)
