"""Plots of the validation page: one panel per model with equal axes, recorded people in grey."""

from __future__ import annotations

import io
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from .run import Validation
from .scenario import BOTTLENECK_FLOWS, SPECIFIC_FLOW, line_speed, weidmann_speed
from .statistics import summarize_starts

COLUMNS = 5
MODEL, PEOPLE, CURVE, BAD = "#0072b2", "#9a9a9a", "#e69f00", "#d55e00"
"""Colours that are distinguishable with colour blindness (Okabe & Ito)."""

Panel = Callable[[Any, dict[str, Any], dict[str, Any] | None], None]


def draw(done: Validation, folder: Path) -> list[str]:
    """Write one PNG per check and return their names.

    Args:
        done: results; panels of failed checks stay empty.
        folder: output folder.
    """
    names = []
    for name, (title, x, y, panel) in PLOTS.items():
        file = f"{name}.png"
        _grid(done, name, title, x, y, panel, folder / file)
        names.append(file)
    return names


def _grid(done: Validation, name: str, title: str, x: str, y: str, panel: Panel, file: Path) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    found = {model: checks[name] for model, checks in done.outcomes.items() if name in checks}
    rows = max(1, -(-len(found) // COLUMNS))
    columns = max(1, min(COLUMNS, len(found)))
    figure = Figure(figsize=(max(7.0, 0.6 + 2.15 * columns), 1.35 + 1.75 * rows), dpi=100, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    people = (done.people or {}).get(name)
    for axis, (model, one) in zip(axes.flat, found.items(), strict=False):
        axis.set_title(f"{model}, {one.starts} starts", fontsize=8.5, color="black" if one.verdict.passed else BAD)
        axis.grid(alpha=0.25, linewidth=0.6)
        axis.tick_params(labelsize=8)
        if "failed" not in one.result:
            panel(axis, one.result, people)
    for axis in axes.flat[len(found) :]:
        axis.set_visible(False)
    for k in range(columns):  # the last row may be short: labels belong to the lowest panel of each column
        lowest = axes[max(0, len(found) - 1 - k) // columns, k]
        lowest.tick_params(labelbottom=True)
        lowest.set_xlabel(x, fontsize=9)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9, frameon=False)
    figure.suptitle(f"{title} (orange name: criterion not met)", fontsize=11)
    figure.supylabel(y, fontsize=10)
    _save(canvas, file)


def _save(canvas: Any, file: Path) -> None:
    """Save with a palette of 64 colours, a third of the size without visible difference."""
    from PIL import Image

    buffer = io.BytesIO()
    canvas.print_png(buffer)
    picture = Image.open(io.BytesIO(buffer.getvalue())).convert("RGB")
    draft = file.with_suffix(".part")
    picture.quantize(64, dither=Image.Dither.NONE).save(draft, format="PNG", optimize=True)
    os.replace(draft, file)


def _mean(axis: Any, x: Any, mean: Any, low: Any, high: Any) -> None:
    axis.fill_between(x, low, high, color=MODEL, alpha=0.3, linewidth=0, label="95 % interval over starts")
    axis.plot(x, mean, "s-", color=MODEL, markersize=3.5, linewidth=1.2, label="model, mean over starts")


def _single_file(axis: Any, result: dict[str, Any], people: dict[str, Any] | None) -> None:
    if people:
        axis.errorbar(
            people["density"], people["speed"], people["spread"], fmt="o", color=PEOPLE, markersize=3, linewidth=1,
            label="people (n56 ring), deviation",
        )  # fmt: skip
    density = np.linspace(0.2, 2.7, 100)
    axis.plot(density, line_speed(density), color=CURVE, linewidth=1.8, label="Seyfried et al. 2005")
    _mean(axis, result["density"], result["speed"], result["low"], result["high"])
    axis.set(xlim=(0.0, 3.1), ylim=(-0.05, 1.75))


def _corridor(axis: Any, result: dict[str, Any], people: dict[str, Any] | None) -> None:
    if people:
        for k, run in enumerate(people["runs"].values()):
            label = "people (4 HERMES runs), deviation" if k == 0 else None
            axis.errorbar(
                run["density"], run["speed"], run["spread"], fmt="o", color=PEOPLE, markersize=2.5, linewidth=0.8,
                label=label,
            )  # fmt: skip
    density = np.linspace(0.1, 5.0, 100)
    axis.plot(density, weidmann_speed(density), color=CURVE, linewidth=1.8, label="Weidmann 1993")
    _mean(axis, result["density"], result["speed"], result["low"], result["high"])
    axis.set(xlim=(0.0, 5.0), ylim=(-0.05, 1.75))


def _lanes(axis: Any, result: dict[str, Any], people: dict[str, Any] | None) -> None:
    for k, run in enumerate((people or {}).values()):
        label = "people (3 recordings), mean over time" if k == 0 else None
        axis.axhline(run["mean"], color=PEOPLE, linewidth=1.0, linestyle="--", label=label)
    axis.plot(result["time"], result["order"], color=MODEL, linewidth=1.4, label="model, mean over starts")
    axis.set(xlim=(0.0, 60.0), ylim=(-0.15, 1.05))


def _narrow(axis: Any, result: dict[str, Any], people: dict[str, Any] | None) -> None:
    for k, (density, speeds) in enumerate(zip(result["density"], result["speeds"], strict=True)):
        label = "one start" if k == 0 else None
        axis.plot([density] * len(speeds), speeds, "o", color=MODEL, markersize=3.5, label=label, alpha=0.7)
    axis.plot(result["density"], np.mean(result["speeds"], axis=1), color=MODEL, linewidth=1.2, label="mean")
    axis.axhline(0.134, color=BAD, linewidth=1.2, linestyle="--", label="slower is a jam")
    axis.set(xlim=(0.25, 2.25), ylim=(-0.05, 1.55))


def _bottleneck(axis: Any, result: dict[str, Any], people: list[dict[str, Any]] | None) -> None:
    width = np.array([0.4, 2.6])
    axis.plot(width, SPECIFIC_FLOW * width, color=CURVE, linewidth=1.8, label="1.9 per metre (Seyfried et al. 2009)")
    axis.plot(*zip(*BOTTLENECK_FLOWS, strict=True), "^", color="black", markersize=3, label="Liddle et al. 2009")
    if people:
        axis.plot([d["width"] for d in people], [d["flow"] for d in people], "o", color=PEOPLE, markersize=4,
                  label="people (4 recordings)")  # fmt: skip
    found = summarize_starts(result["flows"])
    _mean(axis, result["width"], found["mean"], found["low"], found["high"])
    axis.set(xlim=(0.4, 2.6), ylim=(-0.3, 8.0))


PLOTS: dict[str, tuple[str, str, str, Any]] = {
    "single-file": ("Single file: speed over line density", "people per metre [1/m]", "speed [m/s]", _single_file),
    "corridor": ("One-way corridor: speed over density", "people per area [1/m²]", "speed [m/s]", _corridor),
    "lanes": ("Two-way flow, 4 m wide, 1 person/m²: order of lanes", "time [s]", "order (1 = pure lanes)", _lanes),
    "narrow": ("Two-way flow, 2 m wide: forward speed after 80 s", "people per area [1/m²]", "speed [m/s]", _narrow),
    "bottleneck": ("Bottleneck: flow over width", "width [m]", "flow [people/s]", _bottleneck),
}
"""Title, axis labels and panel function of each check."""
