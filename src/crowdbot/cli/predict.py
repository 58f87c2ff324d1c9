"""``crowdbot predict``: score predictors on recordings of people."""

from __future__ import annotations

import argparse
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .output import Progress, add_json, note, print_json, print_table, progress
from .recordings import add_recordings, horizon, recordings, tell_notes
from .schemes import add_scheme, frame_line, recipes

if TYPE_CHECKING:
    from crowdbot.benchmark import Part, Piece, Result, Study
    from crowdbot.metrics import Score


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add_recordings(parser)
    add = parser.add_argument
    add(
        "--predictor", nargs="+", default=["constant-velocity"], metavar="NAME",
        help="one or several: crowdbot list predictors, or file.py:Name (default constant-velocity)",
    )  # fmt: skip
    add_scheme(parser, many=True)
    add("--set", nargs="+", default=[], metavar="NAME=VALUE", help="parameters of the predictor or its crowd model")
    add("--samples", type=int, default=1, metavar="K", help="futures drawn from a predictor that samples")
    add("--best-of", default="person", metavar="RULE", help="how the best of K is chosen: person, scene or same")
    add("--live", action="store_true", help="frame by frame: calibrations begin with the fit of the frame before")
    add("--workers", type=int, default=1, metavar="N", help="processes (default 1)")
    add("--cluster", metavar="ADDRESS", help="run on a Ray cluster, such as auto; needs crowdbot[cluster]")
    add("--out", type=Path, metavar="DIR", help="write tables and plots there; run again to go on after a stop")
    add("--animate", type=int, metavar="FRAME", help="with --out: also an animation of the predictions at this frame")
    add("--seed", type=int, default=0, help="seed of predictors that sample or search")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Score every predictor on every recording and on all together."""
    from crowdbot.benchmark import Study
    from crowdbot.core import InputError

    if options.animate is not None and options.out is None:
        raise InputError("--animate writes a file: say where with --out DIR")
    found = recordings(options)
    study = Study(found, recipes(options), options.samples, options.best_of, options.seed, options.live)
    if options.animate is not None:
        study.window_at(options.animate)  # says now, not after the work, that there is none
    keep = None if options.out is None else options.out / "parts"
    with progress(options.json) as report, warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".* answers instead$")  # a note says it, once
        done = _done(study, options, keep, report)
    results = study.results(done)
    if options.out is not None:
        _written(options, study, results)
    if options.json:
        print_json(as_json(study, results))
        return 0
    tell_notes(found)
    for sentence in _notes(results):
        note(sentence)
    _tables(options, study, results)
    return 0


def _notes(results: list[Result]) -> list[str]:
    """Return what predictors say about the recordings, each sentence once."""
    said = (one.recipe.predictor.note(one.recording.windows[0]) for one in results)
    return [sentence for sentence in dict.fromkeys(said) if sentence]


def _done(study: Study, options: argparse.Namespace, keep: Path | None, report: Progress) -> list[tuple[Piece, Part]]:
    """Run the study; each frame of a calibrated crowd is one line as soon as it is known."""
    pieces = study.pieces()
    whole: dict[tuple[str, str], int] = {}
    for piece in pieces:
        whole[piece.label] = whole.get(piece.label, 0) + piece.last - piece.first
    done: list[tuple[Piece, Part]] = []
    share: dict[tuple[str, str], int] = {}
    said = False
    for piece, part in study.run(options.workers, options.cluster, keep):
        done.append((piece, part))
        share[piece.label] = share.get(piece.label, 0) + piece.last - piece.first
        report(" ".join(piece.label), share[piece.label] / whole[piece.label])
        if not options.json and part.frames.calibrated:
            if not said:
                note(frame_line())
                said = True
            _frame_lines(part)
    return done


def _frame_lines(part: Part) -> None:
    frames = part.frames
    for row in zip(frames.frame, frames.people, frames.cost, frames.evaluations, frames.seconds, strict=True):
        note(frame_line(*row))


def _tables(options: argparse.Namespace, study: Study, results: list[Result]) -> None:
    """Print one table a predictor, or with several predictors one a recording."""
    from crowdbot.metrics import Score

    best = f", best of {options.samples} per {options.best_of}" if options.samples > 1 else ""
    caption = f"protocol {study.recordings[0].protocol}{best}; means over persons, 95 % by drawing persons"
    if len(study.recipes) == 1:
        scores = [result.score for result in results]
        rows = [result.recording.name for result in results]
        if len(scores) > 1:
            scores.append(Score.total(scores))
            rows.append("together")
        steps = [one.tracks.dt for one in study.recordings]
        reach = horizon(steps, options.observe, options.predict)
        _table(f"{study.recipes[0].name}, {reach}", "recording", rows, scores, caption)
        return
    for recording in study.recordings:
        own = [result for result in results if result.recording is recording]
        title = f"{recording.name}, {horizon([recording.tracks.dt], options.observe, options.predict)}"
        _table(title, "predictor", [result.label for result in own], [r.score for r in own], caption)


def _table(title: str, head: str, rows: list[str], scores: list[Score], caption: str) -> None:
    from crowdbot.metrics import Score

    heads = Score.heads(scores)
    cells = [(row, *score.cells(heads)) for row, score in zip(rows, scores, strict=True)]
    print_table(title, (head, *heads), cells, caption=caption)


def as_json(study: Study, results: list[Result]) -> dict[str, Any]:
    """Return the object that ``--json`` prints."""
    from crowdbot.metrics import Score

    return {
        "protocol": study.recordings[0].protocol,
        "observe": study.recordings[0].observe,
        "predict": study.recordings[0].predict,
        "seed": study.seed,
        "results": [
            {
                "predictor": recipe.name,
                "notes": _notes([one for one in results if one.recipe is recipe]),
                "total": Score.total([one.score for one in results if one.recipe is recipe]).as_dict(),
                "data": {one.recording.path: one.score.as_dict() for one in results if one.recipe is recipe},
            }
            for recipe in study.recipes
        ],
    }


def _written(options: argparse.Namespace, study: Study, results: list[Result]) -> None:
    """Write the scores, every frame, the plots and, when asked for, the animation."""
    from crowdbot.benchmark import animate, plot_errors, plot_frames

    from .output import json_text

    scores = json_text(as_json(study, results))
    (options.out / "scores.json").write_text(scores + "\n", encoding="utf-8")
    study.table(results).to_parquet(options.out / "frames.parquet", index=False)
    plot_errors(results, options.out / "errors.png")
    plot_frames(results, options.out / "frames.png")
    names = ["scores.json", "frames.parquet", "errors.png", "frames.png"]
    if options.animate is not None:
        names += [animate(study, options.animate, options.out / f"frame-{options.animate}.gif").name]
    note(f"wrote {', '.join(names)} in {options.out}")
