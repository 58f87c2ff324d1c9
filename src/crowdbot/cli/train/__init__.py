"""``crowdbot train``: train a predictor on recordings of people, or a detector or predictor on generated scans."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from crowdbot.cli.output import add_json, note, number, print_json, print_table, progress
from crowdbot.cli.recordings import add_recordings, per_file, print_notes, recordings
from crowdbot.cli.settings import add_settings, parse_settings

from .detector import DETECTOR, train_detector
from .learned_scene import RUNS, SCAN_PREDICTOR, train_scan_predictor

if TYPE_CHECKING:
    from crowdbot.cli.parser import CommandParser
    from crowdbot.data import Recording
    from crowdbot.prediction import DataSet, LogRow, TimeSplit, TrainingResult

LEARNERS = ("anchor-net", "social-ways")
EPOCHS = 100
"""Default number of epochs."""


def arguments(parser: CommandParser) -> None:
    """Declare the options."""
    names = f"predictor: {', '.join(LEARNERS)}; detector: {DETECTOR}; scan predictor: {SCAN_PREDICTOR}"
    parser.add_argument("what", metavar="NAME", help=names)
    add_recordings(parser, required=False)
    add = parser.add_argument
    add("--check", nargs="+", type=Path, metavar="PATH", help="validation recordings (default: see --hold)")
    add(
        "--hold",
        type=float,
        default=0.2,
        metavar="SHARE",
        help="final share of each recording for validation, without --check (default: 0.2)",
    )
    add(
        "--leave-out",
        metavar="NAME",
        help="excluded test set: eth, hotel, univ, zara1, zara2, file",
    )
    add(
        "--balance", type=per_file(int), action="append", metavar="N",
        help="at most N futures of each folder of recordings, evenly spaced, and a fifth of it for validation;"
        " PART=N: of all files with PART in their path together; repeatable, the last that fits counts (default: all)",
    )  # fmt: skip
    add("--out", type=Path, required=True, metavar="DIR", help="folder for weights, log and training state")
    add("--resume", action="store_true", help="resume the training in DIR")
    add(
        "--from", metavar="WEIGHTS",
        help="start from other weights: a file, open (anchor-net) or a place such as zara1 (default: random weights)",
    )  # fmt: skip
    add("--epochs", type=int, metavar="N", help=f"number of epochs (default: {EPOCHS})")
    add = parser.add_rare_group("details of a training").add_argument
    add("--updates", type=int, metavar="N", help="number of updates, instead of --epochs")
    add("--check-every", type=int, default=200, metavar="N", help="updates between validations (default: 200)")
    add(
        "--patience",
        type=int,
        metavar="N",
        help="validations without improvement before early stopping (default: none)",
    )
    add("--scans", type=int, default=3000, metavar="N", help=f"generated scans of {DETECTOR} (default: 3000)")
    add("--runs", type=int, default=RUNS, metavar="N", help=f"runs of each trial of {SCAN_PREDICTOR} (default: {RUNS})")
    add("--settings", metavar="NAME", help="preset (social-ways: report, variety or modes; default: report)")
    add_settings(parser, "settings that differ from the preset")
    add("--device", default="cpu", metavar="NAME", help="cpu, cuda or cuda:N (default: cpu)")
    add(
        "--threads",
        type=int,
        default=1,
        metavar="N",
        help="number of PyTorch threads; it affects the last bits of results (default: 1)",
    )
    add("--tensorboard", action="store_true", help="write TensorBoard events to DIR")
    add("--seed", type=int, default=0, help="random seed (default: 0)")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Train and print the path of the weights."""
    if options.what == DETECTOR:
        return train_detector(options)
    if options.what == SCAN_PREDICTOR:
        return train_scan_predictor(options)
    return _train_predictor(options)


def _train_predictor(options: argparse.Namespace) -> int:
    """Train a predictor on recordings and print the path of the weights."""
    from crowdbot.core import InputError, UnknownName, explain_write_errors

    if options.what not in LEARNERS:
        raise UnknownName("learned predictor", options.what, (*LEARNERS, DETECTOR, SCAN_PREDICTOR))
    if options.data is None:
        raise InputError(f"crowdbot train {options.what} needs recordings: give --data PATH ...")
    from crowdbot.prediction import (
        BEST,
        LAST,
        TrainingSchedule,
        make_learner,
        short_recordings,
        torch_module,
        torch_threads,
        train,
    )

    for part, limit in options.balance or ():
        if limit < 1:
            raise InputError(f"--balance {limit}: the number of futures must be at least 1")
        if not any(part in str(path) for path in options.data):
            raise InputError(f"--balance {part}={limit}: no recording of --data has {part!r} in its path")
    if options.resume and not (options.out / LAST).is_file():
        raise InputError(
            f"--out {options.out} has no {LAST}: nothing to resume; give the folder of a training, or omit --resume"
        )
    torch_module()  # fails before the recordings are read
    epochs = EPOCHS if options.updates is None and options.epochs is None else options.epochs
    schedule = TrainingSchedule(
        options.updates, epochs, options.check_every, options.check_every, ("ade", "fde"), options.patience,
        options.seed,
    )  # fmt: skip
    data = _read(options)
    samples, check = data.split.training, data.split.validation
    start = str(getattr(options, "from") or "")
    model = make_learner(
        options.what, options.settings, parse_settings(options.set), samples, check, options.seed, options.device,
        start,
    )  # fmt: skip
    if not options.json:
        print_notes(data.recordings)
        for sentence in short_recordings(data.recordings):
            note(f"warning: {sentence}")
        for sentence in _remarks(options, data):
            note(sentence)
        size = f"{samples.people} futures in {len(samples)} windows, {len(data.recordings)} recordings"
        note(f"training {options.what} on {size}")
    before = dict(model.check()) if start else None
    with (
        torch_threads(options.threads),
        explain_write_errors(options.out),
        _events(options) as events,
        progress(options.json) as report,
    ):
        done = train(
            model,
            schedule,
            options.out,
            options.resume,
            _log_callback(options.json, events),
            lambda update, total: report(f"train {options.what}", update / total),
        )
    _print_result(options, done, options.out / BEST, data, before)
    return 0


class _TrainingData(NamedTuple):
    """What a training reads.

    Fields:
        recordings: the training recordings.
        split: training and validation samples.
        test: paths of the recordings of ``--leave-out``.
        short: recordings without a window, which are left out.
    """

    recordings: tuple[Recording, ...]
    split: TimeSplit
    test: list[str]
    short: list[Recording]


def _read(options: argparse.Namespace) -> _TrainingData:
    """Return the recordings and samples of the options."""
    from crowdbot.prediction import Samples, TimeSplit, leave_out, recordings_with_windows, split_in_time

    found, test = list(recordings(options)), list[Any]()
    if options.leave_out is not None:
        found, test = leave_out(found, options.leave_out)
    found, short = recordings_with_windows(found)
    paths = [item.path for item in test]
    sets = _data_sets(options, found)
    if options.check is None:
        return _TrainingData(tuple(found), split_in_time(found, options.hold, sets), paths, short)
    watched = list(recordings(options, options.check))
    if options.leave_out is not None:
        watched, _ = leave_out(watched, options.leave_out)
    watched, more = recordings_with_windows(watched)
    samples, check = Samples.of(found), Samples.of(watched)
    if sets:
        samples, check = samples.balance(sets), check.balance(_data_sets(options, watched), watched=True)
    return _TrainingData(tuple(found), TimeSplit(samples, check), paths, [*short, *more])


def _data_sets(options: argparse.Namespace, found: list[Recording]) -> list[DataSet]:
    """Return the data set of each recording with its limit; nothing without --balance."""
    from crowdbot.prediction import DataSet

    if options.balance is None:
        return []
    sets = []
    for one in found:
        part, limit = next((pair for pair in reversed(options.balance) if pair[0] in one.path), ("", None))
        sets.append(DataSet(part or str(Path(one.path).parent), limit))
    return sets


def _remarks(options: argparse.Namespace, data: _TrainingData) -> list[str]:
    """Return a line on the recordings that are left out, and on those that are not cut in time."""
    lines = []
    if data.short:
        names = [item.name for item in data.short]
        words = [item.path if names.count(item.name) > 1 else item.name for item in data.short]
        rows = f"{options.observe} + {options.predict} rows of {data.split.training.dt:.4g} s"
        lines.append(f"left out, without a window of {rows}: {', '.join(words)}")
    uses = (data.split.whole_training, "training"), (data.split.whole_validation, "validation")
    parts = [f"{', '.join(names)} for {use}" for names, use in uses if names]
    if parts:
        lines.append(f"too short for --hold {options.hold:g}, used whole: {'; '.join(parts)}")
    return lines


class _Events:
    """TensorBoard events, or nothing."""

    def __init__(self, writer: Any = None) -> None:
        self.writer = writer

    def __enter__(self) -> _Events:
        return self

    def __exit__(self, *_: object) -> None:
        if self.writer is not None:
            self.writer.close()

    def add(self, row: LogRow) -> None:
        """Write one row of the log."""
        if self.writer is not None:
            for name, value in row.items():
                if name not in ("update", "epoch"):
                    self.writer.add_scalar(name, value, int(row["update"]))


def _events(options: argparse.Namespace) -> _Events:
    from crowdbot.core import InputError

    if not options.tensorboard:
        return _Events()
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ImportError:
        raise InputError(
            "--tensorboard requires TensorBoard: pip install tensorboard; log.csv is always written"
        ) from None
    return _Events(SummaryWriter(str(options.out)))


def _log_callback(quiet: bool, events: _Events) -> Callable[[LogRow], None]:
    def log(row: LogRow) -> None:
        events.add(row)
        if not quiet:
            words = [f"{name} {value:.4f}" for name, value in row.items() if name not in ("update", "epoch", "seconds")]
            note(f"update {row['update']:.0f}  epoch {row['epoch']:.0f}  {'  '.join(words)}  {row['seconds']:.0f} s")

    return log


def _print_result(
    options: argparse.Namespace, done: TrainingResult, file: Path, data: _TrainingData, before: LogRow | None
) -> None:
    best = done.rows[done.best] if done.best is not None else {}
    if options.json:
        print_json(
            {"checkpoint": str(file), "updates": done.updates, "stopped_early": done.stopped,
             "seconds": done.seconds, "start": before, "best": dict(best), "log": [dict(row) for row in done.rows],
             "left_out": data.test, "without_windows": [item.path for item in data.short],
             "used_whole": {"training": list(data.split.whole_training),
                            "validation": list(data.split.whole_validation)}}
        )  # fmt: skip
        return
    rows = [] if before is None else [("start", "0", *(number(before.get(name)) for name in ("ade", "fde")))]
    rows += [
        ("best", *(number(best.get(name)) for name in ("update", "ade", "fde"))),
    ]
    rows.append(("last", *(number(done.rows[-1].get(name)) for name in ("update", "ade", "fde"))))
    ending = ", stopped early" if done.stopped else ""
    caption = f"{done.updates} updates in {done.seconds:.0f} s{ending}; weights in {file}"
    print_table(
        f"{options.what}, best of 20 on the validation data", ("", "update", "ADE [m]", "FDE [m]"), rows, caption
    )
    if before and best and best["ade"] + best["fde"] >= before["ade"] + before["fde"]:
        note("warning: the validation errors are not below those of the start; use the start, or more recordings")
    from crowdbot.prediction import WEIGHTS_FIELDS

    test = " ".join(data.test) or "PATH"
    flags = f"--predictor {options.what} --set {WEIGHTS_FIELDS[options.what]}={file}"
    note(f"evaluate with: crowdbot predict {flags} --samples 20 --data {test}")
