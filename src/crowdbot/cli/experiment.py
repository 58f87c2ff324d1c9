"""``crowdbot experiment``: run trials with participants, print their orders, and summarise the results."""

from __future__ import annotations

import argparse
import shutil
import sys
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .output import add_json, note, number, print_json, print_table, spoken_warnings

if TYPE_CHECKING:
    from crowdbot.experiments import Experiment, Respondent, SessionRunner


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    verbs = parser.add_subparsers(metavar="VERB", required=True, dest="verb")
    _run_arguments(_verb(verbs, "run", "run the session of one participant"))
    order = _verb(verbs, "order", "print the order of trials for each participant")
    _add_experiment(order)
    order.add_argument(
        "--participants", type=int, metavar="N", help="number of participants (default: as planned, or 12)"
    )
    summary = _verb(verbs, "summary", "summarise sessions: one row for each trial of each participant")
    summary.add_argument("folder", metavar="DIR", type=Path, help="output folder of the sessions (--out)")
    summary.add_argument("--out", type=Path, metavar="FILE", help="write all columns to a .csv, .parquet or .json file")
    new = _verb(verbs, "new", "create a small experiment to start from")
    new.add_argument("folder", metavar="DIR", type=Path, help="new folder")
    begin = new.add_mutually_exclusive_group()
    begin.add_argument("--like", default="robot-speed", metavar="NAME", help="a built-in experiment")
    begin.add_argument(
        "--import",
        dest="original",
        type=Path,
        metavar="FILE",
        help="configuration or order file of the CrowdBot simulator (2021)",
    )
    new.add_argument(
        "--participant", type=int, metavar="N", help="participant whose order is imported (default: as configured)"
    )
    new.add_argument(
        "--root",
        type=Path,
        metavar="DIR",
        help="project folder of that simulator, for files that an imported file refers to (default: its folder)",
    )
    for command in (order, summary, new):
        add_json(command)


def main(options: argparse.Namespace) -> int:
    """Run the subcommand."""
    verbs = {"run": _run, "order": _order, "summary": _summary, "new": _new}
    return verbs[options.verb](options)


def _verb(verbs: Any, name: str, line: str) -> argparse.ArgumentParser:
    about = line[0].upper() + line[1:] + "."
    made: argparse.ArgumentParser = verbs.add_parser(name, help=line, description=about, allow_abbrev=False)
    return made


def _add_experiment(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("experiment", metavar="FILE", help="an experiment file, its folder, or a built-in name")
    parser.add_argument(
        "--trust", action="store_true", help="allow trials and code outside the folder of the experiment"
    )


def _run_arguments(parser: argparse.ArgumentParser) -> None:
    _add_experiment(parser)
    parser.add_argument("--participant", type=int, required=True, metavar="N", help="number of the participant, from 1")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of all participants")
    parser.add_argument("--resume", action="store_true", help="continue an existing session")
    parser.add_argument(
        "--answers", type=Path, metavar="FILE", help="JSON file with answers by question, for a run without input"
    )
    add_json(parser)


def _run(options: argparse.Namespace) -> int:
    """Run a session and return the status: 0 when done, 1 when aborted, 130 when closed."""
    from crowdbot.experiments import (
        Console,
        ConsoleClosed,
        ConsoleRespondent,
        ScriptedRespondent,
        SessionRunner,
        load_experiment,
    )

    experiment = load_experiment(options.experiment, trust=options.trust)
    stream = sys.stderr if options.json else sys.stdout

    def write(text: str) -> None:
        stream.write(text)
        stream.flush()

    person: Respondent = ConsoleRespondent(sys.stdin, write, patient=sys.stdin.isatty())
    if options.answers is not None:
        person = ScriptedRespondent.load(options.answers, experiment)
    sitting = SessionRunner(
        experiment, options.participant, options.out, time.time, resume=options.resume, trust=options.trust
    )
    try:
        with spoken_warnings():
            Console(sitting, person, write, _tell).run()
    except ConsoleClosed as left:
        note(
            f"crowdbot: the session is stored in {sitting.folder}{f' ({left})' if str(left) else ''}; continue "
            f"with --resume"
        )
        return 130
    finally:
        sitting.close()
    return _ended(sitting, options.json)


def _tell(what: str, share: float) -> None:
    """Print the progress of a trial on stderr: in place on a terminal, otherwise at its start and end."""
    if sys.stderr.isatty():
        sys.stderr.write(f"\r{what}  {100.0 * share:3.0f} %" + ("\n" if share == 1.0 else ""))
        sys.stderr.flush()
    elif share in (0.0, 1.0):
        note(f"{what} {'...' if share == 0.0 else 'over'}")


def _ended(sitting: SessionRunner, as_json: bool) -> int:
    session = sitting.session
    outcomes = Counter(result.outcome for result in session.results.values())
    if as_json:
        answers = [
            {"screen": session.steps[index].name, "trial": session.steps[index].number or None, **given}
            for index, given in session.answers.items()
        ]
        print_json(
            {
                "experiment": sitting.experiment.name,
                "participant": sitting.participant,
                "session": session.phase,
                "outcomes": dict(outcomes),
                "answers": answers,
                "folder": str(sitting.folder),
            }
        )
    else:
        said = ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items()) or "none"
        print(f"\nsession   {session.phase}\ntrials    {said}\nfolder    {sitting.folder}")
    return 0 if session.phase == "done" else 1


def _order(options: argparse.Namespace) -> int:
    from crowdbot.core import InputError
    from crowdbot.experiments import load_experiment, plan

    experiment = load_experiment(options.experiment, trust=options.trust)
    count = options.participants if options.participants is not None else experiment.participants or 12
    if count < 1:
        raise InputError(f"--participants {count} must be at least 1")
    rows = {
        participant: [f"{step.block}.{step.name}" for step in plan(experiment, participant) if step.role == "trial"]
        for participant in range(1, count + 1)
    }
    sentences = _balance(experiment, count)
    if options.json:
        print_json({"experiment": experiment.name, "orders": rows, "notes": sentences})
        return 0
    single = len(experiment.blocks) == 1
    table = [(str(who), *(name.partition(".")[2] if single else name for name in row)) for who, row in rows.items()]
    head = ("participant", *(str(k) for k in range(1, len(rows[1]) + 1)))
    print_table(experiment.name, head, table, words=len(head))
    for sentence in sentences:
        print(sentence)
    return 0


def _balance(experiment: Experiment, count: int) -> list[str]:
    """Return for each Latin square whether it is balanced for this number of participants."""
    from crowdbot.experiments import rows_of

    said = []
    for block in experiment.blocks:
        every = rows_of(block)
        if block.order == "latin-square":
            right = "balanced" if count % every == 0 else "not balanced"
            said.append(f"block {block.name}: {right} over {count} participants; balanced over multiples of {every}")
    return said


def _summary(options: argparse.Namespace) -> int:
    from crowdbot.experiments import save_summary, summary

    rows = summary(options.folder)
    if options.out is not None:
        save_summary(rows, options.out)
    if options.json:
        print_json(rows)
        return 0
    first = ["participant", "session", "number", "trial", "outcome", "time_to_goal", "min_clearance"]
    columns = [name for name in first if name in rows[0]] + [name for name in rows[0] if "." in name]
    cells = [[number(row[name], 2) for name in columns] for row in rows]
    head = [name.replace("_", "\n").replace(".", "\n") for name in columns]
    print_table(f"participants: {len({row['participant'] for row in rows})}", head, cells, words=2)
    if options.out is not None:
        print(f"table     {options.out}: {len(rows)} rows, {len(rows[0])} columns")
    return 0


def _new(options: argparse.Namespace) -> int:
    from crowdbot.core import InputError, UnknownName
    from crowdbot.experiments import builtin_experiments

    known = builtin_experiments()
    if options.original is None and options.like not in known:
        raise UnknownName("experiment", options.like, known)
    if options.folder.exists():
        raise InputError(f"{options.folder} already exists; give a new folder")
    left_out: tuple[str, ...] = ()
    try:
        if options.original is not None:
            left_out = _imported(options)
        else:
            shutil.copytree(known[options.like], options.folder)
    except OSError as error:
        raise InputError(f"cannot write {options.folder}: {error.strerror or error}") from None
    files = sorted(path.name for path in options.folder.iterdir())
    if options.json:
        print_json({"folder": str(options.folder), "files": files, "left_out": list(left_out)})
        return 0
    print(f"{options.folder}: {', '.join(files)}")
    if left_out:
        print("not imported:")
    for sentence in left_out:
        print(f"  - {sentence}")
    return 0


def _imported(options: argparse.Namespace) -> tuple[str, ...]:
    """Write an imported experiment with its trials, and return what was not imported and what is to be corrected."""
    from crowdbot.core import TrialError
    from crowdbot.experiments import FILE, experiment_xml, import_experiment
    from crowdbot.trials import check_trial, trial_xml

    done = import_experiment(options.original, participant=options.participant, root=options.root)
    texts = {name: trial_xml(trial) for name, trial in done.trials} | {FILE: experiment_xml(done.experiment)}
    options.folder.mkdir(parents=True)
    for name, text in texts.items():
        (options.folder / name).write_text(text, encoding="utf-8")
    mend: list[str] = []
    for name, trial in done.trials:
        try:
            check_trial(trial)
        except TrialError as error:
            mend += [f"to correct in {name}: {sentence}" for sentence in error.problems]
    return (*done.left_out, *mend)
