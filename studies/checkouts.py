"""What the studies on clones of public repositories share: their tables, missing files, commands and pages."""

from __future__ import annotations

import contextlib
import io
import tomllib
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from crowdbot.cli import main as crowdbot
from crowdbot.core import InputError, explain_write_errors

BRIEF = ("repository", "commit", "file")
"""Fields that each row has: ``OWNER/NAME`` on GitHub, commit, and path there."""
CTRL_C = 130
"""Exit code of a command that Ctrl-C ended."""


def read_toml(file: Path) -> dict[str, Any]:
    """Return the content of a TOML file.

    Raises:
        InputError: the file cannot be read.
    """
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"cannot read {file}: {error}") from None


def check_fields(row: Mapping[str, Any], needed: Collection[str], known: Collection[str], place: str) -> None:
    """Raise :class:`InputError` if a row lacks a field or has an unknown one."""
    missing, unknown = [key for key in needed if key not in row], sorted(set(row) - set(known))
    if missing:
        raise InputError(f"{place} lacks {missing[0]!r}")
    if unknown:
        raise InputError(f"{place} has {unknown[0]!r}, allowed are {', '.join(sorted(known))}")


def missing_file(file: Path, checkouts: Path, repository: str, commit: str) -> str:
    """Return the sentence on a file that is not there, with the commands that fetch it."""
    home = checkouts / repository
    fetch = f"git clone https://github.com/{repository} {home} && git -C {home} checkout {commit}"
    return f"there is no {file}; {fetch}"


def call(words: list[str]) -> tuple[int, str, str]:
    """Return exit code, standard output and standard error of a command.

    Raises:
        KeyboardInterrupt: Ctrl-C ended the command.
    """
    told, wrong = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(told), contextlib.redirect_stderr(wrong):
        try:
            code = crowdbot(words)
        except SystemExit as error:  # wrong options
            code = 2 if error.code is None else int(error.code)
    if code == CTRL_C:
        raise KeyboardInterrupt
    return code, told.getvalue(), wrong.getvalue()


def write_page(text: str, page: Path | None) -> None:
    """Write a page to a file, or print it."""
    if page is None:
        print(text, end="")
        return
    with explain_write_errors(page):
        page.write_text(text, encoding="utf-8")
