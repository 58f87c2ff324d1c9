"""Import of experiments of the CrowdBot simulator of 2021: configurations and order files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from crowdbot.cli import main
from crowdbot.core import TrialError
from crowdbot.experiments import Experiment, import_experiment, load_experiment, orders, plan
from crowdbot.trials import import_original
from trial_texts import written

TRIAL = """<Trial><scene><endingConditions><condition parameter="time" test="greater" value="{seconds}"/>
  </endingConditions></scene></Trial>"""
CONFIG = """<Config><experience currentUser="{user}" startingTrial="0" userHeight="1.8">
  <sourceFileExperiment>./Scenario/{order}.csv</sourceFileExperiment></experience><log debugLvl="0"/>
  <Recording dataSeparator=";"/></Config>"""


def study(folder: Path, order: str, user: int = 1, **files: str) -> Path:
    """Write a configuration, orders and trials a, b, c."""
    for name, text in files.items():
        written(folder / "Scenario", text, f"{name}.csv")
    for k, name in enumerate("abc"):
        written(folder / "Scenario", TRIAL.format(seconds=5 + k), f"{name}.xml")
    return written(folder, CONFIG.format(user=user, order=order), "Config.xml")


def names(experiment: Experiment, participant: int) -> list[str]:
    return [step.name for step in plan(experiment, participant) if step.role == "trial"]


def test_two_orders_become_a_latin_square(tmp_path: Path) -> None:
    config = study(tmp_path, "O{TWO}", O0="Scenario/b.xml\nScenario/a.xml\n", O1="Scenario/a.xml\nScenario/b.xml;x\n")
    done = import_experiment(config)
    (block,) = done.experiment.blocks
    assert (block.order, block.seeds, [entry.source for entry in block.trials]) == (
        "latin-square", "same", ["a.xml", "b.xml"],
    )  # fmt: skip
    assert [orders(done.experiment, block, who) for who in (1, 2, 3)] == [[[0, 1]], [[1, 0]], [[0, 1]]]
    assert [trial.duration for _, trial in done.trials] == [5.0, 6.0]
    said = "\n".join(done.left_out)
    for words in ("<Recording>", "<log>", "userHeight", "screens", "seeds"):
        assert words in said


def test_orders_that_differ_otherwise_are_told(tmp_path: Path) -> None:
    one, two, three = ("\n".join(f"Scenario/{name}.xml" for name in row) for row in ("abc", "acb", "abc"))
    config = study(tmp_path, "O{USER}", O1=one, O2=two, O3=three)
    done = import_experiment(config)
    assert done.experiment.blocks[0].order == "fixed"
    assert any("the order of participant 1 is used; those of 2 differ" in sentence for sentence in done.left_out)
    assert [entry.name for entry in import_experiment(config, participant=2).experiment.blocks[0].trials] == [*"acb"]


def test_repetitions_and_trials_that_come_again(tmp_path: Path) -> None:
    study(tmp_path, "O", O="\n".join(f"Scenario/{name}.xml" for name in "abab"), P="Scenario/a.xml\nb.xml\na.xml\n")
    done = import_experiment(tmp_path / "Config.xml")
    assert (done.experiment.blocks[0].repetitions, len(done.experiment.blocks[0].trials)) == (2, 2)
    mixed = study(tmp_path / "m", "O", O="\n".join(f"Scenario/{name}.xml" for name in "aba"))
    entries = import_experiment(mixed).experiment.blocks[0].trials
    assert [(entry.name, entry.source) for entry in entries] == [
        ("a", "a.xml"), ("b", "b.xml"), ("a_again1", "a.xml"),
    ]  # fmt: skip


def test_an_order_file_alone_is_enough(tmp_path: Path) -> None:
    study(tmp_path, "O", O="./Scenario/a.xml\n.\\Scenario\\c.xml\n")
    done = import_experiment(tmp_path / "Scenario" / "O.csv")
    assert [name for name, _ in done.trials] == ["a.xml", "c.xml"]
    assert [name for name, _ in import_original(tmp_path / "Scenario" / "O.csv").trials] == ["a", "c"]
    with pytest.raises(TrialError, match="no trial of the order"):
        import_experiment(written(tmp_path, "nothing.xml\n", "bad.csv"))
    with pytest.raises(TrialError, match=r"the root element is <x>, an original file has Trial or Config"):
        import_experiment(written(tmp_path, "<x/>", "x.xml"))


def test_names_are_short_and_each_its_own(tmp_path: Path) -> None:
    for name in ("1 trial.xml", "sub/1 trial.xml", "sub/é.xml"):
        written((tmp_path / name).parent, TRIAL.format(seconds=5), Path(name).name)
    order = written(tmp_path, "1 trial.xml\nsub/1 trial.xml\nsub/é.xml\n", "order.csv")
    done = import_experiment(order)
    assert [name for name, _ in done.trials] == ["trial_1_trial.xml", "trial_1_trial_2.xml", "trial__.xml"]


def test_the_command_writes_a_folder_that_loads(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = study(tmp_path, "O{TWO}", O0="Scenario/b.xml\nScenario/a.xml\n", O1="Scenario/a.xml\nScenario/b.xml\n")
    folder = tmp_path / "new"
    assert main(["experiment", "new", str(folder), "--import", str(config)]) == 0
    out = capsys.readouterr().out
    assert out.startswith(f"{folder}: a.xml, b.xml, experiment.xml\nnot imported:\n  - ")
    experiment = load_experiment(folder)
    assert (names(experiment, 1), names(experiment, 2)) == (["a", "b"], ["b", "a"])
    assert main(["experiment", "order", str(folder), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["orders"]["2"] == ["trials.b", "trials.a"]
    assert main(["check", str(folder / "a.xml")]) == 0
    assert main(["experiment", "new", str(folder), "--import", str(config)]) == 2
    assert "already exists" in capsys.readouterr().err
    assert main(["experiment", "new", str(tmp_path / "gone"), "--import", str(tmp_path / "none.xml")]) == 2
    assert not (tmp_path / "gone").exists()


def project(folder: Path) -> Path:
    """Write a project of the original simulator: its paths begin at the root, and its files lie deeper."""
    written(folder / "CrowdMP" / "Scenario" / "Demo", TRIAL.format(seconds=5), "a.xml")
    written(folder / "CrowdMP" / "Scenario" / "Demo", TRIAL.format(seconds=6), "b.xml")
    written(folder / "CrowdMP" / "Scenario" / "Other", TRIAL.format(seconds=9), "a.xml")
    rows = "./StreamingAssets/Scenario/Demo/a.xml\n.\\StreamingAssets\\Scenario\\Demo\\b.xml\n"
    written(folder / "CrowdMP" / "Scenario" / "Demo", rows, "FileOrder1.csv")
    config = """<Config><experience currentUser="1">
      <sourceFileExperiment>./StreamingAssets/Scenario/Demo/FileOrder{USER}.csv</sourceFileExperiment>
      </experience></Config>"""
    return written(folder / "Configs" / "deep" / "deeper" / "deepest" / "still", config, "Config.xml")


def test_paths_from_the_project_root_are_found_by_their_ends(tmp_path: Path) -> None:
    config = project(tmp_path)
    with pytest.raises(TrialError, match="the order file './StreamingAssets/Scenario/Demo/FileOrder1.csv' cannot be"):
        import_experiment(config)
    done = import_experiment(config, root=tmp_path)
    assert [(name, trial.duration) for name, trial in done.trials] == [("a.xml", 5.0), ("b.xml", 6.0)]
    order = tmp_path / "CrowdMP" / "Scenario" / "Demo" / "FileOrder1.csv"
    for root in (None, tmp_path):
        trials = import_original(order, root=root).trials
        assert [(name, trial.duration) for name, trial in trials] == [("a", 5.0), ("b", 6.0)]


def test_two_files_that_fit_equally_well_are_an_error(tmp_path: Path) -> None:
    config = project(tmp_path)
    written(tmp_path / "CrowdMP" / "Scenario" / "Demo", "./Elsewhere/a.xml\n", "FileOrder1.csv")
    with pytest.raises(TrialError, match="2 files in .* end with 'a.xml': /CrowdMP/Scenario/Demo/a.xml, /CrowdMP/"):
        import_experiment(config, root=tmp_path)
    with pytest.raises(TrialError, match="there is no folder .*nowhere"):
        import_experiment(config, root=tmp_path / "nowhere")


def test_a_root_does_not_open_files_outside_it(tmp_path: Path) -> None:
    config = project(tmp_path)
    written(tmp_path.parent, TRIAL.format(seconds=5), f"{tmp_path.name}-secret.xml")
    demo = tmp_path / "CrowdMP" / "Scenario" / "Demo"
    written(demo, f"../../../../{tmp_path.name}-secret.xml\n", "FileOrder1.csv")
    (demo / f"{tmp_path.name}-secret.xml").symlink_to(tmp_path.parent / f"{tmp_path.name}-secret.xml")
    with pytest.raises(TrialError, match="lies outside"):
        import_experiment(config, root=tmp_path)


def test_the_commands_take_the_root(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = str(project(tmp_path))
    assert main(["experiment", "new", str(tmp_path / "mine"), "--import", config, "--root", str(tmp_path)]) == 0
    assert sorted(path.name for path in (tmp_path / "mine").iterdir()) == ["a.xml", "b.xml", "experiment.xml"]
    assert main(["new", "trial", str(tmp_path / "t.xml"), "--import", config, "--root", str(tmp_path)]) == 0
    assert "t-01-a.xml" in capsys.readouterr().out
    assert main(["new", "trial", str(tmp_path / "u.xml"), "--import", config]) == 2
    assert "StreamingAssets" in capsys.readouterr().err
