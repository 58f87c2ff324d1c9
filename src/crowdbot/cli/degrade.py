"""``crowdbot degrade``: evaluate predictors on degraded recordings, or write a degraded recording."""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .output import Progress, add_json, json_text, note, print_json, print_table, progress
from .recordings import add_recordings, horizon, print_notes, recordings
from .schemes import add_scheme, predictor_specs
from .settings import add_settings, parse_settings

if TYPE_CHECKING:
    from crowdbot.data import Recording, Trajectories
    from crowdbot.data.degrade import Chain, Degradation
    from crowdbot.evaluation import DegradedScore, DegradedTask
    from crowdbot.prediction import Predictor

    from .parser import CommandParser

ALL = "all"


def arguments(parser: CommandParser) -> None:
    """Declare the options."""
    add_recordings(parser)
    add = parser.add_argument
    add(
        "--by",
        nargs="+",
        required=True,
        metavar="NAME",
        help="degradations, see `crowdbot list degradations`; A+B applies both and sweeps A; all: every degradation",
    )
    add("--levels", nargs="+", type=float, metavar="X", help="levels of the sweep (default: from the degradation)")
    add(
        "--predictor",
        nargs="+",
        metavar="NAME",
        help="predictors (default: all that do not require PyTorch)",
    )
    add_scheme(parser, many=True)
    add_settings(parser, "parameters of the degradation, such as occlusion.eye=3,1.5")
    add_settings(parser, "parameters of the predictor or its crowd model", "--set-predictor")
    add(
        "--out",
        type=Path,
        metavar="DIR",
        help="folder for degraded.json, .png and .svg",
    )
    add("--write", type=Path, metavar="FILE", help="write the degraded recording, without evaluation")
    add("--draws", type=int, default=3, metavar="N", help="random draws per level (default: 3)")
    add("--carry", type=int, default=0, metavar="ROWS", help="rows to extrapolate lost tracks (default: 0)")
    add("--samples", type=int, default=1, metavar="K", help="number of futures per person (default: 1)")
    add(
        "--best-of",
        default="person",
        metavar="RULE",
        help="best of K by person, scene or same (default: person)",
    )
    add("--seed", type=int, default=0, help="random seed (default: 0)")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Evaluate the predictors level by level, or write the degraded recording."""
    values = parse_settings(options.set)
    degradations = read_degradations(options.by, values)
    if options.write is not None:
        return _write(options, degradations)
    _check_sweep(options, degradations, values)
    found = recordings(options)
    predictors = _predictors(options, found)
    tracks = [one.rest for one in found]
    task = _task(options)
    done: dict[str, list[DegradedScore]] = {}
    interrupted = False
    with progress(options.json) as report:
        try:
            _sweep(options, tracks, degradations, predictors, task, report, done)
        except KeyboardInterrupt:
            if not done:
                raise
            interrupted = True
    files = _keep(options, done, task, not interrupted, plot=True)
    if options.json:
        print_json({**_page(options, done, task, not interrupted), "files": [str(file) for file in files]})
    else:
        print_notes(found)
        _tables(done, tracks, task, files)
    if interrupted:
        kept = f" and stored in {options.out}" if files else ""
        note(f"results up to the interruption are shown{kept}")
        raise KeyboardInterrupt
    return 0


def read_degradations(words: Sequence[str], values: Mapping[str, str]) -> list[Degradation | Chain]:
    """Return the degradations of ``--by`` with the parameters of ``--set``.

    A parameter applies to all degradations that have it; ``occlusion.eye`` applies to one.
    """
    from crowdbot.core import builtin_classes, find_class, from_attributes
    from crowdbot.data import degrade

    names = list(dict.fromkeys(words))
    if ALL in names:
        names = [*builtin_classes(degrade, degrade.Degradation)]
    kinds = [[find_class(part, degrade, degrade.Degradation) for part in name.split("+")] for name in names]
    _check_names(values, {kind for parts in kinds for kind in parts})
    degradations: list[Degradation | Chain] = []
    for parts in kinds:
        links = tuple(from_attributes(kind, _own(kind, values)) for kind in parts)
        degradations.append(links[0] if len(links) == 1 else degrade.Chain(links))
    return degradations


def _fields(kind: type) -> list[str]:
    import dataclasses

    return [field.name.replace("_", "-") for field in dataclasses.fields(kind)]


def _own(kind: type, values: Mapping[str, str]) -> dict[str, str]:
    """Return the values that apply to a degradation."""
    from crowdbot.core import kebab_case

    split = {key: key.replace("_", "-").rpartition(".") for key in values}
    return {
        field: values[key]
        for key, (name, _, field) in split.items()
        if field in _fields(kind) and name in ("", kebab_case(kind.__name__))
    }


def _check_names(values: Mapping[str, str], kinds: set[type]) -> None:
    from crowdbot.core import InputError, did_you_mean, kebab_case

    known = sorted({field for kind in kinds for field in _fields(kind)})
    full = sorted(f"{kebab_case(kind.__name__)}.{field}" for kind in kinds for field in _fields(kind))
    for key in values:
        word = key.replace("_", "-")
        if word not in known and word not in full:
            near = did_you_mean(word, [*known, *full])
            raise InputError(
                f"--set {key}: no chosen degradation has this parameter{near}; they have {', '.join(full)}"
            )


def _check_sweep(
    options: argparse.Namespace, degradations: Sequence[Degradation | Chain], values: Mapping[str, str]
) -> None:
    from crowdbot.core import InputError
    from crowdbot.data.degrade import Chain

    if options.levels is not None and len(degradations) > 1:
        raise InputError(
            f"--levels requires a single degradation, not {len(degradations)}; omit it to use the "
            f"levels of each degradation"
        )
    for degradation in degradations:
        first = degradation.links[0] if isinstance(degradation, Chain) else degradation
        if first.level in _own(type(first), values):
            raise InputError(
                f"--set {first.level}: this parameter is varied by the sweep of {first.name}; use --levels instead"
            )
    if options.late != "skip":
        raise InputError(f"--late {options.late} is not supported by degrade; use --by late-start instead")
    if options.out is not None and options.out.exists() and not options.out.is_dir():
        raise InputError(f"--out {options.out} is a file; give a folder")


def _predictors(options: argparse.Namespace, found: Sequence[Recording]) -> list[Predictor]:
    """Return the predictors; learned goals are estimated from the first part of the clean recording."""
    from crowdbot import prediction
    from crowdbot.core import InputError, builtin_classes, required_fields

    known = builtin_classes(prediction, prediction.Predictor)
    plain = (
        name
        for name in known
        if not issubclass(known[name], prediction.LearnedPredictor) and not required_fields(known[name])
    )
    options.predictor = [*dict.fromkeys(options.predictor or plain)]
    options.set = options.set_predictor  # --set applies to degradations here
    made = predictor_specs(options)
    late = next((item.goal for item in made if item.goal is not None), None)
    if late is not None and len(found) > 1:
        raise InputError(f"the goal {late} depends on the recording: give one recording, not {len(found)}")
    return [item.build(found[0]) for item in made]


def _task(options: argparse.Namespace) -> DegradedTask:
    from crowdbot.evaluation import DegradedTask

    names = ("observe", "predict", "protocol", "near", "samples", "best_of", "seed", "carry", "draws", "every")
    return DegradedTask(**{name: getattr(options, name) for name in names})


def _sweep(
    options: argparse.Namespace,
    recordings: Sequence[Trajectories],
    degradations: Sequence[Degradation | Chain],
    predictors: Sequence[Predictor],
    task: DegradedTask,
    report: Progress,
    done: dict[str, list[DegradedScore]],
) -> None:
    """Fill ``done`` level by level and update the output file."""
    from crowdbot.evaluation import sweep_degradations

    for found in sweep_degradations(recordings, degradations, predictors, options.levels, task, report):
        done.setdefault(found[0].degradation.name, []).extend(found)
        _keep(options, done, task, complete=False, plot=False)


def _keep(
    options: argparse.Namespace, done: Mapping[str, list[DegradedScore]], task: DegradedTask, complete: bool, plot: bool
) -> list[Path]:
    """Write the results to the folder ``--out`` and return the files."""
    from crowdbot.core import InputError

    if options.out is None:
        return []
    file = options.out / "degraded.json"
    try:
        options.out.mkdir(parents=True, exist_ok=True)
        draft = file.with_suffix(".part")
        draft.write_text(json_text(_page(options, done, task, complete)) + "\n", encoding="utf-8")
        os.replace(draft, file)
        if not plot:
            return [file]
        from crowdbot.evaluation import plot_degradation

        return [file, *plot_degradation(list(done.values()), options.out, _title(options, task))]
    except OSError as error:
        raise InputError(f"cannot write --out {options.out}: {error.strerror or error}") from None


def _title(options: argparse.Namespace, task: DegradedTask) -> str:
    names = ", ".join(path.name for path in options.data)
    return f"{names}: protocol {task.protocol}, {task.observe} observed + {task.predict} predicted rows"


def _page(
    options: argparse.Namespace, done: Mapping[str, list[DegradedScore]], task: DegradedTask, complete: bool
) -> dict[str, Any]:
    """Return the content of ``degraded.json`` and ``--json``."""
    import dataclasses

    return {
        "data": [str(path) for path in options.data],
        "task": dataclasses.asdict(task),
        "complete": complete,
        "degradations": {
            name: {
                "level": scores[0].degradation.level,
                "unit": scores[0].degradation.unit,
                "parameters": scores[0].degradation.describe(level=False),
                "rows": [score.as_dict() for score in scores],
            }
            for name, scores in done.items()
        },
    }


def _tables(
    done: Mapping[str, list[DegradedScore]],
    recordings: Sequence[Trajectories],
    task: DegradedTask,
    files: Sequence[Path],
) -> None:
    names = ", ".join(tracks.name for tracks in recordings)
    units = recordings[0].units
    rows_and_seconds = horizon([recording.dt for recording in recordings], task.observe, task.predict)
    best = f", best of {task.samples} per {task.best_of}" if task.samples > 1 else ""
    carried = f", carried {task.carry} rows" if task.carry else ""
    for name, scores in done.items():
        degradation = scores[0].degradation
        unit = "" if degradation.unit in ("1", degradation.level) else f" [{degradation.unit}]"
        rest = ", ".join(f"{key} = {word}" for key, word in degradation.describe(level=False).items())
        predictors = list(dict.fromkeys(score.predictor for score in scores))
        rows = []
        for level in dict.fromkeys(score.level for score in scores):
            here = {score.predictor: score for score in scores if score.level == level}
            share = f"{100.0 * here[predictors[0]].coverage:.1f} %"
            rows.append((f"{level:g}", share, *(_errors(here[predictor]) for predictor in predictors)))
        print_table(
            f"{name}{f' ({rest})' if rest else ''}: ADE / FDE [{units}] of {names}",
            (f"{degradation.level}{unit}", "predicted", *map(_head, predictors)),
            rows,
            caption=f"protocol {task.protocol}, {rows_and_seconds}{best};"
            f" {scores[0].asked} persons, means over the predicted ones;"
            f" {max(score.draws for score in scores)} draws, seed {task.seed}{carried}",
        )
    for file in files:
        print(f"written   {file}")


def _head(predictor: str) -> str:
    """Return a name with line breaks at its hyphens."""
    import textwrap

    return "\n".join(textwrap.wrap(predictor, 16))


def _errors(score: DegradedScore) -> str:
    return f"{score.score.ade:.3f} / {score.score.fde:.3f}" if score.score else "-"


def _write(options: argparse.Namespace, degradations: Sequence[Degradation | Chain]) -> int:
    """Write one degraded recording and print a summary."""
    import dataclasses

    from crowdbot.core import InputError, stream
    from crowdbot.data import save

    if options.predictor or options.set_predictor or options.out is not None:
        raise InputError("--write does not evaluate predictors; omit --predictor, --set-predictor and --out")
    if len(options.data) > 1 or len(degradations) > 1 or len(options.levels or ()) > 1:
        raise InputError("--write requires exactly one --data, one --by (chain with A+B) and at most one of --levels")
    degradation = degradations[0].at(options.levels[0]) if options.levels else degradations[0]
    clean = recordings(options)[0].tracks
    seen = degradation.apply(clean, stream(options.seed, "degrade", 0))
    description = f"degraded by {degradation}, seed {options.seed}"
    save(dataclasses.replace(seen.tracks, note="; ".join(filter(None, (clean.note, description)))), options.write)
    counts = {"rows": (len(clean), len(seen.tracks)), "tracks": (len(clean.ids), len(seen.tracks.ids))}
    if options.json:
        parameters = {"name": degradation.name, "parameters": degradation.describe(), "seed": options.seed}
        print_json({"file": str(options.write), "degradation": parameters, **counts})
        return 0
    print(description)
    print(", ".join(f"{what} {before} -> {after}" for what, (before, after) in counts.items()))
    print(f"written   {options.write}")
    return 0
