"""A whole recording is calibrated in chunks; an interrupted calibration resumes and gives the same fit."""

from __future__ import annotations

import dataclasses
import itertools
from pathlib import Path

import numpy as np
import pytest
from made_crowds import Drifting

from crowdbot.calibration import CalibrationChunk, Calibrator, Fit, RecordingCalibration
from crowdbot.core import stream
from crowdbot.data import Recording

ARRAYS = ("values", "given", "id", "counted", "cost", "given_cost", "evaluations", "history")


def write_recording(path: Path) -> Recording:
    """Write twelve people who cross a square, some of them late, and return the recording."""
    rng = stream(0, "recording")
    lines = ["frame,id,x,y"]
    for person in range(12):
        place, velocity = rng.uniform(-4.0, 4.0, 2), rng.normal(0.0, 1.0, 2)
        for frame in range(int(rng.integers(0, 8)), 30):
            x, y = place + 0.4 * frame * velocity + rng.normal(0.0, 0.05, 2)
            lines.append(f"{frame},{person},{x:.4f},{y:.4f}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return Recording(str(path), fps=2.5, observe=5, predict=3)


def scheme(budget: int = 6) -> Calibrator:
    return Calibrator(Drifting(), "absolute", "random-search", budget=budget, free=("share", "push"))


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    return write_recording(tmp_path_factory.mktemp("recording") / "square.csv")


@pytest.fixture(scope="module")
def whole(recording: Recording) -> Fit:
    calibration = RecordingCalibration(recording, scheme(), seed=3)
    return calibration.merge(list(calibration.run()))


def assert_same(fit: Fit, other: Fit) -> None:
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(fit, name), getattr(other, name), err_msg=name)
    assert (fit.scheme, fit.windows, fit.persons) == (other.scheme, other.windows, other.persons)


def test_chunks_cover_the_recording_in_order(recording: Recording) -> None:
    chunks = list(RecordingCalibration(recording, scheme()).run())
    assert len(chunks) >= 8
    ends = [(chunk.first, chunk.last) for chunk in chunks]
    assert ends[0][0] == 0
    assert ends[-1][1] == len(recording.windows[0])
    assert all(before[1] == after[0] for before, after in itertools.pairwise(ends))
    past = recording.windows[0]
    np.testing.assert_array_equal(np.concatenate([chunk.frame for chunk in chunks]), past.frame[:, -1])
    np.testing.assert_array_equal(np.concatenate([chunk.people for chunk in chunks]), past.present[:, -1].sum(axis=1))


def test_chunks_give_the_fit_of_all_windows(recording: Recording, whole: Fit) -> None:
    past = recording.windows[0]
    rngs = [stream(3, "calibrate", window) for window in range(len(past))]
    assert_same(whole, scheme().fit_each(past, rngs))
    calibration = RecordingCalibration(recording, scheme(), seed=3)
    assert_same(whole, calibration.merge(list(calibration.run())[::-1]))
    assert whole.seconds > 0.0


def test_an_interrupted_calibration_resumes(
    recording: Recording, whole: Fit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calibration = RecordingCalibration(recording, scheme(), seed=3)
    run = calibration.run(keep=tmp_path)
    first = [next(run) for _ in range(3)]
    run.close()
    kept = sorted(path.name for path in tmp_path.iterdir())
    assert 2 <= len(kept) <= 3
    assert all(name.startswith(calibration.key) for name in kept)
    calibrated: list[int] = []
    fit_each = Calibrator.fit_each

    def counted(self: Calibrator, past: object, *more: object) -> Fit:
        calibrated.append(len(past))  # type: ignore[arg-type]
        return fit_each(self, past, *more)  # type: ignore[arg-type]

    monkeypatch.setattr(Calibrator, "fit_each", counted)
    chunks: list[CalibrationChunk] = list(calibration.run(keep=tmp_path))
    assert sum(calibrated) == sum(chunk.last - chunk.first for chunk in chunks[len(kept) :])
    assert_same(whole, calibration.merge(chunks))
    assert [chunk.first for chunk in first[: len(kept)]] == [chunk.first for chunk in chunks[: len(kept)]]
    calibrated.clear()
    assert_same(whole, calibration.merge(list(calibration.run(keep=tmp_path))))
    assert calibrated == []


def test_the_key_depends_on_everything_that_decides(recording: Recording, tmp_path: Path) -> None:
    calibration = RecordingCalibration(recording, scheme(), seed=3)
    others = [
        dataclasses.replace(calibration, seed=4),
        dataclasses.replace(calibration, calibrator=scheme(7)),
        dataclasses.replace(calibration, goal="ground-truth"),
        dataclasses.replace(calibration, recording=dataclasses.replace(recording, observe=4)),
    ]
    changed = tmp_path / "square.csv"
    changed.write_text(Path(recording.path).read_text(encoding="utf-8").replace("0,", "1,", 1))
    others.append(dataclasses.replace(calibration, recording=dataclasses.replace(recording, path=str(changed))))
    keys = [calibration.key, *(other.key for other in others)]
    assert len(set(keys)) == len(keys)
    assert RecordingCalibration(recording, scheme(), seed=3).key == calibration.key


def test_a_goal_that_knows_the_future_is_given_the_recording(recording: Recording) -> None:
    calibration = RecordingCalibration(recording, scheme(), goal="ground-truth", seed=3)
    assert calibration.goal_calibrator.scheme == "drifting, absolute, random-search, ground-truth"
    fit = calibration.merge(list(calibration.run()))
    assert np.nanmean(fit.cost) <= np.nanmean(fit.given_cost)
    assert RecordingCalibration(recording, scheme()).goal_calibrator == scheme()
