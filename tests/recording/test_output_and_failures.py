"""Runs that overwrite, collide or fail: by the command line as users see it, and in Python."""

from __future__ import annotations

import dataclasses
import errno
import json
import os
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import EpisodeError, InputError, Scene, Twist, lock_output, relative_name
from crowdbot.models import CrowdModel
from crowdbot.navigation import Navigator, Observation
from crowdbot.recording import branch, export, open_run, read_episode, record, repair, replay
from crowdbot.rendering import ImageWriter, RenderedImage
from crowdbot.sensors import Scan, Sensor, SensorView
from crowdbot.simulation import RunFailureWarning, Simulation, simulate, simulate_seeds
from crowdbot.trials import Mount, Trial, parse_trial
from trial_texts import GOOD

TRIAL = parse_trial(GOOD)
NAVIGATOR = """from crowdbot.core import Twist
from crowdbot.navigation import Navigator


class Shy(Navigator):
    def act(self, observation):
        if observation.time > 1.0:
            raise ValueError("no way\\nout")
        return Twist(0.5)
"""


@dataclasses.dataclass(frozen=True)
class Lost(Navigator):
    def act(self, observation: Observation) -> Twist:
        raise KeyError("map")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Blind(Sensor):
    def measure(self, view: SensorView, state: None, rng: Any = None) -> tuple[Scan, None]:
        raise RuntimeError("no light")


@dataclasses.dataclass(frozen=True)
class Stuck(CrowdModel):
    def velocity(self, scene: Scene, dt: float, rng: Any = None) -> Any:
        if scene.time > 0.99:
            raise ZeroDivisionError("stuck")
        return scene.velocity


class Broken:
    def orders(self, simulation: Simulation) -> Any:
        if simulation.tick == 5:
            raise OSError("connection lost")
        return []


def line_of(text: str) -> int:
    return next(
        k for k, line in enumerate(Path(__file__).read_text(encoding="utf-8").splitlines(), start=1) if text in line
    )


def test_run_refuses_to_overwrite(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "episode.mcap"
    words = ["run", "frontal", "--set", "duration=0.5", "--out", str(tmp_path)]
    assert main(words) == 0
    before = file.read_bytes()
    capsys.readouterr()
    assert main([*words, "--seed", "7"]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert said == f"crowdbot: {file} already exists; use another path, or --force (force=True) to overwrite it"
    assert file.read_bytes() == before
    assert main([*words, "--seed", "7", "--force"]) == 0
    assert read_episode(file).seed == 7
    assert os.listdir(tmp_path) == ["episode.mcap"]


def test_branch_and_export_refuse_to_overwrite(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record(dataclasses.replace(TRIAL, duration=1.0), out=tmp_path / "a")
    source = str(tmp_path / "a" / "episode.mcap")
    for words in (
        ["branch", source, "--at", "0.5", "--out", str(tmp_path / "b")],
        ["export", source, "--to", str(tmp_path / "people.csv")],
    ):
        assert main(words) == 0
        assert main(words) == 2
        assert "already exists; use another path, or --force" in capsys.readouterr().err
        assert main([*words, "--force"]) == 0
    assert sorted(os.listdir(tmp_path)) == ["a", "b", "people.csv"]


@pytest.mark.parametrize("name", ["image.png", "images"])
def test_images_are_not_overwritten(tmp_path: Path, name: str) -> None:
    image = RenderedImage(0.0, np.zeros((16, 16, 3), np.uint8))
    files, _ = ImageWriter(tmp_path / name, film=False).write([image])
    before = files[0].read_bytes()
    with pytest.raises(InputError, match="already exists; use another path, or --force"):
        ImageWriter(tmp_path / name, film=False)
    assert files[0].read_bytes() == before
    again, _ = ImageWriter(tmp_path / name, film=False, force=True).write([image])
    assert again == files
    assert not list(tmp_path.rglob(".*"))


@pytest.mark.live
def test_two_runs_into_one_folder(tmp_path: Path) -> None:
    words = [
        sys.executable,
        "-m",
        "crowdbot",
        "run",
        "frontal",
        "--pace",
        "4",
        "--json",
        "--out",
        str(tmp_path / "out"),
    ]
    two = [subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    said = [process.communicate(timeout=120) for process in two]
    assert sorted(process.returncode for process in two) == [0, 2]
    winner = 0 if two[0].returncode == 0 else 1
    assert "is being written by another run (process " in said[1 - winner][1]
    assert read_episode(tmp_path / "out" / "episode.mcap").digest == json.loads(said[winner][0])["digest"]
    assert os.listdir(tmp_path / "out") == ["episode.mcap"]


@pytest.mark.live
def test_a_lock_is_taken_over_when_its_process_is_gone(tmp_path: Path) -> None:
    lock = tmp_path / ".episode.mcap.lock"
    code = "import os, sys; from pathlib import Path; from crowdbot.core import lock_output\n"
    code += "with lock_output(Path(sys.argv[1])): os._exit(9)"
    path = tmp_path / "episode.mcap"
    assert subprocess.run([sys.executable, "-c", code, str(path)], check=False).returncode == 9
    pid = lock.read_text()
    with lock_output(path):
        assert lock.read_text() != pid
    assert os.listdir(tmp_path) == []


def test_a_lock_that_cannot_be_written_leaves_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full() -> str:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("socket.gethostname", full)
    with pytest.raises(OSError, match="No space left"), lock_output(tmp_path / "episode.mcap"):
        pass
    assert os.listdir(tmp_path) == []


def test_a_full_disk_at_the_end_of_a_run_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(file: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(EpisodeError, match=r"cannot write .*episode\.mcap: No space left"):
        record(dataclasses.replace(TRIAL, duration=0.5), out=tmp_path)


def test_one_of_many_takes_over_a_stale_lock(tmp_path: Path) -> None:
    path, inside, most = tmp_path / "episode.mcap", [0], [0]
    (tmp_path / ".episode.mcap.lock").write_text("")
    os.utime(tmp_path / ".episode.mcap.lock", (0, 0))
    refused, guard = [0], threading.Lock()

    def take() -> None:
        for _ in range(20):
            try:
                with lock_output(path):
                    with guard:
                        inside[0] += 1
                        most[0] = max(most[0], inside[0])
                    with guard:
                        inside[0] -= 1
            except InputError:
                with guard:
                    refused[0] += 1

    threads = [threading.Thread(target=take) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most[0] == 1
    assert refused[0] < 80
    assert os.listdir(tmp_path) == []


def test_repair_waits_for_no_run(tmp_path: Path) -> None:
    with open_run(TRIAL, out=tmp_path) as running:
        running.until(1_000_000_000)
        with pytest.raises(InputError, match="is being written by another run"):
            repair(tmp_path / "episode.mcap")


def test_a_lock_of_another_host_is_named(tmp_path: Path) -> None:
    (tmp_path / ".episode.mcap.lock").write_text("12 elsewhere\n")
    with pytest.raises(InputError, match="by process 12 on elsewhere; if that run has ended, delete"):
        record(TRIAL, out=tmp_path)
    assert os.listdir(tmp_path) == [".episode.mcap.lock"]


def test_an_exception_of_a_navigator_by_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "shy.py").write_text(NAVIGATOR)
    trial = tmp_path / "shy.xml"
    trial.write_text(GOOD.replace('navigator type="straight"', 'navigator type="shy.py:Shy"'))
    assert main(["run", str(trial), "--out", str(tmp_path), "--json"]) == 1
    said = capsys.readouterr()
    summary = json.loads(said.out)
    assert (summary["outcome"], summary["error"]) == ("error", "ValueError: no way out")
    assert summary["error_place"] == "shy.py:8"
    sentence = "ValueError: no way out (shy.py:8) at 1.1 s"
    code, told = said.err.splitlines(keepends=True)
    assert code == "crowdbot: loads code from shy.py\n"
    assert told == f"crowdbot: trial 'small' ended with an error: {sentence}; --debug prints the traceback\n"
    read = read_episode(tmp_path / "episode.mcap")
    assert (read.complete, read.outcome, read.digest) == (True, "error", summary["digest"])
    assert str(read.failure) == sentence
    assert read.times[-1] == pytest.approx(1.1)
    assert main(["replay", str(tmp_path / "episode.mcap"), "--json"]) == 0
    done = json.loads(capsys.readouterr().out)
    assert (done["equal"], done["outcome"], done["replayed_outcome"]) == (True, "error", "error")
    assert done["error"] == done["replayed_error"] == sentence
    assert f"ended with an error: {sentence}" in str(replay(tmp_path / "episode.mcap"))


@pytest.mark.parametrize(
    ("changes", "message", "line"),
    [
        ({"robots": [dataclasses.replace(TRIAL.robots[0], navigator=Lost())]}, "KeyError: 'map'", 'KeyError("map")'),
        (
            {"robots": [dataclasses.replace(TRIAL.robots[0], sensors=[Mount(name="eye", sensor=Blind())])]},
            "RuntimeError: no light",
            'RuntimeError("no light")',
        ),
        ({"crowd": Stuck()}, "ZeroDivisionError: stuck", 'ZeroDivisionError("stuck")'),
    ],
    ids=["navigator", "sensor", "crowd"],
)
def test_every_exception_ends_an_episode(changes: dict[str, Any], message: str, line: str) -> None:
    trial = dataclasses.replace(TRIAL, **changes)
    place = f"{Path(__file__).name}:{line_of(f'raise {line}')}"
    with pytest.warns(RunFailureWarning, match=r"trial 'small' ended with an error"):
        episode = simulate(trial)
    assert episode.outcome == "error"
    assert episode.failure is not None
    assert (episode.failure.message, episode.failure.place) == (message, place)
    assert "Traceback" in episode.failure.trace
    assert len(episode.times) >= 1
    with pytest.warns(RunFailureWarning):
        together = simulate_seeds(trial, [3, 4])
    assert together[0].digest == episode.digest
    assert together[0].failure == episode.failure


def test_an_exception_of_a_source(tmp_path: Path) -> None:
    with open_run(TRIAL, out=tmp_path, sources=[Broken()]) as running:
        while running.outcome is None:
            running.step()
    assert running.outcome == "error"
    read = read_episode(tmp_path / "episode.mcap")
    assert (read.complete, read.outcome, read.times[-1]) == (True, "error", 0.2)
    assert read.failure == running.failure
    assert read.failure is not None
    assert read.failure.place == f"{Path(__file__).name}:{line_of('raise OSError(')}"
    done = replay(tmp_path / "episode.mcap")
    assert not done.equal
    assert done.outcomes == ("error", "interrupted")
    assert branch(tmp_path / "episode.mcap", 0.2).outcome != "error"
    assert export(tmp_path / "episode.mcap", tmp_path / "a.csv") > 0


def test_an_episode_of_an_empty_folder_needs_no_force(tmp_path: Path) -> None:
    trial = Trial(name="empty", duration=0.2, crowd=TRIAL.crowd)
    assert record(trial, out=tmp_path).outcome == "finished"
    with pytest.raises(InputError, match="already exists"):
        record(trial, out=tmp_path)
    assert record(trial, out=tmp_path, force=True).outcome == "finished"


def test_a_file_on_another_drive_has_its_absolute_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = tmp_path / "my.py"
    assert relative_name(path, tmp_path / "trial") == "../my.py"

    def refuse(path: object, start: object) -> str:
        raise ValueError("path is on mount 'D:', start on mount 'C:'")

    monkeypatch.setattr("os.path.relpath", refuse)
    assert relative_name(path, tmp_path / "trial") == path.as_posix()
