"""Results window by window: the same numbers for any number of windows that are predicted together."""

import numpy as np
import pytest

from crowdbot.core import DataError
from crowdbot.data import Trajectories, detect_format, save
from crowdbot.evaluation import predict_windows
from crowdbot.prediction import SampledConstantVelocity, Simulated


def crossing():
    """Four people who cross each other, as past and future of windows."""
    frame = np.repeat(np.arange(30), 4)
    angle = np.tile(np.pi / 2 * np.arange(4), 30)
    way = 4.0 - 0.4 * frame + 0.05 * np.sin(frame + angle)
    return Trajectories(
        np.tile(np.arange(4), 30), frame, way * np.cos(angle), way * np.sin(angle) + 0.3, row_rate=2.5
    ).windows(8, 12)


@pytest.mark.parametrize(
    "predictor",
    [SampledConstantVelocity(), Simulated(), Simulated(search="random-search", budget=10)],
    ids=["sampled", "orca", "calibrated orca"],
)
def test_results_do_not_depend_on_the_number_of_windows_together(predictor):
    past, future = crossing()
    parts = {size: list(predict_windows(predictor, past, future, 3, seed=5, size=size)) for size in (1, 4, len(past))}
    whole = parts[len(past)][0]
    for found in parts.values():
        assert [part.first for part in found] == [0, *(part.last for part in found[:-1])]
        assert np.array_equal(np.concatenate([part.forecast.position for part in found]), whole.forecast.position)
        assert np.array_equal(np.concatenate([part.errors.ade for part in found]), whole.errors.ade)
        costs = np.concatenate([part.frames.cost for part in found])
        assert np.array_equal(costs, whole.frames.cost, equal_nan=True)
        assert all((part.fit is None) == (whole.fit is None) for part in found)


def test_a_range_of_windows_has_the_numbers_of_the_whole():
    past, future = crossing()
    whole = next(predict_windows(SampledConstantVelocity(), past, future, 3, size=len(past)))
    (part,) = predict_windows(SampledConstantVelocity(), past, future, 3, size=99, first=4, last=7)
    assert np.array_equal(part.forecast.position, whole.forecast.position[4:7])
    assert part.frames.frame.tolist() == past.frame[4:7, -1].tolist()


@pytest.mark.parametrize(("suffix", "name"), [(".csv", "csv"), (".txt", "sgan"), (".parquet", "parquet")])
def test_the_format_is_found_in_the_content(tmp_path, suffix, name):
    save(Trajectories([7, 7], [0, 10], [0.0, 0.5], [2.0, 2.0], row_rate=2.5), tmp_path / f"two{suffix}")
    (tmp_path / f"two{suffix}").rename(tmp_path / "tracks")
    assert detect_format(tmp_path / "tracks") == name


def test_a_text_of_no_format_is_refused(tmp_path):
    (tmp_path / "letter").write_text("dear reader\n")
    with pytest.raises(DataError, match="of an unknown format"):
        detect_format(tmp_path / "letter")
