"""Draw every built-in trial: its stage, its people at the beginning, and the ways of a run.

    python tools/trial_pictures.py docs/gallery/trials

writes one small picture per trial into the folder, and beside it the page that lists them with their parameters.
``--missing`` draws only the pictures that the folder does not have.
"""

from __future__ import annotations

import argparse
import io
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import kebab_case
from crowdbot.recording import run
from crowdbot.simulation import Episode
from crowdbot.trials import PRESETS, Crowds, Trial, builtin_trials, load_trial, parse_trial, trial_xml

SECONDS = 20.0
PIXELS, DPI = 320, 100
PERSON, ROBOT, WALL, FLOOR = "#3b6ea5", "#d1495b", "#2b2b2b", "#f6f5f1"


def main() -> int:
    """Draw those that are named, or all, and write the page."""
    import matplotlib

    matplotlib.use("Agg")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--missing", action="store_true", help="draw only pictures that are not there")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    for name in options.names or builtin_trials():
        file = options.folder / f"{name}.png"
        if not (options.missing and file.exists()):
            draw(load_trial(name), file)
            print(name)
    page(options.folder.with_suffix(".md"))
    return 0


def draw(trial: Trial, file: Path) -> None:
    """Draw one trial."""
    import matplotlib.pyplot as plt
    from PIL import Image

    short = trial_xml(trial)
    if trial.duration > SECONDS:
        short = re.sub(r'duration="[^"]*"', f'duration="{SECONDS:g}"', short, count=1)
    episode = run(parse_trial(short))
    low, high = extent(trial, episode)
    size = high - low
    width = PIXELS / DPI
    figure = plt.figure(figsize=(width, max(0.7, width * size[1] / size[0])), dpi=DPI)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", facecolor=FLOOR)
    axes.set_axis_off()
    figure.patch.set_facecolor(FLOOR)
    ground(axes, trial)
    ways(axes, episode)
    people(axes, episode)
    whole = io.BytesIO()
    figure.savefig(whole, metadata={"Software": None})
    plt.close(figure)
    whole.seek(0)
    Image.open(whole).convert("RGB").quantize(48).save(file, optimize=True)


def extent(trial: Trial, episode: Episode) -> tuple[Any, Any]:
    """Return the corners of what is drawn."""
    points = [episode.position[0, episode.active[0]]]
    points += [np.array([robot.goal.position]) for robot in trial.robots]
    points += [np.asarray(ring) for ring in trial.stage.rings]
    points += [np.asarray(source.zone) for source in trial.sources]
    whole = np.concatenate([np.asarray(point).reshape(-1, 2) for point in points])
    low, high = whole.min(axis=0) - 0.6, whole.max(axis=0) + 0.6
    middle, size = (low + high) / 2.0, np.maximum(high - low, (high - low).max() / 3.5)
    return middle - size / 2.0, middle + size / 2.0


def ground(axes: Any, trial: Trial) -> None:
    """Draw walls and obstacles."""
    for ring in trial.stage.rings:
        closed = np.vstack([ring, ring[:1]])
        axes.plot(*closed.T, color=WALL, linewidth=1.6, solid_capstyle="round")
    for obstacle in trial.stage.obstacles:
        axes.fill(*np.array(obstacle.points).T, color=WALL)
    for portal in trial.portals:
        axes.fill(*np.array(portal.zone).T, color="#e3dfd2", zorder=0)
    for source in trial.sources:
        axes.fill(*np.array(source.zone).T, color="#d3dfec", zorder=0)


def ways(axes: Any, episode: Episode) -> None:
    """Draw where everybody went, where they did not jump."""
    for agent in range(len(episode.ids)):
        here = episode.active[:, agent]
        way = np.where(here[:, None], episode.position[:, agent], np.nan)
        own = agent in episode.robots
        axes.plot(*way.T, color=ROBOT if own else PERSON, linewidth=1.4 if own else 0.6, alpha=0.9 if own else 0.3)


def people(axes: Any, episode: Episode) -> None:
    """Draw bodies at the beginning, and the goals of robots."""
    from matplotlib.patches import Circle

    for agent in np.flatnonzero(episode.active[0]):
        x, y = episode.position[0, agent]
        own = int(agent) in episode.robots
        radius = max(episode.radius[agent], 0.008 * np.ptp(axes.get_xlim()))
        axes.add_patch(Circle((x, y), radius, facecolor=ROBOT if own else PERSON, edgecolor="none", zorder=3))
        ahead = 1.6 * radius * np.array([np.cos(episode.heading[0, agent]), np.sin(episode.heading[0, agent])])
        axes.plot([x, x + ahead[0]], [y, y + ahead[1]], color=ROBOT if own else PERSON, linewidth=1.2, zorder=3)
    for robot in episode.trial.robots:
        axes.plot(*robot.goal.position, marker="x", markersize=6, color=ROBOT, markeredgewidth=1.8, zorder=4)


def page(file: Path) -> None:
    """Write the page that lists all."""
    lines = [
        "---",
        "hide: [toc]",
        "---",
        "",
        "# Built-in trials",
        "",
        "Each picture shows people (blue) and the robot (red) at the start, the paths of the first 20 s, and the goal",
        "of the robot (x). Blue zones are sources; other shaded zones are portals: people who enter one continue at",
        "the other. `python tools/trial_pictures.py docs/gallery/trials` makes the pictures and this page.",
        "",
        "Run a trial with `crowdbot run NAME`, change its parameters with `--set NAME=VALUE`, and list them with",
        "`crowdbot list trials NAME`. The last column gives the names of other simulators and the parameters",
        "with which the trial equals theirs. CrowdNav, social-jym, UMANS, SEAN and RVO2 are simulators; the",
        "[scenarios of Francis et al.](#scenarios-of-francis-et-al) have cards.",
        "",
        "Trials that reproduce a benchmark or the CrowdBot challenge keep its crowd model, `orca`; in others, people",
        "walk by the preset `people`. `--set model=orca` gives the crowd that these trials had before; for",
        "`crossing-flows`, add `--set crowd/time-horizon-walls=1`.",
        "",
        "| trial | picture | crowd model | parameters | also known as |",
        "|---|---|---|---|---|",
    ]
    for name in builtin_trials():
        preset = PRESETS.get(name)
        trial = load_trial(name)
        crowd = ", ".join(f"`{kebab_case(type(item.model).__name__)}`" for item in Crowds.spread(trial.crowd))
        options = "" if preset is None else "<br>".join(f"`{key}` {option}" for key, option in preset.own.items())
        also = "" if preset is None else preset.also.replace("; ", "<br>")
        lines.append(f"| **{name}**<br>{trial.about} | ![{name}](trials/{name}.png) | {crowd} | {options} | {also} |")
    lines += scenarios()
    lines += [
        "",
        "## Trials from recordings",
        "",
        'Trials with recorded people are not built in. `<recorded data="..." exclude="...">` replays any recording,',
        "with one person replaced by the robot (as in SocNavBench and the evaluation of RDS);",
        'with `mode="reactive"`, people near the robot react to it.',
        "[Start from an existing trial](../how-to/trial.md#from-a-recording) shows how.",
        "",
        "## A long trial",
        "",
        "[thousand.xml](trials/thousand.xml) is not built in: a thousand people walk both ways for ten minutes, with a",
        "robot among them, in a corridor of 100 m by 20 m that wraps around.",
        "`crowdbot run docs/gallery/trials/thousand.xml --out DIR` runs and records it with a progress bar;",
        "`python tools/long_trial.py DIR` prints its speed against real time, and the memory at quarters of the run.",
    ]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def scenarios() -> list[str]:
    """Return the lines of the section with the cards of scenarios."""
    lines = [
        "",
        "## Scenarios of Francis et al.",
        "",
        "Names are those of Table 3 and Figure 7 of Francis et al. 2025, Principles and guidelines for evaluating",
        "social robot navigation algorithms (doi:10.1145/3700599); geometry, numbers and texts are our own.",
        "`crowdbot list scenarios` prints them, `crowdbot list trials NAME` the card of a trial.",
        "[Metrics](../reference/metrics.md) has the names of their metrics.",
        "",
        "| scenario | trial | setup | intended behaviour of the robot | success | metrics of quality | not shown |",
        "|---|---|---|---|---|---|---|",
    ]
    rows = {
        card.name: [f"`{card.command(name)}`", card.setup, card.robot, card.success,
                    ", ".join(f"`{metric}`" for metric in card.metrics), card.lacks]
        for name, preset in PRESETS.items()
        for card in preset.cards
    }  # fmt: skip
    return [*lines, *(f"| **{name}** | {' | '.join(cells)} |" for name, cells in sorted(rows.items()))]


if __name__ == "__main__":
    sys.exit(main())
