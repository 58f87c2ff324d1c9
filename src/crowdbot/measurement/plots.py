"""Plots of measurements, one PNG for each table that has a plot."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .interaction_energy import pool_interaction_energy
from .survey import Measurements

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c510a", "#525252")
"""Colours that are distinguishable with colour blindness (Okabe & Ito), then brown and grey."""

Draw = Callable[[Any, Any, str, str], None]


def plot_measurements(found: Sequence[Measurements], folder: Path) -> list[Path]:
    """Draw all tables and return the files, PNG.

    Recordings share the panels of curves; profiles and Voronoi densities are drawn for the first recording.

    Args:
        found: results of :func:`~crowdbot.measurement.measure`.
        folder: output folder; it is created.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for name, (x, y, draw) in CURVES.items():
        source = SOURCES.get(name, name)
        some = [one for one in found if source in one.tables and len(one.tables[source])]
        if some:
            files.append(_curves(name, x, y, draw, some, folder))
    tables = [one.tables["time-to-collision"] for one in found if "time-to-collision" in one.tables]
    if len(tables) > 1:
        files.append(_pooled_energy(tables, folder))
    for name, title in PROFILES.items():
        if found and "profiles" in found[0].tables:
            files.append(_profile(found[0], name, title, folder))
    for name, columns in PANELS.items():
        some = [one for one in found if name in one.tables]
        if some:
            files.append(_panels(name, columns, some, folder))
    return files


def _line(axis: Any, table: Any, label: str, color: str, x: str, y: str, **style: Any) -> None:
    axis.plot(table[x], table[y], color=color, label=label, linewidth=1.4, **style)


def _diagram(axis: Any, table: Any, label: str, color: str) -> None:
    axis.errorbar(table.density, table.speed, table.spread, fmt="o-", color=color, label=label, markersize=4,
                  linewidth=1.2, elinewidth=0.8, capsize=2)  # fmt: skip
    axis.fill_between(table.density, table.low, table.high, color=color, alpha=0.25, linewidth=0)


def _flow(axis: Any, table: Any, label: str, color: str) -> None:
    axis.plot(table.density, table.flow, "o-", color=color, label=label, markersize=4, linewidth=1.2)


def _steps(axis: Any, table: Any, label: str, color: str) -> None:
    axis.step(table.time, table.cumulative_pedestrians, where="post", color=color, label=label, linewidth=1.4)


def _points(x: str, y: str) -> Draw:
    def draw(axis: Any, table: Any, label: str, color: str) -> None:
        axis.plot(table[x], table[y], ".", color=color, label=label, markersize=4)

    return draw


def _curve(x: str, y: str, **style: Any) -> Draw:
    def draw(axis: Any, table: Any, label: str, color: str) -> None:
        _line(axis, table, label, color, x, y, **style)

    return draw


def _unity(x: str, y: str) -> Draw:
    """Draw a curve beside the line at 1, where there is no interaction."""

    def draw(axis: Any, table: Any, label: str, color: str) -> None:
        _line(axis, table, label, color, x, y)
        axis.axhline(1.0, color="#9a9a9a", linewidth=0.8, linestyle="--")

    return draw


def _times(axis: Any, table: Any, label: str, color: str) -> None:
    axis.fill_between(table.ttc, table.low, table.high, color=color, alpha=0.25, linewidth=0)
    _line(axis, table, label, color, "ttc", "g")
    axis.axhline(1.0, color="#9a9a9a", linewidth=0.8, linestyle="--")


def _energy(axis: Any, table: Any, label: str, color: str) -> None:
    near = table[table.ttc <= LONGEST_TIME]
    low, mean, high = (near[name].to_numpy() for name in ("energy_low", "energy", "energy_high"))
    spread = np.nan_to_num(np.abs(np.stack([mean - low, high - mean])))
    axis.errorbar(near.ttc, mean, spread, fmt="o", color=color, label=label, markersize=3,
                  linewidth=0.8)  # fmt: skip
    axis.plot(near.ttc, near.fit, color=color, linewidth=1.4)
    axis.axhline(0.0, color="#9a9a9a", linewidth=0.8, linestyle="--")


def _pooled_energy(tables: Sequence[Any], folder: Path) -> Path:
    figure = _figure(6.0, 4.0)
    axis = figure.subplots()
    _energy(axis, pool_interaction_energy(tables).table, f"{len(tables)} recordings or starts", COLORS[0])
    axis.set(xlabel="time to collision τ [s]", ylabel="energy ln 1/g(τ), with fit k τ^-n + c")
    _finish(axis, ())
    return _save(figure, folder / "interaction-energy-pooled.png")


LONGEST_TIME = 4.0
"""Longest time to collision of the plot of the energy [s]."""

CURVES: Mapping[str, tuple[str, str, Draw]] = {
    "diagram": ("Voronoi density [1/m²]", "speed [m/s]", _diagram),
    "diagram-values": ("Voronoi density [1/m²]", "speed [m/s]", _points("density", "speed")),
    "n-t": ("time [s]", "people beyond the line", _steps),
    "passages": ("density during the passage [1/m²]", "speed of the passage [m/s]", _points("density", "speed")),
    "clearance": ("clearance [m]", "frequency [1/m]", _curve("value", "density")),
    "time-to-collision": ("time to collision τ [s]", "g(τ), with 95 % interval", _times),
    "interaction-energy": ("time to collision τ [s]", "energy ln 1/g(τ), with fit k τ^-n + c", _energy),
    "pair-distribution": ("distance r [m]", "g(r)", _unity("radius", "g")),
    "lanes": ("time [s]", "order of lanes", _curve("time", "order", marker=".")),
    "acceleration": ("acceleration [m/s²]", "frequency [s²/m]", _curve("value", "density")),
    "file-diagram": ("line density [1/m]", "speed [m/s]", _diagram),
    "headways": ("gap ahead [m]", "speed [m/s]", _points("ahead", "speed")),
}
"""Tables that are one panel: label of x, label of y, how a recording is drawn."""

SOURCES = {"interaction-energy": "time-to-collision"}
"""Tables of the plots that have another name."""

PROFILES = {"density": "density [1/m²]", "speed": "speed [m/s]", "flow": "specific flow [1/(m s)]"}

PANELS: Mapping[str, Sequence[tuple[str, Sequence[str]]]] = {
    "area": (
        ("density [1/m²]", ("voronoi_density", "classic_density")),
        ("speed [m/s]", ("voronoi_speed", "mean_speed")),
        ("specific flow [1/(m s)]", ("specific_flow",)),
    ),
    "line": (("density [1/m²]", ("density",)), ("speed [m/s]", ("speed",)), ("flow [1/(m s)]", ("flow",))),
}
"""Tables over time with several panels: label of y and columns of each."""


def _curves(name: str, x: str, y: str, draw: Draw, found: Sequence[Measurements], folder: Path) -> Path:
    figure = _figure(6.0, 4.0)
    axis = figure.subplots()
    for k, one in enumerate(found):
        draw(axis, one.tables[SOURCES.get(name, name)], one.name, _color(k))
    axis.set(xlabel=x, ylabel=y)
    if name in ("diagram", "file-diagram", "clearance", "acceleration", "time-to-collision", "pair-distribution"):
        axis.set_ylim(bottom=0.0)
    _finish(axis, found)
    return _save(figure, folder / f"{name}.png")


def _panels(
    name: str, columns: Sequence[tuple[str, Sequence[str]]], found: Sequence[Measurements], folder: Path
) -> Path:
    figure = _figure(7.0, 2.0 * len(columns) + 0.4)
    axes = figure.subplots(len(columns), 1, sharex=True)
    for axis, (unit, names) in zip(axes, columns, strict=True):
        for k, one in enumerate(found):
            table = one.tables[name]
            for style, column in zip(("-", ":"), names, strict=False):
                label = one.name if style == "-" else None
                axis.plot(table.time, table[column], style, color=_color(k), label=label, linewidth=1.2)
            steady = one.tables.get("steady")
            for first, last in [] if steady is None or name != "area" else steady.to_numpy():
                axis.axvspan(first, last, color=_color(k), alpha=0.12, linewidth=0)
        axis.set_ylabel(unit, fontsize=9)
        if names[1:]:
            title = f"solid: {names[0]}, dotted: {names[1]}".replace("_", " ")
            axis.set_title(title, fontsize=8, loc="left")
        _finish(axis, found, legend=axis is axes[0])
    axes[-1].set_xlabel("time [s]")
    return _save(figure, folder / f"{name}.png")


def _profile(measurements: Measurements, name: str, title: str, folder: Path) -> Path:
    assert measurements.grid is not None
    left, right, bottom, top = measurements.grid.extent
    tall = min(8.0, max(2.0, 6.0 * (top - bottom) / (right - left)))
    figure = _figure(7.2, tall + 0.8)
    axis = figure.subplots()
    values = measurements.tables["profiles"][name].to_numpy().reshape(measurements.grid.rows, measurements.grid.columns)
    image = axis.imshow(values, extent=measurements.grid.extent, cmap="viridis", vmin=0.0, interpolation="nearest")
    for ring in (measurements.walkable.border, *measurements.walkable.obstacles):
        axis.plot(*np.vstack([ring, np.asarray(ring)[:1]]).T, color="black", linewidth=1.0)
    axis.plot(
        *np.vstack([measurements.area.corners, np.asarray(measurements.area.corners)[:1]]).T,
        color="white",
        linewidth=1.0,
    )
    if measurements.line is not None:
        axis.plot(*zip(measurements.line.start, measurements.line.end, strict=True), color=COLORS[1], linewidth=1.5)
    axis.set(xlabel="x [m]", ylabel="y [m]", title=measurements.name, xlim=(left, right), ylim=(bottom, top))
    figure.colorbar(image, ax=axis, label=title, shrink=0.9)
    return _save(figure, folder / f"profile-{name}.png")


def _finish(axis: Any, found: Sequence[Measurements], legend: bool = True) -> None:
    axis.grid(alpha=0.25, linewidth=0.6)
    axis.tick_params(labelsize=8)
    axis.spines[["top", "right"]].set_visible(False)
    if legend and len(found) <= len(COLORS):
        axis.legend(fontsize=7, frameon=False)


def _color(k: int) -> str:
    return COLORS[k % len(COLORS)]


def _figure(width: float, height: float) -> Any:
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), dpi=110, layout="constrained")


def _save(figure: Any, file: Path) -> Path:
    from matplotlib import rc_context

    draft = file.with_suffix(".part")
    with rc_context({"font.family": "sans-serif"}):
        figure.savefig(draft, format="png", metadata={"Software": None})
    os.replace(draft, file)
    return file
