"""VideoRun: people in the video of a robot's camera, from images to forecasts in metres."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Pose, SpatialPose
from crowdbot.metrics import TrackComparison, tracking_scores
from crowdbot.perception import BoxDetector, Detections, Tracker, Tracks
from crowdbot.prediction import Live, Predictor
from crowdbot.sensors import RgbImage, cast_plane
from crowdbot.typing import Floats

from .camera_files import CameraCalibration, RobotOdometry, TruePaths, iterate_frames

STEP = 0.4
"""Time between the rows of a forecast [s]."""
MARGIN = 0.5
"""Share of the directions to a person that must be free for a person who must be found."""
BODY = 0.25
"""Radius of a person [m]."""


@dataclass(frozen=True)
class VideoForecast:
    """A forecast at one frame: ``ids [A]``, ``position [T, A, 2]`` [m] at ``time + ahead [T]`` [s].

    ``start [A, 2]`` are the places at ``time`` [m].
    """

    time: float
    ids: NDArray[np.int64]
    start: Floats
    position: Floats
    ahead: Floats


@dataclass(frozen=True)
class VideoRun:
    """People found in a video.

    Fields:
        time: ``[F]`` of the frames [s].
        pose: poses of the camera.
        detections, tracks: of each frame.
        forecasts: at most one for each frame.
        image: the last frame ``[H, W, 3]``.
        camera: the camera.
    """

    time: Floats
    pose: tuple[SpatialPose, ...]
    detections: tuple[Detections, ...]
    tracks: tuple[Tracks, ...]
    forecasts: tuple[VideoForecast, ...]
    image: NDArray[np.uint8]
    camera: CameraCalibration

    def table(self, truth: TruePaths, max_range: float) -> TrackComparison:
        """Return true people and tracks; people outside the image or behind others need not be found.

        Args:
            truth: true tracks with the same clock.
            max_range: people farther away need not be found [m].
        """
        people, tracks, hidden = [], [], []
        for now, pose, known in zip(self.time, self.pose, self.tracks, strict=True):
            there = truth.at(float(now))
            ids, place = list(there), np.array(list(there.values())).reshape(-1, 2)
            seen = self._visible(place, pose, max_range)
            people.append(there)
            tracks.append(dict(zip(known.ids.tolist(), known.position.tolist(), strict=True)))
            hidden.append([who for who, item in zip(ids, seen, strict=True) if not item])
        return TrackComparison.of(people, tracks, hidden)

    def scores(self, truth: TruePaths, reach: float, max_range: float) -> dict[str, float]:
        """Return the scores of the tracks, and the displacement errors of the forecasts [m] by their time ahead.

        A forecast counts for the person within reach of the track at the time of the forecast.
        """
        found = tracking_scores(self.table(truth, max_range), self.time, reach)
        errors: dict[float, list[float]] = {}
        for forecast in self.forecasts:
            for ahead, error in _errors(forecast, truth, reach):
                errors.setdefault(ahead, []).append(error)
        return found | {f"error_at_{ahead:g}_s": float(np.mean(rows)) for ahead, rows in sorted(errors.items())}

    def _visible(self, place: Floats, pose: SpatialPose, max_range: float) -> NDArray[np.bool_]:
        """Return which people are in the image, within the range, and not behind others."""
        lens = self.camera.lens
        if not len(place):
            return np.zeros(0, dtype=np.bool_)
        angles = np.linspace(-np.pi, np.pi, 1440, endpoint=False)
        planar = pose.planar
        _, hit = cast_plane(
            Pose(planar.position, planar.heading), angles, place[None], np.full((1, len(place)), BODY),
            np.zeros((0, 4)), max_range + 1.0,
        )  # fmt: skip
        away = place - planar.position[0]
        distance = np.linalg.norm(away, axis=1)
        bearing = np.angle(np.exp(1j * (np.arctan2(away[:, 1], away[:, 0]) - planar.heading[0])))
        half = np.arctan(0.5 * lens.width / lens.fx)
        whole = 2.0 * np.arcsin(np.minimum(1.0, BODY / np.maximum(distance, BODY))) * 1440 / (2.0 * np.pi)
        share = np.bincount(hit[hit >= 0], minlength=len(place))[: len(place)] / whole
        return np.asarray((np.abs(bearing) < half) & (distance <= max_range) & (share > MARGIN))


def track_video(
    file: Path | str, camera: CameraCalibration, odometry: RobotOdometry, detector: BoxDetector, tracker: Tracker,
    predictor: Predictor, steps: int = 8, start: float | None = None, progress: Callable[[float], None] | None = None,
) -> VideoRun:  # fmt: skip
    """Return the people in the video of a robot's camera, and their forecasts.

    Args:
        file: the video.
        camera, odometry: where the camera is at each frame.
        detector: finds boxes in images.
        tracker: follows people on the floor.
        predictor: predicts the tracks.
        steps: number of rows of 0.4 s of a forecast.
        start: time of the first frame [s]; default: the first of the odometry.
        progress: called with the share of the time of the odometry.

    Raises:
        DataError: the video cannot be read.
        InputError: the detector does not read images.
    """
    if not isinstance(detector, BoxDetector):
        raise InputError(f"{type(detector).__name__} does not find people in images; see `crowdbot list detectors`")
    live, state = Live(predictor, STEP), tracker.begin()
    times, poses, found, rows, forecasts = [], [], [], [], []
    image = np.zeros((camera.lens.height, camera.lens.width, 3), dtype=np.uint8)
    for now, image in iterate_frames(file, camera.lens, float(odometry.time[0]) if start is None else start):
        pose = camera.pose(odometry.at(now))
        detections = detector.detect(RgbImage(now, pose, image[None], None, camera.lens))
        tracks, state = tracker.update(detections, now, state)
        live.update(tracks.ids, tracks.position, time=now, covariances=tracks.covariance[:, :2, :2])
        if len(tracks):
            ahead = live.predict(steps)
            place = np.einsum("k,ktai->tai", ahead.weight[0], ahead.position[0])
            start_places = live.past().position[0, -1]
            later = STEP * np.arange(1.0, steps + 1.0)
            forecasts.append(VideoForecast(now, np.asarray(live.ids), start_places, place, later))
        times.append(now)
        poses.append(pose)
        found.append(detections)
        rows.append(tracks)
        if progress is not None:
            progress(min(1.0, (now - times[0]) / max(1e-9, float(odometry.time[-1]) - times[0])))
    return VideoRun(np.array(times), tuple(poses), tuple(found), tuple(rows), tuple(forecasts), image, camera)


def _errors(forecast: VideoForecast, truth: TruePaths, reach: float) -> list[tuple[float, float]]:
    """Return time ahead [s] and error [m] of each row of a forecast whose person is known."""
    now = truth.at(forecast.time)
    if not now:
        return []
    ids, place, found = list(now), np.array(list(now.values())), []
    whose = []
    for a in range(len(forecast.ids)):
        away = np.linalg.norm(place - forecast.start[a], axis=1)
        whose.append(ids[int(away.argmin())] if away.min() <= reach else None)
    for row, ahead in enumerate(forecast.ahead):
        later = truth.at(forecast.time + float(ahead))
        for a, who in enumerate(whose):
            if who in later:
                error = np.linalg.norm(forecast.position[row, a] - np.array(later[who]))
                found.append((round(float(ahead), 6), float(error)))
    return found
