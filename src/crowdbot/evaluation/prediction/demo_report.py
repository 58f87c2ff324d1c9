"""Report: a self-contained HTML page about a recorded trial and the predictions of its people."""

from __future__ import annotations

import html
import importlib.resources
import io
import json
import math
import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from crowdbot.data import Forecast, Windows
    from crowdbot.metrics import Score
    from crowdbot.simulation import Episode


COLORS = ("#e69f00", "#cc79a7", "#009e73", "#0072b2", "#d55e00", "#56b4e9")
"""Colours that are distinguishable with colour blindness (Okabe & Ito)."""
LINES = (("o", "-"), ("s", "--"), ("^", "-."), ("D", ":"), ("v", "-"), ("P", "--"))
"""Marker and line of each predictor, so that curves on one line can be told apart without colours."""
FRAME = 0.1
"""Period of the animation [s]."""
OPENING = 5.0
"""Initial time of the animation [s], with the robot among people."""
MARGIN = 0.6


@dataclass(frozen=True)
class PredictionResult:
    """Forecasts of a predictor for the windows of an episode, and their score."""

    forecast: Forecast
    score: Score


def write_demo_report(
    path: Path,
    episode: Episode,
    past: Windows,
    future: Windows,
    predicted: Sequence[PredictionResult],
    commands: Mapping[str, str],
    seen: str,
) -> Path:
    """Write the page atomically.

    Args:
        path: file to write.
        episode: the recorded trial.
        past, future: windows of its people at the prediction times, ``[W, T, A, ...]``.
        predicted: one entry for each predictor, over the same windows.
        commands: commands that reproduce each part, with a description of the part.
        seen: description of the input of the predictors.
    """
    page = Template(_asset("page.html")).substitute(
        title=html.escape(f"{episode.trial.name}: {episode.outcome}"),
        lead=html.escape(episode.trial.about),
        style=_asset("page.css"),
        script=_asset("page.js"),
        cards=_cards(episode, predicted),
        seen=html.escape(seen),
        prediction=_prediction_table(predicted, future),
        horizon=_horizon_chart(predicted, future.dt),
        horizon_words=f"Mean distance to the true position over the horizon, over the same {predicted[0].score.persons}"
        " person-windows; right: differences, on the scale of the predictors that are close to each other.",
        navigation=_navigation_table(episode),
        commands=html.escape("\n".join(f"# {what}\n{command}" for command, what in commands.items())),
        environment=html.escape(_environment(episode)),
        data=_data(episode, past, future, predicted),
    )
    draft = path.with_suffix(".part")
    draft.write_text(page, encoding="utf-8")
    os.replace(draft, path)
    return path


def _asset(name: str) -> str:
    return importlib.resources.files("crowdbot").joinpath("assets", "report", name).read_text(encoding="utf-8")


def _cards(episode: Episode, predicted: Sequence[PredictionResult]) -> str:
    best = min(predicted, key=lambda one: one.score.ade).score
    people = episode.position.shape[1] - len(episode.robots)
    cards = [
        (episode.outcome, "outcome", "good" if episode.outcome == "success" else "bad"),
        (f"{episode.times[-1]:.1f} s", "simulated time", ""),
        (str(people), "people", ""),
        (f"{episode.metrics['min_clearance']:.2f} m", "minimum clearance between the robot and people", ""),
        (
            f"{best.ade:.2f} m",
            f"mean error over {best.dt * len(best.horizon):.1f} s of the best predictor, {best.predictor}",
            "",
        ),
    ]
    return "".join(
        f'<li class="{kind}"><b>{html.escape(value)}</b><span>{html.escape(words)}</span></li>'
        for value, words, kind in cards
    )


def _prediction_table(predicted: Sequence[PredictionResult], future: Windows) -> str:
    best, marked = min(item.score.ade for item in predicted), ' class="best"'
    rows = "".join(
        f"<tr{marked if item.score.ade == best else ''}><td>{html.escape(item.score.predictor)}</td>"
        + "".join(f"<td>{cell}</td>" for cell in item.score.cells())
        + "</tr>"
        for item in predicted
    )
    head = "".join(f"<th>{name}</th>" for name in ("predictor", *predicted[0].score.columns))
    horizon = future.dt * future.position.shape[1]
    return (
        f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
        f'<p class="hint">Protocol {html.escape(predicted[0].score.protocol)}, {horizon:.1f} s ahead every'
        f" {future.dt} s; means over persons. ADE: mean distance over the horizon; FDE: distance at its end;"
        " collisions: share of people with a predicted distance below 0.2 m to another person, centre to centre.</p>"
    )


def _navigation_table(episode: Episode) -> str:
    from crowdbot.metrics import FALL_METRICS, IMPACT_METRICS, NAVIGATION_METRICS

    known = NAVIGATION_METRICS | IMPACT_METRICS | FALL_METRICS
    rows = "".join(
        f"<tr><td>{html.escape(name.replace('_', ' '))}</td><td>{_format_value(value)}</td><td>{html.escape(unit)}</td>"
        f"<td>{html.escape(words)}</td></tr>"
        for name, value in episode.metrics.items()
        for unit, words in [known.get(name.rpartition(".")[2], ("", ""))]
    )
    head = "<tr><th>metric</th><th>value</th><th>unit</th><th>definition</th></tr>"
    return f'<table class="words"><thead>{head}</thead><tbody>{rows}</tbody></table>'


def _format_value(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.3f}" if math.isfinite(value) else ("-" if math.isnan(value) else "none")
    return html.escape(str(value))


def _environment(episode: Episode) -> str:
    import numba

    version = importlib.import_module("crowdbot").__version__
    return (
        f"crowdbot {version}, Python {platform.python_version()}, numpy {np.__version__},"
        f" numba {numba.__version__}, {platform.system()} {platform.machine()};"
        f" seed {episode.seed}, digest {episode.digest}"
    )


def _horizon_chart(predicted: Sequence[PredictionResult], dt: float) -> str:
    """Return a picture of the mean errors over the horizon, and beside it of their differences to the first one.

    The errors of good predictors lie on one line; the scale of the differences is that of the middle predictor.
    """
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context({"svg.hashsalt": "crowdbot", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 10}):
        figure = Figure(figsize=(9.6, 3.4), layout="constrained")
        errors, differences = figure.subplots(1, 2)
        first = np.asarray(predicted[0].score.horizon)
        times = dt * np.arange(1, len(first) + 1)
        for item, color, (marker, line) in zip(predicted, COLORS, LINES, strict=False):
            look: dict[str, Any] = {"color": color, "label": item.score.predictor, "marker": marker, "linestyle": line}
            curve = np.asarray(item.score.horizon)
            errors.plot(times, curve, markersize=4, **look)
            differences.plot(times, curve - first, markersize=4, **look)
        errors.set_ylabel("mean error [m]")
        errors.set_ylim(bottom=0.0)
        errors.legend(frameon=False)
        differences.set_ylabel(f"difference to {predicted[0].score.predictor} [m]")
        far = [float(np.max(np.abs(np.asarray(item.score.horizon) - first))) for item in predicted[1:]]
        if far and (reach := sorted(far)[(len(far) - 1) // 2]) > 0.0:
            differences.set_ylim(-1.3 * reach, 1.3 * reach)
        for axes in (errors, differences):
            axes.set_xlabel("time ahead [s]")
            axes.grid(alpha=0.3)
            axes.spines[["top", "right"]].set_visible(False)
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    return text.getvalue()[text.getvalue().index("<svg") :]


def _data(episode: Episode, past: Windows, future: Windows, predicted: Sequence[PredictionResult]) -> str:
    robot = episode.robots[0]
    chosen = _frames(episode.times)
    times = episode.times[chosen]
    people = [a for a in range(episode.position.shape[1]) if a not in episode.robots]
    spec = episode.trial.robots[0]
    page = {
        "bounds": _bounds(episode),
        "walls": [_round(ring) for ring in episode.walls],
        "times": _round(times),
        "opening": int(np.searchsorted(times, OPENING)),
        "people": [_track(episode, a, chosen) for a in people],
        "robot": {
            **_track(episode, robot, chosen),
            "radius": spec.radius,
            "goal": [*spec.goal.position, spec.goal.tolerance],
        },
        "scans": _scans(episode),
        "forecasts": _forecasts(past, future, predicted, times[0]),
    }
    return json.dumps(page, separators=(",", ":"), allow_nan=False).replace("</", "<\\/")


def _frames(times: np.ndarray) -> np.ndarray:
    stride = max(1, round(FRAME / float(times[1] - times[0])))
    return np.arange(0, len(times), stride)


def _bounds(episode: Episode) -> list[float]:
    points = episode.position[episode.active]
    corners = np.concatenate([points, *episode.walls])
    low, high = corners.min(axis=0) - MARGIN, corners.max(axis=0) + MARGIN
    return [float(low[0]), float(low[1]), float(high[0]), float(high[1])]


def _track(episode: Episode, agent: int, frames: np.ndarray) -> dict[str, Any]:
    here = episode.active[frames, agent]
    place, heading = episode.position[frames, agent], episode.heading[frames, agent]
    return {
        "r": round(float(episode.radius[agent]), 3),
        "x": _or_none(place[:, 0], here),
        "y": _or_none(place[:, 1], here),
        "h": _or_none(heading, here),
    }


def _scans(episode: Episode) -> dict[str, Any]:
    scans = episode.scans
    if not scans:
        return {"times": [], "poses": [], "angles": [], "ranges": []}
    return {
        "times": _round([scan.time for scan in scans]),
        "poses": [_round(scan.pose) for scan in scans],
        "angles": [round(float(a), 4) for a in scans[0].angles],
        "ranges": [_or_none(scan.ranges, np.isfinite(scan.ranges)) for scan in scans],
    }


def _forecasts(past: Windows, future: Windows, predicted: Sequence[PredictionResult], begin: float) -> dict[str, Any]:
    observed = past.position.shape[1]
    instants = [float(begin + past.dt * (frame + observed - 1)) for frame in range(len(past))]
    return {
        "times": _round(instants),
        "period": past.dt,
        "truth": _paths(past, future, future.position),
        "predictors": [
            {
                "name": item.score.predictor,
                "color": color,
                "shown": index in (0, len(predicted) - 1),
                "paths": _paths(past, future, item.forecast.position[:, 0]),
            }
            for index, (item, color) in enumerate(zip(predicted, COLORS, strict=False))
        ],
    }


def _paths(past: Windows, future: Windows, position: np.ndarray) -> list[list[list[list[float]]]]:
    now = past.position[:, -1]
    return [
        [_round(np.concatenate([now[w, a][None], position[w, :, a]])) for a in np.flatnonzero(future.scored[w])]
        for w in range(len(past))
    ]


def _round(values: Any) -> Any:
    return np.round(np.asarray(values, dtype=float), 3).tolist()


def _or_none(values: np.ndarray, here: np.ndarray) -> list[float | None]:
    return [round(float(v), 3) if ok else None for v, ok in zip(values, here, strict=True)]
