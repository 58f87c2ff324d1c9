"""Write ``docs/results/trial-crowds.md``: how crowds of the preset ``people`` walk in trials, beside experiments.

``python studies/trial_crowds.py --out docs/results/trial-crowds.md`` takes about 15 minutes of computing time.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.progress import track

from crowdbot.measurement import lane_order
from crowdbot.simulation import Episode, simulate_seeds
from crowdbot.trials import Trial, load_trial, parse_trial
from crowdbot.typing import Floats
from crowdbot.validation.scenario import line_speed, weidmann_speed

SEEDS = 20
BATCH = 25
"""Seeds of one simulation."""
LAST = 20.0
"""Time at the end of a run that is measured [s]."""
JAM = 0.134
"""A crowd slower than this [m/s], a tenth of the free speed, is jammed."""
SECTION = 8.0
"""Length of the sections in which the order of lanes is measured [m]."""
STANDS, PATIENCE = 0.5, 60.0
"""A person who moves less than this [m] in this time [s] stands."""
DENSITIES = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0)
FILES = (0.5, 1.0, 1.5)
"""People per metre of a single file."""
DOORS = (0.8, 1.0, 1.2, 1.6, 2.0)
LEAVING = 60
CUT = 1.0 / 6.0
"""Share of the crossings at either end that is left out of a flow."""

FILE = """<trial name="single-file" duration="90" step="0.05" heading-jitter="0.001">
  <crowd type="people"/>
  <contact/>
  <stage>
    <wall points="-15,-0.35 15,-0.35"/>
    <wall points="-15,0.35 15,0.35"/>
  </stage>
  <journey name="east"><direction heading="0"/></journey>
  <spawner count="{count}" zone="-9.8,-0.05 9.8,-0.05 9.8,0.05 -9.8,0.05" journey="east" speed="1.34"/>
  <portal zone="10,-0.35 14,-0.35 14,0.35 10,0.35" dx="-20"/>
</trial>"""
DOOR = """<trial name="door" duration="180" step="0.05" heading-jitter="0.001">
  <crowd type="people"/>
  <contact/>
  <stage>
    <wall points="-8,-3 0,-3 0,-{half}"/>
    <wall points="0,{half} 0,3 -8,3"/>
    <wall points="-8,3 -8,-3"/>
    <wall points="0,-{half} 2.8,-{half}"/>
    <wall points="0,{half} 2.8,{half}"/>
  </stage>
  <routing radius="{routing}"/>
  <spawner count="{count}" zone="-7.7,-2.7 -1,-2.7 -1,2.7 -7.7,2.7" goal="6,-0.5 7,-0.5 7,0.5 6,0.5"/>
</trial>"""
CORNER = """<trial name="corner" duration="60" step="0.05" heading-jitter="0.001">
  <crowd type="people"/>
  <contact/>
  <routing radius="0.3"/>
  <stage>
    <wall points="-2,2 10,2 10,14"/>
    <wall points="-2,0 12,0 12,14"/>
  </stage>
  <spawner count="20" zone="0.3,0.25 6.3,0.25 6.3,1.75 0.3,1.75" goal="10.5,11 11.5,11 11.5,12 10.5,12"/>
</trial>"""


def run_seeds(trial: Trial, count: int) -> list[Episode]:
    """Return the episodes of the seeds 0 to ``count`` - 1 of a trial without its robots."""
    alone = dataclasses.replace(trial, robots=())
    return [
        episode
        for first in range(0, count, BATCH)
        for episode in simulate_seeds(alone, range(first, min(first + BATCH, count)))
    ]


def own_trial(text: str, **values: float | str) -> Trial:
    """Return one of the trials of this file."""
    return parse_trial(text.format(**values), place="trial")


def walking(episode: Episode) -> tuple[Floats, NDArray[np.bool_], Floats]:
    """Return forward speeds ``[T, A]`` [m/s] in the last seconds, who is present, and the direction ``[A]`` of each."""
    along = np.where(episode.active, episode.velocity[..., 0], np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # columns of people who are never present at a recorded step
        side = np.where(np.nanmean(along, axis=0) < 0.0, -1.0, 1.0)
    late = episode.times > episode.times[-1] - LAST
    return along[late] * side, episode.active[late], side


def forward_speed(episode: Episode) -> float:
    """Return the mean forward speed [m/s] in the last seconds."""
    speed, present, _ = walking(episode)
    return float(speed[present].mean())


def section_order(episode: Episode) -> float:
    """Return the mean order of lanes in sections of the corridor, once per second of the last seconds."""
    _, _, side = walking(episode)
    every = round(1.0 / float(episode.times[1] - episode.times[0]))
    orders = []
    for k in np.flatnonzero(episode.times > episode.times[-1] - LAST)[::every]:
        for first in np.arange(-12.0, 12.0, SECTION):
            x = episode.position[k, :, 0]
            here = episode.active[k] & (x >= first) & (x < first + SECTION)
            if min((side[here] > 0.0).sum(), (side[here] < 0.0).sum()) >= 5:
                orders.append(lane_order(episode.position[k, here, 1], side[here]))
    return float(np.mean(orders))


def crossing_times(episode: Episode, x: float) -> Floats:
    """Return the sorted times [s] at which people first are beyond ``x`` [m]."""
    beyond = episode.active & (episode.position[..., 0] > x)
    return np.sort(episode.times[np.argmax(beyond, axis=0)[beyond.any(axis=0)]])


def steady_flow(times: Floats) -> float:
    """Return the flow [1/s] of sorted crossings without the transients at both ends."""
    cut = round(CUT * len(times))
    inner = times[cut : len(times) - cut]
    return (len(inner) - 1) / float(inner[-1] - inner[0])


def stands(episode: Episode) -> bool:
    """Return whether somebody moves less than 0.5 m in 60 s."""
    rows = round(PATIENCE / float(episode.times[1] - episode.times[0]))
    way = np.hypot(*np.moveaxis(episode.position[rows:] - episode.position[:-rows], -1, 0))
    return bool(np.any((way < STANDS) & episode.active[rows:] & episode.active[:-rows]))


def mean_and_range(values: Sequence[float]) -> str:
    """Return mean, minimum and maximum."""
    return f"{np.mean(values):.2f} ({min(values):.2f} to {max(values):.2f})"


def one_way_row(density: float) -> str:
    """Return the row of a one-way corridor."""
    speeds = [forward_speed(one) for one in run_seeds(load_trial("one-way-with", density=density, width=4.0), SEEDS)]
    wanted = float(weidmann_speed(density))
    return f"| {density:g} | {mean_and_range(speeds)} | {wanted:.2f} | {np.mean(speeds) - wanted:+.2f} |"


def two_way_row(width: float, density: float) -> str:
    """Return the row of a two-way corridor."""
    runs = run_seeds(load_trial("two-way", density=density, width=width), SEEDS)
    speeds = [forward_speed(one) for one in runs]
    jams = sum(speed < JAM for speed in speeds)
    orders = [section_order(one) for one, speed in zip(runs, speeds, strict=True) if speed >= JAM]
    order = f"{np.mean(orders):.2f}" if orders else "-"
    speed = f"{np.median(speeds):.2f} ({min(speeds):.2f} to {max(speeds):.2f})"
    return f"| {width:g} | {density:g} | {speed} | {order} | {jams} |"


def file_row(density: float) -> str:
    """Return the row of a single file."""
    speeds = [forward_speed(one) for one in run_seeds(own_trial(FILE, count=round(20.0 * density)), SEEDS)]
    wanted = float(line_speed(density))
    return f"| {density:g} | {mean_and_range(speeds)} | {wanted:.2f} | {np.mean(speeds) - wanted:+.2f} |"


def door_row(width: float) -> str:
    """Return the row of a door."""
    half = 0.5 * width
    trial = own_trial(DOOR, half=half, count=LEAVING, routing=round(min(0.3, half - 0.05), 3))
    times = [crossing_times(one, 1.4) for one in run_seeds(trial, SEEDS)]
    flows = [steady_flow(one) / width for one in times if len(one) == LEAVING]
    left = SEEDS - len(flows)
    value = mean_and_range(flows) if flows else "-"
    return f"| {width:g} | {value} | {left} |"


def sentences() -> list[str]:
    """Return the results that are one number each."""
    corner = run_seeds(own_trial(CORNER), SEEDS)
    around = sum(not one.active[-1].any() for one in corner)
    seconds = float(np.mean([one.times[one.active.any(axis=1)][-1] for one in corner]))
    few = run_seeds(own_trial(DOOR, half=0.5, count=3, routing=0.3), SEEDS)
    through = sum(len(crossing_times(one, 1.4)) == 3 for one in few)
    hall = dataclasses.replace(load_trial("bottleneck"), duration=180.0)
    count = 100
    stand = sum(stands(one) for one in run_seeds(hall, count))
    return [
        f"* 20 people go around a corner of a corridor 2 m wide in {around} of {SEEDS} runs within 60 s; the last"
        f" arrives after {seconds:.0f} s in the mean.",
        f"* Three people alone pass a door of 1 m in {through} of {SEEDS} runs.",
        f"* In the trial `bottleneck`, for 180 s, somebody moves less than {STANDS:g} m in {PATIENCE:g} s in {stand} of"
        f" {count} runs.",
    ]


def page() -> str:
    """Return the page."""
    jobs: list[tuple[str, Callable[[], str]]] = []
    jobs += [("one", lambda d=d: one_way_row(d)) for d in DENSITIES]  # type: ignore[misc]
    jobs += [("two", lambda w=w, d=d: two_way_row(w, d)) for w in (4.0, 6.0) for d in (0.5, 1.0, 1.5, 2.0)]  # type: ignore[misc]
    jobs += [("file", lambda d=d: file_row(d)) for d in FILES]  # type: ignore[misc]
    jobs += [("door", lambda w=w: door_row(w)) for w in DOORS]  # type: ignore[misc]
    rows: dict[str, list[str]] = {"one": [], "two": [], "file": [], "door": []}
    for name, job in track(jobs, "rows", disable=not sys.stderr.isatty()):
        rows[name].append(job())
        print(rows[name][-1], flush=True)
    tables = {name: "\n".join(lines) for name, lines in rows.items()}
    return TEXT.format(seeds=SEEDS, last=LAST, people=LEAVING, sentences="\n".join(sentences()), **tables)


TEXT = """# Crowds in trials

How people of the preset `people` walk in trials, as `crowdbot run` simulates them, beside experiments. This page is
generated by:

```
python studies/trial_crowds.py --out docs/results/trial-crowds.md
```

Bodies, free speeds and contacts are those of every trial: discs with a radius of 0.17 to 0.23 m, 1.34 +- 0.26 m/s
(single file: 1.34 m/s), time step 0.05 s, {seeds} seeds. There is no robot. Values are means over the last {last:g} s
of runs of 90 s, with the smallest and the largest of the runs. The [validation](validation.md) page tests all models,
in shorter corridors, with bodies of 0.20 m.

What does not agree with experiments:

* Two-way flows of 2 people/m2 jam, and some of 1.5 people/m2; people walk on.
* One-way crowds of 2 people/m2 and more are too fast. Below 1 person/m2 they are too slow, since people overtake late.
* At a door of 0.8 m, less than twice as wide as the largest bodies, crowds of 60 clog in some runs.

A disc cannot be a body that is 0.45 m wide and 0.25 m deep. Discs with the half width of the shoulders (0.20 to 0.30 m,
the bodies of trials before) jam in two-way flows at 1 person/m2, where people walk, and 3 people/m2 cannot be placed.
The discs of trials have about the area of a trunk. Shoulders reach a few centimetres beyond them: add 0.05 m to a
clearance that must hold for shoulders.

## One-way corridor

Trial `one-way-with`, 4 m wide, 40 m long and periodic.

| people/m2 | speed [m/s] | Weidmann 1993 | difference |
|---|---|---|---|
{one}

## Two-way corridor

Trial `two-way`, 40 m long and periodic; both directions are mixed at the start. Median speed; order of lanes in
sections of 8 m (0 mixed, 1 complete; recordings have 0.5 to 1), mean of the runs that do not jam; *jams* are runs
below 0.13 m/s.

| width [m] | people/m2 | speed [m/s] | order | jams, of {seeds} |
|---|---|---|---|---|
{two}

## Single file

A periodic track of 20 m between walls 0.7 m apart. The line is 1 / density = 0.36 m + 1.06 s * speed (Seyfried et al.
2005).

| people/m | speed [m/s] | line | difference |
|---|---|---|---|
{file}

## Doors

{people} people leave a room 6 m wide through a passage 2.8 m long. Specific flow without the first and the last sixth
of the people; experiments: 1.9 /(m s) (Seyfried et al. 2009). *Not through*: runs in which not all have left after
180 s.

| width [m] | flow [1/(m s)] | not through, of {seeds} |
|---|---|---|
{door}

## Corners, few people, long jams

{sentences}
"""


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="page")
    options = parser.parse_args()
    options.out.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
