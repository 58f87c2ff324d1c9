"""Demo: run a built-in trial, predict its people and write a report."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.core import InputError, kebab_case
from crowdbot.recording import run

from .demo_report import PredictionResult, write_demo_report

if TYPE_CHECKING:
    from crowdbot.calibration import Fit
    from crowdbot.data import Windows
    from crowdbot.metrics import Score
    from crowdbot.simulation import Episode
    from crowdbot.trials import Trial


TRIAL = "crossing-flows"
STEP = 0.4
"""Time step of the predictions [s], as in the ETH and UCY benchmarks."""
OBSERVE, PREDICT = 8, 12
NEAR = 5.0
"""People within this distance [m] of the robot are predicted."""
OTHER_SEED = 1000
"""Added to the seed of the demo for the crowd used in the calibration."""
BUDGET = 64


@dataclass(frozen=True)
class Demo:
    """Result of the demo: the episode, the scores of the predictors and the files."""

    episode: Episode
    scores: tuple[Score, ...]
    episode_file: Path
    report_file: Path
    caption: str

    def as_dict(self) -> dict[str, Any]:
        """Return the output of ``crowdbot demo --json``."""
        return {
            "trial": self.episode.trial.name,
            "seed": self.episode.seed,
            "outcome": self.episode.outcome,
            "digest": self.episode.digest,
            "metrics": self.episode.metrics,
            "prediction": {score.predictor: score.as_dict() for score in self.scores},
            "episode": str(self.episode_file),
            "report": str(self.report_file),
        }


def run_demo(
    out: Path,
    seed: int | None = None,
    progress: Callable[[str, float], None] | None = None,
    force: bool = False,
) -> Demo:
    """Run ``crossing-flows``, predict the people near its robot and write ``episode.mcap`` and ``report.html``.

    Args:
        out: folder of the results; created if missing.
        seed: random seed (default: the seed of the trial).
        progress: called with the name of the current task and the completed fraction.
        force: whether existing files may be overwritten.

    Raises:
        InputError: the folder has one of the files and ``force`` is false.
    """
    from crowdbot.trials import load_trial

    report = progress or (lambda what, share: None)
    trial = load_trial(TRIAL)
    out.mkdir(parents=True, exist_ok=True)
    file, page = out / "episode.mcap", out / "report.html"
    if page.exists() and not force:
        raise InputError(f"{page} already exists; use another path, or --force (force=True) to overwrite it")
    episode = run(trial, seed=seed, out=file, progress=lambda share: report("1 run the trial", share), force=force)
    report("1 run the trial", 1.0)
    fit = _calibrate(trial, episode.seed + OTHER_SEED, lambda share: report("2 calibrate the simulated crowd", share))
    past, future = episode.tracks(STEP).windows(OBSERVE, PREDICT, near=NEAR)
    predicted = _predict(fit, past, future, episode.seed, lambda share: report("3 predict the people", share))
    report("4 write the report", 0.0)
    commands = _commands(out, episode, fit)
    page = write_demo_report(page, episode, past, future, predicted, commands, _describe_input(trial, fit))
    report("4 write the report", 1.0)
    scores = tuple(item.score for item in predicted)
    caption = f"protocol {scores[0].protocol}; people within {NEAR:g} m of the robot; means over persons"
    return Demo(episode, scores, file, page, caption)


def _calibrate(trial: Trial, seed: int, progress: Callable[[float], None]) -> Fit:
    """Fit one ORCA parameter set to another crowd of the same trial, without the scored people."""
    from crowdbot.calibration import Calibrator

    past, _ = run(trial, seed=seed).tracks(STEP).windows(PREDICT, 1)
    calibrator = Calibrator("orca", "absolute", "random-search", budget=BUDGET, shared=True)
    return calibrator.fit(past[::4], seed=seed, progress=progress)


def _predict(
    fit: Fit, past: Windows, future: Windows, seed: int, progress: Callable[[float], None]
) -> list[PredictionResult]:
    from crowdbot.core import stream
    from crowdbot.prediction import ConstantAcceleration, ConstantVelocity, Kalman, Simulated

    from .predictor_score import score_predictor

    prediction_results = []
    predictors = (ConstantVelocity(), ConstantAcceleration(), Kalman(), Simulated.of(fit))
    for number, predictor in enumerate(predictors, start=1):
        score = score_predictor(predictor, past, future, seed=seed)
        score = dataclasses.replace(score, predictor=predictor.name.partition("(")[0])  # parameters are listed below
        prediction_results.append(PredictionResult(predictor.predict(past, PREDICT, rng=stream(seed, "report")), score))
        progress(number / 4)
    return prediction_results


def _commands(out: Path, episode: Episode, fit: Fit) -> dict[str, str]:
    file = out / "episode.mcap"
    scored = f"crowdbot predict --data {file} --near {NEAR:g} --predictor"
    values = " ".join(f"{name.replace('_', '-')}={value!r}" for name, (value, _) in fit.table().items())
    return {
        f"crowdbot run {TRIAL} --seed {episode.seed} --out {out}": "the trial",
        f"crowdbot replay {file}": "the trial again, compared byte by byte",
        f"{scored} constant-velocity": "constant-velocity in the prediction table",
        f"{scored} constant-acceleration": "constant-acceleration in the prediction table",
        f"{scored} kalman": "kalman in the prediction table",
        f"{scored} simulated --model orca --set {values}": "simulated in the prediction table: the calibrated crowd",
        f"crowdbot demo --seed {episode.seed} --out {out}": "this page",
    }


def _describe_input(trial: Trial, fit: Fit) -> str:
    crowd = kebab_case(type(trial.crowd).__name__)
    return (
        f"The input of the predictors is the last {OBSERVE * STEP:.1f} s of the true positions, without noise and"
        f" without goals. The crowd of this trial uses the model {crowd}; the simulated predictor is ORCA, calibrated"
        f" with {fit.evaluations[0]} evaluations on a crowd with another seed. A simulated crowd is easier to predict"
        " than a real one; for real recordings, use crowdbot predict."
    )
