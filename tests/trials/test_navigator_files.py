"""Files of navigators: in the folder of the trial, read with it, and kept by its recordings."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from crowdbot.core import InputError, TrialError
from crowdbot.navigation import Navigator, PolicyNavigator, policy_file
from crowdbot.recording import named_files, record, replay
from crowdbot.trials import Trial, load_trial, parse_trial, trial_xml

LEARNED = ("policy", "attention-policy", "recurrent-policy", "scan-policy")
TABLE = """
from dataclasses import dataclass
from pathlib import Path
import crowdbot as cb


@dataclass(frozen=True)
class Table(cb.Navigator):
    speeds: str = "speeds.txt"
    file_parameters = ("speeds",)

    def act(self, observation):
        return observation.towards_goal(float(Path(self.speeds).read_text()))
"""


def hall(folder: Path, name: str, file: str, trust: bool = True) -> Trial:
    """Return a trial in a folder whose robot has a navigator with a file."""
    text = trial_xml(load_trial("frontal", duration=1.0)).replace(
        '<navigator type="orca"/>', f'<navigator type="{name}" file="{file}"/>'
    )
    assert file in text
    return parse_trial(text, folder=folder, trust=trust)


@pytest.mark.parametrize("name", LEARNED)
def test_weights_start_from_the_folder_of_the_trial_and_are_recorded(name: str, tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "own.npz").write_bytes(policy_file(name).read_bytes())
    trial = hall(folder, name, "own.npz", trust=False)
    assert trial.robots[0].controller.file == str(folder / "own.npz")  # type: ignore[attr-defined]
    assert 'file="own.npz"' in trial_xml(trial)
    assert named_files(trial)["own.npz"] == ("data", folder / "own.npz")
    done = record(trial, 1, out=tmp_path / "run.mcap")
    (folder / "own.npz").unlink()
    assert replay(tmp_path / "run.mcap").recorded == done.digest
    with pytest.raises(TrialError, match=r"navigator file=\"own.npz\": there is no file 'own.npz' in "):
        hall(folder, name, "own.npz")


def test_weights_outside_the_folder_need_trust_and_damaged_ones_are_refused(tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    (tmp_path / "out.npz").write_bytes(policy_file().read_bytes())
    assert hall(folder, "policy", "../out.npz").robots
    with pytest.raises(TrialError, match=r"\.\./out.npz\": the file .* lies outside .*--trust"):
        hall(folder, "policy", "../out.npz", trust=False)
    (folder / "own.npz").write_bytes(policy_file().read_bytes()[:1000])
    with pytest.raises(TrialError, match=r"navigator file=\"own.npz\": .*own.npz has no weights of a policy"):
        hall(folder, "policy", "own.npz")
    robot = load_trial("frontal").robots[0]
    with pytest.raises(InputError, match="there is no file 'gone.npz'"):
        dataclasses.replace(robot, navigator=PolicyNavigator(file="gone.npz"))


def test_an_own_navigator_can_have_files(tmp_path: Path) -> None:
    (tmp_path / "table.py").write_text(TABLE)
    (tmp_path / "speeds.txt").write_text("0.5")
    text = trial_xml(load_trial("frontal", duration=1.0)).replace(
        '<navigator type="orca"', '<navigator type="table.py:Table" speeds="speeds.txt"'
    )
    trial = parse_trial(text, folder=tmp_path)
    assert isinstance(trial.robots[0].navigator, Navigator)
    assert set(named_files(trial)) == {"speeds.txt", "table.py"}
    assert record(trial, 1, out=tmp_path / "run.mcap").outcome == "timeout"
    assert replay(tmp_path / "run.mcap").equal
    (tmp_path / "speeds.txt").unlink()
    with pytest.raises(TrialError, match=r"navigator speeds=\"speeds.txt\": there is no file 'speeds.txt'"):
        parse_trial(text, folder=tmp_path)
