"""Makes ``tests/reference/tracking/scores.json``: made tracks, scored by motmetrics 1.4.0 and TrackEval 1.3.0.

Run it with both packages installed: ``python tests/metrics/tracking_reference.py``.
"""

import json
from pathlib import Path

import numpy as np

from crowdbot.metrics import TrackComparison

FILE = Path(__file__).parents[1] / "reference" / "tracking" / "scores.json"
SEEDS = range(4)
REACH, ZERO = 0.5, 1.0


def made_table(seed):
    """Return 5 people on random walks for 60 instants, and noisy tracks with gaps, changed identities and clutter."""
    rng = np.random.default_rng(seed)
    truth = np.cumsum(rng.normal(0.0, 0.12, (60, 5, 2)), axis=0) + rng.uniform(-2.0, 2.0, (1, 5, 2))
    estimate = np.full((60, 12, 2), np.nan)
    column = np.arange(5)
    for t in range(60):
        if rng.random() < 0.15:
            a, b = rng.choice(5, 2, replace=False)
            column[[a, b]] = column[[b, a]]
        if rng.random() < 0.1:
            column[rng.integers(5)] = 5 + rng.integers(5) if len({*column.tolist()} & {*range(5, 10)}) == 0 else 0
        used = {}
        for person in range(5):
            if rng.random() < 0.85:
                used[column[person]] = truth[t, person] + rng.normal(0.0, 0.2, 2)
        for name, place in used.items():
            estimate[t, name] = place
        if rng.random() < 0.3:
            estimate[t, 10 + rng.integers(2)] = rng.uniform(-3.0, 3.0, 2)
    truth[:10, 0], truth[40:, 1] = np.nan, np.nan
    return TrackComparison(truth, estimate)


def main():
    import motmetrics
    import trackeval

    rows = []
    for seed in SEEDS:
        table = made_table(seed)
        people, tracks = (~np.isnan(item[..., 0]) for item in (table.truth, table.estimate))
        accumulator = motmetrics.MOTAccumulator(auto_id=True)
        distances = table.distances()
        data = {"gt_ids": [], "tracker_ids": [], "similarity_scores": []}
        for t, distance in enumerate(distances):
            inside = distance[people[t]][:, tracks[t]]
            a, b = np.flatnonzero(people[t]), np.flatnonzero(tracks[t])
            accumulator.update(a, b, np.where(inside <= REACH, inside, np.nan))
            data["gt_ids"].append(a)
            data["tracker_ids"].append(b)
            data["similarity_scores"].append(np.maximum(0.0, 1.0 - inside / ZERO))
        used = np.flatnonzero(tracks.any(axis=0))
        data["tracker_ids"] = [np.searchsorted(used, ids) for ids in data["tracker_ids"]]
        data |= {
            "num_gt_ids": people.shape[1], "num_tracker_ids": len(used), "num_timesteps": len(people),
            "num_gt_dets": int(people.sum()), "num_tracker_dets": int(tracks.sum()),
        }  # fmt: skip
        names = ["mota", "motp", "idf1", "num_switches", "num_misses", "num_false_positives"]
        summary = motmetrics.metrics.create().compute(accumulator, metrics=names).iloc[0]
        scores = trackeval.metrics.HOTA().eval_sequence(data)
        row = {name: float(summary[name]) for name in names}
        row |= {name.lower(): float(np.mean(scores[name])) for name in ("HOTA", "DetA", "AssA")}
        rows.append({"seed": seed, **row})
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
