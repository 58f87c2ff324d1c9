"""``crowdbot train navigator``: train the navigator ``policy`` by reinforcement learning in simulated crowds."""

from __future__ import annotations

import argparse
import dataclasses
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import note, print_json, print_table, progress
from crowdbot.cli.settings import parse_settings

if TYPE_CHECKING:
    from crowdbot.gym import NavigatorTraining, PPOSettings, TrainingTask

__all__ = ["NAVIGATOR", "add_navigator", "check_options", "train_policy"]

NAVIGATOR = "navigator"
ENVIRONMENTS = 1024
"""Default number of environments."""
ONLY_HERE = ("trials", "rounds", "environments")
ONLY_PREDICTORS = ("data", "check", "leave_out", "epochs", "updates", "patience", "settings", "tensorboard", "from")


def add_navigator(parser: argparse._ActionsContainer) -> None:
    """Declare the options of ``crowdbot train navigator``."""
    add = parser.add_argument
    add(
        "--trials", metavar="LIST",
        help='trials with values, separated by commas, such as "crowdnav-circle-5, crowdnav-circle-10'
        ' people=8" (default: the crossings of CrowdNav with 5 to 20 people)',
    )  # fmt: skip
    add("--rounds", type=int, metavar="N", help="number of rounds (default: 6)")
    add("--environments", type=int, metavar="N", help=f"number of environments (default: {ENVIRONMENTS})")


def check_options(options: argparse.Namespace) -> None:
    """Raise an InputError for an option of the other kind of training, or without recordings for a predictor."""
    from crowdbot.core import InputError

    own = options.what == NAVIGATOR
    for name in ONLY_PREDICTORS if own else ONLY_HERE:
        if getattr(options, name) not in (None, False):
            kind = "predictors" if own else "the navigator"
            raise InputError(f"--{name.replace('_', '-')} is an option for {kind}, not for {options.what!r}")
    if not own and options.data is None:
        raise InputError(f"crowdbot train {options.what} needs recordings: give --data PATH ...")


def train_policy(options: argparse.Namespace) -> int:
    """Train, or continue, and print where the weights are."""
    from crowdbot.core import InputError, explain_write_errors
    from crowdbot.gym import CHECKPOINT, POLICY_FILE, train_navigator

    if options.resume and not (options.out / CHECKPOINT).is_file():
        raise InputError(f"--out {options.out} has no {CHECKPOINT}: nothing to resume; omit --resume")
    if not options.resume and (options.out / CHECKPOINT).is_file():
        raise InputError(f"--out {options.out} has a training; add --resume, or give another folder")
    settings, tasks = _settings(options), _tasks(options)
    try:
        with progress(options.json) as report, explain_write_errors(options.out):

            def tell(row: dict[str, float], rounds: int) -> None:
                report("train navigator", row["round"] / rounds)
                if not options.json:
                    note(_sentence(row, rounds))

            done = train_navigator(
                tasks,
                settings,
                options.out,
                resume=options.resume,
                threads=options.threads,
                command=_command(options),
                report=tell,
            )
    except KeyboardInterrupt:
        if (options.out / CHECKPOINT).is_file():
            note(f"crowdbot: the rounds done are stored in {options.out}; the same command with --resume continues")
        raise
    _print_result(options, done, str(options.out / POLICY_FILE))
    return 0


def _settings(options: argparse.Namespace) -> PPOSettings:
    """Return the settings from ``--rounds``, ``--seed`` and ``--set``."""
    from crowdbot.core import InputError, did_you_mean
    from crowdbot.gym import PPOSettings

    values: dict[str, Any] = {"seed": options.seed}
    if options.rounds is not None:
        values["rounds"] = options.rounds
    known = {one.name.replace("_", "-"): one for one in dataclasses.fields(PPOSettings) if one.name != "reward"}
    for name, text in parse_settings(options.set).items():
        field = known.get(name)
        if field is None:
            raise InputError(f"unknown setting {name!r}{did_you_mean(name, known)}; known are {', '.join(known)}")
        kind = int if field.type == "int" else float
        try:
            values[field.name] = kind(text)
        except ValueError:
            raise InputError(f"--set {name}={text} must be a number") from None
    return PPOSettings(**values)


def _command(options: argparse.Namespace) -> str:
    """Return the command that makes the weights, for their card."""
    words = ["crowdbot train navigator"]
    if options.trials is not None:
        words.append(f'--trials "{options.trials}"')
    words += [f"--{name} {getattr(options, name)}" for name in ("rounds", "environments") if getattr(options, name)]
    words += [f"--seed {options.seed}"] if options.seed else []
    return " ".join([*words, *(["--set", *options.set] if options.set else []), "--out DIR"])


def _tasks(options: argparse.Namespace) -> tuple[TrainingTask, ...]:
    """Return the tasks of ``--trials``, with equal numbers of environments, or the standard tasks."""
    from crowdbot.core import InputError
    from crowdbot.gym import TrainingTask, standard_tasks

    count = ENVIRONMENTS if options.environments is None else options.environments
    if count < 1:
        raise InputError(f"--environments {count} must be at least 1")
    if options.trials is None:
        return standard_tasks(count)
    texts = [text.split() for text in options.trials.split(",") if text.strip()]
    if not texts:
        raise InputError("--trials names no trial")
    each = max(1, count // len(texts))
    return tuple(TrainingTask(words[0], each, parse_settings(words[1:], "--trials")) for words in texts)


def _sentence(row: dict[str, float], rounds: int) -> str:
    """Return a line about a round."""
    shares = "  ".join(f"{name} {row[name]:.3f}" for name in ("success", "collision", "timeout"))
    times = f"{row['seconds']:.0f} s, {row['cpu_seconds']:.0f} s of the processor"
    return f"round {row['round']:.0f} of {rounds}  {row['steps'] / 1e6:.2f} M steps  {shares}  {times}"


def _print_result(options: argparse.Namespace, done: NavigatorTraining, file: str) -> None:
    last = done.rows[-1]
    if options.json:
        print_json({"weights": file, "rounds": done.done, "log": done.rows, "score": done.score})
        return
    names = ("success", "collision", "timeout", "time")
    rows = [(str(row["trial"]), *(f"{row[name]:.3f}" for name in names)) for row in done.score]
    caption = f"{last['steps'] / 1e6:.2f} M steps in {last['seconds']:.0f} s; weights in {file}"
    print_table("policy in 200 unseen cases", ("trial", *names[:3], "time [s]"), rows, caption)
    note(f'compare with: crowdbot evaluate crowdnav-circle-5 --navigators "orca, policy file={file}" --seeds 0:500')
