"""Search parameters of the preset ``people``: single file and flow through bottlenecks, a few starts each.

    python tools/people_preset.py FILE [--seed 1] [--sets 20]

appends a row for every parameter set to FILE (JSON lines) and prints those that no other set beats in both measures.
A longer search continues with another seed. ``crowdbot validate --models people`` measures the final choice.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.models import People
from crowdbot.validation import bottleneck, single_file

RANGES = {
    "headway_time_gap": (1.1, 2.0),
    "headway_anticipation": (0.3, 1.2),
    "headway_width": (0.5, 0.8),
    "headway_taper": (0.7, 1.0),
    "range": (0.03, 0.1),
    "strength": (4.0, 10.0),
    "wall_strength": (3.0, 7.0),
    "wall_range": (0.015, 0.04),
}
GAPS = (0.72, 0.95)
"""Allowed time gap minus anticipation [s]: the time gap of people who follow each other at the same speed."""
LIMIT = single_file.LIMIT


def main() -> int:
    """Search, and print the Pareto set."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--sets", type=int, default=20)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    bottleneck.SEEDS = 1
    with options.file.open("a", encoding="utf-8") as out:
        for _ in range(options.sets):
            out.write(json.dumps(measure(draw(rng))) + "\n")
            out.flush()
    rows = [json.loads(line) for line in options.file.read_text(encoding="utf-8").splitlines()]
    for row in pareto(rows):
        print(
            f"single file {row['single file']:.2f} m/s, bottleneck {row['bottleneck']:.2f} /(m s): {row['parameters']}"
        )
    return 0


def draw(rng: np.random.Generator) -> dict[str, float]:
    """Return random parameters."""
    while True:
        found = {name: float(rng.uniform(low, high)) for name, (low, high) in RANGES.items()}
        if GAPS[0] <= found["headway_time_gap"] - found["headway_anticipation"] <= GAPS[1]:
            return found


def measure(parameters: dict[str, float]) -> dict[str, Any]:
    """Return the deviation in single file [m/s] and the specific flow of bottlenecks [1/(m s)]; 0 if it is not run."""
    model = People(**parameters)
    found = single_file.judge(single_file.run(model, True, lambda part: None))
    deviation, flow = float(found.value.split()[0]), 0.0
    if deviation <= LIMIT:
        result = bottleneck.run(model, False, lambda part: None)
        flow = float(np.mean(np.mean(result["flows"], axis=1) / np.asarray(result["width"])))
    return {"parameters": parameters, "single file": deviation, "bottleneck": flow}


def pareto(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the rows that no other row beats in both measures."""

    def beats(a: dict[str, Any], b: dict[str, Any]) -> bool:
        gain = (b["single file"] - a["single file"], a["bottleneck"] - b["bottleneck"])
        return bool(min(gain) >= 0.0 and max(gain) > 0.0)

    return [row for row in rows if not any(beats(other, row) for other in rows)]


if __name__ == "__main__":
    raise SystemExit(main())
