"""``crowdbot predict``: score predictors on recordings of people, or predictors of scans on readings."""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .output import Progress, add_json, note, print_json, print_table, progress
from .recordings import add_recordings, horizon, print_notes, recordings
from .schemes import add_scheme, frame_line, predictor_specs
from .settings import add_settings
from .track import add_perception, predict_perception

if TYPE_CHECKING:
    from crowdbot.data import Recording
    from crowdbot.evaluation import PredictorEvaluation, PredictorJob, PredictorJobResult, PredictorResult
    from crowdbot.metrics import Score
    from crowdbot.prediction import PredictorSpec

    from .parser import CommandParser


def arguments(parser: CommandParser) -> None:
    """Declare the options."""
    add_recordings(parser, required=False)
    add_perception(parser)
    add = parser.add_argument
    add(
        "--predictor", nargs="+", default=["constant-velocity"], metavar="NAME",
        help="predictors: names from `crowdbot list predictors`, or file.py:Name (default: constant-velocity)",
    )  # fmt: skip
    add_scheme(parser, many=True)
    add_settings(parser, "parameters of the predictor or its crowd model")
    _add_output(parser)
    add("--seed", type=int, metavar="N", help="random seed (default: 0, or that of the trial)")
    add_json(parser)


def _add_output(parser: CommandParser) -> None:
    """Declare the options of samples, forecasts and files."""
    add = parser.add_argument
    add("--out", type=Path, metavar="DIR", help="folder for tables, plots and resumable results")
    add("--workers", type=int, default=1, metavar="N", help="number of processes (default: 1)")
    add("--samples", type=int, default=1, metavar="K", help="number of futures per person (default: 1)")
    add = parser.add_rare_group("forecasts, animations and clusters").add_argument
    add(
        "--live",
        action="store_true",
        help="frame-by-frame prediction; each calibration starts from the fit of the previous frame",
    )
    add(
        "--forecasts", nargs="+", default=[], type=Path, metavar="FILE",
        help="forecasts made elsewhere, scored beside the predictors: TrajNet++ .ndjson, .npz or .parquet, or a folder"
        " with a file named like each recording",
    )  # fmt: skip
    add(
        "--write-forecasts",
        type=Path,
        metavar="FILE",
        help="file for the forecasts: .ndjson, .npz or .parquet; with several recordings or predictors one file each,"
        " with their names before the suffix",
    )
    add(
        "--best-of",
        default="person",
        metavar="RULE",
        help="selection of the best of K futures: person, scene or same (default: person)",
    )
    add("--cluster", metavar="ADDRESS", help="address of a Ray cluster, such as auto; requires crowdbot[cluster]")
    add("--animate", type=int, metavar="FRAME", help="frame to animate; requires --out")
    add(
        "--animate-format",
        default="gif",
        choices=("gif", "mp4", "webp"),
        help="format of the animation: gif, mp4 (requires PyAV) or webp (default: gif)",
    )


def main(options: argparse.Namespace) -> int:
    """Evaluate every predictor on every recording, or every predictor of scans."""
    from crowdbot.core import InputError, explain_write_errors
    from crowdbot.evaluation import PredictorEvaluation

    if (options.data is None) == (options.perception is None):
        raise InputError("predict: give either --data PATH or --perception SOURCE")
    if options.perception is not None:
        return predict_perception(options)
    if options.animate is not None and options.out is None:
        raise InputError("--animate requires --out DIR")
    windows = _with_windows(recordings(options))
    evaluation = PredictorEvaluation(
        windows,
        (*predictor_specs(options), *_stored(options, windows)),
        options.samples,
        options.best_of,
        options.seed or 0,
        options.live,
    )
    if options.animate is not None:
        evaluation.window_at(options.animate)  # fails before the evaluation starts
    written = {} if options.write_forecasts is None else _forecast_files(evaluation, options.write_forecasts)
    keep = None if options.out is None else options.out / "parts"
    with progress(options.json) as report, warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".* is used instead$")  # reported once as a note
        try:
            done = _run_jobs(evaluation, options, keep, report)
        except KeyboardInterrupt:
            note(_resume_hint(evaluation, keep))
            raise
    results = evaluation.results(done)
    if options.write_forecasts is not None:
        with explain_write_errors(options.write_forecasts):
            _write_forecasts(evaluation, written)
    if options.out is not None:
        with explain_write_errors(options.out):
            _write_results(options, evaluation, results)
    if options.json:
        print_json(as_json(evaluation, results))
        return 0
    print_notes(windows)
    for sentence in _notes(results):
        note(sentence)
    _tables(options, evaluation, results)
    return 0


def _with_windows(found: Sequence[Recording]) -> tuple[Recording, ...]:
    """Return the recordings that have windows; a note names the others.

    Raises:
        NoWindowError: none has one.
    """
    from crowdbot.prediction import recordings_with_windows

    if len(found) == 1:
        return tuple(found)  # the evaluation says why there is no window
    kept, left = recordings_with_windows(found)
    for recording in left:
        note(f"{recording.name} is left out: it has no window; see --observe, --predict and --step")
    return tuple(kept)


def _stored(options: argparse.Namespace, found: Sequence[Recording]) -> list[PredictorSpec]:
    """Return the forecasts of files as predictors."""
    from crowdbot.prediction import PredictorSpec, forecasts_of

    names = [recording.name for recording in found]
    return [PredictorSpec(forecasts_of(path, names)) for path in options.forecasts]


def _forecast_files(evaluation: PredictorEvaluation, file: Path) -> dict[Path, tuple[Recording, PredictorSpec]]:
    """Return the files of forecasts: FILE, or with several recordings or predictors one for each of them.

    Raises:
        InputError: the suffix is unknown, or two files have the same name.
    """
    from crowdbot.core import InputError
    from crowdbot.data import check_forecast_suffix
    from crowdbot.prediction import forecast_file

    check_forecast_suffix(file)
    several = len(evaluation.specs) > 1, len(evaluation.recordings) > 1
    files: dict[Path, tuple[Recording, PredictorSpec]] = {}
    for recording in evaluation.recordings:
        for spec in evaluation.specs:
            names = zip((spec.name, Path(recording.name).stem), several, strict=True)
            path = forecast_file(file, [name for name, wanted in names if wanted])
            if path in files:
                raise InputError(f"--write-forecasts {file}: two recordings or predictors would write {path.name}")
            files[path] = recording, spec
    return files


def _write_forecasts(evaluation: PredictorEvaluation, files: dict[Path, tuple[Recording, PredictorSpec]]) -> None:
    """Predict the windows again and write the forecasts."""
    from crowdbot.data import Forecast, write_forecasts
    from crowdbot.evaluation import predict_windows

    how = evaluation
    for file, (recording, spec) in files.items():
        past, future = recording.windows
        size = 1 if how.live else len(past)
        parts = [window.forecast for window in predict_windows(
            spec.build(recording), past, future, how.samples, how.best_of, how.seed, how.live, size
        )]  # fmt: skip
        write_forecasts(file, past, future, Forecast.concatenate(parts))
        note(f"wrote the forecasts of {spec.name} to {file}")


def _resume_hint(evaluation: PredictorEvaluation, keep: Path | None) -> str:
    """Return what an interrupted run has stored and how to resume it."""
    if keep is None:
        return "nothing is stored; add --out DIR to make a run that can be resumed"
    stored, total = evaluation.progress(keep), len(evaluation.jobs())
    return f"{stored} of {total} jobs are stored in {keep}; run the same command again to resume"


def _notes(results: list[PredictorResult]) -> list[str]:
    """Return the notes of the predictors about the recordings, without duplicates."""
    notes = (result.spec.predictor.note(result.recording.windows[0]) for result in results)
    return [sentence for sentence in dict.fromkeys(notes) if sentence]


def _run_jobs(
    evaluation: PredictorEvaluation, options: argparse.Namespace, keep: Path | None, report: Progress
) -> list[tuple[PredictorJob, PredictorJobResult]]:
    """Run the evaluation; print one line per frame of a calibrated crowd, below the name of its scheme."""
    jobs = evaluation.jobs()
    whole: dict[tuple[str, str], int] = {}
    for job in jobs:
        whole[job.label] = whole.get(job.label, 0) + job.last - job.first
    done: list[tuple[PredictorJob, PredictorJobResult]] = []
    share: dict[tuple[str, str], int] = {}
    headed = ""
    for job, part in evaluation.run(options.workers, options.cluster, keep):
        done.append((job, part))
        share[job.label] = share.get(job.label, 0) + job.last - job.first
        report(" ".join(job.label), share[job.label] / whole[job.label])
        if not options.json and part.frames.calibrated:
            if headed != " on ".join(reversed(job.label)):
                headed = " on ".join(reversed(job.label))
                note(f"{headed}\n{frame_line()}")
            _frame_lines(part)
    return done


def _frame_lines(part: PredictorJobResult) -> None:
    frames = part.frames
    for row in zip(frames.frame, frames.people, frames.cost, frames.evaluations, frames.seconds, strict=True):
        note(frame_line(*row))


def _tables(options: argparse.Namespace, evaluation: PredictorEvaluation, results: list[PredictorResult]) -> None:
    """Print one table for one predictor, or one table per recording for several."""
    from crowdbot.metrics import Score

    best = f", best of {options.samples} per {options.best_of}" if options.samples > 1 else ""
    protocol = evaluation.recordings[0].protocol
    caption = f"protocol {protocol}{best}; means over persons, 95 % intervals by bootstrap over persons"
    if len(evaluation.specs) == 1:
        scores = [result.score for result in results]
        rows = [result.recording.name for result in results]
        if len(scores) > 1:
            scores.append(Score.total(scores))
            rows.append("together")
        steps = [recording.tracks.dt for recording in evaluation.recordings]
        reach = horizon(steps, options.observe, options.predict)
        _table(f"{evaluation.specs[0].name}, {reach}", "recording", rows, scores, caption)
        return
    for recording in evaluation.recordings:
        own = [result for result in results if result.recording is recording]
        title = f"{recording.name}, {horizon([recording.tracks.dt], options.observe, options.predict)}"
        _table(title, "predictor", [result.label for result in own], [r.score for r in own], caption)


def _table(title: str, head: str, rows: list[str], scores: list[Score], caption: str) -> None:
    from crowdbot.metrics import Score

    heads = Score.heads(scores)
    cells = [(row, *score.cells(heads)) for row, score in zip(rows, scores, strict=True)]
    print_table(title, (head, *heads), cells, caption=caption)


def as_json(evaluation: PredictorEvaluation, results: list[PredictorResult]) -> dict[str, Any]:
    """Return the output of ``--json``."""
    from crowdbot.metrics import Score

    return {
        "protocol": evaluation.recordings[0].protocol,
        "observe": evaluation.recordings[0].observe,
        "predict": evaluation.recordings[0].predict,
        "seed": evaluation.seed,
        "results": [
            {
                "predictor": spec.name,
                "notes": _notes([result for result in results if result.spec is spec]),
                "total": Score.total([result.score for result in results if result.spec is spec]).as_dict(),
                "data": {result.recording.path: result.score.as_dict() for result in results if result.spec is spec},
            }
            for spec in evaluation.specs
        ],
    }


def _write_results(
    options: argparse.Namespace, evaluation: PredictorEvaluation, results: list[PredictorResult]
) -> None:
    """Write the scores, the results by frame, the plots and the animation, if requested."""
    from crowdbot.evaluation import animate_window, plot_errors, plot_frames

    from .output import json_text

    scores = json_text(as_json(evaluation, results))
    (options.out / "scores.json").write_text(scores + "\n", encoding="utf-8")
    evaluation.table(results).to_parquet(options.out / "frames.parquet", index=False)
    plot_errors(results, options.out / "errors.png")
    plot_frames(results, options.out / "frames.png")
    names = ["scores.json", "frames.parquet", "errors.png", "frames.png"]
    if options.animate is not None:
        file = options.out / f"frame-{options.animate}.{options.animate_format}"
        names += [animate_window(evaluation, options.animate, file).name]
    note(f"wrote {', '.join(names)} in {options.out}")
