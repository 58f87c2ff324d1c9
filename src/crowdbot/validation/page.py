"""Generator of the page ``validation.md`` with its table, descriptions and plots."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from crowdbot.measurement import LANE_BAND

from . import bottleneck, corridor, lanes, single_file
from .plots import PLOTS, draw
from .recording import METHODS
from .run import Validation
from .scenario import RADIUS, SOURCES, SPECIFIC_FLOW, STEP
from .section import METHOD
from .tables import (
    ability_table,
    case_table,
    deficiencies,
    jams,
    model_table,
    preset_table,
    replace_incomplete,
    steady_table,
    time_step_table,
)

STEADY = (
    "Steady state: of the mean forward speed of each start, found by the modified CUSUM method (Liao et al. 2016) with"
    " the last third of the run as reference; a start without one is measured in its last third"
)
DEFINITIONS = {
    "single-file": f"People of radius {RADIUS} m, all with a free speed of 1.34 m/s (RiMEA test 4 requires equal"
    f" speeds), walk along a periodic track of {single_file.LENGTH:g} m between walls {single_file.WIDTH} m apart."
    f" Density: people per metre of track. Speed: mean forward speed in the steady state of runs of"
    f" {single_file.SECONDS:g} s from rest, with 95 % bootstrap intervals over starts. {STEADY}",
    "corridor": f"A periodic track of {corridor.LENGTH:g} m, {corridor.WIDTH:g} m wide, runs of {corridor.SECONDS:g} s"
    f" at densities of {', '.join(f'{d:g}' for d in corridor.DENSITIES)} people/m2, measured every {corridor.EVERY:g} s"
    f" in the steady state. {METHOD}, with 95 % bootstrap intervals over starts. {STEADY}",
    "lanes": f"A periodic track of {lanes.LENGTH:g} m, {lanes.WIDE:g} m wide, with 1 person/m2, half of them in each"
    f" direction; free speeds are 1.34 +- 0.26 m/s; mean over starts in the last {lanes.LAST:g} of {lanes.SECONDS:g} s."
    " Lane order: for each person"
    f" i with m others at a lateral distance below {LANE_BAND} m, phi_i = (like - unlike)^2 / m^2. With the mean of"
    " phi and its expectation for randomly permuted directions, the lane order is (mean - expectation) / (1 -"
    " expectation): 0 for random directions, 1 for perfect lanes.",
    "narrow": f"As above, {lanes.NARROW_WIDTH:g} m wide, at several densities. Speed:"
    f" mean speed in the walking direction over the last {lanes.NARROW_LAST:g} of {lanes.NARROW_SECONDS:g} s.",
    "bottleneck": f"{bottleneck.PEOPLE} people in a room {2 * bottleneck.HALF:g} m wide walk through an opening that is"
    f" {bottleneck.LENGTH} m long. The goal of each person is the nearest point of the"
    " opening where a body fits. Flow: (n - 1) / (t_n - t_1) for the n crossings of the middle line of the opening"
    " without the first and last sixth; if somebody does not pass, all crossings count, up to the time limit of"
    f" {bottleneck.SECONDS:g} s. Specific flow: flow / width (in the table: mean over widths).",
}

RESULTS = "https://github.com/crowdbot/crowdbot/blob/main/docs/results"
"""Address of the other pages of results, which are not beside a page that a user writes."""
AROUND_A_ROBOT = (
    f"The experiments and tests of this page have no robot. [People around robots]({RESULTS}/around-robots.md) compares"
    " how people of each model evade a robot, and how near they come to it, with recorded people around a golf cart. Of"
    f" the models here, the preset `people` alone keeps a gap to robots by default. [Crowds in trials]({RESULTS}/"
    "trial-crowds.md) measures the preset in longer corridors and doors of trials, with the bodies of their people."
)


def write_page(done: Validation, out: Path, command: str) -> Path:
    """Write ``validation.md`` and its plots in the folder ``validation`` beside it; return the page.

    Args:
        done: results.
        out: output folder, created if missing.
        command: command that generates the page.
    """
    folder = out / "validation"
    folder.mkdir(parents=True, exist_ok=True)
    draw(done, folder)
    shown = replace_incomplete(done)
    text = "\n".join(
        [
            *_head(done, command),
            *model_table(shown),
            *ability_table(shown),
            *deficiencies(shown),
            *jams(shown),
            *_sections(done),
            *steady_table(shown),
            *case_table(shown),
            *time_step_table(shown),
            *preset_table(shown),
            "## Around a robot",
            "",
            AROUND_A_ROBOT,
            "",
            *_foot(done),
        ]
    )
    page = out / "validation.md"
    draft = page.with_suffix(".part")
    draft.write_text(text.rstrip() + "\n", encoding="utf-8")
    os.replace(draft, page)
    return page


def _head(done: Validation, command: str) -> list[str]:
    return [
        "# Validation of the crowd models",
        "",
        "Comparison of the crowd models, with default parameters, with experiments and with verification tests of RiMEA"
        " and ISO 20414. Most models were designed for steering, not for dense crowds. This page is generated by:",
        "",
        "```",
        command,
        "```",
        "",
        *(["**Quick runs with few people and short times. The verdicts mean little.**", ""] if done.quick else []),
        f"Bodies are discs of radius {RADIUS} m. The time step is {STEP} s, in substeps for models that are made for"
        " shorter ones (table below). Values in brackets are 95 % bootstrap intervals over starts. All models start"
        " from the same initial states, and results are reproducible. Every start is stored in the JSON file of its"
        " model beside the plots; the same command computes the starts that are missing or whose code has changed.",
        "",
        "Crowds are chaotic: rounding errors can decide whether a single run jams. Two implementations of ORCA that"
        " agree to 1e-16 m/s per step had 4 and 5 jams of 12, and 1.8 and 1.5 in one start of RiMEA 9. This is why"
        " each point has several starts.",
        "",
        *(
            [
                "RECORDINGS is a folder with the files named below, from the archive of Forschungszentrum Jülich.",
                "",
            ]
            if done.people
            else []
        ),
    ]


def _sections(done: Validation) -> list[str]:
    lines: list[str] = []
    for name, (title, *_) in PLOTS.items():
        lines += [f"## {title}", "", DEFINITIONS[name], ""]
        if done.people and name in METHODS:
            lines += [f"People: {METHODS[name]}.", ""]
        lines += [*_recording_table(done.people, name), f"![{title}](validation/{name}.png)", ""]
    return lines


def _recording_table(people: dict[str, Any] | None, name: str) -> Iterable[str]:
    found = (people or {}).get(name)
    if name == "lanes" and found:
        yield from ("| recording | order | people/m2 | median speed [m/s] |", "|---|---|---|---|")
        for file, run in found.items():
            yield f"| {file} | {run['mean']:.2f} | {run['density']:.2f} | {run['speed']:.2f} |"
        yield ""
    if name == "bottleneck" and found:
        yield from (
            "| recording | width [m] | people | flow [1/s] | specific flow [1/(m s)] |",
            "|---|---|---|---|---|",
        )
        for d in found:
            yield (
                f"| {d['file']} ({d['who']}) | {d['width']} | {d['people']} | {d['flow']:.2f} |"
                f" {d['flow'] / d['width']:.2f} |"
            )
        yield ""
        yield f"Seyfried et al. 2009 report {SPECIFIC_FLOW} /(m s). Pupils are smaller and have a higher flow."
        yield ""


def _foot(done: Validation) -> list[str]:
    lines = ["## Sources", "", *(f"* {source}." for source in SOURCES), ""]
    if done.people is None:
        lines += ["Without recordings (`--data`), the page compares with published curves only.", ""]
    elif done.people["missing"]:
        lines += [f"Missing recordings: {', '.join(done.people['missing'])}.", ""]
    return lines
