"""``crowdbot new``, ``--set``, ``--variant`` and the parameters of built-in trials."""

import json
import shutil

import pytest

from crowdbot.cli import main
from crowdbot.core import TrialError
from crowdbot.trials import load_trial, schema, trial_xml


def refused(capsys, tmp_path, *words):
    before = sorted(tmp_path.rglob("*"))
    assert main([str(word) for word in words]) == 2
    said = capsys.readouterr()
    assert said.err.startswith("crowdbot: ")
    assert said.out == ""
    assert sorted(tmp_path.rglob("*")) == before
    return said.err


def test_a_trial_is_written_from_a_builtin_one(tmp_path, capsys):
    file = tmp_path / "mine.xml"
    assert main(["new", "trial", str(file), "--from", "two-way", "--set", "density=0.1", "--seed", "9"]) == 0
    test = tmp_path / "test_mine.py"
    lines = (f"wrote {file}", f"wrote {test}", f"test it   pytest {test}", f"use it    crowdbot run {file}")
    assert capsys.readouterr().out.splitlines() == [*lines]
    trial = load_trial(file)
    assert (trial.people, trial.seed) == (24, 9)
    assert main(["check", str(file)]) == 0
    capsys.readouterr()
    assert "already exists" in refused(capsys, tmp_path, "new", "trial", file)
    assert main(["new", "trial", str(file), "--force", "--explicit", "--set", "gap=5"]) == 0
    assert len(load_trial(file).agents) == 1


def test_the_schema_is_written(tmp_path):
    file = tmp_path / "trial.xsd"
    assert main(["new", "schema", str(file)]) == 0
    assert file.read_text(encoding="utf-8") == schema()


def test_a_trial_is_written_from_a_recording_and_from_an_original_file(tmp_path, capsys):
    data = tmp_path / "data" / "two.txt"
    data.parent.mkdir()
    data.write_text("".join(f"{10 * k}\t{p}\t{0.5 * k}\t{2 * p}\n" for k in range(20) for p in (1, 2)))
    (tmp_path / "out").mkdir()
    file = tmp_path / "out" / "two.xml"
    words = ["new", "trial", str(file), "--recorded", str(data), "--fps", "25", "--reactive", "--replace", "2"]
    assert main(words) == 0
    assert "copied two.txt to the folder of the trial" in capsys.readouterr().err
    assert load_trial(file).recorded[0].mode == "reactive"
    assert main(["run", str(file)]) == 0
    original = tmp_path / "original.xml"
    original.write_text("<Trial><agents/></Trial>")
    capsys.readouterr()
    assert main(["new", "trial", str(tmp_path / "imported.xml"), "--import", str(original)]) == 0
    assert "not imported:\n  - no end by time was set" in capsys.readouterr().out
    assert main(["check", str(tmp_path / "imported.xml")]) == 0


COLUMNS = ["--columns", "id=who", "time=clock", "x=east", "y=north"]


@pytest.mark.parametrize(
    ("per", "second", "words"),
    [
        (100.0, 1.0, [*COLUMNS, "--units", "cm"]),
        (1.0 / 0.3048, 1.0, [*COLUMNS, "--units", "export=ft"]),
        (50.0, 1.0, [*COLUMNS, "--scale", "0.02"]),
        (50.0, 1.0, [*COLUMNS, "--homography", "{}/H.txt"]),
        (1.0, 1000.0, ["--columns", "id=who", "time_ms=clock", "x=east", "y=north"]),
        (1.0, 1.0, [*COLUMNS, "label=kind", "--agents", "pedestrians"]),
    ],
)
def test_a_trial_from_a_recording_has_the_options_of_predict(tmp_path, capsys, per, second, words):
    rows = [(who, second * 0.4 * k, per * 0.5 * k, per * 2.0 * who) for k in range(20) for who in (1, 2)]
    rows += [(3, second * 0.4 * k, per * 2.0 * k, per * 9.0) for k in range(20)] * ("--agents" in words)
    text = "".join(f"{','.join(map(str, row))},{'car' if row[0] == 3 else 'pedestrian'}\n" for row in rows)
    (tmp_path / "export.csv").write_text("who,clock,east,north,kind\n" + text)
    (tmp_path / "H.txt").write_text("0.02 0 0\n0 0.02 0\n0 0 1\n")
    file = tmp_path / "t.xml"
    words = [word.format(tmp_path) for word in words]
    assert main(["new", "trial", str(file), "--recorded", str(tmp_path / "export.csv"), *words, "--replace", "1"]) == 0
    said = capsys.readouterr().err
    assert "warning" not in said
    people = load_trial(file).recorded[0]
    tracks = people.tracks()
    assert (people.data, tracks.ids.tolist(), tracks.dt) == ("export.csv", [1, 2], pytest.approx(0.4))
    assert tracks.x.max() == pytest.approx(9.5)
    assert main(["check", str(file)]) == 0
    capsys.readouterr()
    (tmp_path / "else").mkdir()
    again = ["new", "trial", tmp_path / "else" / "v.xml", "--recorded", tmp_path / "export.csv", *words]
    assert main([str(word) for word in again]) == 0
    assert "copied export.csv to the folder of the trial" in capsys.readouterr().err
    assert load_trial(tmp_path / "else" / "v.xml").recorded[0].tracks().x.max() == pytest.approx(9.5)
    wrong = ["new", "trial", tmp_path / "u.xml", "--recorded", tmp_path / "export.csv", *words, "--replace", "77"]
    assert main([str(word) for word in wrong]) == 2
    assert not list(tmp_path.glob("u*"))


def test_a_trial_from_a_recording_says_what_is_odd_in_it(tmp_path, capsys):
    rows = [f"{who},{400 * k},{0.5 * k},{2 * who}\n" for k in range(20) for who in (1, 2)]
    (tmp_path / "milli.csv").write_text("id,time,x,y\n" + "".join(rows))
    file = str(tmp_path / "t.xml")
    assert main(["new", "trial", file, "--recorded", str(tmp_path / "milli.csv")]) == 0
    assert "milli.csv: warning: the times in time are 400 s apart" in capsys.readouterr().err
    assert main(["check", file]) == 0
    assert "they are probably in milliseconds, give --columns time_ms=time" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["new", "trial", "{}/gone/t.xml"], "t.xml does not exist"),
        (["new", "trial", "{}/t.xml", "--from", "frontl"], "there is no trial 'frontl', did you mean 'frontal'?"),
        (["new", "trial", "{}/t.xml", "--set", "width"], "--set 'width' must be NAME=VALUE"),
        (["new", "trial", "{}/t.xml", "--set", "width=2", "--set", "width=3"], "--set width is given twice"),
        (["new", "trial", "{}/t.xml", "--set", "width=99"], "must be from 1.2 to 20 m"),
        (["new", "trial", "{}/t.xml", "--set", "trust=true"], "frontal has no parameter 'trust'"),
        (["new", "trial", "{}/t.xml", "--import", "{}/none.xml"], "there is no trial file"),
        (["new", "trial", "{}/t.xml", "--recorded", "{}/none.txt"], "there is no file 'none.txt'"),
        (
            ["new", "trial", "{}/t.xml", "--recorded", "{}/none.txt", "--units", "citr=cm"],
            "--units citr=cm: no recording has 'citr' in its path",
        ),
        (["run", "frontal", "--variant", "1"], "--variant 1: frontal has no variants"),
        (["run", "frontal", "--set", "widht=2"], "frontal has no parameter 'widht', did you mean 'width'?"),
        (["list", "trials", "frontl"], "'frontl' is not a built-in trial with parameters, did you mean 'frontal'?"),
    ],
)
def test_wrong_words_are_told_and_nothing_is_written(tmp_path, capsys, words, sentence):
    assert sentence in refused(capsys, tmp_path, *(word.format(tmp_path) for word in words))


def test_a_trial_with_sweeps_is_run_by_its_variants(tmp_path, capsys):
    file = tmp_path / "many.xml"
    text = trial_xml(load_trial("frontal")).replace("</trial>", '  <sweep path="seed" values="3 4"/>\n</trial>')
    file.write_text(text)
    said = refused(capsys, tmp_path, "run", file)
    assert "has 2 variants in its sweeps; run one of them with --variant 1 to 2" in said
    assert "has 2 variants" in refused(capsys, tmp_path, "run", file, "--variant", "3")
    assert main(["run", str(file), "--variant", "2", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["seed"] == 4
    assert main(["check", str(file), "--json"]) == 0
    assert len(next(iter(json.loads(capsys.readouterr().out).values()))["variants"]) == 2


def test_the_parameters_of_a_builtin_trial_are_listed(capsys):
    assert main(["list", "trials", "intersection", "--json"]) == 0
    options = json.loads(capsys.readouterr().out)["intersection"]
    assert {"density", "angle", "delay", "model", "navigator", "robot", "reactive", "seed"} <= set(options)
    assert main(["list", "trials", "intersection"]) == 0
    said = capsys.readouterr().out
    assert "people in the side corridor" in said
    assert "Intersection No Gesture (Francis et al. 2025" in said
    assert main(["list", "scenarios", "--json"]) == 0
    scenarios = json.loads(capsys.readouterr().out)["scenarios"]
    assert scenarios["Narrow Hallway"].startswith("frontal --set width=1.2: ")
    assert scenarios["Intersection Gesture Wait"].startswith("intersection-gesture-wait: ")
    assert main(["run", "intersection", "--set", "density=0.5", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["outcome"] in ("success", "collision", "timeout")


def test_a_trial_from_a_bag_and_from_a_table_without_names(tmp_path, capsys):
    rows = "".join(f"{k / 10:.1f};{who};{0.13 * k:.3f};{2 * who};9\n" for k in range(40) for who in (1, 2))
    (tmp_path / "plain.csv").write_text(rows)
    words = ["--recorded", str(tmp_path / "plain.csv"), "--columns", "time=1", "id=2", "x=3", "y=4"]
    assert main(["new", "trial", str(tmp_path / "t.xml"), *words]) == 0
    assert 'columns="time=1 id=2 x=3 y=4"' in (tmp_path / "t.xml").read_text()
    assert load_trial(tmp_path / "t.xml").recorded[0].tracks().ids.tolist() == [1, 2]
    assert main(["check", str(tmp_path / "t.xml")]) == 0
    capsys.readouterr()
    both = ["--scale", "0.02", "--homography", str(tmp_path / "H.txt")]
    assert "coordinates have one scale" in refused(capsys, tmp_path, "new", "trial", tmp_path / "u.xml", *words, *both)


def walkers(folder, columns="time,x,y"):
    """Write a folder with one file a person."""
    folder.mkdir()
    for who in (3, 4):
        rows = "".join(f"{50 + 0.4 * k:g},{100 * (0.5 * k + who):g},{150 * who}\n" for k in range(20))
        (folder / f"p{who}.csv").write_text(f"{columns}\n{rows}")
    return folder


@pytest.mark.parametrize("columns", ["time,x,y", "when,east,north"])
def test_a_folder_of_one_file_a_person_becomes_a_trial(tmp_path, capsys, columns):
    data = walkers(tmp_path / "walkers", columns)
    named = [f"{name}={column}" for name, column in zip(("time", "x", "y"), columns.split(","), strict=True)]
    (tmp_path / "out").mkdir()
    file = tmp_path / "out" / "t.xml"
    words = ["new", "trial", str(file), "--recorded", str(data), "--units", "cm", "--columns", *named]
    assert main(words) == 0
    assert "copied walkers to the folder of the trial" in capsys.readouterr().err
    (people,) = load_trial(file).recorded
    tracks = people.tracks()
    assert (people.data, tracks.ids.tolist(), len(tracks)) == ("walkers", [3, 4], 40)
    assert tracks.position.max(axis=0).tolist() == pytest.approx([13.5, 6.0])
    assert main([*words, "--force"]) == 0  # the copy is there with the same files
    capsys.readouterr()
    (data / "p5.csv").write_text((data / "p4.csv").read_text())
    assert "exists with a different content" in refused(capsys, tmp_path, *words, "--force")


def test_an_episode_keeps_the_folder_of_its_recording(tmp_path, capsys):
    walkers(tmp_path / "walkers")
    file = tmp_path / "t.xml"
    assert main(["new", "trial", str(file), "--recorded", str(tmp_path / "walkers"), "--units", "cm"]) == 0
    assert main(["run", str(file), "--out", str(tmp_path / "run")]) == 0
    shutil.rmtree(tmp_path / "walkers")
    capsys.readouterr()
    assert main(["replay", str(tmp_path / "run" / "episode.mcap")]) == 0
    assert "replays with the same digest" in capsys.readouterr().out
    assert main(["check", str(file)]) == 2
    assert "there is no file 'walkers'" in capsys.readouterr().out


def test_a_folder_of_a_trial_has_no_file_from_elsewhere(tmp_path):
    (tmp_path / "trial").mkdir()
    walkers(tmp_path / "trial" / "walkers")
    (tmp_path / "secret.csv").write_text("time,x,y\n0,0,0\n0.4,1,1\n")
    (tmp_path / "trial" / "walkers" / "p9.csv").symlink_to(tmp_path / "secret.csv")
    text = '<trial name="t" duration="2"><crowd type="orca"/><recorded data="walkers"/></trial>'
    (tmp_path / "trial" / "t.xml").write_text(text)
    with pytest.raises(TrialError, match=r"'walkers/p9\.csv' lies outside"):
        load_trial(tmp_path / "trial" / "t.xml")
    assert len(load_trial(tmp_path / "trial" / "t.xml", trust=True).recorded[0].tracks().ids) == 3
