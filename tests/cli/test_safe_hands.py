"""Full and read-only disks, closed and narrow streams, and errors in user code: one sentence each, no trace."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import crowdbot as cb
from crowdbot.cli import main

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="limits and permissions of POSIX")
SOURCES = Path(cb.__file__).parents[1]
EXPERIMENT = """<experiment name="tiny">
  <instructions><screen name="hello" text="Grüß Gott, Zoë → go"/></instructions>
  <block name="main"><trial name="walk" source="walk.xml"/></block>
</experiment>
"""
WALK = """<trial name="walk" duration="1">
  <stage walkable="0,0 7,0 7,4 0,4"/>
  <crowd type="orca"/>
  <robot radius="0.3" x="1" y="1">
    <goal x="6" y="1"/>
    <drive type="differential-drive"/>
    <navigator type="{}"/>
  </robot>
</trial>
"""
BROKEN = """from dataclasses import dataclass

import crowdbot as cb


@dataclass(frozen=True)
class Broken(cb.Navigator):
    def act(self, observation):
        raise RuntimeError("no more battery")
"""
LIMITED = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (200, 200))
from crowdbot.cli import main
raise SystemExit(main(sys.argv[1:]))
"""


def run(folder, *command, text="", **options):
    environment = {**os.environ, "PYTHONPATH": str(SOURCES), "CROWDBOT_DEBUG": "", **options}
    return subprocess.run(
        [sys.executable, *map(str, command)], cwd=folder, env=environment, input=text, capture_output=True, text=True
    )


def shell(folder, line):
    environment = {**os.environ, "PYTHONPATH": str(SOURCES), "CROWDBOT_DEBUG": ""}
    command = f"{sys.executable} -m crowdbot {line}"
    return subprocess.run(command, cwd=folder, env=environment, shell=True, capture_output=True, text=True)


@pytest.fixture
def experiment(tmp_path):
    (tmp_path / "experiment.xml").write_text(EXPERIMENT, encoding="utf-8")
    (tmp_path / "walk.xml").write_text(WALK.format("straight"))
    return tmp_path


RUN = ("experiment", "run", "experiment.xml", "--participant", "1", "--out", "data")


@pytest.mark.parametrize("words", [["trial", "t.xml"], ["navigator", "t.py"], ["schema", "t.xsd"], ["robot", "t"]])
def test_new_on_a_full_disk_is_one_sentence_and_leaves_no_file(words, tmp_path):
    done = run(tmp_path, "-B", "-c", LIMITED, "new", *words)
    assert done.returncode == 2
    assert done.stderr.endswith("cannot be written: File too large\n")
    assert done.stderr.count("\n") == 1
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


@pytest.mark.parametrize(
    "words", [["new", "trial", "{}/t.xml"], ["new", "goal", "{}/t.py"], ["demo", "--out", "{}/demo"]]
)
def test_a_folder_that_cannot_be_written_is_one_sentence(words, tmp_path, capsys):
    place = Path("/proc/self") if os.geteuid() == 0 else tmp_path  # the superuser may write everywhere but there
    tmp_path.chmod(0o500)
    try:
        assert main([word.format(place) for word in words]) == 2
    finally:
        tmp_path.chmod(0o700)
    error = capsys.readouterr().err
    assert error.startswith("crowdbot: ")
    assert str(place) in error
    assert "Traceback" not in error
    assert not list(tmp_path.iterdir())


def test_an_experiment_without_standard_input_waits(experiment):
    done = shell(experiment, f"{' '.join(RUN)} <&-")
    assert done.returncode == 2
    assert "--resume" in done.stderr
    assert "Traceback" not in done.stderr
    again = run(experiment, "-m", "crowdbot", *RUN, "--resume", text="\n")
    assert again.returncode == 0, again.stderr
    assert "session   done" in again.stdout


def test_an_experiment_without_output_records_everything(experiment):
    done = shell(experiment, f"{' '.join(RUN)} >&- 2>&- < experiment.xml")
    assert done.returncode == 0
    assert list(experiment.glob("data/participant-001/*/episode.mcap"))


def test_an_experiment_prints_to_an_output_of_ascii(experiment):
    done = run(experiment, "-m", "crowdbot", *RUN, text="\n", PYTHONIOENCODING="ascii")
    assert done.returncode == 0, done.stderr
    assert "Gr?? Gott, Zo?" in done.stdout
    log = (experiment / "data" / "participant-001" / "session.jsonl").read_text(encoding="utf-8")
    assert "Grüß Gott, Zoë → go" in log


def test_an_error_in_user_code_is_a_failed_trial_with_its_message_and_place(experiment):
    (experiment / "broken.py").write_text(BROKEN)
    (experiment / "walk.xml").write_text(WALK.format("broken.py:Broken"))
    done = run(experiment, "-m", "crowdbot", *RUN, text="\nnext\n")
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr + done.stdout
    assert "RuntimeError: no more battery" in done.stdout
    assert "broken.py" in done.stdout
