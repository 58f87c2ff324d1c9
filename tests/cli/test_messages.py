"""Messages and tables of commands: suggestions, warnings and the width of tables."""

import sys

import pytest

from crowdbot.cli import main
from crowdbot.cli.output import print_table

WALK = "id,frame,x,y\n" + "".join(f"1,{row},{0.5 * row},0\n" for row in range(25))


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["predict", "--data", "a.csv", "--predictr", "kalman"], "--predictr kalman, did you mean '--predictor'?"),
        (["run", "frontal", "more"], "crowdbot run: error: unrecognized arguments: more; see crowdbot run --help"),
        (["experiment", "order", "e.xml", "--participant", "2"], "did you mean '--participants'?"),
    ],
)
def test_unknown_options_have_a_suggestion_on_one_line(capsys, words, sentence):
    with pytest.raises(SystemExit) as end:
        main(words)
    said = capsys.readouterr().err
    assert end.value.code == 2
    assert sentence in said
    assert said.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["run", "frontal", "--seed", "abc"], "argument --seed: 'abc' must be a whole number\n"),
        (["run", "frontal", "--pace", "fast"], "argument --pace: 'fast' must be a number\n"),
        (["new", "senser", "a.py"], "argument KIND: 'senser' must be model, predictor, sensor, "),
        (["new", "senser", "a.py"], ", schema, did you mean 'sensor'?\n"),
    ],
)
def test_the_parser_names_the_value_and_what_is_allowed(capsys, words, sentence):
    with pytest.raises(SystemExit) as end:
        main(words)
    assert end.value.code == 2
    assert sentence in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["run", "frontal", "--pace", "0"], "--pace 0 must be above 0"),
        (["run", "frontl"], "did you mean 'frontal'?; it is neither a file nor a built-in name; crowdbot list trials"),
        (["run", "{}/a.csv/b"], "there is no trial file"),
        (["predict", "--data", "{}/a.csv", "--step", "0"], "step = 0.0 s must be above 0"),
        (["list", "models", "orca"], "crowdbot list models takes no name"),
    ],
)
def test_wrong_values_are_named(tmp_path, capsys, words, sentence):
    (tmp_path / "a.csv").write_text(WALK)
    assert main([word.format(tmp_path) for word in words]) == 2
    assert sentence in capsys.readouterr().err


def test_units_that_make_people_too_slow_cause_a_warning(tmp_path, capsys):
    (tmp_path / "a.csv").write_text(WALK)
    assert main(["predict", "--data", str(tmp_path / "a.csv"), "--fps", "2.5"]) == 0
    assert "impossible" not in capsys.readouterr().err
    assert main(["predict", "--data", str(tmp_path / "a.csv"), "--fps", "2.5", "--units", "cm"]) == 0
    assert (
        "the median speed 0.013 m/s is impossible for people: check the frame rate (fps) and the units"
        in capsys.readouterr().err
    )


def test_a_folder_without_a_robot_is_named(tmp_path, capsys):
    assert main(["check", str(tmp_path)]) == 2
    assert f"{tmp_path} is a folder without robot.xml" in capsys.readouterr().out


def test_an_empty_table_says_what_the_episode_lacks(tmp_path, capsys):
    assert main(["run", "empty-corridor", "--set", "duration=1", "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    assert main(["export", str(tmp_path / "episode.mcap"), "--table", "images", "--to", str(tmp_path / "i.csv")]) == 0
    assert "i.csv: 0 rows: the episode holds no images" in capsys.readouterr().out


def test_a_wide_table_breaks_names_at_hyphens_in_a_narrow_terminal(capsys, monkeypatch):
    head = ("predictor", "windows", "persons", "ADE [m]", "95 %", "FDE [m]", "collisions", "ms/window")
    row = ("constant-velocity", "9", "339", "0.197", "0.138-0.258", "0.416", "8.0 %", "0.544")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "80")
    print_table("a title that is longer than the table", head, [row])
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    assert "constant- 9 339 0.197 0.138-0.258 0.416 8.0 % 0.544" in lines
    assert "velocity" in lines


def test_a_table_without_column_names_has_no_header(capsys):
    print_table("a title that is longer than the table", ("", ""), [("seed", "0")])
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    assert [line for line in lines if line] == ["a title that is longer than the table", "seed   0"]
