"""Page: ``validation.md`` with its table, its plain words and its plots."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from . import bottleneck, corridor, lanes, single_file
from .literature import SOURCES, SPECIFIC_FLOW
from .plots import PLOTS, draw
from .recording import METHODS
from .rimea import NOT_APPLICABLE
from .run import CHECKS, Validation
from .scenario import RADIUS, STEP

__all__ = ["write_page"]

DEFINITIONS = {
    "single-file": f"People of radius {RADIUS} m, all of free speed 1.34 m/s (RiMEA test 4 asks for equal ones), walk"
    f" round a straight track of {single_file.LENGTH:g} m between walls {single_file.WIDTH} m apart; its"
    " end is its beginning. Density: people per metre of track. Speed: mean over people of the way forward in"
    f" {single_file.MEASURED:g} s, after {single_file.WARM:g} s from standing.",
    "corridor": f"A closed track of {corridor.LENGTH:g} m, {corridor.WIDTH:g} m wide. Density: people per square metre"
    f" of the whole floor. Speed: mean over people of the way forward in {corridor.MEASURED:g} s, after"
    f" {corridor.WARM:g} s.",
    "lanes": f"A closed track of {lanes.LENGTH:g} m, {lanes.WIDE:g} m wide, 1 person/m2, half of them each way, free"
    f" speeds 1.34 +- 0.26 m/s, mean of {lanes.SEEDS} starts. Order: for each person i with m others whose lateral"
    f" distance is below {lanes.BAND} m, phi_i = (like - unlike)^2 / m^2; the mean of phi, less what dealing out the"
    " same directions at random would give, over one less the same: 0 is chance, 1 is pure lanes.",
    "narrow": f"As above, {lanes.NARROW_WIDTH:g} m wide, {lanes.NARROW_SEEDS} starts at each density. Speed: mean over"
    f" people of the way in their own direction in the last {lanes.NARROW_LAST:g} of {lanes.NARROW_SECONDS:g} s.",
    "bottleneck": f"{bottleneck.PEOPLE} people in a room {2 * bottleneck.HALF:g} m wide walk through an opening that is"
    f" {bottleneck.LENGTH} m long; everyone heads for the nearest point of it where a body fits. Flow: (n - 1) / (t_n -"
    " t_1) of the crossings of its middle line, n who passed; t_n is the time limit of"
    f" {bottleneck.SECONDS:g} s when somebody is left behind. Specific flow: flow / width (in the table: mean over"
    " widths).",
}


def write_page(done: Validation, out: Path, command: str) -> Path:
    """Write ``validation.md`` and, in the folder ``validation`` beside it, its plots; return the page.

    Args:
        done: what the page tells.
        out: folder of the page, made when missing.
        command: the words that made it.
    """
    folder = out / "validation"
    folder.mkdir(parents=True, exist_ok=True)
    draw(done, folder)
    text = "\n".join(
        [
            *_head(done, command),
            *_table(done),
            *_words(done),
            *_jams(done),
            *_sections(done),
            *_rimea(),
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
        "How the models of crowdbot walk with their default parameters, against experiments with people and the"
        " verification tests of the RiMEA guideline. A model that fails a test here is not wrong everywhere: most were"
        " made for steering, not for crowds, and none was fitted to these tests. The page is generated:",
        "",
        "```",
        command,
        "```",
        "",
        *(["**Quick runs: few people, short times. The verdicts mean little.**", ""] if done.quick else []),
        f"Bodies are discs of radius {RADIUS} m, the time step is {STEP} s, all models meet the same crowds, and the"
        " same seed gives the same numbers. On closed tracks everyone has a copy one length away that the others see"
        " like anybody else. All numbers lie beside the plots, one JSON file a model.",
        "",
        "Crowds are chaotic: a rounding error decides whether a single run jams. Two programs of ORCA whose steps agree"
        " to 1e-16 m/s got 4 and 5 jams of 12 and 1.8 and 1.5 in RiMEA 9: read differences of that size as none.",
        "",
        *(
            [
                "RECORDINGS is a folder with the files that are named below, of the archive of Forschungszentrum"
                " Jülich.",
                "",
            ]
            if done.people
            else []
        ),
    ]


def _table(done: Validation) -> list[str]:
    titles = [check.title for check in CHECKS]
    lines = [
        "## Model by test",
        "",
        "✓ the criterion below holds, ✗ it does not. Overlap: how deep two bodies get into each other in any of these"
        " tests, of 0.40 m. Seconds: of computing, for the whole row.",
        "",
        f"| model | {' | '.join(titles)} | passed | overlap [m] | seconds |",
        "|---" * (len(titles) + 4) + "|",
    ]
    for model, checks in done.outcomes.items():
        cells = [
            f"{'✓' if checks[c.name].verdict.passed else '✗'} {_cell(checks[c.name].verdict.value)}" for c in CHECKS
        ]
        passed = sum(checks[c.name].verdict.passed for c in CHECKS)
        overlap = max((one.result.get("overlap", 0.0) for one in checks.values()), default=0.0)
        seconds = sum(one.seconds for one in checks.values())
        lines.append(f"| {model} | {' | '.join(cells)} | {passed} of {len(CHECKS)} | {overlap:.2f} | {seconds:.0f} |")
    if done.people:
        cells = [_cell(_people(done.people, check.name)) for check in CHECKS]
        lines.append(f"| *people* | {' | '.join(cells)} | | | |")
    total = sum(one.seconds for checks in done.outcomes.values() for one in checks.values())
    lines += ["", f"All together took {total:.0f} s ({_environment()}).", ""]
    if done.skipped:
        lines += ["Not run:", "", *(f"* {name}: {why}." for name, why in done.skipped.items()), ""]
    lines += ["The criteria:", "", *(f"* **{check.title}**: {check.criterion}." for check in CHECKS), ""]
    return lines


def _cell(text: str) -> str:
    return text.replace("|", "/")


def _people(people: dict[str, Any], name: str) -> str:
    """Return what real people would have in a cell, where it was measured."""
    found = people.get(name)
    if not found:
        return ""
    if name in ("single-file", "corridor"):
        return f"{found['distance']:.2f} m/s"
    if name == "lanes":
        return f"{np.mean([run['mean'] for run in found.values()]):.2f}, " + (
            f"{np.mean([run['speed'] for run in found.values()]):.2f} m/s"
        )
    if name == "bottleneck":
        return f"{np.mean([door['flow'] / door['width'] for door in found]):.2f} /(m s)"
    return ""


def _words(done: Validation) -> list[str]:
    lines = ["## What each model does badly", ""]
    for model, checks in done.outcomes.items():
        words = [one.verdict.words for one in checks.values() if one.verdict.words]
        overlap = max((one.result.get("overlap", 0.0) for one in checks.values()), default=0.0)
        if overlap > 0.1:
            words.append(f"bodies get {overlap:.2f} m into each other")
        same = _same(done, model)
        if same:
            words.append(f"walks exactly like {same} in all of these tests, whose goals are far away")
        lines.append(f"* **{model}**: {'; '.join(words) or 'nothing that these tests find'}.")
    return [*lines, ""]


def _same(done: Validation, model: str) -> str:
    """Return the first other model with the very same numbers in all checks, if any."""
    own = {name: one.result for name, one in done.outcomes[model].items()}
    others = (
        m for m, checks in done.outcomes.items() if m != model and own == {n: c.result for n, c in checks.items()}
    )
    return next(others, "")


def _jams(done: Validation) -> list[str]:
    def named(name: str, wrong: Any) -> str:
        models = [m for m, c in done.outcomes.items() if "failed" not in c[name].result and wrong(c[name].result)]
        return ", ".join(models) or "none"

    def jam(result: dict[str, Any]) -> bool:
        return bool(np.any(np.asarray(result["speeds"]) < lanes.JAM * 1.34))

    def low(result: dict[str, Any]) -> bool:
        speeds = np.asarray(result["speeds"])[np.asarray(result["density"]) <= 1.0]
        return bool(np.any(speeds < lanes.JAM * 1.34))

    def clogs(result: dict[str, Any]) -> bool:
        return bool(np.any(np.asarray(result["passed"]) < result["people"]))

    def careless(result: dict[str, Any]) -> bool:
        return bool(result["speed"][int(np.argmin(np.abs(np.asarray(result["density"]) - 3.0)))] > 0.7 * 1.34)

    return [
        "## Which models jam, and which never slow down",
        "",
        f"* Jams in a two-way corridor 2 m wide at up to 2 people/m2: {named('narrow', jam)}.",
        f"* Of these, already at 1 person/m2 or less: {named('narrow', low)}.",
        f"* A crowd of {bottleneck.PEOPLE} clogs at least one bottleneck: {named('bottleneck', clogs)}.",
        "* No fundamental diagram: a one-way crowd of 3 people/m2 walks with more than 70 % of its free speed (nobody"
        " is on a course to collide, and pushes from ahead and from behind cancel):"
        f" {named('corridor', careless)}.",
        "",
    ]


def _sections(done: Validation) -> list[str]:
    lines: list[str] = []
    for name, (title, *_) in PLOTS.items():
        lines += [f"## {title}", "", DEFINITIONS[name], ""]
        if done.people and name in METHODS:
            lines += [f"People: {METHODS[name]}.", ""]
        lines += [*_recorded(done.people, name), f"![{title}](validation/{name}.png)", ""]
    return lines


def _recorded(people: dict[str, Any] | None, name: str) -> Iterable[str]:
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
        yield f"Seyfried et al. 2009 give {SPECIFIC_FLOW} /(m s). Pupils are small, and go faster through a door."
        yield ""


def _rimea() -> list[str]:
    return [
        "## RiMEA tests that do not apply",
        "",
        "Tests 1, 6, 7, 9, 12 and 15 are run, 4 is the two fundamental diagrams. The guideline itself says that 9 and"
        " 12 document how a model behaves and exclude none. Way points around corners and to doors are given to the"
        " models as goals. The others:",
        "",
        *(f"* {number}: {why}." for number, why in NOT_APPLICABLE.items()),
        "",
    ]


def _foot(done: Validation) -> list[str]:
    lines = ["## Sources", "", *(f"* {source}." for source in SOURCES), ""]
    if done.people is None:
        lines += ["No recordings were given (`--data`): the page compares with published curves only.", ""]
    elif done.people["missing"]:
        lines += [f"Recordings that were not found: {', '.join(done.people['missing'])}.", ""]
    return lines


def _environment() -> str:
    from importlib.metadata import version

    import numba

    return (
        f"{os.cpu_count()} cores, Python {platform.python_version()}, numpy {np.__version__},"
        f" numba {numba.__version__}, crowdbot {version('crowdbot')}"
    )
