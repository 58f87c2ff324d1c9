"""``crowdbot experiment``: run sessions of participants, print trial orders, and summarise results."""

from __future__ import annotations

import argparse
import contextlib
import shutil
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.cli.bridge.mocap import add_mocap, open_capture_set
from crowdbot.cli.output import add_json, note, number, print_json, print_table, print_warnings

from .streams import add_streams, open_outlets, record_streams
from .study import add_analyse, add_withdraw, analyse, withdraw_participant

if TYPE_CHECKING:
    from crowdbot.bridges import CaptureSet
    from crowdbot.experiments import Experiment, Respondent, SessionRunner
    from crowdbot.simulation import OrderSource
    from crowdbot.trials import Trial


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    verbs = parser.add_subparsers(metavar="COMMAND", required=True, dest="verb")
    _run_arguments(_verb(verbs, "run", "run the session of one participant"))
    order = _verb(verbs, "order", "print the order of trials for each participant")
    _add_experiment(order)
    order.add_argument(
        "--participants", type=int, metavar="N", help="number of participants (default: from the experiment, or 12)"
    )
    summary = _verb(verbs, "summary", "summarise sessions in a table, with one row for each trial of each participant")
    summary.add_argument("folder", metavar="DIR", type=Path, help="output folder of the sessions (--out)")
    summary.add_argument("--out", type=Path, metavar="FILE", help="write all columns to a .csv, .parquet or .json file")
    add_analyse(_verb(verbs, "analyse", "compare the conditions of an experiment within participants"))
    add_withdraw(_verb(verbs, "withdraw", "delete everything recorded of one participant"))
    new = _verb(verbs, "new", "create an experiment from a built-in one, or import one")
    new.add_argument("folder", metavar="DIR", type=Path, help="new folder")
    begin = new.add_mutually_exclusive_group()
    begin.add_argument(
        "--like", default="robot-speed", metavar="NAME", help="built-in experiment to copy (default: robot-speed)"
    )
    begin.add_argument(
        "--import",
        dest="original",
        type=Path,
        metavar="FILE",
        help="configuration or order file of the CrowdBot simulator (2021)",
    )
    new.add_argument(
        "--participant",
        type=int,
        metavar="N",
        help="participant whose trial order is imported (default: from the file)",
    )
    new.add_argument(
        "--root",
        type=Path,
        metavar="DIR",
        help="project folder of the CrowdBot simulator, for files that FILE refers to (default: folder of FILE)",
    )
    for command in (order, summary, new):
        add_json(command)


def main(options: argparse.Namespace) -> int:
    """Run the subcommand."""
    verbs = {"run": _run, "order": _order, "summary": _summary, "new": _new}
    verbs |= {"analyse": analyse, "withdraw": withdraw_participant}
    return verbs[options.verb](options)


def _verb(verbs: Any, name: str, line: str) -> argparse.ArgumentParser:
    about = line[0].upper() + line[1:] + "."
    made: argparse.ArgumentParser = verbs.add_parser(name, help=line, description=about, allow_abbrev=False)
    return made


def _add_experiment(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("experiment", metavar="FILE", help="experiment file, its folder, or built-in name")
    parser.add_argument(
        "--trust", action="store_true", help="allow trials and code outside the folder of the experiment"
    )


def _run_arguments(parser: argparse.ArgumentParser) -> None:
    _add_experiment(parser)
    parser.add_argument("--participant", type=int, required=True, metavar="N", help="participant number, from 1")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="output folder, shared by all participants"
    )
    parser.add_argument("--resume", action="store_true", help="continue an existing session")
    parser.add_argument(
        "--answers", type=Path, metavar="FILE", help="JSON file with answers by question, instead of input"
    )
    parser.add_argument(
        "--rehearse",
        action="store_true",
        help="emulate the participant: answers are drawn at random, and a program moves the avatar",
    )
    parser.add_argument(
        "--rate", type=float, metavar="R", help="speed of the trials, 1 for real time (default: as fast as possible)"
    )
    add_streams(parser)
    add_mocap(parser)
    add_json(parser)


def _run(options: argparse.Namespace) -> int:
    """Run a session and return the exit status: 0 if it is done, 1 if aborted, 130 if the input is closed."""
    from crowdbot.core import InputError
    from crowdbot.experiments import Console, ConsoleClosed, SessionRunner, load_experiment

    if options.rate is not None and not 0.01 <= options.rate <= 100.0:
        raise InputError(f"--rate {options.rate:g}: expected 0.01 to 100")
    experiment = load_experiment(options.experiment, trust=options.trust)
    stream = sys.stderr if options.json else sys.stdout

    def write(text: str) -> None:
        stream.write(text)
        stream.flush()

    with contextlib.ExitStack() as stack:
        captures = open_capture_set(options, stack)
        respondent, walkers = _respondent(options, experiment, write), _walkers(options, experiment, captures)
        runner = SessionRunner(
            experiment,
            options.participant,
            options.out,
            time.time,
            resume=options.resume,
            trust=options.trust,
            outlets=open_outlets(options, experiment.name, stack),
        )
        stack.callback(runner.close)
        record_streams(options, runner.folder, stack)
        try:
            with print_warnings():
                Console(
                    runner,
                    respondent,
                    write,
                    _print_progress,
                    walkers,
                    options.rate,
                    lambda text: note(f"warning: {text}"),
                ).run()
        except ConsoleClosed as closed:
            note(
                f"crowdbot: the session is stored in {runner.folder}{f' ({closed})' if str(closed) else ''}; continue "
                f"with --resume"
            )
            return 130
    return _print_session(runner, options.json)


def _respondent(options: argparse.Namespace, experiment: Experiment, write: Callable[[str], None]) -> Respondent:
    """Return who answers: a file, a program, or the terminal."""
    from crowdbot.experiments import ConsoleRespondent, EmulatedRespondent, ScriptedRespondent

    if options.answers is not None:
        return ScriptedRespondent.load(options.answers, experiment)
    if options.rehearse:
        return EmulatedRespondent(options.participant)
    return ConsoleRespondent(sys.stdin, write, patient=sys.stdin.isatty())


def _walkers(
    options: argparse.Namespace, experiment: Experiment, captures: CaptureSet
) -> Callable[[Trial], list[OrderSource]]:
    """Return what moves the avatars and mirrored robots of a trial."""
    from crowdbot.experiments import emulated_participant

    person = emulated_participant(experiment, options.participant)

    def walkers(trial: Trial) -> list[OrderSource]:
        driven = options.rehearse and any(avatar.source == "external" for avatar in trial.avatars)
        return [*([person.source(trial)] if driven else []), *captures.captures_of(trial)]

    return walkers


def _print_progress(what: str, share: float) -> None:
    """Print the progress of a trial on stderr: in place on a terminal, otherwise at its start and end."""
    if sys.stderr.isatty():
        sys.stderr.write(f"\r{what}  {100.0 * share:3.0f} %" + ("\n" if share == 1.0 else ""))
        sys.stderr.flush()
    elif share in (0.0, 1.0):
        note(f"{what} {'...' if share == 0.0 else 'done'}")


def _print_session(runner: SessionRunner, as_json: bool) -> int:
    session = runner.session
    outcomes = Counter(result.outcome for result in session.results.values())
    if as_json:
        answers = [
            {"screen": session.steps[index].name, "trial": session.steps[index].number or None, **given}
            for index, given in session.answers.items()
        ]
        print_json(
            {
                "experiment": runner.experiment.name,
                "participant": runner.participant,
                "session": session.phase,
                "outcomes": dict(outcomes),
                "answers": answers,
                "folder": str(runner.folder),
            }
        )
    else:
        outcome_counts = ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items()) or "none"
        print(f"\nsession   {session.phase}\ntrials    {outcome_counts}\nfolder    {runner.folder}")
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

    sentences = []
    for block in experiment.blocks:
        every = rows_of(block)
        if block.order == "latin-square":
            verdict = "balanced" if count % every == 0 else "not balanced"
            sentences.append(
                f"block {block.name}: {verdict} over {count} participants; balanced over multiples of {every}"
            )
    return sentences


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
            left_out = _import(options)
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


def _import(options: argparse.Namespace) -> tuple[str, ...]:
    """Write an imported experiment with its trials, and return the skipped parts and the errors to correct."""
    from crowdbot.core import TrialError
    from crowdbot.experiments import FILE, experiment_xml, import_experiment
    from crowdbot.trials import check_trial, trial_xml

    done = import_experiment(options.original, participant=options.participant, root=options.root)
    texts = {name: trial_xml(trial) for name, trial in done.trials} | {FILE: experiment_xml(done.experiment)}
    options.folder.mkdir(parents=True)
    for name, text in texts.items():
        (options.folder / name).write_text(text, encoding="utf-8")
    problems: list[str] = []
    for name, trial in done.trials:
        try:
            check_trial(trial)
        except TrialError as error:
            problems += [f"to correct in {name}: {sentence}" for sentence in error.problems]
    return (*done.left_out, *problems)
