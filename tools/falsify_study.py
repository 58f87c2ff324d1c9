"""Measure ``crowdbot falsify`` on trials chosen by seed, against plain Monte Carlo; writes the tables of a page.

    python tools/falsify_study.py --out build/falsify

The trial of seed 0, 1, 2, ... has two people who cross the way of a robot that they do not see. The first three seeds
with fewer than 3 failures in 1000 random runs are searched with 1000 runs. The first seed with more failures is the
check: its probability by searches with 1000 runs and with a tenth of the plain runs, and by plain runs. Plain runs end
after a given time; the same command continues them, as it continues an interrupted study.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path

import numpy as np

from crowdbot.core import stream
from crowdbot.falsification import (
    FalsificationResult,
    PlainSampling,
    SearchSpace,
    falsify,
    parse_factor,
    parse_sampling,
)
from crowdbot.trials import parse_trial, trial_xml

RADIUS, PEOPLE, NEAR = 4.0, 2, 0.5
"""Radius of the circle [m], number of people, and least angle between them [rad]."""
RARE, FIRST = 3, 1000
"""A trial is taken if fewer than 3 of 1000 random runs fail."""
STEP = 1024
"""Plain runs between two looks at the clock."""

TRIAL = """<trial name="ways-{seed}" duration="25" step="0.25">
<crowd type="orca" neighbor-distance="10" time-horizon="5" time-horizon-walls="5"/>
{agents}
<robot x="0" y="-4" heading="1.5707963" radius="0.3" visible="false" control-period="0.25" holonomic="true">
<goal x="0" y="4"/>
<drive type="omnidirectional" max-speed="1" max-acceleration="1000"/>
<navigator type="orca" safety="0.15" neighbor-distance="10" time-horizon="5"/>
<sensor type="ground-truth-people" name="people" rate="1"/>
</robot>
<recording period="0.25"/>
</trial>"""


def make_space(seed: int) -> SearchSpace:
    """Return the trial of a seed: people have random ways and speeds; starts and speeds vary in the search."""
    rng = np.random.default_rng(seed)
    angles: list[float] = []
    while len(angles) < PEOPLE:
        angle = float(rng.uniform(0.0, 2.0 * math.pi))
        if all(abs(math.remainder(angle - other, 2.0 * math.pi)) > NEAR for other in [*angles, -math.pi / 2.0]):
            angles.append(angle)
    agents, factors = [], []
    for number, angle in enumerate(angles, 1):
        x, y = RADIUS * math.cos(angle), RADIUS * math.sin(angle)
        end = angle + math.pi + float(rng.uniform(-0.6, 0.6))
        speed = float(rng.uniform(0.7, 1.2))
        goal = f"{RADIUS * math.cos(end):.2f},{RADIUS * math.sin(end):.2f}"
        place = f'name="p{number}" x="{x:.2f}" y="{y:.2f}"'
        agents.append(f'<agent {place} goal="{goal}" speed="{speed:.2f}" radius="0.3"/>')
        factors += [
            f"agent[p{number}]/x=normal({x:.2f}, 0.3)",
            f"agent[p{number}]/y=normal({y:.2f}, 0.3)",
            f"agent[p{number}]/speed=normal({speed:.2f}, 0.1)",
        ]
    text = TRIAL.format(seed=seed, agents="\n".join(agents))
    return SearchSpace(parse_trial(text), tuple(map(parse_factor, factors)))


def main() -> None:
    """Run the study and print its table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plain", type=int, default=4096, help="most plain runs of the check, a multiple of 1024")
    parser.add_argument("--minutes", type=float, default=6.0, help="time after which no more plain runs begin [min]")
    parser.add_argument("--out", type=Path, default=Path("build/falsify"), help="folder of partial results")
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args()
    rare: list[int] = []
    frequent: list[int] = []
    seed = 0
    while len(rare) < 3 or not frequent:
        random = _run(options, seed, "plain", FIRST, "random")
        (rare if random.failures < RARE else frequent).append(seed)
        if random.failures < RARE and len(rare) <= 3:
            _run(options, seed, "cross-entropy", FIRST, "cross-entropy")
        seed += 1
    for runs in (FIRST, options.plain // 10):
        _run(options, frequent[0], "cross-entropy", runs, "check")
    begin = time.monotonic()
    for runs in range(STEP, options.plain + 1, STEP):
        _run(options, frequent[0], "plain", runs, "plain", "plain")
        if time.monotonic() - begin > 60.0 * options.minutes:
            break


def _run(
    options: argparse.Namespace, seed: int, search: str, runs: int, name: str, place: str = ""
) -> FalsificationResult:
    """Run one search and write its values; the plain runs of the check have another seed than the random ones.

    Searches that share a folder (``place``) and a name share the runs that they have in common.
    """
    space = make_space(seed)
    folder = options.out / f"ways-{seed}" / (place or f"{name}-{runs}")
    own = int(stream(seed, name).integers(2**31))
    sampling = PlainSampling() if search == "plain" else parse_sampling(search)
    result = falsify(space, "collision", sampling, runs=runs, seed=own, folder=folder, workers=options.workers)
    (folder.parent / "trial.xml").write_text(trial_xml(space.trial), encoding="utf-8")
    result.save(folder / "result.json")
    line = {"trial": space.trial.name, "search": name, "runs": runs, "failures": result.failures}
    line |= {"first": result.first_failure, "estimate": str(result.estimate), "clusters": len(result.clusters)}
    line["same"] = [one.same for one in result.found].count(True) == len(result.found)
    print(json.dumps(line), flush=True)
    return result


if __name__ == "__main__":
    main()
