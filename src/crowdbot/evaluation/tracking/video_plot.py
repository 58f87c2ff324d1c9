"""Plot of a video run: boxes of people in the last frame with their forecasts, and the map with the true paths."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.sensors import Lens
from crowdbot.typing import Floats

from .camera_files import TruePaths
from .video_run import VideoForecast, VideoRun

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c510a")
LAST = 4.0
"""Time before the last frame that is drawn [s]."""
BODY = 0.3
"""Half width of the drawn mark of a person on the floor [m]."""


def plot_video_run(run: VideoRun, file: Path, truth: TruePaths | None = None) -> Path:
    """Draw the last frame with tracks and forecasts on the floor, and the map from above, as PNG; return the file.

    Args:
        run: the run.
        file: output file.
        truth: true paths, drawn in grey from 4 s before to the end of the forecasts.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(13, 5.2), dpi=110)
    left.imshow(run.image)
    left.set_axis_off()
    left.set_title(f"last frame, {run.time[-1]:.1f} s: people on the floor and forecasts")
    now = [forecast for forecast in run.forecasts if forecast.time == run.time[-1]]
    pose = run.pose[-1]
    for item in now:
        _draw_on_image(left, run, item)
    left.set(xlim=(0, run.image.shape[1]), ylim=(run.image.shape[0], 0))
    if truth is not None:
        _draw_truth(right, run, truth)
    _draw_map(right, run, now)
    middle, heading = pose.planar.position[0], float(pose.planar.heading[0])
    half = float(np.arctan(0.5 * run.camera.lens.width / run.camera.lens.fx))
    for turn in (-half, half):
        end = middle + 10.0 * np.array([np.cos(heading + turn), np.sin(heading + turn)])
        right.plot([middle[0], end[0]], [middle[1], end[1]], color="#888888", linewidth=0.8, linestyle="--")
    path = np.array([item.planar.position[0] for item in run.pose])
    right.plot(path[:, 0], path[:, 1], color="black", linewidth=2.0, label="camera")
    right.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title="map, last 4 s")
    right.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(file)
    pyplot.close(figure)
    return file


def _draw_truth(axis: Any, run: VideoRun, truth: TruePaths) -> None:
    end = float(run.time[-1])
    for k, rows in enumerate(truth.rows.values()):
        past = rows[(rows[:, 0] >= end - LAST) & (rows[:, 0] <= end)]
        later = rows[(rows[:, 0] >= end) & (rows[:, 0] <= end + LAST)]
        axis.plot(past[:, 1], past[:, 2], color="#b8b8b8", linewidth=5.0, label=None if k else "true path")
        axis.plot(later[:, 1], later[:, 2], color="#b8b8b8", linewidth=1.5, label=None if k else "true future")


def _draw_map(axis: Any, run: VideoRun, now: list[VideoForecast]) -> None:
    table: dict[int, list[tuple[float, float]]] = {}
    for time, tracks in zip(run.time, run.tracks, strict=True):
        for who, (x, y) in zip(tracks.ids.tolist(), tracks.position.tolist(), strict=True):
            if time >= run.time[-1] - LAST:
                table.setdefault(who, []).append((x, y))
    for k, (who, places) in enumerate(sorted(table.items())):
        path = np.array(places)
        axis.plot(path[:, 0], path[:, 1], color=COLORS[who % len(COLORS)], label=None if k else "track")
    first = True
    for item in now:
        for a, who in enumerate(item.ids.tolist()):
            path = np.concatenate([item.start[a][None], item.position[:, a]])
            label = "forecast" if first else None
            axis.plot(path[:, 0], path[:, 1], "o:", color=COLORS[who % len(COLORS)], markersize=2.5, label=label)
            first = False


def _draw_on_image(axis: Any, run: VideoRun, video_forecast: VideoForecast) -> None:
    """Draw a mark below each person and the forecast on the floor."""
    for a, who in enumerate(video_forecast.ids.tolist()):
        color = COLORS[who % len(COLORS)]
        circle = np.linspace(0.0, 2.0 * np.pi, 33)
        mark = video_forecast.start[a] + BODY * np.stack([np.cos(circle), np.sin(circle)], axis=-1)
        path = np.concatenate([video_forecast.start[a][None], video_forecast.position[:, a]])
        for line, style in ((mark, "-"), (path, ":")):
            pixel = _project(line, run)
            if len(pixel) > 1:
                axis.plot(pixel[:, 0], pixel[:, 1], style, color=color, linewidth=2.0)


def _project(place: Floats, run: VideoRun) -> Floats:
    """Return the pixels ``[M, 2]`` of places ``[N, 2]`` on the floor that are before the camera."""
    lens: Lens = run.camera.lens
    pose = run.pose[-1]
    point = np.concatenate([place, np.zeros((len(place), 1))], axis=1) - pose.position[0]
    ahead = point @ pose.matrix[0]
    ahead = ahead[ahead[:, 0] > 0.3]
    right, down = lens.distort(-ahead[:, 1] / ahead[:, 0], -ahead[:, 2] / ahead[:, 0])
    return np.stack([right * lens.fx + lens.cx, down * lens.fy + lens.cy], axis=-1)
