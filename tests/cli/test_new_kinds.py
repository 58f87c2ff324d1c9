"""Every kind of ``crowdbot new``: the program writes it, pytest runs its contract test, and a command uses it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import crowdbot as cb
from crowdbot.cli.new import KINDS

SOURCES = Path(cb.__file__).parents[1]
TRIAL = """<trial name="mine" duration="2">
  <stage {stage}/>
  <crowd type="orca"/>
  <agent name="ann" x="5" y="1" goal="1,1"/>
  <robot {robot} x="1" y="1">
    <goal x="6" y="1"/>{inner}
    <navigator type="straight"/>
  </robot>
</trial>
"""
AREA = 'walkable="0,0 7,0 7,4 0,4"'
PLAIN = '\n    <drive type="differential-drive"/>'
SENSOR = PLAIN + '\n    <sensor name="mine" type="mine.py:Mine" rate="5"/>'
USES = {
    "model": ["predict", "--data", "crowd.csv", "--predictor", "simulated", "--model", "mine.py:Mine"],
    "predictor": ["predict", "--data", "crowd.csv", "--predictor", "mine.py:Mine", "--set", "tau=8"],
    "goal": ["predict", "--data", "crowd.csv", "--predictor", "simulated", "--goal", "mine.py:Mine"],
    "cost": [
        "calibrate",
        "--data",
        "crowd.csv",
        "--cost",
        "mine.py:Mine",
        "--search",
        "random-search",
        "--budget",
        "4",
    ],
    "navigator": ["run", "frontal", "--set", "robot/navigator/type=mine.py:Mine", "--set", "duration=2"],
    "sensor": ["run", "hall.xml", "--out", "out"],
    "robot": ["run", "hall.xml"],
    "stage": ["run", "hall.xml"],
    "trial": ["run", "mine.xml"],
}
FILES = {"stage": "mine.geojson", "trial": "mine.xml", "robot": "mine"}
TRIALS = {
    "sensor": TRIAL.format(stage=AREA, robot='radius="0.3"', inner=SENSOR),
    "robot": TRIAL.format(stage=AREA, robot='type="mine" sensor-rates="nearest"', inner=""),
    "stage": TRIAL.format(stage='area="mine.geojson"', robot='radius="0.3"', inner=PLAIN),
}


def run(folder, *words):
    environment = {**os.environ, "PYTHONPATH": str(SOURCES), "CROWDBOT_DEBUG": ""}
    return subprocess.run(
        [sys.executable, "-m", *map(str, words)],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )


def walkers(steps=24):
    """Return a recording of four people as CSV: frame, id, x, y."""
    rows = [f"{k},{p},{0.4 * k * (-1) ** p},{1.5 * p}" for k in range(steps) for p in range(4)]
    return "frame,id,x,y\n" + "\n".join(rows) + "\n"


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "schema"])
def test_every_kind_keeps_its_contract_and_is_ready_to_use(kind, tmp_path):
    name = FILES.get(kind, "mine.py")
    done = run(tmp_path, "crowdbot", "new", kind, name)
    assert (done.returncode, done.stderr) == (0, "")
    assert "wrote test_mine.py" in done.stdout
    tested = run(tmp_path, "pytest", "-q", "-p", "no:cacheprovider", "test_mine.py")
    assert tested.returncode == 0, tested.stdout
    assert "1 passed" in tested.stdout
    (tmp_path / "crowd.csv").write_text(walkers())
    if kind in TRIALS:
        (tmp_path / "hall.xml").write_text(TRIALS[kind])
        checked = run(tmp_path, "crowdbot", "check", "hall.xml")
        assert checked.returncode == 0, checked.stdout
    words = [*USES[kind], "--fps", "2.5"] if "--data" in USES[kind] else USES[kind]
    used = run(tmp_path, "crowdbot", *words, "--json")
    assert used.returncode == 0, used.stderr
    assert used.stdout.startswith("{")


@pytest.mark.parametrize(
    ("kind", "before", "after", "sentence"),
    [
        ("model", "return np.where(scene.external", "return -np.where(scene.external", "changes external agents"),
        ("predictor", "self.check(past, steps, samples)", "pass", "call self.check"),
        ("sensor", "return reading, count", "return reading", "it must return (Reading, state)"),
        ("goal", "np.where(past.present[:, -1, :, None], goal, 0.0)", "goal + 1.0", "must be finite, and 0"),
        ("cost", "np.nan)", "0.0)", "counts robots"),
        ("navigator", "return cb.Twist(0.0,", "return (0.0,", "must give a Twist"),
    ],
)
def test_a_contract_test_finds_a_breach(kind, before, after, sentence, tmp_path):
    assert run(tmp_path, "crowdbot", "new", kind, "mine.py").returncode == 0
    text = (tmp_path / "mine.py").read_text()
    assert before in text
    (tmp_path / "mine.py").write_text(text.replace(before, after))
    tested = run(tmp_path, "pytest", "-q", "-p", "no:cacheprovider", "test_mine.py")
    assert tested.returncode == 1
    assert sentence in tested.stdout


def test_the_class_has_the_name_of_the_file(tmp_path):
    done = run(tmp_path, "crowdbot", "new", "navigator", "very_shy.py")
    assert "class VeryShy(cb.Navigator)" in (tmp_path / "very_shy.py").read_text()
    assert done.stdout.splitlines()[-1] == (
        "use it    crowdbot run frontal --set robot/navigator/type=very_shy.py:VeryShy"
    )


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["model", "my-model.py"], "'my-model.py' is not a Python module; name it like my_model.py"),
        (["sensor", "mine.txt"], "'mine.txt' is not a Python module; name it like my_sensor.py"),
        (["stage", "mine.xml"], "'mine.xml' must end in .geojson"),
        (["robot", "my robot"], "'my robot' is no name of a robot folder"),
        (["goal", "here.py"], "test_here.py exists already"),
        (["goal", "gone/mine.py"], "there is no folder gone"),
    ],
)
def test_wrong_names_write_nothing(words, sentence, tmp_path):
    (tmp_path / "test_here.py").write_text("")
    done = run(tmp_path, "crowdbot", "new", *words)
    assert done.returncode == 2
    assert done.stderr.startswith(f"crowdbot: {sentence}")
    assert [path.name for path in tmp_path.iterdir()] == ["test_here.py"]


SHY = """from dataclasses import dataclass

import crowdbot as cb

from .speeds import SLOW


@dataclass(frozen=True)
class Shy(cb.Navigator):
    def act(self, observation):
        return observation.towards_goal(SLOW)
"""


@pytest.mark.parametrize("address", ["lab/:Shy", "lab:Shy", "lab.shy:Shy", "lab/:shy.Shy"])
def test_a_folder_of_files_is_a_package(address, tmp_path):
    (tmp_path / "lab").mkdir()
    (tmp_path / "lab" / "shy.py").write_text(SHY)
    (tmp_path / "lab" / "speeds.py").write_text("SLOW = 0.3\n")
    text = TRIAL.format(stage=AREA, robot='radius="0.3"', inner=PLAIN).replace("straight", address)
    (tmp_path / "hall.xml").write_text(text)
    assert run(tmp_path, "crowdbot", "check", "hall.xml").returncode == 0
    done = run(tmp_path, "crowdbot", "run", "hall.xml", "--out", "out")
    assert done.returncode == 0, done.stderr
    (tmp_path / "lab").rename(tmp_path / "out" / "lab")  # a replay finds the code beside the episode
    again = run(tmp_path, "crowdbot", "replay", "out/episode.mcap")
    assert again.returncode == 0, again.stderr
    (tmp_path / "out" / "lab" / "speeds.py").write_text("SLOW = 0.4\n")
    changed = run(tmp_path, "crowdbot", "replay", "out/episode.mcap")
    assert changed.returncode == 2
    assert "'lab/speeds.py'" in changed.stderr
