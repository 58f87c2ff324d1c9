"""Plots of an evaluation: errors by predictor, error and time by frame, animation of a window."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, stream
from crowdbot.data import Recording, Windows
from crowdbot.prediction import PredictorSpec

from .evaluation import PredictorEvaluation, PredictorResult

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c510a", "#525252")
"""Colours that are distinguishable with colour blindness (Okabe & Ito), then brown and grey."""
PEOPLE, TRUTH, ORACLE = "#9a9a9a", "#000000", "#f0c987"
MOST_LINES = len(COLORS)
"""Maximum number of predictors drawn as lines."""
SHOWN_ROWS = 80
ANIMATIONS = (".gif", ".mp4", ".webp")
"""Endings of animations."""
FAINTEST = 0.06
"""Opacity of the least probable futures."""
FRAMES_A_ROW = 3
"""Images per row of the recording in an animation."""


def plot_errors(results: Sequence[PredictorResult], file: Path) -> None:
    """Draw the ADE of each predictor with its 95 % interval, one panel per recording, sorted by error."""
    from matplotlib.patches import Patch

    panels = _by_recording(results)
    most = max(len(own) for own in panels.values())
    figure, axes = _figure(1, len(panels), (1.0 + 5.5 * len(panels), 1.2 + 0.17 * min(most, SHOWN_ROWS)))
    for axis, (recording, own) in zip(axes[0], panels.items(), strict=True):
        ranked = sorted(own, key=lambda one: one.score.ade)[:SHOWN_ROWS]
        for row, item in enumerate(ranked):
            low, high = item.score.intervals.ade
            axis.barh(row, item.score.ade, color=_color(item), height=0.7)
            axis.plot((low, high), (row, row), color="black", linewidth=1)
        axis.set_yticks(range(len(ranked)), [item.label for item in ranked], fontsize=6)
        axis.margins(y=0.01)
        axis.invert_yaxis()
        axis.set_xlabel(f"ADE [{own[0].score.units}], 95 % bootstrap interval", fontsize=8)
        axis.tick_params(axis="x", labelsize=8)
        left = "" if len(own) <= SHOWN_ROWS else f" (best {SHOWN_ROWS} of {len(own)})"
        axis.set_title(f"{recording.name}, {recording.predict} rows{left}", fontsize=9, loc="left")
        axis.grid(axis="x", alpha=0.25, linewidth=0.6)
    kinds = {"calibrated": COLORS[0], "as given": PEOPLE, "knows the true destinations": ORACLE}
    handles = [Patch(color=color, label=word) for word, color in kinds.items()]
    figure.legend(handles=handles, fontsize=7, loc="outside lower center", ncols=3)
    _save(figure, file)


def _color(result: PredictorResult) -> str:
    if result.spec.knows_future:
        return ORACLE
    return COLORS[0] if result.frames.calibrated else PEOPLE


def plot_frames(results: Sequence[PredictorResult], file: Path) -> None:
    """Draw error, minimum cost and time by frame, one row of panels per recording, for the first eight predictors."""
    panels = _by_recording(results)
    figure, axes = _figure(len(panels), 3, (13, 0.8 + 2.5 * len(panels)))
    for row, (recording, own) in zip(axes, panels.items(), strict=True):
        shown = own[:MOST_LINES]
        for color, item in zip(COLORS, shown, strict=False):
            frames = item.frames
            for axis, values in zip(row, (frames.ade, frames.cost, 1e3 * frames.seconds), strict=True):
                if not np.all(np.isnan(values)):
                    axis.plot(*_broken(frames.frame, values), color=color, linewidth=0.9, label=item.label)
        unit = own[0].score.units
        for axis, name in zip(row, (f"error (ADE) [{unit}]", "minimum cost [m]", "time [ms]"), strict=True):
            axis.set_title(f"{recording.name}: {name}", fontsize=9)
            axis.set_xlabel("frame", fontsize=8)
            axis.tick_params(labelsize=8)
            axis.grid(alpha=0.25, linewidth=0.6)
        row[2].set_yscale("log")
        if not any(item.frames.calibrated for item in shown):
            row[1].text(0.5, 0.5, "nothing was calibrated", ha="center", transform=row[1].transAxes, fontsize=8)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), fontsize=7, loc="outside lower center", ncols=2)
    _save(figure, file)


def animate_window(evaluation: PredictorEvaluation, frame: int, file: Path) -> Path:
    """Write an animation of one window: observed and true tracks, and the forecasts of each predictor.

    Args:
        evaluation: recordings and predictors.
        frame: last observed frame of the window.
        file: GIF, MP4 or WebP file, by its ending; MP4 requires PyAV.

    Raises:
        InputError: no window of the recordings ends at this frame, there are more than eight predictors, or the ending
            is not known.
    """
    if file.suffix not in ANIMATIONS:
        raise InputError(f"{file.name}: an animation ends with {', '.join(ANIMATIONS)}")
    if len(evaluation.specs) > MOST_LINES:
        raise InputError(f"an animation shows at most {MOST_LINES} predictors, not {len(evaluation.specs)}")
    recording, window = evaluation.window_at(frame)
    past, future = (item[window : window + 1] for item in recording.windows)
    labels = evaluation.labels()
    paths = {labels[spec.name]: _paths(spec, recording, past, evaluation) for spec in evaluation.specs}
    figure, axes = _figure(1, 1, (7.5, 7.0))
    axis = axes[0, 0]
    _background(axis, past, future, paths)
    figure.set_figheight(np.clip(7.0 * np.ptp(axis.get_ylim()) / np.ptp(axis.get_xlim()) + 1.2, 2.6, 7.0))
    axis.set_xlabel(f"x [{recording.tracks.units}]", fontsize=8)
    axis.set_ylabel(f"y [{recording.tracks.units}]", fontsize=8)
    axis.set_title(f"{recording.name}, frame {frame}", fontsize=10)
    lines = [_fan(axis, color, name, tracks) for color, (name, tracks) in zip(COLORS, paths.items(), strict=False)]
    discs = axis.scatter([], [], s=60, color=PEOPLE, edgecolor="black", linewidth=0.5, zorder=3)
    figure.legend(*axis.get_legend_handles_labels(), fontsize=7, loc="outside lower center", ncols=2)
    steps = recording.predict

    def draw(number: int) -> None:
        reach = number / FRAMES_A_ROW
        discs.set_offsets(_at(past, future, reach))
        for line, tracks in zip(lines, paths.values(), strict=True):
            line.set_segments(_until(tracks.path, reach))

    _animate(figure, draw, steps * FRAMES_A_ROW + 1, max(1, round(FRAMES_A_ROW / past.dt)), file)
    return file


def _animate(figure: Any, draw: Callable[[int], None], images: int, fps: int, file: Path) -> None:
    """Draw the images of an animation and write them."""
    if file.suffix == ".gif":
        from matplotlib.animation import FuncAnimation, PillowWriter

        FuncAnimation(figure, draw, frames=images).save(file, PillowWriter(fps=fps))
        return
    from crowdbot.rendering import reel

    writer = reel(file, fps)
    try:
        for number in range(images):
            draw(number)
            figure.canvas.draw()
            writer.add(np.asarray(figure.canvas.buffer_rgba())[..., :3])
        writer.finish()
    except BaseException:
        writer.abandon()
        raise


class _Futures(NamedTuple):
    """Futures of all people.

    Fields:
        path: one line ``[T + 1, 2]`` per person and future with a weight, from the last observed row on.
        opacity: of each line, in proportion to the probability of the future; 1 for the most probable one of a person.
    """

    path: list[NDArray[np.float64]]
    opacity: list[float]


def _paths(spec: PredictorSpec, recording: Recording, past: Windows, evaluation: PredictorEvaluation) -> _Futures:
    """Return the futures of the people of a window."""
    predictor = spec.build(recording)
    forecast = predictor.predict(past, recording.predict, evaluation.samples, stream(evaluation.seed, "animate"))
    own = forecast.person_weight
    futures = _Futures([], [])
    for person in np.flatnonzero(past.present[0, -1]):
        weight = forecast.weight[0] if own is None else own[0, :, person]
        order = np.argsort(weight, kind="stable")  # the most probable one is drawn last
        for k in order[weight[order] > 0.0]:
            futures.path.append(np.concatenate([past.position[0, -1:, person], forecast.position[0, k, :, person]]))
            futures.opacity.append(max(FAINTEST, float(weight[k] / weight.max())))
    return futures


def _fan(axis: Any, color: str, name: str, futures: _Futures) -> Any:
    """Add the futures of a predictor to a picture as a fan, with a line in the legend."""
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_rgba

    axis.plot([], [], color=color, linewidth=1.6, label=name)
    colors = [to_rgba(color, item) for item in futures.opacity]
    single = min(futures.opacity, default=1.0) == 1.0  # single trajectories are drawn above the fans of others
    fan = LineCollection([], colors=colors, linewidths=1.6, zorder=2.5 if single else 2.0)
    axis.add_collection(fan)
    return fan


def _background(axis: Any, past: Windows, future: Windows, paths: dict[str, _Futures]) -> None:
    for ring in past.walls:
        axis.plot(*np.vstack([ring, ring[:1]]).T, color="black", linewidth=1)
    everything = [point for tracks in paths.values() for point in tracks.path]
    for person in np.flatnonzero(past.present[0, -1]):
        seen = past.position[0, past.present[0, :, person], person]
        later = future.position[0, future.present[0, :, person], person]
        axis.plot(*seen.T, color=PEOPLE, linewidth=1)
        axis.plot(*np.vstack([seen[-1:], later]).T, color=TRUTH, linewidth=0.8, linestyle=":")
        everything += [seen, later]
    points = np.concatenate(everything) if everything else np.zeros((1, 2))
    low, high = points.min(axis=0) - 1.0, points.max(axis=0) + 1.0
    axis.set_xlim(low[0], high[0])
    axis.set_ylim(low[1], high[1])
    axis.set_aspect("equal")
    axis.plot([], [], color=TRUTH, linewidth=0.8, linestyle=":", label="true path")


def _at(past: Windows, future: Windows, reach: float) -> NDArray[np.float64]:
    """Return the true positions ``reach`` rows after the last observed one."""
    path = np.concatenate([past.position[0, -1:], future.position[0]])
    here = np.concatenate([past.present[0, -1:], future.present[0]])
    row = min(int(reach), len(path) - 1)
    after = min(row + 1, len(path) - 1)
    known = here[row] & here[after]
    place = path[row] + (reach - row) * (path[after] - path[row])
    return np.asarray(place[known])


def _until(tracks: list[NDArray[np.float64]], reach: float) -> list[NDArray[np.float64]]:
    """Return the lines up to ``reach`` rows ahead."""
    row = int(reach)
    until = []
    for track in tracks:
        after = min(row + 1, len(track) - 1)
        tip = track[min(row, len(track) - 1)] + (reach - row) * (track[after] - track[min(row, len(track) - 1)])
        until.append(np.vstack([track[: row + 1], tip]))
    return until


def _broken(frame: NDArray[np.int64], values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return a line by frame with gaps at missing frames."""
    jumps = np.flatnonzero(np.diff(frame) > 2 * np.median(np.diff(frame))) + 1 if len(frame) > 1 else np.zeros(0, int)
    return np.insert(frame.astype(float), jumps, np.nan), np.insert(values, jumps, np.nan)


def _by_recording(results: Sequence[PredictorResult]) -> dict[Recording, list[PredictorResult]]:
    recording: dict[Recording, list[PredictorResult]] = {}
    for result in results:
        recording.setdefault(result.recording, []).append(result)
    return recording


def _figure(rows: int, columns: int, size: tuple[float, float]) -> tuple[Any, Any]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, columns, squeeze=False)


def _save(figure: Any, file: Path) -> None:
    fresh = file.with_suffix(".part")
    figure.savefig(fresh, format="png")
    fresh.replace(file)
