"""``crowdbot new KIND FILE``: write a file to begin with: a trial, or the schema of trials."""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from crowdbot.trials import check_trial, expand_spawners, trial_xml

from .output import note
from .settings import add_settings, settings

if TYPE_CHECKING:
    from crowdbot.trials import Trial

KINDS = ("trial", "schema")


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("kind", metavar="KIND", choices=KINDS, help="trial, or schema (XSD) of trials")
    parser.add_argument("file", metavar="FILE", type=Path, help="file to write")
    parser.add_argument("--force", action="store_true", help="write over a file that exists")
    parser.add_argument("--trust", action="store_true", help="let the trial use code and files outside its folder")
    group = parser.add_argument_group("a trial")
    begin = group.add_mutually_exclusive_group()
    begin.add_argument("--from", dest="source", metavar="TRIAL", help="a built-in name or a file (default: frontal)")
    begin.add_argument("--import", dest="original", type=Path, metavar="FILE", help="of the CrowdBot simulator of 2021")
    begin.add_argument("--recorded", type=Path, metavar="DATA", help="a recording whose people are the crowd")
    group.add_argument(
        "--root",
        type=Path,
        metavar="DIR",
        help="project folder of that simulator, searched for files that an imported file names (default: its folder)",
    )
    add_settings(group)
    group.add_argument("--explicit", action="store_true", help="write everybody at the beginning as an agent to edit")
    group.add_argument("--seed", type=int, help="seed by which people are placed (default: the trial's own)")
    group = parser.add_argument_group("a trial of recorded people")
    group.add_argument("--fps", type=float, help="frames per second of the recording (default: from the file)")
    group.add_argument("--reactive", action="store_true", help="people near the robot walk by a model")
    group.add_argument("--replace", type=int, metavar="ID", help="the robot goes in the place of this person")


def main(options: argparse.Namespace) -> int:
    """Write the file."""
    from crowdbot.core import InputError

    if options.file.exists() and not options.force:
        raise InputError(f"{options.file} exists already; give another name, or --force to write over it")
    if not options.file.parent.is_dir():
        raise InputError(f"there is no folder {options.file.parent} to write {options.file.name} in")
    if options.kind == "schema":
        from crowdbot.trials import schema

        _write(options.file, schema())
    elif options.original is not None:
        _imported(options)
    else:
        trial = _recorded(options) if options.recorded is not None else _taken(options)
        if options.seed is not None or options.explicit:
            trial = _placed(trial, options)
        _write(options.file, trial_xml(trial))
    return 0


def _taken(options: argparse.Namespace) -> Trial:
    from crowdbot.trials import load_trial

    return load_trial(options.source or "frontal", trust=options.trust, **settings(options))


def _placed(trial: Trial, options: argparse.Namespace) -> Trial:
    import dataclasses

    seed = trial.seed if options.seed is None else options.seed
    return expand_spawners(trial, seed) if options.explicit else dataclasses.replace(trial, seed=seed)


def _recorded(options: argparse.Namespace) -> Trial:
    from crowdbot.trials import recorded_trial

    trial = recorded_trial(
        options.recorded,
        fps=options.fps,
        mode="reactive" if options.reactive else "scripted",
        replace=options.replace,
        name=options.file.stem,
    )
    beside = options.file.parent / options.recorded.name
    if beside.resolve() != options.recorded.resolve():
        if not beside.exists():
            shutil.copyfile(options.recorded, beside)
            note(f"copied {options.recorded.name} beside it, for a trial reads files of its own folder only")
        elif beside.read_bytes() != options.recorded.read_bytes():
            from crowdbot.core import InputError

            raise InputError(f"{beside} exists and is another file; write the trial into another folder")
    return trial


def _imported(options: argparse.Namespace) -> None:
    from crowdbot.core import TrialError
    from crowdbot.trials import import_original

    done = import_original(options.original, root=options.root)
    problems: list[str] = []
    for k, (name, trial) in enumerate(done.trials):
        single = len(done.trials) == 1
        file = options.file if single else options.file.with_stem(f"{options.file.stem}-{k + 1:02d}-{Path(name).stem}")
        _write(file, trial_xml(trial))
        try:
            check_trial(trial)
        except TrialError as error:
            problems += [f"{file.name}: {sentence}" for sentence in error.problems]
    for title, rows in (("not carried over", done.left_out), ("to mend", problems)):
        if rows:
            print(f"{title}:")
            for sentence in rows:
                print(f"  - {sentence}")


def _write(file: Path, text: str) -> None:
    """Write a file whole, or not at all."""
    part = file.with_name(file.name + ".part")
    part.write_text(text, encoding="utf-8")
    part.replace(file)
    print(f"wrote {file}")
