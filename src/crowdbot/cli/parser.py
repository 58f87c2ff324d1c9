"""CommandParser: the parser of a command, whose help fits on two screens; ``--help-all`` describes every option."""

from __future__ import annotations

import argparse
import os
import re
import shlex
import sys
import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NoReturn

OUTPUTS = ("out", "plot", "to", "write")
"""Options of results; those with the metavar ``DIR`` are folders."""
SETTING = "NAME=VALUE"
"""Metavar of options that take one or several settings, such as ``--set``."""


Options = argparse._ActionsContainer
"""A parser or a group of options, such as :data:`OptionGroup`; argparse has no public names for them."""
OptionGroup = argparse._ArgumentGroup


class CommandHelp(argparse.HelpFormatter):
    """Help text of a command: names are not broken at hyphens, and several values are written ``NAME ...``."""

    def _format_args(self, action: argparse.Action, default_metavar: str) -> str:
        if action.nargs == argparse.ONE_OR_MORE:
            return f"{self._metavar_formatter(action, default_metavar)(1)[0]} ..."
        return super()._format_args(action, default_metavar)

    def _split_lines(self, text: str, width: int) -> list[str]:
        return textwrap.wrap(" ".join(text.split()), width, break_on_hyphens=False)

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return "\n".join(f"{indent}{line}" for line in self._split_lines(text, width - len(indent)))


class _HelpAll(argparse.Action):
    """Prints the help with the descriptions of all options."""

    def __init__(self, option_strings: Sequence[str], dest: str, help: str) -> None:
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, default=argparse.SUPPRESS, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        assert isinstance(parser, CommandParser)
        print(parser.format_full_help(), end="")
        parser.exit()


class CommandParser(argparse.ArgumentParser):
    """Parser of one command.

    The help describes the options that most runs need. Groups of rare options are listed by name; ``--help-all``
    describes these, too.

    Args:
        options: as for :class:`argparse.ArgumentParser`.

    >>> parser = CommandParser(prog="crowdbot run")
    >>> _ = parser.add_argument("trial", metavar="TRIAL", help="trial file")
    >>> _ = parser.add_rare_group("network").add_argument("--token", metavar="TEXT", help="token of clients")
    >>> print(parser.format_help())
    usage: crowdbot run TRIAL [options]
    <BLANKLINE>
    positional arguments:
      TRIAL       trial file
    <BLANKLINE>
    options:
      -h, --help  show this help message and exit
      --help-all  describe all options and exit
    <BLANKLINE>
    network (see --help-all):
      --token
    <BLANKLINE>
    >>> "token of clients" in parser.format_full_help()
    True
    """

    def __init__(self, **options: Any) -> None:
        options.setdefault("allow_abbrev", False)
        options.setdefault("formatter_class", CommandHelp)
        super().__init__(**options)
        self._rare_groups: list[OptionGroup] = []

    def add_rare_group(self, title: str, description: str | None = None) -> OptionGroup:
        """Return a new group of options that the short help lists by name only."""
        if not self._rare_groups:
            self.add_argument("--help-all", action=_HelpAll, help="describe all options and exit")
        group = self.add_argument_group(title, description)
        self._rare_groups.append(group)
        return group

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse words; an option of settings takes the following words with an equals sign, and no argument after them.

        Unknown words end the program with a suggestion.

        Raises:
            InputError: a file or folder of results cannot be written.

        >>> parser = CommandParser(prog="crowdbot run")
        >>> for name, how in {"trial": {}, "--set": {"action": "append", "metavar": SETTING}}.items():
        ...     _ = parser.add_argument(name, **how)
        >>> parser.parse_args(["--set", "people=3", "seed=4", "frontal"])
        Namespace(trial='frontal', set=['people=3', 'seed=4'])
        """
        options = {name for action in self._actions if action.metavar == SETTING for name in action.option_strings}
        words: list[str] = []
        option = ""  # the option of settings that the next word belongs to
        for word in sys.argv[1:] if args is None else args:
            if option and words[-1] != option and "=" in word and not word.startswith("-"):
                words.append(option)
            elif words[-1:] != [option]:
                option = ""
            option = word if word in options else option
            words.append(word)
        parsed, unknown = super().parse_known_args(words, namespace)
        for action in self._actions:
            if action.dest in OUTPUTS and isinstance(path := getattr(parsed, action.dest, None), Path):
                _check_writable(path, folder=action.metavar == "DIR")
        if unknown:
            self.exit(
                2, unknown_words(self.prog, unknown, (name for one in self._actions for name in one.option_strings))
            )
        return parsed, unknown

    def error(self, message: str) -> NoReturn:
        """Print the usage and the message, and exit with status 2."""
        if message.startswith("the following arguments are required"):  # an option has taken them as its values
            message += "; arguments come before options that take several values"
        if option := re.fullmatch(r"argument (?:\S+/)?(--\S+): expected one argument", message):
            message += f"; write {option[1]}=VALUE if the value begins with -"
        super().error(_in_words(message))

    def format_usage(self) -> str:
        """Return the line of usage: arguments and required options, then ``[options]`` for the others."""
        needed = argparse.ArgumentParser(prog=self.prog, add_help=False, formatter_class=CommandHelp)
        for action in self._actions:
            if action.required or not action.option_strings:
                needed._add_action(action)
        return f"{needed.format_usage().rstrip()} [options]\n"

    def format_help(self) -> str:
        """Return the short help."""
        return self._help(self._rare_groups)

    def format_full_help(self) -> str:
        """Return the help with the descriptions of all options."""
        return self._help(())

    def _help(self, listed: Sequence[OptionGroup]) -> str:
        """Return the help, in which these groups are listed by name."""
        formatter = self._get_formatter()
        formatter.add_text(self.description)
        for group in self._action_groups:
            by_name = any(group is other for other in listed)
            formatter.start_section(f"{group.title} (see --help-all)" if by_name else group.title)
            if by_name:
                formatter.add_text(" ".join(action.option_strings[-1] for action in group._group_actions))
            else:
                formatter.add_text(group.description)
                formatter.add_arguments(group._group_actions)
            formatter.end_section()
        formatter.add_text(self.epilog)
        return f"{self.format_usage()}\n{formatter.format_help()}"


def unknown_words(prog: str, unknown: Sequence[str], known: Iterable[str]) -> str:
    """Return the error about words that are no option or argument, with the known option that may be meant."""
    from crowdbot.core import did_you_mean

    first = next((word for word in unknown if word.startswith("-")), "").partition("=")[0]
    meant = did_you_mean(first, known) if first else ""
    return f"{prog}: error: unrecognized arguments: {shlex.join(unknown)}{meant}; see {prog} --help\n"


def _check_writable(path: Path, folder: bool) -> None:
    """Check before long work that a file or folder of results can be written.

    Raises:
        InputError: a part of the path is a file, the path is one and a folder is asked for, or there is no permission.
    """
    from crowdbot.core import InputError

    place = path.absolute()
    while not os.path.lexists(place):
        place = place.parent
    if not place.is_dir() and (folder or place != path.absolute()):
        raise InputError(f"cannot write {path}: {place} is a file; give a folder")
    if not os.access(place, os.W_OK) and not place.is_symlink():
        raise InputError(f"cannot write {path}: no permission to write {place}")


def _in_words(message: str) -> str:
    """Return a message of argparse in the words of the other errors: the value, and what is allowed."""
    from crowdbot.core import did_you_mean

    choice = re.search(r"invalid choice: '(?P<value>[^']*)' \(choose from (?P<known>.*)\)$", message)
    if choice:
        known = re.findall(r"[^\s,']+", choice["known"])
        words = f"{choice['value']!r} must be {', '.join(known)}{did_you_mean(choice['value'], known)}"
        return message[: choice.start()] + words
    for kind, words in (("int", "a whole number"), ("float", "a number")):
        message = re.sub(rf"invalid {kind} value: (.*)$", rf"\1 must be {words}", message)
    return message
