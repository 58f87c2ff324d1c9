"""The plot of degraded input: its lines, its clipped outlier, and the same bytes again."""

import numpy as np
import pytest

from crowdbot.data import Trajectories
from crowdbot.data.degrade import GaussianNoise, MissingFrames
from crowdbot.evaluation import DegradedTask, plot_degradation, sweep_degradations
from crowdbot.evaluation.prediction.degraded_plot import _figure
from crowdbot.prediction import ConstantAcceleration, ConstantVelocity, Kalman


@pytest.fixture(scope="module")
def sweeps():
    rows = np.arange(40)
    tracks = Trajectories(
        np.repeat([1, 2], 40), np.tile(rows, 2), np.tile(0.5 * rows, 2), np.repeat([0.0, 2.0], 40), 2.5
    )
    predictors = [ConstantVelocity(), Kalman(), ConstantAcceleration()]
    return [
        [
            score
            for scores in sweep_degradations([tracks], [item], predictors, task=DegradedTask(draws=2))
            for score in scores
        ]
        for item in (GaussianNoise(), MissingFrames())
    ]


def test_every_predictor_has_its_line_and_the_coverage_stands_below(sweeps):
    noise, missing = _figure(sweeps).subfigs
    above, below = noise.axes
    assert [line.get_label() for line in above.get_lines()] == ["constant-velocity", "kalman", "constant-acceleration"]
    for predictor, line in zip(("constant-velocity", "kalman"), above.get_lines(), strict=False):
        assert line.get_ydata().tolist() == [s.score.ade for s in sweeps[0] if s.predictor == predictor]
    assert below.get_lines()[0].get_ydata().tolist() == [100.0] * 5
    assert missing.axes[1].get_lines()[0].get_ydata()[-1] < 50.0
    assert below.get_xlabel() == "sd [m]"
    assert missing.axes[0].get_title() == "missing-frames\nburst 1, of person"


def test_one_predictor_that_is_far_worse_leaves_the_picture_and_it_says_so(sweeps):
    axis = _figure(sweeps).subfigs[0].axes[0]
    worst = max(score.high for score in sweeps[0])
    assert axis.get_ylim()[1] < worst
    assert axis.texts[0].get_text() == f"constant-acceleration\ngoes on to {worst:.3g} m"


def test_the_same_scores_give_the_same_files(sweeps, tmp_path):
    kept = []
    for name in ("one", "two"):
        folder = tmp_path / name
        folder.mkdir()
        files = plot_degradation(sweeps, folder, "two people")
        assert [file.name for file in files] == ["degraded.png", "degraded.svg"]
        assert sorted(folder.iterdir()) == files
        kept.append([file.read_bytes() for file in files])
    assert kept[0] == kept[1]
