"""Write every generated file that tests compare: ``python tools/fix.py [STEP ...]``.

A step writes one kind of file: pages and tables of the documentation, the schema, published values, digests, the page
of the app, numbers and versions in texts, style and format. All steps together take about a minute. A step that fails
does not stop the others. ``--check`` leaves the tree as it was and fails if a file would change; ``--list`` names the
steps.

Kept results are protected: digests of the built-in trials and the golden files of models, searches and state frames are
written only where they are missing. To change one on purpose, delete the file first, and name the change in the commit.
In the same way the step ``constraints`` adds packages and does not change a version; ``tools/pin.py`` writes all.

Pages whose numbers need recordings or hours are not part of it (``--list`` names their commands).
"""

from __future__ import annotations

import argparse
import functools
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[1]
CODE = ("src", "studies", "tests", "tools")
LONG = {
    "docs/results/around-robots.md": "python studies/around_robots.py --data RECORDINGS --sets FILE --out FILE",
    "docs/results/calibrated-crowds.md": "python studies/schemes.py SHARED docs/results",
    "docs/results/contacts.md": "crowdbot validate --contacts --starts 20 --out docs/results",
    "docs/results/energy.md": "python studies/measure_energy.py --data RECORDINGS --out docs/results/energy.md",
    "docs/results/measured.md": "python studies/measured.py SHARED > docs/results/measured.md",
    "docs/results/people.md": "python studies/predict_people.py --data RECORDINGS --out docs/results/people.md",
    "docs/results/people-values.md": "python studies/fit_people.py --data RECORDINGS --state FILE --profiles FILE",
    "docs/results/trial-crowds.md": "python studies/trial_crowds.py --out docs/results/trial-crowds.md",
    "docs/results/validation.md": "crowdbot validate --data RECORDINGS --out docs/results",
}
"""Generated pages that no step writes, with their commands."""


class StepFailure(Exception):
    """A step did not do its work; the text says why."""


class LeftOut(Exception):
    """A step cannot work here and need not; the text says what it lacks."""


@dataclass(frozen=True)
class Step:
    """One kind of generated file.

    Attributes:
        name: as the command line names it.
        about: what it writes, in a few words.
        writes: patterns of the files that it may change.
        action: writes them.
    """

    name: str
    about: str
    writes: tuple[str, ...]
    action: Callable[[], None]


@dataclass
class Outcome:
    """What a step did: ``state`` is ``done``, ``left out`` or ``FAILED``, ``about`` the reason."""

    name: str
    state: str = "done"
    about: str = ""
    seconds: float = 0.0
    files: list[str] = field(default_factory=list)

    def lines(self, check: bool) -> list[str]:
        """Return what is printed behind the name of the step."""
        if self.state == "done":
            verb = "would change" if check else "changed"
            told = f"{verb} {len(self.files)}" if self.files else "nothing to change"
        else:
            told = f"{self.state}: {self.about}"
        return [f"{self.seconds:6.1f} s  {told}", *(f"    {name}" for name in self.files)]


def command(*words: str, out: str = "") -> None:
    """Run Python with these words; its output becomes the text of the file ``out``, if one is named."""
    paths = os.pathsep.join([str(ROOT / "src"), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, "PYTHONPATH": paths}
    done = subprocess.run([sys.executable, *words], cwd=ROOT, env=environment, capture_output=True, check=False)
    if done.returncode:
        told = (done.stdout + done.stderr).decode(errors="replace").strip().splitlines()
        raise StepFailure("\n".join([f"exit status {done.returncode} of python {' '.join(words)}", *told[-12:]]))
    if out:
        (ROOT / out).write_bytes(done.stdout)


def write_if_missing(file: str, *words: str) -> None:
    """Run a command that writes a file of kept results, if the file is missing."""
    if not (ROOT / file).exists():
        command(*words)


def replace_once(file: str, pattern: str, text: str) -> None:
    """Replace the only match of a pattern in a file."""
    before = (ROOT / file).read_text(encoding="utf-8")
    after, count = re.subn(pattern, lambda match: text, before, flags=re.M)
    if count != 1:
        raise StepFailure(f"{file} has {count} places of the form {pattern}, one is needed")
    if after != before:
        (ROOT / file).write_text(after, encoding="utf-8")


def write_versions() -> None:
    """Write the version of the package into the files that repeat it."""
    text = (ROOT / "src/crowdbot/__init__.py").read_text(encoding="utf-8")
    match = re.search(r'^__version__ = "(.+)"$', text, flags=re.M)
    if match is None:
        raise StepFailure("src/crowdbot/__init__.py has no line __version__")
    replace_once("pyproject.toml", r'^version = ".*"$', f'version = "{match[1]}"')
    replace_once("CITATION.cff", r"^version: .*$", f"version: {match[1]}")
    replace_once(".zenodo.json", r'"version": ".*?"', f'"version": "{match[1]}"')


def add_constraints() -> None:
    """Add the installed packages that the file of tested versions lacks."""
    from importlib.metadata import PackageNotFoundError

    import pin

    try:
        installed = pin.pinned()
    except PackageNotFoundError as error:
        raise StepFailure(f'{error.name} is not installed: pip install -c constraints.txt -e ".[dev]"') from None
    file = ROOT / "constraints.txt"
    head, *lines = file.read_text(encoding="utf-8").splitlines()
    known = installed | dict(line.split("==") for line in lines)
    text = "\n".join([head, *(f"{name}=={known[name]}" for name in sorted(known))]) + "\n"
    if text != file.read_text(encoding="utf-8"):
        file.write_text(text, encoding="utf-8")


def build_page() -> None:
    """Bundle the page of the app, if its libraries are installed."""
    if not (ROOT / "frontend/node_modules/esbuild").is_dir():
        raise LeftOut("the libraries of the page are not installed: cd frontend && npm ci")
    done = subprocess.run(["node", "build.mjs"], cwd=ROOT / "frontend", capture_output=True, text=True, check=False)
    if done.returncode:
        raise StepFailure(done.stderr.strip())


def write_readings() -> None:
    """Write the message types of sensor readings into the page on recordings."""
    from crowdbot.messages import reading_table

    replace_once("docs/reference/recording.md", r"^\| reading \| sensor \|.*\n(?:\|.*\n)+", reading_table())


def files_with_inputs() -> list[str]:
    """Return the test files that may ask for recordings or robot files: they, or a helper beside them, name these."""
    words = re.compile(r"\b(recordings|urdf)\b")
    texts = {path: path.read_text(encoding="utf-8") for path in sorted((ROOT / "tests").glob("*/**/*.py"))}
    naming = [path for path, text in texts.items() if words.search(text)]
    folders = {path.parent for path in naming if not path.name.startswith("test_")}
    files = [path for path in texts if path.name.startswith("test_") and (path in naming or path.parent in folders)]
    return [path.relative_to(ROOT).as_posix() for path in files]


def count_inputs() -> None:
    """Write into tests/RECORDINGS.md how many tests of the gate a machine without recordings leaves out."""
    words = ["-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider", *files_with_inputs()]
    with tempfile.TemporaryDirectory() as empty:
        environment = {name: value for name, value in os.environ.items() if name not in ("CI", "PYTEST_ADDOPTS")}
        paths = os.pathsep.join([str(ROOT / "src"), *filter(None, [os.environ.get("PYTHONPATH")])])
        environment |= {"CROWDBOT_SHARED": empty, "PYTHONPATH": paths}
        done = subprocess.run(
            [sys.executable, *words], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
        )
    needs = "recordings that cannot ship", "robot files that cannot ship"
    found = [re.search(rf"(\d+) need {need}", done.stdout) for need in needs]
    if done.returncode or not all(found):
        raise StepFailure("the tests cannot be counted:\n" + "\n".join((done.stdout + done.stderr).splitlines()[-12:]))
    counts = [int(one[1]) for one in found if one]
    text = ", ".join(f"{count} need {need}" for count, need in zip(counts, needs, strict=True))
    replace_once(
        "tests/RECORDINGS.md",
        r"^\d+ tests left out: .*$",
        f"{sum(counts)} tests left out: {text} (see tests/RECORDINGS.md)",
    )


def page_step(name: str, about: str, file: str, *words: str) -> Step:
    """Return the step that prints one page."""
    return Step(name, about, (file,), functools.partial(command, *words, out=file))


def result_step(name: str, about: str, file: str, *words: str) -> Step:
    """Return the step that writes a file of kept results if it is missing."""
    return Step(name, about, (file,), functools.partial(write_if_missing, file, *words))


ALL_CODE = tuple(f"{folder}/**/*.py" for folder in CODE)
INTERFACE = "docs/reference/robot-interface.md"
SCHEMA = "src/crowdbot/assets/trial.xsd"
METRICS = "docs/reference/metrics.md"
STATES = "tests/models/golden/jupedsim_states.npz"
STEPS = (
    Step("versions", "the version of the package in CITATION.cff, .zenodo.json and pyproject.toml",
         ("pyproject.toml", "CITATION.cff", ".zenodo.json"), write_versions),
    Step("constraints", "packages that constraints.txt lacks", ("constraints.txt",), add_constraints),
    Step("schema", "schema of trial files", (SCHEMA,),
         functools.partial(command, "-m", "crowdbot", "new", "schema", SCHEMA, "--force")),
    page_step("crowd-models", "reference of crowd models", "docs/reference/crowd-models.md", "tools/models.py"),
    page_step("robot-interface", "topics and services of a trial", INTERFACE, "tools/robot_interface.py"),
    Step("readings", "message types of sensor readings", ("docs/reference/recording.md",), write_readings),
    page_step("metrics", "reference of metrics", METRICS,
              "-c", "from crowdbot.metrics import metric_page; print(metric_page(), end='')"),
    Step("navigators", "page of navigators, from the rows that it has", ("docs/results/navigators.md",),
         functools.partial(command, "studies/navigators.py", "--layout")),
    Step("gallery", "page of built-in trials, and pictures that it lacks",
         ("docs/gallery/trials.md", "docs/gallery/trials/*.png"),
         functools.partial(command, "tools/trial_pictures.py", "docs/gallery/trials", "--missing")),
    Step("published-values", "defaults, ranges, presets and built-in trials", ("tests/*/published_values.json",),
         functools.partial(command, "tests/published_values.py")),
    Step("digests", "missing digests of built-in trials", ("tests/simulation/builtin_digests.json",),
         functools.partial(command, "tests/builtin_digests.py")),
    result_step("golden-models", "steps of crowd models", "tests/models/golden/steps.npz", "tools/golden_models.py"),
    result_step("golden-jupedsim", "steps with states of JuPedSim", STATES, "tools/jupedsim_states.py"),
    result_step("golden-searches", "results of searches", "tests/calibration/golden/searches.npz",
                "tests/calibration/golden_searches.py"),
    result_step("golden-frame", "bytes of a state frame", "tests/web/state_frame.bin", "tests/web/golden_frame.py"),
    Step("first-trial", "beginning of the first trial of the app", ("src/crowdbot/assets/app/first-trial.xz",),
         functools.partial(command, "tools/first_trial.py")),
    Step("page", "bundle of the page of the app", ("src/crowdbot/assets/web/*",), build_page),
    Step("lint", "faults of style that ruff can correct", ALL_CODE,
         functools.partial(command, "-m", "ruff", "check", "--quiet", "--fix", *CODE)),
    Step("format", "format of the code", ALL_CODE,
         functools.partial(command, "-m", "ruff", "format", "--quiet", *CODE)),
    Step("inputs", "numbers of tests that need recordings", ("tests/RECORDINGS.md",), count_inputs),
)  # fmt: skip


def contents(patterns: tuple[str, ...]) -> dict[Path, bytes]:
    """Return the bytes of all files of some patterns."""
    return {path: path.read_bytes() for pattern in patterns for path in ROOT.glob(pattern) if path.is_file()}


def restore(before: dict[Path, bytes], after: dict[Path, bytes]) -> None:
    """Give files their old content, and remove those that were not there."""
    for path in after.keys() - before.keys():
        path.unlink()
    for path, content in before.items():
        if after.get(path) != content:
            path.write_bytes(content)


def perform(step: Step, check: bool) -> Outcome:
    """Perform a step; with ``check`` the tree is afterwards as it was."""
    outcome, begin, before = Outcome(step.name), time.monotonic(), contents(step.writes)
    try:
        step.action()
    except LeftOut as error:
        outcome.state, outcome.about = "left out", str(error)
    except (StepFailure, OSError) as error:
        outcome.state, outcome.about = "FAILED", str(error)
    finally:
        after = contents(step.writes)
        if check:
            restore(before, after)
    both = before.keys() | after.keys()
    outcome.files = sorted(p.relative_to(ROOT).as_posix() for p in both if before.get(p) != after.get(p))
    outcome.seconds = time.monotonic() - begin
    return outcome


def print_steps(steps: tuple[Step, ...]) -> None:
    """Print names, contents and files of steps, and what no step writes."""
    for step in steps:
        print(f"{step.name:<17} {step.about}: {' '.join(step.writes)}")
    print("\nnot written, since they need recordings or hours:")
    for file, words in LONG.items():
        print(f"{file}: {words}")


def main(words: list[str] | None = None) -> int:
    """Perform the chosen steps; return 1 if one failed, or with ``--check`` if a file would change."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("steps", nargs="*", metavar="STEP", help="names of steps (default: all)")
    parser.add_argument("--check", action="store_true", help="write nothing, and fail if a file would change")
    parser.add_argument("--list", action="store_true", help="print the steps and what they write")
    options = parser.parse_args(words)
    known = {step.name: step for step in STEPS}
    if unknown := [name for name in options.steps if name not in known]:
        parser.error(f"no step is called {', '.join(unknown)}; the steps are {', '.join(known)}")
    steps = tuple(step for step in STEPS if step.name in options.steps or not options.steps)
    if options.list:
        print_steps(steps)
        return 0
    outcomes = []
    try:
        for step in steps:
            print(f"{step.name:<17}", end="", flush=True)
            outcomes.append(perform(step, options.check))
            print("\n".join(outcomes[-1].lines(options.check)), flush=True)
    except KeyboardInterrupt:
        print("\nfix: interrupted")
        return 130
    failed = [outcome.name for outcome in outcomes if outcome.state == "FAILED"]
    changed = [outcome.name for outcome in outcomes if outcome.files]
    print(f"fix: {len(outcomes)} steps in {sum(outcome.seconds for outcome in outcomes):.0f} s")
    for title, names in (("would change" if options.check else "changed", changed), ("failed", failed)):
        if names:
            print(f"fix: {title}: {', '.join(names)}")
    return int(bool(failed or (options.check and changed)))


if __name__ == "__main__":
    sys.exit(main())
