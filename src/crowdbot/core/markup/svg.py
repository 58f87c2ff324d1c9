"""SVG drawings of paths and discs, for notebooks, without a drawing library."""

from __future__ import annotations

import html
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

PERSON_COLOR = "#3b6ea5"
"""Colour of people."""
ROBOT_COLOR = "#d1495b"
"""Colour of robots."""
WALL_COLOR = "#6b6b6b"
"""Colour of walls."""
WIDTH, TALLEST = 640.0, 480.0
MARGIN, CAPTION = 8.0, 22.0
POINTS = 20_000
"""Approximate maximum number of points; longer paths are subsampled."""


class Path2D(NamedTuple):
    """A path in the plane.

    Fields:
        points: ``[N, 2]`` [m]; NaN interrupts the line.
        color: line colour.
        width: line width [px].
        opacity: line opacity, from 0 to 1.
    """

    points: NDArray[np.float64]
    color: str = PERSON_COLOR
    width: float = 1.0
    opacity: float = 1.0


class Disc(NamedTuple):
    """A disc in the plane.

    Fields:
        x, y: centre [m].
        radius: radius [m].
        color: fill colour.
    """

    x: float
    y: float
    radius: float
    color: str = PERSON_COLOR


def draw_svg(paths: Iterable[Path2D], discs: Iterable[Disc] = (), caption: str = "") -> str:
    """Return an SVG drawing, seen from above, with y upwards and equal axes.

    Args:
        paths: lines; later ones are drawn on top.
        discs: discs, drawn on top of the lines.
        caption: line of text below the drawing.

    >>> drawing = draw_svg([Path2D(np.array([[0.0, 0.0], [2.0, 1.0]]))], [Disc(0.0, 0.0, 0.25)], "one person")
    >>> drawing.startswith("<svg"), drawing.count("<path"), drawing.count("<circle"), "one person" in drawing
    (True, 1, 1, True)
    """
    lines, dots = [*paths], [*discs]
    corners = [line.points[np.isfinite(line.points).all(axis=-1)] for line in lines]
    corners += [np.array([[d.x - d.radius, d.y - d.radius], [d.x + d.radius, d.y + d.radius]]) for d in dots]
    points = np.concatenate([np.zeros((0, 2)), *corners])
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(2), np.ones(2))
    size = np.maximum(high - low, 1e-6)
    scale = float(min((WIDTH - 2.0 * MARGIN) / size[0], (TALLEST - 2.0 * MARGIN) / size[1]))
    width, height = size[0] * scale + 2.0 * MARGIN, size[1] * scale + 2.0 * MARGIN
    total = height + (CAPTION if caption else 0.0)
    every = 1 + sum(len(line.points) for line in lines) // POINTS
    body = [_path(line, low, high, scale, every) for line in lines]
    body += [_disc(dot, low, high, scale) for dot in dots]
    if caption:
        text = html.escape(caption)
        body.append(f'<text x="{MARGIN:g}" y="{height + 14:.1f}" font-size="12" font-family="sans-serif">{text}</text>')
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {max(width, 320):.1f} {total:.1f}"'
    return f'{head} width="{max(width, 320):.0f}" height="{total:.0f}">{"".join(body)}</svg>'


def _place(points: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64], scale: float) -> str:
    x = MARGIN + (points[:, 0] - low[0]) * scale
    y = MARGIN + (high[1] - points[:, 1]) * scale
    return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))


def _path(line: Path2D, low: NDArray[np.float64], high: NDArray[np.float64], scale: float, every: int) -> str:
    """Return one line; NaN starts a new stroke, and subsampling keeps the last point."""
    finite = np.isfinite(line.points).all(axis=-1)
    cuts = np.flatnonzero(np.diff(np.concatenate([[False], finite, [False]])))
    strokes = [line.points[a:b] for a, b in zip(cuts[::2], cuts[1::2], strict=True) if b - a > 1]
    thin = [np.concatenate([stroke[:-1:every], stroke[-1:]]) for stroke in strokes]
    d = " ".join("M" + _place(stroke, low, high, scale) for stroke in thin)
    return (
        f'<path d="{d}" fill="none" stroke="{line.color}" stroke-width="{line.width:g}" opacity="{line.opacity:.3g}"/>'
    )


def _disc(dot: Disc, low: NDArray[np.float64], high: NDArray[np.float64], scale: float) -> str:
    x, y = MARGIN + (dot.x - low[0]) * scale, MARGIN + (high[1] - dot.y) * scale
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{max(dot.radius * scale, 1.5):.1f}" fill="{dot.color}"/>'
