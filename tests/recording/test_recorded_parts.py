"""Parts of a recording: which files it keeps, where names lead, velocities of robots, instants of a branch."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import EpisodeError, Twist
from crowdbot.data import McapReader
from crowdbot.messages import Messages
from crowdbot.navigation import Navigator, Observation
from crowdbot.recording import attachments, branch, export, read_episode, run
from crowdbot.recording.step_records import _moment
from crowdbot.sensors import GroundTruthPeople
from crowdbot.trials import Mount, Trial, parse_trial
from crowdbot.world import Omnidirectional
from trial_texts import GOOD

TINY = parse_trial(GOOD)


@pytest.mark.parametrize(
    ("name", "inside"),
    [
        ("a.csv", True), ("maps/a.csv", True), ("a..b/c", True), ("", False), ("../a.csv", False),
        ("maps/../../a.csv", False), ("maps/..", False), ("/etc/a", False), ("c:/a", False), ("a\\b", False),
        ("a\0b", False),
    ],
)  # fmt: skip
def test_names_stay_in_their_folder(name: str, inside: bool) -> None:
    assert attachments._is_inside(name) is inside


def test_files_are_kept_as_long_as_they_fit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes = {"a": 6, "b": 20, "c": 6, "d": 1}
    for name, size in sizes.items():
        (tmp_path / name).write_bytes(b"x" * size)
    monkeypatch.setattr(attachments, "MOST", 12)
    monkeypatch.setattr(attachments, "named_files", lambda trial: {name: ("data", tmp_path / name) for name in sizes})
    rows = attachments.collect_attachments([TINY])
    assert [(row.name, row.size, row.kept) for row, _ in rows] == [
        ("a", 6, True), ("b", 20, False), ("c", 6, True), ("d", 1, False),
    ]  # fmt: skip
    assert len({row.digest for row, _ in rows}) == 3
    gone = attachments.skip_message([row for row, _ in rows])
    assert "b" in gone
    assert "a" not in gone.split()
    assert attachments.skip_message([rows[0][0]]) == ""


@dataclasses.dataclass(frozen=True)
class Sideways(Navigator):
    """Drives ahead, to the left and round at once."""

    def act(self, observation: Observation) -> Twist:
        return Twist(0.3, 0.5, left=0.2)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("sideways")
    robot = dataclasses.replace(
        TINY.robots[0],
        drive=Omnidirectional(max_acceleration=50.0, max_turn_acceleration=50.0),
        navigator=Sideways(),
        heading=0.7,
        sensors=(Mount(name="people", sensor=GroundTruthPeople(), x=0.1),),
    )
    trial = dataclasses.replace(TINY, robots=(robot,), duration=1.0)
    run(trial, seed=3, out=out)
    return out / "episode.mcap"


def test_velocities_of_a_robot_that_drives_sideways_are_those_of_its_places(recorded: Path) -> None:
    episode = read_episode(recorded)
    robot = episode.robots[0]
    heading, velocity = episode.heading[1:, robot], episode.velocity[1:, robot]
    cos, sin = np.cos(heading), np.sin(heading)
    np.testing.assert_allclose(cos * velocity[:, 0] + sin * velocity[:, 1], 0.3, atol=1e-9)
    np.testing.assert_allclose(cos * velocity[:, 1] - sin * velocity[:, 0], 0.2, atol=1e-9)
    between = np.diff(episode.position[1:, robot], axis=0) / 0.1
    np.testing.assert_allclose(0.5 * (velocity[1:] + velocity[:-1]), between, atol=0.02)


def test_tracked_people_are_rows_with_their_velocities(recorded: Path, tmp_path: Path) -> None:
    import pandas as pd

    count = export(recorded, tmp_path / "tracked.csv", "tracked")
    table = pd.read_csv(tmp_path / "tracked.csv")
    reading = read_episode(recorded).readings["robot/people"][0]
    first = table[np.isclose(table["time"], reading.time)].sort_values("id")
    assert len(table) == count
    who = np.flatnonzero(reading.present[0])
    np.testing.assert_allclose(first[["ahead", "left"]], reading.position[0, who])
    np.testing.assert_allclose(first[["ahead_speed", "left_speed"]], reading.velocity[0, who])
    np.testing.assert_allclose(first["radius"], reading.radius[0, who])


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("plain")
    run(dataclasses.replace(TINY, duration=1.0), seed=3, out=out)
    return out / "episode.mcap"


def test_a_scan_of_an_old_episode_is_placed_by_its_transforms(plain: Path) -> None:
    stamp, make, episode = 500_000_000, Messages(), read_episode(plain)
    with plain.open("rb") as stream:
        messages = list(McapReader(stream).messages())
    heard = [
        (message.topic, message.data)
        for message in messages
        if message.stamp == stamp or message.topic.topic == "/tf_static"
    ]
    old = ("/tf", "/tf_static", "/robot/scan")  # there were no records of readings
    scan = _moment(stamp, [(t.topic, make.decode_message(data, t.kind)) for t, data in heard if t.topic in old])
    x, y = episode.position[5, episode.robots[0]]
    heading = episode.heading[5, episode.robots[0]]
    expected = (x + 0.1 * np.cos(heading), y + 0.1 * np.sin(heading), heading)
    assert scan.scans["robot/scan"].pose == pytest.approx(expected)


@pytest.mark.parametrize("at", [-0.1, 1.1, 9.0])
def test_a_branch_begins_within_the_episode(plain: Path, tmp_path: Path, at: float) -> None:
    with pytest.raises(EpisodeError, match=f"has no step at {at:g} s; it lasts from 0 s to 1 s"):
        branch(plain, at, out=tmp_path)


def test_a_branch_begins_at_a_record(plain: Path, tmp_path: Path) -> None:
    with pytest.raises(EpisodeError, match=r"it was recorded every 0.1 s; the nearest is 0.5 s"):
        branch(plain, 0.52, out=tmp_path)


def test_a_seed_of_a_run_replaces_that_of_the_trial() -> None:
    short: Trial = dataclasses.replace(TINY, duration=0.2)
    assert run(short).seed == 3
    assert run(short, seed=8).seed == 8
    assert run(short).digest == run(short, seed=3).digest != run(short, seed=8).digest
