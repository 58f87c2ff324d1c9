"""Options of ``crowdbot run`` for bridges."""

import pytest

from crowdbot.cli import main
from crowdbot.recording import read_episode

RUN = ["run", "frontal", "--set", "duration=1"]


@pytest.mark.live
def test_a_run_with_a_bridge_is_recorded(tmp_path, capsys):
    options = ["--bridge", "rosbridge:0", "--clock", "free", "--out", str(tmp_path), "--seed", "3"]
    assert main([*RUN, *options]) == 0
    printed = capsys.readouterr()
    assert "timeout" in printed.out
    assert "trial frontal is open to rosbridge" in printed.err
    assert 'type="external"' in read_episode(tmp_path / "episode.mcap").xml


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--bridge", "rosbrige"], "did you mean 'rosbridge'"),
        (["--bridge", "rosbridge:x"], "must be rosbridge or rosbridge:PORT"),
        (["--bridge", "rosbridge:99999"], "port 99999 must be from 0 to 65535"),
        (["--bridge", "rosbridge", "--bridge-host", "0.0.0.0"], "is open to everybody"),
        (["--bridge", "rosbridge-client:ws://127.0.0.1:9", "--bridge-host", "0.0.0.0"], "does not take host"),
        (["--bridge", "rosbridge", "--clock", "free", "--pace", "2"], "--pace needs the clock paced"),
        (["--clock", "free"], "--clock needs --bridge"),
        (["--bridge-token", "x"], "--bridge-token needs --bridge"),
    ],
)
def test_wrong_options_are_refused(options, message, capsys):
    assert main([*RUN, *options]) == 2
    assert message in capsys.readouterr().err
