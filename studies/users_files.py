"""Read recordings, scenes and maps of public repositories as users do, and write what each command says.

    python studies/users_files.py CHECKOUTS --page docs/results/users-files.md

CHECKOUTS holds a clone of each repository of ``users_files.toml`` at its commit, as CHECKOUTS/OWNER/NAME; a file that
is missing there is a row that says so. Each file goes through the command of its row, first as it is and, where the
product asks for an option, with that option, which is a row of its own. The number of people is compared with a count
of the ids in the file by other means (the field ``people``), and a row that should be read and is refused, or the other
way round, is a miss.
"""

from __future__ import annotations

import argparse
import re
import shlex
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from checkouts import BRIEF, call, check_fields, missing_file, read_toml, write_page
from crowdbot.cli.output import progress
from crowdbot.core import CrowdbotError, InputError, explain_write_errors
from crowdbot.trials import load_trial

LIST = Path(__file__).with_suffix(".toml")
FIELDS = {"kind", *BRIEF, "command", "refused", "people"}
COMMANDS = ("predict", "import", "map")
ROWS = re.compile(r": (\d+) rows of (\d+) (?:person|people), ([^ ]+) s with a step of ([^ ]+) s")
SPEED = re.compile(r": ([^ ]+ x [^ ]+ \w+); speed ([^ ]+ [\w/]+)")
MOST_WARNINGS = 2
LONGEST = 150
"""Longest sentence in a cell."""
MAP = '<trial name="map" duration="1"><stage map="{name}"/><crowd type="orca"/></trial>'
HEAD = """# Files of users

{count} commands on recordings, scenes and maps of {repositories} public repositories, as a user gives them. Made by

```
{command}
```

`CHECKOUTS` has the repositories at the commits in the links. A command without options is what a user gives first; a
row below it without a name is the same file with the option that the message asks for. *Result* is what the command
printed, shortened: a map is a trial with `<stage map>` that is checked. `!` marks a warning of the command, and errors
of a trial that it wrote.
"""


class UserFile(NamedTuple):
    """A file and the command that is run on it.

    Fields:
        kind: kind of file.
        repository, commit, file: ``OWNER/NAME`` on GitHub, commit, and path there; a folder is one recording.
        command: command and options: ``predict``, ``import`` (of a scene) or ``map``, such as ``predict --fps 25``.
        refused: words of the sentence with which the file must be refused; empty if it must be read.
        people: number of people, counted in the file by other means.
    """

    kind: str
    repository: str
    commit: str
    file: str
    command: str = "predict"
    refused: str = ""
    people: int | None = None


class Outcome(NamedTuple):
    """What a command said: whether the file was read, its sentence, the number of people, and the warnings."""

    read: bool
    sentence: str
    people: int | None = None
    warnings: tuple[str, ...] = ()


def read_list(file: Path = LIST) -> list[UserFile]:
    """Return the rows of a TOML file.

    Raises:
        InputError: the file cannot be read, or a row lacks a field or has a wrong one.
    """
    rows: list[UserFile] = []
    for number, row in enumerate(read_toml(file).get("file", []), 1):
        check_fields(row, ("kind", *BRIEF), FIELDS, f"{file}: file {number}")
        item = UserFile(**row)
        if item.command.split()[:1] not in ([word] for word in COMMANDS):
            raise InputError(f"{file}: file {number} has the command {item.command!r}, it begins with {COMMANDS}")
        rows.append(item)
    return rows


def run(item: UserFile, checkouts: Path) -> Outcome:
    """Return what the command of a row says."""
    file = checkouts / item.repository / item.file
    if not file.exists():
        return Outcome(False, missing_file(file, checkouts, item.repository, item.commit))
    name, *options = shlex.split(item.command)
    with tempfile.TemporaryDirectory() as folder:
        trial = Path(folder, "trial.xml")
        if name == "map":
            trial = file.with_name("crowdbot_map_of_users_files.xml")
            with explain_write_errors(trial):
                trial.write_text(MAP.format(name=file.name), encoding="utf-8")
            words = ["check", str(trial)]
        elif name == "import":
            words = ["new", "trial", str(trial), "--import", str(file)]
        else:
            words = ["predict", "--data", str(file)]
        try:
            code, out, wrong = call([*words, *options])
            told = [*wrong.splitlines(), *out.splitlines()]
            if code:
                refusal = next((line for line in told if line.startswith("crowdbot: ")), told[0] if told else "")
                return Outcome(False, _plain(refusal, file, trial))
            return _of_recording(told) if name == "predict" else _of_trial(trial, told)
        finally:
            if name == "map":
                trial.unlink(missing_ok=True)


def _plain(refusal: str, file: Path, trial: Path) -> str:
    """Return a refusal without the folders of this computer."""
    for folder in (f"{file.parent.resolve()}/", f"{file.parent}/", f"{trial.parent}/"):
        refusal = refusal.replace(folder, "")
    return refusal.removeprefix("crowdbot: ")


def _of_recording(told: Sequence[str]) -> Outcome:
    text = "\n".join(told)
    rows, speed = ROWS.search(text), SPEED.search(text)
    if rows is None or speed is None:
        return Outcome(False, "the command printed no figures of the recording")
    warnings = tuple(part.split("; ")[0] for part in text.split("warning: ")[1:])
    who = "1 person" if rows[2] == "1" else f"{rows[2]} people"
    sentence = f"{rows[1]} rows of {who}, step {rows[4]} s; {speed[1]}, {speed[2]}"
    return Outcome(True, sentence, int(rows[2]), tuple(warning.splitlines()[0] for warning in warnings))


def _of_trial(file: Path, told: Sequence[str]) -> Outcome:
    errors = tuple(line.strip(" -") for line in told if line.startswith("  - trial.xml: "))
    try:
        trial = load_trial(file)
    except CrowdbotError as error:
        return Outcome(True, "written, but the trial needs a change", warnings=errors or (str(error),))
    stage = trial.stage
    count = {
        "walls": len(stage.walls) + len(stage.obstacles), "people": len(trial.agents), "groups": len(trial.spawners),
        "sources": len(trial.sources), "robots": len(trial.robots), "exits": len(trial.exits),
    }  # fmt: skip
    if stage.map:
        count["solid polygons"] = len(stage.rings)
    lost = sum(line.startswith("  - ") for line in told) - len(errors)
    named = ", ".join(f"{number} {what}" for what, number in count.items() if number) or "nothing"
    return Outcome(True, f"{named}; {lost} remarks" if lost else named, warnings=errors)


def miss(item: UserFile, outcome: Outcome) -> str:
    """Return in what an outcome differs from what is expected, as a sentence; empty if in nothing."""
    if outcome.read == bool(item.refused):
        return f"it is {'read' if outcome.read else 'refused: ' + outcome.sentence}"
    if item.refused and item.refused not in outcome.sentence:
        return f"it is refused, but not because {item.refused!r}: {outcome.sentence}"
    if item.people is not None and outcome.people != item.people:
        return f"{outcome.people} people are read, the file has {item.people}"
    return ""


def page(items: Sequence[UserFile], outcomes: Sequence[Outcome], command: str) -> str:
    """Return the page as Markdown."""
    rows, before = [["kind", "file", "command", "result"]], ""
    for item, outcome in zip(items, outcomes, strict=False):
        url = f"https://github.com/{item.repository}/blob/{item.commit}/{item.file.replace(' ', '%20')}"
        file = "" if url == before else f"[{item.repository}]({url})"
        result = _short(outcome.sentence) if outcome.read else f"refused: {_short(outcome.sentence)}"
        marks = "".join(f" ! {_short(warning)}" for warning in outcome.warnings[:MOST_WARNINGS])
        more = len(outcome.warnings) - MOST_WARNINGS
        marks += f" ! and {more} more" if more > 0 else ""
        rows.append([item.kind if file else "", file, f"`{item.command}`", result + marks])
        before = url
    missed = [(item, miss(item, outcome)) for item, outcome in zip(items, outcomes, strict=False)]
    read = sum(outcome.read for outcome in outcomes)
    parts = [
        HEAD.format(
            count=len(outcomes), repositories=len({item.repository for item in items[: len(outcomes)]}),
            command=command,
        ).strip(),
        f"{read} are read, {len(outcomes) - read} refused; {sum(bool(why) for _, why in missed)} not as expected.",
        "## Not as expected",
        "\n".join(f"* {item.repository}, {item.file}: {why}." for item, why in missed if why) or "None.",
        "## Table",
        _table(rows),
    ]  # fmt: skip
    return "\n\n".join(parts) + "\n"


def _short(sentence: str) -> str:
    return sentence if len(sentence) <= LONGEST else sentence[: LONGEST - 3].rstrip() + "..."


def _table(rows: Sequence[Sequence[str]]) -> str:
    lines = [rows[0], ["---"] * len(rows[0]), *rows[1:]]
    cells = [[cell.replace("|", "/").replace("<", "&lt;") for cell in line] for line in lines]
    return "\n".join(f"| {' | '.join(line)} |" for line in cells)


def measure(items: Sequence[UserFile], checkouts: Path) -> list[Outcome]:
    """Return the outcomes of all rows; Ctrl-C returns those of the first."""
    outcomes: list[Outcome] = []
    with progress() as report:
        try:
            for number, item in enumerate(items):
                report(f"{item.repository} {item.file}"[:60], number / len(items))
                outcomes.append(run(item, checkouts))
        except KeyboardInterrupt:
            print(f"stopped; {len(outcomes)} of {len(items)} files are done", file=sys.stderr)
    return outcomes


def main(words: Sequence[str] | None = None) -> int:
    """Run the commands, and print or write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("checkouts", type=Path, metavar="CHECKOUTS", help="folder of the repositories, as OWNER/NAME")
    add("--list", type=Path, default=LIST, metavar="FILE.toml", help="files and commands (default: %(default)s)")
    add("--page", type=Path, metavar="FILE.md", help="page (default: standard output)")
    options = parser.parse_args(words)
    if not options.checkouts.is_dir():
        parser.error(f"there is no folder {options.checkouts}")
    try:
        items = read_list(options.list)
        text = page(
            items, measure(items, options.checkouts), "python studies/users_files.py CHECKOUTS --page users-files.md"
        )
        write_page(text, options.page)
    except CrowdbotError as error:
        parser.error(str(error))
    return 0


if __name__ == "__main__":
    sys.exit(main())
