"""The demo end to end: its files, its numbers, and its page as a browser shows it."""

import json
import re
import subprocess
from pathlib import Path

import pytest

from crowdbot.cli import main
from crowdbot.evaluation import run_demo
from crowdbot.recording import replay

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    said = []
    made = run_demo(tmp_path_factory.mktemp("demo"), progress=lambda what, share: said.append((what, share)))
    return made, said


def test_it_makes_two_files_and_tells_its_progress(done):
    made, said = done
    folder = made.report_file.parent
    assert sorted(p.name for p in folder.iterdir()) == ["episode.mcap", "report.html"]
    steps = list(dict.fromkeys(what for what, _ in said))
    assert [step[0] for step in steps] == ["1", "2", "3", "4"]
    assert all(dict(said)[step] == 1.0 for step in steps)


def test_the_robot_gets_through_the_crowd(done):
    episode = done[0].episode
    assert episode.outcome == "success"
    assert episode.position.shape[1] == 41
    assert replay(done[0].episode_file).equal


def test_four_predictors_are_scored_on_the_same_people(done):
    scores = done[0].scores
    assert [s.predictor for s in scores] == ["constant-velocity", "constant-acceleration", "kalman", "simulated"]
    assert len({(s.windows, s.persons, s.protocol) for s in scores}) == 1
    assert all(0.0 < s.ade < s.fde for s in scores)
    assert scores[0].horizon[0] < scores[0].horizon[-1]


def test_the_commands_of_the_page_reproduce_its_table(done, capsys):
    made = done[0]
    page = made.report_file.read_text(encoding="utf-8")
    lines = re.findall(r"^crowdbot predict .*$", page.replace("&#x27;", "'"), re.MULTILINE)
    assert len(lines) == 4
    for line, score in zip(lines, made.scores, strict=True):
        assert main([*line.split()[1:], "--json"]) == 0
        total = json.loads(capsys.readouterr().out)["results"][0]["total"]
        assert (total["ade"], total["fde"], total["persons"]) == pytest.approx((score.ade, score.fde, score.persons))


def test_the_readme_has_the_table_of_the_demo(done):
    shown = {}
    for line in (ROOT / "README.md").read_text(encoding="utf-8").splitlines():
        name, *cells = re.split(r"\s{2,}", line.strip())
        if name in {score.predictor for score in done[0].scores}:
            shown[name] = cells[:-1]
    *_, milliseconds = done[0].scores[0].columns
    assert milliseconds == "ms/window"  # the only column that depends on the machine
    assert shown == {score.predictor: [*score.cells()[:-1]] for score in done[0].scores}


def test_the_page_asks_nothing_from_outside(done):
    page = done[0].report_file.read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:|#)""", page)
    assert not re.search(r"@import|fetch\(|XMLHttpRequest|WebSocket", page)
    outside = set(re.findall(r"https?://[^\s\"'<>)]+", page))
    assert all("w3.org" in address or "purl.org" in address or "creativecommons.org" in address for address in outside)


def test_a_browser_draws_the_page(done, tmp_path, chromium):
    flags = [
        "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
        "--disable-background-networking", "--disable-component-update", f"--user-data-dir={tmp_path / 'profile'}",
        "--virtual-time-budget=5000", "--window-size=1280,1500", f"--screenshot={tmp_path / 'page.png'}",
    ]  # fmt: skip
    address = done[0].report_file.resolve().as_uri()
    shown = subprocess.run([chromium, *flags, "--dump-dom", address], capture_output=True, text=True, timeout=120)
    assert 'data-ready="true"' in shown.stdout, shown.stderr[-2000:]
    drawn = subprocess.run([chromium, *flags, address], capture_output=True, text=True, timeout=120)
    assert drawn.returncode == 0
    assert "Uncaught" not in shown.stderr + drawn.stderr
    pixels = _pixels(tmp_path / "page.png")
    assert pixels.shape[:2] == (1500, 1280)
    assert len({tuple(p) for p in pixels[300:800:3, ::3, :3].reshape(-1, 3).tolist()}) > 50


def _pixels(path):
    from matplotlib.image import imread

    return (imread(path) * 255).astype(int)


def test_the_command_prints_one_object(tmp_path, capsys):
    assert main(["demo", "--out", str(tmp_path / "here"), "--seed", "4", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["seed"] == 4
    assert set(document["prediction"]) == {"constant-velocity", "constant-acceleration", "kalman", "simulated"}


@pytest.mark.parametrize("name", ["episode.mcap", "report.html"])
def test_results_are_not_overwritten_unasked(name, tmp_path, capsys):
    (tmp_path / name).write_text("mine")
    assert main(["demo", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert f"{tmp_path / name} already exists; use another path, or --force" in said
    assert (tmp_path / name).read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == [name]
