"""Help of commands: at most two screens each, and ``--help-all`` with every option."""

from __future__ import annotations

import argparse
import importlib
from collections.abc import Iterator

import pytest

from crowdbot.cli import COMMANDS, main
from crowdbot.cli.parser import CommandParser
from crowdbot.cli.settings import add_seeds, add_settings, parse_settings
from crowdbot.core import InputError
from crowdbot.evaluation import parse_robots, parse_seeds

SCREENS = 48
"""Lines of two terminals of 80 columns and 24 lines."""


def text_of(words: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit, match="0"):
        main(words)
    return capsys.readouterr().out


def parsers(command: str) -> Iterator[CommandParser]:
    """Yield the parser of a command, and those of its verbs."""
    parser = CommandParser(prog=f"crowdbot {command}")
    importlib.import_module(f"crowdbot.cli.{command}").arguments(parser)
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            yield from action.choices.values()


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_of_a_command_fits_on_two_screens(
    command: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = text_of([command, "--help"], capsys, monkeypatch).splitlines()
    assert lines[0].startswith(f"usage: crowdbot {command}")
    assert max(map(len, lines)) <= 80
    assert len(lines) <= SCREENS
    for parser in parsers(command):
        assert len(parser.format_help().splitlines()) <= SCREENS, parser.prog


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_names_every_option_and_the_full_help_describes_it(command: str) -> None:
    for parser in parsers(command):
        short, full = parser.format_help(), parser.format_full_help()
        for action in parser._actions:
            assert all(name in short for name in action.option_strings[-1:]), action.option_strings
            if action.option_strings and action.help:
                expected = "".join((action.help % {**vars(action), "prog": parser.prog}).split())
                assert expected in "".join(full.split()), action.option_strings


def test_rare_options_are_described_by_the_full_help_only(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    short = text_of(["run", "--help"], capsys, monkeypatch)
    full = text_of(["run", "--help-all"], capsys, monkeypatch)
    assert "token that clients must send" not in short
    assert "--bridge-token" in short
    assert "--bridge-token TOKEN  token that clients must send" in full
    assert short.startswith("usage: crowdbot run TRIAL [options]\n")


def test_settings_are_given_together_or_one_by_one() -> None:
    parser = CommandParser()
    add_settings(parser)
    add_seeds(parser, "0:20")
    options = parser.parse_args(["--set", "a=1", "b[2]/c=x=y", "--seeds", "3", "--set", "d = 4 "])
    assert parse_settings(options.set) == {"a": "1", "b[2]/c": "x=y", "d": "4"}
    assert parse_seeds(options.seeds) == (3,)
    with pytest.raises(InputError, match="--trial 'a' must be NAME=VALUE, such as density=0.5"):
        parse_settings(["a"], "--trial")
    with pytest.raises(InputError, match="--set a is given twice"):
        parse_settings(["a=1", "a=2"])


def test_an_argument_may_follow_settings(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["run", "--set", "duration=1", "people=3", "no-such-trial", "--seed", "x"])
    assert "argument --seed" in capsys.readouterr().err
    parser = CommandParser()
    parser.add_argument("trial")
    add_settings(parser)
    options = parser.parse_args(["--set", "a=1", "b=2", "frontal"])
    assert (options.trial, options.set) == ("frontal", ["a=1", "b=2"])


def test_an_argument_after_an_option_of_several_values_is_refused_with_a_hint(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["measure", "--methods", "density", "tracks.csv"])
    assert "PATH; arguments come before options that take several values" in capsys.readouterr().err


def test_every_command_has_the_same_grammar_for_values_seeds_and_robots() -> None:
    found: dict[str, set[tuple[object, ...]]] = {}
    for command in COMMANDS:
        for parser in parsers(command):
            for action in parser._actions:
                for name in {"--set", "--set-predictor", "--trial", "--seeds", "--robots"} & {*action.option_strings}:
                    kind = "--set" if name in ("--set-predictor", "--trial") else name
                    found.setdefault(kind, set()).add((type(action).__name__, action.nargs, action.metavar))
    assert found == {
        "--set": {("_AppendAction", None, "NAME=VALUE")},
        "--seeds": {("_StoreAction", None, "SEEDS")},
        "--robots": {("_StoreAction", None, "LIST")},
    }


@pytest.mark.parametrize(("text", "seeds"), [("7", (7,)), ("0:3", (0, 1, 2)), ("3, 5,8:10", (3, 5, 8, 9))])
def test_seeds_are_numbers_and_ranges(text: str, seeds: tuple[int, ...]) -> None:
    assert parse_seeds(text) == seeds


@pytest.mark.parametrize(
    ("text", "sentence"),
    [("x", "'x' must be a seed such as 7 or a range such as 0:100"), ("1,0:3", "seeds '1,0:3': 1 is there twice"),
     ("5:5", "the range '5:5' must have 1 to"), ("", "'' must be a seed such as 7 or a range such as 0:100"),
     ("0..3", "or a range such as 0:100, did you mean 0:3 (0 to 2) or 0:4 (0 to 3)?"), ("4-6", "did you mean 4:6"),
     ("3..1", "such as 0:100\n")],
)  # fmt: skip
def test_wrong_seeds_are_refused_by_every_command(text: str, sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    for words in (["evaluate", "frontal"], ["generate", "frontal", "--out", "nowhere"]):
        assert main([*words, "--seeds", text]) == 2
        assert sentence in capsys.readouterr().err


def test_robots_are_separated_by_commas() -> None:
    assert parse_robots("pepper, robots/mine,") == ("pepper", "robots/mine", "")
    assert parse_robots("") == ("",)
