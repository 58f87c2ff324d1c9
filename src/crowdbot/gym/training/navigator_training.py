"""The training of the policy in rounds; an interrupted training resumes with bitwise identical results."""

from __future__ import annotations

import csv
import dataclasses
import json
import os
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import InputError
from crowdbot.navigation import PolicyWeights
from crowdbot.prediction import load_checkpoint, save_checkpoint, torch_module, torch_threads

from .policy_network import PolicyNetwork
from .policy_score import score_policy
from .policy_task import TrainingTask
from .ppo_settings import PPOSettings
from .ppo_update import update_policy
from .rollouts import Counts, TaskRunner

__all__ = ["CHECKPOINT", "LOG", "POLICY_FILE", "NavigatorTraining", "TrainingRow", "train_navigator"]

CHECKPOINT, POLICY_FILE, LOG = "last.npz", "policy.npz", "log.csv"
"""Files in the folder of a training: its state, the weights of the navigator, and the log."""
KIND = "policy training"

TrainingRow = dict[str, float]
"""Row of the log: round, steps, shares of outcomes in the training, losses, spread, wall and processor time [s]."""


class NavigatorTraining:
    """The policy with its optimiser and tasks, between two rounds.

    Args:
        tasks: trials with their numbers of environments.
        settings: numbers of the training.

    Raises:
        MissingExtra: PyTorch is not installed.
    """

    def __init__(self, tasks: Sequence[TrainingTask], settings: PPOSettings) -> None:
        torch = torch_module()
        if not tasks:
            raise InputError("a training needs at least one task")
        self.tasks, self.settings = tuple(tasks), settings
        self.network = PolicyNetwork(torch.Generator().manual_seed(settings.seed), settings.spread)
        self.optimizer = torch.optim.Adam([*self.network.layers.values()], lr=settings.learning_rate, eps=1e-5)
        self.crowd_tasks = [task.crowd_task(settings.reward) for task in self.tasks]
        self.done, self.rows = 0, list[TrainingRow]()
        self.score: list[dict[str, str | float]] = []

    @property
    def plan(self) -> str:
        """Tasks and settings as JSON, by which a resumed training is recognised."""
        tasks = [[one.trial, one.environments, dict(one.values)] for one in self.tasks]
        return json.dumps({"tasks": tasks, "settings": dataclasses.asdict(self.settings)}, sort_keys=True)

    def run_round(self) -> TrainingRow:
        """Train for one round and return the row of the log."""
        settings, begin, busy = self.settings, time.perf_counter(), time.process_time()
        counts, losses, steps = Counts(), dict[str, float](), 0
        runners = [
            TaskRunner(task, one.environments, np.random.default_rng([settings.seed, self.done, k]))
            for k, (task, one) in enumerate(zip(self.crowd_tasks, self.tasks, strict=True))
        ]
        rng = np.random.default_rng([settings.seed, self.done, len(runners)])
        for k in range(settings.updates):
            share = (self.done + k / settings.updates) / settings.rounds
            for group in self.optimizer.param_groups:
                group["lr"] = settings.learning_rate * (1.0 - share)
            rollouts = [runner.run(self.network, settings, counts) for runner in runners]
            losses = update_policy(self.network, self.optimizer, rollouts, settings, rng)
            steps += sum(one.value.size for one in rollouts)
        self.done += 1
        earlier = self.rows[-1] if self.rows else {}
        row = {
            "round": float(self.done),
            "steps": earlier.get("steps", 0.0) + steps,
            **{name: counts.share(name) for name in ("success", "collision", "timeout")},
            **losses,
            "spread": float(np.exp(self.network.spread.detach().numpy()).mean()),
            "seconds": earlier.get("seconds", 0.0) + time.perf_counter() - begin,
            "cpu_seconds": earlier.get("cpu_seconds", 0.0) + time.process_time() - busy,
        }
        self.rows.append(row)
        return row

    def weights(self) -> PolicyWeights:
        """Return the weights of the navigator now."""
        return self.network.weights()

    def save(self, folder: Path, **card: Any) -> None:
        """Write the state, the weights of the navigator with more values for their card, and the log."""
        moments = self.optimizer.state_dict()["state"]
        state = {
            "plan": self.plan,
            "done": self.done,
            "rows": self.rows,
            "layers": {name: value.detach().numpy() for name, value in self.network.layers.items()},
            "moments": {str(k): {name: np.asarray(v) for name, v in one.items()} for k, one in moments.items()},
        }
        save_checkpoint(folder / CHECKPOINT, KIND, state)
        self.weights().save(folder / POLICY_FILE, {"plan": self.plan, "rounds": self.done, **card})
        draft = folder / f"{LOG}.part"
        with draft.open("w", newline="", encoding="utf-8") as stream:
            table = csv.DictWriter(stream, list(self.rows[-1]) if self.rows else ["round"])
            table.writeheader()
            table.writerows(self.rows)
        os.replace(draft, folder / LOG)

    def restore(self, folder: Path) -> None:
        """Continue with the state in a folder.

        Raises:
            InputError: there is no state, or it has other tasks or settings.
        """
        torch = torch_module()
        state = load_checkpoint(folder / CHECKPOINT, KIND)
        if state["plan"] != self.plan:
            raise InputError(
                f"{folder / CHECKPOINT} is a training with other tasks or settings; give the same ones, or another"
                " folder"
            )
        with torch.no_grad():
            for name, value in self.network.layers.items():
                value.copy_(torch.from_numpy(np.array(state["layers"][name])))
        whole = self.optimizer.state_dict()
        whole["state"] = {
            int(k): {name: torch.from_numpy(np.array(v)) for name, v in one.items()}
            for k, one in state["moments"].items()
        }
        self.optimizer.load_state_dict(whole)
        self.done, self.rows = int(state["done"]), [dict(row) for row in state["rows"]]


def train_navigator(
    tasks: Sequence[TrainingTask],
    settings: PPOSettings,
    folder: Path,
    *,
    resume: bool = False,
    threads: int = 1,
    cases: int = 200,
    command: str = "",
    report: Callable[[TrainingRow, int], Any] | None = None,
) -> NavigatorTraining:
    """Train the policy and write its state, weights and log to a folder after each round.

    With one thread, the same tasks and settings give the same weights to the last bit, also after interruptions. At the
    end, the card of the weights gets the score in unseen cases, see :func:`score_policy`.

    Args:
        tasks: trials with their numbers of environments.
        settings: numbers of the training.
        folder: output folder; created if missing.
        resume: whether to continue the training in the folder.
        threads: number of PyTorch threads.
        cases: number of unseen cases of each task for the score; 0 for no score.
        command: command for the card.
        report: called with each row of the log and the number of rounds.

    Raises:
        InputError: the folder has no training to resume, or one with other tasks or settings.
        MissingExtra: PyTorch is not installed.
    """
    with torch_threads(threads):
        training = NavigatorTraining(tasks, settings)
        if resume:
            training.restore(folder)
            training.save(folder, command=command)  # a killed training can have weights older than its state
        folder.mkdir(parents=True, exist_ok=True)
        while training.done < settings.rounds:
            row = training.run_round()
            training.save(folder, command=command)
            if report is not None:
                report(row, settings.rounds)
    if cases:
        training.score = score_policy(folder / POLICY_FILE, training.tasks, cases)
        training.save(folder, command=command, score=training.score)
    return training
