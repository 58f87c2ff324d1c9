"""Write ``docs/results/trial-crowds.md``: how crowds of the preset ``people`` walk in trials, beside experiments.

``python studies/trial_crowds.py --out docs/results/trial-crowds.md`` takes about 15 minutes of computing time.
``python studies/trial_crowds.py --row two-way 4 2 --seeds 4 --seconds 45 --set headway_spacing=0.1`` prints one row
with other values of the preset.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
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

TOLERANCE = 0.1
"""Difference [m/s] from Weidmann's curve that the head of the page does not name."""

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


@dataclass(frozen=True)
class Runs:
    """Seeds of a trial without its robots, for how long they run, and with which values of the crowd.

    Fields:
        seeds: number of seeds, from 0.
        seconds: simulated time [s]; None: that of the trial.
        values: parameters of the crowd that differ from the preset.
    """

    seeds: int = SEEDS
    seconds: float | None = None
    values: Mapping[str, float] = field(default_factory=dict)

    def of(self, trial: Trial) -> list[Episode]:
        """Return the episodes of a trial."""
        crowd = dataclasses.replace(trial.crowd, **self.values)
        alone = dataclasses.replace(trial, robots=(), crowd=crowd, duration=self.seconds or trial.duration)
        return [
            episode
            for first in range(0, self.seeds, BATCH)
            for episode in simulate_seeds(alone, range(first, min(first + BATCH, self.seeds)))
        ]


PAGE = Runs()


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


def one_way_row(density: float, runs: Runs = PAGE) -> str:
    """Return the row of a one-way corridor."""
    speeds = [forward_speed(item) for item in runs.of(load_trial("one-way-with", density=density, width=4.0))]
    wanted = float(weidmann_speed(density))
    return f"| {density:g} | {mean_and_range(speeds)} | {wanted:.2f} | {np.mean(speeds) - wanted:+.2f} |"


def two_way_row(width: float, density: float, runs: Runs = PAGE) -> str:
    """Return the row of a two-way corridor."""
    episodes = runs.of(load_trial("two-way", density=density, width=width))
    speeds = [forward_speed(episode) for episode in episodes]
    jams = sum(speed < JAM for speed in speeds)
    orders = [section_order(episode) for episode, speed in zip(episodes, speeds, strict=True) if speed >= JAM]
    order = f"{np.mean(orders):.2f}" if orders else "-"
    speed = f"{np.median(speeds):.2f} ({min(speeds):.2f} to {max(speeds):.2f})"
    return f"| {width:g} | {density:g} | {speed} | {order} | {jams} |"


def file_row(density: float, runs: Runs = PAGE) -> str:
    """Return the row of a single file."""
    speeds = [forward_speed(item) for item in runs.of(own_trial(FILE, count=round(20.0 * density)))]
    wanted = float(line_speed(density))
    return f"| {density:g} | {mean_and_range(speeds)} | {wanted:.2f} | {np.mean(speeds) - wanted:+.2f} |"


def door_row(width: float, runs: Runs = PAGE) -> str:
    """Return the row of a door."""
    half = 0.5 * width
    trial = own_trial(DOOR, half=half, count=LEAVING, routing=round(min(0.3, half - 0.05), 3))
    times = [crossing_times(item, 1.4) for item in runs.of(trial)]
    flows = [steady_flow(time) / width for time in times if len(time) == LEAVING]
    left = runs.seeds - len(flows)
    value = mean_and_range(flows) if flows else "-"
    return f"| {width:g} | {value} | {left} |"


def sentences() -> list[str]:
    """Return the results that are one number each."""
    corner = PAGE.of(own_trial(CORNER))
    around = sum(not item.active[-1].any() for item in corner)
    seconds = float(np.mean([item.times[item.active.any(axis=1)][-1] for item in corner]))
    few = PAGE.of(own_trial(DOOR, half=0.5, count=3, routing=0.3))
    through = sum(len(crossing_times(item, 1.4)) == 3 for item in few)
    hall = dataclasses.replace(load_trial("bottleneck"), duration=180.0)
    count = 100
    stand = sum(stands(item) for item in Runs(count).of(hall))
    return [
        f"* 20 people go around a corner of a corridor 2 m wide in {around} of {SEEDS} runs within 60 s; the last"
        f" arrives after {seconds:.0f} s in the mean.",
        f"* Three people alone pass a door of 1 m in {through} of {SEEDS} runs.",
        f"* In the trial `bottleneck`, for 180 s, somebody moves less than {STANDS:g} m in {PATIENCE:g} s in {stand} of"
        f" {count} runs.",
    ]


def misses(rows: Mapping[str, Sequence[str]]) -> str:
    """Return the lines of the head of the page: what is beyond experiments, from the rows of the tables."""
    cells = {name: [[cell.strip() for cell in row.strip("|").split("|")] for row in own] for name, own in rows.items()}
    jams = [
        f"{last} of {SEEDS} at {density} people/m2 ({width} m wide)"
        for width, density, *_, last in cells["two"]
        if last != "0"
    ]
    away = [f"{gap} m/s at {density}" for density, *_, gap in cells["one"] if abs(float(gap)) > TOLERANCE]
    clogs = [f"{left} of {SEEDS} at {width} m" for width, _, left in cells["door"] if left != "0"]
    return "\n".join(
        [
            f"* Two-way flows jam: {', '.join(jams)}. People walk on.",
            f"* One-way crowds against Weidmann 1993: {', '.join(away)} people/m2.",
            f"* Crowds of {LEAVING} clog in doors: {', '.join(clogs)}.",
        ]
    )


ROWS: dict[str, Callable[..., str]] = {
    "one-way": one_way_row,
    "two-way": two_way_row,
    "file": file_row,
    "door": door_row,
}
"""Rows of the page, by the name on the command line: their numbers are those in front of the row."""


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
    return TEXT.format(
        seeds=SEEDS, last=LAST, people=LEAVING, misses=misses(rows), sentences="\n".join(sentences()), **tables
    )


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

What does not agree with experiments (runs of each row, from the tables below):

{misses}

[What was tried](#what-was-tried) has the causes.

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

## What was tried

Single runs show why; each change was measured on its own, with few seeds, and none is in the preset. Rows of values are
printed by `--row`, for example

```
python studies/trial_crowds.py --row two-way 4 2 --seeds 4 --seconds 45 --set headway_spacing=0.1
```

### Jams of two-way flows

By chance, people of one direction gather across the whole width; those who meet them close up, and a front with a plug
on each side of it grows from the tenth second on. After 25 s, a third of the people who stand touch somebody ahead who
walks the other way, and 58 % only people of their own direction (seed 1): who makes room has none to go to.
4 m, 2 people/m2, seeds 0 to 3, 45 s, mean speed of the last 20 s (a front is not full yet: with 90 s nearly all jam).

| change | speed [m/s], four seeds | mean |
|---|---|---|
| none | 0.08, 0.23, 0.69, 0.29 | 0.32 |
| more space between those who stand: `headway_spacing` 0.1 | 0.30, 0.31, 0.62, 0.32 | 0.39 |
| longer steps aside and back: `headway_sidestep` 1, `headway_step_back` 0.4 | 0.20, 0.19, 0.50, 0.39 | 0.32 |
| lanes: people turn to those ahead who walk their way, if six of the others are ahead | 0.12, 0.34, 0.35, 0.37 | 0.29 |
| who is slower than 0.3 m/s and meets somebody always steps to the right | 0.21, 0.32, 0.24, 0.40 | 0.29 |

People walk about 0.6 m/s at this density. The last two are changes of the model that are not kept. Space between those
who stand gains most, 0.07 m/s with four seeds, but changes every dense crowd. A lane that enters a plug needs room.
Bodies that are narrower ahead than a disc (0.25 m deep, with turns of the shoulders) may give it. This was not tried:
contacts of people are those of discs.

### Speed of one-way crowds

Dense crowds are too fast since the corridor ahead is narrow (0.55 sums of the radii, tapered): neighbours to the side
do not count. In thin crowds, the person ahead limits the speed, and a step past somebody who walks the same way is
shorter the less this person is aside. Speeds [m/s], seeds 0 to 3, 60 and 30 s; Weidmann: 1.34 and 0.61.

| change | 0.25 people/m2 | 2 people/m2 |
|---|---|---|
| none | 1.19 | 0.96 |
| longer time gap: `headway_time_gap` 2.1 | 1.18 | 0.78 |
| wider corridor ahead: `headway_width` 0.8 | 1.14 | 0.85 |
| space between those who stand: `headway_spacing` 0.1 | 1.18 | 0.90 |
| less anticipation, same gap: `headway_anticipation` 0.5, `headway_time_gap` 1.35 | 1.18 | 0.93 |
| people evade each other earlier: `range` 0.1 | 1.25 | 0.89 |

Recorded people (HERMES, in the [validation](validation.md)) do not walk as Weidmann's curve: 1.4 m/s at 0.5, 0.9 at
1.5, 0.6 to 0.7 at 2, and 0.3 to 0.6 at 3 people/m2. Against them, the crowds of this page are 0.3 m/s too slow at
0.5, and 0.2 and 0.1 m/s too fast at 2 and 3 people/m2. A time gap of 2.1 s halves the difference to Weidmann at 2
people/m2 and comes to 0.1 to 0.2 m/s above these recordings; a range of 0.1 m gains a third of the difference at 0.25
people/m2. They are not in the preset: they change every trial whose people meet, and with it the measured table of
[navigators](navigators.md). With the time gap, 4 seeds, single file of 1 person/m is 0.10 m/s too slow (without: 0.15
m/s too fast), and the flow of a door of 1 m is 1.58 instead of 1.97 /(m s), with 1.9 in experiments. The range was
chosen small for two-way flows. One time gap does not reach corridor and door together; a gap that grows with the
number of people abreast may.

### Doors of 0.8 m

Two people whose diameters together exceed the width arrive side by side: each is pushed away from the other, both step
back and return together, or they stand still in the door. Seed 1 leaves the last three behind, seed 10 the last two,
and seed 11 a pair in the door and all who wait behind it.
Seeds 10 to 19, 90 s; the 5 clogs without a change are the 6 of the table above less the one of seeds 0 to 9.

| change | not through, of 10 | flow [1/(m s)] |
|---|---|---|
| none | 5 | 1.58 (20 seeds) |
| of two who touch, one does not step back (model) | 4 | 1.60 |
| `headway_step_back` 0.4 | 4 | 1.54 |
| directions vary more: `heading-jitter` 0.02 (trial) | 3 | 1.55 |
| `wall_strength` 6 | 6 | 1.33 |
| paths around the corners at 0.2 instead of 0.3 m (trial) | 7 | 1.51 |

None ends the clogs. One of two people side by side would have to wait until the other is through, which needs a memory
of who goes first; the model has none.
"""


def main() -> None:
    """Write the page, or print one row."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, help="page")
    parser.add_argument("--row", nargs="+", help=f"name ({', '.join(ROWS)}) and numbers of a row to print")
    parser.add_argument("--seeds", type=int, default=SEEDS, help="seeds of the row (default: %(default)s)")
    parser.add_argument("--seconds", type=float, help="simulated time of the row [s]")
    parser.add_argument("--set", nargs="*", default=[], metavar="NAME=VALUE", help="values of the preset for the row")
    options = parser.parse_args()
    if (options.out is None) == (options.row is None):
        parser.error("give --out or --row")
    if options.out:
        options.out.write_text(page(), encoding="utf-8")
        return
    name, *numbers = options.row
    if name not in ROWS:
        parser.error(f"--row {name}: there is no such row; give one of {', '.join(ROWS)}")
    values = {key: float(value) for key, value in (item.split("=") for item in options.set)}
    print(ROWS[name](*map(float, numbers), runs=Runs(options.seeds, options.seconds, values)))


if __name__ == "__main__":
    main()
