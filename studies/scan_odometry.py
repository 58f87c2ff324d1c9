"""Print how far the motion of a scanner from its scans is off: ``python studies/scan_odometry.py [--seeds N]``.

A robot drives through each trial, and :class:`crowdbot.perception.ScanOdometry` gets its scans of 360 beams with 1 cm
noise. Printed are the distances from the true place at the end and on average over the scans, each a mean over the
seeds, the largest one at an end, and the processor time of a scan. The halls of `random-hall` are those of layouts 11,
12, ... for seeds 0, 1, ...
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np

from crowdbot.core import Pose, SpatialPose
from crowdbot.evaluation import ReadingLog, log_readings
from crowdbot.perception import LidarClusters, ScanOdometry
from crowdbot.trials import load_trial

TRIALS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("block", {}),
    ("four-blocks", {}),
    ("corner-traffic", {}),
    ("doorway", {}),
    ("entering-room", {}),
    ("random-hall", {}),
    ("random-hall", {"length": 24.0, "width": 18.0, "tables": 4, "bodies": "limbs"}),
)
LAYOUT = 11
"""Layout of the hall of seed 0."""


def place(pose: Pose | SpatialPose) -> tuple[float, float, float]:
    """Return x, y [m] and heading [rad] of a pose of one environment."""
    x, y, *_ = pose.position[0].tolist()
    return x, y, float(pose.heading[0])


def errors(log: ReadingLog) -> tuple[list[float], float]:
    """Return the distance from the true place at each scan [m], and the processor time of a scan [ms]."""
    odometry, state, distances = ScanOdometry(), None, []
    begin, seconds = place(log.rows[0].reading.pose), 0.0
    cos, sin = np.cos(begin[2]), np.sin(begin[2])
    for row in log.rows:
        start = time.process_time()
        pose, state = odometry.update(row.reading, state)
        seconds += time.process_time() - start
        x, y, _ = place(row.reading.pose)
        dx, dy = x - begin[0], y - begin[1]
        found = place(pose)
        distances.append(float(np.hypot(found[0] - cos * dx - sin * dy, found[1] + sin * dx - cos * dy)))
    return distances, 1e3 * seconds / len(log.rows)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seeds", type=int, default=4, help="runs of each trial (default: %(default)s)")
    seeds = range(parser.parse_args().seeds)
    print("| trial | at the end [m] | largest [m] | on average [m] | a scan [ms] |\n|---|---:|---:|---:|---:|")
    for name, values in TRIALS:
        found = []
        for seed in seeds:
            hall = {"layout": LAYOUT + seed} if name == "random-hall" else {}
            found.append(errors(log_readings(load_trial(name, values | hall), seed, LidarClusters())))
        ends = [distances[-1] for distances, _ in found]
        mean, cost = np.mean([np.mean(distances) for distances, _ in found]), np.mean([ms for _, ms in found])
        title = " ".join(
            [
                f"`{name}`",
                *(
                    f"{key}={value:g}" if isinstance(value, float) else f"{key}={value}"
                    for key, value in values.items()
                ),
            ]
        )
        print(f"| {title} | {np.mean(ends):.3f} | {max(ends):.3f} | {mean:.3f} | {cost:.1f} |", flush=True)


if __name__ == "__main__":
    main()
