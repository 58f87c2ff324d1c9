"""Checks read the classes of Python files beside a trial and never run them; running says whose code it loads."""

from __future__ import annotations

import logging.config
from pathlib import Path

import pytest

from crowdbot import navigation
from crowdbot.cli import main
from crowdbot.core import InputError, TrialError, find_class, without_running_code
from crowdbot.trials import load_trial
from trial_texts import SHY, changed, written

TRAP = 'from pathlib import Path\nPath(__file__).with_name("ran").write_text("yes")\n'


def trial_with(folder: Path, code: str, attributes: str = "", name: str = "Shy") -> Path:
    (folder / "shy.py").write_text(TRAP + code)
    return written(folder, changed('type="straight"', f'type="shy.py:{name}" {attributes}'))


def problems(trial: Path) -> list[str]:
    """Return what is wrong with a trial that is only read."""
    with without_running_code():
        try:
            load_trial(trial)
        except TrialError as error:
            return [*error.problems]
    return []


def test_a_check_runs_no_code_and_a_run_says_whose_it_loads(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    trial = trial_with(tmp_path, SHY, 'space="0.7"')
    assert main(["check", str(trial)]) == 0
    assert not (tmp_path / "ran").exists()
    assert "loads code" not in capsys.readouterr().err
    assert main(["run", str(trial)]) in (0, 1)
    assert (tmp_path / "ran").exists()
    assert "loads code from shy.py" in capsys.readouterr().err


def test_a_package_that_sets_up_logging_does_not_hide_whose_code_runs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    trial = trial_with(tmp_path, SHY, 'space="0.7"')
    logging.config.dictConfig({"version": 1})
    assert main(["run", str(trial)]) in (0, 1)
    assert "loads code from shy.py" in capsys.readouterr().err


@pytest.mark.parametrize("place", ["robot", "sweep"])
def test_a_check_runs_no_code_of_robots_and_sweeps(tmp_path: Path, place: str) -> None:
    drive = "from crowdbot.world import DifferentialDrive\nclass Slow(DifferentialDrive):\n    pass\n"
    (tmp_path / "mine").mkdir()
    for folder in (tmp_path, tmp_path / "mine"):
        (folder / "slow.py").write_text(TRAP + drive + SHY)
    if place == "robot":
        robot = '<robot name="mine"><footprint radius="0.3"/><drive type="slow.py:Slow"/></robot>'
        (tmp_path / "mine" / "robot.xml").write_text(robot)
        main(["check", str(tmp_path / "mine")])
    else:
        sweep = '<sweep path="robot/navigator/type" values="straight slow.py:Shy"/><stage'
        assert main(["check", str(written(tmp_path, changed("<stage", sweep)))]) == 0
    assert not list(tmp_path.rglob("ran"))


def test_a_described_class_is_written_with_its_address(tmp_path: Path) -> None:
    trial = trial_with(tmp_path, SHY, 'space="0.7"')
    with without_running_code():
        read = load_trial(trial, **{"robot/navigator/space": 0.5})
    assert read.robots[0].navigator.space == 0.5  # type: ignore[attr-defined]
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize(
    ("code", "attributes", "sentence"),
    [
        (SHY, 'spce="1"', "has no attribute 'spce', did you mean 'space'?"),
        (SHY, 'space="wide"', "space: 'wide' is not a number"),
        (SHY.replace("float = 1.0", "float"), "", "needs the attribute 'space'"),
        (SHY.replace("class Shy", "class Bold"), "", "is not a concrete Navigator; shy.py defines Bold"),
        (SHY.replace("Shy(Navigator)", "Shy"), "", "is not a concrete Navigator; shy.py defines Shy"),
        (SHY.replace("def act", "def go"), "", "is not a concrete Navigator; shy.py defines Shy"),
        ("Shy = 3", "", "is not a concrete Navigator; shy.py defines none"),
        ("class Shy(:", "", "shy.py cannot be loaded: SyntaxError"),
        ("x = " + "(" * 3000 + ")" * 3000, "", "shy.py cannot be loaded"),
        ("\0", "", "shy.py cannot be loaded"),
    ],
)
def test_what_is_wrong_with_a_class_is_found_without_running_it(
    tmp_path: Path, code: str, attributes: str, sentence: str
) -> None:
    found = problems(trial_with(tmp_path, code, attributes))
    assert len(found) == 1
    assert sentence in found[0]
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize(
    "field",
    [
        "space: float = 2 * SPACE",
        "space: 'float' = 1.0",
        "space: float | None = None",
        "space: Optional[float] = None",
        "space: float = dataclasses.field(default=2.0)",
        "space: float = dataclasses.field(default_factory=lambda: 2.0)",
        "space: float = os.getpid() / 1e6",
        "space: Wish = Wish()",
        "space: float = parameter(1.0, unit='m', low=0.0, high=2.0, source='own')",
    ],
)
@pytest.mark.parametrize("attributes", ["", 'space="0.4"'])
def test_fields_of_every_form_are_read(tmp_path: Path, field: str, attributes: str) -> None:
    head = "import dataclasses, os\nfrom typing import Optional\nfrom crowdbot.core import parameter\nSPACE = 0.5\n"
    code = head + "class Wish: pass\n" + SHY.replace("space: float = 1.0", field)
    assert problems(trial_with(tmp_path, code, attributes)) == []
    assert not (tmp_path / "ran").exists()


def test_base_classes_are_followed(tmp_path: Path) -> None:
    code = SHY + "\n@dataclass(frozen=True)\nclass Shyer(Shy):\n    more: int = 2\n"
    assert problems(trial_with(tmp_path, code, 'space="0.4" more="3"', "Shyer")) == []
    code = "import crowdbot.navigation as nav\nclass Mine(nav.ORCANavigator):\n    pass\n"
    assert problems(trial_with(tmp_path, code, 'speed="0.4"', "Mine")) == []
    assert "speed" in problems(trial_with(tmp_path, code, 'speed="-1"', "Mine"))[0]


def test_modules_are_found_without_importing_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "guests"
    package.mkdir()
    (package / "__init__.py").write_text(TRAP)
    (package / "shy.py").write_text(TRAP + SHY)
    monkeypatch.syspath_prepend(str(tmp_path))
    with without_running_code():
        found = find_class("guests.shy:Shy", navigation, navigation.Navigator)
        with pytest.raises(InputError, match="the module 'guests.none' is not found as a Python file"):
            find_class("guests.none:Shy", navigation, navigation.Navigator)
        with pytest.raises(InputError, match="is not loaded from here; pass --trust"):
            find_class("guests.shy:Shy", navigation, navigation.Navigator, trust=False)
    assert issubclass(found, navigation.Navigator)
    assert not (package / "ran").exists()


@pytest.mark.parametrize("noise", ["gaussian(-0.0)", "gaussian(0)", "peak(0.1, 1.0, -0.0)"])
def test_a_noise_of_zero_width_is_checked_and_run_alike(tmp_path: Path, noise: str) -> None:
    trial = written(tmp_path, changed('noise="gaussian(0.01)"', f'noise="{noise}"'))
    assert main(["check", str(trial)]) == 0
    assert main(["run", str(trial)]) in (0, 1)


@pytest.mark.parametrize("part", ["navigator", "crowd"])
def test_a_default_that_only_running_code_knows_does_not_stop_a_check(tmp_path: Path, part: str) -> None:
    """A sweep reads the trial once more from its elements."""
    (tmp_path / "shy.py").write_text("import os\n" + SHY.replace("float = 1.0", "float = os.getpid() / 1e6"))
    model = "import os\nfrom dataclasses import dataclass\nfrom crowdbot.models import ORCA\n"
    (tmp_path / "mine.py").write_text(
        f"{model}@dataclass(frozen=True)\nclass Mine(ORCA):\n    wish: float = os.nice(0)\n"
    )
    old, new = (
        ('type="straight"', 'type="shy.py:Shy"') if part == "navigator" else ('type="orca"', 'type="mine.py:Mine"')
    )
    text = changed(old, new).replace("<stage", '<sweep path="duration" values="3 4"/><stage', 1)
    trial = written(tmp_path, text)
    with without_running_code():
        assert load_trial(trial, duration=2).duration == 2.0
    assert main(["check", str(trial)]) == 0


def test_an_unreadable_default_is_no_problem_of_a_person(tmp_path: Path) -> None:
    model = "import os\nfrom dataclasses import dataclass\nfrom crowdbot.models import ORCA\n"
    (tmp_path / "mine.py").write_text(
        f"{model}@dataclass(frozen=True)\nclass Mine(ORCA):\n    wish: float = os.nice(0)\n"
    )
    agent = '<agent x="1" y="0.5"><parameter name="wish" value="3"/></agent><robot'
    trial = written(tmp_path, changed('type="orca"', 'type="mine.py:Mine"').replace("<robot", agent, 1))
    with without_running_code():
        assert load_trial(trial).agents[0].parameters[0].value == 3.0
    trial.write_text(trial.read_text().replace('name="wish" value="3"', 'name="wish"'))
    with without_running_code(), pytest.raises(TrialError, match="needs the attribute 'value'"):
        load_trial(trial)
