"""Write the reference of the site while it is built (a hook of mkdocs, used by mkdocs.yml).

One page for each room with every name of its face, from the docstrings, one page for each command, from argparse, and
one page of all elements of a trial file, from its schema.
"""

from __future__ import annotations

import argparse
import ast
import importlib
import inspect
import itertools
import os
import pkgutil
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

import crowdbot
from crowdbot.cli import COMMAND_GROUPS, COMMANDS
from crowdbot.cli.parser import CommandParser
from crowdbot.trials import schema

sys.path.insert(0, str(Path(__file__).parent))
from griffe_fields import ROLE, google
from trial_elements import elements_page

API, CLI = "reference/api", "reference/cli"
ELEMENTS = "reference/trial-elements.md"


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Add the pages to the section "Reference"."""
    assert config.nav is not None
    reference = next(section["Reference"] for section in config.nav if "Reference" in section)
    rooms = [{_title(room): f"{API}/{_title(room)}.md"} for room in faces()]
    commands = [{name: f"{CLI}/{name}.md"} for name in COMMANDS]
    reference.insert(2, {"Trial elements": ELEMENTS})
    reference += [
        {"Command line": [f"{CLI}/index.md", *commands]},
        {"Python": [f"{API}/index.md", *rooms]},
    ]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the generated files."""
    pages = {f"{API}/index.md": front_door(), f"{CLI}/index.md": all_commands(), ELEMENTS: elements_page(schema())}
    pages |= {f"{API}/{_title(room)}.md": face(room) for room in faces()}
    pages |= {f"{CLI}/{name}.md": command(name) for name in COMMANDS}
    for path, text in pages.items():
        files.append(File.generated(config, path, content=text))
    return files


def faces() -> list[ModuleType]:
    """Return every package that lists public names, the room before what is in it."""
    names = [m.name for m in pkgutil.walk_packages(crowdbot.__path__, "crowdbot.") if m.ispkg]
    modules = [importlib.import_module(name) for name in names if ".assets" not in name and name != "crowdbot.cli"]
    return [module for module in modules if getattr(module, "__all__", ())]


def face(module: ModuleType) -> str:
    """Return the page of one room: its sentence, then its classes, functions and constants."""
    groups: dict[str, list[str]] = {"Classes": [], "Functions": [], "Constants": []}
    for name in sorted(module.__all__, key=str.lower):
        groups[_group(getattr(module, name))].append(name)
    lines = [f"# {module.__name__}", "", google(inspect.cleandoc(module.__doc__ or "")), ""]
    for title, names in groups.items():
        if names:
            links = [f"[`{n}`](#{_path(module, n)})" for n in names]
            lines += [f"**{title}**: " + ", ".join(links), ""]
    for title in ("Classes", "Functions"):
        for name in groups[title]:
            lines += [f"::: {_path(module, name)}", ""]
    notes = _notes(module)
    for name in groups["Constants"]:
        lines += [f"## {name} {{ #{module.__name__}.{name} .doc-heading }}", "", notes.get(name, ""), ""]
        if isinstance(value := getattr(module, name), int | float | str | tuple) and len(repr(value)) < 300:
            lines += [f"`{name} = {value!r}`", ""]
    return "\n".join(lines)


def _path(module: ModuleType, name: str) -> str:
    """Return the dotted name of something in a face; where a file has the same name, that in the file."""
    thing = getattr(module, name)
    if (Path(module.__path__[0]) / f"{name}.py").exists() and hasattr(thing, "__qualname__"):
        return f"{thing.__module__}.{thing.__qualname__}"
    return f"{module.__name__}.{name}"


def _notes(module: ModuleType) -> dict[str, str]:
    """Return the docstrings below constants, by name, in all files of a package."""
    found: dict[str, str] = {}
    for file in sorted(Path(module.__path__[0]).rglob("*.py")):
        body = ast.parse(file.read_text(encoding="utf-8")).body
        for assigned, note in itertools.pairwise(body):
            if (
                isinstance(note, ast.Expr)
                and isinstance(note.value, ast.Constant)
                and isinstance(note.value.value, str)
            ):
                targets = assigned.targets if isinstance(assigned, ast.Assign) else [getattr(assigned, "target", None)]
                names = [
                    node.id for target in targets if target for node in ast.walk(target) if isinstance(node, ast.Name)
                ]
                found |= {name: google(note.value.value) for name in names if name not in found}
    return found


def front_door() -> str:
    """Return the page of ``crowdbot`` itself: what it offers, and the rooms."""
    lines = [
        "# Python reference",
        "",
        "`import crowdbot as cb` gives the names below; each is loaded on first use.",
    ]
    for job, modules in crowdbot.JOBS.items():
        lines += ["", f"## {job}", "", "| name | room | meaning |", "|---|---|---|"]
        for module, names in modules.items():
            room = importlib.import_module(f"crowdbot.{module}")
            for name in names:
                known = name in getattr(room, "__all__", ()) and hasattr(room, "__path__")
                link = f"[`cb.{name}`][{_path(room, name)}]" if known else f"`cb.{name}`"
                lines.append(f"| {link} | `crowdbot.{module}` | {_sentence(getattr(crowdbot, name))} |")
    lines += ["", "## Rooms", "", "| package | content |", "|---|---|"]
    lines += [f"| [`{room.__name__}`]({_title(room)}.md) | {_sentence(room)} |" for room in faces()]
    return "\n".join(lines) + "\n"


def all_commands() -> str:
    """Return the page that lists the commands."""
    lines = [
        "# Command line",
        "",
        "`crowdbot COMMAND --help-all` prints the same. The exit status is 0 when a command is done, 1 when a check",
        "failed, 2 when the input is wrong, and 130 after Ctrl-C. `--help` lists rare options by name only.",
        "",
        "These options have one form in all commands:",
        "",
        "| option | form |",
        "|---|---|",
        "| `--set NAME=VALUE ...` | one or several values; repeatable. The name is a parameter (`density=0.5`) or, in a"
        " trial, a path (`spawner[1]/count=20`). The arguments of the command come before it |",
        "| `--seeds SEEDS` | numbers and ranges, separated by commas: `7` is one seed, `0:100` are 0 to 99, `3,5,10:20`"
        " are twelve seeds |",
        "| `--robots LIST` | types or folders of robots, separated by commas; an empty name: the robot of the trial |",
    ]
    for title, group in COMMAND_GROUPS.items():
        lines += ["", f"## {title[0].upper()}{title[1:]}", "", "| command | task |", "|---|---|"]
        lines += [f"| [`crowdbot {name}`]({name}.md) | {line[0].upper()}{line[1:]}. |" for name, line in group.items()]
    return "\n".join(lines) + "\n"


def command(name: str) -> str:
    """Return the page of one command and of its own commands, such as ``crowdbot experiment run``."""
    line = COMMANDS[name]
    os.environ["COLUMNS"] = "100"
    parser = CommandParser(prog=f"crowdbot {name}", description=f"{line[0].upper()}{line[1:]}.")
    importlib.import_module(f"crowdbot.cli.{name}").arguments(parser)
    return "\n".join([f"# crowdbot {name}", "", *_sections(parser)]) + "\n"


def _sections(parser: argparse.ArgumentParser) -> Iterator[str]:
    """Yield what one parser says: a sentence, its usage, a table of arguments, then its own commands."""
    yield from ([parser.description, ""] if parser.description else [])
    yield from ["```text", parser.format_usage().removeprefix("usage: ").rstrip(), "```", ""]
    below: list[argparse._SubParsersAction[Any]] = []
    for group in parser._action_groups:
        actions = [
            a
            for a in group._group_actions
            if a.help != argparse.SUPPRESS and "--help-all" not in a.option_strings and a.dest != "help"
        ]
        below += [a for a in actions if isinstance(a, argparse._SubParsersAction)]
        rows = [a for a in actions if not isinstance(a, argparse._SubParsersAction)]
        if rows:
            title = "argument" if group.title == "positional arguments" else "option"
            name = "" if group.title in ("positional arguments", "options") else (group.title or "")
            yield from ([f"**{name[0].upper()}{name[1:]}**", ""] if name else [])
            yield from [f"| {title} | meaning |", "|---|---|"]
            yield from (f"| {_words(action)} | {_help(parser, action)} |" for action in rows)
            yield ""
    for action in below:
        for child, own in action.choices.items():
            yield from [f"## {parser.prog} {child}", "", *_sections(own)]
    if parser.epilog:
        yield from [parser.epilog, ""]


def _words(action: argparse.Action) -> str:
    value = action.metavar or (action.dest.upper() if action.nargs != 0 else "")
    value = value if isinstance(value, str) else " ".join(value)
    if not action.option_strings:
        return f"`{value}`"
    return ", ".join(
        f"`{option}{' ' + value if value and action.nargs != 0 else ''}`" for option in action.option_strings
    )


def _help(parser: argparse.ArgumentParser, action: argparse.Action) -> str:
    text = (action.help or "") % {**vars(action), "prog": parser.prog}
    return text[:1].upper() + text[1:].replace("|", "\\|")


def _group(thing: Any) -> str:
    if inspect.isclass(thing):
        return "Classes"
    return "Functions" if callable(thing) else "Constants"


def _sentence(thing: Any) -> str:
    text = (inspect.getdoc(thing) or "").split("\n\n")[0].replace("\n", " ").replace("|", "\\|")
    return ROLE.sub(r"`\1`", text).replace("``", "`")


def _title(module: ModuleType) -> str:
    return module.__name__.removeprefix("crowdbot.")
