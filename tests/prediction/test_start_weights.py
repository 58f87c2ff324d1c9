"""Trainings that start from other weights."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import DataError, InputError, stream
from crowdbot.prediction import AnchorNet, Samples, SocialWays, TrainingSchedule, make_learner, train
from crowdbot.prediction.pretrained_weights import load_pretrained


def samples(scenes: int = 12, people: int = 6) -> Samples:
    """Return windows of 8 + 12 rows with turning people."""
    rng = stream(3, "start weights")
    count = scenes * people
    angle = rng.uniform(-np.pi, np.pi, (count, 1)) + np.cumsum(rng.normal(0.0, 0.1, (count, 20)), axis=1)
    step = 0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    place = rng.uniform(-6.0, 6.0, (count, 1, 2)) + np.cumsum(step, axis=1)
    yes = np.ones((count, 20), dtype=bool)
    first = people * np.arange(scenes + 1)
    return Samples(place, yes, yes[:, 0], first, np.zeros(scenes, dtype=np.int64), ("made",), 8, 0.4)


@pytest.fixture
def turners(tmp_path: Path) -> Path:
    """Write a recording of ten people who turn, 80 rows of 0.4 s."""
    rng = stream(5, "turners")
    file = tmp_path / "turners.csv"
    lines = ["id,time,x,y"]
    for person in range(10):
        angle = rng.uniform(-np.pi, np.pi) + np.cumsum(rng.normal(0.0, 0.15, 80))
        place = rng.uniform(-6.0, 6.0, 2) + np.cumsum(0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=1), axis=0)
        lines += [f"{person},{0.4 * row:.1f},{x:.4f},{y:.4f}" for row, (x, y) in enumerate(place)]
    file.write_text("\n".join(lines) + "\n")
    return file


def test_without_an_update_the_network_is_that_of_the_start() -> None:
    model = make_learner("anchor-net", "general", {}, samples(), samples(), start="open")
    shipped = load_pretrained("anchor-net", "open")
    own = model.numbers()  # type: ignore[attr-defined]
    for name in ("basis", "centres", "own_1_weight", "out_bias", "nobody", "width", "line_share", "reach"):
        np.testing.assert_allclose(own[name], shipped[name], rtol=1e-6, atol=1e-7)
    assert model.config.rate < 1e-3


def test_a_training_changes_the_start_and_its_weights_predict(tmp_path: Path) -> None:
    model = make_learner("anchor-net", "general", {"people": "32"}, samples(), samples(), start="open")
    before = dict(model.check())
    train(model, TrainingSchedule(updates=60, check_every=60), tmp_path)
    after = dict(model.check())
    assert after["ade"] < before["ade"]  # these people turn more than those of the start
    assert AnchorNet(file=str(tmp_path / "best.npz")).fold == "auto"
    again = make_learner("anchor-net", "general", {}, samples(), samples(), start=str(tmp_path / "best.npz"))
    assert again.check()["ade"] == pytest.approx(after["ade"], abs=1e-5)


def test_a_resumed_training_has_the_same_start(tmp_path: Path) -> None:
    schedule = TrainingSchedule(updates=2, check_every=2)
    values = {"people": "16"}
    train(make_learner("anchor-net", "general", values, samples(), samples(), start="open"), schedule, tmp_path)
    other = make_learner("anchor-net", "general", values | {"rate": "3e-4"}, samples(), samples(), start="zara1")
    with pytest.raises(InputError, match="contains a training with other"):
        train(other, schedule, tmp_path, resume=True)


def test_what_cannot_be_a_start_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="cannot start from the weights all"):
        make_learner("anchor-net", "general", {}, samples(), samples(), start="all")
    with pytest.raises(InputError, match="'width': 64.* are not those of the start weights"):
        make_learner("anchor-net", "general", {"width": "64"}, samples(), samples(), start="open")
    with pytest.raises(DataError, match="does not exist"):
        make_learner("anchor-net", "general", {}, samples(), samples(), start=str(tmp_path / "none.npz"))
    with pytest.raises(InputError, match="omit --settings variety"):
        make_learner("social-ways", "variety", {}, samples(), samples(), start="zara1")


def test_social_ways_starts_from_shipped_weights() -> None:
    model = make_learner("social-ways", None, {}, samples(), samples(), start="zara1")
    fresh = make_learner("social-ways", None, {}, samples(), samples())
    assert model.check()["ade"] < fresh.check()["ade"]
    assert model.facts["offset"] != fresh.facts["offset"]
    assert SocialWays("zara1").is_pretrained


def test_the_program_prints_the_errors_before_and_after(
    turners: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["train", "anchor-net", "--data", str(turners), "--from", "open", "--updates", "2", "--out"]
    assert main([*words, str(tmp_path / "new")]) == 0
    printed = capsys.readouterr().out
    table = [line.split() for line in printed.splitlines() if line.split()[:1] in (["start"], ["best"], ["last"])]
    assert [row[:2] for row in table] == [["start", "0"], ["best", "2"], ["last", "2"]]
