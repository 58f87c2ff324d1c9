"""``crowdbot predict``: score a predictor on recordings of people."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .output import Progress, add_json, note, print_json, print_table, progress

if TYPE_CHECKING:
    from crowdbot.metrics import Score
    from crowdbot.prediction import Predictor

EPISODE_STEP = 0.4
"""A recorded trial has no annotation rate of its own: it is scored at the field's 0.4 s."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add(
        "--data", nargs="+", type=Path, required=True, metavar="PATH", help="recordings, scored one by one and together"
    )
    add("--predictor", default="constant-velocity", metavar="NAME", help="crowdbot list predictors, or file.py:Name")
    add("--model", metavar="NAME", help="crowd model of the predictor `simulated`: crowdbot list models")
    add("--set", nargs="+", default=[], metavar="NAME=VALUE", help="parameters of the predictor, or of its crowd model")
    add("--observe", type=int, default=8, metavar="ROWS", help="observed rows (default 8)")
    add("--predict", type=int, default=12, metavar="ROWS", help="predicted rows (default 12)")
    add("--protocol", default="all", metavar="NAME", help="all, sgan, partial or timesplit (default all)")
    add("--samples", type=int, default=1, metavar="K", help="futures drawn from a predictor that samples")
    add("--best-of", default="person", metavar="RULE", help="how the best of K is chosen: person, scene or same")
    add("--near", type=float, metavar="METRES", help="score only people this near to a recorded robot")
    add("--fps", type=float, metavar="F", help="rows a second of one track, when the file does not say")
    add("--format", metavar="NAME", help="crowdbot list formats; default: found by content")
    add("--time-base", default="true", metavar="NAME", help="true or published, for the ETH file with two time bases")
    add("--units", metavar="NAME", help="m, cm or px, when the file does not say")
    add("--late", default="skip", metavar="NAME", help="people who appear while observed: skip or extrapolate")
    add("--seed", type=int, default=0, help="seed of predictors that sample")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Score the predictor on every recording and on all together."""
    from crowdbot.metrics import Score

    predictor = chosen(options.predictor, options.model, assignments(options.set))
    notes: dict[str, None] = {}
    with progress(options.json) as report:
        scores = {str(path): _score(path, predictor, options, report, notes) for path in options.data}
    total = Score.total(list(scores.values()))
    if options.json:
        print_json(as_json(total, scores))
        return 0
    for sentence in notes:
        note(sentence)
    heads = Score.heads([total, *scores.values()])
    rows = [(Path(name).name, *score.cells(heads)) for name, score in scores.items()]
    if len(scores) > 1:
        rows.append(("together", *total.cells(heads)))
    best = f", best of {options.samples} per {options.best_of}" if options.samples > 1 else ""
    print_table(
        f"{total.predictor}, {options.observe} observed + {options.predict} predicted rows",
        ("recording", *heads),
        rows,
        caption=f"protocol {total.protocol}{best}; means over persons",
    )
    return 0


def as_json(total: Score, scores: Mapping[str, Score]) -> dict[str, Any]:
    """Return the object that ``--json`` prints."""
    return {
        "protocol": total.protocol,
        "predictor": total.predictor,
        "total": _five(total),
        "data": {name: _five(score) for name, score in scores.items()},
    }


def assignments(words: list[str]) -> dict[str, str]:
    """Return ``name=value`` words as a mapping."""
    from crowdbot.core import InputError

    wrong = next((word for word in words if "=" not in word), None)
    if wrong is not None:
        raise InputError(f"--set takes NAME=VALUE, not {wrong!r}")
    return {name: value for name, _, value in (word.partition("=") for word in words)}


def chosen(name: str, model: str | None, values: Mapping[str, str]) -> Predictor:
    """Return the predictor by name with its parameters; the crowd model's own parameters go to the model."""
    import dataclasses

    from crowdbot import models, prediction
    from crowdbot.core import InputError, plug

    kind = plug.find(name, prediction, prediction.Predictor)
    fields = {field.name for field in dataclasses.fields(kind)}
    if "model" not in fields:
        if model is not None:
            raise InputError(f"--model is for predictors that simulate a crowd; {plug.kebab(kind.__name__)} does not")
        return plug.read(kind, values)  # type: ignore[no-any-return]
    own = {key: value for key, value in values.items() if key.replace("-", "_") in fields}
    rest = {key: value for key, value in values.items() if key not in own}
    crowd = plug.read(plug.find(model or "orca", models, models.CrowdModel), rest)
    return dataclasses.replace(plug.read(kind, own), model=crowd)  # type: ignore[no-any-return]


def _score(
    path: Path, predictor: Predictor, options: argparse.Namespace, report: Progress, notes: dict[str, None]
) -> Score:
    from crowdbot.data import load
    from crowdbot.prediction import evaluate

    tracks = load(path, options.fps, options.format, options.units, options.time_base)
    if tracks.units == "px" and tracks.homography is not None:
        tracks = tracks.metres()
    if tracks.robots and options.fps is None:
        tracks = tracks.resample(EPISODE_STEP)
    if tracks.note:
        notes[f"{path.name}: {tracks.note}"] = None
    past, future = tracks.windows(options.observe, options.predict, options.protocol, options.near, options.late)
    return evaluate(
        predictor,
        past,
        future,
        samples=options.samples,
        best_of=options.best_of,
        seed=options.seed,
        progress=lambda share: report(path.name, share),
    )


def _five(score: Score) -> dict[str, float]:
    return {
        "windows": score.windows,
        "persons": score.persons,
        "ade": score.ade,
        "fde": score.fde,
        "seconds_per_window": score.seconds_per_window,
    }
