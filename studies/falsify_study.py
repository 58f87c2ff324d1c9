"""Measure ``crowdbot falsify`` on trials chosen by seed, against plain Monte Carlo; writes the tables of a page.

    python studies/falsify_study.py --out build/falsify

The trial of seed 0, 1, 2, ... has two people who cross the way of a robot that they do not see. The delay of its sensor
varies; with ``--family ways`` the sensor is slow instead. The first three seeds with fewer than 3 failures in 1000
random runs are searched with 1000 runs. Then each is searched with a tenth of the plain runs, which follow, the trial
with the largest probability first, and by other searches. No plain runs begin after a given time. The same command
continues an interrupted study.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import stream
from crowdbot.falsification import (
    CrossEntropy,
    PlainSampling,
    Sampling,
    SearchSpace,
    Splitting,
    falsify,
    parse_factor,
)
from crowdbot.trials import parse_trial, trial_xml

PEOPLE, NEAR = 2, 0.5
"""Number of people, and least angle between them [rad]."""
RARE, RANDOM = 3, (64, 128, 256, 512, 1000)
"""A trial is taken if fewer than 3 of 1000 random runs fail; the random runs end early if more do."""
BATCH, STEP = 64, 3200
"""Random runs that are drawn together, and plain runs between two looks at the clock."""
CLEARANCE = "min-clearance>0"
SEARCHES: tuple[tuple[str, str, Sampling], ...] = (
    ("cross-entropy", "collision", CrossEntropy()),
    ("cross-entropy, smallest clearance", CLEARANCE, CrossEntropy()),
    ("splitting, smallest clearance", CLEARANCE, Splitting(replicates=4, particles=48)),
)
"""Searches with 1000 runs: title, failure, search."""

ROBOT = """<robot x="0" y="-{radius:g}" heading="1.5707963" radius="0.3" visible="false" control-period="{period}"
 holonomic="true">
<goal x="0" y="{radius:g}"/>
<drive type="omnidirectional" max-speed="1" max-acceleration="1000"/>
<navigator type="orca" safety="0.15" neighbor-distance="10" time-horizon="5"/>
{sensor}
</robot>"""


class Family(NamedTuple):
    """Trials that differ by their seed.

    Fields:
        radius: radius of the circle [m].
        duration, step, period: duration, time step, and control and recording period [s].
        sensor: sensor and faults of the robot.
        spread: standard deviation of the starts [m].
        factors: what varies beside starts and speeds.
    """

    radius: float
    duration: float
    step: float
    period: float
    sensor: str
    spread: float
    factors: tuple[str, ...] = ()


FAMILIES = {
    "late": Family(
        3.0, 12.0, 0.1, 0.2,
        '<sensor type="ground-truth-people" name="people" rate="10" visible-only="false"/>'
        '<fault type="late-sensor" delay="0.05"/>',
        0.2, ("robot/fault/delay=normal(0.05, 0.05, 0, 0.6)",),
    ),
    "ways": Family(4.0, 25.0, 0.25, 0.25, '<sensor type="ground-truth-people" name="people" rate="1"/>', 0.3),
}  # fmt: skip
"""A late sensor, and one of 1 Hz."""


def make_space(seed: int, name: str = "late") -> SearchSpace:
    """Return the trial of a seed: people have random ways and speeds; starts, speeds and the delay vary."""
    family = FAMILIES[name]
    rng, radius = np.random.default_rng(seed), family.radius
    angles: list[float] = []
    while len(angles) < PEOPLE:
        angle = float(rng.uniform(0.0, 2.0 * math.pi))
        if all(abs(math.remainder(angle - other, 2.0 * math.pi)) > NEAR for other in [*angles, -math.pi / 2.0]):
            angles.append(angle)
    agents, factors = [], []
    for number, angle in enumerate(angles, 1):
        x, y = radius * math.cos(angle), radius * math.sin(angle)
        end = angle + math.pi + float(rng.uniform(-0.6, 0.6))
        speed = float(rng.uniform(0.7, 1.2))
        goal = f"{radius * math.cos(end):.2f},{radius * math.sin(end):.2f}"
        place = f'name="p{number}" x="{x:.2f}" y="{y:.2f}"'
        agents.append(f'<agent {place} goal="{goal}" speed="{speed:.2f}" radius="0.3"/>')
        factors += [
            f"agent[p{number}]/x=normal({x:.2f}, {family.spread})",
            f"agent[p{number}]/y=normal({y:.2f}, {family.spread})",
            f"agent[p{number}]/speed=normal({speed:.2f}, 0.1)",
        ]
    head = f'name="{name}-{seed}" duration="{family.duration:g}" step="{family.step}"'
    crowd = '<crowd type="orca" neighbor-distance="10" time-horizon="5" time-horizon-walls="5"/>'
    robot = ROBOT.format(radius=radius, period=family.period, sensor=family.sensor)
    parts = [crowd, *agents, robot, f'<recording period="{family.period}"/>']
    trial = parse_trial("\n".join([f"<trial {head}>", *parts, "</trial>"]))
    return SearchSpace(trial, tuple(map(parse_factor, [*factors, *family.factors])))


def main() -> None:
    """Run the study and print its table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--family", choices=list(FAMILIES), default="late", help="trials")
    parser.add_argument("--plain", type=int, default=100_000, help="plain runs of a trial")
    parser.add_argument(
        "--minutes", type=float, default=math.inf, help="time after which no more plain runs begin [min]"
    )
    parser.add_argument("--out", type=Path, default=Path("build/falsify"), help="folder of partial results")
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args()
    begin = time.monotonic()
    found: dict[int, float] = {}
    seed = 0
    while len(found) < 3:
        if _is_rare(options, seed):
            found[seed] = _run(options, seed, *SEARCHES[0], 1000)["value"]
        seed += 1
    order = sorted(found, key=lambda one: -found[one])
    for seed in order:
        _run(options, seed, "check", "collision", CrossEntropy(), options.plain // 10)
        runs = 0
        while runs < options.plain and time.monotonic() - begin < 60.0 * options.minutes:
            runs = min(runs + STEP, options.plain)
            _run(options, seed, "plain", "collision", PlainSampling(batch=BATCH), runs, "plain")
    for seed in order:
        for search in SEARCHES[1:]:
            _run(options, seed, *search, 1000)


def _is_rare(options: argparse.Namespace, seed: int) -> bool:
    """Return whether fewer than 3 of 1000 random runs of a trial fail."""
    for runs in RANDOM:
        if _run(options, seed, "random", "collision", PlainSampling(batch=BATCH), runs, "random")["failures"] >= RARE:
            return False
    return True


def _run(
    options: argparse.Namespace,
    seed: int,
    name: str,
    failure: str,
    sampling: Sampling,
    runs: int,
    place: str = "",
) -> dict[str, Any]:
    """Run one search, print its values and keep them; the plain runs have other seeds than the random ones.

    Searches that share a folder (``place``) and a name share the runs that they have in common.
    """
    space = make_space(seed, options.family)
    folder = options.out / space.trial.name / (place or f"{name}-{runs}".replace(", ", "-").replace(" ", "-"))
    file = folder / f"values-{runs}.json"
    if file.is_file():
        return dict(json.loads(file.read_text(encoding="utf-8")))
    own = int(stream(seed, name).integers(2**31))
    result = falsify(space, failure, sampling, runs=runs, seed=own, folder=folder, keep=3, workers=options.workers)
    result.save(folder / "result.json")
    (folder.parent / "trial.xml").write_text(trial_xml(space.trial), encoding="utf-8")
    values = {"trial": space.trial.name, "search": name, "runs": runs, "failures": result.failures}
    values |= {"first": result.first_failure, "estimate": str(result.estimate), "clusters": len(result.clusters)}
    values |= {"value": result.estimate.value if result.estimate else 0.0}
    values["same"] = [one.same for one in result.found].count(True) == len(result.found)
    print(json.dumps(values), flush=True)
    file.write_text(json.dumps(values), encoding="utf-8")
    return values


if __name__ == "__main__":
    main()
