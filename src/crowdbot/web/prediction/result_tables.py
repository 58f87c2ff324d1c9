"""Tables and series of the results: metrics, error by horizon, variables by frame, files."""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.core import InputError, did_you_mean
from crowdbot.metrics import Score
from crowdbot.web.plain_json import plain_number

from .prediction_board import CLEAN, INPUTS, BoardMember, PredictionBoard
from .prediction_results import VARIABLES, PredictorResults


def variable_names(board: PredictionBoard) -> list[dict[str, str]]:
    """Return the variables of the online plots: those of every run, then the fitted parameters."""
    units = "m" if board.setup is None else board.tracks.units
    found = [{"name": name, "label": label, "unit": _unit(unit, units)} for name, (label, unit) in VARIABLES.items()]
    names: dict[str, str] = {}
    for _, _, results in _each(board):
        names |= dict(results.parameter_names())
    return found + [{"name": n, "label": n.replace("_", " "), "unit": _unit(u, units)} for n, u in names.items()]


def variable_rows(board: PredictionBoard, variable: str, person: int | None) -> dict[str, Any]:
    """Return a variable by frame for every predictor, for everybody or one person.

    Raises:
        InputError: there is no such variable.
    """
    known = {name["name"]: name for name in variable_names(board)}
    if variable not in known:
        raise InputError(f"variable {variable!r:.40} does not exist{did_you_mean(variable, known)}")
    rows = [_row(m, name) | {"values": results.series(variable, person)} for m, name, results in _each(board)]
    frames = board.windows()[0].frame[:, -1].tolist()
    return {"label": known[variable]["label"], "unit": known[variable]["unit"], "frames": frames, "rows": rows}


def horizon_rows(board: PredictionBoard) -> dict[str, Any]:
    """Return the mean error at each predicted row for every predictor."""
    steps, dt = board.recording.predict, board.tracks.dt
    rows = [_row(m, name) | {"values": results.horizon()} for m, name, results in _each(board) if results.count]
    return {
        "seconds": [round(dt * (row + 1), 6) for row in range(steps)],
        "unit": board.tracks.units,
        "rows": [row for row in rows if len(row["values"]) == steps],
    }


def score_table(board: PredictionBoard) -> dict[str, Any]:
    """Return the table of metrics, with the columns of `crowdbot predict`, and the protocol."""
    shown = [(m, name, _score(m, results)) for m, name, results in _each(board)]
    scores = [score for _, _, score in shown if score is not None]
    heads = Score.heads(scores) if scores else ()
    rows = []
    for member, name, score in shown:
        if score is None:
            continue
        results = member.results[name]
        clean = member.results[CLEAN].score if CLEAN in member.results else None
        more = score.ade - clean.ade if name != CLEAN and clean is not None else None
        best = f"best of {score.samples} per {score.best_of}" if score.samples > 1 else ""
        part = "" if results.state == "done" else f"{results.count} of {len(results.past)} frames"
        rows.append(
            _row(member, name)
            | {"cells": list(score.cells(heads)), "state": results.state, "difference": plain_number(more)}
            | {"note": ", ".join(filter(None, (best, part)))}
        )
    r, dt = board.recording, board.tracks.dt
    caption = (
        f"protocol {r.protocol}, {r.observe} rows ({r.observe * dt:.3g} s) observed, {r.predict} rows"
        f" ({r.predict * dt:.3g} s) predicted; means over persons, 95 % intervals by bootstrap over persons"
    )
    return {"heads": list(heads), "rows": rows, "caption": caption, "unit": board.tracks.units}


def frame_table(board: PredictionBoard) -> Any:
    """Return a pandas table with a row for each frame, predictor and input, as `frames.parquet` of `crowdbot predict`.

    Raises:
        InputError: there is no result.
    """
    import pandas as pd

    tables = []
    for member, name, results in _each(board):
        frames = results.frames()
        if frames is not None:
            columns = {"recording": board.recording.name, "predictor": member.spec.name, "input": name}
            tables.append(pd.DataFrame({**columns, **vars(frames)}))
    if not tables:
        raise InputError("there is no result yet; run the predictors first")
    return pd.concat(tables, ignore_index=True)


def person_table(board: PredictionBoard) -> Any:
    """Return a pandas table with a row for each scored person and window: errors and fitted parameters.

    Raises:
        InputError: there is no result.
    """
    import pandas as pd

    rows = []
    for member, name, results in _each(board):
        for index in range(len(results.past)):
            for id in results.future.id[index, results.future.scored[index]].tolist():
                if results.forecast(index) is None:
                    continue
                found = results.person(index, id)
                own = {one["name"]: one["value"] for one in found["parameters"]}
                frame = int(results.past.frame[index, -1])
                head = {"predictor": member.spec.name, "input": name, "frame": frame, "id": id}
                rows.append({**head, "ade": found["ade"], "fde": found["fde"], "cost": found["cost"], **own})
    if not rows:
        raise InputError("there is no result yet; run the predictors first")
    return pd.DataFrame(rows)


def _each(board: PredictionBoard) -> list[tuple[BoardMember, str, PredictorResults]]:
    return [(m, name, m.results[name]) for m in board.members for name in INPUTS if name in m.results]


def _row(member: BoardMember, name: str) -> dict[str, Any]:
    return {"key": member.key, "slot": member.slot, "input": name, "label": member.label}


def _score(member: BoardMember, results: PredictorResults) -> Score | None:
    """Return the score; of a run that was cancelled, over the windows that it has predicted."""
    if results.score is not None or results.state != "cancelled":
        return results.score
    errors = results.errors()
    if errors is None:
        return None
    done = np.flatnonzero([results.forecast(index) is not None for index in range(len(results.past))])
    return Score.of(errors, member.spec.name, member.choice.samples, results.future[done], "person")


def _unit(unit: str, units: str) -> str:
    return "" if unit == "1" else units if unit == "m" else unit
