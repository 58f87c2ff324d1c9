"""Messages and tables of commands: suggestions, warnings and the width of tables."""

import json
import sys

import pytest

from crowdbot.cli import main
from crowdbot.cli.output import print_table
from crowdbot.world import builtin_robots

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


def test_a_wide_table_puts_intervals_and_parts_of_names_on_lines_of_their_own(capsys):
    head = ("navigator", "robot", "runs", *(f"long-name-of-{k}\n[share]" for k in range(6)))
    row = ("robots/mine.py:Mine", "kobuki", "6", *["0.541 [0.459, 0.708]"] * 6)
    print_table("doorway", head, [row], words=2)
    printed = capsys.readouterr().out
    lines = [" ".join(line.split()) for line in printed.splitlines()]
    assert max(map(len, printed.splitlines())) <= 120
    assert "robots/mine.py: kobuki 6 0.541 0.541 0.541 0.541 0.541 0.541" in lines
    assert "Mine [0.459, 0.708] [0.459, 0.708] [0.459, 0.708] [0.459, 0.708] [0.459, 0.708] [0.459, 0.708]" in lines


def test_a_table_that_fits_keeps_intervals_on_the_line_of_their_value(capsys):
    print_table("frontal", ("navigator", "rate"), [("mine.py:Mine", "0 [0, 0.459]")])
    assert "  mine.py:Mine   0 [0, 0.459]" in capsys.readouterr().out


def test_check_prints_drive_and_sensors_in_words_with_units(capsys):
    assert main(["check", "cuybot"]) == 0
    printed = capsys.readouterr().out
    drive = next(line for line in printed.splitlines() if line.startswith("  drive"))
    assert drive == (
        "  drive   differential-drive: max-speed 1 m/s, max-turn-rate 1.5 rad/s, max-acceleration 0.8 m/s2,"
        " max-turn-acceleration 2 rad/s2; latency 0.1 s"
    )
    assert (
        "base_scan: lidar2d: rate 20 Hz, noise gaussian(0.001), delay 0 s, rays 451, field-of-view 3.927 rad" in printed
    )
    assert main(["check", "cuybot", "--json"]) == 0
    row = json.loads(capsys.readouterr().out)["cuybot"]["robot"]
    assert row["drive"]["values"]["max-speed"] == {"value": 1.0, "unit": "m/s"}
    assert row["sensors"]["base_scan"]["type"] == "lidar2d"


def test_check_knows_the_unit_of_each_length_angle_and_time_of_every_built_in_robot(capsys):
    names = sorted(builtin_robots())
    assert main(["check", *names, "--json"]) == 0
    units = {
        name: value["unit"]
        for row in json.loads(capsys.readouterr().out).values()
        for part in (row["robot"]["drive"], *row["robot"]["sensors"].values())
        for name, value in part["values"].items()
    }
    for word, unit in (("speed", "m/s"), ("turn-rate", "rad/s"), ("range", "m"), ("view", "rad"), ("delay", "s")):
        found = {name: value for name, value in units.items() if name.endswith(word) or name.startswith(f"{word}-")}
        assert found
        assert set(found.values()) - {"rad/s"} <= {unit}, found


def test_a_seed_that_begins_with_a_minus_has_a_hint(capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["evaluate", "frontal", "--seeds", "-1:2"])
    assert (
        "argument --seeds: expected one argument; write --seeds=VALUE if the value begins with -"
        in capsys.readouterr().err
    )


def test_a_table_without_column_names_has_no_header(capsys):
    print_table("a title that is longer than the table", ("", ""), [("seed", "0")])
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    assert [line for line in lines if line] == ["a title that is longer than the table", "seed   0"]
