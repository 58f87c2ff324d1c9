"""Recordings keep the poses of people out of balance, and the height and tilt of robots."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from crowdbot.cli import main
from crowdbot.data import McapReader
from crowdbot.humans import LYING, FallPose, blend_fall_poses
from crowdbot.messages import FALL_POSES, Messages, fall_pose_message, read_fall_poses
from crowdbot.recording import RecordedSimulation, open_run, read_episode, record, replay
from crowdbot.simulation import PushOrder
from crowdbot.trials import parse_trial

TRIAL = """<trial name="pushed" duration="7" world="physics" balance="true" get-up="1" step="0.05" seed="1"><stage/>
<crowd type="orca"/><agent x="0" y="0" body="man-24" speed="0.001"/>
<agent x="0" y="4" body="woman-72" speed="0.001"/><agent x="0" y="-4" body="man-36" speed="0.001"/>
<robot name="turtle" type="turtlebot2" x="-3" y="-2" default-sensors="false"><goal x="9" y="-2"/>
<navigator type="straight"/></robot></trial>"""
RAMP = """<trial name="ramp" duration="10" world="physics"><stage walkable="-2,-2 8,-2 8,2 -2,2">
<ramp x="2" y="0" length="3" width="3" height="0.24"/><platform x="5" y="0" length="3" width="3" height="0.24"/></stage>
<crowd type="orca"/><robot name="bot" type="turtlebot2" x="-1" y="0" default-sensors="false"><goal x="6" y="0"/>
<navigator type="straight"/></robot></trial>"""
STUMBLES, FALLS, STANDS = 0, 1, 2


def push_two(out: Path) -> Path:
    """Record a run in which one person stumbles, one falls, and one is left alone."""
    with open_run(parse_trial(TRIAL), out=out) as running:
        while running.outcome is None:
            orders = [
                PushOrder(person=STUMBLES, force=260, direction=0.0, duration=0.3),
                PushOrder(person=FALLS, force=900, direction=math.pi / 2, duration=0.25),
            ]
            running.step(orders if running.simulation.tick == 10 else [])
    return out / "episode.mcap"


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return push_two(tmp_path_factory.mktemp("pushed"))


def raw_messages(path: Path) -> list[tuple[int, bytes]]:
    with path.open("rb") as stream:
        return [
            (message.stamp, message.data)
            for message in McapReader(stream).messages()
            if message.topic.topic == FALL_POSES
        ]


def test_poses_are_those_of_the_simulation(path: Path) -> None:
    episode = read_episode(path)
    with RecordedSimulation(path) as recorded:
        for seconds in (0.5, 0.8, 1.2, 2.0, 4.0, 6.5):
            k = int(np.argmin(np.abs(episode.times - seconds)))
            world = recorded.at(float(episode.times[k])).world
            expected = world.fall_poses_of(0)
            assert {*episode.fall_poses[k]} == {*expected}
            for person, pose in expected.items():
                assert np.allclose(episode.fall_poses[k][person], pose, atol=1e-6)


def test_only_people_out_of_balance_are_recorded(path: Path) -> None:
    episode = read_episode(path)
    begin = episode.times > 0.55
    assert all(not poses for poses, late in zip(episode.fall_poses, begin, strict=True) if not late)
    known = [{*poses} for poses in episode.fall_poses]
    assert set().union(*known) == {STUMBLES, FALLS}
    stumbling = episode.times[[STUMBLES in item for item in known]]
    assert 0.3 < np.ptp(stumbling) < 3.0  # then the person stands again
    assert not any(poses[STUMBLES].down for poses in episode.fall_poses if STUMBLES in poses)
    tilts = [poses[FALLS].tilt for poses in episode.fall_poses if FALLS in poses]
    assert max(tilts) == pytest.approx(LYING, abs=1e-6)
    assert not episode.fall_poses[-1]  # who has fallen is up again
    (fall,) = episode.falls
    assert (fall.person, fall.direction) == (str(FALLS), "left")


def test_poses_take_twenty_bytes_each(path: Path) -> None:
    episode, rows = read_episode(path), raw_messages(path)
    assert len(rows) == sum(bool(poses) for poses in episode.fall_poses)
    longest = max(len(data) for _, data in rows)
    assert longest <= 40 + 20 * max(map(len, episode.fall_poses))


def test_runs_replay_to_the_byte_also_from_a_keyframe(path: Path, tmp_path: Path) -> None:
    assert push_two(tmp_path / "again").read_bytes() == path.read_bytes()
    assert replay(path).equal
    assert replay(path, begin=6.0).begin == 5.0
    assert replay(path, begin=6.0).equal


def test_a_recording_without_poses_is_read(path: Path, tmp_path: Path) -> None:
    record(parse_trial(TRIAL.replace('balance="true"', "")), out=tmp_path / "old.mcap")
    episode = read_episode(tmp_path / "old.mcap")
    assert not any(episode.fall_poses)
    assert raw_messages(tmp_path / "old.mcap") == []
    assert len(dataclasses.replace(read_episode(path), fall_poses=()).fall_poses) == 0


def test_poses_are_a_table(path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", str(path), "--table", "fall-poses", "--to", str(tmp_path / "poses.csv")]) == 0
    capsys.readouterr()
    table = pd.read_csv(tmp_path / "poses.csv")
    assert list(table.columns) == ["time", "person", *FallPose._fields]
    episode = read_episode(path)
    assert len(table) == sum(map(len, episode.fall_poses))
    assert table[table.person == FALLS].down.any()


@pytest.mark.parametrize("pose", [(math.nan, 1.0, 0.2), (0.0, 4.0, 0.2), (0.0, -0.1, 0.2), (0.0, 1.0, math.inf)])
def test_impossible_poses_are_refused(pose: tuple[float, float, float]) -> None:
    message = fall_pose_message(Messages(), 0, {3: FallPose(*pose, False, True)})
    with pytest.raises(ValueError, match="person 3 has an impossible pose"):
        read_fall_poses(message)


def test_a_pose_between_two_instants() -> None:
    lean, fall = FallPose(3.0, 0.3, 0.0, False, False), FallPose(-3.0, 1.1, 0.35, True, True)
    assert blend_fall_poses(lean, fall, 0.5) == FallPose(-3.0, 0.7, 0.35, True, True)
    other = fall._replace(direction=3.0, tilt=0.5)
    turned = blend_fall_poses(other, fall, 0.5)
    assert math.cos(turned.direction) == pytest.approx(-1.0)
    assert blend_fall_poses(lean, None, 0.75).tilt == pytest.approx(0.075)
    with pytest.raises(ValueError, match="must be of a person out of balance"):
        blend_fall_poses(None, None, 0.5)


def test_height_and_tilt_of_a_robot_on_a_ramp(tmp_path: Path) -> None:
    record(parse_trial(RAMP), out=tmp_path / "ramp.mcap")
    episode = read_episode(tmp_path / "ramp.mcap")
    assert episode.tilts.shape == (len(episode.times), 1, 3)
    x, (z, _, pitch) = episode.position[:, episode.robots[0], 0], episode.tilts[:, 0].T
    on = (x > 1.0) & (x < 3.0)
    assert on.any()
    assert np.median(pitch[on]) == pytest.approx(-math.atan2(0.24, 3.0), abs=0.02)  # the nose points up
    assert z[x > 4.0][-1] - z[0] == pytest.approx(0.24, abs=0.01)


def test_the_plane_is_level(tmp_path: Path) -> None:
    flat = RAMP[: RAMP.index("<ramp")] + RAMP[RAMP.index("</stage>") :]
    record(parse_trial(flat.replace('world="physics"', "")), out=tmp_path / "flat.mcap")
    episode = read_episode(tmp_path / "flat.mcap")
    assert episode.tilts.shape == (len(episode.times), 1, 3)
    assert not episode.tilts.any()
