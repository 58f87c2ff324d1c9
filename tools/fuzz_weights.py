"""Samples and reader of weights and population priors, for ``fuzz_kinds.py``."""

from __future__ import annotations

import functools
import json
import random
import shutil
import tempfile
from pathlib import Path

import numpy as np
from fuzzing import check_sentence

from crowdbot.core import CrowdbotError
from crowdbot.data import Windows

ROOT = Path(__file__).parents[1]
ASSETS = ROOT / "src" / "crowdbot" / "assets"


def make_weights(folder: Path) -> None:
    """Write checkpoints, shipped weights and a population prior."""
    first = ROOT / "tests" / "prediction" / "data" / "first-version"
    for name, path in {
        "anchor-net": first / "anchor-net" / "best.npz",
        "social-ways": first / "social-ways" / "best.npz",
        "shipped": ASSETS / "predictors" / "anchor-net-open.npz",
    }.items():
        (folder / name).mkdir()
        shutil.copyfile(path, folder / name / "weights.npz")
    (folder / "prior").mkdir()
    prior = {
        "names": ["radius", "time-horizon"],
        "mean": [0.1, -0.2],
        "covariance": [[1, 0.1], [0.1, 1]],
        "strength": 0.1,
    }
    (folder / "prior" / "prior.json").write_text(json.dumps(prior), encoding="utf-8")


def read_weights(folder: Path, name: str, rng: random.Random) -> None:
    """Read weights and predict with them."""
    from crowdbot.calibration import PopulationPrior
    from crowdbot.prediction import AnchorNet, SocialWays

    if name == "prior.json":
        PopulationPrior.load(folder / name)
        return
    past = _past()
    predictors = (AnchorNet(file=str(folder / name)), SocialWays(str(folder / name)))
    problems = []
    for predictor in predictors:
        try:
            predictor.predict(past, 12, 4, np.random.default_rng(0))
        except CrowdbotError as error:
            check_sentence(str(error))
            problems.append(error)
    if len(problems) == len(predictors):
        raise problems[0]


@functools.cache
def _past() -> Windows:
    from synthetic_recordings import sgan_text

    from crowdbot.data import load

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "crowds.txt")
        sgan_text(path)
        return load(path).windows()[0][20:24]
