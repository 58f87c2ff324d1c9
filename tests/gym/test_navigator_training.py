"""The training of the policy: estimates, updates, the same weights twice and after interruptions, wrong input."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.gym import NavigatorTraining, PPOSettings, TrainingTask, standard_tasks, train_navigator
from crowdbot.gym.training.policy_network import PolicyNetwork
from crowdbot.gym.training.ppo_update import update_policy
from crowdbot.gym.training.rollouts import PolicyRollout, advantages, to_speeds
from crowdbot.navigation import PolicyWeights
from crowdbot.navigation.planners.policy_kernels import apply_network

TASKS = (TrainingTask("crowdnav-circle-5", 3, {"people": 2}), TrainingTask("crowdnav-square-5", 2, {"people": 3}))
SMALL = PPOSettings(rounds=3, updates=2, steps=6, epochs=2, batches=2, seed=5)


def weights_of(folder: Path) -> list[bytes]:
    return [value.tobytes() for value in PolicyWeights.read(folder / "policy.npz")[0]]


def test_the_same_training_gives_the_same_weights_to_the_last_bit(tmp_path: Path) -> None:
    rows = []
    for name in ("a", "b"):
        training = train_navigator(TASKS, SMALL, tmp_path / name, cases=4)
        rows.append([{k: v for k, v in row.items() if "seconds" not in k} for row in training.rows])
    assert weights_of(tmp_path / "a") == weights_of(tmp_path / "b")
    assert rows[0] == rows[1]
    score = training.score
    assert [row["trial"] for row in score] == ["crowdnav-circle-5 people=2", "crowdnav-square-5 people=3"]
    assert all(sum(float(row[name]) for name in ("success", "collision", "timeout")) == 1.0 for row in score)
    assert PolicyWeights.read(tmp_path / "b" / "policy.npz")[1]["score"] == score
    assert rows[0][-1]["steps"] == 3 * 2 * 6 * 5
    other = train_navigator(TASKS, PPOSettings(**{**vars(SMALL), "seed": 6}), tmp_path / "c", cases=0)
    assert weights_of(tmp_path / "c") != weights_of(tmp_path / "a")
    assert other.done == 3


def test_an_interrupted_training_resumes_with_the_same_end(tmp_path: Path) -> None:
    train_navigator(TASKS, SMALL, tmp_path / "whole", cases=0)

    def stop(row: dict[str, float], rounds: int) -> None:
        raise KeyboardInterrupt

    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            train_navigator(
                TASKS, SMALL, tmp_path / "part", resume=(tmp_path / "part" / "last.npz").is_file(), report=stop
            )
    done = train_navigator(TASKS, SMALL, tmp_path / "part", resume=True, cases=0)
    assert done.done == 3
    assert weights_of(tmp_path / "part") == weights_of(tmp_path / "whole")
    with (tmp_path / "part" / "log.csv").open() as log:
        assert len(log.readlines()) == 4
    with pytest.raises(InputError, match="is a training with other tasks or settings"):
        train_navigator(TASKS[:1], SMALL, tmp_path / "part", resume=True)


def test_advantages_equal_the_sum_of_discounted_differences() -> None:
    rng = np.random.default_rng(1)
    T, E = 12, 4
    reward, value = (rng.normal(size=(T, E)).astype(np.float32) for _ in range(2))
    end, last = rng.random((T, E)) < 0.2, rng.normal(size=E).astype(np.float32)
    found = advantages(reward, end, value, last, SMALL)
    after = np.concatenate([value[1:], last[None]])
    delta = reward + SMALL.discount * np.where(end, 0.0, after) - value
    for e in range(E):
        for t in range(T):
            whole, factor = 0.0, 1.0
            for s in range(t, T):
                whole += factor * delta[s, e]
                if end[s, e]:
                    break
                factor *= SMALL.discount * SMALL.trace
            assert found[t, e] == pytest.approx(whole, abs=1e-4)


def make_network() -> PolicyNetwork:
    return PolicyNetwork(torch.Generator().manual_seed(3), 0.5)


def random_inputs(count: int, seed: int = 2) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    own, people = rng.normal(size=(count, 6)), rng.normal(size=(count, 4, 11))
    return own.astype(np.float32), people.astype(np.float32), rng.integers(0, 5, (count, 1)).astype(np.float32)


def test_the_navigator_has_the_network_of_the_training() -> None:
    network, inputs = make_network(), random_inputs(7)
    with torch.no_grad():
        expected = network.heads(network.pool(*map(torch.from_numpy, inputs)))[0].numpy()
    out = np.zeros((7, 2))
    own, people, present = inputs
    arrays = (own.astype(np.float64), people.astype(np.float64), present[:, 0].astype(np.int64))
    apply_network(np.ones(7, bool), *arrays, out, *network.weights().layers())
    np.testing.assert_allclose(out, expected, atol=1e-5)


def test_an_update_makes_good_actions_more_likely() -> None:
    network, (own, people, present) = make_network(), random_inputs(64)
    with torch.no_grad():
        mean, value = network.heads(network.pool(*map(torch.from_numpy, (own, people, present))))
    noise = np.random.default_rng(0).normal(size=(64, 2)).astype(np.float32)
    action = mean.numpy() + 0.5 * noise
    chance = -0.5 * (noise**2).sum(axis=1) - 2 * np.log(np.float32(0.5))
    rows = (own, people, present, action, chance, value.numpy(), noise[:, 0])
    rollout = PolicyRollout(*[row[None].astype(np.float32) for row in rows])
    optimizer = torch.optim.Adam([*network.layers.values()], lr=1e-3)
    settings = PPOSettings(rounds=1, epochs=10, batches=2)
    losses = update_policy(network, optimizer, [rollout], settings, np.random.default_rng(0))
    with torch.no_grad():
        after = network.heads(network.pool(*map(torch.from_numpy, (own, people, present))))[0]
    assert losses["policy_loss"] < 0.0
    assert (after - mean).numpy()[:, 0].mean() > 0.02


def test_actions_in_the_goal_frame_are_turned_and_limited() -> None:
    turn = np.array([[0.0, 1.0], [1.0, 0.0]], np.float32)
    found = to_speeds(np.array([[1.0, 0.0], [3.0, 4.0]], np.float32), turn)
    np.testing.assert_allclose(found, [[0.0, 1.0], [0.6, 0.8]], atol=1e-7)


def test_the_standard_tasks_have_five_to_twenty_people() -> None:
    training = NavigatorTraining(standard_tasks(16), SMALL)
    people = [task.observation.max_people for task in training.crowd_tasks]
    assert min(people) <= 5
    assert max(people) == 20


def words(folder: Path, *more: str) -> list[str]:
    return ["train", "navigator", "--trials", "crowdnav-circle-5 people=2", "--environments", "3", "--rounds", "2",
            "--out", str(folder), "--set", "steps=4", "updates=1", "batches=2", *more]  # fmt: skip


def test_the_command_trains_and_resumes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words(tmp_path / "a", "--json")) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["rounds"] == 2
    assert told["log"][-1]["steps"] == 2 * 4 * 3
    assert told["score"][0]["trial"] == "crowdnav-circle-5 people=2"
    card = PolicyWeights.read(Path(told["weights"]))[1]
    assert card["command"].startswith('crowdbot train navigator --trials "crowdnav-circle-5 people=2" --rounds 2')
    assert main(words(tmp_path / "a")) == 2
    assert "has a training; add --resume" in capsys.readouterr().err
    assert main(words(tmp_path / "a", "--resume")) == 0
    assert "crowdbot evaluate crowdnav-circle-5" in capsys.readouterr().err
    assert main(words(tmp_path / "b", "--resume")) == 2
    assert "nothing to resume" in capsys.readouterr().err


@pytest.mark.parametrize(("more", "sentence"), [
    (["--data", "a.csv"], "--data is an option for predictors, not for 'navigator'"),
    (["--set", "step=3"], "unknown setting 'step', did you mean 'steps'?"),
    (["--set", "steps=many"], "--set steps=many must be a number"),
    (["--set", "discount=2"], "discount = 2 must be from 0 to 1"),
    (["--rounds", "0"], "rounds = 0 must be at least 1"),
    (["--environments", "0"], "--environments 0 must be at least 1"),
    (["--trials", " , "], "--trials names no trial"),
])  # fmt: skip
def test_wrong_options_are_refused(
    more: list[str], sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["train", "navigator", "--out", str(tmp_path / "out"), *more]) == 2
    assert sentence in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_predictors_need_recordings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["train", "anchor-net", "--out", str(tmp_path)]) == 2
    assert "needs recordings: give --data PATH" in capsys.readouterr().err
    assert main(["train", "social-ways", "--out", str(tmp_path), "--rounds", "3"]) == 2
    assert "--rounds is an option for the navigator, not for 'social-ways'" in capsys.readouterr().err


def test_a_task_without_environments_is_refused() -> None:
    with pytest.raises(InputError, match="environments = 0 must be at least 1"):
        TrainingTask("crowdnav-circle-5", 0)
    with pytest.raises(InputError, match="task 'frontal': the first robot must have holonomic"):
        NavigatorTraining([TrainingTask("frontal", 2)], SMALL)
    with pytest.raises(InputError, match="at least one task"):
        NavigatorTraining((), SMALL)
