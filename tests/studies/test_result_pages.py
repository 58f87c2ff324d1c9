"""Pages of drives and of crowd models beside other engines."""

import dataclasses
import shutil
from pathlib import Path

import crowdbot
import engines
from crowdbot.benchmark import DriveFigures, EngineReport, EngineRow, EngineSizes, MillionRow, measure_drives
from drives import main, write_drives_page

ROBOTS = Path(crowdbot.__file__).parent / "assets" / "robots"


STUDIES = Path(__file__).parents[2] / "studies"
SCRIPTS = sorted(file.name for file in STUDIES.glob("*.py") if "__main__" in file.read_text(encoding="utf-8"))


def test_every_script_reads_its_arguments_with_a_help():
    assert len(SCRIPTS) > 20
    for name in SCRIPTS:
        source = (STUDIES / name).read_text(encoding="utf-8")
        assert "ArgumentParser(" in source, f"studies/{name} has no --help"
        assert "sys.argv[" not in source, f"studies/{name} reads its arguments past its parser"


def test_a_page_has_its_tables_and_plots(tmp_path):
    report = measure_drives(["differential"], quick=True)
    files = write_drives_page(report, tmp_path / "drives.md", "python studies/drives.py --quick")
    assert [file.name for file in files] == ["drives.md", "steps.png", "paths.png", "slip.png", "time-steps.png"]
    assert all(file.stat().st_size > 1000 for file in files)
    text = files[0].read_text(encoding="utf-8")
    assert "| differential | wheels | 5 |" in text
    assert "All figures of 1 robot are within the bars." in text
    worse = dataclasses.replace(report.rows[0], grid=DriveFigures(overshoot=0.5, tilt=1.0))
    write_drives_page(dataclasses.replace(report, rows=(worse,)), tmp_path / "drives.md")
    text = files[0].read_text(encoding="utf-8")
    assert "Not within the bars: differential at 5 ms (overshoot, fall)." in text


def test_the_page_has_robots_of_other_makers(tmp_path):
    cart, page = tmp_path / "cart.urdf", tmp_path / "drives.md"
    shutil.copyfile(ROBOTS / "turtlebot2" / "turtlebot2.urdf", cart)
    words = ["--robot", "differential", "--quick", "--page", str(page), "--makers", str(cart)]
    assert main(words) == 0
    text = page.read_text(encoding="utf-8")
    assert f"--page drives.md --makers \\\n    {cart}\n" in text
    assert "## Robots of other makers" in text
    assert "| cart | differential | 5 |" in text
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cart.urdf", "drives", "drives.md"]


def test_figures_beyond_the_bars_are_named_for_other_makers(tmp_path):
    report = measure_drives(["differential"], quick=True)
    worse = dataclasses.replace(report.rows[0], robot="cart", grid=DriveFigures(overshoot=0.5, tilt=1.0))
    report = dataclasses.replace(report, makers=(worse, report.rows[0]))
    text = write_drives_page(report, tmp_path / "drives.md")[0].read_text(encoding="utf-8")
    assert "Within all bars at all steps: 1 robot. Beyond a bar at some step: cart: overshoot, fall." in text


def test_the_page_of_engines_has_its_rows_and_the_command(tmp_path):
    row = EngineRow("orca", "RVO2", 1000, "sorted", 1, 0.1, 2.0, 3.0, 1.5, 1.4, 1.6)
    million = MillionRow("orca", 1_000_000, 1.5, 900.0)
    words = {"RVO2": "the same model"}
    report = EngineReport("a machine", (None, None), EngineSizes(2), 2, {"pyrvo": "0.4"}, words, {}, (row,), million)
    engines.write_engines_page(report, tmp_path / "page.md", "python studies/engines.py --page engines.md")
    page = (tmp_path / "page.md").read_text(encoding="utf-8")
    assert "```\npython studies/engines.py --page engines.md\n```" in page
    assert "| orca | RVO2 | 1000 | sorted | 1 | 0.1 | 2 | 3 | 1.50 | 1.40 to 1.60 |" in page
    assert "1000000 people (orca, all kernels in their default number of threads): 1.50 s a step of 0.1 s" in page
