"""The documents are true: their code runs, their commands exist, their links lead somewhere."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from crowdbot import models
from crowdbot.cli import COMMANDS
from crowdbot.core import builtin_classes
from crowdbot.trials import builtin_trials

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
"""The pages outside docs/; those in it are run by tests/docs."""
ALL_PAGES = [*PAGES, *sorted((ROOT / "docs").rglob("*.md"))]


def _blocks(page, language):
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.S)


PYTHON = [(page.name, number, code) for page in PAGES for number, code in enumerate(_blocks(page, "python"))]


@pytest.mark.program
@pytest.mark.parametrize(("page", "number", "code"), PYTHON, ids=[f"{p}-{n}" for p, n, _ in PYTHON])
def test_python_blocks_run(page, number, code, tmp_path):
    program = tmp_path / "block.py"
    program.write_text(code, encoding="utf-8")
    done = subprocess.run([sys.executable, "-W", "error", str(program)], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr


def test_the_readme_shows_a_prediction_and_a_trial():
    predict, live, trial = _blocks(ROOT / "README.md", "python")
    assert len([line for line in predict.splitlines() if line.strip()]) <= 12
    assert len([line for line in live.splitlines() if line.strip()]) <= 12
    assert len([line for line in trial.splitlines() if line.strip()]) <= 4


WALKS = [block for block in _blocks(ROOT / "CONTRIBUTING.md", "") if ".py " in block and "python " not in block]
STATION = re.compile(r"^[ |+-]*(?P<room>[a-z]+ )? *(?P<file>[a-z_/0-9]+\.py) (?P<name>\w+)", flags=re.M)


@pytest.mark.parametrize("walk", WALKS, ids=["beam"])
def test_a_walk_names_what_exists_and_enters_a_room_once(walk):
    stations = list(STATION.finditer(walk))
    assert len(stations) == walk.count(".py ") >= 4
    for station in stations:
        text = (ROOT / "src" / "crowdbot" / station["file"]).read_text(encoding="utf-8")
        assert re.search(rf"^(?:def|class) {station['name']}\b", text, flags=re.M), station[0]
    rooms = [station["file"].split("/")[0] for station in stations]
    entered = [station["room"].strip() for station in stations if station["room"]]
    assert entered == list(dict.fromkeys(rooms))


def test_numbers_of_built_in_names_are_those_of_today():
    trials, kinds = len(builtin_trials()), len(builtin_classes(models, models.CrowdModel))
    page = (ROOT / "docs/index.md").read_text(encoding="utf-8")
    assert f"{trials} built-in trials" in page
    assert f"calibrated crowds ({kinds} models)" in page
    assert f"{kinds} crowd models" in (ROOT / "docs/about/comparison.md").read_text(encoding="utf-8")
    assert f"{trials} trials are built in" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_the_floors_are_those_of_the_linter():
    (floors,) = [block for block in _blocks(ROOT / "CONTRIBUTING.md", "") if "cli   " in block and "core" in block]
    listed = [" | ".join(re.findall(r"\w+", line[4:41].strip())) for line in floors.splitlines()]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert listed == project["tool"]["importlinter"]["contracts"][0]["layers"]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_and_pictures_exist(page):
    targets = re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8"))
    missing = [t for t in targets if not t.startswith("http") and not (page.parent / t).exists()]
    assert missing == []


@pytest.mark.parametrize("page", ALL_PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_commands_exist(page):
    named = set(
        re.findall(
            r"^ *(?:\$ )?crowdbot ([a-z]+)",
            "\n".join(re.findall(r"```(?:console)?\n(.*?)```", page.read_text(), flags=re.S)),
            flags=re.M,
        )
    )
    assert named <= set(COMMANDS)


@pytest.mark.program
def test_make_knows_the_commands_and_ci_runs_both_tiers():
    for target in ("demo", "test", "live"):
        done = subprocess.run(
            ["make", "--dry-run", target], cwd=ROOT, capture_output=True, text=True, env={**os.environ, "MAKEFLAGS": ""}
        )
        assert done.returncode == 0, done.stderr
        assert {"demo": "crowdbot demo", "test": "pytest", "live": "tools/live.py"}[target] in done.stdout
    assert "make test && make live && exit" in (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()


@pytest.mark.program
def test_the_page_of_models_is_made_from_the_models():
    done = subprocess.run([sys.executable, ROOT / "tools" / "models.py"], capture_output=True, text=True, check=True)
    assert (ROOT / "docs" / "reference" / "crowd-models.md").read_text(encoding="utf-8") == done.stdout, "make fix"
